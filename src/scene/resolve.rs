//! Resolution of a scene: determines the names, the numeric values and the defaults of all runs and
//! sweeps of the scene.

use super::discretisation::{SOLUTION, Solution};
use super::error::SceneError;
use super::problem::Problem;
use super::reach::Ends;
use super::statement::{Run, Scene, Start, Sweep};
use crate::core::bifurcation::catalogue;
use crate::core::cancel::CancelToken;
use crate::core::continuation::{Branch, Settings};
use crate::core::hybrid::HybridEquations;
use crate::core::problem::Group;
use crate::core::system::{Kind, System};
use crate::output::{Document, restrict_plot};
use std::fmt::Display;
use std::sync::Arc;

/// A special point of an earlier result at which a run of a scene starts.
#[derive(Clone, Debug, PartialEq)]
pub struct StartPoint {
    /// The branch that contains the special point.
    pub branch: Branch,
    /// The label of the special point.
    pub label: usize,
    /// The names of the parameters and settings whose values at the start are taken from the scene;
    /// all other parameters, and all other settings that determine the equations, have the values of
    /// the special point.
    pub changed: Vec<String>,
    /// The settings with which the branch was traced, with their values.
    pub settings: Vec<(String, String)>,
    /// The other branches of the earlier result, besides the branch that contains the special
    /// point. If the special point is the first point of a branch that emanates from a parent
    /// branch of the earlier result, this branch is traced again from the corresponding special
    /// point of the parent branch.
    pub beside: Vec<Branch>,
    /// The kind of special point whose curve starts at this point; `None` if the scene determines
    /// the kind.
    pub hold: Option<Kind>,
    /// Whether to trace a branch that emanates from the special point: cycles at a Hopf point,
    /// doubled orbits at a period doubling, or the other branch at a branch point.
    pub switch: bool,
}

impl StartPoint {
    /// Creates a start point at which no parameters have values from the scene.
    pub fn new(branch: Branch, label: usize) -> Self {
        let (changed, settings, beside) = (Vec::new(), Vec::new(), Vec::new());
        StartPoint { branch, label, changed, settings, beside, hold: None, switch: false }
    }

    /// Creates a start point at a special point of a document; the start point also stores the
    /// document's settings and other branches.
    pub fn of(document: &Document, branch: Branch, label: usize) -> Self {
        let others = document.branches.iter().filter(|other| other.name != branch.name);
        let beside = others.cloned().collect();
        let own = document.differences.iter().filter(|(name, _)| *name == branch.name);
        let own = own.flat_map(|(_, set)| set).chain(&document.settings).cloned();
        StartPoint { settings: own.collect(), beside, ..StartPoint::new(branch, label) }
    }

    /// Returns the value of a parameter at the special point.
    fn value(&self, parameter: &str) -> Option<f64> {
        let special = self.branch.labelled(self.label)?;
        special.value(self.branch.column(parameter)?)
    }

    /// Returns the settings of a scene that determine its equations and have other values at the
    /// special point: their names, the values at the special point, and the values in the scene.
    fn other_settings(&self, scene: &Scene) -> Vec<(String, String, String)> {
        let defining = scene.problem.defining_settings().into_iter();
        let free = defining.filter(|(name, _)| {
            !self.changed.contains(name) && scene.run_that_sets(name).is_none()
        });
        let other = free.filter_map(|(name, in_scene)| {
            let (_, here) = self.settings.iter().find(|(known, _)| *known == name)?;
            (*here != in_scene).then(|| (name, here.clone(), in_scene))
        });
        other.collect()
    }

    /// Returns the kind of the special point at which a run starts.
    pub(super) fn kind(&self) -> Option<Kind> {
        self.branch.labelled(self.label).map(|special| special.kind)
    }

    /// Returns whether the start point is the origin of the run's branch: the point where the
    /// branch emanates from another known branch.
    pub(super) fn is_origin(&self, run: &Run) -> bool {
        let Start::From { run: from, kind, switch, .. } = &run.start else { return false };
        let leaves = *switch || *kind == Kind::HB;
        let known = self.beside.iter().any(|branch| branch.name == *from);
        let first = self.branch.points.first().map(|point| &point.parameters);
        let here = self.branch.labelled(self.label).map(|special| &special.parameters);
        leaves && known && self.branch.name == run.name && first.is_some() && first == here
    }
}

/// A run of a scene, with all its names and values resolved.
#[derive(Clone, Debug, PartialEq)]
pub struct Resolved {
    /// The statement of the run, including its name, ranges, bounds, marks, and `hold` or
    /// `hold_level`.
    pub(super) run: Run,
    /// The problem, with the settings that apply to the run.
    pub(super) problem: Problem,
    /// The values of all parameters at the start of the run, in the order of the problem's
    /// parameters.
    pub(super) values: Vec<f64>,
    /// The parameters whose values at the start are not taken from the special point at which the
    /// run starts, with these values.
    pub(super) changed: Vec<(String, f64)>,
    /// The settings of the continuation.
    pub(super) settings: Settings,
    /// For each parameter, how far the parameter varies from its start in any run of the scene.
    pub(super) reach: Vec<f64>,
    /// The special point of an earlier result at which the run starts.
    pub(super) from: Option<StartPoint>,
}

/// A sweep of a scene, with all its names and values resolved.
#[derive(Clone, Debug)]
pub(super) struct ResolvedSweep {
    /// The statement of the sweep in the scene.
    pub sweep: Sweep,
    /// The problem, with the settings that apply to the sweep.
    pub problem: Problem,
    /// The values of all parameters in the order of the problem's parameters; for the parameters on
    /// the axes of the sweep, the values on the axes are used instead.
    pub values: Vec<f64>,
    /// The token that cancels the sweep.
    pub cancel: CancelToken,
}

/// The runs and sweeps of a scene with resolved names and values, in the order of execution.
#[derive(Clone, Debug)]
pub struct Resolution {
    /// The scene as stated in its text, which identifies the results and states how they are drawn.
    scene: Scene,
    start: Option<StartPoint>,
    /// Warnings about settings whose values are taken from the start point and not from the scene.
    inherited: Vec<String>,
    /// The runs whose branches are traced, with resolved names and values.
    pub(super) runs: Vec<Resolved>,
    pub(super) sweeps: Vec<ResolvedSweep>,
}

impl Resolved {
    /// Returns the name of the branch that the run traces.
    pub fn name(&self) -> &str {
        &self.run.name
    }

    /// Returns the system of equations whose solutions the run traces.
    pub(super) fn system(&self) -> Result<Box<dyn System>, SceneError> {
        self.problem.model().system(&self.values, &self.reach)
    }

    /// Returns the motion that the run simulates.
    pub(super) fn motion(&self) -> Result<Arc<dyn HybridEquations>, SceneError> {
        self.problem.model().motion()
    }

    /// Returns the default initial states of motions and branches.
    pub(super) fn initial(&self) -> Vec<(String, f64)> {
        self.problem.initial(&self.values)
    }

    /// Returns the names and values of the parameters.
    pub(super) fn parameters(&self) -> impl Iterator<Item = (String, f64)> {
        self.problem.parameter_names().into_iter().zip(self.values.iter().copied())
    }
}

impl Scene {
    /// Resolves the scene: determines every name, value and default of its runs and sweeps.
    ///
    /// If a start point is given, only one of the runs whose branches are shown is traced; if the
    /// start point requests a curve of special points of some kind, the run traces this curve. The
    /// run is chosen by the first of the following rules that applies: the run has the name of the
    /// start point's branch; the run traces the same kind of curve in the same unknowns; the run
    /// traces special points of the start point's kind, or a curve that emanates from the point;
    /// the run is the first one whose branch is shown. If the run traces points of a local map, the
    /// runs that find the grazing at which the map is built are traced first. Parameters, and
    /// settings that determine the equations, have the values of the start point, unless the start
    /// point lists them as changed.
    ///
    /// ```
    /// use tangency::scene::Scene;
    /// let scene = Scene::parse("Scene(
    ///     title: \"Two runs\",
    ///     problem: Equations(states: [(\"x\", \"a - b*x^2\")]),
    ///     parameters: [(\"a\", 1), (\"b\", 1)],
    ///     runs: [
    ///         (name: \"plain\", along: [(name: \"a\", low: 0, high: 1)]),
    ///         (name: \"steep\", set: [(\"b\", \"7/2\")], along: [(name: \"a\", low: 0, high: 1)]),
    ///     ],
    /// )")?;
    /// let resolution = scene.resolve(None)?;
    /// let names: Vec<&str> = resolution.runs().iter().map(|run| run.name()).collect();
    /// assert_eq!(names, ["plain", "steep"]);
    /// # Ok::<(), tangency::scene::SceneError>(())
    /// ```
    ///
    /// # Errors
    /// [`SceneError`] if a parameter has no value.
    pub fn resolve(&self, start: Option<&StartPoint>) -> Result<Resolution, SceneError> {
        let (mut scene, mut inherited) = (self.clone(), Vec::new());
        for (name, here, in_scene) in start.map_or(Vec::new(), |point| point.other_settings(self)) {
            scene.set(&name, &here)?;
            inherited.push(overridden(&name, &here, &in_scene));
        }
        let ends = Ends::of(&scene.runs);
        let all = scene.runs.iter().map(|run| scene.resolved_among(run, &ends));
        let runs: Vec<Resolved> = all.collect::<Result<_, _>>()?;
        let runs = match start {
            Some(point) => going_on(&scene, runs, point)?,
            None => runs,
        };
        let sweeps = scene.sweeps.iter().map(|sweep| scene.resolved_sweep(sweep));
        let (start, sweeps) = (start.cloned(), sweeps.collect::<Result<_, _>>()?);
        Ok(Resolution { scene, start, inherited, runs, sweeps })
    }

    /// Resolves a run of the scene; values that the run does not state are taken from the scene.
    /// The following runs trace orbits unless they set `solution`: a run from a Hopf point along a
    /// branch of solutions, a run along a curve of special orbits, and a run along a curve of
    /// special cycles that starts at a special point of equilibria.
    pub(super) fn resolved(&self, run: &Run) -> Result<Resolved, SceneError> {
        self.resolved_among(run, &Ends::of(&self.runs))
    }

    /// Resolves a run in the same way as [`resolved`](Self::resolved), given the ends of the ranges of
    /// all runs.
    pub(super) fn resolved_among(&self, run: &Run, ends: &Ends) -> Result<Resolved, SceneError> {
        let mut seen = self.with(&run.set)?;
        let at_hopf = matches!(run.start, Start::From { kind: Kind::HB, .. });
        let holds = run.hold.is_some() || run.hold_level.is_some();
        let says = run.set.iter().any(|(name, _)| name == SOLUTION);
        let of_cycles = match run.start {
            Start::From { kind, .. } => leads_to_cycles(Some(kind), run),
            _ => false,
        } || run.hold.is_some_and(catalogue::is_of_orbits);
        if (at_hopf && !holds || of_cycles) && !says {
            seen.problem.follow(Solution::Orbit);
        }
        let values = seen.values()?;
        let reach = ends.reach(&seen.problem, &values);
        let own = run.set.iter().filter_map(|(name, _)| Some((name.clone(), seen.value(name)?)));
        let changed = own.collect();
        let Scene { problem, settings, .. } = seen;
        Ok(Resolved { run: run.clone(), problem, values, changed, settings, reach, from: None })
    }

    pub(super) fn resolved_sweep(&self, sweep: &Sweep) -> Result<ResolvedSweep, SceneError> {
        let seen = self.with(&sweep.set)?;
        let values = seen.values()?;
        let cancel = seen.settings.cancel;
        Ok(ResolvedSweep { sweep: sweep.clone(), problem: seen.problem, values, cancel })
    }
}

impl Resolution {
    /// Returns the runs whose branches are traced, in the order of execution.
    pub fn runs(&self) -> &[Resolved] {
        &self.runs
    }

    /// Returns the scene whose runs and sweeps are resolved.
    pub fn scene(&self) -> &Scene {
        &self.scene
    }

    /// Returns the start point of the resolution, or `None` if no start point is given.
    pub(super) fn start(&self) -> Option<&StartPoint> {
        self.start.as_ref()
    }

    /// Resolves an additional run as if the scene stated it. A run that this resolution already
    /// contains is returned unchanged, because it may start from a saved point.
    pub(super) fn further(&self, run: &Run) -> Result<Resolved, SceneError> {
        match self.runs.iter().find(|own| own.run == *run) {
            Some(own) => Ok(own.clone()),
            None => self.scene.resolved(run),
        }
    }

    /// Returns the run with a given name, preceded by all runs that its start needs.
    pub(super) fn leading(&self, name: &str) -> Vec<&Resolved> {
        let names = leading(&self.runs, name);
        self.runs.iter().filter(|run| names.contains(&run.name())).collect()
    }

    /// Returns warnings about probable mistakes in the scene ([`Scene::warnings`]), and about
    /// values in the scene that have no effect because the start point has other values.
    pub fn warnings(&self) -> Vec<String> {
        let mut warnings = [self.scene.warnings(), self.inherited.clone()].concat();
        if let (Some(start), Some(going)) = (&self.start, self.runs.last()) {
            warnings.extend(self.overridden(start, going));
        }
        warnings
    }

    /// Returns warnings about parameters whose values at the start point differ from their values
    /// in the scene.
    fn overridden(&self, start: &StartPoint, going: &Resolved) -> Vec<String> {
        let released = |run: &Run, name: &str| run.along.iter().any(|range| range.name == name);
        let varied = |name: &str| {
            let set = |run: &Run| run.set.iter().any(|(set, _)| set == name);
            self.scene.runs.iter().any(|run| released(run, name) || set(run))
        };
        let changed = |name: &str| going.changed.iter().any(|(own, _)| own == name);
        let of_scene = self.scene.parameters.iter().filter(|(name, _)| !varied(name)).cloned();
        let set = going.run.set.iter().map(|(name, _)| name);
        let set = set.filter(|name| !released(&going.run, name));
        let stated = self.scene.resolved(&going.run);
        let of_run = stated.iter().flat_map(Resolved::parameters);
        let of_run = of_run.filter(|(name, _)| set.clone().any(|own| own == name));
        let stated = of_scene.chain(of_run).filter(|(name, _)| !changed(name));
        let differs = stated.filter_map(|(name, value)| {
            let at = start.value(&name)?;
            (at != value).then(|| overridden(&name, &at, &value))
        });
        differs.collect()
    }

    /// Creates a document for branches, with the title, plot and settings of the scene.
    pub(super) fn document<'a>(
        &self,
        runs: impl Iterator<Item = &'a Run>,
        branches: Vec<Branch>,
    ) -> Document {
        let mut document = Document::new(self.scene.title.clone(), branches);
        document.plot = self.scene.labelled_plot();
        if self.start.is_some() {
            // The scene's plot may show other branches, which are not traced.
            restrict_plot(&mut document);
        }
        document.settings = self.scene.record();
        // The start point has its own parameter values.
        let parameters = self.scene.problem.parameter_names();
        let counts =
            |(name, _): &&(String, String)| self.start.is_none() || !parameters.contains(name);
        let set = |run: &Run| run.set.iter().filter(counts).cloned().collect::<Vec<_>>();
        let different = runs.filter(|run| run.shown).map(|run| (run.name.clone(), set(run)));
        document.differences = different.filter(|(_, set)| !set.is_empty()).collect();
        document
    }
}

/// Returns the warning that the value of a parameter or setting is taken from the start point.
fn overridden(name: &str, here: &impl Display, in_scene: &impl Display) -> String {
    format!(
        "`{name}` is {here} at the start point but {in_scene} in the scene: the branch starts with \
         `{name}` = {here}; give `--set {name}={in_scene}` to start with the value in the scene"
    )
}

/// Returns the run that continues from a start point, preceded by the runs that find the grazing of
/// the local map, if the run uses a local map.
fn going_on(
    scene: &Scene,
    runs: Vec<Resolved>,
    point: &StartPoint,
) -> Result<Vec<Resolved>, SceneError> {
    let Some(run) = continuing(&runs, point) else { return Ok(Vec::new()) };
    let mut going = run.clone();
    let orbits = on_orbits(&going);
    let of_orbits =
        || has_unknowns(&orbits, &point.branch) || point.branch.condition == Some(Kind::HOM);
    let kind = point.kind();
    let of_cycles = leads_to_cycles(kind, &going.run) || point.switch && kind == Some(Kind::HB);
    if of_cycles || !has_unknowns(&going, &point.branch) && of_orbits() {
        going = orbits;
    }
    if let Some(range) = going.run.along.iter().find(|range| point.changed.contains(&range.name)) {
        return Err(SceneError::invalid(format!(
            "`{}` varies along the branch, and the start point gives the first value",
            range.name
        ))
        .with_help(format!("omit `--set {}=…`", range.name)));
    }
    let changed = point.changed.iter().filter_map(|name| Some((name.clone(), scene.value(name)?)));
    going.changed = changed.collect();
    for (name, value) in going.problem.parameter_names().iter().zip(&mut going.values) {
        let here = point.value(name).filter(|_| !point.changed.contains(name));
        *value = here.unwrap_or(*value);
    }
    going.reach = Ends::of(&scene.runs).reach(&going.problem, &going.values);
    going.from = Some(point.clone());
    let names = going.run.local.as_ref().map_or(Vec::new(), |local| leading(&runs, &local.run));
    let before = runs.iter().filter(|run| names.contains(&run.name())).cloned();
    let mut all: Vec<Resolved> = before.collect();
    all.iter_mut().for_each(|before| before.run.shown = false);
    all.push(going);
    Ok(all)
}

/// Returns whether a run traces a curve of special cycles that emanates from a special point of
/// equilibria.
fn leads_to_cycles(point: Option<Kind>, run: &Run) -> bool {
    let leads = |(point, held)| catalogue::is_of_cycles(point, held);
    point.zip(run.hold).is_some_and(leads)
}

/// Returns a copy of the run that traces orbits, if its problem has both equilibria and orbits.
fn on_orbits(run: &Resolved) -> Resolved {
    let mut orbits = run.clone();
    orbits.problem.follow(Solution::Orbit);
    orbits
}

/// Returns whether the solutions of a run have the same unknowns as a branch.
fn has_unknowns(run: &Resolved, branch: &Branch) -> bool {
    run.system().is_ok_and(|system| {
        // In old documents each element of an array is a group.
        system.names().elements().eq(branch.unknowns.iter().flat_map(Group::elements))
    })
}

/// Returns the run that continues the branch of a start point, among the runs whose branches are
/// shown; if no run does, returns a run that traces special points of the start point's kind, or a
/// curve that emanates from the start point.
fn continuing<'a>(runs: &'a [Resolved], point: &StartPoint) -> Option<&'a Resolved> {
    let branch = &point.branch;
    let wanted = |run: &Run| point.hold.is_none() || run.hold == point.hold;
    let shown = || runs.iter().filter(|it| it.run.shown && wanted(&it.run));
    let alike = |resolved: &&Resolved| {
        let run = &resolved.run;
        let held = run.hold.or(run.hold_level.as_ref().map(|_| Kind::UZ));
        held == branch.condition && run.local.is_none() && has_unknowns(resolved, branch)
    };
    let kind = point.kind();
    let leaving = branch.condition.zip(kind).map(|(held, kind)| catalogue::leaving(held, kind));
    let follows = |resolved: &&Resolved| {
        let leaves = |held: &Kind| leaving.is_some_and(|leaving| leaving.contains(held));
        resolved.run.hold.is_some_and(|held| Some(held) == kind || leaves(&held))
    };
    let named = shown().find(|run| run.name() == branch.name);
    named.or(shown().find(alike)).or(shown().find(follows)).or(shown().next())
}

/// Returns the name of a run, and the names of all runs that its start needs.
fn leading<'a>(runs: &'a [Resolved], name: &'a str) -> Vec<&'a str> {
    let mut names = vec![name];
    let mut last = name;
    while let Some(run) = runs.iter().find(|run| run.name() == last)
        && let Start::From { run: from, .. } = &run.run.start
    {
        names.push(from);
        last = from;
    }
    names
}

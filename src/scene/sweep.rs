//! Sweeps of a scene, which compute the attractors of motions over ranges of parameters and initial
//! states.

use super::error::SceneError;
use super::forecast::SweepForecast;
use super::resolve::{Resolution, ResolvedSweep};
use super::simulate::stated;
use super::statement::{Grid, Scene, Sweep};
use super::trace::map_of;
use crate::core::attractor::{
    AttractorSearch, Layout, PeriodMap, ReturnMap, StroboscopicError, StroboscopicMap,
};
use crate::core::failure::one_line;
use crate::core::hybrid::{HybridEquations, HybridSettings, Mode};
use crate::core::local_map::{Iterated, LocalMap};
use crate::core::ode;
use crate::core::problem::{UnknownName, position};
use crate::core::sweep::{self, Axis, Found, Make, Part, Plan, Quantity};
use crate::output::{SWEEPS, SweepTable, Sweeps};
use std::collections::BTreeMap;
use std::num::NonZeroUsize;
use std::sync::Arc;

/// An observer of the runs of a scene's sweeps.
pub trait SweepWatch {
    /// Called when a sweep begins; the table contains the runs that are already finished.
    fn begin(&mut self, _sweep: &SweepTable) {}

    /// Called when a sweep begins, with the estimated work of the sweep.
    fn work(&mut self, _work: &SweepForecast) {}

    /// Called when a run of a sweep is finished; `_known` contains the results of all finished
    /// runs, with the result of this run as the last one.
    fn found(&mut self, _known: &Sweeps, _found: &Found) {}
}

impl SweepWatch for () {}

impl Scene {
    /// Returns an error if the runs that are already known belong to another scene.
    ///
    /// # Errors
    /// [`SceneError::OtherScene`].
    pub fn check_known(&self, known: &Sweeps) -> Result<(), SceneError> {
        if known.scene == self.in_words() { Ok(()) } else { Err(SceneError::OtherScene) }
    }
}

impl ResolvedSweep {
    /// Returns the plan of the sweep's runs, for a motion that starts in a given mode.
    pub fn plan(&self, mode: &Mode) -> Result<Plan, SceneError> {
        let (sweep, parameters) = (&self.sweep, self.problem.parameter_names());
        let axis = |&Grid { ref name, low, high, count }: &Grid| {
            let known = parameters.iter().chain(&mode.states);
            let quantity = match position("parameter or state", name, known)? {
                state if state >= parameters.len() => Quantity::State(state - parameters.len()),
                parameter => Quantity::Parameter(parameter),
            };
            Ok::<Axis, UnknownName>(Axis { quantity, low, high, count })
        };
        let axes = sweep.over.iter().map(axis).collect::<Result<_, _>>()?;
        let starts = if sweep.starts.is_empty() { &[Vec::new()] } else { &sweep.starts[..] };
        let starts = starts.iter().map(|state| stated(mode, state)).collect::<Result<_, _>>()?;
        let crisis = sweep.crisis.as_ref().map(|sought| sought.among(&parameters)).transpose()?;
        let Sweep { order, strands, ref search, .. } = *sweep;
        let search = AttractorSearch { cancel: self.cancel.clone(), ..search.clone() };
        let plan = Plan { axes, starts, order, strands, search, crisis };
        plan.check(parameters.len())?;
        Ok(plan)
    }

    /// Returns the motion that the sweep samples.
    pub fn motion(&self) -> Result<Arc<dyn HybridEquations>, SceneError> {
        self.problem.model().motion()
    }

    /// Creates an empty table of results for a given number of runs.
    pub fn table(&self, runs: usize, layout: &Layout) -> SweepTable {
        let Sweep { name, over, crisis, .. } = &self.sweep;
        let axes: Vec<String> = over.iter().map(|grid| grid.name.clone()).collect();
        let crisis = crisis.as_ref().map(|sought| sought.name.as_str());
        SweepTable::new(name, (&axes, crisis), runs, layout)
    }

    /// Returns the system that is sampled once in every period: the motion of the problem, or a
    /// local map.
    fn sampled<'a>(
        &self,
        motion: &'a dyn HybridEquations,
        map: Option<&LocalMap>,
    ) -> Result<Box<dyn StroboscopicMap + 'a>, StroboscopicError> {
        let Sweep { at, measures, flow_tolerance, .. } = &self.sweep;
        let Some(map) = map else {
            let flow = ode::Settings::new(ode::Scheme::DormandPrince8, *flow_tolerance);
            let flow = ode::Settings { cancel: self.cancel.clone(), ..flow };
            let settings = HybridSettings { flow, ..HybridSettings::default() };
            return Ok(match at {
                None => Box::new(PeriodMap::of(motion, settings, measures)?),
                Some(event) => Box::new(ReturnMap::of(motion, settings, measures, event)?),
            });
        };
        let names = self.problem.parameter_names();
        let iterated = Iterated::of(map.clone(), &names, measures);
        Ok(Box::new(iterated.map_err(|cause| StroboscopicError::Map(one_line(&cause)))?))
    }
}

/// Computes the sweeps of a scene, or only a part of the runs of these sweeps, except for runs
/// whose results are already known.
///
/// ```
/// use tangency::core::sweep::Part;
/// use tangency::scene::{Scene, sweep};
/// let scene = Scene::parse("Scene(
///     title: \"Impacts\",
///     problem: ImpactOscillator(),
///     parameters: [(\"frequency\", 2.2)],
///     sweeps: [(name: \"up\", order: up, over: [(name: \"amplitude\", low: 1, high: 5, count: 3)])],
/// )")?;
/// let sweeps = sweep(&scene, "impacts", Part::WHOLE, None, &mut ())?;
/// let table = &sweeps.sweeps[0];
/// let impacts = table.run_columns.iter().position(|name| name == "impact").expect("a column");
/// assert!(table.is_complete() && table.rows[&2].values[impacts] == 1.0);
/// # Ok::<(), tangency::scene::SceneError>(())
/// ```
///
/// # Errors
/// [`SceneError`] if a sweep is invalid, or if the known results belong to another scene.
pub fn sweep(
    scene: &Scene,
    name: &str,
    part: Part,
    known: Option<Sweeps>,
    watch: &mut dyn SweepWatch,
) -> Result<Sweeps, SceneError> {
    let resolution = scene.resolve(None)?;
    let prepared = resolution.sweeps.iter().map(|sweep| Prepared::of(&resolution, sweep));
    let prepared: Vec<Prepared> = prepared.collect::<Result<_, _>>()?;
    let nothing = Sweeps {
        format: SWEEPS.into(),
        name: name.into(),
        title: scene.title.clone(),
        scene: scene.in_words(),
        plot: scene.labelled_plot(),
        sweeps: prepared.iter().map(Prepared::table).collect(),
    };
    let mut all = match known {
        Some(known) => {
            scene.check_known(&known)?;
            known.check_tables(&nothing).map_err(SceneError::OtherTables)?;
            known
        }
        None => nothing,
    };
    let mut before = 0;
    for (index, one) in prepared.iter().enumerate() {
        one.execute(part.after(before)?, &mut all, index, watch)?;
        if scene.settings.cancel.is_cancelled() {
            break;
        }
        before += scene.sweeps[index].strand_lengths(None).count();
    }
    Ok(all)
}

/// A sweep that has not been executed yet.
struct Prepared<'a> {
    resolved: &'a ResolvedSweep,
    motion: Arc<dyn HybridEquations>,
    /// The local map that the sweep iterates; `None` if the sweep simulates the motion.
    map: Option<LocalMap>,
    layout: Layout,
    plan: Plan,
}

impl<'a> Prepared<'a> {
    fn of(resolution: &Resolution, resolved: &'a ResolvedSweep) -> Result<Self, SceneError> {
        let motion = resolved.motion()?;
        let local = resolved.sweep.local.as_ref();
        let map = local.map(|local| map_of(resolution, resolved, local)).transpose()?;
        let layout = resolved.sampled(&*motion, map.as_ref())?.layout().clone();
        let plan = resolved.plan(&layout.modes[0])?;
        Ok(Prepared { resolved, motion, map, layout, plan })
    }

    /// Returns the table of the sweep before any results are added.
    fn table(&self) -> SweepTable {
        self.resolved.table(self.plan.runs(), &self.layout)
    }

    /// Computes the runs of the sweep whose results are not known yet.
    fn execute(
        &self,
        part: Part,
        all: &mut Sweeps,
        index: usize,
        watch: &mut dyn SweepWatch,
    ) -> Result<(), SceneError> {
        let Prepared { resolved, motion, map, layout, plan } = self;
        let (table, modes) = (&all.sweeps[index], &layout.modes);
        watch.begin(table);
        let end = |run: &usize| Some((*run, table.end(*run, plan.starts[0].time, modes)?));
        let ends: BTreeMap<usize, _> = table.rows.keys().filter_map(end).collect();
        let make: &Make = &|| resolved.sampled(&**motion, map.as_ref());
        let runs = (plan.runs() / part.of).saturating_sub(table.rows.len());
        let threads = part.threads.map_or_else(rayon::current_num_threads, NonZeroUsize::get);
        let work = make().ok().and_then(|mut map| {
            SweepForecast::of(plan, &resolved.values, &mut *map, runs, threads)
        });
        if let Some(work) = work {
            watch.work(&work);
        }
        let done = |run: usize| ends.get(&run).cloned();
        sweep::execute(plan, part, &resolved.values, make, &done, &mut |found: Found| {
            all.sweeps[index].push(&found, plan.start(found.run), modes);
            watch.found(all, &found);
        })?;
        Ok(())
    }
}

//! The columns of branches, which are known before the branches are computed.

use super::error::SceneError;
use super::resolve::{Resolved, ResolvedSweep};
use super::simulate::{Simulated, history_columns};
use super::statement::{Range, Run, Scene, Start};
use crate::core::attractor::Layout;
use crate::core::bifurcation::catalogue;
use crate::core::continuation::{Branch, End};
use crate::core::hybrid::Mode;
use crate::core::local_map::{Iterated, LocalOrbit, PHASE};
use crate::core::orbit::GRAZINGS;
use crate::core::problem::{Names, UnknownName, distinct};
use crate::output::{Document, FigureError, Plot, SweepTable, check_columns};

impl Scene {
    /// Returns the plot of the scene; columns without a label in the scene get the labels that the
    /// model's equations state.
    pub(super) fn labelled_plot(&self) -> Plot {
        let mut plot = self.plot.clone();
        let labels = self.problem.text().map_or(&[][..], |model| model.labels());
        for label in labels {
            if plot.labels.iter().all(|(column, _)| *column != label.0) {
                plot.labels.push(label.clone());
            }
        }
        plot
    }

    /// Returns the names of all columns that branches of the scene may have, including both the
    /// columns of equilibria and the columns of orbits; `None` if the columns are not known before
    /// the branches are traced. For a scene without runs, a run along the first parameter is
    /// assumed.
    ///
    /// ```
    /// use tangency::scene::{LIBRARY, Scene};
    /// let text = LIBRARY.iter().find(|scene| scene.name == "lorenz").unwrap().text;
    /// let columns = Scene::parse(text)?.columns().unwrap();
    /// assert!(["x", "max_x", "period"].iter().all(|name| columns.iter().any(|it| it == name)));
    /// assert!(!columns.contains(&"w".to_string()));
    /// # Ok::<(), tangency::scene::SceneError>(())
    /// ```
    pub fn columns(&self) -> Option<Vec<String>> {
        let first = self.problem.parameter_names().into_iter().next()?;
        let assumed = Run {
            start: Start::Simulated(Simulated::default()),
            ..Run::along("branch", vec![Range { name: first, low: None, high: None }])
        };
        let runs = if self.runs.is_empty() { vec![assumed] } else { self.runs.clone() };
        let mut columns: Vec<String> = Vec::new();
        for run in &runs {
            let mut resolved = self.resolved(run).ok()?;
            let mut branches = vec![resolved.untraced()?];
            if let Some(solution) = resolved.problem.solution() {
                resolved.problem.follow(solution.other());
                // Forced systems do not have equilibria.
                branches.extend(resolved.untraced());
            }
            columns.extend(branches.iter().flat_map(Branch::columns).map(String::from));
        }
        Some(columns)
    }

    /// Returns an error, before any computation, if the plot uses a column that no branch and no
    /// sweep will have.
    ///
    /// ```
    /// use tangency::core::failure::one_line;
    /// use tangency::scene::{BUILT_IN, Scene};
    /// let text = BUILT_IN.iter().find(|scene| scene.name == "bratu").unwrap().text;
    /// assert!(Scene::parse(text)?.check_plot().is_ok());
    /// let mut scene = Scene::parse(text)?;
    /// scene.plot.y = Some("max_v".into());
    /// scene.plot.x = Some("lamda".into());
    /// let error = one_line(&scene.check_plot().unwrap_err());
    /// assert!(error.contains("unknown column `lamda`; did you mean `lambda`?"), "{error}");
    /// # Ok::<(), tangency::scene::SceneError>(())
    /// ```
    ///
    /// # Errors
    /// [`SceneError::Figure`] with the missing column and the known columns, if a column does not
    /// exist.
    pub fn check_plot(&self) -> Result<(), SceneError> {
        let resolution = self.resolve(None)?;
        let shown = resolution.runs.iter().filter(|resolved| resolved.run.shown);
        // Errors other than unknown columns are reported by the trace.
        let branches: Option<Vec<Branch>> = shown.map(Resolved::untraced).collect();
        let tables: Option<Vec<SweepTable>> =
            resolution.sweeps.iter().map(ResolvedSweep::undone).collect();
        let (Some(branches), Some(tables)) = (branches, tables) else { return Ok(()) };
        let plain = self.runs.iter().all(|run| run.local.is_none() && !run.along.is_empty());
        if tables.is_empty() && plain && !branches.is_empty() {
            let mut document = Document::new(self.title.clone(), branches);
            document.plot = self.plot.clone();
            return Ok(check_columns(&document)?);
        }
        require_columns(&self.plot, &branches, &tables)
    }
}

/// Returns an error if a plot uses a column that no branch and no sweep has.
fn require_columns(
    plot: &Plot,
    branches: &[Branch],
    tables: &[SweepTable],
) -> Result<(), SceneError> {
    let Plot { x, y, panels, swept, logarithmic, .. } = plot;
    let pairs = panels.iter().chain(swept).flat_map(|(x, y)| [x, y]);
    let has = |name: &str| {
        branches.iter().any(|branch| !branch.columns_showing(name).is_empty())
            || tables.iter().any(|table| table.has_column(name))
    };
    let mut names = x.iter().chain(y).chain(logarithmic).chain(pairs);
    let Some(name) = names.find(|name| !has(name)) else { return Ok(()) };
    let of_branches =
        branches.iter().flat_map(|branch| branch.parameters.iter().chain(&branch.monitors));
    let of_tables =
        tables.iter().flat_map(|table| table.run_columns.iter().chain(&table.point_columns));
    let known = distinct(of_branches.chain(of_tables));
    Err(FigureError::NoColumn(UnknownName::new("column", name, known)).into())
}

impl Resolved {
    /// Returns a branch without points but with all columns that the branch of the run may have;
    /// `None` if the columns are not known yet.
    fn untraced(&self) -> Option<Branch> {
        let run = &self.run;
        let own = match (&run.local, run.along.is_empty()) {
            (None, false) => self.system().ok()?.names().clone(),
            (None, true) => {
                let names = Names::new([""; 0], self.problem.parameter_names());
                names.with_monitors(history_columns(&self.motion().ok()?.modes()))
            }
            (Some(local), _) => {
                let coordinates = coordinates(&self.motion().ok()?.modes());
                let names = Names::new([""; 0], &local.parameters);
                names.with_monitors(LocalOrbit::columns(&coordinates))
            }
        };
        let mut monitors = own.monitors;
        let guards = self.motion().is_ok_and(|motion| !motion.guards().is_empty());
        // The events of an orbit are known only if the start determines them.
        let begins = !matches!(run.start, Start::Rest | Start::Guess(_) | Start::Profile(_));
        let further = GRAZINGS.iter().map(ToString::to_string).filter(|_| guards && begins);
        let missing: Vec<String> = further.filter(|name| !monitors.contains(name)).collect();
        monitors.extend(missing);
        let made = run.hold.and_then(|kind| catalogue::row_of(kind)?.seen.first()?.defined_by);
        monitors.extend(made.iter().flat_map(|make| make(0).names()).map(ToString::to_string));
        Some(Branch {
            name: run.name.clone(),
            condition: run.hold,
            itinerary: String::new(),
            method: String::new(),
            unknowns: own.unknowns,
            parameters: own.parameters,
            released: run.along.iter().map(|range| range.name.clone()).collect(),
            monitors,
            points: Vec::new(),
            special: Vec::new(),
            stretches: Vec::new(),
            ends: [End::Start, End::Start],
            warnings: Vec::new(),
            settings: self.settings.clone(),
        })
    }
}

impl Resolved {
    /// Returns a copy of the run, and a list of names: the copy lacks the bounds and marks of
    /// columns that exist only for the other kind of solution (orbits have a `period`, equilibria
    /// do not), and the list contains the names of these columns.
    pub(super) fn without_idle(&self) -> (Resolved, Vec<String>) {
        let idle = self.idle_columns().unwrap_or_default();
        let mut resolved = self.clone();
        resolved.run.bounds.retain(|bound| !idle.contains(&bound.name));
        resolved.run.marks.retain(|(name, _)| !idle.contains(name));
        (resolved, idle)
    }

    fn idle_columns(&self) -> Option<Vec<String>> {
        let marked = self.run.marks.iter().map(|(name, _)| name);
        let stated: Vec<&String> =
            self.run.bounds.iter().map(|bound| &bound.name).chain(marked).collect();
        if stated.is_empty() {
            return None;
        }
        let mut other = self.clone();
        other.problem.follow(self.problem.solution()?.other());
        // Forced systems do not have equilibria.
        let (own, other) = (self.untraced()?, other.untraced()?);
        let shows = |branch: &Branch, name: &str| !branch.columns_showing(name).is_empty();
        let idle = stated.into_iter().filter(|name| !shows(&own, name) && shows(&other, name));
        Some(idle.cloned().collect())
    }
}

impl ResolvedSweep {
    /// Returns a table of results without rows but with all columns that the sweep may have; `None`
    /// if the columns are not known yet.
    fn undone(&self) -> Option<SweepTable> {
        let motion = self.motion().ok()?;
        let mut modes = motion.modes();
        let mut events: Vec<String> = motion.guards().into_iter().map(|guard| guard.name).collect();
        if self.sweep.local.is_some() {
            modes.push(Mode::new("map", coordinates(&modes)));
            events.push(Iterated::EVENT.into());
        }
        let layout = Layout { modes, events, measures: self.sweep.measures.clone() };
        Some(self.table(0, &layout))
    }
}

/// Returns the names of all coordinates that a local map may have.
fn coordinates(modes: &[Mode]) -> Vec<String> {
    let states = distinct(modes.iter().flat_map(|mode| &mode.states)).into_iter();
    states.map(String::from).chain([PHASE.to_string()]).collect()
}

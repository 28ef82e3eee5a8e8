//! Sweeps of a scene: what motions settle on, over parameters and starts.

use super::execute::map_of;
use super::problem::Swept;
use super::simulate::at_rest;
use super::{Local, Scene, SceneError};
use crate::core::attractor::{
    AttractorSearch, CrisisSearch, Layout, StroboscopicError, StroboscopicMap,
};
use crate::core::grazing::{Iterated, LocalMap};
use crate::core::hybrid::Mode;
use crate::core::names::UnknownName;
use crate::core::sweep::{self, Axis, Found, Make, Order, Part, Plan, Quantity};
use crate::output::{SweepTable, Sweeps};
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;
use std::ops::ControlFlow;

/// One sweep.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Sweep {
    /// Its name.
    pub name: String,
    /// What differs from the scene, as `--set` would: parameters by name.
    #[serde(default)]
    pub set: Vec<(String, String)>,
    /// The local map near a grazing that is iterated, in place of motion. Its states are deviations from the
    /// grazing.
    #[serde(default)]
    pub local: Option<Local>,
    /// The parameters, or states in which motion begins, that vary; the last one varies fastest.
    pub over: Vec<Grid>,
    /// Where runs begin.
    #[serde(default)]
    pub order: Order,
    /// In how many strands, each from its start, the axis is divided where runs follow each other: they are done
    /// at the same time.
    #[serde(default = "one")]
    pub strands: usize,
    /// The states in which motion begins by name, where they are not zero: each makes a sweep of its own. By default
    /// one, at rest.
    #[serde(default)]
    pub starts: Vec<Vec<(String, f64)>>,
    /// How runs are followed.
    #[serde(default)]
    pub search: AttractorSearch,
    /// Where each run seeks the crisis in which its attractor is lost.
    #[serde(default)]
    pub crisis: Option<SoughtCrisis>,
    /// What is measured in every period recorded, by the names of the problem's monitors.
    #[serde(default)]
    pub measures: Vec<String>,
    /// The tolerance of the flow, absolute and relative.
    #[serde(default = "flow_error")]
    pub flow_error: f64,
}

fn one() -> usize {
    1
}

fn flow_error() -> f64 {
    1e-10
}

/// Equally spaced values.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Grid {
    /// The parameter or state.
    pub name: String,
    /// The first value.
    pub low: f64,
    /// The last value.
    pub high: f64,
    /// How many.
    pub count: usize,
}

/// Where a crisis is sought ([`CrisisSearch`]).
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct SoughtCrisis {
    /// The parameter that goes on.
    pub name: String,
    /// From where on.
    pub from: f64,
    /// Where to.
    pub to: f64,
    /// In how many steps.
    #[serde(default = "one")]
    pub steps: usize,
    /// How long the interval may be in which the crisis is.
    pub tolerance: f64,
}

impl SoughtCrisis {
    fn among(&self, parameters: &[(String, Option<f64>)]) -> Result<CrisisSearch, UnknownName> {
        let &SoughtCrisis { ref name, from, to, steps, tolerance } = self;
        let parameter = parameters.iter().position(|(known, _)| known == name);
        let known = parameters.iter().map(|(name, _)| name.as_str());
        let parameter =
            parameter.ok_or_else(|| UnknownName::new("parameter", name.as_str(), known))?;
        Ok(CrisisSearch { parameter, between: [from, to], steps, tolerance })
    }
}

/// Sees the runs of sweeps.
pub trait SweepWatch {
    /// A sweep begins, of which so many runs are done.
    fn begin(&mut self, _sweep: &SweepTable) {}

    /// A run is done, and is the last of what is known now. The sweeps may be ended.
    fn found(&mut self, _known: &Sweeps, _found: &Found) -> ControlFlow<()> {
        ControlFlow::Continue(())
    }
}

impl SweepWatch for () {}

impl Scene {
    /// The scene in words, with all that was set: what results are known by.
    pub fn in_words(&self) -> String {
        ron::to_string(self).unwrap_or_default()
    }

    fn plan(&self, sweep: &Sweep, mode: &Mode) -> Result<Plan, SceneError> {
        let parameters = self.problem.parameters();
        let states = &mode.states;
        let axis = |grid: &Grid| {
            let parameter = parameters.iter().position(|(name, _)| *name == grid.name);
            let state = || states.iter().position(|name| *name == grid.name).map(Quantity::State);
            let quantity = parameter.map(Quantity::Parameter).or_else(state);
            let known = parameters.iter().map(|(name, _)| name).chain(states).map(String::as_str);
            let quantity = quantity
                .ok_or_else(|| UnknownName::new("parameter or state", &*grid.name, known))?;
            let &Grid { low, high, count, .. } = grid;
            Ok::<Axis, UnknownName>(Axis { quantity, low, high, count })
        };
        let axes = sweep.over.iter().map(axis).collect::<Result<_, _>>()?;
        let starts = match sweep.starts.is_empty() {
            true => vec![at_rest(mode, &[])?],
            false => {
                let starts = sweep.starts.iter().map(|state| at_rest(mode, state));
                starts.collect::<Result<_, _>>()?
            }
        };
        let crisis = sweep.crisis.as_ref().map(|sought| sought.among(&parameters)).transpose()?;
        let Sweep { order, strands, search, .. } = *sweep;
        let plan = Plan { axes, starts, order, strands, search, crisis };
        plan.check()?;
        Ok(plan)
    }
}

/// Does the sweeps of a scene, or a part of them, but for the runs that are known.
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
/// [`SceneError`] if a sweep has no meaning, or what is known belongs to another scene.
pub fn sweep(
    scene: &Scene,
    name: &str,
    part: Part,
    known: Option<Sweeps>,
    watch: &mut dyn SweepWatch,
) -> Result<Sweeps, SceneError> {
    let prepared = scene.sweeps.iter().map(|sweep| Prepared::of(scene, sweep));
    let prepared: Vec<Prepared> = prepared.collect::<Result<_, _>>()?;
    let mut all = match known {
        Some(known) if known.scene == scene.in_words() => known,
        Some(_) => return Err(SceneError::OtherScene),
        None => Sweeps {
            name: name.into(),
            title: scene.title.clone(),
            scene: scene.in_words(),
            plot: scene.plot.clone(),
            sweeps: prepared.iter().map(Prepared::table).collect(),
        },
    };
    for (index, one) in prepared.iter().enumerate() {
        if one.execute(part, &mut all, index, watch)?.is_break() {
            break;
        }
    }
    Ok(all)
}

/// What a sweep looks at once in every period: the problem's motion, or a local map.
fn strobed<'a>(
    sweep: &Sweep,
    seen: &'a Scene,
    motions: &'a dyn Swept,
    map: Option<&LocalMap>,
) -> Result<Box<dyn StroboscopicMap + 'a>, StroboscopicError> {
    let Some(map) = map else { return motions.strobed(&sweep.measures, sweep.flow_error) };
    let names: Vec<String> = seen.problem.parameters().into_iter().map(|(name, _)| name).collect();
    let iterated = Iterated::of(map.clone(), &names, &sweep.measures);
    Ok(Box::new(iterated.map_err(|cause| StroboscopicError::Map(cause.to_string()))?))
}

/// A sweep about to be done.
struct Prepared<'a> {
    sweep: &'a Sweep,
    /// The scene as the sweep sees it.
    seen: Scene,
    /// The local map, if that is iterated.
    map: Option<LocalMap>,
    layout: Layout,
    plan: Plan,
}

impl<'a> Prepared<'a> {
    fn of(scene: &Scene, sweep: &'a Sweep) -> Result<Self, SceneError> {
        let seen = scene.with(&sweep.set)?;
        let motions = seen.problem.entry().swept()?;
        let map = sweep.local.as_ref().map(|local| map_of(scene, &seen, &sweep.name, local));
        let map = map.transpose()?;
        let layout = strobed(sweep, &seen, motions, map.as_ref())?.layout().clone();
        let plan = seen.plan(sweep, &layout.modes[0])?;
        Ok(Prepared { sweep, seen, map, layout, plan })
    }

    /// The sweep, of which nothing is done.
    fn table(&self) -> SweepTable {
        let axes: Vec<String> = self.sweep.over.iter().map(|grid| grid.name.clone()).collect();
        let crisis = self.sweep.crisis.as_ref().map(|sought| sought.name.as_str());
        SweepTable::new(&self.sweep.name, (&axes, crisis), self.plan.runs(), &self.layout)
    }

    /// Does the runs that are not known.
    fn execute(
        &self,
        part: Part,
        all: &mut Sweeps,
        index: usize,
        watch: &mut dyn SweepWatch,
    ) -> Result<ControlFlow<()>, SceneError> {
        let Prepared { sweep, seen, map, layout, plan } = self;
        let (table, modes) = (&all.sweeps[index], &layout.modes);
        watch.begin(table);
        let end = |run: &usize| Some((*run, table.end(*run, plan.starts[0].time, modes)?));
        let ends: BTreeMap<usize, _> = table.rows.keys().filter_map(end).collect();
        let motions = seen.problem.entry().swept()?;
        let make: &Make = &|| strobed(sweep, seen, motions, map.as_ref());
        let mut outcome = ControlFlow::Continue(());
        let done = |run: usize| ends.get(&run).cloned();
        sweep::execute(plan, part, &seen.values()?, make, &done, &mut |found: Found| {
            all.sweeps[index].push(&found, plan.start(found.run), modes);
            outcome = watch.found(all, &found);
            outcome
        })?;
        Ok(outcome)
    }
}

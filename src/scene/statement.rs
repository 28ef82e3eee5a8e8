//! What a scene states: runs and sweeps of a problem.

use super::local::Local;
use super::notation::{value, values};
use super::problem::Problem;
use super::profile::Profile;
use super::simulate::Simulated;
use crate::core::attractor::{AttractorSearch, CrisisSearch};
use crate::core::continuation::Settings;
use crate::core::problem::{UnknownName, position};
use crate::core::sweep::Order;
use crate::core::system::Kind;
use crate::output::Plot;
use serde::{Deserialize, Serialize};

/// A scene: a problem, its runs and sweeps, and their pictures.
///
/// [`Catalogue::parse`](super::Catalogue::parse) reads a scene from RON: first with the text of its
/// problem, `P`, which the catalogue then replaces by the [`Problem`] of that name.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Scene<P = Problem> {
    /// The title of its diagram.
    pub title: String,
    /// The subject in one line, for lists of scenes.
    #[serde(skip_serializing_if = "is_default")]
    pub summary: Option<String>,
    /// The problem and its terms.
    #[serde(default)]
    pub problem: P,
    /// The file that states the problem's equations, in place of `problem`; `None` once it has been
    /// read.
    #[serde(default, skip_serializing)]
    pub model: Option<String>,
    /// Values of parameters at the start, where they differ from the problem's defaults; all of
    /// them, if it has none. A value may be a formula of numbers, `"8/3"`.
    #[serde(default, deserialize_with = "values", skip_serializing_if = "is_default")]
    pub parameters: Vec<(String, f64)>,
    /// The wanted relative error of special points, or of ends at bounds where a scene has no others: of
    /// the parameters that vary along their branch, and of the columns that the setting `refine` names.
    /// An end that matters is stated by `marks`. The cheapest
    /// orders, modes, meshes or tolerances that meet it are chosen, in place of stated ones, and
    /// special points are not refined on others.
    #[serde(skip_serializing_if = "is_default")]
    pub accuracy: Option<f64>,
    /// Settings of the continuation.
    #[serde(default, skip_serializing_if = "is_default")]
    pub settings: Settings,
    /// How the branches are drawn.
    #[serde(default, skip_serializing_if = "is_default")]
    pub plot: Plot,
    /// The runs to be traced, in this order.
    #[serde(default, skip_serializing_if = "is_default")]
    pub runs: Vec<Run>,
    /// The sweeps, in this order.
    #[serde(default, skip_serializing_if = "is_default")]
    pub sweeps: Vec<Sweep>,
}

/// One branch or curve of events.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Run {
    /// The branch's name.
    pub name: String,
    /// The differences from the scene, as `--set` gives them: parameters and settings by name.
    #[serde(default, skip_serializing_if = "is_default")]
    pub set: Vec<(String, String)>,
    /// Where it starts.
    #[serde(default, skip_serializing_if = "is_default")]
    pub start: Start,
    /// The local map near a grazing of which fixed or periodic points are followed, in place of
    /// orbits of the flow.
    #[serde(skip_serializing_if = "is_default")]
    pub local: Option<Local>,
    /// Whether each iterate of a point of the local map impacts: none, of fixed points before the
    /// surface. A start from another run goes on with its iterates.
    #[serde(default, skip_serializing_if = "is_default")]
    pub impacts: Vec<bool>,
    /// The curve of folds (`LP`) or period doublings (`PD`) that begins at the grazing of the local
    /// map, by its Taylor series to the map's order, in place of points of the map: released is one
    /// of its two parameters.
    #[serde(skip_serializing_if = "is_default")]
    pub expanded: Option<Kind>,
    /// The kind of special point that is held along the curve, where it is a curve of events.
    #[serde(skip_serializing_if = "is_default")]
    pub hold: Option<Kind>,
    /// The parameter or monitor that is held at a level along the curve, where it is a curve of
    /// marks.
    #[serde(skip_serializing_if = "is_default")]
    pub hold_level: Option<(String, f64)>,
    /// The parameters that are released, the continued one first, with their ranges. A simulation
    /// that releases none is kept as a history.
    #[serde(default, skip_serializing_if = "is_default")]
    pub along: Vec<Range>,
    /// Bounds of parameters and monitors, where the branch ends.
    #[serde(default, skip_serializing_if = "is_default")]
    pub bounds: Vec<Range>,
    /// Values of parameters and monitors that are marked.
    #[serde(default, deserialize_with = "values", skip_serializing_if = "is_default")]
    pub marks: Vec<(String, f64)>,
    /// Values of monitors at which a solution touches something, marked as grazings (`G`). The
    /// branch goes on behind them, as if nothing were touched.
    #[serde(default, deserialize_with = "values", skip_serializing_if = "is_default")]
    pub grazings: Vec<(String, f64)>,
    /// Whether the branch goes on where solutions graze, and pass through surfaces beyond: virtual
    /// ones.
    #[serde(default, skip_serializing_if = "is_default")]
    pub beyond_grazings: bool,
    /// Which way it is traced.
    #[serde(default, skip_serializing_if = "is_default")]
    pub direction: Way,
    /// Whether the branch is kept: a run that only leads to the start of others is not.
    #[serde(default = "yes", skip_serializing_if = "is_yes")]
    pub shown: bool,
}

fn yes() -> bool {
    true
}

fn is_yes(value: &bool) -> bool {
    *value
}

fn is_default<T: Default + PartialEq>(value: &T) -> bool {
    *value == T::default()
}

impl Run {
    /// A run from rest, both ways.
    pub fn along(name: &str, along: Vec<Range>) -> Self {
        Run {
            name: name.into(),
            set: Vec::new(),
            start: Start::Rest,
            local: None,
            impacts: Vec::new(),
            expanded: None,
            hold: None,
            hold_level: None,
            along,
            bounds: Vec::new(),
            marks: Vec::new(),
            grazings: Vec::new(),
            beyond_grazings: false,
            direction: Way::Both,
            shown: true,
        }
    }
}

/// A range; an end that is not given is open. An end may be a formula of numbers, `"8/3"`.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Range {
    /// The parameter or monitor.
    pub name: String,
    /// The lower end.
    #[serde(default, deserialize_with = "value", skip_serializing_if = "is_default")]
    pub low: Option<f64>,
    /// The upper end.
    #[serde(default, deserialize_with = "value", skip_serializing_if = "is_default")]
    pub high: Option<f64>,
}

impl Range {
    /// The range as numbers, open ends being infinite.
    pub fn interval(&self) -> std::ops::RangeInclusive<f64> {
        self.low.unwrap_or(f64::NEG_INFINITY)..=self.high.unwrap_or(f64::INFINITY)
    }

    /// The number in the range that is nearest to this one.
    pub(super) fn nearest(&self, value: f64) -> f64 {
        let interval = self.interval();
        value.min(*interval.end()).max(*interval.start())
    }
}

/// Where a run starts.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
#[non_exhaustive]
pub enum Start {
    /// At rest: all unknowns zero.
    #[default]
    Rest,
    /// Near a guess: values of unknowns by name. The others have their initial value, or are zero.
    Guess(#[serde(deserialize_with = "values")] Vec<(String, f64)>),
    /// Near a profile given as a table, for boundary-value problems.
    Profile(Profile),
    /// At the periodic motion on which a simulation settles; or, where no parameter is
    /// released, the simulated history itself.
    Simulated(Simulated),
    /// At a special point of an earlier run.
    From {
        /// The run.
        run: String,
        /// The kind of special point.
        kind: Kind,
        /// Which one of that kind, in the order of the branch, from 0.
        #[serde(default)]
        nth: usize,
        /// Whether to leave it along the other branch.
        #[serde(default)]
        switch: bool,
        /// Along which one, where several others cross or begin there, from 0.
        #[serde(default)]
        which: usize,
        /// Whether to start there although it has not converged.
        #[serde(default)]
        unconverged: bool,
    },
}

/// Which way a branch is traced from its start.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Way {
    /// Both ways.
    #[default]
    Both,
    /// The way in which the parameter released last grows.
    Forward,
    /// The way in which it falls.
    Backward,
}

/// One sweep.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Sweep {
    /// Its name.
    pub name: String,
    /// The differences from the scene, as `--set` gives them: parameters by name.
    #[serde(default)]
    pub set: Vec<(String, String)>,
    /// The local map near a grazing that is iterated, in place of motion. Its states are deviations
    /// from the grazing.
    pub local: Option<Local>,
    /// The event just after which motion is sampled, of a hybrid system without forcing. Periods
    /// are returns to it then.
    #[serde(default)]
    pub at: Option<String>,
    /// The parameters, or states in which motion begins, that vary; the last one varies fastest.
    pub over: Vec<Grid>,
    /// Where runs begin.
    #[serde(default)]
    pub order: Order,
    /// In how many strands, each from its start, the axis is divided where runs follow each other:
    /// they are done at the same time.
    #[serde(default = "one")]
    pub strands: usize,
    /// The states in which motion begins by name, where they are not zero: each makes a sweep of
    /// its own. By default one, at rest.
    #[serde(default)]
    pub starts: Vec<Vec<(String, f64)>>,
    /// How runs are followed.
    #[serde(default)]
    pub search: AttractorSearch,
    /// Where each run seeks the crisis in which its attractor is lost.
    pub crisis: Option<SoughtCrisis>,
    /// The measures of every recorded period, by the names of the problem's monitors.
    #[serde(default)]
    pub measures: Vec<String>,
    /// The tolerance of the flow, absolute and relative.
    #[serde(default = "flow_tolerance")]
    pub flow_tolerance: f64,
}

impl Sweep {
    /// A sweep over some values, anew at each of them from rest.
    pub(super) fn over(name: &str, over: Vec<Grid>) -> Self {
        Sweep {
            name: name.into(),
            set: Vec::new(),
            local: None,
            at: None,
            over,
            order: Order::Anew,
            strands: one(),
            starts: Vec::new(),
            search: AttractorSearch::default(),
            crisis: None,
            measures: Vec::new(),
            flow_tolerance: flow_tolerance(),
        }
    }
}

fn one() -> usize {
    1
}

fn flow_tolerance() -> f64 {
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
    pub(super) fn among(&self, parameters: &[String]) -> Result<CrisisSearch, UnknownName> {
        let &SoughtCrisis { ref name, from, to, steps, tolerance } = self;
        let parameter = position("parameter", name, parameters)?;
        Ok(CrisisSearch { parameter, between: [from, to], steps, tolerance })
    }
}

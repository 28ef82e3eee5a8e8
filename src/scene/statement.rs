//! The statement of a scene: runs and sweeps of a problem.

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

/// A scene: a problem, its runs and sweeps, and their plots.
///
/// [`Catalogue::parse`](super::Catalogue::parse) reads a scene from RON: first with the text of its
/// problem, `P`, which the catalogue then replaces by the named [`Problem`].
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
    /// The initial values of parameters that differ from the problem's defaults; of all parameters,
    /// if there are no defaults. A value may be a formula of numbers, such as `"8/3"`.
    #[serde(default, deserialize_with = "values", skip_serializing_if = "is_default")]
    pub parameters: Vec<(String, f64)>,
    /// The requested relative error of special points, or of ends at bounds in scenes without other
    /// special points. The error applies to the parameters that vary along the branch, and to the
    /// columns that the setting `refine` names. An important end can be stated in `marks`. The
    /// cheapest orders, modes, meshes or tolerances that meet the accuracy are chosen, in place of
    /// stated ones, and special points are not refined further.
    #[serde(skip_serializing_if = "is_default")]
    pub accuracy: Option<f64>,
    /// Settings of the continuation.
    #[serde(default, skip_serializing_if = "is_default")]
    pub settings: Settings,
    /// The plot of the branches.
    #[serde(default, skip_serializing_if = "is_default")]
    pub plot: Plot,
    /// The runs to trace, in order.
    #[serde(default, skip_serializing_if = "is_default")]
    pub runs: Vec<Run>,
    /// The sweeps, in order.
    #[serde(default, skip_serializing_if = "is_default")]
    pub sweeps: Vec<Sweep>,
}

/// One branch, or one curve of special points.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Run {
    /// The name of the branch.
    pub name: String,
    /// The differences from the scene, as for `--set`: parameters and settings by name.
    #[serde(default, skip_serializing_if = "is_default")]
    pub set: Vec<(String, String)>,
    /// The start of the branch.
    #[serde(default, skip_serializing_if = "is_default")]
    pub start: Start,
    /// The local map near a grazing whose fixed or periodic points are traced, in place of orbits
    /// of the flow.
    #[serde(skip_serializing_if = "is_default")]
    pub local: Option<Local>,
    /// Whether each iterate of a point of the local map impacts; by default one iterate without
    /// impact. A start from another run keeps the iterates of that run.
    #[serde(default, skip_serializing_if = "is_default")]
    pub impacts: Vec<bool>,
    /// The curve of folds (`LP`) or period doublings (`PD`) that emanates from the grazing of the
    /// local map, as a Taylor series to the map's order, in place of points of the map. One of the
    /// map's two parameters is varied.
    #[serde(skip_serializing_if = "is_default")]
    pub expanded: Option<Kind>,
    /// The kind of special point that is held along a curve of special points.
    #[serde(skip_serializing_if = "is_default")]
    pub hold: Option<Kind>,
    /// The parameter or monitor that is held at a level along a curve of marks.
    #[serde(skip_serializing_if = "is_default")]
    pub hold_level: Option<(String, f64)>,
    /// The varied parameters with their ranges, the continuation parameter first. A simulation
    /// without varied parameters is kept as a history.
    #[serde(default, skip_serializing_if = "is_default")]
    pub along: Vec<Range>,
    /// Bounds of parameters and monitors, at which the branch ends.
    #[serde(default, skip_serializing_if = "is_default")]
    pub bounds: Vec<Range>,
    /// Values of parameters and monitors at which the branch is marked.
    #[serde(default, deserialize_with = "values", skip_serializing_if = "is_default")]
    pub marks: Vec<(String, f64)>,
    /// Values of monitors at which a solution touches a surface, marked as grazings (`G`). The
    /// branch continues beyond them, ignoring the contact.
    #[serde(default, deserialize_with = "values", skip_serializing_if = "is_default")]
    pub grazings: Vec<(String, f64)>,
    /// Whether the branch continues beyond grazings with virtual solutions, which pass through
    /// surfaces.
    #[serde(default, skip_serializing_if = "is_default")]
    pub beyond_grazings: bool,
    /// The direction of the trace.
    #[serde(default, skip_serializing_if = "is_default")]
    pub direction: Way,
    /// Whether the branch is kept; false for a run that only provides the start of others.
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
    /// Creates a run from rest, in both directions.
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

/// A range; an omitted end is open. An end may be a formula of numbers, such as `"8/3"`.
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
    /// Returns the usual range of a parameter with a given value: from zero to twice the value, or
    /// from −1 to 1.
    ///
    /// ```
    /// use tangency::scene::Range;
    /// let ends = |value| Range::usual("a", value).interval().into_inner();
    /// assert_eq!((ends(3.0), ends(-1.0), ends(0.0)), ((0.0, 6.0), (-2.0, 0.0), (-1.0, 1.0)));
    /// ```
    pub fn usual(name: impl Into<String>, value: f64) -> Self {
        let [low, high] = match 2.0 * value {
            0.0 => [-1.0, 1.0],
            twice => [twice.min(0.0), twice.max(0.0)],
        };
        Range { name: name.into(), low: Some(low), high: Some(high) }
    }

    /// Returns the range as numbers; open ends are infinite.
    pub fn interval(&self) -> std::ops::RangeInclusive<f64> {
        self.low.unwrap_or(f64::NEG_INFINITY)..=self.high.unwrap_or(f64::INFINITY)
    }

    /// Returns the number in the range that is nearest to `value`.
    pub(super) fn nearest(&self, value: f64) -> f64 {
        let interval = self.interval();
        value.min(*interval.end()).max(*interval.start())
    }
}

/// The start of a run.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
#[non_exhaustive]
pub enum Start {
    /// At rest: all unknowns are zero.
    #[default]
    Rest,
    /// Near a guess: values of unknowns by name. The others have their initial value, or are zero.
    Guess(#[serde(deserialize_with = "values")] Vec<(String, f64)>),
    /// Near a profile given as a table, for boundary-value problems.
    Profile(Profile),
    /// At the periodic motion to which a simulation converges; without varied parameters, the
    /// simulated history itself.
    Simulated(Simulated),
    /// At a special point of an earlier run.
    From {
        /// The name of the earlier run.
        run: String,
        /// The kind of special point.
        kind: Kind,
        /// The index of the special point among its kind, in the order of the branch, from 0.
        #[serde(default)]
        nth: usize,
        /// Whether to leave the special point along the other branch.
        #[serde(default)]
        switch: bool,
        /// The index of the branch to take, if several others cross or emanate there, from 0.
        #[serde(default)]
        which: usize,
        /// Whether to start there even if the special point has not converged.
        #[serde(default)]
        unconverged: bool,
    },
}

/// The direction in which a branch is traced from its start.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Way {
    /// Both directions.
    #[default]
    Both,
    /// The direction in which the last varied parameter increases.
    Forward,
    /// The direction in which the last varied parameter decreases.
    Backward,
}

/// One sweep.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Sweep {
    /// The name of the sweep.
    pub name: String,
    /// The differences from the scene, as for `--set`: parameters by name.
    #[serde(default)]
    pub set: Vec<(String, String)>,
    /// The local map near a grazing to iterate, in place of motion. Its states are deviations from
    /// the grazing.
    pub local: Option<Local>,
    /// The event at which a hybrid system without forcing is sampled, just after the event. Periods
    /// are then returns to the event.
    #[serde(default)]
    pub at: Option<String>,
    /// The parameters or initial states to vary; the last one varies fastest.
    pub over: Vec<Grid>,
    /// The order of the runs, which determines their initial states.
    #[serde(default)]
    pub order: Order,
    /// The number of parallel strands into which the axis is divided if each run starts at the end
    /// of the previous one. Each strand begins at the initial state.
    #[serde(default = "one")]
    pub strands: usize,
    /// The initial states by name; others are zero. Each entry makes a separate sweep. By default
    /// one sweep, from rest.
    #[serde(default)]
    pub starts: Vec<Vec<(String, f64)>>,
    /// The settings of the search for attractors.
    #[serde(default)]
    pub search: AttractorSearch,
    /// The search for the crisis at which the attractor of each run is lost.
    pub crisis: Option<SoughtCrisis>,
    /// The measures of every recorded period, by the names of the problem's monitors.
    #[serde(default)]
    pub measures: Vec<String>,
    /// The tolerance of the flow, absolute and relative.
    #[serde(default = "flow_tolerance")]
    pub flow_tolerance: f64,
}

impl Sweep {
    /// Creates a sweep over some values, with every run starting from rest.
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
    /// The number of values.
    pub count: usize,
}

/// The parameter and range of the search for a crisis ([`CrisisSearch`]).
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct SoughtCrisis {
    /// The parameter to vary.
    pub name: String,
    /// The first value of the parameter.
    pub from: f64,
    /// The last value of the parameter.
    pub to: f64,
    /// The number of steps.
    #[serde(default = "one")]
    pub steps: usize,
    /// The maximum length of the final interval that contains the crisis.
    pub tolerance: f64,
}

impl SoughtCrisis {
    pub(super) fn among(&self, parameters: &[String]) -> Result<CrisisSearch, UnknownName> {
        let &SoughtCrisis { ref name, from, to, steps, tolerance } = self;
        let parameter = position("parameter", name, parameters)?;
        Ok(CrisisSearch { parameter, between: [from, to], steps, tolerance })
    }
}

//! The contents of a scene file: the runs and sweeps of a problem.

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

/// A scene, which consists of a problem, its runs and sweeps, and the plot of their results.
///
/// [`Catalogue::parse`](super::Catalogue::parse) reads a scene from RON in two steps: in the first
/// step, the type `P` of the problem is a text, and in the second step the catalogue replaces this
/// text by the [`Problem`] that the text names.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Scene<P = Problem> {
    /// The title of the scene's diagram.
    pub title: String,
    /// The subject of the scene in one line, which lists of scenes show.
    #[serde(skip_serializing_if = "is_default")]
    pub summary: Option<String>,
    /// The problem of the scene, with its settings.
    #[serde(default)]
    pub problem: P,
    /// The file that contains the equations of the problem, if it is given instead of `problem`;
    /// `None` after the file has been read.
    #[serde(default, skip_serializing)]
    pub model: Option<String>,
    /// The initial values of those parameters whose initial values differ from the problem's
    /// default values; for a problem without default values, the initial values of all parameters.
    /// The value of a parameter may be a formula of numbers, such as `"8/3"`.
    #[serde(default, deserialize_with = "values", skip_serializing_if = "is_default")]
    pub parameters: Vec<(String, f64)>,
    /// The requested relative error of special points; if a scene has no special points other than
    /// ends of branches, the requested relative error of ends at bounds. The requested error
    /// applies to the parameters that vary along the branch, and to the columns that the setting
    /// `refine` names. To apply the requested error to an important end of a branch, state the end
    /// in `marks`. The cheapest discretisation that reaches the accuracy is chosen automatically:
    /// the numbers of basis functions or modes of a plate, the mesh of collocation, or the
    /// tolerance of shooting. The chosen settings replace the stated settings, and special points
    /// are not refined further.
    #[serde(skip_serializing_if = "is_default")]
    pub accuracy: Option<f64>,
    /// The settings of the continuation.
    #[serde(default, skip_serializing_if = "is_default")]
    pub settings: Settings,
    /// The plot of the branches.
    #[serde(default, skip_serializing_if = "is_default")]
    pub plot: Plot,
    /// The runs to trace, in the order of execution.
    #[serde(default, skip_serializing_if = "is_default")]
    pub runs: Vec<Run>,
    /// The sweeps, in the order of execution.
    #[serde(default, skip_serializing_if = "is_default")]
    pub sweeps: Vec<Sweep>,
}

/// A run, which traces one branch or one curve of special points.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Run {
    /// The name of the run, which is also the name of its branch.
    pub name: String,
    /// The parameters and settings that have other values in this run than in the scene, by name,
    /// as for the option `--set`.
    #[serde(default, skip_serializing_if = "is_default")]
    pub set: Vec<(String, String)>,
    /// The start of the branch, for example a guess or a special point of an earlier run.
    #[serde(default, skip_serializing_if = "is_default")]
    pub start: Start,
    /// The local map near a grazing whose fixed or periodic points the run traces instead of orbits
    /// of the flow.
    #[serde(skip_serializing_if = "is_default")]
    pub local: Option<Local>,
    /// For each iterate of a periodic point of the local map, whether the iterate impacts; the
    /// default is one iterate without impact. A run that starts from another run of a local map has
    /// the same number of iterates and the same impacts as that run.
    #[serde(default, skip_serializing_if = "is_default")]
    pub impacts: Vec<bool>,
    /// The kind of a curve, folds (`LP`) or period doublings (`PD`), that emanates from the grazing
    /// of the local map. If a kind is given, the run traces the Taylor series of this curve, up to
    /// the order of the map, instead of points of the map. Along the Taylor series of such a curve,
    /// the run varies one of the two parameters of the local map.
    #[serde(skip_serializing_if = "is_default")]
    pub expanded: Option<Kind>,
    /// The kind of special point, if the run traces a curve of special points; all points of the
    /// curve are of this kind.
    #[serde(skip_serializing_if = "is_default")]
    pub hold: Option<Kind>,
    /// The parameter or monitor that has a constant value along the curve, if the run traces a
    /// curve of marked points.
    #[serde(skip_serializing_if = "is_default")]
    pub hold_level: Option<(String, f64)>,
    /// The varied parameters with their ranges, the continuation parameter first. If a simulation
    /// has no varied parameters, it is saved as a history.
    #[serde(default, skip_serializing_if = "is_default")]
    pub along: Vec<Range>,
    /// The bounds of parameters and monitors at which the branch ends.
    #[serde(default, skip_serializing_if = "is_default")]
    pub bounds: Vec<Range>,
    /// The values of parameters and monitors at which points of the branch are marked.
    #[serde(default, deserialize_with = "values", skip_serializing_if = "is_default")]
    pub marks: Vec<(String, f64)>,
    /// The values of monitors at which a solution grazes a surface; these points are marked as
    /// grazings (`G`). The branch continues beyond these grazings and ignores the contact.
    #[serde(default, deserialize_with = "values", skip_serializing_if = "is_default")]
    pub grazings: Vec<(String, f64)>,
    /// Whether the branch continues beyond grazings with virtual solutions, that is, with solutions
    /// that cross the surface of an event without the event.
    #[serde(default, skip_serializing_if = "is_default")]
    pub beyond_grazings: bool,
    /// The direction in which the branch is traced.
    #[serde(default, skip_serializing_if = "is_default")]
    pub direction: Way,
    /// Whether the branch is saved and drawn; this is false for a run that only provides the start
    /// of other runs.
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
    /// Creates a run that starts from rest and traces its branch in both directions.
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

/// A range of a parameter or monitor; if an end is omitted, the range is unbounded on this side. An
/// end of a range may be a formula of numbers, such as `"8/3"`.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Range {
    /// The name of the parameter or monitor.
    pub name: String,
    /// The lower end.
    #[serde(default, deserialize_with = "value", skip_serializing_if = "is_default")]
    pub low: Option<f64>,
    /// The upper end.
    #[serde(default, deserialize_with = "value", skip_serializing_if = "is_default")]
    pub high: Option<f64>,
}

impl Range {
    /// Returns the range over which a parameter with a given value is varied by default: from zero
    /// to twice the value, or from −1 to 1 if the value is zero.
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

    /// Returns the ends of the range as numbers; an omitted end is infinite.
    pub fn interval(&self) -> std::ops::RangeInclusive<f64> {
        self.low.unwrap_or(f64::NEG_INFINITY)..=self.high.unwrap_or(f64::INFINITY)
    }

    /// Returns the number in the range that is nearest to `value`.
    pub(super) fn nearest(&self, value: f64) -> f64 {
        let interval = self.interval();
        value.min(*interval.end()).max(*interval.start())
    }
}

/// The start of a run, from which its branch is traced.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
#[non_exhaustive]
pub enum Start {
    /// The run starts at rest: all unknowns are zero.
    #[default]
    Rest,
    /// The run starts near a guess, which gives values of unknowns by name. Unknowns that do not
    /// occur in the guess have their initial value, or are zero.
    Guess(#[serde(deserialize_with = "values")] Vec<(String, f64)>),
    /// The run starts near a profile that is given as a table, for boundary-value problems.
    Profile(Profile),
    /// The run starts at the periodic motion to which a simulation converges; if the run varies no
    /// parameters, its result is the simulated history.
    Simulated(Simulated),
    /// The run starts at a special point of an earlier run.
    From {
        /// The name of the earlier run that found the special point.
        run: String,
        /// The kind of the special point at which the run starts.
        kind: Kind,
        /// The index of the special point among the special points of its kind, in the order of the
        /// branch, counted from 0.
        #[serde(default)]
        nth: usize,
        /// Whether to follow the other branch that passes through the special point.
        #[serde(default)]
        switch: bool,
        /// The index of the branch to follow, counted from 0, if several other branches cross at
        /// the special point or emanate from it.
        #[serde(default)]
        which: usize,
        /// Whether to start at the special point even if it has not converged.
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
    /// Only the direction in which the last varied parameter increases.
    Forward,
    /// Only the direction in which the last varied parameter decreases.
    Backward,
}

/// One sweep.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Sweep {
    /// The name of the sweep.
    pub name: String,
    /// The parameters and settings that have other values in this sweep than in the scene, by name,
    /// as for the option `--set`.
    #[serde(default)]
    pub set: Vec<(String, String)>,
    /// The local map near a grazing, if the sweep iterates a local map instead of simulating the
    /// motion. The states of the local map are deviations from the state at the grazing.
    pub local: Option<Local>,
    /// The event, for a hybrid system without forcing: the motion is sampled just after every
    /// occurrence of this event. For a sweep with such an event, a period is the time between two
    /// successive occurrences of the event.
    #[serde(default)]
    pub at: Option<String>,
    /// The parameters or initial states to vary; the last of them varies fastest.
    pub over: Vec<Grid>,
    /// The order of the runs of the sweep, which determines their initial states.
    #[serde(default)]
    pub order: Order,
    /// The number of independent sequences of runs into which the values on the axis are divided,
    /// if each run starts at the end of the previous run. Each of these sequences begins at the
    /// initial state.
    #[serde(default = "one")]
    pub strands: usize,
    /// The initial states by name; states that are not named are zero. For each entry of the list
    /// of starts, a separate sweep is computed. By default, one sweep is computed, and it starts
    /// from rest.
    #[serde(default)]
    pub starts: Vec<Vec<(String, f64)>>,
    /// The settings of the search for the attractor in each run.
    #[serde(default)]
    pub search: AttractorSearch,
    /// The settings of the search for the crisis at which the attractor of each run disappears.
    pub crisis: Option<SoughtCrisis>,
    /// The measures that are recorded in every period; they are given by the names of the problem's
    /// monitors.
    #[serde(default)]
    pub measures: Vec<String>,
    /// The absolute and relative tolerance with which the motion is integrated.
    #[serde(default = "flow_tolerance")]
    pub flow_tolerance: f64,
}

impl Sweep {
    /// Creates a sweep over some axes, in which every run starts from rest.
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
    /// The name of the parameter or state.
    pub name: String,
    /// The first value.
    pub low: f64,
    /// The last value.
    pub high: f64,
    /// The number of values along the axis.
    pub count: usize,
}

/// The parameter for which a crisis is searched, and the range in which it is searched
/// ([`CrisisSearch`]).
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct SoughtCrisis {
    /// The name of the parameter that is varied to find the crisis.
    pub name: String,
    /// The first value of the varied parameter.
    pub from: f64,
    /// The last value of the varied parameter.
    pub to: f64,
    /// The number of steps between the first and the last value of the parameter.
    #[serde(default = "one")]
    pub steps: usize,
    /// The maximum length of the parameter interval that finally contains the crisis.
    pub tolerance: f64,
}

impl SoughtCrisis {
    pub(super) fn among(&self, parameters: &[String]) -> Result<CrisisSearch, UnknownName> {
        let &SoughtCrisis { ref name, from, to, steps, tolerance } = self;
        let parameter = position("parameter", name, parameters)?;
        Ok(CrisisSearch { parameter, between: [from, to], steps, tolerance })
    }
}

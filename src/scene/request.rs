//! Requests to trace a model that is given without a scene, and requests that change the contents
//! of a scene.

use super::resolve::StartPoint;
use super::statement::{Grid, Range};
use crate::core::cancel::CancelToken;
use crate::core::system::Kind;

/// A request to trace a model that is given without a scene, or a request that changes the contents
/// of a scene; it corresponds to the options of `tangency trace`.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Request {
    /// The changed values, by the names of parameters and settings.
    pub set: Vec<(String, String)>,
    /// The varied parameters with their ranges, the continuation parameter first.
    pub along: Vec<Range>,
    /// The bounds of parameters and monitors.
    pub bounds: Vec<Range>,
    /// The values of parameters and columns at which points of branches are marked.
    pub marks: Vec<(String, f64)>,
    /// The initial states of the first run.
    pub state: Vec<(String, f64)>,
    /// The point of an earlier result at which the branch starts; no start of the branch is then
    /// searched, and changed settings must have an effect on the run that continues from the point.
    pub start: Option<Box<StartPoint>>,
    /// The duration of the simulation that precedes the first run: in periods of the forcing, or in
    /// units of time for a system without forcing.
    pub settle: Option<f64>,
    /// The kind of special point whose curve is traced in all varied parameters of the request; the
    /// curve starts at the first special point of this kind on the first run.
    pub hold: Option<Kind>,
    /// The box in which solutions are searched; the solutions are either the result of the request
    /// or the starts of branches.
    pub within: Option<SearchBox>,
    /// The token that cancels all computations for the request.
    pub cancel: CancelToken,
}

/// A box in the space of unknowns in which solutions are searched.
#[derive(Clone, Debug, PartialEq)]
pub struct SearchBox {
    /// The range of each unknown in the box.
    pub ranges: Vec<Range>,
    /// The number of points from which Newton's method starts.
    pub starts: usize,
}

/// The sweeps that a request computes instead of the scene's own sweeps.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Swept {
    /// The parameters or initial states that the sweep varies. If a single parameter is varied,
    /// each run starts at the end of the previous run and the parameter increases from run to run;
    /// otherwise all runs start from the initial states.
    pub over: Vec<Grid>,
    /// Whether to add a second sweep in which the parameter decreases.
    pub both: bool,
    /// The initial states of the first run of the sweep, by name.
    pub start: Vec<(String, f64)>,
    /// The event just after which a motion without forcing is sampled.
    pub at: Option<String>,
    /// The monitors that the sweep records in every period, such as `max_x`. Pictures show the
    /// first of these monitors, unless the scene's picture names another column.
    pub measures: Vec<String>,
}

//! Plans of sweeps: the list of runs, and the order of the runs.

use crate::core::attractor::{AttractorSearch, CrisisSearch, CrisisSearchError};
use crate::core::hybrid::HybridState;
use serde::{Deserialize, Serialize};
use std::num::NonZeroUsize;

/// Heuristic: the maximal number of runs of one sweep, limited because all results are kept in
/// memory and written repeatedly.
pub(crate) const MOST_RUNS: usize = 4_000_000;
/// Heuristic: the maximal number of periods of the transient, and of the average for a Lyapunov
/// exponent; a larger number is probably a mistake.
const MOST_PERIODS: usize = 1_000_000_000;
/// Heuristic: the maximal number of recorded periods of one run, limited because all recorded
/// periods are kept in memory.
const MOST_RECORDED: usize = 1_000_000;

/// The quantity that varies along an axis of the grid.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Quantity {
    /// A parameter, given by its position among the parameters.
    Parameter(usize),
    /// The initial value of a state variable, given by its position in the mode.
    State(usize),
}

/// An axis of the grid: equally spaced values of a quantity.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Axis {
    /// The quantity.
    pub quantity: Quantity,
    /// The first value.
    pub low: f64,
    /// The last value.
    pub high: f64,
    /// The number of values on the axis.
    pub count: usize,
}

impl Axis {
    /// Returns value number `k` of the axis, counted from 0.
    pub fn value(&self, k: usize) -> f64 {
        spaced([self.low, self.high], self.count, k)
    }
}

/// Returns value number `k`, counted from 0, of `count` equally spaced values from `low` to `high`.
pub(crate) fn spaced([low, high]: [f64; 2], count: usize, k: usize) -> f64 {
    let last = count.saturating_sub(1).max(1);
    if k == last { high } else { low + (high - low) * k as f64 / last as f64 }
}

/// The choice of the starting states of runs.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Order {
    /// All runs begin at the starting state of the plan.
    #[default]
    Anew,
    /// Each run begins where the preceding run ended; the runs are ordered from the first value of
    /// the parameter to the last.
    Up,
    /// Each run begins where the preceding run ended; the runs are ordered from the last value of
    /// the parameter to the first.
    Down,
}

impl Order {
    /// Returns the number of runs in a strand (chain of dependent runs) if `points` grid points are
    /// divided into strands; the last strand may contain fewer runs.
    fn strand_length(self, points: usize, strands: usize) -> usize {
        match self {
            Order::Anew => 1,
            Order::Up | Order::Down => points.div_ceil(strands.max(1)).max(1),
        }
    }

    /// Returns the numbers of runs in the strands (chains of dependent runs) into which `points`
    /// grid points are divided, in order.
    pub fn strand_lengths(self, points: usize, strands: usize) -> impl Iterator<Item = usize> {
        let length = self.strand_length(points, strands);
        (0..points).step_by(length).map(move |first| length.min(points - first))
    }
}

/// A plan of runs over a grid, from one or several starting states.
///
/// ```
/// use tangency::core::{attractor::AttractorSearch, hybrid::HybridState, sweep::{Axis, Order, Plan, Quantity}};
/// let start = HybridState { mode: 0, time: 0.0, x: vec![0.0, 0.0] };
/// let axis = Axis { quantity: Quantity::Parameter(0), low: 1.0, high: 2.0, count: 5 };
/// let plan = Plan { axes: vec![axis], starts: vec![start], order: Order::Down, strands: 2, search: AttractorSearch::default(),
///     crisis: None };
/// assert_eq!(plan.runs(), 5);
/// // Down from 2 to 1.5, and from 1.25 to 1.
/// assert_eq!(plan.strand_list(), [vec![4, 3, 2], vec![1, 0]]);
/// assert_eq!(plan.values(3), [1.75]);
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct Plan {
    /// The axes of the grid; along the runs, the value on the last axis varies fastest.
    pub axes: Vec<Axis>,
    /// The starts.
    pub starts: Vec<HybridState<f64>>,
    /// The choice of the starting states of runs.
    pub order: Order,
    /// The number of strands (chains of dependent runs) into which the axis is divided, if each run
    /// starts where the preceding run ended; the first run of each strand begins at the starting
    /// state of the plan.
    pub strands: usize,
    /// The settings of the search for the attractor of each run.
    pub search: AttractorSearch,
    /// The settings of a search for the crisis of each run's attractor, if any.
    pub crisis: Option<CrisisSearch>,
}

/// The reasons why a plan is invalid.
#[derive(Clone, Debug, PartialEq, miette::Diagnostic, thiserror::Error)]
#[non_exhaustive]
pub enum PlanError {
    /// An axis has no values, or the plan has no starting states or no strands (chains of dependent
    /// runs).
    #[error(
        "a sweep needs at least one value on every axis, one start and one strand, but \
         {0} is 0"
    )]
    Nothing(&'static str),
    /// The number of runs exceeds the maximum of one sweep.
    #[error("the sweep has {counts} runs, but the maximum of one sweep is {MOST_RUNS} runs")]
    #[diagnostic(help("use fewer values on an axis, or run several sweeps"))]
    TooMany {
        /// The counts of axis values and starting states whose product is too large.
        counts: String,
    },
    /// A setting that gives a number of periods is out of range.
    #[error("the setting `{name}` of the sweep is {value}, but must be between {low} and {high}")]
    Length {
        /// The name of the setting.
        name: &'static str,
        /// The given length.
        value: usize,
        /// The smallest allowed number of periods.
        low: usize,
        /// The largest allowed number of periods.
        high: usize,
    },
    /// Runs cannot start where the preceding run ended on this grid, which varies several
    /// quantities or an initial state.
    #[error(
        "runs can start where earlier runs ended only if the sweep varies one parameter: for a \
         sweep with {0} axes, or over an initial state, use the order `anew`"
    )]
    Followed(usize),
    /// An end of the interval of an axis is not finite.
    #[error("the axis from {low} to {high} has an end that is not finite")]
    #[diagnostic(help("choose finite ends"))]
    Interval {
        /// The lower end.
        low: f64,
        /// The upper end.
        high: f64,
    },
    /// An axis varies a parameter or a state that does not exist.
    #[error(
        "axis {axis} of the sweep varies the {what} with number {position}, but there are only \
         {count}, numbered from 0"
    )]
    Quantity {
        /// The axis.
        axis: usize,
        /// Either `parameter` or `state`: the kind of quantity that the axis varies.
        what: &'static str,
        /// The position of the missing parameter or state.
        position: usize,
        /// The number of parameters, or the number of state variables in the starting state that
        /// has the fewest state variables.
        count: usize,
    },
    /// A setting of the search for a crisis is invalid.
    #[error(transparent)]
    #[diagnostic(transparent)]
    CrisisSearch(#[from] CrisisSearchError),
    /// The number of the part is not between 1 and the number of parts.
    #[error("part {number} does not exist: the sweep is divided into {of} parts")]
    #[diagnostic(help("count parts from 1"))]
    Part {
        /// The number of the part that does not exist.
        number: usize,
        /// The number of parts of the sweep.
        of: usize,
    },
    /// The requested threads cannot be started.
    #[error("{threads} threads cannot be started: {cause}")]
    Threads {
        /// The requested number of threads.
        threads: NonZeroUsize,
        /// The reason.
        cause: String,
    },
}

impl Plan {
    /// The number of runs of the plan.
    pub fn runs(&self) -> usize {
        self.starts.len() * self.points()
    }

    /// The number of points of the grid.
    fn points(&self) -> usize {
        self.axes.iter().map(|axis| axis.count).product()
    }

    /// Rejects plans with too many runs, and numbers of periods that are out of range.
    fn check_sizes(&self) -> Result<(), PlanError> {
        let counts = || self.axes.iter().map(|axis| axis.count).chain([self.starts.len()]);
        let runs = counts().try_fold(1_usize, usize::checked_mul);
        if runs.is_none_or(|runs| runs > MOST_RUNS) {
            let counts: Vec<String> = counts().map(|count| count.to_string()).collect();
            return Err(PlanError::TooMany { counts: counts.join(" × ") });
        }
        let AttractorSearch { transient, recorded_periods, max_period, lyapunov_periods, .. } =
            self.search;
        let lengths = [
            ("transient", transient, 0, MOST_PERIODS),
            ("recorded_periods", recorded_periods, 1, MOST_RECORDED),
            ("max_period", max_period, 1, MOST_RECORDED),
            ("lyapunov_periods", lyapunov_periods, 0, MOST_PERIODS),
        ];
        match lengths.into_iter().find(|(_, value, low, high)| !(low..=high).contains(&value)) {
            Some((name, value, low, high)) => Err(PlanError::Length { name, value, low, high }),
            None => Ok(()),
        }
    }

    /// The index of the starting state of a run.
    pub fn start(&self, run: usize) -> usize {
        run / self.points()
    }

    /// The values of the varied quantities in a run, one for each axis.
    pub fn values(&self, run: usize) -> Vec<f64> {
        let mut rest = run % self.points();
        let mut values: Vec<f64> = Vec::new();
        for axis in self.axes.iter().rev() {
            values.push(axis.value(rest % axis.count));
            rest /= axis.count;
        }
        values.reverse();
        values
    }

    /// The parameters and the starting state of a run of a checked plan, given the parameters that
    /// do not vary.
    pub fn setting(&self, run: usize, p: &[f64]) -> (Vec<f64>, HybridState<f64>) {
        let (mut p, mut state) = (p.to_vec(), self.starts[self.start(run)].clone());
        for (axis, value) in self.axes.iter().zip(self.values(run)) {
            match axis.quantity {
                Quantity::Parameter(k) => p[k] = value,
                Quantity::State(k) => state.x[k] = value,
            }
        }
        (p, state)
    }

    /// Rejects axes whose parameter or state does not exist.
    fn check_quantities(&self, parameters: usize) -> Result<(), PlanError> {
        let states = self.starts.iter().map(|start| start.x.len()).min().unwrap_or(0);
        for (axis, Axis { quantity, .. }) in self.axes.iter().enumerate() {
            let (what, position, count) = match *quantity {
                Quantity::Parameter(position) => ("parameter", position, parameters),
                Quantity::State(position) => ("state", position, states),
            };
            if position >= count {
                return Err(PlanError::Quantity { axis, what, position, count });
            }
        }
        Ok(())
    }

    /// Returns the strands (chains of dependent runs), as lists of consecutive runs.
    pub fn strand_list(&self) -> Vec<Vec<usize>> {
        let points = self.points();
        let length = self.order.strand_length(points, self.strands);
        let of_start = |start: usize| {
            let mut runs: Vec<usize> = (start * points..(start + 1) * points).collect();
            if self.order == Order::Down {
                runs.reverse();
            }
            runs.chunks(length).map(<[usize]>::to_vec).collect::<Vec<_>>()
        };
        (0..self.starts.len()).flat_map(of_start).collect()
    }

    /// Checks the plan for a system with the given number of parameters.
    ///
    /// # Errors
    /// A [`PlanError`] that names the invalid setting.
    pub fn check(&self, parameters: usize) -> Result<(), PlanError> {
        let counts = self.axes.iter().map(|axis| (axis.count, "the count of an axis"));
        let others = [(self.starts.len(), "the number of starts"), (self.strands, "`strands`")];
        if let Some((_, what)) = counts.chain(others).find(|(count, _)| *count == 0) {
            return Err(PlanError::Nothing(what));
        }
        self.check_sizes()?;
        if let Some(axis) = self.axes.iter().find(|a| !(a.low.is_finite() && a.high.is_finite())) {
            return Err(PlanError::Interval { low: axis.low, high: axis.high });
        }
        let one_parameter =
            matches!(self.axes[..], [Axis { quantity: Quantity::Parameter(_), .. }]);
        if self.order != Order::Anew && !one_parameter {
            return Err(PlanError::Followed(self.axes.len()));
        }
        self.check_quantities(parameters)?;
        Ok(self.crisis.map_or(Ok(()), |search| search.check(parameters))?)
    }
}

//! Reasons why branches end.

use super::newton::NewtonError;
use serde::{Deserialize, Serialize};

/// The reason why a branch ended.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, thiserror::Error)]
#[non_exhaustive]
pub enum End {
    /// A parameter reached its bound.
    #[error("{name} reached its bound {value}")]
    ParameterBound {
        /// The parameter.
        name: String,
        /// The bound.
        value: f64,
    },
    /// A monitor reached its bound.
    #[error("{name} reached its bound {value}")]
    MonitorBound {
        /// The monitor.
        name: String,
        /// The bound.
        value: f64,
    },
    /// The orbit grazes a surface at the end of the branch, and would cross the surface beyond the
    /// end.
    #[error("{}: {name} vanishes", subkind.as_deref().unwrap_or("the solution grazes"))]
    Grazing {
        /// The name of the monitor that vanishes at the end.
        name: String,
        /// The standard name of the end point, such as `grazing-sliding`, if it has one.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        subkind: Option<String>,
    },
    /// The reset of an event is discontinuous at the end of the branch, for example because of an
    /// `if`, so that the branch does not continue to nearby solutions.
    #[error(
        "the reset of the event `{event}` is discontinuous: the value of {state} after the event \
         jumps from {from:.6e} to {to:.6e}; start the branch on the other side of the jump from a \
         simulated cycle"
    )]
    ResetJumps {
        /// The event.
        event: String,
        /// The name of the state with the largest jump.
        state: String,
        /// The value of the state after the event, on the near side of the discontinuity.
        from: f64,
        /// The value of the state after the event, on the far side of the discontinuity.
        to: f64,
    },
    /// The curve is closed: it returned to its start.
    #[error("the curve closed after {points} points")]
    Closed {
        /// The number of points on the closed curve.
        points: usize,
    },
    /// The maximal number of points was reached.
    #[error(
        "a direction of the branch has {points} points, as many as `max_points` allows: increase \
         `max_points` to trace the rest"
    )]
    PointLimit {
        /// The number of points on the branch.
        points: usize,
    },
    /// The continuation failed with the smallest allowed step.
    #[error("even a step of {step:.1e} fails: {cause}")]
    StepTooSmall {
        /// The length of the smallest attempted step, in scaled arclength.
        step: f64,
        /// The error message of Newton's method.
        cause: String,
        /// The error of Newton's method, which is not saved to files.
        #[serde(skip)]
        failure: Option<Box<NewtonError>>,
    },
    /// The mesh is too coarse for the solution, as near a homoclinic orbit.
    #[error(
        "the mesh causes an error of {error:.1e}, more than `max_mesh_error`, {limit:.1e}: take more intervals, or \
         bound the branch"
    )]
    MeshTooCoarse {
        /// The estimated relative error of the solution on its mesh.
        error: f64,
        /// The largest allowed relative error of the solution.
        limit: f64,
    },
    /// Cycles approach a homoclinic orbit, or a heteroclinic cycle: the period grows while the
    /// parameters change by no more than their errors, and the orbit approaches an equilibrium.
    /// Unconverged special points are omitted if they were found where the parameters are constant.
    /// A curve of special points of cycles ends likewise if it follows homoclinic orbits so closely
    /// that finer meshes no longer determine the periods.
    #[error(
        "the cycles approach a homoclinic orbit: the period grows to {period:.6} while the \
         parameters hardly change, and the distance of the cycle from an equilibrium falls to \
         {distance:.1e} of the cycle's size"
    )]
    Homoclinic {
        /// The period at the end of the branch.
        period: f64,
        /// The distance of the orbit from the equilibrium, relative to the size of the orbit.
        distance: f64,
    },
    /// A leading eigenvalue of the equilibrium of homoclinic orbits approaches zero. At zero, the
    /// approach to the equilibrium is slower than exponential.
    #[error(
        "the equilibrium of the homoclinic orbits is nearly non-hyperbolic: the real part `{name}` \
         of an eigenvalue falls to {rate:.1e} from {largest:.1e}"
    )]
    WeakSaddle {
        /// The name of the monitor that contains the eigenvalue.
        name: String,
        /// The largest real part of the eigenvalue on this half of the branch.
        largest: f64,
        /// The real part of the eigenvalue at the end of the branch.
        rate: f64,
    },
    /// The period has grown by more than the settings allow.
    #[error(
        "the period grows from {shortest:.6} to {period:.6}, more than the setting \
         `max_period_growth` allows"
    )]
    LongPeriod {
        /// The period at the end of the branch.
        period: f64,
        /// The shortest period on this half of the branch.
        shortest: f64,
    },
    /// A branch of cycles has many folds at the same two values of the parameter, while the period
    /// grows (snaking).
    #[error(
        "the branch snakes, as near a homoclinic orbit to another cycle: its last {turns} folds \
         lie near the parameter values {:.6} and {:.6} while the period grows from {from:.6} to \
         {to:.6}; set a bound on the period to follow the branch farther",
        values[0], values[1]
    )]
    Snaking {
        /// The number of folds at the same two values of the parameter.
        turns: usize,
        /// The two values of the parameter at the folds; the smaller value comes first.
        values: [f64; 2],
        /// The period at the first of the counted folds.
        from: f64,
        /// The period at the end of the branch.
        to: f64,
    },
    /// A group of unknowns grows without bound while the parameters are constant.
    #[error(
        "the branch goes to infinity: {name} grows from {from:.3e} to {to:.3e} while the \
         parameters are constant; set a bound to end the branch sooner"
    )]
    Infinite {
        /// The name of the group of unknowns that grows.
        name: String,
        /// The norm of the group of unknowns at the point where the parameters became constant.
        from: f64,
        /// The norm of the group of unknowns at the end of the branch.
        to: f64,
    },
    /// The curve converges to a point: for example, an invariant manifold of a saddle converges to
    /// a stable node.
    #[error(
        "the manifold converges to the point ({}), which iterates approach but never reach",
        numbers(point)
    )]
    ConvergesTo {
        /// The states of the point to which the curve converges.
        point: Vec<f64>,
    },
    /// The branch did not make net progress over many steps.
    #[error(
        "the branch makes no progress: over the last {points} points, {way:.1e} of scaled \
         arclength, the net change of each parameter and group of unknowns is at most {ahead:.1e} \
         of the length of its path; the discretisation may be too coarse, or rounding errors may \
         dominate the solution: refine the discretisation, or bound the branch"
    )]
    NoProgress {
        /// The number of points over which the branch made no net progress.
        points: usize,
        /// The total arclength of the steps without net progress.
        way: f64,
        /// For each recorded quantity, its net change in the steps without net progress is divided
        /// by the length of its path; this value is the largest of the ratios.
        ahead: f64,
    },
    /// A terminal event occurred, which ends the branch.
    #[error("the event `{event}` ends the branch")]
    Event {
        /// The event.
        event: String,
    },
    /// The user interrupted the continuation; all points computed before the interruption are kept.
    #[error("interrupted")]
    Interrupted,
    /// The branch was not traced towards this end, but only in the opposite direction.
    #[error(
        "the branch ends at its start, because the continuation in this direction was not requested"
    )]
    Start,
}

/// Formats each number with six decimals, and separates the numbers by commas.
fn numbers(values: &[f64]) -> String {
    values.iter().map(|value| format!("{value:.6}")).collect::<Vec<_>>().join(", ")
}

impl End {
    /// Whether the end is expected: the branch reached a bound, a grazing, an event or a point to
    /// which it converges, the curve is closed, or the user limited the branch to one direction or
    /// interrupted it. Summaries explain all other ends, and the option `--strict` turns other ends
    /// into errors.
    ///
    /// ```
    /// use tangency::core::continuation::End;
    /// assert!(End::Closed { points: 40 }.is_expected() && !End::PointLimit { points: 40 }.is_expected());
    /// ```
    pub fn is_expected(&self) -> bool {
        match self {
            End::ParameterBound { .. }
            | End::MonitorBound { .. }
            | End::Grazing { .. }
            | End::Event { .. }
            | End::Closed { .. }
            | End::ConvergesTo { .. }
            | End::Start
            | End::Interrupted => true,
            End::Homoclinic { .. }
            | End::LongPeriod { .. }
            | End::Snaking { .. }
            | End::WeakSaddle { .. }
            | End::Infinite { .. }
            | End::PointLimit { .. }
            | End::MeshTooCoarse { .. }
            | End::StepTooSmall { .. }
            | End::NoProgress { .. }
            | End::ResetJumps { .. } => false,
        }
    }

    /// Creates the end at a limit of admissible solutions, where the monitor of the limit vanishes.
    pub(super) fn at_limit(name: String, subkind: Option<String>) -> Self {
        End::Grazing { name, subkind }
    }
}

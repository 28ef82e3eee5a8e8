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
    /// The solution touches a surface, and would cross it beyond.
    #[error("{}: {name} vanishes", subkind.as_deref().unwrap_or("the solution grazes"))]
    Grazing {
        /// The monitor that vanishes.
        name: String,
        /// The standard name of the point, if any: `grazing-sliding`.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        subkind: Option<String>,
    },
    /// The reset of an event is discontinuous there, as with an `if`: no solution is close beyond.
    #[error(
        "the reset of the event `{event}` is discontinuous: the value of {state} after the event \
         jumps from {from:.6e} to {to:.6e}; start the branch on the other side of the jump from a \
         simulated cycle"
    )]
    ResetJumps {
        /// The event.
        event: String,
        /// The state with the largest jump.
        state: String,
        /// The value of the state after the event, before the jump.
        from: f64,
        /// The value of the state beyond the jump.
        to: f64,
    },
    /// The curve is closed: it returned to its start.
    #[error("the curve closed after {points} points")]
    Closed {
        /// The number of points on the closed curve.
        points: usize,
    },
    /// The maximal number of points was reached.
    #[error("{points} points, as many as `max_points` allows")]
    PointLimit {
        /// The number of points.
        points: usize,
    },
    /// A step of the smallest allowed length failed.
    #[error("even a step of {step:.1e} fails: {cause}")]
    StepTooSmall {
        /// The smallest step tried, in units of scaled arclength.
        step: f64,
        /// The message of Newton's failure.
        cause: String,
        /// Newton's failure, which is not saved.
        #[serde(skip)]
        failure: Option<Box<NewtonError>>,
    },
    /// The mesh is too coarse for the solution, as near a homoclinic orbit.
    #[error(
        "the mesh causes an error of {error:.1e}, more than `max_mesh_error`, {limit:.1e}: take more intervals, or \
         bound the branch"
    )]
    MeshTooCoarse {
        /// The estimated relative error.
        error: f64,
        /// The largest allowed error.
        limit: f64,
    },
    /// Cycles approach a homoclinic orbit, or a heteroclinic cycle: the period grows while the
    /// parameters change by no more than their errors, and the orbit approaches an equilibrium.
    /// Special points that do not converge while the parameters are constant are omitted.
    #[error(
        "the cycles approach a homoclinic orbit: the period grows to {period:.6} while the \
         parameters are constant, and the distance of the cycle from an equilibrium falls to \
         {distance:.1e} of the cycle's size"
    )]
    Homoclinic {
        /// The period at the end.
        period: f64,
        /// The distance from the equilibrium, relative to the size of the orbit.
        distance: f64,
    },
    /// A leading eigenvalue of the equilibrium of homoclinic orbits approaches zero, where orbits
    /// take infinite time.
    #[error(
        "the equilibrium of the homoclinic orbits is nearly non-hyperbolic: the real part `{name}` \
         of an eigenvalue falls to {rate:.1e} from {largest:.1e}"
    )]
    WeakSaddle {
        /// The monitor of the eigenvalue.
        name: String,
        /// The largest real part on this half of the branch.
        largest: f64,
        /// The real part at the end.
        rate: f64,
    },
    /// The period has grown by more than the setting allows.
    #[error(
        "the period grows from {shortest:.6} to {period:.6}, more than the setting \
         `max_period_growth` allows"
    )]
    LongPeriod {
        /// The period at the end.
        period: f64,
        /// The shortest period on this half of the branch.
        shortest: f64,
    },
    /// A branch of cycles turns again and again at the same two values of the parameter, while the
    /// period grows.
    #[error(
        "the branch snakes, as near a homoclinic orbit to another cycle: its last {turns} folds \
         lie near the parameter values {:.6} and {:.6} while the period grows from {from:.6} to \
         {to:.6}; set a bound on the period to follow the branch farther",
        values[0], values[1]
    )]
    Snaking {
        /// The number of turns at the same two values.
        turns: usize,
        /// The smaller and the larger value of the parameter.
        values: [f64; 2],
        /// The period at the first of these turns.
        from: f64,
        /// The period at the end.
        to: f64,
    },
    /// A group of unknowns grows without bound, while the parameters are constant.
    #[error(
        "the branch goes to infinity: {name} grows from {from:.3e} to {to:.3e} while the \
         parameters are constant; set a bound to end the branch sooner"
    )]
    Infinite {
        /// The group of unknowns.
        name: String,
        /// The norm of the group where the parameters became constant.
        from: f64,
        /// The norm of the group at the end.
        to: f64,
    },
    /// The curve converges to a point, such as a manifold of a saddle to a stable node.
    #[error(
        "the manifold converges to the point ({}), which iterates approach but never reach",
        numbers(point)
    )]
    ConvergesTo {
        /// The states of the point.
        point: Vec<f64>,
    },
    /// The branch did not advance over many steps.
    #[error(
        "the branch makes no progress: over the last {points} points, {way:.1e} of scaled \
         arclength, the net change of each parameter and group of unknowns is at most {ahead:.1e} \
         of the length of its path; the discretisation may be too coarse, or rounding errors may \
         dominate the solution: refine the discretisation, or bound the branch"
    )]
    NoProgress {
        /// The number of points.
        points: usize,
        /// The length of these steps.
        way: f64,
        /// The largest ratio of a quantity's net change over these steps to the length of its path.
        ahead: f64,
    },
    /// A terminal event happened.
    #[error("the event `{event}` ends the branch")]
    Event {
        /// The event.
        event: String,
    },
    /// Interrupted by the user; all points up to there are kept.
    #[error("interrupted")]
    Interrupted,
    /// The branch was only traced in the other direction.
    #[error(
        "the branch ends at its start, because the continuation in this direction was not requested"
    )]
    Start,
}

/// Formats numbers with six decimals, separated by commas.
fn numbers(values: &[f64]) -> String {
    values.iter().map(|value| format!("{value:.6}")).collect::<Vec<_>>().join(", ")
}

impl End {
    /// Whether the end needs no attention: at a bound, a surface, an event or the start, on a
    /// closed curve, or on request. Summaries explain all other ends, and `--strict` fails for
    /// them.
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

    /// The end where a limit of admissible solutions vanishes.
    pub(super) fn at_limit(name: String, subkind: Option<String>) -> Self {
        End::Grazing { name, subkind }
    }
}

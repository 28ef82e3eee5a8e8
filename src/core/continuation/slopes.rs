//! The arclength position of a point along its branch, and the slopes of its parameters and
//! monitors.

use serde::{Deserialize, Serialize};

/// The arclength position of a point along its branch, and the derivatives of its parameters and
/// monitors (its columns) with respect to this position.
///
/// Between two points, each column is approximated by the cubic polynomial with the values and
/// slopes at both points, to the accuracy of
/// [`Settings::curve_error`](super::Settings::curve_error). Slopes are computed from the last
/// factored matrix, which may belong to an earlier Newton iterate; they have at least three
/// accurate digits.
///
/// ```
/// use tangency::core::{continuation::Continuation, system::Dense};
/// tangency::zero_problem! {
///     struct Plate [u; load] {
///         0 = load / (T::one() - u).powi(2) - u;
///         monitor deflection = u;
///     }
/// }
/// let mut plate = Dense::new(Plate);
/// let branch = Continuation::new(&mut plate).along("load", 0.0..=1.0).trace()?;
/// // load = u (1 − u)², hence d load / du = (1 − u) (1 − 3 u).
/// let point = &branch.points[2];
/// let slopes = point.slopes.as_ref().ok_or("no slopes")?;
/// let [load, deflection] = ["load", "deflection"].map(|name| branch.column(name).unwrap());
/// let u = point.value(deflection).unwrap();
/// let ratio = slopes.columns[load].unwrap() / slopes.columns[deflection].unwrap();
/// assert!((ratio - (1.0 - u) * (1.0 - 3.0 * u)).abs() < 1e-3);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Slopes {
    /// The arclength from the start of the branch, measured in the scales at the start; negative in
    /// the backward direction.
    pub position: f64,
    /// The derivatives of parameters and monitors with respect to the position; `None` for a
    /// monitor that is not differentiable.
    pub columns: Vec<Option<f64>>,
}

impl Slopes {
    /// Shifts the origin of positions to `begin`, and rescales arclength by `growth`.
    pub(super) fn placed(self, begin: f64, growth: f64) -> Self {
        let columns = self.columns.into_iter().map(|slope| Some(slope? / growth));
        Slopes { position: begin + growth * self.position, columns: columns.collect() }
    }

    /// Returns the position and slopes for the reversed direction of the branch.
    pub(super) fn reversed(self) -> Self {
        let columns = self.columns.into_iter().map(|slope| Some(-slope?));
        Slopes { position: -self.position, columns: columns.collect() }
    }
}

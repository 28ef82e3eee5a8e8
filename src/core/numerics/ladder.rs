//! Ladders, which are sequences of successively finer discretisations (the rungs), and error
//! estimates for quantities that are computed on the rungs.
//!
//! Each problem defines its next finer discretisation in one place
//! ([`Discretised::refined`](crate::core::system::Discretised::refined)). The final correction of a
//! special point uses the discretisation that follows the discretisation of its branch in this
//! refinement. A scene chooses the cheapest sufficiently accurate discretisation from a [`ladder`].
//! The ladder contains the discretisations that refinement yields, one more discretisation between
//! each two of them, and coarser discretisations below them. Both the correction of special points
//! and the choice by scenes estimate errors from the changes between successive discretisations, by
//! [`error_of_last`].

/// Extends a ladder of discretisations from the given rungs, up to `most` rungs in total. Each new
/// rung (discretisation) is the refinement of the last rung but one, so that two rungs lead from a
/// discretisation to its refinement.
///
/// ```
/// use tangency::core::numerics::ladder;
/// let intervals = ladder(vec![20, 30], 6, |n| Some(2 * n));
/// assert_eq!(intervals, [20, 30, 40, 60, 80, 120]);
/// ```
pub fn ladder<D>(mut rungs: Vec<D>, most: usize, finer: impl Fn(&D) -> Option<D>) -> Vec<D> {
    while rungs.len() < most
        && let [.., last_but_one, _] = &rungs[..]
        && let Some(next) = finer(last_but_one)
    {
        rungs.push(next);
    }
    rungs
}

/// Estimates the error of the last of several approximations of a number, which are computed on the
/// rungs of a ladder (increasingly fine discretisations); infinite for a single approximation.
///
/// If only two approximations are given, their difference `d` bounds the error of the finer one,
/// provided that each rung (discretisation) at least halves the error. If two changes between
/// successive approximations are known, further changes are assumed to shrink by the same ratio `ρ
/// ≤ ½`: their sum is `d(ρ + ρ² + …) = dρ/(1 − ρ)`, and the estimate is four times this sum. The
/// ratio is at least 0.1, and a change is at least a hundredth of the previous change, because
/// spectral convergence can become algebraic at a corner singularity, and because changes pass
/// through zero where errors change sign.
///
/// ```
/// use tangency::core::numerics::error_of_last;
/// assert_eq!(error_of_last(&[1.0, 1.5]), 0.5);
/// // Halved: ρ = ½.
/// assert_eq!(error_of_last(&[1.0, 1.5, 1.75]), 1.0);
/// ```
pub fn error_of_last(values: &[f64]) -> f64 {
    let change = |[a, b]: [f64; 2]| (a - b).abs();
    match *values {
        [.., a, b, c] => {
            let before = change([a, b]);
            let change = change([b, c]).max(0.01 * before);
            let ratio = (change / before.max(f64::MIN_POSITIVE)).clamp(0.1, 0.5);
            4.0 * change * ratio / (1.0 - ratio)
        }
        [a, b] => change([a, b]),
        _ => f64::INFINITY,
    }
}

/// Estimates the error of the first of several approximations of a number, computed on rungs of
/// growing accuracy: four thirds of the largest distance of any approximation from the last one,
/// plus the error of the last one. (The distance of the first approximation from the last one, and
/// the last change, can be small by accident.)
pub fn error_of_first(values: &[f64]) -> f64 {
    let last = values.last().copied().unwrap_or(f64::NAN);
    let far = values.iter().map(|value| (value - last).abs()).fold(0.0, f64::max);
    4.0 / 3.0 * far + error_of_last(values)
}

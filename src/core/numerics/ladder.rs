//! Ladders of discretisations, and the errors of values on their rungs.
//!
//! A problem has one definition of a finer discretisation. Special points climb by it from the
//! discretisation of their branch
//! ([`Discretised::refined`](crate::core::system::Discretised::refined)). The [`ladder`] from which a
//! scene takes the cheapest discretisation that is accurate enough has the same rungs, with one
//! between each two and coarser ones below. Both estimate errors from the changes between rungs, by
//! [`error_of_last`].

/// The ladder that begins with the given rungs. Each further one, up to `most` in all, is the finer
/// discretisation of the last but one: a step to the finer discretisation is two rungs.
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

/// The estimated error of the last of some values of a number, on rungs of growing accuracy;
/// infinite for a single value.
///
/// A single change `d` bounds the error of the finer value if each rung at least halves it. With
/// two, changes are taken to go on shrinking by their ratio `ρ ≤ ½`: what is to come is
/// `d(ρ + ρ² + …) = dρ/(1 − ρ)`, of which four times is the estimate. A ratio below 0.1 is not
/// relied on, nor is a change below a hundredth of the one before: spectral convergence may turn
/// algebraic where a corner singularity takes over, and changes pass zero where errors change sign.
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

/// The estimated error of the first of such values: four thirds of the largest distance of any of
/// them from the last one, and that one's error. (The first distance, and the last change, may be
/// small by accident.)
pub fn error_of_first(values: &[f64]) -> f64 {
    let last = values.last().copied().unwrap_or(f64::NAN);
    let far = values.iter().map(|value| (value - last).abs()).fold(0.0, f64::max);
    4.0 / 3.0 * far + error_of_last(values)
}

//! Finds zeros of functions of one variable.

/// The criteria that stop an iteration for a root.
pub(crate) struct Limits {
    /// The largest number of iterations.
    pub rounds: usize,
    /// The iteration has converged if the root estimate moves by less than this size.
    pub moved: f64,
}

/// Finds a zero of a function between two points; `sign` is the sign of the function at the first
/// point. Uses Newton's method from an initial guess, with the function's value and derivative;
/// bisection keeps the iterates inside the bracket.
#[inline]
pub(crate) fn bracketed_zero(
    [mut low, mut high]: [f64; 2],
    sign: f64,
    guess: f64,
    limits: Limits,
    mut of: impl FnMut(f64) -> [f64; 2],
) -> f64 {
    let mut place = guess;
    for _ in 0..limits.rounds {
        let [value, rate] = of(place);
        *(if value * sign > 0.0 { &mut low } else { &mut high }) = place;
        let newton = place - value / rate;
        let next = if newton > low && newton < high { newton } else { 0.5 * (low + high) };
        let moved = (next - place).abs();
        place = next;
        if moved < limits.moved {
            break;
        }
    }
    place
}

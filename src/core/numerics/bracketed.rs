//! Zeros of functions of one variable.

/// The limits of an iteration.
pub(crate) struct Limits {
    /// The largest number of rounds.
    pub rounds: usize,
    /// The size of a move below which the iteration has converged.
    pub moved: f64,
}

/// Finds a zero of a function between two places; `sign` is the function's sign at the first one.
/// Uses Newton's method from a guess, with value and rate, kept inside the bracket by bisection.
#[inline]
pub(crate) fn bracketed_zero(
    [mut low, mut high]: [f64; 2],
    sign: f64,
    guess: f64,
    limits: Limits,
    of: impl Fn(f64) -> [f64; 2],
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

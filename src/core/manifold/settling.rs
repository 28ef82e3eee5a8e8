//! Detection of manifold halves that converge to a point.

/// Heuristic: the largest arclength that a converged curve gains in one iterate, as a fraction of
/// the resolution.
const STILL: f64 = 0.1;

/// Heuristic: the largest ratio of the arclengths that a converged curve gains in successive
/// iterates.
const LESS: f64 = 0.9;

/// Heuristic: the number of consecutive iterates in which a converged curve must satisfy the bounds
/// on arclength and ratio.
const TIMES: usize = 3;

/// The arclength that a curve gains from iterate to iterate.
pub(super) struct Settling {
    /// The increase of the parameter `t` in one iterate.
    window: f64,
    /// The parameter at the beginning of the current iterate, and the arclength there.
    begin: [f64; 2],
    gained: f64,
    times: usize,
}

impl Settling {
    /// Starts the detection at a parameter of the curve; each iterate increases the parameter by
    /// `rate`.
    pub fn new(t: f64, rate: f64) -> Self {
        Settling { window: rate.max(0.5), begin: [t, 0.0], gained: f64::INFINITY, times: 0 }
    }

    /// Whether the curve has converged, given a parameter and the arclength at this parameter.
    pub fn has_settled(&mut self, t: f64, arclength: f64, resolution: f64) -> bool {
        let [t0, length] = self.begin;
        if t - t0 < self.window {
            return false;
        }
        let gained = (arclength - length) / (t - t0);
        let less = gained <= LESS * self.gained && gained * self.window <= STILL * resolution;
        self.times = if less { self.times + 1 } else { 0 };
        (self.begin, self.gained) = ([t, arclength], gained);
        self.times >= TIMES
    }
}

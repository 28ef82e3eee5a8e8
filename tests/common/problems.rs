//! Problems with known answers that several tests solve and benchmarks time.

use tangency::core::problem::{Dynamics, Names, ZeroProblem};
use tangency::core::scalar::Scalar;
use tangency::{vector_field, zero_problem};

zero_problem! {
    /// `μ + x − x³/3 = 0`: folds `μ = ±2/3` at `x = ∓1`.
    pub struct CuspSlice [x; mu] {
        0 = mu + x - x.powi(3) / 3.0;
        monitor square = x * x;
    }
}

zero_problem! {
    /// The cusp's normal form `x³ − a x − b = 0`: folds `4a³ = 27b²`, a cusp at 0.
    pub struct CuspForm [x; b, a] {
        0 = a * x + b - x.powi(3);
    }
}

zero_problem! {
    /// `p² + x² = radius²`: closed.
    pub struct Circle { pub radius: f64 } [x; p] {
        0 = x * x + p * p - radius * radius;
        fn dynamics(&self) -> Dynamics {
            Dynamics::None
        }
    }
}

zero_problem! {
    /// AUTO's demo pp2.
    pub struct PredatorPrey [x, y; p] {
        0 = x * 3.0 * (T::one() - x) - x * y - p * (T::one() - (x * -5.0).exp());
        0 = x * y * 3.0 - y;
    }
}

/// `u'' + 10 a (eᵘ − 1 − b u²/2) = 0`: branch points on `u = 0` at `a = (kπ)²/10` (continuum).
pub struct TrivialBranch(pub usize);

impl ZeroProblem for TrivialBranch {
    fn names(&self) -> Names {
        Names::new([("u", self.0)], ["a", "b"])
    }
    fn residual<T: Scalar>(&self, u: &[T], p: &[T], r: &mut [T]) {
        let n = self.0;
        let inverse = ((n + 1) * (n + 1)) as f64;
        let at = |i: usize| if i == 0 || i > n { T::zero() } else { u[i - 1] };
        for i in 1..=n {
            let source = at(i).exp() - 1.0 - p[1] * at(i) * at(i) * 0.5;
            r[i - 1] = (at(i - 1) - at(i) * 2.0 + at(i + 1)) * inverse + p[0] * source * 10.0;
        }
    }
}

zero_problem! {
    /// Two coupled columns under one load: a pitchfork from `x = y = 0`, at `p = 1 − c` and `1 + c`.
    pub struct Columns [x, y; p, c] {
        0 = (p - 1.0) * x + c * y - x.powi(3);
        0 = (p - 1.0) * y + c * x - y.powi(3);
    }
}

zero_problem! {
    /// CO oxidation (Bykov), `q₂` and `k` free.
    pub struct Oxidation [x, y, s; q2, k] {
        let z = T::one() - x - y - s;
        0 = z * z * 5.0 - x * x * 2.0 - x * y * 10.0;
        0 = q2 * z - y * 0.1 - x * y * 10.0;
        0 = (z - k * s) * 0.0675;
    }
}

/// Central differences of `u'' + λeᵘ = 0`, `u(0) = u(1) = 0`.
pub struct Bratu(pub usize);

impl ZeroProblem for Bratu {
    fn names(&self) -> Names {
        Names::new([("u", self.0)], ["lambda"]).with_monitors(["middle"])
    }
    fn residual<T: Scalar>(&self, u: &[T], p: &[T], r: &mut [T]) {
        let n = self.0;
        let inverse = ((n + 1) * (n + 1)) as f64;
        let at = |i: usize| if i == 0 || i > n { T::zero() } else { u[i - 1] };
        for i in 1..=n {
            r[i - 1] = (at(i - 1) - at(i) * 2.0 + at(i + 1)) * inverse + p[0] * at(i).exp();
        }
    }
    fn monitors<T: Scalar>(&self, u: &[T], _p: &[T], values: &mut [T]) {
        values[0] = u[self.0 / 2];
    }
}

vector_field! {
    /// `x' = a − (b + 1) x + x² y`, `y' = b x − x² y`: a Hopf point at `b = 1 + a²`, of frequency `a`.
    pub struct Brusselator [x, y; a, b] {
        let reaction = x * x * y;
        d/dt x = a - (b + 1.0) * x + reaction;
        d/dt y = b * x - reaction;
    }
}

zero_problem! {
    /// `x' = y, y' = a + b y + x² + x y`: equilibria `x = ±√−a`, of which those with `x > 0` are
    /// saddles. The trace of `F_z` is `b + x`.
    pub struct BogdanovTakens [x, y; a, b] {
        0 = y;
        0 = a + b * y + x * x + x * y;
    }
}

vector_field! {
    /// Van der Pol's oscillator: `x' = y, y' = μ (1 − x²) y − x`.
    pub struct VanDerPol [x, y; mu] {
        d/dt x = y;
        d/dt y = mu * (T::one() - x * x) * y - x;
    }
}

//! Two fields and a surface, as one type: what is generic over systems is compiled once for all.
//! Beside each the same by hand, with normal velocities and sliding worked out on paper, in fixed
//! steps.

use std::f64::consts::TAU;
use tangency::core::hybrid::filippov::{FilippovNames, FilippovSystem, Side};
use tangency::core::problem::Forcing;
use tangency::core::scalar::Scalar;

#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Sliding {
    /// Relay feedback, `u = −sgn x`, of the plant `(s² + 2σρ s + ρ²)/((s² + 2ζω s + ω²)(s + λ))`
    /// (M. di Bernardo, K. H. Johansson, F. Vasca, *Int. J. Bifurcation Chaos* 11:1121, 2001).
    Relay,
    /// A mass on a spring on a belt of velocity 1, with friction `a₀ sgn w − a₁ w + a₂ w³` at the
    /// relative velocity `w = 1 − v` (M. di Bernardo, P. Kowalczyk, A. Nordmark, *Int. J.
    /// Bifurcation Chaos* 13:2935, 2003).
    Friction,
    /// Chua's circuit with a cubic resistor, and a current `J` that is drawn where the voltage
    /// exceeds `E`.
    Chua,
    /// Rotation, and a pull of 1 towards the circle `x² + y² = 1 + a sin t`.
    Circle,
}

impl Sliding {
    /// Names and values of parameters.
    pub fn parameters(self) -> Vec<(&'static str, f64)> {
        match self {
            Sliding::Relay => {
                vec![
                    ("zeta", 0.05),
                    ("omega", 3.0),
                    ("lambda", 0.05),
                    ("sigma", -1.0),
                    ("rho", 1.0),
                ]
            }
            Sliding::Friction => {
                vec![("nu", 2.0), ("A", 3.0), ("a0", 1.5), ("a1", 1.5), ("a2", 0.45)]
            }
            Sliding::Chua => vec![("alpha", 6.85), ("beta", 14.0), ("E", 1.8), ("J", 0.5)],
            Sliding::Circle => vec![("a", 0.1)],
        }
    }

    /// A state above the surface.
    pub fn start(self) -> Vec<f64> {
        match self {
            Sliding::Relay => vec![0.5, 0.1, -0.3],
            Sliding::Friction => vec![1.0, 0.1],
            Sliding::Chua => vec![1.6, 0.1, -1.5],
            Sliding::Circle => vec![2.0, 0.0],
        }
    }
}

impl FilippovSystem for Sliding {
    fn states(&self) -> Vec<String> {
        let states: &[&str] = match self {
            Sliding::Relay | Sliding::Chua => &["x", "y", "z"],
            Sliding::Friction => &["u", "v"],
            Sliding::Circle => &["x", "y"],
        };
        states.iter().map(ToString::to_string).collect()
    }
    fn parameters(&self) -> Vec<String> {
        Sliding::parameters(*self).into_iter().map(|(name, _)| name.to_string()).collect()
    }
    fn names(&self) -> FilippovNames {
        match self {
            Sliding::Friction => FilippovNames::new("slower", "faster", "stick", "belt"),
            _ => FilippovNames::default(),
        }
    }
    fn surface<T: Scalar>(&self, t: T, x: &[T], p: &[T]) -> T {
        match self {
            Sliding::Relay => x[0],
            Sliding::Friction => -x[1] + 1.0,
            Sliding::Chua => p[2] - x[0],
            Sliding::Circle => x[0] * x[0] + x[1] * x[1] - p[0] * t.sin() - 1.0,
        }
    }
    fn field<T: Scalar>(&self, side: Side, t: T, x: &[T], p: &[T], f: &mut [T]) {
        let above = if side == Side::Above { 1.0 } else { -1.0 };
        match self {
            Sliding::Relay => {
                let ([zeta, omega, lambda], [sigma, rho]) = ([p[0], p[1], p[2]], [p[3], p[4]]);
                let square = omega * omega;
                f[0] = x[1] - (zeta * omega * 2.0 + lambda) * x[0] - above;
                f[1] = x[2]
                    - (zeta * omega * lambda * 2.0 + square) * x[0]
                    - sigma * rho * 2.0 * above;
                f[2] = -lambda * square * x[0] - rho * rho * above;
            }
            Sliding::Friction => {
                let w = -x[1] + 1.0;
                f[0] = x[1];
                f[1] = p[1] * (p[0] * t).cos() - x[0] - p[3] * w + p[4] * w.powi(3) + p[2] * above;
            }
            Sliding::Chua => {
                let resistor = -x[0] / 7.0 + x[0].powi(3) * (4.0 / 63.0);
                let drawn = if side == Side::Below { p[3] } else { T::zero() };
                f[0] = p[0] * (x[1] - resistor - drawn);
                f[1] = x[0] - x[1] + x[2];
                f[2] = -p[1] * x[1];
            }
            Sliding::Circle => {
                let radius = (x[0] * x[0] + x[1] * x[1]).sqrt();
                f[0] = -x[1] - x[0] / radius * above;
                f[1] = x[0] - x[1] / radius * above;
            }
        }
    }
    fn forcing(&self) -> Forcing {
        match self {
            Sliding::Friction => Forcing::Periodic { phase: TAU },
            _ => Forcing::None,
        }
    }
    fn period<T: Scalar>(&self, p: &[T]) -> T {
        if *self == Sliding::Friction { p[0].recip() * TAU } else { T::one() }
    }
}

/// What motion by hand passes: where it reaches the surface from above, and where a probe vanishes.
pub enum Mark {
    /// Motion in a mode reaches the surface, or leaves it.
    Arrival(usize),
    /// The probe vanishes.
    Probe,
}

/// A function of mode, time and state.
type InMode<'a, T> = dyn Fn(usize, f64, &[f64; 3]) -> T + 'a;

/// Where motion by hand is in fixed steps: 0 above the surface, 1 below, 2 on it.
pub struct ByHand<'a> {
    /// The rates of states in a mode.
    pub field: &'a InMode<'a, [f64; 3]>,
    /// The surface's function.
    pub surface: &'a dyn Fn(&[f64; 3]) -> f64,
    /// The normal velocities above and below.
    pub normal: &'a dyn Fn(f64, &[f64; 3]) -> [f64; 2],
    /// A function in a mode, whose zeros are marked.
    pub probe: &'a InMode<'a, Option<f64>>,
    pub step: f64,
}

/// The mass on a belt by hand, `h = 1 − v`, at a frequency and a force. Its probe is what turns
/// where motion touches: the surface's function below the belt's velocity, the force in sliding.
pub fn on_belt<R>([nu, a]: [f64; 2], with: impl FnOnce(ByHand) -> R) -> R {
    let force = move |t: f64, x: &[f64; 3]| {
        let w = 1.0 - x[1];
        a * (nu * t).cos() - x[0] - 1.5 * w + 0.45 * w * w * w
    };
    let normal = move |t: f64, x: &[f64; 3]| [-force(t, x) - 1.5, -force(t, x) + 1.5];
    let field = move |mode: usize, t: f64, x: &[f64; 3]| match mode {
        0 => [x[1], force(t, x) + 1.5, 0.0],
        1 => [x[1], force(t, x) - 1.5, 0.0],
        _ => [x[1], 0.0, 0.0],
    };
    with(ByHand {
        field: &field,
        surface: &|x| 1.0 - x[1],
        normal: &normal,
        probe: &|mode, t, x| match mode {
            0 => Some(normal(t, x)[0]),
            1 => None,
            _ => Some(a * nu * (nu * t).sin() + x[1]),
        },
        step: 5e-4,
    })
}

impl ByHand<'_> {
    /// A step of Runge's and Kutta's method.
    fn stepped(&self, mode: usize, t: f64, x: &[f64; 3], h: f64) -> [f64; 3] {
        let moved = |k: &[f64; 3], h: f64| std::array::from_fn(|i| x[i] + h * k[i]);
        let a = (self.field)(mode, t, x);
        let b = (self.field)(mode, t + 0.5 * h, &moved(&a, 0.5 * h));
        let c = (self.field)(mode, t + 0.5 * h, &moved(&b, 0.5 * h));
        let d = (self.field)(mode, t + h, &moved(&c, h));
        std::array::from_fn(|i| x[i] + h / 6.0 * (a[i] + 2.0 * (b[i] + c[i]) + d[i]))
    }

    /// What ends a mode where it is negative, and the mode that follows.
    fn exits(&self, mode: usize, t: f64, x: &[f64; 3]) -> f64 {
        let [up, down] = (self.normal)(t, x);
        match mode {
            0 => (self.surface)(x),
            1 => -(self.surface)(x),
            _ => (-up).min(down),
        }
    }

    fn next(&self, mode: usize, t: f64, x: &[f64; 3]) -> usize {
        let [up, down] = (self.normal)(t, x);
        match mode {
            0 => {
                if down > 0.0 {
                    2
                } else {
                    1
                }
            }
            1 => {
                if up < 0.0 {
                    2
                } else {
                    0
                }
            }
            _ => usize::from(-up > down),
        }
    }

    /// The part of a step after which a function is negative first.
    fn part(
        &self,
        (mode, t, x): (usize, f64, &[f64; 3]),
        f: &dyn Fn(f64, &[f64; 3]) -> f64,
    ) -> f64 {
        let (mut low, mut high) = (0.0, self.step);
        for _ in 0..60 {
            let middle = 0.5 * (low + high);
            match f(t + middle, &self.stepped(mode, t, x, middle)) > 0.0 {
                true => low = middle,
                false => high = middle,
            }
        }
        high
    }

    /// Follows motion from above the surface for a time, and shows its marks.
    pub fn run(&self, start: [f64; 3], duration: f64, show: impl FnMut(Mark, f64, &[f64; 3])) {
        self.follow((0, 0.0, start), duration, show);
    }

    /// Follows motion from a mode, a time and a state until a time, no farther than a step beyond
    /// it, and shows its marks.
    pub fn follow(
        &self,
        (mut mode, mut t, mut x): (usize, f64, [f64; 3]),
        end: f64,
        mut show: impl FnMut(Mark, f64, &[f64; 3]),
    ) -> (usize, f64, [f64; 3]) {
        while t < end {
            let next = self.stepped(mode, t, &x, self.step);
            let probe = |t, x: &[f64; 3]| (self.probe)(mode, t, x);
            let [before, after] = [probe(t, &x), probe(t + self.step, &next)];
            let here = (mode, t, &x);
            // One that leaves the surface begins with a negative rate, and is above it again at
            // once.
            let ends = self.exits(mode, t + self.step, &next) < 0.0;
            let part = ends.then(|| self.part(here, &|t, x| self.exits(mode, t, x)));
            if let (Some(before), Some(after)) = (before, after)
                && before * after < 0.0
            {
                let rises = before.signum();
                let at = self.part(here, &|t, x| rises * probe(t, x).unwrap_or(0.0));
                if part.is_none_or(|part| at < part) {
                    show(Mark::Probe, t + at, &self.stepped(mode, t, &x, at));
                }
            }
            let Some(part) = part else {
                (x, t) = (next, t + self.step);
                continue;
            };
            (x, t) = (self.stepped(mode, t, &x, part), t + part);
            show(Mark::Arrival(mode), t, &x);
            mode = self.next(mode, t, &x);
        }
        (mode, t, x)
    }

    /// How far motion is from where it was a period ago, with the last part of the period in one
    /// step.
    pub fn miss(
        &self,
        (mode, t, x): (usize, f64, [f64; 3]),
        period: f64,
        show: impl FnMut(Mark, f64, &[f64; 3]),
    ) -> f64 {
        let (last, at, end) = self.follow((mode, t, x), t + period - self.step, show);
        let end = self.stepped(last, at, &end, t + period - at);
        let apart = end.iter().zip(&x).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
        if last == mode { apart } else { f64::INFINITY }
    }
}

/// Where a margin that some simulations have on one side of a place vanishes: by the polynomial
/// through their parameters.
pub fn vanishing(margin: impl Fn(f64) -> f64, near: f64, aside: f64) -> f64 {
    let samples: Vec<[f64; 2]> =
        (1..=5).map(|k| near + aside * k as f64).map(|p| [margin(p), p]).collect();
    let weight = |k: usize| {
        let others = samples.iter().enumerate().filter(|(j, _)| *j != k);
        others.map(|(_, other)| other[0] / (other[0] - samples[k][0])).product::<f64>()
    };
    (0..samples.len()).map(|k| samples[k][1] * weight(k)).sum()
}

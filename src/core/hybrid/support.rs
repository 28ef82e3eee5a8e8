//! Projection of states onto a surface, and of states onto the set of states at rest on the
//! surface.

use super::erased::{EventNumber, HybridEquations};
use super::leg::{GuardOf, Moment};
use crate::core::problem::{WatchIn, Watchable, gradient};
use num_dual::Dual;

/// Heuristic: the number of Newton iterations with real gradients: the first iterations converge in
/// value, and each further iteration makes one more order of derivatives exact.
const ROUNDS: usize = 2;
/// Heuristic: the gradients of a guard and of its rate count as parallel if the squared sine of the
/// angle between the two gradients is below this value.
const APART: f64 = 1e-6;

/// The surface on which a guard vanishes in a mode, at a given time.
#[derive(Clone, Copy)]
pub(super) struct Surface<'a, T> {
    pub system: &'a dyn HybridEquations,
    pub guard: usize,
    pub mode: usize,
    pub t: T,
}

impl<'a, T: EventNumber> Surface<'a, T>
where
    GuardOf<'a>: Watchable<T>,
{
    /// Returns the smallest change, in units of the scales, that moves a state onto the surface,
    /// with its derivatives; if `at_rest` is true, the guard's rate of change along the motion also
    /// vanishes after the change.
    pub fn change(self, x: &[T], p: &[T], at_rest: bool) -> Vec<T> {
        let sizes = self.system.sizes_of(self.mode, &p.iter().map(T::real).collect::<Vec<_>>());
        let mut rested = x.to_vec();
        for _ in 0..ROUNDS + T::NDERIV {
            let (values, slopes) = (self.values(&rested, p), self.slopes(&rested, p));
            let product = |a: usize, b: usize| {
                let parts = slopes[a].iter().zip(&slopes[b]).zip(&sizes);
                parts.map(|((a, b), size)| a * b * size * size).sum::<f64>()
            };
            let [hh, hr, rr] = [product(0, 0), product(0, 1), product(1, 1)];
            if hh == 0.0 {
                break;
            }
            let determinant = hh * rr - hr * hr;
            let shares = match at_rest && determinant > APART * hh * rr {
                true => {
                    let [h, r] = values;
                    [(h * rr - r * hr) / determinant, (r * hh - h * hr) / determinant]
                }
                false => [values[0] / hh, T::zero()],
            };
            for (i, x) in rested.iter_mut().enumerate() {
                let change = shares[0] * slopes[0][i] + shares[1] * slopes[1][i];
                *x -= change * (sizes[i] * sizes[i]);
            }
        }
        rested.iter().zip(x).map(|(rested, x)| *rested - *x).collect()
    }

    /// Returns the value of the guard and its rate of change along the motion.
    fn values(self, x: &[T], p: &[T]) -> [T; 2] {
        let Surface { system, guard, mode, t } = self;
        let mut f = vec![T::zero(); x.len()];
        system.field(mode, t, x, p, &mut f);
        let x: Vec<_> = x.iter().zip(&f).map(|(x, f)| Dual::new(*x, *f)).collect();
        let p: Vec<_> = p.iter().map(|p| Dual::new(*p, T::zero())).collect();
        let watch = GuardOf { system, guard, mode, scale: 1.0 };
        let along = watch.value_in(Dual::new(t, T::one()), &x, &p);
        [along.re, along.eps]
    }

    /// Returns the gradients of the guard and of its rate of change with respect to the states.
    fn slopes(self, x: &[T], p: &[T]) -> [Vec<f64>; 2] {
        let Surface { system, guard, mode, t } = self;
        let [x, p] = [x, p].map(|v| v.iter().map(T::real).collect::<Vec<f64>>());
        let place = (t.real(), &x[..]);
        let values = gradient(place, &p, |t, x, p| system.guard(guard, mode, t, x, p));
        let rates = gradient(place, &p, |t, x, p| Moment { system, mode, t, x, p }.rate(guard));
        [values.0, rates.0]
    }
}

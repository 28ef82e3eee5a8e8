//! Promise: a discretisation of one's own is one file, written from outside of the library: the
//! Fourier collocation (harmonic balance) of any forced vector field.

use crate::common::close;
use crate::orbits::cycles::collocated;
use std::f64::consts::PI;
use tangency::core::continuation::{Branch, Continuation};
use tangency::core::problem::{Dynamics, Names, VectorField, ZeroProblem};
use tangency::core::scalar::Scalar;
use tangency::core::system::{Dense, Kind, System};
use tangency::vector_field;

/// The periodic motion of a forced field, by its values at `2N + 1` equidistant times of a period:
/// `D x = T f`, with the derivative `D` of the trigonometric polynomial through them (L. N.
/// Trefethen, *Spectral Methods in MATLAB*, SIAM 2000, chapter 3).
struct HarmonicBalance<F> {
    field: F,
    harmonics: usize,
}

impl<F: VectorField> HarmonicBalance<F> {
    fn places(&self) -> usize {
        2 * self.harmonics + 1
    }
}

impl<F: VectorField> ZeroProblem for HarmonicBalance<F> {
    fn names(&self) -> Names {
        let Names { unknowns, parameters, .. } = self.field.names();
        let values = unknowns.iter().map(|state| (&state.name[..], self.places()));
        Names::new(values, parameters)
    }
    fn dynamics(&self) -> Dynamics {
        Dynamics::None
    }
    fn residual<T: Scalar>(&self, z: &[T], p: &[T], r: &mut [T]) {
        let (places, period) = (self.places(), self.field.period(p));
        let states = z.len() / places;
        let (mut x, mut f) = (vec![T::zero(); states], vec![T::zero(); states]);
        for j in 0..places {
            (0..states).for_each(|i| x[i] = z[i * places + j]);
            let share = j as f64 / places as f64;
            self.field.field(period * share, &x, p, &mut f);
            for i in 0..states {
                r[i * places + j] = -period * f[i];
            }
            for k in (0..places).filter(|k| *k != j) {
                let sign = if (j + k) % 2 == 0 { 1.0 } else { -1.0 };
                let angle = PI * (j as f64 - k as f64) / places as f64;
                for i in 0..states {
                    r[i * places + j] += z[i * places + k] * (PI * sign / angle.sin());
                }
            }
        }
    }
}

vector_field! {
    /// `x'' + x'/10 + x + x³ = cos(ω t)/5`.
    struct Duffing [x, v; omega; t] {
        d/dt x = v;
        d/dt v = (t * omega).cos() * 0.2 - v * 0.1 - x - x * x * x;
        period = omega.recip() * (2.0 * PI), phase = 2.0 * PI;
    }
}

fn response(system: &mut dyn System) -> Branch {
    let rest = vec![0.0; system.names().dimension()];
    let curve = Continuation::new(system).from(&rest).at("omega", 0.6);
    curve.along("omega", 0.6..=2.0).trace().unwrap()
}

/// Both folds of the resonance agree with those by collocation with polynomials.
#[test]
fn harmonic_balance_finds_the_folds_of_a_resonance() {
    let folds = |branch: Branch| -> Vec<f64> {
        branch.of_kind(Kind::LP).map(|fold| fold.parameters[0]).collect()
    };
    let expected = folds(response(&mut collocated(Duffing, 30)));
    let found = folds(response(&mut Dense::new(HarmonicBalance { field: Duffing, harmonics: 16 })));
    assert_eq!((found.len(), expected.len()), (2, 2));
    for (found, expected) in found.iter().zip(expected) {
        close(*found, expected, 1e-10);
    }
}

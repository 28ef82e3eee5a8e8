//! Promise: the functions and rules of plates are what their formulas say.

use tangency::core::numerics::gauss_legendre;
use tangency::problems::plate::basis::Basis;
use tangency::problems::plate::{Rule, Support};

#[test]
fn bubbles_vanish_at_the_ends_and_are_orthonormal() {
    let basis = Basis::transverse([Support::Clamped; 2], false, 50);
    for end in [-1.0, 1.0] {
        for [value, slope, _] in basis.at(end) {
            assert!(value.abs() < 1e-14 && slope.abs() < 1e-14);
        }
    }
    let (x, w) = gauss_legendre(60);
    let table = basis.table(&x);
    for i in 0..50 {
        let dot: f64 = (0..60)
            .map(|q| w[q] * table.curvatures[i * 60 + q] * table.curvatures[3 * 60 + q])
            .sum();
        assert!((dot - f64::from(u8::from(i == 3))).abs() < 1e-13);
    }
}

#[test]
fn values_are_integrals_of_slopes_and_those_of_curvatures() {
    let basis = Basis::transverse([Support::SimplySupported, Support::Free], false, 20);
    let (x, w) = gauss_legendre(24);
    let (from, to) = (-0.3, 0.7);
    let at = |t: f64| basis.at(0.5 * (from + to) + 0.5 * (to - from) * t);
    for i in 0..20 {
        for order in 0..2 {
            let integral: f64 = (0..24).map(|q| 0.5 * w[q] * at(x[q])[i][order + 1]).sum();
            let change = at(1.0)[i][order] - at(-1.0)[i][order];
            assert!((integral - change).abs() < 1e-14);
        }
    }
}

#[test]
fn rules_are_exact_and_sum_to_one() {
    for symmetric in [true, false] {
        for rule in [Rule::exact(20, symmetric), Rule::halves(11, symmetric)] {
            let power = |n: i32| -> f64 {
                rule.nodes.iter().zip(&rule.weights).map(|(x, w)| w * x.powi(n)).sum()
            };
            assert!((power(0) - 1.0).abs() < 1e-14);
            assert!((power(20) - 1.0 / 21.0).abs() < 1e-14);
        }
    }
}

//! Promise: jets are Taylor series. Every operation and function agrees with nested dual numbers,
//! and beyond their order with identities; flows of jets agree with those of linear systems in
//! closed form.

use crate::common::close;
use num_dual::{Dual3, DualNum, HyperHyperDual64};
use proptest::prelude::*;
use tangency::core::ode::{Flow, Scheme, Settings};
use tangency::core::scalar::{Jet, JetError, Scalar, Space};
use tangency::vector_field;

type Small = Jet<64>;

/// All functions of one variable, with a number to which they apply for every number between 0
/// and 1.
fn functions<T: Scalar>(x: T) -> Vec<(&'static str, T)> {
    let (sin, cos) = (x * 3.0).sin_cos();
    vec![
        ("recip", (x + 0.5).recip()),
        ("powi", (x - 0.3).powi(5)),
        ("powi < 0", (x + 0.4).powi(-3)),
        ("powf", (x + 0.4).powf(1.7)),
        ("powd", (x + 0.4).powd(x)),
        ("sqrt", (x + 0.3).sqrt()),
        ("cbrt", (x - 1.4).cbrt()),
        ("exp", (x * 2.0).exp()),
        ("exp2", x.exp2()),
        ("exp_m1", x.exp_m1()),
        ("ln", (x + 0.4).ln()),
        ("log", (x + 0.4).log(3.0)),
        ("log2", (x + 0.4).log2()),
        ("log10", (x + 0.4).log10()),
        ("ln_1p", x.ln_1p()),
        ("sin", sin),
        ("cos", cos),
        ("tan", x.tan()),
        ("asin", (x * 0.8).asin()),
        ("acos", (x * 0.8).acos()),
        ("atan", (x * 3.0).atan()),
        ("atan2", (x - 0.5).atan2(x * 0.7 - 1.2)),
        ("atan2 steep", (x + 0.2).atan2(x * 0.3 + 0.05)),
        ("sinh", x.sinh()),
        ("cosh", x.cosh()),
        ("tanh", x.tanh()),
        ("asinh", x.asinh()),
        ("acosh", (x + 1.2).acosh()),
        ("atanh", (x * 0.8).atanh()),
        ("sph_j0", ((x + 0.3) * 2.0).sph_j0()),
        ("sph_j1", ((x + 0.3) * 2.0).sph_j1()),
        ("sph_j2", ((x + 0.3) * 2.0).sph_j2()),
        ("division", (x - 0.2) / (x * x + 1.0)),
        ("abs", (x - 2.0).abs() * x),
    ]
}

/// A function of three variables with all kinds of products and quotients.
fn mixed<T: Scalar>([x, y, z]: [T; 3]) -> T {
    let mut sum = (x * y - z).exp() / (z * z + 1.0) - (y / (x + 2.0)).sin() * z;
    sum *= x + 1.0;
    sum -= (z + 3.0).ln() * y;
    sum += x * y * z;
    sum /= y + 2.0;
    -sum * 0.5 + T::one()
}

/// A variable of jets of an order.
fn variable(variables: usize, order: usize, k: usize, value: f64) -> Small {
    Jet::variable(Space::of(variables, order).unwrap(), k, value).unwrap()
}

proptest! {
    /// Up to the third derivative.
    #[test]
    fn functions_agree_with_dual_numbers(x in 0.01..0.99_f64) {
        let dual = functions(Dual3::new(x, 1.0, 0.0, 0.0));
        for ((name, dual), (_, jet)) in dual.iter().zip(functions(variable(1, 3, 0, x))) {
            let expected = [dual.re, dual.v1, dual.v2 / 2.0, dual.v3 / 6.0];
            for (k, expected) in expected.iter().enumerate() {
                let found = jet.coefficient(&[k as u8]);
                let size = expected.abs().max(1.0);
                prop_assert!((found - expected).abs() < 2e-12 * size, "{name} {k}: {found} {expected}");
            }
        }
    }

    /// Mixed derivatives in three variables.
    #[test]
    fn products_agree_with_dual_numbers(x in -0.9..0.9_f64, y in -0.9..0.9_f64, z in -0.9..0.9_f64) {
        let at = [x, y, z];
        let jet = mixed([0, 1, 2].map(|k| variable(3, 3, k, at[k])));
        for [i, j, k] in [[0, 0, 0], [0, 0, 1], [0, 1, 2], [1, 2, 2], [2, 2, 2]] {
            let seed = |v: usize| {
                let part = |w: usize| f64::from(u8::from(v == w));
                HyperHyperDual64::new(at[v], part(i), part(j), part(k), 0.0, 0.0, 0.0, 0.0)
            };
            let derivative = mixed([0, 1, 2].map(seed)).eps1eps2eps3;
            let mut powers = [0_u8; 3];
            [i, j, k].iter().for_each(|v| powers[*v] += 1);
            let factorials: f64 =
                powers.iter().map(|n| [1.0, 1.0, 2.0, 6.0][usize::from(*n)]).product();
            let found = jet.coefficient(&powers) * factorials;
            prop_assert!((found - derivative).abs() < 1e-11 * derivative.abs().max(1.0));
        }
    }

    /// Identities to the eighth order.
    #[test]
    fn identities_hold_to_any_order(x in 0.1..0.9_f64) {
        let x = variable(1, 8, 0, x);
        let (sin, cos) = x.sin_cos();
        let (sinh, cosh) = (x.sinh(), x.cosh());
        let zeros = [
            sin * sin + cos * cos - 1.0,
            cosh * cosh - sinh * sinh - 1.0,
            sin / cos - x.tan(),
            sinh / cosh - x.tanh(),
            x.exp().ln() - x,
            x.exp_m1().ln_1p() - x,
            x.sqrt() * x.sqrt() - x,
            x.cbrt().powi(3) - x,
            x.powf(2.5) - x.powi(2) * x.sqrt(),
            sin.asin() - x,
            cos.acos() - x,
            x.tan().atan() - x,
            sin.atan2(cos) - x,
            cos.atan2(sin) + x - std::f64::consts::FRAC_PI_2,
            sinh.asinh() - x,
            cosh.acosh() - x,
            x.tanh().atanh() - x,
            x.recip() * x - 1.0,
            // The series near 0 against closed forms.
            x.sph_j0() * x - sin,
            x.sph_j1() * x * x - sin + x * cos,
            x.sph_j2() * x.powi(3) - (x * x * -1.0 + 3.0) * sin + x * cos * 3.0,
        ];
        for (k, zero) in zeros.iter().enumerate() {
            let scale = 1e-13 * 0.1_f64.min(x.coefficients()[0]).powi(-8);
            prop_assert!(zero.size() < scale, "identity {k}: {:?}", zero.coefficients());
        }
    }
}

/// A jet that is a constant takes part in everything; a quotient by a variable loses a degree; a
/// space that is too large is refused.
#[test]
fn constants_quotients_and_limits() {
    let (x, y) = (variable(2, 4, 0, 0.0), variable(2, 4, 1, 0.0));
    let five = Small::from(5.0);
    assert_eq!((five * five).coefficients(), [25.0]);
    let quotient = (x * x * five + x * y.exp()).divided_by(0);
    assert_eq!(quotient.coefficient(&[1, 0]), 5.0);
    assert_eq!(quotient.coefficient(&[0, 2]), 0.5);
    assert_eq!((x % 2.0 + (five % 3.0)).coefficients()[..3], [2.0, 1.0, 0.0]);
    assert!(matches!(Space::of(9, 5), Err(JetError::TooLarge { coefficients: 2002, .. })));
    assert!(matches!(Space::of(2, 9), Err(JetError::TooLarge { order: 9, .. })));
    let space = Space::of(4, 4).unwrap();
    assert!(matches!(Small::variable(space, 0, 1.0), Err(JetError::TooLarge { most: 64, .. })));
    assert!(Jet::<256>::variable(space, 0, 1.0).is_ok());
    assert_eq!(
        Jet::<256>::variable(space, 4, 1.0).unwrap_err(),
        JetError::NoVariable { variables: 4, variable: 4 }
    );
}

vector_field! {
    /// `x'' + ω²x = 0`.
    struct Oscillator [x, v; frequency] {
        d/dt x = v;
        d/dt v = -frequency * frequency * x;
    }
}

/// The flow by initial state, frequency and time to the fourth order: `x cos ωt + v/ω sin ωt`.
/// Steps are controlled by all coefficients.
#[test]
fn flows_have_the_jets_of_closed_forms() {
    let space = Space::of(4, 4).unwrap();
    let at = |k, value| Jet::<256>::variable(space, k, value).unwrap();
    let (start, omega, time) = ([at(0, 0.7), at(1, -0.2)], at(2, 2.0), at(3, 1.5));
    let mut x = start;
    let settings = Settings::new(Scheme::DormandPrince8, 1e-13);
    let mut flow = Flow::new(settings).unwrap().measured_by(Jet::size);
    flow.advance(&Oscillator, 0.0.into(), time, &mut x, &[omega]).unwrap();
    let (sin, cos) = (omega * time).sin_cos();
    let exact = [start[0] * cos + start[1] / omega * sin, start[1] * cos - start[0] * omega * sin];
    for (x, exact) in x.iter().zip(exact) {
        assert!((*x - exact).size() < 1e-11, "{}", (*x - exact).size());
    }
}

/// A flow for a time without a real part is exact in one step.
#[test]
fn flows_for_no_real_time_are_exact() {
    let space = Space::of(1, 8).unwrap();
    let time = Jet::<16>::variable(space, 0, 0.0).unwrap();
    let settings =
        Settings { first_step: Some(1.0), ..Settings::new(Scheme::DormandPrince8, 1e-12) };
    let mut x = [0.7, -0.2].map(Jet::from);
    let mut flow = Flow::new(settings).unwrap();
    let statistics =
        flow.advance(&Oscillator, 0.0.into(), time, &mut x, &[Jet::from(2.0)]).unwrap();
    assert_eq!(statistics.accepted, 1);
    let exact = (time * 2.0).cos() * 0.7 - (time * 2.0).sin() * 0.1;
    for (found, exact) in x[0].coefficients().iter().zip(exact.coefficients()) {
        close(*found, *exact, 1e-14);
    }
}

//! Promise: coefficients at special points of orbits with impacts tell how large the motion is that
//! simulations settle on beyond.

use crate::common::close;
use crate::common::settling::middle;
use crate::hybrid::systems::impact_oscillator::ClosedForm;
use crate::hybrid::systems::orbits::impacting;
use std::f64::consts::PI;
use std::ops::ControlFlow;
use tangency::core::bifurcation::NullSpace;
use tangency::core::continuation::{Branch, SpecialPoint};
use tangency::core::hybrid::{Event, HybridEquations, HybridFlow, HybridSettings, HybridState};
use tangency::core::linalg::Form;
use tangency::core::ode::{Scheme, Settings};
use tangency::core::system::{Kind, System};
use tangency::problems::classic::ImpactOscillator;

/// The size of the velocity after the impact along the critical direction `q`, `∫⟨q, q⟩ dt = 1`.
fn velocity_of_critical(system: &mut dyn System, point: &SpecialPoint) -> f64 {
    let form = Form::Antiperiodic;
    let x = [&point.state[..], &point.parameters].concat();
    let mut null = NullSpace::default();
    null.start(system, &x, form, None).unwrap();
    let right = null.of(system, &x, form, None).unwrap().right.clone();
    let square = system.deviation(&x, &right[0]).unwrap().square;
    let mut place = 0;
    for group in &system.names().unknowns {
        if group.name == "velocity" {
            break;
        }
        place += group.length;
    }
    right[0][place].abs() / square.sqrt()
}

/// The speeds after the impacts of motion from an orbit, disturbed, once it has settled.
fn speeds(
    system: &dyn HybridEquations,
    (branch, point): (&Branch, &SpecialPoint),
    p: &[f64],
    [settle, count]: [usize; 2],
) -> Vec<f64> {
    let (mut state, period): (HybridState<f64>, f64) = middle(system, branch, point);
    state.x[1] *= 1.0 + 1e-3;
    let flow = Settings::new(Scheme::DormandPrince8, 1e-13);
    let settings = HybridSettings { flow, ..HybridSettings::default() };
    let mut flow = HybridFlow::new(system, settings).unwrap();
    let mut speeds = Vec::new();
    let mut keep = |event: &Event<f64>| {
        speeds.push(event.after[1]);
        ControlFlow::Continue(())
    };
    flow.advance(&mut state, (settle + count) as f64 * period, p, &mut keep).unwrap();
    speeds.split_off(speeds.len() - count)
}

/// Three values `y(x)` at `x`, `2x`, `3x` as `y = a x + b x²` in the mean: `a`.
fn slope(x: f64, values: [f64; 3]) -> f64 {
    let [y1, y2, y3] = [values[0] / x, values[1] / (2.0 * x), values[2] / (3.0 * x)];
    // The line through (1, y1), (2, y2), (3, y3) at 0.
    (4.0 * y1 + y2 - 2.0 * y3) / 3.0
}

/// Beyond a period doubling the speeds of successive impacts differ by `2 ξ q_v`, where
/// `ξ² = −(growth_slope/doubling_c) (λ − λ₀)`.
#[test]
fn doubled_orbits_have_the_amplitude_of_their_coefficient() {
    let form = ClosedForm::usual(2.2);
    let system: &dyn HybridEquations = &ImpactOscillator;
    for mut start in impacting(&form, 1.3) {
        let branch = start.along("amplitude", [3.0, 6.0]).trace().unwrap();
        let doubling = branch.of_kind(Kind::PD).next().unwrap();
        let value = |name: &str| doubling.number(name).unwrap().value;
        let (c, growth) = (value("doubling_c"), value("growth_slope"));
        assert!(c < 0.0, "{c}");
        assert_eq!(doubling.subkind.as_deref(), Some("supercritical"));
        let q = velocity_of_critical(start.system.as_mut(), doubling);
        let away = (1e-3 * doubling.parameters[0]).copysign(growth);
        let square = |k: f64| {
            let mut p = doubling.parameters.clone();
            p[0] += k * away;
            let last = speeds(system, (&branch, doubling), &p, [20_000, 2]);
            (last[1] - last[0]).powi(2)
        };
        let found = slope(away, [1.0, 2.0, 3.0].map(square));
        let expected = -growth / c * (2.0 * q).powi(2);
        println!("{}: c = {c}, growth = {growth}: {found} {expected}", start.method);
        assert!((found - expected).abs() < 0.01 * expected.abs(), "{found} {expected}");
    }
}

/// At the critical damping the map from impact to impact keeps areas, whatever the speeds: tori are
/// born all at once, `Re d` is zero but for rounding, and no case is stated.
#[test]
fn torus_points_of_a_map_that_keeps_areas_are_degenerate() {
    let (frequency, restitution, u) = (2.2, 0.8_f64, 1.5);
    let critical = frequency / PI * restitution.ln();
    let beside = ClosedForm::new(frequency, restitution, critical + 0.03, 1.0);
    for mut start in impacting(&beside, u) {
        let branch = start.along("damping", [critical - 0.02, critical + 0.04]).trace().unwrap();
        let torus = branch.of_kind(Kind::TR).next().unwrap();
        let value = |name: &str| torus.number(name).unwrap().value;
        assert!(value("torus_d_re").abs() < 1e-12 * value("torus_d_im").abs());
        assert_eq!(torus.subkind, None);
        close(value("growth_slope"), -0.5, 1e-12);
    }
}

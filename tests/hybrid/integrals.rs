//! Promise: integrals over time are those of the closed form where a period has an impact, in
//! sweeps and on branches.

use crate::common::close;
use crate::hybrid::systems::as_another;
use crate::hybrid::systems::impact_oscillator::ClosedForm;
use std::f64::consts::TAU;
use tangency::core::attractor::{PeriodMap, StroboscopicMap};
use tangency::core::bvp::{BoundarySystem, Collocation, Mesh, Method, Shooting};
use tangency::core::hybrid::{Guard, HybridSettings, HybridState, HybridSystem, Member, Mode};
use tangency::core::orbit::{HybridOrbit, Itinerary};
use tangency::core::problem::{Forcing, Integral, Measure};
use tangency::core::scalar::Scalar;
use tangency::core::system::System;
use tangency::problems::classic::ImpactOscillator;

const NAMES: [&str; 4] = ["total", "mean", "norm", "duration"];

/// The oscillator with integrals of its displacement, the norm of both states, and the duration.
#[derive(Clone)]
struct Integrated;

macro_rules! oscillator {
    ($self:ident, $system:ident => $answer:expr) => {{
        let $system = ImpactOscillator;
        $answer
    }};
}

impl HybridSystem for Integrated {
    as_another!(self, oscillator);
    fn measures(&self) -> Vec<(String, Measure)> {
        let total = Measure::Integral(Integral::Total, vec!["displacement".into()]);
        let norm = Measure::norm(["displacement", "velocity"]);
        let measures = [total, Measure::mean("displacement"), norm, Measure::Duration];
        NAMES.map(String::from).into_iter().zip(measures).collect()
    }
}

/// Integrated over a period, the equation of motion says `∫ x dt = −(1 + e) u`: the impact changes
/// the velocity by `(1 + e) u`, and force and damping leave nothing. The norm is that of the closed
/// form by Simpson's rule.
#[test]
fn integrals_over_an_impact_are_those_of_the_closed_form() {
    let (form, u) = (ClosedForm::usual(2.2), 0.7);
    let (period, amplitude, impact) = (TAU / 2.2, form.amplitude(u), form.time(u));
    let p = [amplitude, 2.2, form.restitution, form.damping, form.clearance];
    let after = [impact, -form.restitution * u];
    let square = |k: usize| {
        let [x, v] = form.flight(amplitude, after, period * k as f64 / 2000.0);
        let weight = [2.0, 4.0][k % 2] - f64::from(u8::from(k.is_multiple_of(2000)));
        weight * (x * x + v * v) / 6000.0
    };
    let total = -(1.0 + form.restitution) * u;
    let norm = (0..=2000).map(square).sum::<f64>().sqrt();
    let exact = [total, total / period, norm, period];

    let mut map =
        PeriodMap::of(&Integrated, HybridSettings::default(), &NAMES.map(String::from)).unwrap();
    let x = form.flight(amplitude, after, 0.3 * period).to_vec();
    let state = HybridState { mode: ImpactOscillator::FLIGHT, time: impact + 0.3 * period, x };
    let found = map.record(&mut Member { state, p: p.to_vec() }).unwrap();
    assert_eq!(found.events.len(), 1);
    found.measures.iter().zip(exact).for_each(|(found, exact)| close(*found, exact, 1e-8));

    let collocation = Collocation::new(6).unwrap();
    for method in [Method::from(collocation), Method::from(Shooting::default())] {
        let itinerary = Itinerary::read("flight:impact", &Integrated).unwrap();
        let orbit = HybridOrbit::of(Integrated, itinerary).unwrap();
        let mut orbits = BoundarySystem::new(orbit, method, vec![Mesh::uniform(20)]).unwrap();
        let z = orbits.flowed(&[form.clearance, after[1]], &[impact, period], &p).unwrap();
        let names = orbits.names().monitors.clone();
        let mut values = vec![0.0; names.len()];
        orbits.monitors(&[&z[..], &p].concat(), 0, &mut values).unwrap();
        for (name, exact) in NAMES.iter().zip(exact) {
            let column = names.iter().position(|known| known == name).unwrap();
            close(values[column], exact, 1e-9);
        }
    }
}

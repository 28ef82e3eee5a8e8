//! Promise: points of codimension two on a curve of grazings are found and named whether the curve
//! is held for the orbits without the event or for those with it.

use crate::common::close;
use crate::hybrid::systems::impact_oscillator::{ClosedForm, resonance};
use crate::hybrid::systems::orbits::{DIGITS, found, nonimpacting};
use std::f64::consts::TAU;
use tangency::core::bvp::{BoundarySystem, Mesh, Shooting};
use tangency::core::continuation::{Branch, Continuation, Settings};
use tangency::core::ode::Scheme;
use tangency::core::orbit::{HybridOrbit, Itinerary};
use tangency::core::system::{Kind, System};
use tangency::hybrid_system;
use tangency::problems::classic::ImpactOscillator;

/// The curve of grazings through that of a branch, held without the event and with it.
fn from_both_sides(
    system: &mut dyn System,
    branch: &Branch,
    [first, second]: [(&str, [f64; 2]); 2],
    max_step: f64,
) -> [Branch; 2] {
    let label = branch.of_kind(Kind::G).next().unwrap().label;
    [false, true].map(|switched| {
        let run = Continuation::new(&mut *system).restart(branch, label).hold(Kind::G);
        let run = if switched { run.switch() } else { run };
        let run = run.settings(Settings { max_step, ..Settings::default() });
        let run = run.along(first.0, first.1[0]..=first.1[1]);
        run.along(second.0, second.1[0]..=second.1[1]).trace().unwrap()
    })
}

/// Grazing orbits in two parameters: `A = D(ω) d` to the digits, and the degenerate points at
/// `ω = 2ω_d/n`, where families with an impact are born upright. Multipliers without impacts are
/// those of free motion, of modulus less than 1, so that nothing else happens.
#[test]
fn resonant_grazings_are_degenerate() {
    let form = ClosedForm::usual(1.2);
    for mut start in nonimpacting(&form, 0.5) {
        let range = [0.1 * form.grazing(), 2.0 * form.grazing()];
        let branch = start.along("amplitude", range).trace().unwrap();
        let plane = [("amplitude", [0.0, 10.0]), ("frequency", [0.3, 2.3])];
        for curve in from_both_sides(start.system.as_mut(), &branch, plane, 0.02) {
            let column = |name: &str| curve.column(name).unwrap();
            let [amplitude, frequency] = ["amplitude", "frequency"].map(column);
            for point in &curve.points {
                let expected = ClosedForm::usual(point.value(frequency).unwrap()).grazing();
                close(point.value(amplitude).unwrap(), expected, DIGITS);
            }
            assert!(found(&curve).iter().all(|(kind, _)| *kind == Kind::GD), "{:?}", found(&curve));
            let points = curve.of_kind(Kind::GD).map(|point| point.value(frequency).unwrap());
            let mut points: Vec<f64> = points.collect();
            points.sort_by(|a, b| b.total_cmp(a));
            assert_eq!(points.len(), 6, "{}: {points:?}", curve.name);
            for (n, point) in points.iter().enumerate() {
                close(*point, resonance(n + 1, form.damping), DIGITS);
            }
        }
    }
}

hybrid_system! {
    /// The impact oscillator beside a linear oscillator in a frame that turns by half in a period,
    /// which has the multipliers `−e^{2πμ}` and `−e^{−2π}`: the parameters are the amplitude and μ.
    struct Turning [amplitude, mu; t] {
        period = T::from(TAU / FREQUENCY);
        mode flight [displacement, velocity, s, z] {
            let phase = t * FREQUENCY;
            let [cosine, sine] = [phase.cos(), phase.sin()];
            let along = ((cosine + 1.0) * s + sine * z) * 0.5;
            let across = (sine * s + (-cosine + 1.0) * z) * 0.5;
            d/dt displacement = velocity;
            d/dt velocity = amplitude * cosine - displacement - velocity * DAMPING;
            d/dt s = (mu * along - (s - along) - z * 0.5) * FREQUENCY;
            d/dt z = (mu * across - (z - across) + s * 0.5) * FREQUENCY;
            event impact: -displacement + 1.0
                => flight { displacement, velocity: -velocity * 0.8, s, z };
        }
    }
}

const FREQUENCY: f64 = 1.2;
const DAMPING: f64 = 0.1;

/// Where a multiplier is −1 with the impact and without it, at μ = 0, both flips are named, and
/// nothing else is.
#[test]
fn flips_are_named() {
    let orbit = HybridOrbit::of(Turning, Itinerary::smooth(ImpactOscillator::FLIGHT, 1)).unwrap();
    let method = Shooting::new(Scheme::DormandPrince8, 1e-13).unwrap();
    let mut orbits = BoundarySystem::new(orbit, method, vec![Mesh::uniform(1)]).unwrap();
    let grazing = ClosedForm::new(FREQUENCY, 0.8, DAMPING, 1.0).grazing();
    let run = Continuation::new(&mut orbits).at("amplitude", 0.1).at("mu", -0.05);
    let branch = run.along("amplitude", 0.1..=2.0).trace().unwrap();
    let plane = [("amplitude", [0.0, 2.0]), ("mu", [-0.06, 0.03])];
    for curve in from_both_sides(&mut orbits, &branch, plane, 0.1) {
        let mut kinds: Vec<&str> = found(&curve).iter().map(|(kind, _)| kind.letters()).collect();
        kinds.sort_unstable();
        assert_eq!(kinds, ["GF", "GP"], "{}", curve.name);
        for special in [Kind::GF, Kind::GP].iter().flat_map(|kind| curve.of_kind(*kind)) {
            close(special.parameters[0], grazing, DIGITS);
            close(special.parameters[1], 0.0, DIGITS);
        }
    }
}

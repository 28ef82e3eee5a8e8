//! Promise: fixed points of local maps, their multipliers, folds and period doublings approach
//! those of the flow at the order of the map; the scenario of a grazing and the curves that begin
//! at a degenerate one are those of the literature and of closed forms.

use crate::common::ALL;
use crate::common::{close, solved};
use crate::grazing::points::{actuator, along_grazings, oscillator, settings};
use crate::hybrid::systems::impact_oscillator::{ClosedForm, flow, resonance};
use crate::hybrid::systems::multipliers;
use std::f64::consts::PI;
use std::sync::Arc;
use tangency::core::bvp::{BoundarySystem, Mesh, Shooting};
use tangency::core::continuation::{Branch, Continuation, Settings};
use tangency::core::local_map::{LocalMap, LocalOrbit, Scenario};
use tangency::core::manifold::{ManifoldSettings, Side, manifold};
use tangency::core::ode::Scheme;
use tangency::core::orbit::{HybridOrbit, Itinerary};
use tangency::core::problem::DiscreteMap;
use tangency::core::system::{Kind, System};
use tangency::problems::mita::Actuator;
use tangency::scene::{ExpansionError, expanded};

/// The displacement and the phase of the virtual point of the orbit with one impact of speed `u`,
/// and its amplitude.
fn exact(form: &ClosedForm, u: f64) -> [f64; 3] {
    let (amplitude, time) = (form.amplitude(u), form.time(u));
    let [p, v] = form.motion(amplitude, time);
    let free = [form.clearance - p, u - v];
    let motion = |after: f64| {
        let ([[a, b], [c, d]], [p, v]) =
            (flow(after, form.damping), form.motion(amplitude, time + after));
        [p + a * free[0] + b * free[1], v + c * free[0] + d * free[1]]
    };
    let mut after = 0.0;
    for _ in 0..50 {
        after += motion(after)[1] / (form.clearance * form.frequency.powi(2));
    }
    [motion(after)[0], (time + after) * form.frequency, amplitude]
}

/// Fixed points and the sum of their multipliers, order by order: halving the impact's speed
/// divides the error of the points by `2^{n+1}`, and that of the multipliers, which are derivatives
/// with respect to `y` over `y`, by `2^{n−1}`.
#[test]
fn fixed_points_have_the_order_of_the_map() {
    let form = ClosedForm::usual(1.2);
    let map = oscillator(&form, &["amplitude"], 5);
    let errors = |u: f64, order: usize| -> [f64; 2] {
        let [displacement, phase, amplitude] = exact(&form, u);
        let origin = map.origin().0;
        let expected = [displacement - origin[0], phase - origin[1]];
        let mut orbits = LocalOrbit::of(map.clone(), &[true]).to_order(order).system().unwrap();
        let p = [amplitude - form.grazing()];
        let depth = expected[0].sqrt();
        let z = orbits.flowed(&expected, &[depth], &p).unwrap();
        let x = solved(&mut orbits, &z, &p).unwrap();
        let found = orbits.states(&x, 0, 0.0).unwrap();
        orbits.assemble(&x).unwrap();
        let spectrum = orbits.spectrum(&x, ALL).unwrap().unwrap();
        let sum: f64 = spectrum.iter().map(|mu| mu.0).sum();
        let miss = (x[z.len() - 1] - depth).abs().max((found[1] - expected[1]).abs());
        [miss, (sum - form.trace(u)).abs()]
    };
    for order in 1..=5 {
        let (far, near) = (errors(0.04, order), errors(0.02, order));
        // To first order the penetration y² is none, and multipliers are infinite.
        let kinds = if order == 1 { 1 } else { 2 };
        for (k, (far, near)) in far.iter().zip(near).enumerate().take(kinds) {
            let expected = [order as f64 + 1.0, order as f64 - 1.0][k];
            let rate = (far / near).log2();
            let rounding = [1e-12, 1e-8][k];
            assert!(rate > expected - 0.4 || near < rounding, "{order} {k}: {far:.2e} {near:.2e}");
        }
    }
    // Both multipliers, of which one is large.
    let u = 0.01;
    let [displacement, phase, amplitude] = exact(&form, u);
    let start = [displacement - map.origin().0[0], phase - map.origin().0[1]];
    let mut orbits = LocalOrbit::of(map.clone(), &[true]).system().unwrap();
    let p = [amplitude - form.grazing()];
    let z = orbits.flowed(&start, &[start[0].sqrt()], &p).unwrap();
    let x = solved(&mut orbits, &z, &p).unwrap();
    orbits.assemble(&x).unwrap();
    let found = orbits.spectrum(&x, ALL).unwrap().unwrap();
    for (found, expected) in found.iter().zip(multipliers(form.trace(u), form.determinant())) {
        close(found.0, expected.0, 1e-6 * expected.0.abs().max(1.0));
    }
}

/// Deviations of a parameter at the special points of a kind.
fn at(branch: &Branch, kind: Kind) -> Vec<f64> {
    branch.of_kind(kind).map(|point| point.parameters[0]).collect()
}

/// The branch of fixed points with an impact from the grazing.
fn from_grazing(map: &LocalMap, order: usize, parameter: &str, range: [f64; 2]) -> Branch {
    let mut orbits = LocalOrbit::of(map.clone(), &[true]).to_order(order).system().unwrap();
    let p = vec![0.0; map.parameters().len()];
    let start = orbits.flowed(&[0.0, 0.0], &[0.0], &p).unwrap();
    let settings = Settings { initial_step: 1e-4, max_step: 2e-3, ..Settings::default() };
    Continuation::new(&mut orbits)
        .from(&start)
        .along(parameter, range[0]..=range[1])
        .settings(settings)
        .trace()
        .unwrap()
}

/// Fixed points of the map without impacts graze at once, and the switch there leads to those with
/// one.
#[test]
fn passing_points_graze_where_impacting_ones_begin() {
    let form = ClosedForm::usual(1.0);
    let map = oscillator(&form, &["amplitude"], 3);
    let mut orbits = LocalOrbit::of(map.clone(), &[false]).system().unwrap();
    let start = orbits.flowed(&[-5e-4, 0.0], &[5e-4], &[-5e-5]).unwrap();
    let range = -1e-4..=1e-4;
    let passing = Continuation::new(&mut orbits)
        .from(&start)
        .at("amplitude", -5e-5)
        .along("amplitude", range.clone())
        .trace()
        .unwrap();
    let [grazing] = at(&passing, Kind::G)[..] else { panic!("{:?}", at(&passing, Kind::G)) };
    close(grazing, 0.0, 1e-12);
    let label = passing.of_kind(Kind::G).next().unwrap().label;
    let impacting = Continuation::new(&mut orbits)
        .restart(&passing, label)
        .switch()
        .along("amplitude", range)
        .trace()
        .unwrap();
    let [fold] = at(&impacting, Kind::LP)[..] else { panic!("{:?}", at(&impacting, Kind::LP)) };
    close(form.grazing() + fold, form.fold_amplitude(), 1e-9);
    assert_eq!(impacting.itinerary, "impact");
}

/// At a period doubling a branch of two impacts begins, whose points the map takes to each other;
/// its multipliers are those of the product of the map's derivatives.
#[test]
fn doubled_orbits_are_those_of_the_iterated_map() {
    let form = ClosedForm::usual(resonance(1, 0.1) + 0.004);
    let map = oscillator(&form, &["amplitude"], 4);
    let single = from_grazing(&map, 4, "amplitude", [-5e-4, 5e-4]);
    let label = single.of_kind(Kind::PD).next().unwrap().label;
    let mut orbits = LocalOrbit::of(map.clone(), &[true]).system().unwrap();
    let settings = Settings { initial_step: 1e-4, max_step: 1e-2, ..Settings::default() };
    let doubled = Continuation::new(&mut orbits)
        .restart(&single, label)
        .switch()
        .along("amplitude", -5e-4..=5e-4)
        .settings(settings)
        .trace()
        .unwrap();
    assert_eq!(doubled.itinerary, "impact impact");
    let end = doubled.of_kind(Kind::EP).next().unwrap();
    let x = [&end.state[..], &end.parameters].concat();
    orbits.resume_from(&doubled.solution(end)).unwrap();
    let points = [0, 1].map(|k| orbits.states(&x, k, 0.0).unwrap());
    let dual = |x: f64| num_dual::Dual64::from(x);
    let p: Vec<_> = end.parameters.iter().map(|p| dual(*p)).collect();
    let mut iteration = map.iteration();
    let mut derivative = nalgebra::Matrix2::<f64>::identity();
    for k in 0..2 {
        let columns = [0, 1].map(|column| {
            let mut image: Vec<_> = points[k].iter().map(|x| dual(*x)).collect();
            image[column] = image[column].derivative();
            assert!(iteration.penetration(&image, &p).re > 1e-6);
            iteration.apply(&mut image, &p);
            let values: Vec<f64> = image.iter().map(|x| x.re).collect();
            crate::common::agree(&values, &points[1 - k], 1e-11);
            nalgebra::Vector2::new(image[0].eps, image[1].eps)
        });
        derivative = nalgebra::Matrix2::from_columns(&columns) * derivative;
    }
    orbits.assemble(&x).unwrap();
    let spectrum = orbits.spectrum(&x, ALL).unwrap().unwrap();
    let expected = multipliers(derivative.trace(), derivative.determinant());
    for (found, expected) in spectrum.iter().zip(expected) {
        close(found.0, expected.0, 1e-8 * expected.0.abs().max(1.0));
        close(found.1, expected.1, 1e-8);
    }
}

/// Folds and period doublings of the oscillator on both sides of a resonance: each order brings
/// digits.
#[test]
fn special_points_gain_by_every_order() {
    let resonance = resonance(1, 0.1);
    for (frequency, kind) in [(resonance - 4e-4, Kind::LP), (resonance + 0.004, Kind::PD)] {
        let form = ClosedForm::usual(frequency);
        let expected = match kind {
            Kind::LP => form.fold_amplitude(),
            _ => form.amplitude(form.doubling()),
        } - form.grazing();
        let map = oscillator(&form, &["amplitude"], 5);
        let range = [-5.0 * expected.abs(), 5.0 * expected.abs()];
        let error = |order: usize| {
            let branch = from_grazing(&map, order, "amplitude", range);
            let [found] = at(&branch, kind)[..] else {
                panic!("{kind} {order}: {:?}", at(&branch, kind))
            };
            (found - expected).abs() / expected.abs()
        };
        let errors: Vec<f64> = (2..=5).map(error).collect();
        assert!(errors[3] < 1e-4, "{errors:?}");
        assert!(errors.windows(2).all(|pair| pair[1] < 0.5 * pair[0]), "{errors:?}");
    }
}

/// The series of the curves of folds and period doublings from the resonance, against closed forms:
/// `A_SN(ω)` where the speed at the fold is positive, `A_PD(ω)` where that at the doubling is.
#[test]
fn curves_from_a_resonance_are_those_of_closed_forms() {
    let origin = resonance(1, 0.1);
    let names = ["amplitude", "frequency"];
    let map = oscillator(&ClosedForm::usual(origin), &names, 5);
    for kind in [Kind::LP, Kind::PD] {
        let series = expanded(&map, kind, names).unwrap();
        let error = |change: f64, order: usize| {
            let form = ClosedForm::usual(origin + change);
            let (speed, amplitude) = match kind {
                Kind::LP => (form.fold(), form.fold_amplitude()),
                _ => (form.doubling(), form.amplitude(form.doubling())),
            };
            assert_eq!(speed > 0.0, series.depth[0] * change > 0.0, "{kind}: the side");
            let terms = series.parameter[..order].iter().enumerate();
            let sum: f64 = terms.map(|(k, c)| c * change.powi(k as i32 + 1)).sum();
            (sum - (amplitude - map.origin().1[0])).abs()
        };
        let step = [1e-2, 1e-3][usize::from(kind == Kind::PD)];
        for order in 1..=5 {
            let (far, near) = (error(step, order), error(0.5 * step, order));
            let rate = (far / near).log2();
            assert!(
                rate > order as f64 + 0.6 || near < 1e-12,
                "{kind} {order}: {far:.2e} {near:.2e}"
            );
        }
    }
    let refused = expanded(&map, Kind::HB, names).unwrap_err();
    assert!(matches!(refused, ExpansionError::NoCurve(Kind::HB)));
    let elsewhere = oscillator(&ClosedForm::usual(1.2), &names, 2);
    let refused = expanded(&elsewhere, Kind::LP, names).unwrap_err();
    assert!(matches!(refused, ExpansionError::NotDegenerate(_)), "{refused}");
}

/// X. Zhao (2004), section 5.3: `ΔV = 0.224982 Δω + 17.7774 Δω²` for folds, `Δω > 0`, and
/// `0.224982 Δω + 1557.35 Δω²` for period doublings, `Δω < 0`.
#[test]
fn curves_from_the_degenerate_point_are_those_of_the_literature() {
    let names = ["voltage", "frequency"];
    let point = actuator(0.171066688958, 0.487808700440, 5.496543861);
    let map = LocalMap::of(&Actuator, &point, &names, settings(3)).unwrap();
    for (kind, curvature, digit, side) in
        [(Kind::LP, 17.7774, 1e-4, 1.0), (Kind::PD, 1557.35, 1e-2, -1.0)]
    {
        let series = expanded(&map, kind, names).unwrap();
        close(series.parameter[0], 0.224982, 0.51e-6);
        close(series.parameter[1], curvature, 0.51 * digit);
        assert!(series.depth[0] * side > 0.0, "{series:?}");
    }
}

/// X. Zhao (2004), chapter 4: types I, II and III at ω = 0.5, 0.485, 0.45. At ω = 0.5 one
/// multiplier is about 0.123/u.
#[test]
fn scenarios_are_those_of_the_literature() {
    for (frequency, voltage, phase, scenario, sides) in [
        (0.5, 0.2271775831, 5.985512558, Scenario::Jump, [-1.0, -1.0]),
        (0.485, 0.1717414232, 5.406828312, Scenario::Continuous, [-1.0, 1.0]),
        (0.45, 0.2286188177, 4.963861078, Scenario::Unstable, [1.0, 1.0]),
    ] {
        let point = actuator(voltage, frequency, phase).located(&Actuator, "voltage").unwrap();
        close(point.p[0], voltage, 6e-11);
        let map = LocalMap::of(&Actuator, &point, &["voltage"], settings(2)).unwrap();
        let found = map.classified("voltage").unwrap();
        assert_eq!(found.scenario, scenario);
        assert_eq!([found.distance.signum(), found.depth.signum()], sides, "{found:?}");
        // The sign of P^q_θ, with the √-coefficient negative.
        let shift = map.smooth()[0].coefficient(&[0, 1, 0]);
        assert!(found.growth * shift < 0.0 && (shift < 0.0) == (scenario == Scenario::Jump));
        if frequency == 0.5 {
            let force = (voltage * phase.sin() / 0.5).powi(2) - 0.5;
            close(found.growth * (-2.0 * force).sqrt(), 0.123, 5e-4);
        }
        let unstable = found.multipliers.iter().filter(|mu| mu.0.hypot(mu.1) > 1.0).count();
        assert_eq!(unstable, usize::from(scenario == Scenario::Unstable));
    }
}

/// The actuator's orbits with one impact in a period, by shooting, from their grazing.
fn by_flow(frequency: f64, point: &tangency::core::local_map::GrazingPoint) -> Branch {
    let itinerary = Itinerary::read("forward:rest stick:front", &Actuator).unwrap();
    let problem = HybridOrbit::of(Actuator, itinerary).unwrap();
    let method = Shooting::new(Scheme::DormandPrince8, 1e-13).unwrap();
    let meshes = vec![Mesh::uniform(1); 2];
    let mut orbits = BoundarySystem::new(problem, method, meshes).unwrap();
    let extras = [point.time, 0.0, PI / frequency];
    let starts = [0.5, 0.0, 0.0, 0.0, 0.5, 0.0];
    let z = orbits.flowed(&starts, &extras, &point.p).unwrap();
    let names = orbits.names().parameters.clone();
    let run = Continuation::new(&mut orbits).from(&z);
    let run = names.iter().zip(&point.p).fold(run, |run, (name, p)| run.at(name, *p));
    run.along("voltage", 0.16..=0.2).trace().unwrap()
}

/// The fold and the period doubling of the actuator near the degenerate point, map against flow:
/// the third order gains.
#[test]
fn special_points_of_the_actuator_approach_those_of_the_flow() {
    for (frequency, kind) in [(0.4888, Kind::LP), (0.4876, Kind::PD)] {
        let point = along_grazings(frequency);
        let flow = at(&by_flow(frequency, &point), kind);
        let expected = flow[0] - point.p[0];
        let map = LocalMap::of(&Actuator, &point, &["voltage"], settings(5)).unwrap();
        let range = [-4.0 * expected.abs(), 4.0 * expected.abs()];
        let error = |order: usize| {
            let found = at(&from_grazing(&map, order, "voltage", range), kind);
            (found[0] - expected).abs() / expected.abs()
        };
        let errors: Vec<f64> = (2..=4).map(error).collect();
        assert!(errors[1] < errors[0] && errors[2] < 1e-2 * errors[0], "{errors:?}");
    }
}

/// The saddle with one impact in a period, near the grazing, has manifolds under the local map: the
/// multipliers agree with the closed form, and iterates of points on the stable manifold come nearer.
#[test]
fn impacting_saddles_have_manifolds() {
    let form = ClosedForm::usual(1.2);
    let map = oscillator(&form, &["amplitude"], 5);
    let u = 0.01;
    let [displacement, phase, amplitude] = exact(&form, u);
    let start = [displacement - map.origin().0[0], phase - map.origin().0[1]];
    let p = [amplitude - form.grazing()];
    let expected = multipliers(form.trace(u), form.determinant());
    let settings =
        ManifoldSettings { length: 0.1, resolution: 1e-6, ..ManifoldSettings::default() };
    let map = Arc::new(map);
    let grow = |side| manifold(&map, &start, &p, side, &settings).unwrap().remove(0);
    let [unstable, stable] = [Side::Unstable, Side::Stable].map(grow);
    for (curve, expected) in [&unstable, &stable].into_iter().zip(expected) {
        close(curve.multiplier, expected.0, 1e-6 * expected.0.abs().max(1.0));
        for half in &curve.halves {
            assert!(half.points.len() > 10, "{:?}", half.end);
            // At the grazing the map has a corner, and so has the curve.
            assert!(half.deviation.unwrap() <= 10.0 * settings.resolution, "{:?}", half.deviation);
        }
    }
    let away = |at: &[f64]| (at[0] - stable.saddle[0]).hypot(at[1] - stable.saddle[1]);
    for half in &stable.halves {
        let mut at = half.points.last().unwrap().at.to_vec();
        let (first, mut image) = (away(&at), at.clone());
        for _ in 0..6 {
            map.next(&at, &p, &mut image);
            at.clone_from(&image);
        }
        assert!(away(&at) < 0.1 * first, "{:.1e} after {first:.1e}", away(&at));
    }
}

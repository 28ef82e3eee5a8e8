//! The sine model of a simply supported plate against values from independent formulations.

use crate::common::ALL;
use crate::plates::models::{
    ASPECT, FORCE_X, FORCE_Y, GAP_RATIO, LOAD, NU, PRESSURE, SHEAR, all_parameters,
};
use crate::plates::plate_fold::{equilibrium, fold, one_mode_start};
use std::f64::consts::PI;
use tangency::core::failure::one_line;
use tangency::core::numerics::gauss_legendre;
use tangency::core::problem::{Dynamics, ZeroProblem};
use tangency::core::system::{Dense, Functional, System};
use tangency::problems::plate::sine::{SinePlate, SineSettings};
use tangency::problems::plate::{
    InPlane, Model, PlateError, PlateSettings, Projection, Theory, Units,
};

fn plate(settings: SineSettings) -> Dense<SinePlate> {
    Dense::new(SinePlate::new(settings).expect("valid settings"))
}

fn settings(modes: usize) -> SineSettings {
    SineSettings { modes, ..Default::default() }
}

fn parameters(values: &[(usize, f64)]) -> Vec<f64> {
    let mut p = SinePlate::new(settings(1)).expect("valid settings").defaults();
    values.iter().for_each(|&(index, value)| p[index] = value);
    p
}

/// `(λ, w)` at pull-in.
fn pull_in(settings: SineSettings, gap_ratio: f64, aspect: f64) -> (f64, f64) {
    let mut system = plate(settings);
    let p = parameters(&[(GAP_RATIO, gap_ratio), (ASPECT, aspect)]);
    let start = one_mode_start(&mut system, &p);
    let x = fold(&mut system, start);
    let n = settings.modes;
    (x[n + LOAD], system.problem().deflection(&x[..n], 0.5, 0.5))
}

fn assert_close(what: &str, value: f64, expected: f64, tolerance: f64) {
    let difference = value - expected;
    assert!(difference.abs() <= tolerance, "{what}: {value}, not {expected}: {difference:.1e}");
}

#[test]
fn few_modes_give_the_loads_of_figures_3_3_to_3_5() {
    let table = [
        (Projection::Multiplied, 1, 156.13641, 0.84149),
        (Projection::Multiplied, 2, 151.98287, 0.75072),
        (Projection::Multiplied, 6, 144.09066, 0.67289),
        (Projection::Multiplied, 15, 144.48157, 0.67018),
        (Projection::Direct, 1, 145.26607, 0.67886),
        (Projection::Direct, 2, 145.02589, 0.67338),
        (Projection::Direct, 6, 144.46514, 0.67012),
        (Projection::Direct, 15, 144.46817, 0.66994),
    ];
    for (projection, modes, load, deflection) in table {
        let found = pull_in(SineSettings { projection, ..settings(modes) }, 2.0, 1.0);
        assert_close(&format!("load, {modes} modes, {projection:?}"), found.0, load, 5.1e-6);
        assert_close(&format!("w, {modes} modes, {projection:?}"), found.1, deflection, 5.1e-6);
    }
}

#[test]
fn pull_in_of_the_square_plate() {
    let table = [
        (InPlane::Slide, 0.0, 52.633290209, 0.4554324767),
        (InPlane::Slide, 0.5, 56.549468343, 0.4909666590),
        (InPlane::Slide, 1.0, 71.252716501, 0.577513077),
        (InPlane::Slide, 2.0, 144.467913425, 0.66999236),
        (InPlane::Straight, 0.0, 52.633290209, 0.4554324767),
        (InPlane::Straight, 0.5, 53.594250295, 0.4646376967),
        (InPlane::Straight, 1.0, 56.705057715, 0.4923202689),
        (InPlane::Straight, 2.0, 72.090268748, 0.5809940633),
    ];
    for (in_plane, gap_ratio, load, deflection) in table {
        let found = pull_in(SineSettings { in_plane, ..settings(90) }, gap_ratio, 1.0);
        assert_close(&format!("load, {in_plane:?}, {gap_ratio}"), found.0, load, 1e-9 * load);
        assert_close(&format!("w, {in_plane:?}, {gap_ratio}"), found.1, deflection, 4e-7);
    }
}

#[test]
fn the_series_converges_algebraically() {
    // N modes reach wave numbers proportional to √N: the error falls with their sixth power or so.
    for (modes, tolerance) in [(15, 2e-6), (40, 1.2e-8), (80, 8e-10), (160, 1e-10)] {
        let (load, _) = pull_in(settings(modes), 2.0, 1.0);
        let error = (load / 144.467913425 - 1.0).abs();
        assert!(error < tolerance, "{modes} modes: {error:.1e}");
        assert!(error > tolerance / 4.0, "{modes} modes: better than stated, {error:.1e}");
    }
}

#[test]
fn pull_in_against_aspect_ratio() {
    let table = [
        (1.5, 0.0, 27.4708175, 0.454336),
        (1.5, 0.5, 29.7298644, 0.493245),
        (1.5, 1.0, 38.3259452, 0.584083),
        (1.5, 2.0, 80.851635, 0.67048),
        (2.0, 0.0, 20.6023851, 0.451844),
        (2.0, 0.5, 22.5318181, 0.495496),
        (2.0, 1.0, 30.0071894, 0.590974),
        (2.0, 2.0, 66.764280, 0.66735),
        (4.0, 0.0, 15.0297110, 0.436707),
        (4.0, 0.5, 16.7876148, 0.488879),
        (4.0, 1.0, 23.8894035, 0.587289),
        (4.0, 2.0, 58.769799, 0.64312),
    ];
    for (aspect, gap_ratio, load, deflection) in table {
        // A circle of wave numbers suits a long plate badly: it takes more of them.
        let modes = if aspect == 4.0 { 120 } else { 60 };
        let found = pull_in(settings(modes), gap_ratio, aspect);
        let what = format!("aspect {aspect}, gap ratio {gap_ratio}");
        assert_close(&format!("load, {what}"), found.0, load, 4e-8 * load);
        assert_close(&format!("w, {what}"), found.1, deflection, 2e-5);
    }
}

#[test]
fn linear_theory_is_von_karman_without_a_gap() {
    let linear = pull_in(SineSettings { theory: Theory::Linear, ..settings(15) }, 2.0, 1.0);
    let flat = pull_in(settings(15), 0.0, 1.0);
    assert_close("load", linear.0, flat.0, 1e-10);
}

/// `w` and its second derivatives `w_ξξ`, `w_ηη`, `w_ξη` of one product of sines or cosines.
fn product(m: f64, n: f64, x: f64, y: f64, sines: bool) -> [f64; 4] {
    let ((sx, cx), (sy, cy)) = ((m * PI * x).sin_cos(), (n * PI * y).sin_cos());
    let (f, g, mixed) = if sines { (sx, sy, cx * cy) } else { (cx, cy, sx * sy) };
    let (m, n) = (m * PI, n * PI);
    [f * g, -m * m * f * g, -n * n * f * g, m * n * mixed]
}

fn bracket(f: &[f64; 4], g: &[f64; 4]) -> f64 {
    f[1] * g[2] + f[2] * g[1] - 2.0 * f[3] * g[3]
}

fn add(sum: &mut [f64; 4], factor: f64, term: [f64; 4]) {
    sum.iter_mut().zip(term).for_each(|(sum, term)| *sum += factor * term);
}

/// Points and weights on the whole unit square.
fn square() -> Vec<(f64, f64, f64)> {
    let (nodes, weights) = gauss_legendre(60);
    let line: Vec<_> = nodes.iter().zip(&weights).map(|(x, w)| (0.5 + 0.5 * x, 0.5 * w)).collect();
    line.iter().flat_map(|&(x, w)| line.iter().map(move |&(y, v)| (x, y, w * v))).collect()
}

/// Coefficients that fall with the order, without any symmetry.
fn sample(n: usize) -> Vec<f64> {
    (0..n).map(|i| 0.3 * (1.0 + 1.7 * i as f64).cos() / (1.0 + i as f64).powi(2)).collect()
}

#[test]
fn the_stress_function_solves_its_equation() {
    let alpha = 1.7;
    let model = SinePlate::new(settings(15)).expect("valid settings");
    let z = sample(15);
    let modes = model.modes();
    let field = |x, y| {
        let mut w = [0.0; 4];
        for (&(m, n), &z) in modes.iter().zip(&z) {
            add(&mut w, z, product(m as f64, n as f64, x, y, true));
        }
        w
    };
    let terms = model.stress_function(&z, &parameters(&[(ASPECT, alpha)]));
    assert!(terms.len() > 50);
    for term in terms {
        let (m, n) = (term.m as f64, term.n as f64);
        let (mut projection, mut norm) = (0.0, 0.0);
        for (x, y, weight) in square() {
            let psi = product(m, n, x, y, false)[0];
            let w = field(x, y);
            projection += weight * psi * bracket(&w, &w);
            norm += weight * psi * psi;
        }
        let operator = (PI * PI * (m * m + n * n / (alpha * alpha))).powi(2);
        let expected = -projection / norm / (2.0 * alpha * alpha) / operator;
        assert_close(&format!("f_{m}{n}"), term.coefficient, expected, 1e-14);
    }
}

#[test]
fn mean_tensions_are_those_of_the_mean_strains() {
    let (alpha, nu, gap_ratio) = (1.3, 0.25, 1.5);
    let model = SinePlate::new(settings(6)).expect("valid settings");
    let z = sample(6);
    let (mut strain_x, mut strain_y) = (0.0, 0.0);
    for (x, y, weight) in square() {
        let (mut slope_x, mut slope_y) = (0.0, 0.0);
        for ((m, n), z) in model.modes().into_iter().zip(&z) {
            let (m, n) = (m as f64 * PI, n as f64 * PI);
            slope_x += z * m * (m * x).cos() * (n * y).sin();
            slope_y += z * n * (m * x).sin() * (n * y).cos() / alpha;
        }
        strain_x += weight * 0.5 * slope_x * slope_x;
        strain_y += weight * 0.5 * slope_y * slope_y;
    }
    let p = parameters(&[(GAP_RATIO, gap_ratio), (ASPECT, alpha), (NU, nu)]);
    let [tension_x, tension_y] = model.edge_tension(&z, &p);
    let scale = 12.0 * gap_ratio * gap_ratio;
    assert_close("N_x", tension_x, scale * (strain_x + nu * strain_y), 1e-11);
    assert_close("N_y", tension_y, scale * (nu * strain_x + strain_y), 1e-11);
}

#[test]
fn both_residuals_are_projections_of_equation_3_12() {
    let (alpha, nu, gap_ratio, load) = (1.3, 0.25, 1.5, 20.0);
    let (force_x, force_y, pressure) = (3.0, -5.0, 7.0);
    let p = parameters(&[
        (LOAD, load),
        (GAP_RATIO, gap_ratio),
        (ASPECT, alpha),
        (NU, nu),
        (FORCE_X, force_x),
        (FORCE_Y, force_y),
        (PRESSURE, pressure),
    ]);
    let z = sample(9);
    for projection in [Projection::Direct, Projection::Multiplied] {
        let model = SinePlate::new(SineSettings { projection, ..settings(9) }).expect("valid");
        let [tension_x, tension_y] = model.edge_tension(&z, &p);
        let stress = model.stress_function(&z, &p);
        let modes = model.modes();
        let kappa = 12.0 * (1.0 - nu * nu) * (gap_ratio / alpha).powi(2);
        let mut expected = vec![0.0; 9];
        for (x, y, weight) in square() {
            let (mut w, mut bending, mut f) = ([0.0; 4], 0.0, [0.0; 4]);
            for (&(m, n), &z) in modes.iter().zip(&z) {
                let phi = product(m as f64, n as f64, x, y, true);
                add(&mut w, z, phi);
                let (m, n) = ((m * m) as f64, (n * n) as f64);
                bending += z * phi[0] * (PI * PI * (m + n / (alpha * alpha))).powi(2);
            }
            for term in &stress {
                add(&mut f, term.coefficient, product(term.m as f64, term.n as f64, x, y, false));
            }
            let membrane = kappa * bracket(&w, &f)
                + (tension_x - force_x) * w[1]
                + (tension_y - force_y) * w[2] / (alpha * alpha);
            let gap = (1.0 - w[0]).powi(2);
            let residual = match projection {
                Projection::Direct => bending - membrane - pressure - load / gap,
                _ => gap * (bending - membrane - pressure) - load,
            };
            for (expected, &(m, n)) in expected.iter_mut().zip(&modes) {
                *expected += weight * residual * product(m as f64, n as f64, x, y, true)[0];
            }
        }
        let mut residual = vec![0.0; 9];
        model.residual(&z, &p, &mut residual);
        for (value, expected) in residual.iter().zip(&expected) {
            assert_close(&format!("{projection:?}"), *value, *expected, 1e-9);
        }
    }
}

#[test]
fn the_direct_residual_is_a_gradient_and_the_multiplied_one_is_not() {
    let asymmetry = |projection| {
        let mut system = plate(SineSettings { projection, ..settings(9) });
        let p = parameters(&[(LOAD, 60.0), (GAP_RATIO, 2.0), (ASPECT, 1.2), (FORCE_X, 4.0)]);
        system.assemble(&[sample(9), p].concat()).expect("inside the domain");
        let mut jacobian = vec![0.0; 81];
        system.jacobian(&mut jacobian);
        let largest = jacobian.iter().fold(0.0_f64, |a, b| a.max(b.abs()));
        let entries = (0..81).map(|k| (jacobian[k] - jacobian[(k % 9) * 9 + k / 9]).abs());
        (system.dynamics(), entries.fold(0.0_f64, f64::max) / largest)
    };
    let (dynamics, direct) = asymmetry(Projection::Direct);
    assert!(dynamics == Dynamics::Potential && direct < 1e-14, "{direct:e}");
    let (dynamics, multiplied) = asymmetry(Projection::Multiplied);
    assert!(dynamics == Dynamics::SecondOrder && multiplied > 1e-3, "{multiplied:e}");
}

#[test]
fn uniform_pressure_bends_the_linear_plate_by_naviers_coefficient() {
    let mut system = plate(SineSettings { theory: Theory::Linear, ..settings(300) });
    let p = parameters(&[(PRESSURE, 1.0)]);
    let x = equilibrium(&mut system, &[0.0; 300], &p);
    let w = system.problem().deflection(&x[..300], 0.5, 0.5);
    assert_close("w D/(q a⁴)", w, 0.00406235266068, 2e-10);
}

#[test]
fn the_flat_plate_has_its_exact_frequencies_and_buckling_loads() {
    let mut system = plate(settings(15));
    let spectrum = |system: &mut Dense<SinePlate>, p: Vec<f64>| {
        let x = [vec![0.0; 15], p].concat();
        system.assemble(&x).expect("inside the domain");
        system.spectrum(&x, ALL).unwrap().expect("a potential")
    };
    let mut exact: Vec<f64> =
        system.problem().modes().iter().map(|(m, n)| PI * PI * (m * m + n * n) as f64).collect();
    exact.sort_by(f64::total_cmp);
    for ((value, _), exact) in spectrum(&mut system, parameters(&[])).iter().zip(&exact) {
        assert_close("ω", (-4.0 * value).sqrt(), *exact, 1e-11 * exact);
    }
    let uniaxial = parameters(&[(FORCE_X, 4.0 * PI * PI)]);
    assert_close("uniaxial", spectrum(&mut system, uniaxial)[0].0, 0.0, 1e-11);
    let biaxial = parameters(&[(FORCE_X, 2.0 * PI * PI), (FORCE_Y, 2.0 * PI * PI)]);
    assert_close("biaxial", spectrum(&mut system, biaxial)[0].0, 0.0, 1e-11);
}

#[test]
fn frequency_about_the_deflected_plate() {
    let table =
        [(2.0, 100.0, 0.4089395821, 28.7671077501), (0.5, 50.0, 0.3186584076, 14.1319768491)];
    for (gap_ratio, load, deflection, frequency) in table {
        let mut system = plate(settings(120));
        let p = parameters(&[(GAP_RATIO, gap_ratio), (LOAD, load)]);
        let mut start = vec![0.0; 120];
        start[0] = deflection;
        let x = equilibrium(&mut system, &start, &p);
        let mut monitors = [0.0; 4];
        System::monitors(&mut system, &x, 0, &mut monitors).expect("finite");
        assert_close("deflection", monitors[0], deflection, 2e-7);
        assert_eq!(monitors[0], monitors[1], "the centre deflects most");
        assert_close("frequency", monitors[2], frequency, 1e-8);
        assert_close("ratio", monitors[3], frequency / (2.0 * PI * PI), 1e-9);
        let vibration = system.problem().vibration(&x[..120], &p).expect("finite");
        assert_close("frequency", vibration.frequency, monitors[2], 1e-10);
        assert_close("shape", system.problem().deflection(&vibration.shape, 0.5, 0.5), 1.0, 1e-14);
    }
}

#[test]
fn the_multiplied_projection_vibrates_with_the_mass_of_equation_3_26() {
    let mut system = plate(SineSettings { projection: Projection::Multiplied, ..settings(30) });
    let p = parameters(&[(GAP_RATIO, 2.0), (LOAD, 100.0)]);
    let mut start = vec![0.0; 30];
    start[0] = 0.4;
    let x = equilibrium(&mut system, &start, &p);
    let mut monitors = [0.0; 4];
    System::monitors(&mut system, &x, 0, &mut monitors).expect("finite");
    assert_close("frequency", monitors[2], 28.7671077501, 2e-3);
}

/// At rest a square plate's frequencies come in pairs; the inertia of the multiplied equations is
/// that of the direct ones there.
#[test]
fn repeated_frequencies_leave_the_lowest_one_known() {
    for modes in [3, 15, 40] {
        let mut system =
            plate(SineSettings { projection: Projection::Multiplied, ..settings(modes) });
        let mut monitors = [0.0; 4];
        let x = [vec![0.0; modes], parameters(&[])].concat();
        System::monitors(&mut system, &x, 0, &mut monitors).expect("finite");
        assert_close("frequency", monitors[2], 2.0 * PI * PI, 1e-10);
        assert_close("ratio", monitors[3], 1.0, 1e-11);
    }
}

/// The same compressed, loaded plate in all three models.
fn three_models(p: &[f64]) -> [(Box<dyn System>, Vec<f64>); 3] {
    [Model::Ritz, Model::Modal, Model::Sine].map(|model| {
        let settings =
            PlateSettings { model, modes: 15, symmetric: Some(true), ..PlateSettings::default() };
        let mut system = settings.system(p, p).expect("valid settings");
        let at_rest = vec![0.0; system.names().dimension()];
        let x = equilibrium(system.as_mut(), &at_rest, p);
        (system, x)
    })
}

#[test]
fn models_agree_on_monitors_and_profiles() {
    let p = parameters(&[(LOAD, 30.0), (FORCE_X, 20.0), (FORCE_Y, -4.0)]);
    let reports = three_models(&p).map(|(mut system, x)| {
        let mut monitors = [0.0; 4];
        system.monitors(&x, 0, &mut monitors).expect("finite");
        (monitors, system.profiles(&x))
    });
    let (exact, exact_profiles) = &reports[0];
    // The flat plate that is compared with carries no edge forces.
    assert_close("ratio", exact[3], exact[2] / (2.0 * PI * PI), 1e-8);
    for (monitors, profiles) in &reports[1..] {
        for (value, exact) in monitors.iter().zip(exact) {
            assert_close("monitor", *value, *exact, 1e-4 * exact.abs());
        }
        assert_eq!(profiles.len(), 2);
        for (profile, exact) in profiles.iter().zip(exact_profiles) {
            assert_eq!((&profile.name, profile.points.len()), (&exact.name, exact.points.len()));
            for (point, exact) in profile.points.iter().zip(&exact.points) {
                assert_close(&profile.name, point[1], exact[1], 1e-4);
            }
        }
    }
}

#[test]
fn the_slope_of_the_squared_frequency_at_no_load_is_minus_two() {
    for gap_ratio in [0.0, 1.0, 2.0] {
        let mut system = plate(settings(15));
        let x = [vec![0.0; 15], parameters(&[(GAP_RATIO, gap_ratio)])].concat();
        let mut gradient = vec![0.0; x.len()];
        system
            .gradient(&x, Functional::Monitor(2), &all_parameters(&system), &mut gradient)
            .unwrap();
        // The diagonal flat stiffness turns the load's column into the slope of the deflection.
        let slope: f64 = system
            .problem()
            .modes()
            .iter()
            .zip(&gradient)
            .map(|(&(m, n), gradient)| {
                let stiffness = 0.25 * (PI * PI * (m * m + n * n) as f64).powi(2);
                gradient * 4.0 / (PI * PI * (m * n) as f64) / stiffness
            })
            .sum();
        let omega = 2.0 * PI * PI;
        let total = 2.0 * omega * (slope + gradient[15 + LOAD]);
        assert_close("d(ω²)/dλ", total, -2.0, 1e-11);
    }
}

#[test]
fn monitor_gradients_are_those_of_difference_quotients() {
    for projection in [Projection::Direct, Projection::Multiplied] {
        let mut system = plate(SineSettings { projection, ..settings(6) });
        let p = parameters(&[(GAP_RATIO, 1.5), (LOAD, 40.0), (ASPECT, 1.1), (FORCE_X, 2.0)]);
        let mut start = vec![0.0; 6];
        start[0] = 0.2;
        let x = equilibrium(&mut system, &start, &p);
        for monitor in 0..4 {
            let mut gradient = vec![0.0; x.len()];
            system
                .gradient(&x, Functional::Monitor(monitor), &all_parameters(&system), &mut gradient)
                .unwrap();
            for i in 0..x.len() {
                let mut at = |shift: f64| {
                    let mut moved = x.clone();
                    moved[i] += shift;
                    let mut values = [0.0; 4];
                    System::monitors(&mut system, &moved, 0, &mut values).expect("finite");
                    values[monitor]
                };
                let quotient = (at(1e-5) - at(-1e-5)) / 2e-5;
                let scale = 1.0 + quotient.abs();
                assert_close(
                    &format!("{projection:?}, monitor {monitor}, component {i}"),
                    gradient[i],
                    quotient,
                    1e-6 * scale,
                );
            }
        }
    }
}

#[test]
fn a_device_reports_hertz_and_metres() {
    let model =
        SinePlate::new(SineSettings { units: Units::Device, ..settings(3) }).expect("valid");
    let p = model.defaults();
    let mut monitors = [0.0; 5];
    model.monitors(&[0.1, 0.0, 0.0], &p, &mut monitors);
    assert_close("displacement", monitors[4], 0.1 * 2e-6, 1e-21);
    model.monitors(&[0.0; 3], &p, &mut monitors);
    let (side, thickness, young, nu, density) = (300e-6_f64, 2e-6_f64, 160e9, 0.22, 2330.0);
    let rigidity: f64 = young * thickness.powi(3) / (12.0 * (1.0 - nu * nu));
    let hertz = PI / side.powi(2) * (rigidity / (density * thickness)).sqrt();
    assert_close("frequency", monitors[2] / hertz, 1.0, 1e-12);
    assert_close("ratio", monitors[3], 1.0, 1e-12);
}

#[test]
fn settings_and_values_out_of_range_are_refused_by_name() {
    // 3260 pairs of odd wave numbers come before the first one above 127.
    for count in [0, 3261, usize::MAX] {
        let error = PlateError::Count { what: "modes", count, least: 1, most: 3260 };
        assert_eq!(SinePlate::new(settings(count)).unwrap_err(), error);
    }
    let coarse = SineSettings { quadrature_points: Some(6), ..settings(15) };
    let error = SinePlate::new(coarse).unwrap_err();
    assert!(matches!(error, PlateError::TooFewPoints { points: 6, needed: 7, .. }), "{error}");

    for in_plane in [InPlane::Immovable, InPlane::Free] {
        let error = SinePlate::new(SineSettings { in_plane, ..settings(3) }).unwrap_err();
        assert_eq!(error, PlateError::SineInPlane { in_plane: in_plane.name() });
        assert!(one_line(&error).contains(in_plane.name()), "{error}");
    }

    let model = SinePlate::new(settings(3)).expect("valid settings");
    let refused = |z: &[f64], values: &[(usize, f64)]| {
        model.domain(z, &parameters(values)).err().map(|left| left.quantity)
    };
    assert_eq!(refused(&[0.9, 0.0, 0.0], &[]), None);
    assert_eq!(refused(&[1.0, 0.0, 0.0], &[]).as_deref(), Some("max_deflection"));
    assert_eq!(refused(&[f64::NAN, 0.0, 0.0], &[]).as_deref(), Some("max_deflection"));
    // Off the centre: the third harmonic is largest at a sixth of the side.
    assert_eq!(refused(&[0.7, 0.7, 0.0], &[]).as_deref(), Some("max_deflection"));
    assert_eq!(refused(&[0.1; 3], &[(ASPECT, 0.0)]).as_deref(), Some("aspect"));
    assert_eq!(refused(&[0.1; 3], &[(LOAD, f64::INFINITY)]).as_deref(), Some("load"));
    assert_eq!(refused(&[0.1; 3], &[(NU, 0.5)]).as_deref(), Some("nu"));
    assert_eq!(refused(&[0.1; 3], &[(NU, f64::NAN)]).as_deref(), Some("nu"));
    assert_eq!(refused(&[0.1; 3], &[(SHEAR, 1.0)]).as_deref(), Some("edge_shear"));
}

#[test]
fn the_order_of_modes_is_that_of_section_3_2() {
    let modes = |count| SinePlate::new(settings(count)).expect("valid settings").modes();
    let expected = [
        [(1, 1), (1, 3), (3, 1), (3, 3), (1, 5)],
        [(5, 1), (3, 5), (5, 3), (1, 7), (5, 5)],
        [(7, 1), (3, 7), (7, 3), (5, 7), (7, 5)],
    ];
    assert_eq!(modes(15), expected.concat());
    // Longer lists only append.
    let long = modes(900);
    for count in [1, 2, 16, 40, 200, 500] {
        assert_eq!(modes(count), long[..count]);
    }
}

#[test]
fn a_state_without_finite_eigenvalues_has_no_vibration() {
    let plate = SinePlate::new(SineSettings { projection: Projection::Multiplied, ..settings(3) });
    let plate = plate.expect("valid settings");
    assert_eq!(plate.vibration(&[f64::INFINITY; 3], &plate.defaults()), None);
    assert_eq!(plate.vibration(&[f64::NAN; 3], &plate.defaults()), None);
}

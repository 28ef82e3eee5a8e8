//! The modal model of the plate against independently computed values and against the full model.

use crate::plates::models::{
    ASPECT, FORCE_X, FORCE_Y, GAP_RATIO, LOAD, NU, PRESSURE, SHEAR, all_parameters,
};
use crate::plates::plate_fold::equilibrium;
use approx::assert_relative_eq;
use std::f64::consts::PI;
use tangency::core::continuation::{Branch, Continuation, Settings};
use tangency::core::failure::one_line;
use tangency::core::linalg::{Border, Factors, Form};
use tangency::core::problem::{Names, ZeroProblem};
use tangency::core::scalar::Scalar;
use tangency::core::system::{Dense, Functional, Kind, System};
use tangency::problems::plate::modal::{MOST_MODES, Modal, ModalSettings};
use tangency::problems::plate::{
    InPlane, Orders, PlateError, Projection, Ritz, RitzSettings, Theory, Units,
};

const BOTH: [Projection; 2] = [Projection::Direct, Projection::Multiplied];

fn settings(supports: &str, modes: usize, projection: Projection) -> ModalSettings {
    let supports = supports.parse().expect("four edges");
    ModalSettings { modes, projection, ..ModalSettings::new(supports) }
}

fn model(settings: ModalSettings) -> Modal {
    Modal::new(settings).expect("valid settings")
}

/// The branch in the load up to nine tenths of the gap.
fn trace(system: &mut dyn System, parameters: &[f64]) -> Branch {
    trace_to(system, parameters, 0.0)
}

/// The same branch, its special points to a relative error.
fn trace_to(system: &mut dyn System, parameters: &[f64], refinement: f64) -> Branch {
    let names = system.names().parameters.clone();
    let mut run =
        Continuation::new(system).settings(Settings { refinement, ..Settings::default() });
    for (name, value) in names.iter().zip(parameters) {
        run = run.at(name, *value);
    }
    run.along("load", 0.0..=400.0).bound("max_deflection", 0.0..=0.9).trace().expect("a start")
}

/// `(λ, w)` at the fold of a branch.
fn fold(branch: &Branch) -> (f64, f64) {
    let fold = branch.of_kind(Kind::LP).next().expect("a fold");
    let deflection = branch.column("deflection").expect("a monitor");
    (fold.parameters[LOAD], fold.value(deflection).expect("a value"))
}

fn pull_in(settings: ModalSettings, gap_ratio: f64) -> (f64, f64) {
    let modal = model(settings);
    let mut parameters = modal.defaults();
    parameters[GAP_RATIO] = gap_ratio;
    fold(&trace(&mut modal.into_system(), &parameters))
}

/// The equilibrium next to `deflection` in the first mode; `x = (z, p)`.
fn deflected(system: &mut Dense<Modal>, deflection: f64, parameters: &[f64]) -> Vec<f64> {
    let mut z = vec![0.0; system.names().dimension()];
    z[0] = 1.0;
    z[0] = deflection / system.problem().deflection(&z, 0.5, 0.5);
    equilibrium(system, &z, parameters)
}

fn monitors(system: &mut Dense<Modal>, x: &[f64]) -> Vec<f64> {
    let mut values = vec![0.0; system.names().monitors.len()];
    System::monitors(system, x, 0, &mut values).expect("finite");
    values
}

#[test]
fn few_modes_of_a_clamped_plate_pull_in_at_known_loads() {
    for (modes, direct, multiplied) in [
        (1, 191.3655, 176.4596),
        (3, 192.1612, 198.2900),
        (7, 191.9268, 191.3084),
        (8, 191.9335, 191.6628),
    ] {
        for (projection, expected) in BOTH.into_iter().zip([direct, multiplied]) {
            let (load, _) = pull_in(settings("CCCC", modes, projection), 1.0);
            assert!((load - expected).abs() < 6e-5, "{load} for {expected}");
        }
    }
}

#[test]
fn few_modes_of_a_supported_plate_pull_in_at_known_loads() {
    for (modes, direct, multiplied) in [
        (1, (145.26607, 0.67886), (156.13641, 0.84149)),
        (2, (145.02589, 0.67338), (151.98287, 0.75072)),
        (6, (144.46514, 0.67012), (144.09066, 0.67289)),
        (15, (144.46817, 0.66994), (144.48157, 0.67018)),
    ] {
        for (projection, expected) in BOTH.into_iter().zip([direct, multiplied]) {
            let found = pull_in(settings("SSSS", modes, projection), 2.0);
            assert!((found.0 - expected.0).abs() < 6e-6, "{found:?} for {expected:?}");
            assert!((found.1 - expected.1).abs() < 6e-6, "{found:?} for {expected:?}");
        }
    }
}

#[test]
fn modes_of_equal_frequency_come_in_a_fixed_order() {
    let modal = model(settings("SSSS", 15, Projection::Direct));
    let order = [
        (1, 1),
        (1, 3),
        (3, 1),
        (3, 3),
        (1, 5),
        (5, 1),
        (3, 5),
        (5, 3),
        (1, 7),
        (5, 5),
        (7, 1),
        (3, 7),
        (7, 3),
        (5, 7),
        (7, 5),
    ];
    for (mode, (m, n)) in order.into_iter().enumerate() {
        let mut unit = [0.0; 15];
        unit[mode] = 1.0;
        for (x, y) in [(0.13, 0.21), (0.4, 0.7), (0.55, 0.05)] {
            let sines = (f64::from(m) * PI * x).sin() * (f64::from(n) * PI * y).sin();
            let found = modal.deflection(&unit, x, y);
            assert!((found - 2.0 * sines).abs() < 1e-4, "({m}, {n}): {found} for {}", 2.0 * sines);
        }
        let frequency = PI * PI * f64::from(m * m + n * n);
        assert_relative_eq!(modal.frequencies()[mode], frequency, max_relative = 1e-8);
    }
}

#[test]
fn centre_lines_and_deflections_agree() {
    let modal = model(settings("SCSF", 4, Projection::Direct));
    let z = [0.1, -0.02, 0.03, 0.01];
    let line = modal.centre_line(&z, 5);
    assert_eq!(line.len(), 5);
    for (x, w) in line {
        assert!((w - modal.deflection(&z, x, 0.5)).abs() < 1e-13);
    }
}

/// Supports, edges in the plane, modes, and how far they leave the load in the direct projection
/// and in the multiplied one, which has the same limit.
#[test]
fn modal_models_converge_to_the_full_one() {
    for (supports, in_plane, modes, direct, multiplied) in [
        ("CCCC", InPlane::Free, 15, 3e-6, 3e-4),
        ("SSSS", InPlane::Straight, 15, 1e-7, 4e-4),
        ("SCSC", InPlane::Slide, 15, 3e-4, 2e-3),
        ("SCSF", InPlane::Immovable, 15, 6e-5, 3e-3),
        ("CCSS", InPlane::Immovable, 15, 4e-3, 4e-2),
        ("CSCF", InPlane::Slide, 15, 1e-3, 1e-2),
        ("CFFF", InPlane::Immovable, 8, 4e-5, 3e-3),
    ] {
        let full = RitzSettings { in_plane, ..RitzSettings::new(supports.parse().expect("edges")) };
        let mut full = Ritz::new(full).expect("valid settings");
        let mut parameters = Units::Dimensionless.defaults().to_vec();
        parameters[GAP_RATIO] = 2.0;
        // A thirtieth of what the better model is allowed to be off.
        let load = fold(&trace_to(&mut full, &parameters, direct / 30.0)).0;
        for (projection, tolerance) in BOTH.into_iter().zip([direct, multiplied]) {
            let mut settings = settings(supports, modes, projection);
            settings.plate.in_plane = in_plane;
            assert_relative_eq!(pull_in(settings, 2.0).0, load, max_relative = tolerance);
        }
    }
}

#[test]
fn long_plates_have_modes_along_their_length() {
    for (projection, tolerance) in BOTH.into_iter().zip([2e-6, 1e-3]) {
        let mut settings = settings("SSSS", 15, projection);
        settings.plate.aspect = 2.0;
        let (load, deflection) = pull_in(settings, 1.0);
        assert_relative_eq!(load, 30.0071894, max_relative = tolerance);
        assert_relative_eq!(deflection, 0.590974, max_relative = 1e-3);
    }
}

#[test]
fn frequencies_about_the_deflected_plate() {
    for (supports, gap_ratio, load, deflection, frequency) in [
        ("CCCC", 2.0, 200.0, 0.344322989, 34.51180097),
        ("CCCC", 1.0, 180.0, 0.386336034, 23.54230968),
        ("SSSS", 2.0, 100.0, 0.4089395821, 28.7671077501),
        ("SSSS", 0.5, 50.0, 0.3186584076, 14.1319768491),
    ] {
        for projection in BOTH {
            let mut system = model(settings(supports, 15, projection)).into_system();
            let mut p = system.problem().defaults();
            (p[LOAD], p[GAP_RATIO]) = (load, gap_ratio);
            let x = deflected(&mut system, deflection, &p);
            let values = monitors(&mut system, &x);
            let tolerance = if projection == Projection::Direct { 2e-4 } else { 1e-3 };
            assert_relative_eq!(values[0], deflection, max_relative = 5.0 * tolerance);
            assert_relative_eq!(values[2], frequency, max_relative = tolerance);
            assert_eq!(values[0], values[1], "the centre deflects most");
            let flat = system.problem().frequencies()[0];
            assert_relative_eq!(values[3], values[2] / flat, max_relative = 1e-13);
            let modes = system.problem().modes(&x[..15], &p, 1).expect("an equilibrium");
            assert_relative_eq!(modes.frequencies()[0], values[2], max_relative = 1e-9);
            let square: f64 = modes.shapes[0].iter().map(|c| c * c).sum();
            assert_relative_eq!(square, 1.0, max_relative = 1e-12);
        }
    }
}

/// `∂ω²/∂λ + ∂ω²/∂z · dz/dλ = −2` at rest: exact for any number of modes of a plate that is bent
/// only.
#[test]
fn the_squared_frequency_falls_at_first_by_twice_the_load() {
    for gap_ratio in [0.0, 1.0, 2.0] {
        let mut system = model(settings("CCCC", 6, Projection::Direct)).into_system();
        let mut p = system.problem().defaults();
        p[GAP_RATIO] = gap_ratio;
        let x = [vec![0.0; 6], p].concat();
        let (mut gradient, mut column) = (vec![0.0; x.len()], vec![0.0; 6]);
        system
            .gradient(&x, Functional::Monitor(2), &all_parameters(&system), &mut gradient)
            .unwrap();
        let mut load = vec![0.0; x.len()];
        load[6 + LOAD] = 1.0;
        system.derivative(&x, &[&load], &mut column).unwrap();
        system.assemble(&x).expect("inside the domain");
        let mut factors = Factors::default();
        system.factor(Form::Jacobian, Border::NONE, &mut factors).expect("regular");
        factors.solve(&mut column);
        let slope: f64 = gradient.iter().zip(&column).map(|(g, c)| -g * c).sum();
        let omega = system.problem().frequencies()[0];
        assert_relative_eq!(2.0 * omega * (slope + gradient[6]), -2.0, max_relative = 1e-10);
    }
}

#[test]
fn compressed_plates_buckle_at_known_forces() {
    let pi2 = PI * PI;
    for (supports, one_way, both_ways, tolerance) in [
        ("SSSS", 4.0 * pi2, 2.0 * pi2, 1e-9),
        ("CCCC", 10.0739480615 * pi2, 5.3036260808 * pi2, 4e-5),
    ] {
        for projection in BOTH {
            // The flat plate is not stretched.
            let mut settings = settings(supports, 30, projection);
            settings.plate.theory = Theory::Linear;
            let mut system = model(settings).into_system();
            // The stiffness is linear in the force: 0 and the lowest ratio.
            let mut stiffness = |x: f64, y: f64| {
                let mut p = system.problem().defaults();
                (p[FORCE_X], p[FORCE_Y]) = (x, y);
                system.assemble(&[vec![0.0; 30], p].concat()).expect("inside the domain");
                let mut matrix = vec![0.0; 900];
                system.jacobian(&mut matrix);
                nalgebra::DMatrix::from_vec(30, 30, matrix)
            };
            let flat = stiffness(0.0, 0.0);
            for (y, critical) in [(0.0, one_way), (1.0, both_ways)] {
                let slope = &flat - stiffness(1.0, y);
                let ratios = nalgebra::DMatrix::from_fn(30, 30, |i, k| {
                    slope[(i, k)] / (flat[(i, i)] * flat[(k, k)]).sqrt()
                });
                let found = 1.0 / nalgebra::SymmetricEigen::new(ratios).eigenvalues.max();
                assert_relative_eq!(found, critical, max_relative = tolerance);
            }
        }
    }
}

#[test]
fn pressed_plates_deflect_as_known() {
    for (in_plane, table) in [
        (InPlane::Slide, [(17.79, 0.236283), (95.0, 0.904787), (402.0, 1.864116)]),
        (InPlane::Immovable, [(17.79, 0.236170), (95.0, 0.901823), (402.0, 1.855964)]),
    ] {
        for projection in BOTH {
            let mut settings = settings("CCCC", 24, projection);
            (settings.nu, settings.plate.in_plane) = (0.316, in_plane);
            let mut system = model(settings).into_system();
            // The gap is ten times the thickness: all deflections are far from the electrode.
            let mut p = system.problem().defaults();
            p[GAP_RATIO] = 10.0;
            for (pressure, deflection) in table {
                p[PRESSURE] = 12.0 * (1.0 - 0.316 * 0.316) * pressure / 10.0;
                let x = deflected(&mut system, deflection / 10.0, &p);
                let found = 10.0 * monitors(&mut system, &x)[0];
                assert_relative_eq!(found, deflection, max_relative = 7e-4);
            }
        }
    }
}

#[test]
fn linear_theory_knows_no_gap_ratio() {
    for (projection, tolerance) in BOTH.into_iter().zip([1e-7, 5e-4]) {
        let mut settings = settings("SSSS", 15, projection);
        settings.plate.theory = Theory::Linear;
        let (load, deflection) = pull_in(settings, 2.0);
        assert_relative_eq!(load, 52.633290209, max_relative = tolerance);
        assert_relative_eq!(deflection, 0.4554324767, max_relative = 1e-4);
    }
}

#[test]
fn the_whole_set_of_modes_gives_the_same_fold() {
    let half = pull_in(settings("SSSS", 4, Projection::Direct), 1.0);
    let mut whole = settings("SSSS", 11, Projection::Direct);
    whole.plate.symmetric = false;
    // Odd-odd ones among the eleven lowest of m² + n²: (1,1), (1,3), (3,1), (3,3).
    let found = pull_in(whole, 1.0);
    assert_relative_eq!(found.0, half.0, max_relative = 1e-8);
}

/// A model of which nothing is known but its residual and monitors.
struct Unknown(Modal);

impl ZeroProblem for Unknown {
    fn names(&self) -> Names {
        self.0.names()
    }

    fn residual<T: Scalar>(&self, z: &[T], p: &[T], r: &mut [T]) {
        self.0.residual(z, p, r);
    }

    fn monitors<T: Scalar>(&self, z: &[T], p: &[T], values: &mut [T]) {
        self.0.monitors(z, p, values);
    }
}

#[test]
fn assembled_derivatives_are_those_of_dual_numbers() {
    for (supports, symmetric) in [("SSSS", true), ("CCSS", false)] {
        for projection in BOTH {
            let mut settings = settings(supports, 5, projection);
            (settings.plate.symmetric, settings.mode_accuracy) = (symmetric, 1e-4);
            let mut p = model(settings).defaults();
            (p[LOAD], p[GAP_RATIO], p[PRESSURE]) = (40.0, 1.4, 5.0);
            (p[FORCE_X], p[FORCE_Y]) = (3.0, -2.0);
            p[SHEAR] = if symmetric { 0.0 } else { 1.5 };
            let x = [vec![0.2, 0.03, -0.02, 0.015, 0.01], p].concat();
            let w = [0.3, -0.4, 0.5, 0.1, 0.7];
            let mut v = vec![0.0; x.len()];
            v[..6].copy_from_slice(&[0.2, 0.1, 0.05, -0.1, -0.2, 0.7]);
            let all: Vec<usize> = (0..x.len() - 5).collect();
            let evaluate = |system: &mut dyn System| -> [Vec<f64>; 7] {
                let zeros = || vec![0.0; x.len()];
                let mut out = [vec![0.0; 25], zeros(), zeros(), zeros(), zeros(), zeros(), zeros()];
                system.assemble(&x).expect("inside the domain");
                system.gradient(&x, Functional::First(&w, &v), &all, &mut out[1]).unwrap();
                system.gradient(&x, Functional::Second(&w, &v), &all, &mut out[2]).unwrap();
                for monitor in 0..4 {
                    system
                        .gradient(&x, Functional::Monitor(monitor), &all, &mut out[3 + monitor])
                        .unwrap();
                }
                out
            };
            let mut tabulated = model(settings).into_system();
            let mut duals = Dense::new(Unknown(model(settings)));
            let (mut assembled, mut by_duals) = (evaluate(&mut tabulated), evaluate(&mut duals));
            tabulated.jacobian(&mut assembled[0]);
            duals.jacobian(&mut by_duals[0]);
            for (assembled, by_duals) in assembled.iter().zip(&by_duals) {
                let scale = by_duals.iter().fold(0.0_f64, |m, b| m.max(b.abs()));
                for (a, b) in assembled.iter().zip(by_duals) {
                    assert!((a - b).abs() < 1e-11 * scale, "{projection:?} {a} {b} of {scale}");
                }
            }
        }
    }
}

/// Central differences of the monitors, for comparison only.
#[test]
fn monitor_gradients_are_those_of_difference_quotients() {
    for projection in BOTH {
        let mut settings = settings("SCSF", 4, projection);
        settings.plate.units = Units::Device;
        let modal = model(settings);
        let mut p = modal.defaults();
        p[0] = 20.0; // volts
        let mut system = modal.into_system();
        let x = deflected(&mut system, 0.05, &p);
        let n = 4;
        for monitor in 0..5 {
            let mut gradient = vec![0.0; x.len()];
            system
                .gradient(&x, Functional::Monitor(monitor), &all_parameters(&system), &mut gradient)
                .unwrap();
            // All unknowns, voltage, thickness, gap and density.
            for i in (0..n).chain([n, n + 3, n + 4, n + 7]) {
                let step = 1e-5 * if i < n { 1.0 } else { x[i] };
                let mut at = |shift: f64| {
                    let mut moved = x.clone();
                    moved[i] += shift;
                    monitors(&mut system, &moved)[monitor]
                };
                let quotient = (at(step) - at(-step)) / (2.0 * step);
                let scale = quotient.abs() + at(0.0).abs() / if i < n { 1.0 } else { x[i] };
                assert!(
                    (gradient[i] - quotient).abs() < 1e-6 * scale,
                    "{projection:?} {monitor} {i}: {} {quotient}",
                    gradient[i]
                );
            }
        }
    }
}

#[test]
fn a_device_reports_hertz_and_metres() {
    let mut settings = settings("CCCC", 3, Projection::Direct);
    (settings.plate.units, settings.plate.aspect, settings.nu) = (Units::Device, 1.5, 0.22);
    let modal = model(settings);
    let p = modal.defaults();
    assert_eq!((p[2], p[6]), (1.5 * p[1], 0.22));
    let mut system = modal.into_system();
    let x = [vec![0.1, 0.0, 0.0], p.clone()].concat();
    let values = monitors(&mut system, &x);
    let [length, thickness, gap, young, nu, density] = [1, 3, 4, 5, 6, 7].map(|i| p[i]);
    assert_relative_eq!(values[4], gap * values[0], max_relative = 1e-14);
    let rest = monitors(&mut system, &[vec![0.0; 3], p].concat());
    let rigidity = young * thickness.powi(3) / (12.0 * (1.0 - nu * nu));
    let unit = (rigidity / (density * thickness)).sqrt() / (length * length * 2.0 * PI);
    let flat = system.problem().frequencies()[0];
    assert_relative_eq!(rest[2], unit * flat, max_relative = 1e-10);
    assert_relative_eq!(rest[3], 1.0, max_relative = 1e-10);
}

#[test]
fn settings_and_values_out_of_range_are_refused_by_name() {
    let refused = |change: &dyn Fn(&mut ModalSettings)| {
        let mut settings = settings("CFFF", 4, Projection::Direct);
        change(&mut settings);
        Modal::new(settings).err().expect("refused")
    };
    for modes in [0, MOST_MODES + 1, usize::MAX] {
        let (what, least, most) = ("modes", 1, MOST_MODES);
        let error = PlateError::Count { what, count: modes, least, most };
        assert_eq!(refused(&|s| s.modes = modes), error);
    }
    assert!(matches!(refused(&|s| s.mode_accuracy = f64::NAN), PlateError::AccuracyRange { .. }));
    let PlateError::Accuracy { modes: 4, accurate, error, .. } =
        refused(&|s| s.mode_accuracy = 1e-8)
    else {
        panic!("corners of free edges limit the accuracy")
    };
    assert!(accurate < 4 && error > 1e-6);
    let few = Some(Orders { transverse: [4, 4], in_plane: [8, 8] });
    let error = refused(&|s| (s.modes, s.plate.orders) = (20, few));
    assert!(one_line(&error).contains("20 modes cannot reach"), "{error}");
    assert!(matches!(refused(&|s| s.plate.aspect = -1.0), PlateError::Domain(_)));
    assert!(matches!(refused(&|s| s.nu = 0.5), PlateError::Domain(_)));

    let modal = model(settings("SSSS", 2, Projection::Direct));
    let refused = |z: [f64; 2], parameter: usize, value: f64| {
        let mut p = modal.defaults();
        p[parameter] = value;
        modal.domain(&z, &p).err().map(|left| left.quantity)
    };
    assert_eq!(refused([0.4, 0.0], LOAD, 1.0), None);
    assert_eq!(refused([0.5, 0.0], LOAD, 1.0).as_deref(), Some("max_deflection"));
    assert_eq!(refused([f64::NAN, 0.0], LOAD, 1.0).as_deref(), Some("max_deflection"));
    assert_eq!(refused([0.1, 0.0], ASPECT, 1.1).as_deref(), Some("aspect"));
    assert_eq!(refused([0.1, 0.0], NU, 0.25).as_deref(), Some("nu"));
    assert_eq!(refused([0.1, 0.0], NU, f64::NAN).as_deref(), Some("nu"));
    assert_eq!(refused([0.1, 0.0], SHEAR, 1.0).as_deref(), Some("edge_shear"));
}

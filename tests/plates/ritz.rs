//! The full Ritz model of the plate against exact and independently computed values.

use crate::common::ALL;
use crate::plates::models::{
    ASPECT, FORCE, FORCE_X, GAP_RATIO, LOAD, NU, PRESSURE, SHEAR, all_parameters,
};
use crate::plates::plate_fold::{fold, settle};
use approx::assert_relative_eq;
use std::f64::consts::PI;
use tangency::core::failure::Failure;
use tangency::core::linalg::{Border, Factors, Form};
use tangency::core::system::{Discretised, Functional, System};
use tangency::problems::plate::{InPlane, Orders, PlateError, Ritz, RitzSettings, Theory, Units};

fn settings(supports: &str) -> RitzSettings {
    RitzSettings::new(supports.parse().unwrap())
}

fn orders(transverse: usize, in_plane: usize) -> Option<Orders> {
    Some(Orders { transverse: [transverse; 2], in_plane: [in_plane; 2] })
}

fn norm(v: &[f64]) -> f64 {
    v.iter().map(|v| v * v).sum::<f64>().sqrt()
}

/// A plate with a state in the middle of its domain, without any symmetry of the numbers.
fn deflected(settings: RitzSettings) -> (Ritz, Vec<f64>) {
    let plate = Ritz::new(settings).unwrap();
    let mut x = plate.at_rest();
    let n = plate.names().dimension();
    for (i, q) in x[..n].iter_mut().enumerate() {
        *q = 0.3 / (1.0 + i as f64) * if i % 3 == 2 { -0.5 } else { 1.0 };
    }
    let deepest = (0..41 * 41)
        .map(|k| plate.deflection(&x[..n], f64::from(k / 41) / 40.0, f64::from(k % 41) / 40.0))
        .fold(0.0, f64::max);
    x[..n].iter_mut().for_each(|q| *q *= 0.6 / deepest);
    x[n + LOAD] = 30.0;
    x[n + GAP_RATIO] = 1.3;
    x[n + ASPECT] = 1.2;
    x[n + FORCE_X] = 2.0;
    x[n + PRESSURE] = 3.0;
    (plate, x)
}

/// The load at a given deflection of the centre.
fn at_deflection(plate: &mut Ritz, x: &mut [f64], deflection: f64) {
    let (n, length) = (plate.names().dimension(), x.len());
    let (mut row, mut column, mut unit) = (vec![0.0; length], vec![0.0; n], vec![0.0; length]);
    unit[n + LOAD] = 1.0;
    plate.gradient(x, Functional::Monitor(0), &[], &mut row).unwrap();
    for _ in 0..30 {
        let mut r = vec![0.0; n + 1];
        plate.residual(x, &mut r[..n]).unwrap();
        r[n] = row[..n].iter().zip(&*x).map(|(a, b)| a * b).sum::<f64>() - deflection;
        plate.assemble(x).unwrap();
        plate.derivative(x, &[&unit], &mut column).unwrap();
        let border =
            Border { width: 1, columns: &column, rows: &row[..n], corner: &[0.0], units: &[] };
        let mut factors = Factors::default();
        plate.factor(Form::Jacobian, border, &mut factors).unwrap();
        factors.solve(&mut r);
        (0..n).for_each(|i| x[i] -= r[i]);
        x[n + LOAD] -= r[n];
        if norm(&r[..n]) < 1e-10 * norm(&x[..n]) {
            return;
        }
    }
    panic!("no equilibrium found at deflection {deflection}");
}

/// `(λ, w)` at the fold next to `x`.
fn polished_fold(plate: &mut Ritz, x: Vec<f64>) -> (f64, f64) {
    let n = plate.names().dimension();
    let x = fold(plate, x);
    (x[n + LOAD], plate.deflection(&x[..n], 0.5, 0.5))
}

/// A start near the fold: the vertex of a parabola through three loads at given deflections.
fn near_fold(plate: &mut Ritz, gap_ratio: f64, aspect: f64) -> Vec<f64> {
    let mut x = plate.at_rest();
    let n = plate.names().dimension();
    (x[n + GAP_RATIO], x[n + ASPECT]) = (gap_ratio, aspect);
    let (mut loads, step) = (vec![0.0], 0.02);
    for k in 1..45 {
        at_deflection(plate, &mut x, step * f64::from(k));
        loads.push(x[n + LOAD]);
        if let [.., before, top, after] = loads[..]
            && after < top
        {
            let shift = 0.5 * (after - before) / (2.0 * top - before - after) - 1.0;
            at_deflection(plate, &mut x, step * (f64::from(k) + shift));
            break;
        }
    }
    x
}

#[test]
fn flat_plates_vibrate_at_known_frequencies() {
    let pi2 = PI * PI;
    for (supports, expected, tolerance) in [
        ("SSSS", vec![2.0 * pi2, 10.0 * pi2, 10.0 * pi2], 1e-8),
        ("CCCC", vec![35.985191115], 1e-9),
        ("SCSC", vec![28.95085037], 1e-9),
        ("SSSC", vec![23.64631954], 1e-9),
        ("SFSF", vec![9.63138487], 1e-9),
        ("SSSF", vec![11.68453677], 1e-9),
        ("SCSF", vec![12.68735975], 1e-9),
        ("CFFF", vec![3.4710], 2e-5),
        ("CCCF", vec![23.92], 5e-4),
        ("CSCF", vec![23.37], 5e-4),
    ] {
        let mut settings = settings(supports);
        settings.orders = orders(16, 4);
        settings.theory = Theory::Linear;
        let modes = Ritz::new(settings).unwrap().flat_modes(1.0, 0.3, 4).unwrap();
        for (found, expected) in modes.frequencies().iter().zip(&expected) {
            assert_relative_eq!(found, expected, max_relative = tolerance);
        }
    }
}

#[test]
fn the_whole_set_of_functions_has_the_antisymmetric_modes_too() {
    let mut settings = settings("CCCC");
    (settings.symmetric, settings.orders) = (false, orders(26, 4));
    let modes = Ritz::new(settings).unwrap().flat_modes(1.0, 0.3, 8).unwrap();
    let expected = [
        35.985191115,
        73.393845524,
        73.393845524,
        108.216501691,
        131.580772614,
        132.204790199,
        165.000406190,
        165.000406190,
    ];
    for (found, expected) in modes.frequencies().iter().zip(expected) {
        assert_relative_eq!(*found, expected, max_relative = 1e-9);
    }
}

#[test]
fn the_assembled_matrix_is_the_derivative_of_the_residual() {
    for (supports, symmetric) in [("SSSS", true), ("CCCC", true), ("SCSF", true), ("CFSF", false)] {
        for in_plane in [InPlane::Slide, InPlane::Immovable, InPlane::Straight, InPlane::Free] {
            let mut settings = settings(supports);
            (settings.in_plane, settings.symmetric) = (in_plane, symmetric);
            settings.orders = orders(5, 6);
            let (mut plate, x) = deflected(settings);
            let n = plate.names().dimension();
            plate.assemble(&x).unwrap();
            let mut jacobian = vec![0.0; n * n];
            plate.jacobian(&mut jacobian);
            let scale = jacobian.iter().fold(0.0_f64, |m, a| m.max(a.abs()));
            let mut out = vec![0.0; n];
            for j in 0..n {
                let mut d = vec![0.0; x.len()];
                d[j] = 1.0;
                plate.derivative(&x, &[&d], &mut out).unwrap();
                for i in 0..n {
                    let difference = (out[i] - jacobian[j * n + i]).abs();
                    assert!(
                        difference < 1e-12 * scale,
                        "{supports} {in_plane:?} {i} {j}: {difference:e} of {scale}"
                    );
                }
            }
        }
    }
}

/// Central differences of the assembled matrix, for comparison only.
#[test]
fn gradients_agree_with_differences_of_the_assembled_matrix() {
    for (supports, symmetric) in [("SSSS", true), ("CFSF", false)] {
        let mut settings = settings(supports);
        (settings.symmetric, settings.orders) = (symmetric, orders(4, 6));
        let (mut plate, x) = deflected(settings);
        let (n, length) = (plate.names().dimension(), x.len());
        let w: Vec<f64> = (0..n).map(|i| f64::from(i as u32 * 7 % 5) - 1.5).collect();
        let mut v: Vec<f64> = (0..length).map(|i| f64::from(i as u32 * 3 % 7) - 2.5).collect();
        v[n..].fill(0.0);
        v[n + LOAD] = 0.7;
        v[n + ASPECT] = -0.1;
        let released = [LOAD, GAP_RATIO, ASPECT, NU, FORCE_X, PRESSURE];
        let (mut first, mut second) = (vec![0.0; length], vec![0.0; length]);
        plate.gradient(&x, Functional::First(&w, &v), &released, &mut first).unwrap();
        plate.gradient(&x, Functional::Second(&w, &v), &released, &mut second).unwrap();
        let mut third = vec![0.0; n];
        let mut along: Vec<f64> = (0..length).map(|i| 0.1 * f64::from(i as u32 % 3)).collect();
        along[n + SHEAR] = 0.0;
        plate.derivative(&x, &[&v, &v, &along], &mut third).unwrap();
        let inner = |a: &[f64]| -> f64 { a.iter().zip(&w).map(|(a, b)| a * b).sum() };
        let step = 1e-4;
        for i in (0..n).chain(released.map(|p| n + p)) {
            let mut both = [[0.0; 2]; 2];
            let mut out = vec![0.0; n];
            for (side, sign) in both.iter_mut().zip([-1.0, 1.0]) {
                let mut moved = x.clone();
                moved[i] += sign * step;
                plate.derivative(&moved, &[&v], &mut out).unwrap();
                side[0] = inner(&out);
                plate.derivative(&moved, &[&v, &v], &mut out).unwrap();
                side[1] = inner(&out);
            }
            let slopes = [0, 1].map(|k| (both[1][k] - both[0][k]) / (2.0 * step));
            assert_relative_eq!(first[i], slopes[0], max_relative = 1e-4, epsilon = 1e-3);
            assert_relative_eq!(second[i], slopes[1], max_relative = 1e-4, epsilon = 1e-2);
        }
        let mut both = [vec![0.0; n], vec![0.0; n]];
        for (side, sign) in both.iter_mut().zip([-1.0, 1.0]) {
            let moved: Vec<f64> = x.iter().zip(&along).map(|(x, d)| x + sign * step * d).collect();
            plate.derivative(&moved, &[&v, &v], side).unwrap();
        }
        for i in 0..n {
            let slope = (both[1][i] - both[0][i]) / (2.0 * step);
            assert_relative_eq!(third[i], slope, max_relative = 1e-4, epsilon = 1e-2);
        }
    }
}

/// Pull-in of the square plate: supports, in-plane edges, then (α₁, λ, w).
#[test]
fn square_plates_pull_in_at_known_loads() {
    for (supports, in_plane, folds) in [
        (
            "SSSS",
            InPlane::Slide,
            [
                (0.5, 56.549468343, 0.4909666590),
                (1.0, 71.252716501, 0.577513077),
                (2.0, 144.467913425, 0.66999236),
            ],
        ),
        (
            "SSSS",
            InPlane::Straight,
            [
                (0.5, 53.594250295, 0.4646376967),
                (1.0, 56.705057715, 0.4923202689),
                (2.0, 72.090268748, 0.5809940633),
            ],
        ),
        (
            "SSSS",
            InPlane::Immovable,
            [
                (0.5, 56.570505258, 0.4911554227),
                (1.0, 71.368061983, 0.578041387),
                (2.0, 145.074752057, 0.670472884),
            ],
        ),
        (
            "SSSS",
            InPlane::Free,
            [
                (0.5, 53.125401310, 0.4601926196),
                (1.0, 54.646105722, 0.4742576904),
                (2.0, 61.243306692, 0.5230221162),
            ],
        ),
        (
            "CCCC",
            InPlane::Immovable,
            [
                (0.5, 176.476184448, 0.4773454427),
                (1.0, 191.915137112, 0.5170906363),
                (2.0, 268.61404177, 0.6160513076),
            ],
        ),
        (
            "CCCC",
            InPlane::Slide,
            [
                (0.5, 176.390987643, 0.4770978414),
                (1.0, 191.525300600, 0.516179861),
                (2.0, 266.71357784, 0.61476278),
            ],
        ),
        (
            "CCCC",
            InPlane::Straight,
            [
                (0.5, 173.591508095, 0.4690156596),
                (1.0, 179.083764635, 0.4846853057),
                (2.0, 203.429473577, 0.5394034989),
            ],
        ),
        (
            "CCCC",
            InPlane::Free,
            [
                (0.5, 173.291796590, 0.4681619220),
                (1.0, 177.799999776, 0.4811899261),
                (2.0, 196.985891023, 0.5259880977),
            ],
        ),
    ] {
        let mut settings = settings(supports);
        (settings.in_plane, settings.orders) = (in_plane, orders(10, 14));
        let mut plate = Ritz::new(settings).unwrap();
        for (gap_ratio, load, deflection) in folds {
            let x = near_fold(&mut plate, gap_ratio, 1.0);
            let found = polished_fold(&mut plate, x);
            assert_relative_eq!(found.0, load, max_relative = 2e-9);
            assert_relative_eq!(found.1, deflection, max_relative = 1e-6);
        }
    }
}

#[test]
fn plates_without_stretching_pull_in_at_known_loads() {
    for (supports, load, deflection) in
        [("SSSS", 52.633290209, 0.4554324767), ("CCCC", 171.824440665, 0.4637295069)]
    {
        for (theory, gap_ratio) in [(Theory::Linear, 2.0), (Theory::VonKarman, 0.0)] {
            let mut settings = settings(supports);
            (settings.theory, settings.orders) = (theory, orders(12, 6));
            let mut plate = Ritz::new(settings).unwrap();
            let x = near_fold(&mut plate, gap_ratio, 1.0);
            let found = polished_fold(&mut plate, x);
            assert_relative_eq!(found.0, load, max_relative = 1e-10);
            assert_relative_eq!(found.1, deflection, max_relative = 1e-9);
        }
    }
}

/// The ladder of finer orders, from the usual ones up, at the aspect ratios of figure 3.9.
#[test]
fn long_plates_pull_in_at_known_loads_two_rungs_up() {
    for (aspect, folds) in [
        (1.5, [(0.0, 27.4708175, 0.454336), (2.0, 80.851635, 0.67048)]),
        (2.0, [(0.5, 22.5318181, 0.495496), (1.0, 30.0071894, 0.590974)]),
        (4.0, [(1.0, 23.8894035, 0.587289), (2.0, 58.769799, 0.64312)]),
    ] {
        let mut base_settings = settings("SSSS");
        base_settings.aspect = aspect;
        let mut base = Ritz::new(base_settings).unwrap();
        for (gap_ratio, load, deflection) in folds {
            let x = near_fold(&mut base, gap_ratio, aspect);
            let coarse = polished_fold(&mut base, x.clone());
            assert_relative_eq!(coarse.0, load, max_relative = 5e-6);
            let mut finer_settings = base_settings;
            finer_settings.orders = Some(base.orders().finer().finer());
            let mut finer = Ritz::new(finer_settings).unwrap();
            let x = base.carry(&x, &finer);
            let found = polished_fold(&mut finer, x);
            assert_relative_eq!(found.0, load, max_relative = 1e-8);
            assert_relative_eq!(found.1, deflection, epsilon = 6e-6);
        }
    }
}

/// Finer orders contain the functions of coarser ones: a plate is the same on finer orders, and again
/// back on the coarser ones.
#[test]
fn a_plate_is_deflected_alike_on_finer_orders_and_back() {
    for (supports, symmetric) in [("CCCC", true), ("SCSF", true), ("CFSF", false)] {
        let mut settings = settings(supports);
        (settings.symmetric, settings.orders) = (symmetric, orders(5, 6));
        let (mut plate, x) = deflected(settings);
        let mut finer = plate.refined(&x).unwrap();
        let mut back = finer.system.discretised().unwrap().coarser(&finer.x).unwrap();
        assert!(finer.x.len() > x.len() && back.x.len() == x.len());
        let mut before = [0.0; 4];
        plate.monitors(&x, 0, &mut before).unwrap();
        for other in [&mut finer, &mut back] {
            let mut after = [0.0; 4];
            other.system.monitors(&other.x, 0, &mut after).unwrap();
            assert_eq!(plate.names().parameters, other.system.names().parameters);
            assert_relative_eq!(before[0], after[0], epsilon = 1e-11);
            assert_relative_eq!(before[1], after[1], epsilon = 1e-11);
        }
    }
}

/// Newton's iteration on the lowest `ω²`, whose slope is that of the quotient of Rayleigh.
fn buckling(settings: RitzSettings, parameter: usize) -> f64 {
    let mut plate = Ritz::new(settings).unwrap();
    let mut x = plate.at_rest();
    let n = plate.names().dimension();
    x[n + parameter] = 1.0;
    for _ in 0..40 {
        let modes = plate.modes(&x, 1).unwrap();
        let mut along = modes.shapes[0].clone();
        along.resize(x.len(), 0.0);
        let mut slope = vec![0.0; x.len()];
        plate
            .gradient(&x, Functional::First(&modes.shapes[0], &along), &[parameter], &mut slope)
            .unwrap();
        x[n + parameter] -= modes.squares[0] / slope[n + parameter];
    }
    x[n + parameter] / (PI * PI)
}

#[test]
fn flat_plates_buckle_at_known_edge_forces() {
    for (supports, parameter, expected, tolerance) in [
        ("SSSS", FORCE_X, 4.0, 1e-11),
        ("SSSS", FORCE, 2.0, 1e-11),
        // A Ritz method's values are upper bounds, and this one's fall
        // to 10.0739479973, 5.3036260666.
        ("CCCC", FORCE_X, 10.0739480615, 1e-8),
        ("CCCC", FORCE, 5.3036260808, 1e-8),
        ("SCSC", FORCE_X, 7.6912836, 1e-8),
    ] {
        let mut settings = settings(supports);
        settings.orders = orders(14, 4);
        if supports == "SCSC" {
            // This one buckles in two half waves.
            (settings.symmetric, settings.orders) = (false, orders(20, 4));
        }
        let found = buckling(settings, parameter);
        assert_relative_eq!(found, expected, max_relative = tolerance);
    }
}

#[test]
fn shear_needs_the_whole_set_of_functions() {
    let mut settings = settings("SSSS");
    let mut plate = Ritz::new(settings).unwrap();
    let mut x = plate.at_rest();
    let n = plate.names().dimension();
    x[n + SHEAR] = 1.0;
    let refusal = plate.residual(&x, &mut vec![0.0; n]).unwrap_err();
    let Failure::OutOfDomain(refusal) = refusal else { panic!("{refusal}") };
    assert_eq!(refusal.quantity, "edge_shear");
    assert!(refusal.remedy.contains("symmetric = false"));
    (settings.symmetric, settings.orders) = (false, orders(16, 4));
    let mut plate = Ritz::new(settings).unwrap();
    // The coefficient of a supported square plate in shear, 9.325 (Timoshenko and Gere print 9.34).
    let (mut low, mut high) = (5.0, 12.0);
    for _ in 0..40 {
        let shear = 0.5 * (low + high);
        let mut x = plate.at_rest();
        let n = plate.names().dimension();
        x[n + SHEAR] = shear * PI * PI;
        *if plate.modes(&x, 1).unwrap().squares[0] > 0.0 { &mut low } else { &mut high } = shear;
    }
    assert_relative_eq!(low, 9.325, max_relative = 1e-4);
}

/// `d(ω²)/dλ = −2` at `λ = 0`, along the branch, whatever stretching does.
#[test]
fn the_frequency_always_falls_first() {
    for supports in ["SSSS", "CCCC"] {
        for gap_ratio in [0.0, 0.5, 1.0, 2.0] {
            let mut plate = Ritz::new(settings(supports)).unwrap();
            let mut x = plate.at_rest();
            let (n, length) = (plate.names().dimension(), x.len());
            x[n + GAP_RATIO] = gap_ratio;
            let (mut slope, mut column) = (vec![0.0; length], vec![0.0; n]);
            let mut unit = vec![0.0; length];
            unit[n + LOAD] = 1.0;
            plate.derivative(&x, &[&unit], &mut column).unwrap();
            plate.assemble(&x).unwrap();
            let mut factors = Factors::default();
            plate.factor(Form::Jacobian, Border::NONE, &mut factors).unwrap();
            factors.solve(&mut column);
            plate
                .gradient(&x, Functional::Monitor(2), &all_parameters(&plate), &mut slope)
                .unwrap();
            let along: f64 = (0..n).map(|i| -slope[i] * column[i]).sum();
            let mut monitors = [0.0; 4];
            plate.monitors(&x, 0, &mut monitors).unwrap();
            let square_slope = 2.0 * monitors[2] * (along + slope[n + LOAD]);
            assert_relative_eq!(square_slope, -2.0, max_relative = 1e-8);
        }
    }
}

#[test]
fn deflected_plates_vibrate_at_known_frequencies() {
    for (supports, gap_ratio, load, deflection, frequency) in [
        ("CCCC", 2.0, 200.0, 0.344322989, 34.51180097),
        ("CCCC", 1.0, 180.0, 0.386336034, 23.54230968),
        ("SSSS", 2.0, 100.0, 0.4089395821, 28.7671077501),
        ("SSSS", 0.5, 50.0, 0.3186584076, 14.1319768491),
    ] {
        let mut settings = settings(supports);
        settings.orders = orders(12, 16);
        let mut plate = Ritz::new(settings).unwrap();
        let mut x = plate.at_rest();
        let n = plate.names().dimension();
        x[n + GAP_RATIO] = gap_ratio;
        for step in 1..=10 {
            x[n + LOAD] = load * f64::from(step) / 10.0;
            settle(&mut plate, &mut x);
        }
        let mut monitors = [0.0; 4];
        plate.monitors(&x, 0, &mut monitors).unwrap();
        assert_relative_eq!(monitors[0], deflection, max_relative = 3e-9);
        assert_relative_eq!(monitors[1], deflection, max_relative = 3e-9);
        assert_relative_eq!(monitors[2], frequency, max_relative = 1e-9);
        plate.assemble(&x).unwrap();
        let spectrum = plate.spectrum(&x, ALL).unwrap().unwrap();
        assert_relative_eq!(spectrum[0].0, -frequency * frequency, max_relative = 2e-9);
    }
}

/// Uniform pressure on clamped plates (ν = 0.316): `P = pa⁴/(Eh⁴)` against `w/h`, here with a gap
/// of `4h`.
#[test]
fn clamped_plates_under_pressure_deflect_as_known() {
    for (in_plane, cases) in [
        (InPlane::Slide, [(17.79, 0.236283), (95.0, 0.904787), (402.0, 1.864116)]),
        (InPlane::Immovable, [(17.79, 0.236170), (95.0, 0.901823), (402.0, 1.855964)]),
    ] {
        let mut settings = settings("CCCC");
        settings.in_plane = in_plane;
        let mut plate = Ritz::new(settings).unwrap();
        let mut x = plate.at_rest();
        let n = plate.names().dimension();
        (x[n + NU], x[n + GAP_RATIO]) = (0.316, 4.0);
        for (pressure, deflection) in cases {
            x[n + PRESSURE] = pressure * 12.0 * (1.0 - 0.316 * 0.316) / 4.0;
            settle(&mut plate, &mut x);
            let found = 4.0 * plate.deflection(&x[..n], 0.5, 0.5);
            assert_relative_eq!(found, deflection, max_relative = 5e-6);
        }
    }
    for (supports, coefficient) in [("SSSS", 0.00406235266068), ("CCCC", 0.0012653190875)] {
        let mut settings = settings(supports);
        (settings.theory, settings.orders) = (Theory::Linear, orders(16, 4));
        let mut plate = Ritz::new(settings).unwrap();
        let mut x = plate.at_rest();
        let n = plate.names().dimension();
        x[n + PRESSURE] = 1.0;
        settle(&mut plate, &mut x);
        let found = plate.deflection(&x[..n], 0.5, 0.5);
        assert_relative_eq!(found, coefficient, max_relative = 3e-8);
    }
}

/// Rigid motions and straight edges differ between half a plate's functions and all of them.
#[test]
fn symmetry_changes_nothing_but_the_cost() {
    for in_plane in [InPlane::Slide, InPlane::Immovable, InPlane::Straight, InPlane::Free] {
        let mut found = [0.0; 2];
        for (found, symmetric) in found.iter_mut().zip([true, false]) {
            let mut settings = settings("SSSS");
            (settings.in_plane, settings.symmetric) = (in_plane, symmetric);
            // The same polynomials: degrees to 12 across and to 11 in the plane.
            settings.orders = if symmetric { orders(6, 6) } else { orders(11, 12) };
            if in_plane == InPlane::Free || in_plane == InPlane::Straight {
                settings.orders = None;
            }
            let mut plate = Ritz::new(settings).unwrap();
            let mut x = plate.at_rest();
            let n = plate.names().dimension();
            (x[n + LOAD], x[n + ASPECT]) = (40.0, 1.1);
            settle(&mut plate, &mut x);
            *found = plate.deflection(&x[..n], 0.5, 0.5);
        }
        assert_relative_eq!(found[0], found[1], max_relative = 1e-5);
    }
}

#[test]
fn gradients_of_monitors_agree_with_differences() {
    for units in [Units::Dimensionless, Units::Device] {
        let mut settings = settings("SCSF");
        (settings.units, settings.orders) = (units, orders(5, 6));
        let mut plate = Ritz::new(settings).unwrap();
        let mut x = plate.at_rest();
        let n = plate.names().dimension();
        match units {
            Units::Dimensionless => x[n + LOAD] = 20.0,
            _ => (x[n], x[n + 2]) = (20.0, 330e-6),
        }
        settle(&mut plate, &mut x);
        let count = plate.names().monitors.len();
        for monitor in 0..count {
            let mut slope = vec![0.0; x.len()];
            plate
                .gradient(&x, Functional::Monitor(monitor), &all_parameters(&plate), &mut slope)
                .unwrap();
            for i in 0..x.len() {
                let step = 1e-5 * if x[i] == 0.0 { 1.0 } else { x[i].abs() };
                let mut values = [vec![0.0; count], vec![0.0; count]];
                for (values, sign) in values.iter_mut().zip([-1.0, 1.0]) {
                    let mut moved = x.clone();
                    moved[i] += sign * step;
                    plate.monitors(&moved, 0, values).unwrap();
                }
                let change = 0.5 * (values[1][monitor] - values[0][monitor]);
                let scale = values[0][monitor].abs();
                assert_relative_eq!(
                    slope[i] * step,
                    change,
                    epsilon = 1e-9 * scale,
                    max_relative = 1e-4
                );
            }
        }
    }
}

#[test]
fn a_device_is_the_dimensionless_plate_in_volts_and_hertz() {
    let mut settings = settings("CCCC");
    settings.units = Units::Device;
    let mut device = Ritz::new(settings).unwrap();
    let mut x = device.at_rest();
    let n = device.names().dimension();
    x[n] = 60.0;
    settle(&mut device, &mut x);
    let plate: tangency::problems::plate::Parameters<f64> = Units::Device.parameters(&x[n..]);
    settings.units = Units::Dimensionless;
    let mut dimensionless = Ritz::new(settings).unwrap();
    let mut y = dimensionless.at_rest();
    (y[n + LOAD], y[n + GAP_RATIO], y[n + NU]) = (plate.load, plate.gap_ratio, plate.nu);
    settle(&mut dimensionless, &mut y);
    let (mut volts, mut ratios) = ([0.0; 5], [0.0; 4]);
    device.monitors(&x, 0, &mut volts).unwrap();
    dimensionless.monitors(&y, 0, &mut ratios).unwrap();
    assert_relative_eq!(volts[0], ratios[0], max_relative = 1e-11);
    assert_relative_eq!(volts[3], ratios[3], max_relative = 1e-11);
    assert_relative_eq!(volts[4], ratios[0] * 2e-6, max_relative = 1e-11);
    let hertz: f64 = Units::Device.frequency_unit(&x[n..]);
    assert_relative_eq!(volts[2], ratios[2] * hertz, max_relative = 1e-11);
}

/// A cantilever's tip hangs lowest.
#[test]
fn the_largest_deflection_is_found_at_a_free_edge() {
    let mut plate = Ritz::new(settings("CFFF")).unwrap();
    let mut x = plate.at_rest();
    let n = plate.names().dimension();
    x[n + LOAD] = 1.0;
    settle(&mut plate, &mut x);
    let mut monitors = [0.0; 4];
    plate.monitors(&x, 0, &mut monitors).unwrap();
    let on_edge = (0..=200)
        .map(|k| plate.deflection(&x[..n], 1.0, f64::from(k) / 200.0))
        .fold(f64::NEG_INFINITY, f64::max);
    assert_relative_eq!(monitors[1], on_edge, max_relative = 1e-6);
    assert!(monitors[1] > 2.0 * monitors[0]);
}

/// The force of the full model on a mode is the gradient of the form.
#[test]
fn the_membrane_form_is_the_stretching_energy_of_modes() {
    for in_plane in [InPlane::Immovable, InPlane::Straight, InPlane::Free] {
        let mut settings = settings("CCCC");
        settings.in_plane = in_plane;
        let mut plate = Ritz::new(settings).unwrap();
        let modes = plate.flat_modes(1.3, 0.3, 3).unwrap();
        let form = plate.membrane_form(&modes.shapes, 1.3, 0.3).unwrap();
        let amplitudes = [0.2, -0.05, 0.03];
        let mut x = plate.at_rest();
        let n = plate.names().dimension();
        x[n + ASPECT] = 1.3;
        for (amplitude, shape) in amplitudes.iter().zip(&modes.shapes) {
            x.iter_mut().zip(shape).for_each(|(x, shape)| *x += amplitude * shape);
        }
        let mut force = vec![0.0; n];
        plate.residual(&x, &mut force).unwrap();
        let at = |i: usize, j: usize| {
            form.pairs.iter().position(|pair| *pair == (i.min(j), i.max(j))).unwrap()
        };
        let a = amplitudes;
        for k in 0..3 {
            let found: f64 = force.iter().zip(&modes.shapes[k]).map(|(f, s)| f * s).sum();
            let mut expected = modes.squares[k] * a[k];
            for (j, l, m) in (0..27).map(|e| (e / 9, e / 3 % 3, e % 3)) {
                let entry = form.quartic[at(k, j) * form.pairs.len() + at(l, m)];
                expected += 24.0 * a[j] * entry * a[l] * a[m];
            }
            assert_relative_eq!(found, expected, max_relative = 1e-10, epsilon = 1e-10);
        }
    }
}

#[test]
fn what_has_no_meaning_is_refused_by_name() {
    let mut plate = Ritz::new(settings("SSSS")).unwrap();
    let n = plate.names().dimension();
    let mut r = vec![0.0; n];
    for (parameter, value, name) in
        [(ASPECT, 0.0, "aspect"), (NU, 0.5, "nu"), (NU, -1.0, "nu"), (LOAD, f64::NAN, "load")]
    {
        let mut x = plate.at_rest();
        x[n + parameter] = value;
        assert_eq!(quantity(plate.residual(&x, &mut r)), name);
        assert_eq!(quantity(plate.assemble(&x)), name);
    }
    let mut x = plate.at_rest();
    x[0] = 2.0;
    assert_eq!(quantity(plate.residual(&x, &mut r)), "max_deflection");
    assert!(matches!(Ritz::new(settings("SFFF")).err(), Some(PlateError::Unsupported { .. })));
    let mut settings = settings("SSSS");
    settings.orders = orders(0, 6);
    assert!(matches!(Ritz::new(settings).err(), Some(PlateError::Count { count: 0, .. })));
}

/// Projections on the functions are transposed expansions in them: with the load direct, the
/// equations are the derivative of an energy.
#[test]
fn the_jacobian_is_symmetric() {
    for (supports, symmetric) in [("SSSS", true), ("CSCF", false)] {
        let mut settings = settings(supports);
        settings.symmetric = symmetric;
        settings.orders = Some(Orders { transverse: [3, 4], in_plane: [5, 4] });
        let (mut plate, x) = deflected(settings);
        let n = plate.names().dimension();
        let mut jacobian = vec![0.0; n * n];
        plate.assemble(&x).unwrap();
        plate.jacobian(&mut jacobian);
        let largest = jacobian.iter().fold(0.0, |largest: f64, entry| largest.max(entry.abs()));
        for (i, j) in (0..n).flat_map(|i| (0..i).map(move |j| (i, j))) {
            let difference = jacobian[i * n + j] - jacobian[j * n + i];
            assert!(difference.abs() < 1e-13 * largest, "{supports} ({i}, {j}): {difference:e}");
        }
    }
}

/// What lies outside the domain.
fn quantity(refusal: Result<(), Failure>) -> String {
    match refusal {
        Err(Failure::OutOfDomain(cause)) => cause.quantity,
        Err(Failure::NotFinite { quantity, .. }) => quantity,
        other => panic!("{other:?}"),
    }
}

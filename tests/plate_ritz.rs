//! The full Ritz model of the plate against exact and independently computed values.

use approx::assert_relative_eq;
use std::f64::consts::PI;
use tangency::core::zero::{Border, Slot, System};
use tangency::problems::plate::{InPlane, Orders, Ritz, RitzSettings, Theory};

/// Positions of the dimensionless parameters.
const LOAD: usize = 0;
const GAP_RATIO: usize = 1;
const ASPECT: usize = 2;
const NU: usize = 3;
const FORCE_X: usize = 5;
const PRESSURE: usize = 8;

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

/// Newton's iteration at fixed parameters.
fn equilibrium(plate: &mut Ritz, x: &mut [f64]) {
    let n = plate.names().dimension();
    let mut r = vec![0.0; n];
    for _ in 0..30 {
        plate.residual(x, &mut r).unwrap();
        plate.assemble(x).unwrap();
        plate.factor(Slot::Curve, Border::NONE).unwrap();
        plate.solve(Slot::Curve, &mut r);
        x[..n].iter_mut().zip(&r).for_each(|(x, r)| *x -= r);
        if norm(&r) < 1e-11 * (1.0 + norm(&x[..n])) {
            return;
        }
    }
    panic!("no equilibrium found");
}

/// The load at a given deflection of the centre.
fn at_deflection(plate: &mut Ritz, x: &mut [f64], deflection: f64) {
    let (n, length) = (plate.names().dimension(), x.len());
    let (mut row, mut column, mut unit) = (vec![0.0; length], vec![0.0; n], vec![0.0; length]);
    unit[n + LOAD] = 1.0;
    plate.monitor_gradient(0, x, &mut row);
    for _ in 0..30 {
        let mut r = vec![0.0; n + 1];
        plate.residual(x, &mut r[..n]).unwrap();
        r[n] = row[..n].iter().zip(&*x).map(|(a, b)| a * b).sum::<f64>() - deflection;
        plate.assemble(x).unwrap();
        plate.derivative(x, &unit, &mut column);
        let border = Border { width: 1, columns: &column, rows: &row[..n], corner: &[0.0] };
        plate.factor(Slot::Curve, border).unwrap();
        plate.solve(Slot::Curve, &mut r);
        (0..n).for_each(|i| x[i] -= r[i]);
        x[n + LOAD] -= r[n];
        if norm(&r[..n]) < 1e-10 * norm(&x[..n]) {
            return;
        }
    }
    panic!("no equilibrium found at deflection {deflection}");
}

/// Newton's iteration on the bordered fold condition; `(λ, w)` at the fold.
fn polish_fold(plate: &mut Ritz, x: &mut [f64]) -> (f64, f64) {
    let (n, length) = (plate.names().dimension(), x.len());
    let mut unit = vec![0.0; length];
    unit[n + LOAD] = 1.0;
    let mut b = vec![0.0; n];
    b[0] = 1.0;
    for turn in 0..12 {
        let mut r = vec![0.0; n + 1];
        plate.residual(x, &mut r[..n]).unwrap();
        plate.assemble(x).unwrap();
        let border = Border { width: 1, columns: &b, rows: &b, corner: &[0.0] };
        plate.factor(Slot::Condition, border).unwrap();
        let mut null = vec![0.0; n + 1];
        null[n] = 1.0;
        plate.solve(Slot::Condition, &mut null);
        let scale = norm(&null[..n]);
        if turn < 2 {
            b.iter_mut().zip(&null).for_each(|(b, null)| *b = null / scale);
            continue;
        }
        let mut along = vec![0.0; length];
        along[..n].copy_from_slice(&null[..n]);
        let mut slope = vec![0.0; length];
        plate.gradient(x, &null[..n], &along, &[LOAD], &mut slope);
        slope.iter_mut().for_each(|s| *s = -*s);
        let mut column = vec![0.0; n];
        plate.derivative(x, &unit, &mut column);
        r[n] = null[n];
        let border = Border {
            width: 1,
            columns: &column,
            rows: &slope[..n],
            corner: &[slope[n + LOAD]],
        };
        plate.factor(Slot::Curve, border).unwrap();
        plate.solve(Slot::Curve, &mut r);
        if std::env::var("DEBUG").is_ok() {
            let mut f = vec![0.0; n]; plate.residual(x, &mut f).unwrap();
            let mut kv = vec![0.0; n]; plate.derivative(x, &along, &mut kv);
            println!("load {} F {:e} dq {:e} dl {:e} g={:e} scale {scale:e} slope {:e} {:e} Kv+bg {:e} col {:e} {:?}", x[n+LOAD], norm(&f), norm(&r[..n]), r[n], null[n],
              norm(&slope[..n]), slope[n+LOAD], kv.iter().zip(&b).map(|(k,b)| (k+b*null[n]).abs()).fold(0.0,f64::max), norm(&column), &r[..3]);
        }
        (0..n).for_each(|i| x[i] -= r[i]);
        x[n + LOAD] -= r[n];
        b.iter_mut().zip(&null).for_each(|(b, null)| *b = null / scale);
        if norm(&r[..n]) < 1e-9 * norm(&x[..n]) && r[n].abs() < 1e-11 * x[n + LOAD].abs() {
            break;
        }
    }
    (x[n + LOAD], plate.deflection(&x[..n], 0.5, 0.5))
}

/// A start near the fold: the deflection of the largest load.
fn near_fold(plate: &mut Ritz, gap_ratio: f64, aspect: f64) -> Vec<f64> {
    let mut x = plate.at_rest();
    let n = plate.names().dimension();
    (x[n + GAP_RATIO], x[n + ASPECT]) = (gap_ratio, aspect);
    let mut best = x.clone();
    for step in 1..20 {
        at_deflection(plate, &mut x, 0.04 * f64::from(step));
        if x[n + LOAD] < best[n + LOAD] {
            break;
        }
        best.copy_from_slice(&x);
    }
    best
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
        println!("{supports} {:?}", modes.frequencies());
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
        35.985191115, 73.393845524, 73.393845524, 108.216501691, 131.580772614, 132.204790199,
        165.000406190, 165.000406190,
    ];
    println!("{:?}", modes.frequencies());
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
                plate.derivative(&x, &d, &mut out);
                for i in 0..n {
                    let difference = (out[i] - jacobian[j * n + i]).abs();
                    assert!(difference < 1e-12 * scale, "{supports} {in_plane:?} {i} {j}: {difference:e} of {scale}");
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
        plate.gradient(&x, &w, &v, &released, &mut first);
        plate.second_gradient(&x, &w, &v, &released, &mut second);
        let inner = |a: &[f64]| -> f64 { a.iter().zip(&w).map(|(a, b)| a * b).sum() };
        let step = 1e-4;
        for i in (0..n).chain(released.map(|p| n + p)) {
            let mut both = [[0.0; 2]; 2];
            let mut out = vec![0.0; n];
            for (side, sign) in both.iter_mut().zip([-1.0, 1.0]) {
                let mut moved = x.clone();
                moved[i] += sign * step;
                plate.derivative(&moved, &v, &mut out);
                side[0] = inner(&out);
                plate.second_derivative(&moved, &v, &v, &mut out);
                side[1] = inner(&out);
            }
            let slopes = [0, 1].map(|k| (both[1][k] - both[0][k]) / (2.0 * step));
            assert_relative_eq!(first[i], slopes[0], max_relative = 1e-4, epsilon = 1e-3);
            assert_relative_eq!(second[i], slopes[1], max_relative = 1e-4, epsilon = 1e-2);
        }
    }
}

/// Pull-in of the square plate: supports, in-plane edges, then (α₁, λ, w).
#[test]
fn square_plates_pull_in_at_known_loads() {
    for (supports, in_plane, folds) in [
        ("SSSS", InPlane::Slide, [(0.5, 56.549468343, 0.4909666590), (1.0, 71.252716501, 0.577513077), (2.0, 144.467913425, 0.66999236)]),
        ("SSSS", InPlane::Straight, [(0.5, 53.594250295, 0.4646376967), (1.0, 56.705057715, 0.4923202689), (2.0, 72.090268748, 0.5809940633)]),
        ("SSSS", InPlane::Immovable, [(0.5, 56.570505258, 0.4911554227), (1.0, 71.368061983, 0.578041387), (2.0, 145.074752057, 0.670472884)]),
        ("SSSS", InPlane::Free, [(0.5, 53.125401310, 0.4601926196), (1.0, 54.646105722, 0.4742576904), (2.0, 61.243306692, 0.5230221162)]),
        ("CCCC", InPlane::Immovable, [(0.5, 176.476184448, 0.4773454427), (1.0, 191.915137112, 0.5170906363), (2.0, 268.61404177, 0.6160513076)]),
        ("CCCC", InPlane::Slide, [(0.5, 176.390987643, 0.4770978414), (1.0, 191.525300600, 0.516179861), (2.0, 266.71357784, 0.61476278)]),
        ("CCCC", InPlane::Straight, [(0.5, 173.591508095, 0.4690156596), (1.0, 179.083764635, 0.4846853057), (2.0, 203.429473577, 0.5394034989)]),
        ("CCCC", InPlane::Free, [(0.5, 173.291796590, 0.4681619220), (1.0, 177.799999776, 0.4811899261), (2.0, 196.985891023, 0.5259880977)]),
    ] {
        let mut settings = settings(supports);
        (settings.in_plane, settings.orders) = (in_plane, orders(10, 14));
        let mut plate = Ritz::new(settings).unwrap();
        for (gap_ratio, load, deflection) in folds {
            let mut x = near_fold(&mut plate, gap_ratio, 1.0);
            let found = polish_fold(&mut plate, &mut x);
            println!("{supports} {in_plane:?} {gap_ratio}: {:.2e} {:.2e}", found.0 / load - 1.0, found.1 - deflection);
            assert_relative_eq!(found.0, load, max_relative = 2e-9);
            assert_relative_eq!(found.1, deflection, max_relative = 1e-6);
        }
    }
}

//! Strips: the limit of the long plate.

use crate::plates::models::LOAD;
use crate::plates::plate_fold::{equilibrium, fold, one_mode_start};
use tangency::core::problem::ZeroProblem;
use tangency::core::system::{Dense, System};
use tangency::problems::plate::PlateError;
use tangency::problems::plate::strip::{Ends, Strip, StripSettings};

fn strip(functions: usize, ends: Ends) -> Dense<Strip> {
    let settings = StripSettings { functions, ends, ..Default::default() };
    Dense::new(Strip::new(settings).expect("valid settings"))
}

fn pull_in(functions: usize, ends: Ends, gap_ratio: f64) -> f64 {
    let mut system = strip(functions, ends);
    let start = one_mode_start(&mut system, &[0.0, gap_ratio]);
    fold(&mut system, start)[functions + LOAD]
}

const FOLDS: [(Ends, [f64; 4]); 2] = [
    (Ends::Supported, [13.79038251, 15.60665437, 23.13855200, 58.73790180]),
    (Ends::Clamped, [70.09504829, 72.14917636, 79.12113763, 115.34601976]),
];

#[test]
fn folds_of_supported_and_clamped_strips() {
    for (ends, loads) in FOLDS {
        for (gap_ratio, expected) in [0.0, 0.5, 1.0, 2.0].into_iter().zip(loads) {
            let load = pull_in(40, ends, gap_ratio);
            assert!(
                (load - expected).abs() < 6e-9,
                "{ends:?}, {gap_ratio}: {load}, not {expected}"
            );
        }
    }
}

#[test]
fn convergence_is_algebraic_in_sines_and_exponential_in_polynomials() {
    for (ends, loads) in FOLDS {
        let exact = pull_in(90, ends, 1.0);
        assert!((exact - loads[2]).abs() < 6e-9);
        let errors = [5, 10, 20, 40].map(|n| (pull_in(n, ends, 1.0) / exact - 1.0).abs());
        match ends {
            Ends::Supported => {
                let orders = [0, 1].map(|i| (errors[i] / errors[i + 1]).log2());
                assert!(orders.iter().all(|order| (6.0..8.5).contains(order)), "{orders:?}");
                assert!(errors[1] < 1e-10, "{errors:?}");
            }
            Ends::Clamped => assert!(errors[1] < 1e-9 && errors[2] < 1e-11, "{errors:?}"),
        }
    }
}

#[test]
fn the_deflection_meets_the_conditions_at_the_ends() {
    for ends in [Ends::Supported, Ends::Clamped] {
        let mut system = strip(40, ends);
        let x = equilibrium(&mut system, &[0.0; 40], &[10.0, 1.0]);
        let deflection = |x_: f64| system.problem().deflection(&x[..40], x_);
        assert!(deflection(0.0).abs() < 1e-14 && deflection(1.0).abs() < 1e-14);
        let slope = deflection(1e-6) / 1e-6;
        assert_eq!(slope.abs() < 1e-4, ends == Ends::Clamped, "{ends:?}: {slope}");
        assert!((deflection(0.3) - deflection(0.7)).abs() < 1e-14);
    }
}

#[test]
fn frequency_of_the_flat_strip_and_its_slope() {
    let exact = [std::f64::consts::PI.powi(2), 4.730_040_744_862_704_f64.powi(2)];
    for (ends, exact) in [Ends::Supported, Ends::Clamped].into_iter().zip(exact) {
        let mut system = strip(40, ends);
        let mut at = |load: f64| {
            let x = equilibrium(&mut system, &[0.0; 40], &[load, 1.0]);
            let mut monitors = [0.0; 4];
            System::monitors(&mut system, &x, 0, &mut monitors).expect("finite");
            monitors
        };
        let [deflection, _, frequency, ratio] = at(0.0);
        assert_eq!(deflection, 0.0);
        assert!((frequency / exact - 1.0).abs() < 1e-11, "{frequency}, not {exact}");
        assert!((ratio - 1.0).abs() < 1e-12);
        let slope = (at(1e-3)[2].powi(2) - at(-1e-3)[2].powi(2)) / 2e-3;
        assert!((slope + 2.0).abs() < 1e-5, "d(ω²)/dλ = {slope}");
    }
}

#[test]
fn an_unstable_strip_has_a_negative_frequency() {
    for ends in [Ends::Supported, Ends::Clamped] {
        let mut system = strip(20, ends);
        let start = one_mode_start(&mut system, &[0.0, 1.0]);
        let x = fold(&mut system, start);
        let mut monitors = [0.0; 4];
        System::monitors(&mut system, &x, 0, &mut monitors).expect("finite");
        assert!(monitors[2].abs() < 1e-2, "the frequency vanishes at pull-in: {}", monitors[2]);
        // The same load at a deflection larger by a fifth: beyond the fold.
        let larger: Vec<f64> = x[..20].iter().map(|z| 1.2 * z).collect();
        system.problem().monitors(&larger, &x[20..], &mut monitors);
        assert!(monitors[2] < -1.0 && monitors[3] < 0.0, "{monitors:?}");
    }
}

#[test]
fn settings_and_values_out_of_range_are_refused() {
    let with = |functions, quadrature_points| {
        Strip::new(StripSettings { functions, quadrature_points, ..Default::default() })
    };
    for count in [0, 513] {
        let error = PlateError::Count { what: "functions", count, least: 1, most: 512 };
        assert_eq!(with(count, None).unwrap_err(), error);
    }
    assert!(matches!(with(9, Some(8)).unwrap_err(), PlateError::TooFewPoints { needed: 9, .. }));
    let model = with(3, None).expect("valid settings");
    let left = model.domain(&[1.1, 0.0, 0.0], &[1.0, 1.0]).unwrap_err();
    assert_eq!((left.quantity.as_str(), left.value), ("max_deflection", 1.1));
}

//! What default settings promise of pull-in: loads to 1e-8, deflections to 1e-6, and an honest
//! `error`.

use crate::plates::models::{IN_PLANE, assert_close, pull_in, through_pull_in};
use tangency::core::continuation::{Continuation, Settings, SpecialPoint};
use tangency::core::system::{Kind, System};
use tangency::problems::plate::{InPlane, Ritz, RitzSettings, Units};

/// Pull-in at default settings, and on a discretisation so many rungs up the ladder.
fn both(settings: RitzSettings, gap_ratio: f64, rungs: usize) -> (SpecialPoint, [f64; 2]) {
    let aspect = settings.aspect;
    let mut plate = Ritz::new(settings).unwrap();
    let start = [("gap_ratio", gap_ratio), ("aspect", aspect)];
    let branch = through_pull_in(&mut plate, &start).trace().unwrap();
    let found = pull_in(&branch).clone();
    let mut finer = settings;
    finer.orders = Some((0..rungs).fold(plate.orders(), |orders, _| orders.finer()));
    let mut fine = Ritz::new(finer).unwrap();
    let x = [found.state.clone(), found.parameters.clone()].concat();
    let carried = plate.carry(&x, &fine);
    let n = fine.names().dimension();
    // The start of a curve of folds is a fold: Newton's iteration at a fixed gap ratio.
    let mut curve = Continuation::new(&mut fine)
        .settings(Settings { refinement: 0.0, max_points: 1, ..Settings::default() })
        .from(&carried[..n]);
    for (name, value) in Units::Dimensionless.names().iter().zip(&carried[n..]) {
        curve = curve.at(name, *value);
    }
    let curve = curve
        .hold(Kind::LP)
        .along("load", 0.0..=f64::INFINITY)
        .along("gap_ratio", gap_ratio..=gap_ratio + 1e-3)
        .forward()
        .trace()
        .unwrap();
    let exact = &curve.special[0];
    assert_eq!(exact.parameters[1], gap_ratio);
    (found.clone(), [exact.parameters[0], exact.monitors[0]])
}

/// `[0, 3] × [1, 6]` covered evenly by few points: an additive sequence of the plastic number.
fn gap_and_aspect(k: usize) -> (f64, f64) {
    let fraction = |ratio: f64| (0.5 + k as f64 * ratio).fract();
    (3.0 * fraction(0.754_877_666_246_692_7), 1.0 + 5.0 * fraction(0.569_840_290_998_053_2))
}

fn usual(supports: &str, in_plane: InPlane, aspect: f64) -> RitzSettings {
    RitzSettings { in_plane, aspect, ..RitzSettings::new(supports.parse().unwrap()) }
}

/// Every in-plane model of a plate, all over `0 ≤ α₁ ≤ 3`, `1 ≤ α ≤ 6`.
fn default_settings_suffice(supports: &str, first: usize) {
    let corners = [(0.0, 1.0), (3.0, 1.0), (3.0, 6.0), (0.0, 6.0)];
    for (k, in_plane) in IN_PLANE.into_iter().enumerate() {
        let others = [1, 2].map(|case| gap_and_aspect(2 * (first + k) + case));
        for (gap_ratio, aspect) in [corners[(k + first / 4) % 4], others[0], others[1]] {
            let (found, [load, deflection]) = both(usual(supports, in_plane, aspect), gap_ratio, 3);
            let what = format!(
                "{supports}, {}, gap ratio {gap_ratio:.3}, aspect {aspect:.3}",
                in_plane.name()
            );
            let off = (found.parameters[0] - load).abs();
            assert!(off <= 1e-8 * load, "{what}: load off by {off:e}");
            assert!(found.error <= 1e-8 * load, "{what}: error {:e}", found.error);
            assert_close(&what, found.monitors[0], deflection, 1e-6);
            assert!(off <= found.error, "{what}: {off:e}, not {:e}", found.error);
        }
    }
}

/// Supported plates at default settings.
#[test]
fn default_settings_suffice_for_supported_plates() {
    default_settings_suffice("SSSS", 0);
}

/// Clamped plates at default settings.
#[test]
fn default_settings_suffice_for_clamped_plates() {
    default_settings_suffice("CCCC", 4);
}

/// Plates with free edges report the larger error that they have, and no more than fifty times of
/// it.
#[test]
fn the_error_of_plates_with_free_edges_is_larger_and_honest() {
    for (supports, aspect) in [("SFSF", 2.0), ("CFFF", 1.0), ("CCCF", 1.5)] {
        let plate = usual(supports, InPlane::Immovable, aspect);
        let (found, [load, _]) = both(plate, 1.0, 5);
        let off = (found.parameters[0] - load).abs();
        let (off, error) = (off / load, found.error / load);
        assert!(off <= error, "{supports}: {off:e}, not {error:e}");
        assert!(error > 1e-8 && error < 50.0 * off, "{supports}: {error:e} for {off:e}");
    }
}

/// Where spectral convergence turns algebraic the error changes sign, and one change between rungs
/// is small by accident (6.3e-7, 2.9e-10, 1.0e-10, 1.4e-10): it is not taken for convergence.
#[test]
fn a_change_that_is_small_by_accident_is_not_relied_on() {
    let (found, [load, _]) = both(usual("CCCC", InPlane::Straight, 2.69), 1.676, 5);
    let off = (found.parameters[0] - load).abs();
    assert!(off <= found.error, "{off:e}, not {:e}", found.error);
    assert!(found.error <= 1e-8 * load, "{:e}", found.error);
}

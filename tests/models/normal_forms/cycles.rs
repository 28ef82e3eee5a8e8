//! Promise: special points of cycles carry the coefficients of periodic normal forms, the same by
//! collocation and shooting, on any mesh, in any number of segments and any units; and their points
//! of codimension two are found. The models are suspensions with exact normal forms.

use super::{at, coefficient, model, range, set, traced};
use crate::common::close;
use std::f64::consts::PI;
use tangency::core::continuation::Branch;
use tangency::core::system::Kind;
use tangency::output::Document;
use tangency::scene::{Following, Range, Request, Run, Scene, Start, execute};

/// Discretisations by which a coefficient is the same.
const METHODS: [&str; 5] = [
    "method=collocation",
    "method=collocation intervals=40 degree=3",
    "method=shooting",
    "method=shooting segments=4",
    "method=shooting scheme=DormandPrince5",
];

fn branch(name: &str, values: &str, along: Range) -> Document {
    let request =
        Request { set: set(values), along: vec![along], settle: Some(100.0), ..Request::default() };
    traced(model(name), &request)
}

fn curve(name: &str, values: &str, kind: Kind, along: [Range; 2]) -> Branch {
    let request = Request {
        set: set(values),
        along: along.into(),
        settle: Some(100.0),
        hold: Some(kind),
        ..Request::default()
    };
    traced(model(name), &request).branches.pop().unwrap()
}

#[test]
fn folds_of_cycles() {
    for method in METHODS {
        let document = branch("folded", method, range("m1", -0.15, 0.2));
        let fold = at(&document.branches[0], Kind::LP, "m1", 0.0, 1e-9);
        coefficient(fold, "fold_b", -0.7 / 0.4, 1e-7);
    }
}

#[test]
fn period_doublings_of_cycles() {
    for method in METHODS {
        for (c, case) in [(0.7, "subcritical"), (-0.5, "supercritical")] {
            let values = format!("{method} c={c}");
            let document = branch("flipped", &values, range("mu", -0.2, 0.2));
            let doubling = at(&document.branches[0], Kind::PD, "mu", 0.0, 1e-9);
            coefficient(doubling, "doubling_c", c / (2.0 * PI), 1e-7);
            coefficient(doubling, "growth_slope", 1.0, 1e-7);
            assert_eq!(doubling.subkind.as_deref(), Some(case));
        }
    }
}

#[test]
fn torus_points_of_cycles() {
    for method in METHODS {
        let document = branch("torus", method, range("mu", -0.1, 0.1));
        let torus = at(&document.branches[0], Kind::TR, "mu", 0.0, 1e-9);
        coefficient(torus, "torus_angle", 2.0 * PI * 0.21, 1e-7);
        coefficient(torus, "torus_d_re", -0.7 / PI, 1e-7);
        coefficient(torus, "torus_d_im", 0.45 / PI, 1e-7);
        coefficient(torus, "growth_slope", 1.0, 1e-7);
        assert_eq!(torus.subkind.as_deref(), Some("supercritical"));
    }
}

#[test]
fn cycles_of_codimension_two() {
    for method in METHODS {
        let values = format!("{method} b0=0 c=-0.3 m2=0.3");
        let along = [range("m1", -0.15, 0.2), range("m2", -0.5, 0.5)];
        let folds = curve("folded", &values, Kind::LP, along);
        let cusp = at(&folds, Kind::CP, "m2", 0.0, 1e-9);
        // s' = c s³ and θ' = 1 + k s: with ξ = −k s the period changes by itself.
        coefficient(cusp, "cpc_c", -0.3 / 0.4_f64.powi(2), 1e-6);
        let along = [range("mu", -0.2, 0.2), range("c", -1.0, 1.0)];
        let doublings = curve("flipped", method, Kind::PD, along);
        let point = at(&doublings, Kind::GPD, "c", 0.0, 1e-9);
        coefficient(point, "gpd_e", 0.3 / (4.0 * PI * PI), 1e-6);
        assert_eq!(point.subkind.as_deref(), Some("e > 0"));
        let along = [range("mu", -0.1, 0.2), range("dr", -1.0, 1.0)];
        let tori = curve("torus", method, Kind::TR, along);
        let point = at(&tori, Kind::CH, "dr", 0.0, 1e-9);
        coefficient(point, "ch_e_re", 0.2 / (PI * PI), 1e-6);
        assert_eq!(point.subkind.as_deref(), Some("e > 0"));
    }
}

/// Curves of cycles divide the plane as the exact normal forms do: `μ > 0` has more unstable
/// directions, and cycles of a fold have `m₁ < m₂²/(4 b₀)`. The second parameter rises along the
/// curve, or falls.
#[test]
fn the_sides_of_curves_of_cycles() {
    for method in ["method=collocation", "method=shooting"] {
        for (name, kind, along, [below, above]) in [
            (
                "folded",
                Kind::LP,
                [range("m1", -0.15, 0.2), range("m2", -0.3, 0.3)],
                [vec![0, 1], vec![]],
            ),
            (
                "flipped",
                Kind::PD,
                [range("mu", -0.2, 0.2), range("c", 0.2, 1.0)],
                [vec![0], vec![1]],
            ),
            (
                "torus",
                Kind::TR,
                [range("mu", -0.1, 0.2), range("dr", -1.0, -0.2)],
                [vec![0], vec![2]],
            ),
        ] {
            let branch = curve(name, method, kind, along);
            let second = branch.column(&branch.released[1]).unwrap();
            let [stretch] = &branch.stretches[..] else { panic!("{:?}", branch.stretches) };
            assert!(stretch.points[0] <= 1 && stretch.points[1] + 2 >= branch.points.len());
            let [first, last] = stretch.points.map(|k| branch.points[k].value(second).unwrap());
            let sides = [&stretch.left, &stretch.right];
            let expected = if first < last { [&below, &above] } else { [&above, &below] };
            assert_eq!(sides, expected, "{name}, {method}");
        }
    }
}

/// The rates per time of `v = s` and `y = √(2π) p` with `p² = P2`. `E` does not depend on the rate of
/// time, `dτ/dt = 1 − v`. Since the band turns by half of θ and its equations by half of t, they
/// differ by `v/2`, and the direction with the rate −ν returns `−v²/(4ν)` to the rate of `y`.
#[test]
fn fold_flip_points_of_cycles() {
    let [b20, b02, b11, b30, b12, b21, b03] = [1.0, 0.5, 0.2, 0.7, -0.4, 0.3, -0.6];
    let e: f64 = b21 - 1.0 / (4.0 * 0.3)
        + 0.5 * b11 * (2.0 * b03 / b02 - 3.0 * b30 / b20 + b12 / b02)
        - b03 * b20 / b02;
    for method in METHODS {
        let values = format!("{method} b30={b30} b12={b12} b21={b21} b03={b03}");
        let along = [range("m1", -0.15, 0.2), range("m2", -0.5, 0.5)];
        let folds = curve("fold-flip", &values, Kind::LP, along);
        let point = at(&folds, Kind::LPPD, "m2", 0.0, 1e-9);
        coefficient(point, "lppd_a20", b20, 1e-6);
        coefficient(point, "lppd_a02", b02 / (2.0 * PI), 1e-6);
        coefficient(point, "lppd_b11", b11, 1e-6);
        coefficient(point, "lppd_theta", b11 / b20, 1e-6);
        coefficient(point, "lppd_e", e, 1e-6);
        assert_eq!(point.subkind.as_deref(), Some("s = 1, θ > 0"));
    }
}

#[test]
fn double_multipliers_of_cycles() {
    for method in METHODS {
        let along = [range("e1", -0.2, 0.2), range("e2", -0.5, 0.5)];
        let folds = curve("resonant-one", method, Kind::LP, along);
        let one = at(&folds, Kind::R1, "e2", 0.0, 1e-9);
        coefficient(one, "r1_a", 1.0, 1e-6);
        coefficient(one, "r1_b", 0.4, 1e-6);
        assert_eq!(one.subkind.as_deref(), Some("s = 1"));
        let along = [range("e1", -0.2, 0.2), range("e2", -0.5, 0.5)];
        let doublings = curve("resonant-two", method, Kind::PD, along);
        let along = [range("e2", -0.2, 0.2), range("e1", -0.3, 0.2)];
        let tori = curve("resonant-two", method, Kind::TR, along);
        let two = at(&doublings, Kind::R2, "e2", 0.0, 1e-9);
        for two in [two, at(&tori, Kind::R2, "e1", 0.0, 1e-9)] {
            // ∫⟨q, q⟩ = 2π for s = p cos(θ/2), Z = p sin(θ/2).
            coefficient(two, "r2_a", 0.3 / (2.0 * PI), 1e-6);
            coefficient(two, "r2_b", -0.5 / (2.0 * PI), 1e-6);
            assert_eq!(two.subkind.as_deref(), Some("s = 1, b < 0"));
        }
    }
}

/// The map of states over a period has `C = 7.41772808814` and `D = 5.88072831974` in
/// `ξ₂ → −ξ₂ + C ξ₁³ + D ξ₁² ξ₂`; `b/a = −D/C − 3` does not depend on norms.
#[test]
fn the_resonance_of_a_seasonal_predator() {
    for method in METHODS {
        let along = [range("b0", 0.3, 0.5), range("eps", 0.25, 0.36)];
        let doublings = curve("seasonal", &format!("{method} eps=0.33 b0=0.45"), Kind::PD, along);
        let two = at(&doublings, Kind::R2, "eps", 0.336962751055, 1e-9);
        let number = |name: &str| two.number(name).unwrap();
        let [a, b] = ["r2_a", "r2_b"].map(number);
        close(b.value / a.value, -5.88072831974 / 7.41772808814 - 3.0, 1e-9);
        assert!(a.error < 1e-6 * a.value && b.error < 1e-6 * -b.value, "{a:?} {b:?}");
        assert_eq!(two.subkind.as_deref(), Some("s = 1, b < 0"));
    }
}

/// The fold of the orbits of two seasons has a double multiplier 1. The reference has 12 digits.
#[test]
fn the_resonance_of_doubled_orbits_of_a_seasonal_predator() {
    let along = |low, high| range("b0", low, high);
    let request = Request {
        set: set("method=shooting eps=0.6 b0=0.6"),
        along: vec![along(0.05, 0.8)],
        settle: Some(100.0),
        ..Request::default()
    };
    let mut scene = Scene::of_model(model("seasonal"), "test", &request).unwrap();
    let orbits = scene.runs[0].clone();
    let from = |run: &str, kind: Kind, switch: bool| Start::From {
        run: run.into(),
        kind,
        nth: 0,
        switch,
        which: 0,
        unconverged: false,
    };
    let start = from(&orbits.name, Kind::PD, true);
    scene.runs.push(Run { name: "doubled".into(), start, ..orbits.clone() });
    let along = vec![along(0.1, 0.3), range("eps", 0.5, 0.7)];
    let (start, hold) = (from("doubled", Kind::LP, false), Some(Kind::LP));
    scene.runs.push(Run { name: "folds".into(), start, hold, along, ..orbits });
    let outcome = execute(&scene, None, &mut ());
    assert!(outcome.error.is_none(), "{:?}", outcome.error);
    let folds = outcome.document.branch("folds").unwrap();
    let one = at(folds, Kind::R1, "eps", 0.604403380885, 1e-9);
    let b0 = one.value(folds.column("b0").unwrap()).unwrap();
    close(b0, 0.176960742715, 1e-9);
    assert_eq!(one.subkind.as_deref(), Some("s = 1"));
}

/// `z' = (… + i om) z + (dr + i di) z |z|² + e^{iθ} (q2 z̄² + q3 z̄³)`, `∫⟨q, q⟩ = π` for `z = s + iZ`. At
/// om = 1/4 the quadratic term does not resonate, and is zero.
#[test]
fn multipliers_of_order_three_and_four_of_cycles() {
    for method in METHODS {
        let of = |values: &str| {
            let along = [range("mu", -0.1, 0.2), range("om", 0.2, 0.4)];
            curve("torus", &format!("{method} {values}"), Kind::TR, along)
        };
        let tori = of("q2=0.6");
        let three = at(&tori, Kind::R3, "om", 1.0 / 3.0, 1e-9);
        coefficient(three, "r3_b", 0.6 / PI.sqrt(), 1e-6);
        coefficient(three, "r3_c_re", -0.7 / PI, 1e-6);
        assert_eq!(three.subkind.as_deref(), Some("c < 0"));
        let tori = of("q3=0.35");
        let four = at(&tori, Kind::R4, "om", 0.25, 1e-9);
        coefficient(four, "r4_d", 0.35 / PI, 1e-6);
        coefficient(four, "r4_a0_re", -0.7 / 0.35, 1e-6);
        coefficient(four, "r4_a0_im", 0.45 / 0.35, 1e-6);
        assert_eq!(four.subkind.as_deref(), Some("Re A₀ < 0"));
    }
}

/// With `∫⟨q, q⟩ = 1`, `|ξ|² = π r` and `y² = 2π P2`.
#[test]
fn two_critical_multipliers_of_cycles() {
    let along = |name: &str, low| [range(name, low, 0.2), range("m2", -0.3, 0.2)];
    for method in METHODS {
        let folds =
            curve("fold-torus", &format!("{method} c02=-0.4 c11=0.6"), Kind::LP, along("m1", -0.2));
        let point = at(&folds, Kind::LPNS, "m2", 0.0, 1e-9);
        coefficient(point, "lpns_a20", 1.0, 1e-6);
        coefficient(point, "lpns_a02", -0.4 / PI, 1e-6);
        coefficient(point, "lpns_b11", 0.6, 1e-6);
        coefficient(point, "lpns_e", (1.0 - 0.6) / -0.4, 1e-6);
        assert_eq!(point.subkind.as_deref(), Some("s = −1, θ > 0"));
        let couplings = format!("{method} c12=0.3 c21=-0.7");
        let flips = curve("flip-torus", &couplings, Kind::PD, along("mu", -0.3));
        let point = at(&flips, Kind::PDNS, "m2", 0.0, 1e-9);
        coefficient(point, "pdns_p11", -1.0 / (2.0 * PI), 1e-6);
        coefficient(point, "pdns_p22", -1.0 / PI, 1e-6);
        coefficient(point, "pdns_theta", -0.3, 1e-6);
        coefficient(point, "pdns_delta", 0.7, 1e-6);
        let tori = curve("two-tori", &couplings, Kind::TR, along("mu", -0.2));
        let point = at(&tori, Kind::NSNS, "m2", 0.0, 1e-9);
        // The pair with the larger angle is that of m2.
        coefficient(point, "nsns_p11", -1.0 / PI, 1e-6);
        coefficient(point, "nsns_p22", -1.0 / PI, 1e-6);
        coefficient(point, "nsns_theta", 0.7, 1e-6);
        coefficient(point, "nsns_delta", -0.3, 1e-6);
        assert_eq!(point.subkind.as_deref(), Some("simple"));
    }
}

/// A pair becomes critical beside a multiplier 1 or −1, or another pair; the curve of the other kind
/// starts there.
#[test]
fn pairs_beside_other_critical_multipliers() {
    for (name, kind, first, found, next) in [
        ("fold-torus", Kind::LP, ("m1", -0.2), Kind::LPNS, Kind::TR),
        ("flip-torus", Kind::PD, ("mu", -0.3), Kind::PDNS, Kind::TR),
        ("two-tori", Kind::TR, ("mu", -0.2), Kind::NSNS, Kind::TR),
    ] {
        let request = Request {
            set: set("method=shooting"),
            along: vec![range(first.0, first.1, 0.2), range("m2", -0.3, 0.2)],
            settle: Some(100.0),
            hold: Some(kind),
            ..Request::default()
        };
        let scene = Scene::of_model(model(name), name, &request).unwrap();
        let following = Following { kinds: Following::of_curves(), depth: 1, distinct: false };
        let (_, outcome) = scene.resolve(None).unwrap().explore(&following, &mut ());
        assert!(outcome.error.is_none(), "{name}: {:?}", outcome.error);
        let curves = &outcome.document.branches[1..];
        at(&curves[0], found, "m2", 0.0, 1e-9);
        // The other curve is m2 = 0, not the same one again.
        assert_eq!(curves[1].condition, Some(next), "{name}");
        let m2 = curves[1].column("m2").unwrap();
        assert!(
            curves[1].points.iter().all(|point| point.value(m2).unwrap().abs() < 1e-8),
            "{name}"
        );
        assert!(curves[1].points.len() > 4, "{name}");
    }
}

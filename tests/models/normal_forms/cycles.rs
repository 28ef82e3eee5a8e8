//! Promise: special points of cycles carry the coefficients of periodic normal forms, the same by
//! collocation and shooting, on any mesh, in any number of segments and any units; and their points
//! of codimension two are found. The models are suspensions with exact normal forms.

use super::{at, coefficient, model, range, set, traced};
use std::f64::consts::PI;
use tangency::core::continuation::Branch;
use tangency::core::system::Kind;
use tangency::output::Document;
use tangency::scene::{Following, Range, Request, Scene};

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
    for method in ["method=collocation", "method=shooting"] {
        let values = format!("{method} b0=0 c=-0.3 m2=0.3");
        let along = [range("m1", -0.15, 0.2), range("m2", -0.5, 0.5)];
        let folds = curve("folded", &values, Kind::LP, along);
        at(&folds, Kind::CP, "m2", 0.0, 1e-9);
        let along = [range("mu", -0.2, 0.2), range("c", -1.0, 1.0)];
        let doublings = curve("flipped", method, Kind::PD, along);
        at(&doublings, Kind::GPD, "c", 0.0, 1e-9);
        let along = [range("mu", -0.1, 0.2), range("dr", -1.0, 1.0)];
        let tori = curve("torus", method, Kind::TR, along);
        at(&tori, Kind::CH, "dr", 0.0, 1e-9);
        let along = [range("m1", -0.15, 0.2), range("m2", -0.5, 0.5)];
        let folds = curve("fold-flip", method, Kind::LP, along);
        at(&folds, Kind::LPPD, "m2", 0.0, 1e-9);
    }
}

#[test]
fn resonances_of_cycles() {
    for method in ["method=collocation", "method=shooting"] {
        let along = [range("e1", -0.2, 0.2), range("e2", -0.5, 0.5)];
        let folds = curve("resonant-one", method, Kind::LP, along);
        at(&folds, Kind::R1, "e2", 0.0, 1e-9);
        let along = [range("e1", -0.2, 0.2), range("e2", -0.5, 0.5)];
        let doublings = curve("resonant-two", method, Kind::PD, along);
        at(&doublings, Kind::R2, "e2", 0.0, 1e-9);
        let along = [range("e2", -0.2, 0.2), range("e1", -0.3, 0.2)];
        let tori = curve("resonant-two", method, Kind::TR, along);
        at(&tori, Kind::R2, "e1", 0.0, 1e-9);
        let along = [range("mu", -0.1, 0.2), range("om", 0.2, 0.4)];
        let tori = curve("torus", method, Kind::TR, along);
        at(&tori, Kind::R3, "om", 1.0 / 3.0, 1e-9);
        at(&tori, Kind::R4, "om", 0.25, 1e-9);
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

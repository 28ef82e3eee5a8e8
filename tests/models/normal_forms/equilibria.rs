//! Promise: special points of equilibria carry their normal forms, and those of codimension two are
//! found to 1e-10 with theirs.

use super::{at, coefficient, model, range, set, traced};
use crate::common::close;
use tangency::core::continuation::{Branch, End};
use tangency::core::system::Kind;
use tangency::output::Document;
use tangency::scene::{Following, Request, Scene};

fn branch(document: &Document) -> &Branch {
    document.branches.last().unwrap()
}

/// `Re c₁ = −(A² + 2)/(2(2A² + 1))`, `ω = A` at `B = 1 + A²`; the real part of the eigenvalues is
/// `(B − 1 − A²)/2`.
#[test]
fn the_brusselator_at_four_values() {
    for a in [0.3, 1.0, 2.0, 5.0_f64] {
        let along = vec![range("b", 0.5, 30.0)];
        let request = Request { set: set(&format!("a={a}")), along, ..Request::default() };
        let document = traced(model("brusselator"), &request);
        let hopf = at(branch(&document), Kind::HB, "b", 1.0 + a * a, 1e-10);
        let real = -(a * a + 2.0) / (2.0 * (2.0 * a * a + 1.0));
        coefficient(hopf, "c1_re", real, 1e-9);
        coefficient(hopf, "l1", real / a, 1e-9);
        coefficient(hopf, "growth_slope", 0.5, 1e-9);
        assert_eq!(hopf.subkind.as_deref(), Some("supercritical"));
    }
}

#[test]
fn fitzhugh_nagumo_is_subcritical_on_both_sides() {
    let request = Request { along: vec![range("i", 0.0, 2.0)], ..Request::default() };
    let document = traced(model("fitzhugh-nagumo"), &request);
    for (i, v) in [(0.331281337455, -0.936_f64.sqrt()), (1.41871866254, 0.936_f64.sqrt())] {
        let hopf = at(branch(&document), Kind::HB, "i", i, 1e-11);
        close(hopf.state[0], v, 1e-10);
        coefficient(hopf, "hopf_frequency", 0.275506805724, 1e-9);
        coefficient(hopf, "c1_re", 0.267784648054, 1e-9);
        coefficient(hopf, "c1_im", -2.27251939692, 1e-9);
        coefficient(hopf, "l1", 0.971971081989, 1e-9);
        assert_eq!(hopf.subkind.as_deref(), Some("subcritical"));
    }
}

/// `u' = −(m − 1) u − u²/√2` at `m = 1`.
#[test]
fn a_transcritical_point() {
    let request = Request { along: vec![range("m", 0.5, 1.5)], ..Request::default() };
    let document = traced(model("predator-prey"), &request);
    let point = at(branch(&document), Kind::BP, "m", 1.0, 1e-12);
    coefficient(point, "transcritical_a", 0.5_f64.sqrt(), 1e-9);
    coefficient(point, "growth_slope", 1.0, 1e-9);
    assert_eq!(point.subkind.as_deref(), Some("transcritical"));
}

/// Two folds and two Hopf points. (MatCont's manual prints Hopf points with `Re c₁` 10.70259 and
/// 4.332247 and folds with `|a|` 0.1166509 and 0.1346534, from coarser points.)
#[test]
fn co_oxidation_in_one_parameter() {
    let request = Request { along: vec![range("q2", 0.5, 2.0)], ..Request::default() };
    let document = traced(model("co-oxidation"), &request);
    let branch = branch(&document);
    for (q2, a) in [(1.04204850538, 0.116659346881), (1.05220028787, -0.134650516124)] {
        coefficient(at(branch, Kind::LP, "q2", q2, 1e-11), "fold_a", a, 1e-9);
    }
    for (q2, omega, re, im) in [
        (1.05155746246, 0.0507403448968, 10.7010196344, -28.5919792821),
        (1.04099156953, 0.0591061479358, 4.33137897821, -15.4356224493),
    ] {
        let hopf = at(branch, Kind::HB, "q2", q2, 1e-11);
        coefficient(hopf, "hopf_frequency", omega, 1e-9);
        coefficient(hopf, "c1_re", re, 1e-9);
        coefficient(hopf, "c1_im", im, 1e-9);
        // The quotient of two numbers of 12 digits.
        close(hopf.number("l1").unwrap().value * omega / re, 1.0, 2e-11);
    }
}

#[test]
fn co_oxidation_in_two_parameters() {
    let along = || vec![range("q2", 0.5, 2.0), range("k", 0.1, 2.0)];
    let request = Request { along: along(), hold: Some(Kind::LP), ..Request::default() };
    let folds = traced(model("co-oxidation"), &request);
    let cusp = at(branch(&folds), Kind::CP, "q2", 1.00640832968, 1e-10);
    close(cusp.parameters[6], 0.355991273209, 1e-10);
    coefficient(cusp, "cusp_c", 0.362788656889, 1e-9);
    let request = Request { along: along(), hold: Some(Kind::HB), ..Request::default() };
    let hopf = traced(model("co-oxidation"), &request);
    for curve in [branch(&folds), branch(&hopf)] {
        for (q2, k, a, b) in [
            (1.41762763760, 0.971397573485, 0.0837844414229, 2.13627992512),
            (1.16119870882, 0.722339072522, -0.0482256452439, -1.93763256963),
        ] {
            let point = at(curve, Kind::BT, "q2", q2, 1e-10);
            close(point.parameters[6], k, 1e-10);
            coefficient(point, "bt_a", a, 1e-9);
            coefficient(point, "bt_b", b, 1e-9);
        }
    }
    for (q2, k, omega, l2) in [
        (0.891318980774, 0.232487354203, 0.0576554391560, -776.900344344),
        (0.924255015219, 0.305879267478, 0.0592647113301, -240.123387708),
    ] {
        let point = at(branch(&hopf), Kind::GH, "q2", q2, 1e-10);
        close(point.parameters[6], k, 1e-10);
        close(point.monitors[branch(&hopf).monitors.len() - 1], omega, 1e-10);
        // The second coefficient changes by a thousandth per 1e-8 of the place.
        coefficient(point, "c2_re", l2, 1e-6);
        assert_eq!(point.subkind.as_deref(), Some("l2 < 0"));
    }
    assert_eq!(branch(&hopf).of_kind(Kind::GH).count(), 2, "poles are no zeros");
}

#[test]
fn bazykin_in_two_parameters() {
    let along = || vec![range("al", 0.05, 1.0), range("de", 1e-4, 4.0)];
    let request = Request { along: along(), hold: Some(Kind::LP), ..Request::default() };
    let folds = traced(model("bazykin"), &request);
    for (al, de, a, b) in [
        (0.860704459310, 0.00605879439401, -8.78262838685e-4, -0.0199572451794),
        (0.453624327778, 0.175127592950, 0.0394530911237, -0.0525387764929),
    ] {
        let point = at(branch(&folds), Kind::BT, "al", al, 1e-10);
        close(point.parameters[1], de, 1e-10);
        coefficient(point, "bt_a", a, 1e-9);
        coefficient(point, "bt_b", b, 1e-9);
    }
    for (al, de, c) in [
        (0.901232691939, 0.00356841936127, 7.59001809567e-5),
        (0.0887673080610, 2.80236121027, -1.94878480951e-4),
    ] {
        let point = at(branch(&folds), Kind::CP, "al", al, 1e-10);
        close(point.parameters[1], de, 1e-10);
        coefficient(point, "cusp_c", c, 1e-9);
    }
}

/// Where a curve of Hopf points ends at a double zero eigenvalue the determinant vanishes as well: a
/// field in the plane has no fold–Hopf points. Both Bogdanov–Takens points have homoclinic orbits.
#[test]
fn planar_fields_have_no_fold_hopf_points() {
    let along = vec![range("al", 0.01, 2.0), range("de", 1e-4, 0.4)];
    let request = Request { along, hold: Some(Kind::LP), ..Request::default() };
    let scene = Scene::of_model(model("bazykin"), "bazykin", &request).unwrap();
    let following = Following { kinds: Following::of_curves(), depth: 1, distinct: false };
    let (_, outcome) = scene.resolve(None).unwrap().explore(&following, &mut ());
    assert!(outcome.error.is_none(), "{:?}", outcome.error);
    let branches = &outcome.document.branches;
    assert!(branches.iter().all(|branch| branch.of_kind(Kind::ZH).count() == 0));
    let count = |kind| branches.iter().filter(|branch| branch.condition == Some(kind)).count();
    assert_eq!((count(Kind::HB), count(Kind::HOM)), (2, 2), "{:?}", branches[1].warnings);
    // Both curves of homoclinic orbits come near a saddle–node.
    let mut homoclinic = branches.iter().filter(|branch| branch.condition == Some(Kind::HOM));
    assert!(homoclinic.all(|branch| matches!(branch.ends[1], End::WeakSaddle { .. })));
}

/// One request draws the bifurcation set: the curve of Hopf points leaves that of folds at both
/// Bogdanov–Takens points, and is traced once; a curve of folds of cycles connects both generalised
/// Hopf points, and a curve of homoclinic orbits leaves each Bogdanov–Takens point. Meshes on which
/// cycles have an error of 1e-4 are too coarse for these folds: near the canards, at q2 = 1.06,
/// curves from both ends once stopped.
#[test]
fn curves_through_points_of_codimension_two_are_followed() {
    let along = vec![range("q2", 0.5, 2.0), range("k", 0.1, 2.0)];
    for (first, other, depth) in [(Kind::LP, Kind::HB, 3), (Kind::HB, Kind::LP, 1)] {
        let request = Request { along: along.clone(), hold: Some(first), ..Request::default() };
        let scene = Scene::of_model(model("co-oxidation"), "oxidation", &request).unwrap();
        let resolution = scene.resolve(None).unwrap();
        let following = Following { kinds: Following::of_curves(), depth, distinct: false };
        let (_, outcome) = resolution.explore(&following, &mut ());
        assert!(outcome.error.is_none(), "{:?}", outcome.error);
        let branches = &outcome.document.branches;
        let conditions: Vec<_> = branches.iter().map(|branch| branch.condition).collect();
        assert_eq!(conditions[..3], [None, Some(first), Some(other)]);
        for q2 in [1.41762763760, 1.16119870882] {
            at(&branches[1], Kind::BT, "q2", q2, 1e-10);
        }
        // A curve of folds starts at the first of them.
        at(&branches[2], Kind::BT, "q2", 1.41762763760, 1e-10);
        if depth > 1 {
            assert_eq!(conditions[3..], [Some(Kind::HOM), Some(Kind::HOM), Some(Kind::LP)]);
            at(&branches[5], Kind::GH, "q2", 0.891318980774, 1e-8);
            // Homoclinic orbits to a saddle–node: the curves end before their steps crawl.
            for homoclinic in &branches[3..5] {
                let end = &homoclinic.ends[1];
                assert!(matches!(end, End::WeakSaddle { .. }), "{end:?}");
                assert!(homoclinic.points.len() < 200, "{}", homoclinic.points.len());
            }
        }
    }
}

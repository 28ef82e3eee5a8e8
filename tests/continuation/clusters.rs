//! Promise: special points that lie close together are found each and followed, folds between
//! points are seen, and branches end where they lead nowhere.

use tangency::core::continuation::{Branch, End, SpecialPoint};
use tangency::core::system::Kind;
use tangency::scene::{Outcome, Scene, explore};

/// Traces a model along a range, and follows what is found.
fn followed(model: &str, along: &str, depth: usize) -> Outcome {
    let name = along.split(',').next().unwrap();
    let [low, high] = [1, 2].map(|k| along.split(',').nth(k).unwrap());
    let text = format!(
        "Scene(title: \"t\", problem: {model}, runs: [Run(name: \"r\", along: [(name: \"{name}\", low: {low}, high: {high})])])"
    );
    let (_, outcome) = explore(&Scene::parse(&text).unwrap(), depth, &mut ());
    assert_eq!(outcome.error, None);
    outcome
}

fn branches(outcome: &Outcome) -> Vec<&str> {
    outcome.document.branches.iter().map(|branch| branch.name.as_str()).collect()
}

/// The special points of a branch between its ends, with their values and multiplicities.
fn found(branch: &Branch) -> Vec<(Kind, f64, usize)> {
    let inside = branch.special.iter().filter(|it| it.kind != Kind::EP);
    inside
        .map(|it| {
            assert!(it.converged, "{it:?}");
            (it.kind, it.parameters[0], it.multiplicity)
        })
        .collect()
}

#[track_caller]
fn check(found: &[(Kind, f64, usize)], expected: &[(Kind, f64, usize)], error: f64) {
    assert_eq!(found.len(), expected.len(), "{found:?}");
    for (a, b) in found.iter().zip(expected) {
        assert!(a.0 == b.0 && a.2 == b.2 && (a.1 - b.1).abs() < error, "{found:?}");
    }
}

fn number(point: &SpecialPoint, name: &str) -> f64 {
    point.number(name).unwrap().value
}

/// Two transcritical points, however near they are: both are found, and the branches that cross
/// there are followed.
#[test]
fn branch_points_near_each_other_are_two() {
    for q in [3e-3, 1e-3, 1e-4, 1e-6, 1e-8, 1e-9] {
        let model = format!(
            "Equations(states: [(\"x\", \"x*(p - x - 2*y)\"), (\"y\", \"y*(p + {q} - 3*x - y)\")], solution: equilibrium,
             parameters: [(\"p\", -1)], initial: [(\"x\", 0), (\"y\", 0)])"
        );
        let outcome = followed(&model, "p,-1,1", 1);
        assert_eq!(branches(&outcome), ["r", "r-BP1", "r-BP2"]);
        check(
            &found(&outcome.document.branches[0]),
            &[(Kind::BP, -q, 1), (Kind::BP, 0.0, 1)],
            1e-12,
        );
    }
}

/// Where they coincide, three other branches cross, and each is followed.
#[test]
fn all_branches_at_a_double_point_are_followed() {
    let model = "Equations(states: [(\"x\", \"x*(p - x - 2*y)\"), (\"y\", \"y*(p - 3*x - y)\")], solution: equilibrium,
         parameters: [(\"p\", -1)], initial: [(\"x\", 0), (\"y\", 0)])";
    let outcome = followed(model, "p,-1,1", 1);
    assert_eq!(branches(&outcome), ["r", "r-BP", "r-BP.2", "r-BP.3"]);
    check(&found(&outcome.document.branches[0]), &[(Kind::BP, 0.0, 2)], 1e-12);
    // x = 0, y = p; x = p, y = 0; 5x = p, 5y = 2p. None of them sees the point that it starts from.
    for branch in &outcome.document.branches[1..] {
        assert_eq!(found(branch), []);
    }
}

const PAIRS: &str = "[(\"x\", \"p*x - y - x*(x^2 + y^2)\"), (\"y\", \"x + p*y - y*(x^2 + y^2)\"),
    (\"u\", \"(p + q)*u - w*v - u*(u^2 + v^2)\"), (\"v\", \"w*u + (p + q)*v - v*(u^2 + v^2)\")]";

/// Two Hopf points of different frequency, also at one parameter, lead to two families of cycles.
#[test]
fn pairs_of_hopf_points() {
    for q in [1e-3, 1e-6, 1e-9, 0.0] {
        let model = format!(
            "Equations(states: {PAIRS}, solution: equilibrium, parameters: [(\"p\", -1), (\"q\", {q}), (\"w\", 1.7)])"
        );
        let outcome = followed(&model, "p,-1,1", 1);
        assert_eq!(branches(&outcome), ["r", "r-HB1", "r-HB2"]);
        let rest = &outcome.document.branches[0];
        check(&found(rest), &[(Kind::HB, -q, 1), (Kind::HB, 0.0, 1)], 1e-12);
        let mut periods = outcome.document.branches[1..].iter().map(|family| {
            let column = family.column("period").unwrap();
            family.points[0].value(column).unwrap() * number(&rest.special[1], "hopf_frequency")
        });
        let [first, second] = [periods.next().unwrap(), periods.next().unwrap()];
        let ratio = (first / second).max(second / first);
        assert!((ratio - 1.7).abs() < 1e-9, "{q}: {first}, {second}");
    }
}

/// Two copies of a system side by side have the special points of one, each twice.
#[test]
fn two_copies_have_the_points_of_one() {
    let folds = "Equations(states: [(\"x\", \"h + x - x^3\"), (\"u\", \"h + u - u^3\")], solution: equilibrium,
         parameters: [(\"h\", -1)], initial: [(\"x\", -1.3), (\"u\", -1.3)])";
    let fold = 2.0 / 27.0_f64.sqrt();
    let outcome = followed(folds, "h,-1,1", 1);
    let expected = [(Kind::LP, fold, 2), (Kind::LP, -fold, 2)];
    check(&found(&outcome.document.branches[0]), &expected, 1e-9);
    // Both folds lie on the closed curve of solutions of which one is the mirror image of the other.
    assert_eq!(branches(&outcome), ["r", "r-LP1"]);

    let doublings = "Map(states: [(\"x\", \"1 - a*x^2 + y\"), (\"y\", \"0.3*x\"), (\"u\", \"1 - a*u^2 + v\"), (\"v\", \"0.3*u\")],
         parameters: [(\"a\", 0.1)], initial: [(\"x\", 0.6), (\"y\", 0.2), (\"u\", 0.6), (\"v\", 0.2)])";
    let outcome = followed(doublings, "a,0,1.2", 0);
    check(&found(&outcome.document.branches[0]), &[(Kind::PD, 0.3675, 2)], 1e-9);

    let model = format!(
        "Equations(states: {PAIRS}, solution: equilibrium, parameters: [(\"p\", -1), (\"q\", 0), (\"w\", 1)])"
    );
    let outcome = followed(&model, "p,-1,1", 0);
    let rest = &outcome.document.branches[0];
    check(&found(rest), &[(Kind::HB, 0.0, 2)], 1e-9);
    assert!((number(&rest.special[1], "hopf_frequency") - 1.0).abs() < 1e-9);
}

/// Branches that come near each other and turn away: the Oregonator has a positive equilibrium for
/// all f, at a distance of 2√(2q) from a negative one at f = 1.
#[test]
fn no_step_crosses_to_a_branch_nearby() {
    for q in [2e-4_f64, 8e-5, 2e-5, 8e-7] {
        let model = format!(
            "Equations(states: [(\"x\", \"(x*(1 - x) - f*z*(x - {q})/(x + {q}))/0.01\"), (\"z\", \"x - z\")], solution: equilibrium,
             parameters: [(\"f\", 0.2)], initial: [(\"x\", 0.8), (\"z\", 0.8)])"
        );
        let outcome = followed(&model, "f,0.2,3", 0);
        let branch = &outcome.document.branches[0];
        let kinds: Vec<Kind> = found(branch).iter().map(|it| it.0).collect();
        assert_eq!(kinds, [Kind::HB, Kind::HB], "{q}");
        let b = 1.0 - q - 3.0;
        let positive = 0.5 * (b + (b * b + 16.0 * q).sqrt());
        let last = branch.special.last().unwrap().state[0];
        assert!((last - positive).abs() < 1e-9, "{q}: {last}");
    }
}

/// A steep S within one step.
#[test]
fn folds_within_a_step_are_seen() {
    for k in [200.0_f64, 500.0, 1000.0] {
        let model = format!(
            "Equations(states: [(\"x\", \"x/{k} - 2*x/(1 + x^2) - p\")], solution: equilibrium,
             parameters: [(\"p\", -3)], initial: [(\"x\", {})])",
            -3.0 * k
        );
        let outcome = followed(&model, "p,-3,3", 0);
        // 2k (1 − x²) = (1 + x²)² with y = 1 + x²: y² + 2k y − 4k = 0.
        let y = -k + (k * k + 4.0 * k).sqrt();
        let x = (y - 1.0_f64).sqrt();
        let p = 2.0 * x / y - x / k;
        check(&found(&outcome.document.branches[0]), &[(Kind::LP, p, 1), (Kind::LP, -p, 1)], 1e-11);
    }
}

/// Cycles of a map that shrink onto a period doubling end there: x² = p (1 − p).
#[test]
fn doubled_cycles_end_where_they_shrink_onto_a_doubling() {
    let model = "Map(states: [(\"x\", \"-(1 + p*(1 - p))*x + x^3\")], parameters: [(\"p\", -0.5)], initial: [(\"x\", 0)])";
    let outcome = followed(model, "p,-0.5,1.5", 1);
    assert_eq!(branches(&outcome), ["r", "r-PD1"]);
    let doubled = &outcome.document.branches[1];
    check(&found(doubled), &[(Kind::PD, 1.0, 1)], 1e-12);
    assert!(doubled.points.len() < 100);
    let end = "the event `period doubling of the orbit of half the period` ends the branch";
    assert_eq!(doubled.ends[1].to_string(), end);
}

/// Fixed points of Hénon's map go to infinity as a → 0, and the cycles of a linear oscillator as
/// they are.
#[test]
fn branches_that_go_to_infinity_end() {
    let henon = "Map(states: [(\"x\", \"1 - a*x^2 + y\"), (\"y\", \"0.3*x\")], parameters: [(\"a\", 0.1)], initial: [(\"x\", 0.8), (\"y\", 0.2)])";
    let outcome = followed(henon, "a,-1,2", 0);
    let branch = &outcome.document.branches[0];
    let end = branch.ends.iter().find(|end| matches!(end, End::Infinite { .. }));
    assert!(
        end.unwrap().to_string().contains("the branch goes to infinity: x grows from"),
        "{end:?}"
    );
    assert!(branch.points.len() < 500, "{}", branch.points.len());

    let centre = "Equations(states: [(\"x\", \"p*x - y\"), (\"y\", \"x + p*y\")], solution: equilibrium, parameters: [(\"p\", -1)])";
    let outcome = followed(centre, "p,-1,1", 1);
    let cycles = &outcome.document.branches[1];
    assert!(matches!(cycles.ends[1], End::Infinite { .. }), "{:?}", cycles.ends);
}

/// A trivial branch and both halves of a pitchfork, which differ in `x` by 1e-3, have a Hopf point each
/// at the same parameter: each has its family, whatever the units of the parameter.
#[test]
fn points_of_different_branches_are_told_apart_in_any_units_of_the_parameter() {
    for scale in [1.0, 1e6, 1e10] {
        let (low, growth) = (-0.5 * scale, format!("(p/{scale} - 0.5)"));
        let model = format!(
            "Equations(states: [(\"x\", \"p/{scale}*x - 1e6*x^3\"), (\"y\", \"{growth}*y - w - y*(y^2 + w^2)\"),
             (\"w\", \"{growth}*w + y - w*(y^2 + w^2)\")], solution: equilibrium, parameters: [(\"p\", {low})], initial: [(\"x\", 0)])"
        );
        let outcome = followed(&model, &format!("p,{low},{scale}"), 2);
        assert_eq!(
            branches(&outcome),
            ["r", "r-BP", "r-HB", "r-BP-HB1", "r-BP-HB2"],
            "in units of {scale}"
        );
    }
}

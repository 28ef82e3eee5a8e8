//! Promise: cycles without events shrink onto their equilibrium at its Hopf point, whatever the sizes of
//! the states are.

use super::observed::scene;
use tangency::core::system::Kind;
use tangency::scene::{Scene, execute};

/// A one-mode hybrid system whose cycles shrink onto the origin at p = 0, with velocities in another
/// unit.
fn shrinking(unit: &str, scales: &str) -> Scene {
    scene(&format!(
        "HybridEquations(
            modes: [(name: \"m\", states: [
                (\"x\", \"v/U\"), (\"v\", \"U*(2*p*v/U - x - 0.1*(v/U)^3 - 0.05*x^2)\"),
            ])],
            guards: [(name: \"far\", modes: [\"m\"], function: \"50 - x\", reset: [(\"v\", \"-v\")])],
            parameters: [(\"p\", 0.2), (\"U\", {unit})], initial: [(\"x\", 1)], {scales}
        )"
    ))
}

#[test]
fn cycles_without_events_shrink_onto_their_equilibrium_in_all_units() {
    for (unit, scales) in
        [("1", ""), ("100", ""), ("100", "scales: [(\"v\", 100)]"), ("1e6", ""), ("1e-3", "")]
    {
        let mut scene = shrinking(unit, scales);
        scene.set("p", "0.2").unwrap();
        scene.runs[0].along[0].low = Some(-0.05);
        let outcome = execute(&scene, None, &mut ());
        assert!(outcome.error.is_none(), "{unit}: {:?}", outcome.error);
        let branch = &outcome.document.branches[0];
        let kinds: Vec<Kind> = branch.special.iter().map(|point| point.kind).collect();
        let hopf: Vec<_> = branch.of_kind(Kind::HB).collect();
        assert_eq!((hopf.len(), branch.special.len()), (1, 2), "{unit} {scales}: {kinds:?}");
        let p = hopf[0].value(branch.column("p").unwrap()).unwrap();
        assert!(p.abs() < 1e-8 && p.abs() <= 3.0 * hopf[0].error, "{unit} {scales}: {p:e}");
    }
}

/// A relief valve (state of the spool, its velocity, and the pressure): cycles without impacts exist
/// between the Hopf point and the grazing. SciPy: eigenvalues, and an integrated orbit that touches
/// the seat.
#[test]
fn a_valve_has_its_hopf_point_and_its_grazing() {
    let text = "HybridEquations(
        modes: [(name: \"open\", states: [
            (\"x\", \"v\"), (\"v\", \"-k*v - (x + del) + pr\"), (\"pr\", \"be*(p - x*sqrt(abs(pr)))\"),
        ])],
        guards: [(name: \"seat\", modes: [\"open\"], function: \"x\", reset: [(\"v\", \"-0.8*v\")])],
        parameters: [(\"p\", 8), (\"k\", 1.25), (\"del\", 10), (\"be\", 20)],
        initial: [(\"x\", 2.5), (\"pr\", 12)],
    )";
    let mut scene = scene(text);
    (scene.runs[0].along[0].low, scene.runs[0].along[0].high) = (Some(7.0), Some(9.5));
    let outcome = execute(&scene, None, &mut ());
    assert!(outcome.error.is_none(), "{:?}", outcome.error);
    let branch = &outcome.document.branches[0];
    let p = branch.column("p").unwrap();
    for (kind, exact, near) in
        [(Kind::HB, 8.49111763518334, 1e-8), (Kind::G, 7.55721097187721, 1e-9)]
    {
        let found: Vec<f64> = branch.of_kind(kind).filter_map(|point| point.value(p)).collect();
        assert!(found.len() == 1 && (found[0] - exact).abs() < near, "{kind}: {found:?}");
    }
    assert_eq!(branch.special.len(), 2);
}

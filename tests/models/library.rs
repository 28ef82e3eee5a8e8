//! The scenes of the library: the points that they find are those of the literature, of exact
//! formulas, or of programs that share no code with this one (`docs/reference/language.md`).

use crate::common::close;
use std::f64::consts::PI;
use std::path::Path;
use tangency::core::continuation::{Branch, End, Point};
use tangency::core::system::Kind;
use tangency::output::Document;
use tangency::scene::{BUILT_IN, Catalogue, Files, Scene, Start, StartPoint, Way, execute};

pub(super) fn scene(name: &str) -> Scene {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("scenes/library");
    let text = std::fs::read_to_string(folder.join(format!("{name}.ron"))).unwrap();
    Catalogue::built_in()
        .parse_in(Files::of(&folder), &text)
        .unwrap_or_else(|error| panic!("{name}: {error}"))
}

fn traced(name: &str) -> Document {
    executed(&scene(name))
}

pub(super) fn executed(scene: &Scene) -> Document {
    let outcome = execute(scene, None, &mut ());
    assert!(outcome.error.is_none(), "{}: {:?}", scene.title, outcome.error);
    outcome.document
}

/// The values of a column at the special points of a kind.
pub(super) fn values(document: &Document, branch: &str, kind: Kind, column: &str) -> Vec<f64> {
    let branch: &Branch = document.branch(branch).unwrap_or_else(|error| panic!("{error}"));
    let column = branch.column(column).expect("a column");
    branch.of_kind(kind).map(|point| point.value(column).expect("a value")).collect()
}

/// Each of some values is that of a special point.
pub(super) fn finds(
    document: &Document,
    (branch, kind, column): (&str, Kind, &str),
    expected: &[f64],
    tolerance: f64,
) {
    let found = values(document, branch, kind, column);
    for expected in expected {
        let is = |value: &f64| (value - expected).abs() <= tolerance;
        assert!(found.iter().any(is), "{branch}, {kind}: {expected} is not among {found:?}");
    }
}

#[test]
fn lorenz() {
    let document = traced("lorenz");
    finds(&document, ("rest", Kind::BP, "rho"), &[1.0], 1e-10);
    let hopf = values(&document, "convection", Kind::HB, "rho");
    assert!(hopf.len() == 2 && hopf.iter().all(|rho| (rho - 470.0 / 19.0).abs() < 1e-9));
    // The homoclinic orbit, by bisection on the unstable manifold of rest.
    finds(&document, ("cycles", Kind::HOM, "rho"), &[13.926557407519], 3e-11);
}

#[test]
fn brusselator() {
    let document = traced("brusselator");
    finds(&document, ("equilibria", Kind::HB, "b"), &[2.0], 1e-10);
    finds(&document, ("Hopf points", Kind::EP, "a"), &[3.0_f64.sqrt()], 1e-9);
    finds(&document, ("Hopf points", Kind::EP, "b"), &[1.04], 1e-9);
}

#[test]
fn neurons() {
    let document = traced("fitzhugh-nagumo");
    // v = −√(1 − bε), I = v³/3 − v + (v + a)/b; mirrored at a/b.
    finds(&document, ("rest", Kind::HB, "I"), &[0.3653081540991872, 1.3846918459008128], 1e-9);
    let folds = values(&document, "firing", Kind::LP, "I");
    close(folds[0], 0.352757535534, 1e-8);
    close(folds[0] + folds[1], 1.75, 1e-8);
    let document = traced("morris-lecar");
    finds(&document, ("rest", Kind::LP, "I"), &[39.96315309274, -9.94903932262], 1e-7);
    finds(&document, ("rest", Kind::HB, "I"), &[97.78788896402], 1e-7);
    finds(&document, ("firing", Kind::LP, "I"), &[116.10953717], 1e-6);
}

#[test]
fn co_oxidation() {
    let document = traced("co-oxidation");
    finds(&document, ("equilibria", Kind::HB, "q2"), &[1.05155746246, 1.04099156953], 1e-9);
    finds(&document, ("equilibria", Kind::LP, "q2"), &[1.0420485053785, 1.0522002878700], 1e-10);
    finds(&document, ("folds", Kind::CP, "q2"), &[1.0064083296783], 1e-9);
    finds(&document, ("folds", Kind::BT, "q2"), &[1.4176276376, 1.16119870882], 1e-9);
}

#[test]
fn lure() {
    let document = traced("lure");
    finds(&document, ("equilibria", Kind::HB, "alpha"), &[1.0], 1e-10);
    finds(&document, ("cycles", Kind::PD, "alpha"), &[0.630302006160], 1e-8);
    finds(&document, ("doubled", Kind::PD, "alpha"), &[0.57962984], 2e-8);
}

#[test]
fn duffing() {
    let document = traced("duffing");
    let folds = [2.4502477378279, 4.722250750188, 0.7211685010243, 0.7480639165895];
    finds(&document, ("symmetric", Kind::LP, "omega"), &folds, 1e-8);
    finds(&document, ("symmetric", Kind::BP, "omega"), &[1.2581357506006, 0.9379135157225], 1e-8);
    // The period of a forced orbit grows as the forcing says: that is no homoclinic orbit.
    let mut wide = scene("duffing");
    wide.runs.truncate(1);
    wide.runs[0].along[0].low = Some(0.3);
    let outcome = execute(&wide, None, &mut ());
    let ends = &outcome.document.branches[0].ends;
    assert!(
        !ends.iter().any(|end| matches!(end, End::LongPeriod { .. } | End::Homoclinic { .. })),
        "{ends:?}"
    );
}

/// The kinds and places of the special points of a branch that lie on no end of it.
fn places(branch: &Branch, column: usize) -> Vec<(Kind, f64)> {
    let inside = branch.special.iter().filter(|it| it.kind != Kind::EP);
    let mut places: Vec<(Kind, f64)> = inside
        .map(|it| {
            assert!(it.converged, "{it:?}");
            (it.kind, it.value(column).unwrap())
        })
        .collect();
    places.sort_by(|a, b| a.1.total_cmp(&b.1));
    places
}

/// Orbits of a symmetric system on meshes without its symmetry: a branch goes over to no other one
/// where both cross, wherever it starts.
#[test]
fn orbits_stay_on_their_branch() {
    let mut duffing = scene("duffing");
    duffing.runs.truncate(1);
    let branch = executed(&duffing).branches[0].clone();
    let omega = branch.column("omega").unwrap();
    let all = places(&branch, omega);
    assert_eq!(all.len(), 6, "{all:?}");
    for special in &branch.special {
        let start = StartPoint::new(branch.clone(), special.label);
        let outcome = execute(&duffing, Some(&start), &mut ());
        let again = places(&outcome.document.branches[0], omega);
        // A branch does not list the branch point that it starts from.
        let is_start = |it: &&(Kind, f64)| {
            it.0 == Kind::BP && (it.1 - special.value(omega).unwrap()).abs() < 1e-9
        };
        let expected: Vec<_> = all.iter().filter(|it| !is_start(it)).collect();
        assert_eq!(again.len(), expected.len(), "from {}: {again:?}", special.label);
        for (a, b) in again.iter().zip(expected) {
            assert!(a.0 == b.0 && (a.1 - b.1).abs() < 1e-8, "from {}: {again:?}", special.label);
        }
    }
    let mut relay = scene("bang-bang");
    relay.set("method", "collocation").unwrap();
    let asymmetric = relay.runs.iter().position(|run| run.name == "asymmetric").unwrap();
    relay.runs.truncate(asymmetric + 1);
    let branch = executed(&relay).branches[asymmetric].clone();
    assert!(matches!(branch.ends[1], End::Closed { .. }), "{:?}", branch.ends);
    let values = values(&Document::new("t", vec![branch]), "asymmetric", Kind::BP, "omega");
    assert!(values.len() == 1 && (values[0] - 0.8543992737).abs() < 1e-9, "{values:?}");
}

#[test]
fn bouncing_ball() {
    let document = traced("bouncing-ball");
    let e = 0.8;
    let fold = |e: f64| PI * (1.0 - e) / (1.0 + e);
    let doubling = |e: f64| fold(e).hypot(2.0 * (1.0 + e * e) / (1.0 + e).powi(2));
    finds(&document, ("one impact", Kind::LP, "amplitude"), &[fold(e)], 1e-9);
    finds(&document, ("one impact", Kind::PD, "amplitude"), &[doubling(e)], 1e-9);
    finds(&document, ("doubled", Kind::PD, "amplitude"), &[1.2217797], 1e-7);
    finds(&document, ("folds", Kind::EP, "amplitude"), &[fold(0.4)], 1e-8);
    finds(&document, ("doublings", Kind::EP, "amplitude"), &[doubling(0.4)], 1e-8);
}

/// The sliding bifurcation at which a branch ends, by its name and place.
fn slides(document: &Document, branch: &str, kind: &str, (column, value): (&str, f64)) {
    let branch = document.branch(branch).unwrap();
    let column = branch.column(column).unwrap();
    let named = branch.of_kind(Kind::G).filter(|point| point.subkind.as_deref() == Some(kind));
    let places: Vec<f64> = named.filter_map(|point| point.value(column)).collect();
    assert!(places.iter().any(|place| (place - value).abs() < 1e-9), "{kind}: {places:?}");
}

/// What `tests/hybrid/sliding.rs` compares with simulations.
#[test]
fn relay() {
    let document = traced("relay");
    slides(&document, "crosses", "crossing-sliding", ("omega", 1.70597864781));
    finds(&document, ("slides", Kind::LP, "omega"), &[3.55743201056], 1e-9);
    let curve = document.branch("crossing-sliding").unwrap();
    let margin = curve.column("decision").unwrap();
    assert!(curve.points.len() > 10);
    assert!(curve.points.iter().all(|point| point.value(margin).unwrap().abs() < 1e-9));
}

#[test]
fn belt() {
    let document = traced("belt");
    slides(&document, "slips", "grazing-sliding", ("nu", 3.20856896212));
    slides(&document, "sticks", "switching-sliding", ("nu", 2.71383664883));
    slides(&document, "sticks, overtakes", "crossing-sliding", ("nu", 1.69152176791));
    slides(&document, "overtakes", "crossing-sliding", ("nu", 0.565759557378));
    slides(&document, "sticks after", "crossing-sliding", ("nu", 0.493012572348));
    slides(&document, "sticks, slow", "adding-sliding", ("nu", 0.426633559729));
    slides(&document, "sticks, slow", "grazing-sliding", ("nu", 0.26451960581));
    let itinerary = |name: &str| document.branch(name).unwrap().itinerary.clone();
    assert_eq!(itinerary("sticks, overtakes"), "stick:slower slower:belt faster:belt");
    assert_eq!(itinerary("overtakes"), "slower:belt faster:belt");
    assert_eq!(itinerary("sticks twice"), "stick:slower slower:belt stick:slower slower:belt");
    for name in ["grazing-sliding", "switching-sliding", "crossing-sliding", "adding-sliding"] {
        let curve = document.branch(name).unwrap();
        assert!(curve.points.len() > 10 && curve.condition == Some(Kind::G), "{name}");
    }
}

#[test]
fn chua_sliding() {
    let document = traced("chua-sliding");
    slides(&document, "free", "grazing-sliding", ("alpha", 6.93362519782));
    assert_eq!(document.branch("clamped").unwrap().itinerary, "clamped:free free:clamp");
}

fn dry() -> Scene {
    let built_in = BUILT_IN.iter().find(|scene| scene.name == "dry-friction").unwrap();
    Scene::parse(built_in.text).unwrap()
}

/// The friction at which motion without stops ends: `|V|/√(H² + 1/ω⁴)`.
fn end_without_stops(omega: f64) -> f64 {
    let v = 1.0 / (1.0 - omega * omega);
    let h = (PI / omega).sin() / (omega * (1.0 + (PI / omega).cos()));
    v.abs() / h.hypot(omega.powi(-2))
}

/// Den Hartog: the functions of `next` are decisions, whose zeros end motion without stops; with
/// two begins there.
#[test]
fn dry_friction() {
    let outcome = execute(&dry(), None, &mut ());
    assert!(outcome.error.is_none(), "{:?}", outcome.error);
    let document = outcome.document;
    let end = end_without_stops(0.6);
    close(end, 0.531512540169, 1e-11);
    finds(&document, ("no stops", Kind::G, "F"), &[end], 1e-10);
    finds(&document, ("no stops", Kind::G, "decision"), &[0.0], 1e-12);
    finds(&document, ("no stops", Kind::UZ, "max_x"), &[1.55060285469], 1e-10);
    finds(&document, ("no stops", Kind::EP, "max_x"), &[1.5625], 1e-9);
    finds(&document, ("two stops", Kind::EP, "F"), &[end, 0.98], 1e-10);
    let boundary = document.branch("boundary").unwrap();
    for point in &boundary.points {
        let [omega, friction] = point.parameters[..] else { panic!("two parameters") };
        // Ordinary points of a curve: Newton's iteration may end a step early on its way to 1e-10.
        close(friction, end_without_stops(omega), 5e-9);
    }
    assert_eq!(document.branch("no stops").unwrap().itinerary, "down:stop up:stop");
    let stops = document.branch("two stops").unwrap();
    assert_eq!(stops.itinerary, "down:stop stick:slip up:stop stick:slip");
    assert!(stops.points.iter().all(|point| point.admissible && point.unstable == Some(0)));
}

/// Where legs vanish, at a grazing, the branch goes on without them: in orbits of another
/// itinerary.
#[test]
fn legs_that_vanish_are_left_out() {
    let mut scene = dry();
    scene.runs.truncate(2);
    let [first, second] = &mut scene.runs[..] else { panic!("two runs") };
    first.set = vec![("F".into(), "0.75".into())];
    first.along[0].high = Some(0.9);
    second.start = Start::From {
        run: first.name.clone(),
        kind: Kind::G,
        nth: 0,
        switch: true,
        which: 0,
        unconverged: false,
    };
    second.marks = vec![("F".into(), 0.2)];
    let outcome = execute(&scene, None, &mut ());
    assert!(outcome.error.is_none(), "{:?}", outcome.error);
    let [first, second] = &outcome.document.branches[..] else { panic!("two branches") };
    assert_eq!(first.itinerary.matches("stick:slip").count(), 2);
    assert!(!second.itinerary.contains("stick") && second.points.iter().all(|p| p.admissible));
    let mark = second.of_kind(Kind::UZ).next().unwrap();
    close(mark.value(second.column("max_x").unwrap()).unwrap(), 1.55060285469, 1e-10);
}

/// Beyond the decision orbits are virtual: they are followed on demand, and marked.
#[test]
fn what_decides_otherwise_is_marked() {
    let mut scene = dry();
    scene.runs.truncate(1);
    let [run] = &mut scene.runs[..] else { panic!("one run") };
    (run.direction, run.beyond_grazings) = (Way::Forward, true);
    run.along[0].high = Some(0.6);
    let outcome = execute(&scene, None, &mut ());
    let branch = &outcome.document.branches[0];
    let beyond = |point: &Point| point.parameters[1] > end_without_stops(0.6) + 1e-9;
    assert!(branch.points.iter().any(beyond) && branch.points.iter().any(|point| !beyond(point)));
    for point in &branch.points {
        assert_eq!(point.admissible, !beyond(point), "{:?}", point.parameters);
    }
}

#[test]
fn swift_hohenberg() {
    let document = traced("swift-hohenberg");
    let flat = [7.065755275957e-5, 0.05726746940757, 0.06359101185589];
    finds(&document, ("flat", Kind::BP, "r"), &flat, 1e-10);
    finds(&document, ("periodic, peak at the centre", Kind::LP, "r"), &[-0.243809162503], 1e-9);
    let odd = [-0.210122206899, -0.184723080512, -0.213092391745, -0.197508609592];
    finds(&document, ("odd", Kind::LP, "r"), &odd, 1e-9);
    let even = [
        -0.216931307844,
        -0.217467801379,
        -0.187784703799,
        -0.212013344771,
        -0.182964752789,
        -0.200824596434,
    ];
    finds(&document, ("even", Kind::LP, "r"), &even, 1e-9);
}

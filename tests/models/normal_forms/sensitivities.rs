//! Promise: the derivatives of the location of a special point by other parameters are those of
//! located points, and spreads are what tracing at the corners of tolerances gives.

use super::{model, range, set, traced};
use crate::models::library::{executed, scene};
use tangency::core::continuation::{Branch, SpecialPoint};
use tangency::output::Document;
use tangency::scene::{Request, Scene};

/// A scene at other values of its parameters.
fn with(scene: &Scene, values: &[(String, String)]) -> Document {
    let request = Request { set: values.to_vec(), ..Request::default() };
    executed(&scene.clone().requested(&request).unwrap())
}

/// The derivative of a location by central differences of fourth order.
fn difference(of: impl Fn(f64) -> Option<f64>, value: f64, step: f64) -> Option<f64> {
    let [a, b, c, d] = [-2.0, -1.0, 1.0, 2.0].map(|k: f64| of(value + k * step));
    Some((a? - 8.0 * b? + 8.0 * c? - d?) / (12.0 * step))
}

/// The same special point of another trace: of the same kind, and nearest to it.
fn same<'b>(branch: &'b Branch, point: &SpecialPoint, released: usize) -> Option<&'b SpecialPoint> {
    let distance =
        |other: &&SpecialPoint| (other.parameters[released] - point.parameters[released]).abs();
    branch.of_kind(point.kind).min_by(|a, b| distance(a).total_cmp(&distance(b)))
}

/// Checks all sensitivities of all special points of a scene by these parameters; how many.
fn check(scene: &Scene, parameters: &[&str], kinds: &[&str], relative: f64) -> usize {
    let document = with(scene, &[]);
    let mut count = 0;
    for name in parameters {
        let branch = &document.branches[0];
        let value = branch.special[0].value(branch.column(name).unwrap()).unwrap();
        let step = 1e-4 * value.abs().max(1e-3);
        let documents: Vec<(f64, Document)> = [-2.0, -1.0, 1.0, 2.0]
            .map(|k: f64| {
                let at = value + k * step;
                (at, with(scene, &[(name.to_string(), format!("{at:e}"))]))
            })
            .into();
        for branch in &document.branches {
            let released = branch.column(&branch.released[0]).unwrap();
            let of_kinds = |point: &&SpecialPoint| kinds.contains(&point.kind.letters());
            for point in branch.special.iter().filter(of_kinds).filter(|point| point.converged) {
                let Some(own) = point.sensitivities.iter().find(|own| own.by == *name) else {
                    continue;
                };
                let location = |at: f64| {
                    let (_, document) =
                        documents.iter().find(|(value, _)| (value - at).abs() < 0.1 * step)?;
                    let branch = document.branches.iter().find(|it| it.name == branch.name)?;
                    Some(same(branch, point, released)?.parameters[released])
                };
                let found = difference(location, value, step).unwrap();
                let size =
                    own.slopes[0].abs().max(1e-9 * (point.parameters[released] / value).abs());
                assert!(
                    (found - own.slopes[0]).abs() <= relative * size + 4.0 * point.error / step,
                    "{} {}: d{}/d{name} = {:e}, differences give {found:e}",
                    branch.name,
                    point.kind,
                    branch.released[0],
                    own.slopes[0]
                );
                count += 1;
            }
        }
    }
    count
}

#[test]
fn of_equilibria() {
    let along = vec![range("q2", 0.5, 2.0)];
    let request = Request { along, ..Request::default() };
    let oxidation = Scene::of_model(model("co-oxidation"), "oxidation", &request).unwrap();
    let parameters = ["q1", "q3", "q4", "q5", "q6", "k"];
    assert_eq!(check(&oxidation, &parameters, &["LP", "HB"], 1e-6), 24);
}

#[test]
fn of_cycles_and_hybrid_orbits() {
    let text = include_str!("../../../scenes/lure.ron");
    let lure = Scene::parse(text).unwrap();
    assert!(check(&lure, &["beta"], &["HB", "PD"], 1e-6) == 4);
    let impacts = Scene::parse(include_str!("../../../scenes/impact-oscillator.ron")).unwrap();
    assert!(check(&impacts, &["frequency"], &["LP", "PD", "G"], 1e-6) >= 1);
}

/// Pull-in of a plate in SI units: the voltage by gap, thickness and modulus. Switching on of the
/// actuator: the voltage of its grazing and fold by the damping.
#[test]
fn of_the_devices() {
    let plate = Scene::parse(include_str!("../../../scenes/plate-device.ron")).unwrap();
    assert_eq!(check(&plate, &["gap", "thickness", "young"], &["LP"], 1e-6), 3);
    let mita = Scene::parse(include_str!("../../../scenes/mita-type-1.ron")).unwrap();
    assert!(check(&mita, &["frequency", "damping", "clearance"], &["LP", "G", "PD"], 1e-6) >= 9);
}

/// A branch point that a parameter breaks up has no sensitivity by it.
#[test]
fn of_branch_points_that_persist_only() {
    let request = Request { along: vec![range("m", 0.5, 1.5)], ..Request::default() };
    let document = traced(model("predator-prey"), &request);
    assert!(document.branches[0].special.iter().all(|point| point.sensitivities.is_empty()));
    let lorenz = executed(&scene("lorenz"));
    let rest = &lorenz.branches[0];
    let pitchfork = rest.special.iter().find(|point| point.kind.letters() == "BP").unwrap();
    let names: Vec<&str> = pitchfork.sensitivities.iter().map(|own| own.by.as_str()).collect();
    assert_eq!(names, ["sigma", "beta"]);
    assert!(pitchfork.sensitivities.iter().all(|own| own.slopes[0].abs() < 1e-12));
}

/// Tolerances of gap and thickness of an oxidation model's constants: the spread is the largest
/// change at the corners, to first order.
#[test]
fn spreads_are_those_at_the_corners() {
    let request = Request {
        along: vec![range("q2", 0.5, 2.0)],
        set: set("tolerances=[(\"k\",1e-5),(\"q3\",1e-4)]"),
        ..Request::default()
    };
    let scene = Scene::of_model(model("co-oxidation"), "oxidation", &request).unwrap();
    let document = executed(&scene);
    let branch = &document.branches[0];
    let released = branch.column("q2").unwrap();
    for point in branch.special.iter().filter(|point| ["LP", "HB"].contains(&point.kind.letters()))
    {
        let spread = point.number("spread_q2").unwrap().value;
        let mut most = 0.0_f64;
        for (k, q3) in [(1.0, 1.0), (1.0, -1.0), (-1.0, 1.0), (-1.0, -1.0)] {
            let k = format!("{:e}", 0.4 + 1e-5 * k);
            let q3 = format!("{:e}", 10.0 + 1e-4 * q3);
            let corner = with(&scene, &[("k".into(), k), ("q3".into(), q3)]);
            let there = same(&corner.branches[0], point, released).unwrap();
            most = most.max((there.parameters[released] - point.parameters[released]).abs());
        }
        assert!((spread - most).abs() < 1e-3 * spread, "{}: {spread} {most}", point.kind);
    }
}

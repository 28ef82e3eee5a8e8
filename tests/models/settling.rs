//! What branches say of orbits with impacts is what simulations do: motion that is disturbed a
//! little comes back to an orbit exactly where the orbit is called admissible and stable.

use super::library::{executed, scene};
use crate::common::settling::settling;
use tangency::core::continuation::Branch;
use tangency::core::hybrid::HybridEquations;
use tangency::language::Model;
use tangency::scene::{Run, Scene};

/// Marks on a run, at 20 values of the parameter that varies along its branch.
fn mark(run: &mut Run, branch: &Branch) {
    let name = &run.along[0].name;
    let column = branch.column(name).unwrap();
    let values = || branch.points.iter().filter_map(|point| point.value(column));
    let (low, high) = (values().fold(f64::MAX, f64::min), values().fold(f64::MIN, f64::max));
    let value = |k: usize| low + (high - low) * (k as f64 + 0.513) / 20.0;
    run.marks = (0..20).map(|k| (name.clone(), value(k))).collect();
}

/// Simulations and branches agree at all marks of all branches of a scene in one parameter. How
/// many orbits attract, how many are unstable, and how many virtual.
fn agree(mut scene: Scene) -> [usize; 3] {
    scene.runs.retain(|run| run.along.len() == 1);
    let document = executed(&scene);
    scene.runs.iter_mut().zip(&document.branches).for_each(|(run, branch)| mark(run, branch));
    let document = executed(&scene);
    let system: &dyn HybridEquations = match scene.problem.text() {
        Some(Model::Hybrid(system)) => &**system,
        Some(Model::Filippov(system)) => &**system,
        _ => panic!("{}: no hybrid system", scene.title),
    };
    let mut counts = [0; 4];
    for branch in &document.branches {
        let of_branch = settling(system, branch);
        counts.iter_mut().zip(of_branch).for_each(|(count, more)| *count += more);
    }
    let [stable, unstable, beyond, slow] = counts;
    assert!(slow <= 1, "{}: {slow} orbits are neither stable nor unstable", scene.title);
    [stable, unstable, beyond]
}

#[test]
fn simulations_settle_where_orbits_are_stable() {
    for name in [
        "bang-bang",
        "bouncing-ball",
        "buck-converter",
        "integrate-and-fire",
        "rocking-block",
        "simplest-walker",
        "soft-stop",
        "stick-slip",
        "two-walls",
    ] {
        let [stable, unstable, _] = agree(scene(name));
        assert!(stable >= 8 && unstable >= 4, "{name}: {stable} stable, {unstable} unstable");
    }
}

/// Orbits that slide, and those between which they begin to.
#[test]
fn simulations_settle_on_orbits_that_slide() {
    for name in ["belt", "chua-sliding", "relay"] {
        let [stable, unstable, _] = agree(scene(name));
        assert!(stable >= 20, "{name}: {stable} stable, {unstable} unstable");
    }
    let text = include_str!("../../scenes/dry-friction.ron");
    let [stable, ..] = agree(Scene::parse(text).unwrap());
    assert!(stable >= 20, "{stable}");
}

/// Beyond grazings orbits are virtual: motion does not follow them.
#[test]
fn nothing_settles_on_virtual_orbits() {
    for name in ["integrate-and-fire", "soft-stop", "stick-slip", "two-walls"] {
        let mut scene = scene(name);
        scene.runs.truncate(1);
        scene.runs[0].beyond_grazings = true;
        scene.set("max_points", "600").unwrap();
        let [.., beyond] = agree(scene);
        assert!(beyond > 0, "{name}");
    }
}

//! Equations that are given as text.

mod border_collisions;
mod bounds;
mod conservative;
mod curves;
mod cycle_findings;
mod errors;
mod fuzz;
mod homoclinic;
mod hybrid_ends;
mod hybrid_equilibria;
mod hybrid_findings;
mod hybrid_invariance;
mod hybrid_jumps;
mod implicit;
mod language;
mod lasting_sliding;
mod library;
mod library_of_impacts;
mod mesh_findings;
mod normal_forms;
mod ode;
mod phase_planes;
mod planes;
mod product_modes;
mod restated;
mod settling;
mod shrinking_curves;
mod singular_points;
mod sliding_curves;
mod small_states;
mod starts;
mod timed_events;
mod units;

use tangency::core::continuation::Branch;
use tangency::scene::{Scene, execute};

/// A scene that must be readable.
fn scene(text: &str) -> Scene {
    Scene::parse(text).unwrap_or_else(|error| panic!("{error}"))
}

/// The branches of a scene that must be traced without an error.
fn traced(text: &str) -> Vec<Branch> {
    branches(&scene(text))
}

/// The branches that must be traced without an error.
fn branches(scene: &Scene) -> Vec<Branch> {
    let outcome = execute(scene, None, &mut ());
    assert!(outcome.error.is_none(), "{:?}", outcome.error);
    outcome.document.branches
}

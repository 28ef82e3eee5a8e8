//! Scenes as a user runs them, shared by tests.

use tangency::core::continuation::Kind;
use tangency::output::Document;
use tangency::scene::{BUILT_IN, Scene, execute};

/// A built-in scene as it stands.
pub fn built_in(name: &str) -> Scene {
    let scene = BUILT_IN.iter().find(|scene| scene.name == name).unwrap();
    Scene::parse(scene.text).unwrap()
}

/// A built-in scene after changes as by `--set`.
pub fn with(name: &str, changes: &[(&str, &str)]) -> Scene {
    let mut scene = built_in(name);
    for (name, value) in changes {
        scene.set(name, value).unwrap_or_else(|error| panic!("{name} = {value}: {error}"));
    }
    scene
}

/// The document of a scene that runs to its end.
pub fn traced(scene: &Scene) -> Document {
    let outcome = execute(scene, None, &mut ());
    assert_eq!(outcome.error, None);
    outcome.document
}

/// What is said of a text that is no scene.
pub fn refusal(text: &str) -> String {
    Scene::parse(text).expect_err("refused").to_string()
}

/// The special points of a kind on a branch: the values of a column, in the order of the branch.
pub fn column(document: &Document, branch: &str, kind: Kind, name: &str) -> Vec<f64> {
    let branch = document.branch(branch).unwrap();
    let column = branch.column(name).unwrap();
    branch.of_kind(kind).map(|point| point.value(column).unwrap()).collect()
}

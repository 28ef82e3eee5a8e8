//! Scenes as a user runs them, shared by tests.

use proptest::prelude::*;
use std::collections::BTreeMap;
use std::sync::{Arc, LazyLock, Mutex, OnceLock};
use tangency::core::failure::one_line;
use tangency::core::system::Kind;
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
    let values: Vec<(String, String)> =
        changes.iter().map(|(name, value)| (name.to_string(), value.to_string())).collect();
    scene.set_all(&values).unwrap_or_else(|error| panic!("{changes:?}: {error}"));
    scene
}

/// Documents of scenes, each traced by the first test that needs it.
static TRACED: LazyLock<Mutex<BTreeMap<String, Arc<OnceLock<Document>>>>> =
    LazyLock::new(Mutex::default);

/// The document of a scene that runs to its end.
pub fn traced(scene: &Scene) -> Document {
    let key = format!("{scene:?}");
    let document = Arc::clone(TRACED.lock().unwrap().entry(key).or_default());
    let trace = || {
        let outcome = execute(scene, None, &mut ());
        assert_eq!(outcome.error, None);
        outcome.document
    };
    document.get_or_init(trace).clone()
}

/// What is said of a text that is no scene.
pub fn refusal(text: &str) -> String {
    one_line(&Scene::parse(text).expect_err("refused"))
}

/// The special points of a kind on a branch: the values of a column, in the order of the branch.
pub fn column(document: &Document, branch: &str, kind: Kind, name: &str) -> Vec<f64> {
    let branch = document.branch(branch).unwrap();
    let column = branch.column(name).unwrap();
    branch.of_kind(kind).map(|point| point.value(column).unwrap()).collect()
}

/// Any text of up to 64 characters.
pub fn any_text() -> impl Strategy<Value = String> {
    proptest::collection::vec(any::<char>(), 0..64).prop_map(String::from_iter)
}

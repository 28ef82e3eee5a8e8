//! The setups that pages show first.

use super::library::Library;
use super::setup::Setup;
use crate::scene::Range;

/// The scene or the model that pages show first.
#[derive(Clone, Debug, PartialEq)]
pub struct Opened {
    /// The name of a built-in scene, or the path of a file, that was given on the command line.
    pub place: String,
    /// The text of the scene or model, and the request (the options of the command line) applied to
    /// it.
    pub setup: Setup,
}

/// Returns the setup that a page shows first: the opened scene, or an example with hysteresis if no
/// scene was opened.
pub(super) fn beginning(opened: Option<&Opened>) -> Setup {
    let simple = || Setup {
        name: "hysteresis".into(),
        text: SIMPLE.into(),
        along: vec![Range { name: "a".into(), low: Some(-1.0), high: Some(1.0) }],
        ..Setup::default()
    };
    opened.map_or_else(simple, |opened| opened.setup.clone())
}

/// Returns the setup of an example.
pub(super) fn example(library: &Library, name: &str) -> Option<Setup> {
    let scene = library.catalogue.scenes().iter().find(|scene| scene.name == name)?;
    Some(Setup { name: scene.name.clone(), text: scene.text.clone(), ..Setup::default() })
}

/// The model that pages show if no scene was opened.
const SIMPLE: &str = "# Hysteresis between two folds, at a = ±2 (b/3)^1.5. Drag b.
x' = a + b*x - x^3
par a=-1, b=1
init x=-1.3
";

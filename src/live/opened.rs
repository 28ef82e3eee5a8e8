//! The setups with which pages begin.

use super::setup::Setup;
use super::shop::Shop;
use crate::scene::Range;

/// The scene or model with which pages begin.
#[derive(Clone, Debug, PartialEq)]
pub struct Opened {
    /// The name on the command line: of a built-in scene, or a path.
    pub place: String,
    /// The text and the request.
    pub setup: Setup,
}

/// Returns the setup with which a page begins: the opened one, or a fold.
pub(super) fn beginning(opened: Option<&Opened>) -> Setup {
    let simple = || Setup {
        name: "fold".into(),
        text: SIMPLE.into(),
        along: vec![Range { name: "load".into(), low: Some(0.0), high: Some(0.3) }],
        ..Setup::default()
    };
    opened.map_or_else(simple, |opened| opened.setup.clone())
}

/// Returns the setup of an example.
pub(super) fn example(shop: &Shop, name: &str) -> Option<Setup> {
    let scene = shop.catalogue.scenes().iter().find(|scene| scene.name == name)?;
    Some(Setup { name: scene.name.clone(), text: scene.text.clone(), ..Setup::default() })
}

/// The model of pages without an opened scene.
const SIMPLE: &str = "# Parallel-plate actuator: pull-in at u = 1/3, load = 4/27.
u' = load/(1 - u)^2 - k*u
par load=0, k=1
init u=0
";

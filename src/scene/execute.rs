//! Tracing a scene with the discretisation that it states, or that its accuracy asks for.

use super::fidelity::traced_to;
use super::observer::SceneObserver;
use super::plan::StartPoint;
use super::statement::Scene;
use super::trace::{Outcome, traced};

/// Traces a scene's runs. With a start point, only one shown run is traced, from there: the one
/// named as the point's branch; else the first one that makes the same kind of curve of the same
/// unknowns; else the first one. (If it follows points of a local map, after the runs that find the
/// map's grazing.)
///
/// ```
/// use tangency::scene::{BUILT_IN, Scene, execute};
/// let scene = Scene::parse(BUILT_IN.iter().find(|s| s.name == "plate-supported").unwrap().text)?;
/// let outcome = execute(&scene, None, &mut ());
/// let plate = &outcome.document.branches[0];
/// let fold = plate.of_kind(tangency::core::system::Kind::LP).next().unwrap();
/// assert!((fold.parameters[0] / 71.252716501 - 1.0).abs() < 1e-9);
/// # Ok::<(), tangency::scene::SceneError>(())
/// ```
///
/// If the scene states an accuracy, the discretisation is chosen for it;
/// [`Document::chosen`](crate::output::Document::chosen) says which, and what its error is
/// estimated to be:
///
/// ```
/// # use tangency::scene::{BUILT_IN, Scene, execute};
/// # let text = BUILT_IN.iter().find(|s| s.name == "impact-oscillator").unwrap().text;
/// let mut scene = Scene::parse(text)?;
/// scene.set("accuracy", "1e-6")?;
/// let chosen = execute(&scene, None, &mut ()).document.chosen.unwrap();
/// assert_eq!(chosen.settings[0].0, "flow_tolerance");
/// assert!(chosen.estimate < 1e-6);
/// # Ok::<(), tangency::scene::SceneError>(())
/// ```
pub fn execute(
    scene: &Scene,
    start: Option<&StartPoint>,
    observer: &mut dyn SceneObserver,
) -> Outcome {
    match scene.accuracy {
        Some(accuracy) => traced_to(accuracy, scene, start, observer),
        None => traced(scene, start, observer),
    }
}

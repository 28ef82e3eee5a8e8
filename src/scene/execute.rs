//! Tracing of the branches of a scene, either with the discretisation that the scene states, or
//! with a discretisation that is chosen for the requested accuracy.

use super::error::SceneError;
use super::fidelity::traced_to;
use super::observer::SceneObserver;
use super::resolve::{Resolution, StartPoint};
use super::statement::Scene;
use super::trace::{Outcome, traced, traced_each};
use crate::output::Document;

impl Outcome {
    /// Returns the outcome for a scene that could not be resolved: a document without branches, and
    /// the error.
    pub(super) fn failed(scene: &Scene, cause: SceneError) -> Self {
        Outcome { document: Document::new(scene.title.clone(), Vec::new()), error: Some(cause) }
    }
}

impl Resolution {
    /// Traces the runs.
    pub fn trace(&self, observer: &mut dyn SceneObserver) -> Outcome {
        match self.scene().accuracy {
            Some(accuracy) => traced_to(accuracy, self, observer).0,
            None => traced(self, observer),
        }
    }

    /// Traces the branches of the runs, and continues with the next run if a run fails. Returns the
    /// outcome with the branches of all runs that succeeded, and the errors together with the names
    /// of the failed runs. If the scene requests an accuracy, tracing stops at the first error.
    ///
    /// ```
    /// use tangency::scene::Scene;
    /// let scene = Scene::parse("Scene(
    ///     title: \"A fold\",
    ///     problem: Equations(states: [(\"x\", \"a - x^2\")], initial: [(\"x\", 1)], solution: equilibrium),
    ///     parameters: [(\"a\", 1)],
    ///     runs: [
    ///         (name: \"rest\", along: [(name: \"a\", low: -1, high: 1)]),
    ///         (name: \"other\", start: From(run: \"rest\", kind: BP, switch: true), along: [(name: \"a\", high: 1)]),
    ///         (name: \"again\", along: [(name: \"a\", low: 0.5, high: 2)]),
    ///     ],
    /// )")?;
    /// let (outcome, failed) = scene.resolve(None)?.trace_each(&mut ());
    /// assert_eq!(outcome.document.branches.len(), 2);
    /// assert_eq!(failed[0].0, "other");
    /// # Ok::<(), tangency::scene::SceneError>(())
    /// ```
    pub fn trace_each(
        &self,
        observer: &mut dyn SceneObserver,
    ) -> (Outcome, Vec<(String, SceneError)>) {
        let Some(accuracy) = self.scene().accuracy else { return traced_each(self, observer) };
        let outcome = traced_to(accuracy, self, observer).0;
        let failed = outcome.error.iter().map(|cause| (String::new(), cause.clone())).collect();
        (outcome, failed)
    }
}

/// Resolves a scene and traces the branches of its runs; if a start point is given, traces only the
/// run that continues from this point ([`Scene::resolve`]).
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
/// If the scene requests an accuracy, a discretisation that reaches the accuracy is chosen;
/// [`Document::chosen`](crate::output::Document::chosen) contains the chosen discretisation and its
/// estimated error:
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
    match scene.resolve(start) {
        Ok(resolution) => resolution.trace(observer),
        Err(cause) => Outcome::failed(scene, cause),
    }
}

//! The description of a scene for the page: parameters, settings, and ranges of parameters.

use super::help::meaning;
use super::library::Library;
use super::setup::Setup;
use crate::core::failure::one_line;
use crate::scene::{Purpose, Range, Sampling, Scene, SceneError};
use serde::Serialize;

/// The parameters of a scene and their ranges.
#[derive(Serialize)]
pub(super) struct Description {
    title: String,
    /// Whether the text is a scene, which contains runs; false for a model, which has no runs.
    is_scene: bool,
    parameters: Vec<Parameter>,
    /// The parameters that are varied by all runs of the scene, with their ranges.
    along: Vec<Range>,
    /// The names of the states, whose values at the start can be given.
    states: Vec<String>,
    /// The ways in which a sweep can sample the motion.
    sweep: Sampled,
}

/// The ways in which a sweep can sample the motion of a scene.
#[derive(Serialize)]
struct Sampled {
    /// The events at which a motion without forcing can be sampled.
    events: Vec<String>,
    /// The reason why the motion cannot be sampled; `None` if a sweep is possible.
    why_not: Option<String>,
}

impl Sampled {
    fn of(scene: &Scene) -> Self {
        match scene.sampling() {
            Ok(Sampling { forced, events, .. }) => {
                let none = !forced && events.is_empty();
                Sampled { events, why_not: none.then(|| UNSAMPLED.into()) }
            }
            Err(cause) => Sampled { events: Vec::new(), why_not: Some(one_line(&cause)) },
        }
    }
}

/// The reason why a motion without forcing and without events cannot be sampled.
const UNSAMPLED: &str = "A sweep samples the motion once a period of the forcing or at an event; these equations have \
                         neither a forcing nor an event.";

/// A parameter of the scene, with its initial value.
#[derive(Serialize)]
struct Parameter {
    name: String,
    value: Option<f64>,
    /// The range over which the parameter is usually varied.
    low: f64,
    high: f64,
    /// The name of the run that sets the parameter; a parameter that a run sets cannot be changed
    /// on the page.
    set_by: Option<String>,
}

/// A setting of the scene, with its value and its meaning.
#[derive(Serialize)]
pub(super) struct Setting {
    name: String,
    value: String,
    meaning: &'static str,
    set_by: Option<String>,
}

/// Describes the scene of a setup; `traced` is the scene with all its runs, or `None` if the scene
/// could not be built.
pub(super) fn describe(setup: &Setup, values: &Scene, traced: Option<&Scene>) -> Description {
    let parameters = values.problem.parameters().into_iter().map(|(name, _)| {
        let value = traced.and_then(|scene| scene.value(&name)).or_else(|| values.value(&name));
        let usual = Range::usual(&*name, value.unwrap_or_default());
        let (low, high) = usual.interval().into_inner();
        let set_by = values.run_that_sets(&name).map(String::from);
        Parameter { name, value, low, high, set_by }
    });
    let runs = traced.map_or(&[][..], |scene| &scene.runs);
    // The ranges of followed curves belong to their runs.
    let own = runs.iter().filter(|run| setup.runs.iter().all(|it| it.name != run.name));
    let mut along: Vec<Range> = Vec::new();
    for range in own.flat_map(|run| &run.along) {
        if along.iter().all(|known| known.name != range.name) {
            along.push(range.clone());
        }
    }
    Description {
        title: traced.unwrap_or(values).title.clone(),
        is_scene: !values.runs.is_empty(),
        parameters: parameters.collect(),
        along,
        states: values.problem.text().map_or(Vec::new(), |model| model.states()),
        sweep: Sampled::of(values),
    }
}

/// Returns the settings that have an effect on the runs of a setup.
pub(super) fn settings(setup: &Setup, library: &Library) -> Result<Vec<Setting>, SceneError> {
    let (setup, _) = setup.suited(library)?;
    let scene = setup.scene(library, &Default::default())?;
    let changed = |name: &str| setup.set.iter().any(|(key, _)| key == name);
    let has_effect = |name: &str| {
        changed(name) || scene.check_effects([name], Purpose::Exploration, None).is_ok()
    };
    let all = scene.settings_by_name().into_iter().filter(|(name, _)| has_effect(name));
    let setting = all.map(|(name, value)| Setting {
        meaning: meaning(&name),
        set_by: scene.run_that_sets(&name).map(String::from),
        name,
        value,
    });
    Ok(setting.collect())
}

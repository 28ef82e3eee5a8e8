//! Checks of the names and texts that a scene contains.

use super::error::SceneError;
use super::statement::Scene;
use crate::output::{Invalid, entry, text};

/// Returns an error if a name or text in a scene contains control characters, or if the name of a
/// sweep is invalid as the name of an archive entry.
pub(super) fn check_words(scene: &Scene) -> Result<(), SceneError> {
    checked(scene).map_err(|invalid| SceneError::invalid(invalid.to_string()))
}

fn checked(scene: &Scene) -> Result<(), Invalid> {
    text("the title", &scene.title)?;
    scene.summary.iter().try_for_each(|summary| text("the summary", summary))?;
    scene.runs.iter().try_for_each(|run| text("the name of a run", &run.name))?;
    scene.sweeps.iter().try_for_each(|sweep| entry("the name of a sweep", &sweep.name))?;
    scene.plot.labels.iter().try_for_each(|(column, label)| {
        text("plot, the column of a label", column)?;
        text(&format!("plot, the label of `{column}`"), label)
    })
}

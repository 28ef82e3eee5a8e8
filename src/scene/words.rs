//! Checks of the names and texts that a scene contains.

use super::error::SceneError;
use super::statement::Scene;
use crate::output::{Invalid, entry, text};

impl Scene {
    /// Returns an error if a name or text contains control characters, or if the name of a sweep is
    /// invalid as the name of an archive entry.
    pub(super) fn check_words(&self) -> Result<(), SceneError> {
        self.words().map_err(|invalid| SceneError::invalid(invalid.to_string()))
    }

    fn words(&self) -> Result<(), Invalid> {
        text("the title", &self.title)?;
        self.summary.iter().try_for_each(|summary| text("the summary", summary))?;
        self.runs.iter().try_for_each(|run| text("the name of a run", &run.name))?;
        self.sweeps.iter().try_for_each(|sweep| entry("the name of a sweep", &sweep.name))?;
        let labels = self.plot.labels.iter();
        labels.into_iter().try_for_each(|(column, label)| {
            text("plot, the column of a label", column)?;
            text(&format!("plot, the label of `{column}`"), label)
        })
    }
}

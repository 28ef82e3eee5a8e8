//! The columns of branches before they are traced.

use super::error::SceneError;
use super::statement::{Run, Scene, Start};
use crate::core::bifurcation::catalogue;
use crate::core::continuation::{Branch, End};
use crate::core::orbit::GRAZINGS;
use crate::output::{Document, check_columns};

impl Scene {
    /// Refuses a picture in columns that its branches will not have: better before the work than after it. What local
    /// maps, histories and sweeps have is known only behind it.
    ///
    /// ```
    /// use tangency::scene::{BUILT_IN, Scene};
    /// let text = BUILT_IN.iter().find(|scene| scene.name == "bratu").unwrap().text;
    /// assert!(Scene::parse(text)?.check_plot().is_ok());
    /// let mut scene = Scene::parse(text)?;
    /// scene.plot.y = Some("max_v".into());
    /// scene.plot.x = Some("lamda".into());
    /// let error = scene.check_plot().unwrap_err().to_string();
    /// assert!(error.contains("unknown column `lamda`; did you mean `lambda`?"), "{error}");
    /// # Ok::<(), tangency::scene::SceneError>(())
    /// ```
    ///
    /// # Errors
    /// [`SceneError::Figure`] with the column and those that there are.
    pub fn check_plot(&self) -> Result<(), SceneError> {
        let shown = self.runs.iter().filter(|run| run.shown);
        let branches: Option<Vec<Branch>> = shown.map(|run| self.untraced(run)).collect();
        let Some(branches) = branches.filter(|all| !all.is_empty() && self.sweeps.is_empty())
        else {
            return Ok(());
        };
        let mut document = Document::new(self.title.clone(), branches);
        document.plot = self.plot.clone();
        Ok(check_columns(&document)?)
    }

    /// The branch of a run without its points, with all columns that it may have; `None` where they are not known.
    fn untraced(&self, run: &Run) -> Option<Branch> {
        if run.local.is_some() || run.along.is_empty() {
            return None;
        }
        // What is wrong beside columns is said by the trace.
        let seen = self.with(&run.set).ok()?;
        let names = seen.system(self).ok()?.names().clone();
        let mut monitors = names.monitors;
        let guards = seen.problem.model().motion().is_ok_and(|motion| !motion.guards().is_empty());
        // Whether orbits pass events is known only where they begin.
        let begins = !matches!(run.start, Start::Rest | Start::Guess(_));
        let further = GRAZINGS.iter().map(ToString::to_string).filter(|_| guards && begins);
        let missing: Vec<String> = further.filter(|name| !monitors.contains(name)).collect();
        monitors.extend(missing);
        let made = run.hold.and_then(|kind| catalogue::row(kind)?.defined_by);
        monitors.extend(made.iter().flat_map(|make| make(0).names()).map(ToString::to_string));
        Some(Branch {
            name: run.name.clone(),
            condition: run.hold,
            itinerary: String::new(),
            unknowns: names.unknowns,
            parameters: names.parameters,
            released: run.along.iter().map(|range| range.name.clone()).collect(),
            monitors,
            points: Vec::new(),
            special: Vec::new(),
            ends: [End::Start, End::Start],
            settings: seen.settings,
        })
    }
}

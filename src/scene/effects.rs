//! Checks of changed settings: a changed setting that has no effect is an error.

use super::discretisation::{SOLUTION, Solution};
use super::error::SceneError;
use super::notation::written;
use super::resolve::{Resolved, ResolvedSweep, StartPoint};
use super::set::is_of_sweeps;
use super::statement::Scene;
use crate::core::problem::{Dynamics, Forcing};

/// The purpose for which a scene is read, which determines the settings that have an effect.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Purpose {
    /// The branches of the scene's runs are computed.
    Runs,
    /// The branches of the scene's runs are computed, and the branches that emanate from special
    /// points of these branches are computed, too.
    Exploration,
    /// The sweeps of the scene are computed; the branches of its runs are computed only to be drawn
    /// together with the sweeps.
    Sweeps,
}

impl Scene {
    /// Returns an error if a changed value has no effect for the given purpose. If a start point is
    /// given, the value must have an effect on the run that continues from this point, whose
    /// solutions can be of another kind than the solutions of the scene.
    ///
    /// # Errors
    /// [`SceneError::NoEffect`] with the reason and the remedy, if a value has no effect.
    ///
    /// ```
    /// use tangency::scene::{BUILT_IN, Scene, Purpose};
    /// let mut scene = Scene::parse(BUILT_IN.iter().find(|scene| scene.name == "bratu").expect("a scene").text)?;
    /// let error = scene.check_effects(["max_period_growth"], Purpose::Runs, None).unwrap_err();
    /// assert!(error.to_string().starts_with("`max_period_growth` has no effect on solutions without an unknown period"));
    /// assert!(scene.check_effects(["max_mesh_error"], Purpose::Runs, None).is_ok());
    /// scene.set("method", "shooting")?;
    /// let error = scene.check_effects(["max_mesh_error"], Purpose::Runs, None).unwrap_err();
    /// assert!(error.to_string().starts_with("`max_mesh_error` has no effect where `method` is `shooting`"));
    /// # Ok::<(), tangency::scene::SceneError>(())
    /// ```
    pub fn check_effects<'a>(
        &self,
        set: impl IntoIterator<Item = &'a str>,
        purpose: Purpose,
        start: Option<&StartPoint>,
    ) -> Result<(), SceneError> {
        let resolution = self.resolve(start)?;
        for name in set {
            let runs = resolution.runs.iter().map(|run| run.without_effect(name, purpose));
            let sweeps = resolution.sweeps.iter().filter(|_| purpose == Purpose::Sweeps);
            // An effect on one run or sweep suffices.
            let refused: Option<Vec<SceneError>> =
                runs.chain(sweeps.map(|sweep| sweep.without_effect(name))).collect();
            if let Some(error) = refused.and_then(|refused| refused.into_iter().next()) {
                return Err(error);
            }
        }
        Ok(())
    }
}

/// A property of solutions; some settings of the continuation have an effect only on solutions with
/// this property.
#[derive(Clone, Copy, PartialEq)]
enum Need {
    /// A discretisation.
    Discretisation,
    /// A free period.
    FreePeriod,
    /// The solutions have dynamics, which define their stability.
    Dynamics,
}

/// The settings of the continuation that have an effect only if the solutions have a certain
/// property.
const NEEDS: [(&str, Need); 8] = [
    ("refinement", Need::Discretisation),
    ("refine", Need::Discretisation),
    ("target_mesh_error", Need::Discretisation),
    ("max_mesh_error", Need::Discretisation),
    ("max_period_growth", Need::FreePeriod),
    ("phase_response", Need::FreePeriod),
    ("stability", Need::Dynamics),
    ("eigenvalues", Need::Dynamics),
];

impl Resolved {
    /// Returns the error for a changed value that has no effect on this run, or `None` if the value
    /// has an effect.
    fn without_effect(&self, name: &str, purpose: Purpose) -> Option<SceneError> {
        if self.problem.parameter_names().iter().any(|known| known == name) {
            return None;
        }
        if is_of_sweeps(name) && !self.problem.names().iter().any(|known| known == name) {
            return Some(SceneError::idle(
                name,
                "on branches, because only sweeps use this setting",
            ));
        }
        if self.run.along.is_empty() {
            return Some(SceneError::idle(name, "on simulated histories"));
        }
        // Orbits may emanate from Hopf points of equilibria, and have other settings.
        let explores = purpose == Purpose::Exploration && self.problem.solution().is_some();
        if let Some((under, value)) = self.problem.model().without_effect(name) {
            let refused = match under == SOLUTION {
                true => no_effect_at(name, &value),
                false => SceneError::no_effect_under(name, &under, &value),
            };
            return (!explores || under != SOLUTION).then_some(refused);
        }
        if self.run.local.is_some() {
            return None;
        }
        if name == "order" {
            return Some(SceneError::idle(name, "on runs without a local map"));
        }
        let (_, need) = NEEDS.into_iter().find(|(known, _)| *known == name)?;
        let at_rest = self.problem.solution().filter(|it| *it == Solution::Equilibrium);
        (!explores && self.lacks(need)).then(|| match at_rest.filter(|_| need != Need::Dynamics) {
            Some(value) => no_effect_at(name, &written(&value)),
            None => SceneError::idle(name, need.without()),
        })
    }

    /// Returns whether the solutions lack a property; returns false if this is not known.
    fn lacks(&self, need: Need) -> bool {
        let Resolved { problem, values, reach, .. } = self;
        let exact = problem.ladder(values, reach).is_ok_and(|ladder| ladder.is_empty());
        let free = self.motion().is_ok_and(|motion| motion.forcing() == Forcing::None);
        match need {
            Need::Discretisation => exact,
            Need::FreePeriod => exact || !free,
            Need::Dynamics => self.system().is_ok_and(|system| system.dynamics() == Dynamics::None),
        }
    }
}

impl ResolvedSweep {
    /// Returns the error for a changed value that has no effect on this sweep, or `None` if the
    /// value has an effect.
    fn without_effect(&self, name: &str) -> Option<SceneError> {
        let sweep = &self.sweep.name;
        if self.sweep.over.iter().any(|grid| grid.name == name) {
            let reason = format!("on the sweep `{sweep}`, which varies `{name}`");
            return Some(SceneError::idle(name, reason));
        }
        if let Some((_, own)) = self.sweep.set.iter().find(|(key, _)| key == name) {
            let reason = format!("on the sweep `{sweep}`, which sets `{name}` to `{own}`");
            return Some(SceneError::idle(name, reason));
        }
        let of_motion = self.problem.parameter_names().iter().any(|known| known == name);
        let has_effect = of_motion || is_of_sweeps(name) || self.sweep.local.is_some();
        (!has_effect).then(|| SceneError::idle(name, "on sweeps of motion"))
    }
}

/// Returns the error for a setting that has no effect on solutions of the kind that the scene states,
/// given this kind; the orbits that emanate from equilibria may use the setting.
fn no_effect_at(name: &str, value: &str) -> SceneError {
    let error = SceneError::no_effect_under(name, SOLUTION, value);
    match value == written(&Solution::Equilibrium) {
        false => error,
        true => error.with_help(format!(
            "omit `{name}`, set `{SOLUTION}` to another value, or also trace the orbits that emanate \
             from Hopf points with `--switch HB`"
        )),
    }
}

impl Need {
    /// Returns a phrase for messages that describes solutions without this property.
    fn without(self) -> &'static str {
        match self {
            Need::Discretisation => "where equations need no discretisation",
            Need::FreePeriod => "on solutions without an unknown period",
            Need::Dynamics => "for equations without dynamics",
        }
    }
}

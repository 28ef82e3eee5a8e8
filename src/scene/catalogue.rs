//! The problems and scenes that the command line finds by name, and the functions with which a
//! crate can add further problems and scenes.

use super::discretisation::{
    BoundarySettings, FieldSettings, HybridOrbitSettings, MapSettings, ZeroSettings,
};
use super::error::SceneError;
use super::kinds::{Boundary, Hybrid};
use super::notation::options;
use super::problem::{Configured, Model, Problem};
use super::source::{Files, SceneText};
use super::statement::{Scene, Start};
use super::text::{self, kind_of, with_default_settings};
use crate::core::bvp::{BoundaryProblem, IntoEquations};
use crate::core::hybrid::HybridSystem;
use crate::core::problem::DiscreteMap;
use crate::core::problem::{VectorField, ZeroProblem, names};
use crate::language::{Fault, KINDS, Source, misread, without_mark};
use ron::error::SpannedError;
use ron::value::RawValue;
use std::path::Path;
use std::sync::Arc;

/// A catalogue of the problems that scenes can name, and of the scenes that can be traced by name.
///
/// A crate can add problems and scenes to the built-in ones, and then use the whole command line
/// with them ([`cli::run`](crate::cli::run)). A new problem or scene replaces an earlier problem or
/// scene of the same name.
///
/// ```
/// use tangency::prelude::*;
/// use tangency::scene::execute;
/// vector_field! {
///     /// `r' = (μ − r²) r`, a rotation with the angular velocity 1: orbits of radius √μ from the Hopf point μ = 0.
///     struct NormalForm [x, y; mu] {
///         let growth = mu - x * x - y * y;
///         d/dt x = growth * x - y;
///         d/dt y = growth * y + x;
///     }
/// }
/// let catalogue = Catalogue::built_in().field("NormalForm", NormalForm);
/// let scene = catalogue.parse("Scene(
///     title: \"Hopf\",
///     problem: NormalForm(solution: equilibrium),
///     parameters: [(\"mu\", -1.0)],
///     runs: [Run(name: \"rest\", along: [(name: \"mu\", low: -1.0, high: 1.0)])],
/// )")?;
/// let rest = &execute(&scene, None, &mut ()).document.branches[0];
/// assert!(rest.of_kind(Kind::HB).next().expect("a Hopf point").parameters[0].abs() < 1e-14);
/// # Ok::<(), tangency::scene::SceneError>(())
/// ```
#[derive(Clone, Debug, Default)]
pub struct Catalogue {
    problems: Vec<Problem>,
    scenes: Vec<NamedScene>,
}

/// A scene that can be traced by name.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct NamedScene {
    /// The name under which the command line and the library find the scene.
    pub name: String,
    /// The text of the scene, as RON.
    pub text: String,
}

impl Catalogue {
    /// Creates an empty catalogue, without problems and scenes.
    pub fn empty() -> Self {
        Catalogue::default()
    }

    /// Adds a zero problem to the catalogue.
    pub fn zero(self, name: &'static str, problem: impl ZeroProblem + 'static) -> Self {
        self.model::<_, ZeroSettings>(name, Arc::new(problem))
    }

    /// Adds a smooth vector field to the catalogue; scenes can compute the equilibria, periodic
    /// orbits, simulations and sweeps of the field.
    pub fn field(self, name: &'static str, field: impl VectorField + 'static) -> Self {
        self.model::<_, FieldSettings>(name, Arc::new(field))
    }

    /// Adds a map to the catalogue; scenes can compute the fixed points and cycles of the map.
    ///
    /// ```
    /// use tangency::core::problem::DiscreteMap;
    /// use tangency::prelude::*;
    /// use tangency::scene::execute;
    /// /// The logistic map `x ↦ r x (1 − x)`, whose fixed point doubles its period at r = 3.
    /// struct Logistic;
    /// impl DiscreteMap for Logistic {
    ///     fn names(&self) -> Names {
    ///         Names::new(["x"], ["r"])
    ///     }
    ///     fn next<T: Scalar>(&self, x: &[T], p: &[T], next: &mut [T]) {
    ///         next[0] = p[0] * x[0] * (T::one() - x[0]);
    ///     }
    /// }
    /// let scene = Catalogue::empty().map("Logistic", Logistic).parse("Scene(
    ///     title: \"Logistic map\",
    ///     problem: Logistic(),
    ///     parameters: [(\"r\", 2)],
    ///     runs: [Run(name: \"fixed\", start: Guess([(\"x\", 0.5)]), along: [(name: \"r\", low: 1.5, high: 3.5)])],
    /// )")?;
    /// let fixed = &execute(&scene, None, &mut ()).document.branches[0];
    /// assert!((fixed.of_kind(Kind::PD).next().expect("a doubling").parameters[0] - 3.0).abs() < 1e-12);
    /// # Ok::<(), tangency::scene::SceneError>(())
    /// ```
    pub fn map(self, name: &'static str, map: impl DiscreteMap + 'static) -> Self {
        self.model::<_, MapSettings>(name, Arc::new(map))
    }

    /// Adds a boundary-value problem to the catalogue.
    pub fn boundary(self, name: &'static str, problem: impl BoundaryProblem + 'static) -> Self {
        let defaults = problem.defaults();
        let problem: Boundary = (problem.into_equations(), defaults);
        self.model::<_, BoundarySettings>(name, problem)
    }

    /// Adds a hybrid system to the catalogue; scenes can compute the periodic orbits, simulations,
    /// sweeps, and local maps at grazings of the system.
    pub fn hybrid(self, name: &'static str, system: impl HybridSystem + 'static) -> Self {
        let system: Hybrid = Arc::new(system);
        self.model::<_, HybridOrbitSettings>(name, system)
    }

    /// Adds a scene to the catalogue. Lists show the summary of the scene, or its title if it has
    /// no summary.
    pub fn scene(self, name: impl Into<String>, text: impl Into<String>) -> Self {
        let scene = NamedScene { name: name.into(), text: text.into() };
        let mut scenes = self.scenes;
        scenes.retain(|known| known.name != scene.name);
        scenes.push(scene);
        Catalogue { scenes, ..self }
    }

    /// Adds a problem of any kind, with its default settings.
    pub(super) fn model<P, S: Default>(mut self, name: &'static str, problem: P) -> Self
    where
        Configured<P, S>: Model + 'static,
    {
        self.problems.retain(|problem| problem.name() != name);
        self.problems.push(Problem::new(name, problem));
        self
    }

    /// Returns all problems, with their default settings.
    pub fn problems(&self) -> &[Problem] {
        &self.problems
    }

    /// Returns all scenes.
    pub fn scenes(&self) -> &[NamedScene] {
        &self.scenes
    }

    /// Returns the summary of a scene in one line, or its title if it has no summary; for an
    /// invalid scene, returns the error message.
    pub fn summary(&self, scene: &NamedScene) -> String {
        match self.parse(&scene.text) {
            Ok(read) => read.summary.unwrap_or(read.title),
            Err(error) => format!("error: {error}"),
        }
    }

    /// Parses a scene.
    ///
    /// # Errors
    /// [`SceneError::Model`] with the position of the error for a text that cannot be parsed;
    /// [`SceneError::UnknownName`] for a problem that is not in the catalogue;
    /// [`SceneError::Invalid`] for invalid contents, such as numbers that are not finite, duplicate
    /// or unknown names, or runs without a start.
    pub fn parse(&self, text: &str) -> Result<Scene, SceneError> {
        self.parse_in(Files::of(Path::new("")), text)
    }

    /// Parses a scene that may refer to files of equations.
    ///
    /// # Errors
    /// The errors of [`parse`](Self::parse), and [`SceneError::File`] for a file that cannot be
    /// read.
    pub fn parse_in(&self, files: Files, text: &str) -> Result<Scene, SceneError> {
        self.parse_within(Some(files), text)
    }

    /// Parses a scene that must not refer to files, such as a scene in an archive from an untrusted
    /// source.
    ///
    /// # Errors
    /// The errors of [`parse`](Self::parse), and [`SceneError::Value`] if the scene refers to a
    /// file.
    pub fn parse_alone(&self, text: &str) -> Result<Scene, SceneError> {
        self.parse_within(None, text)
    }

    fn parse_within(&self, files: Option<Files>, text: &str) -> Result<Scene, SceneError> {
        let text = without_mark(text);
        let read: Scene<Option<&RawValue>> =
            options().from_str(text).map_err(|error| no_scene(text, error))?;
        let given: Vec<String> = read.parameters.iter().map(|(name, _)| name.clone()).collect();
        let within = SceneText { text, files };
        let problem = match (&read.problem, &read.model) {
            (Some(stated), None) => self.problem(stated, within, &given)?,
            (None, Some(file)) => with_default_settings(within, file, &given)?,
            (stated, _) => {
                let found = if stated.is_some() { "is given twice" } else { "is missing" };
                let help = "give the problem exactly once, as `problem: …` or as `model: \
                            \"file.ron\"`";
                return Err(SceneError::invalid(format!("the problem {found}")).with_help(help));
            }
        };
        let Scene {
            title, summary, parameters, accuracy, settings, plot, mut runs, sweeps, ..
        } = read;
        for run in &mut runs {
            if let Start::Profile(profile) = &mut run.start {
                profile.load(within)?;
            }
        }
        let model = None;
        let mut scene = Scene {
            title,
            summary,
            problem,
            model,
            parameters,
            accuracy,
            settings,
            plot,
            runs,
            sweeps,
        };
        scene.observe_scales(&[]);
        scene.check()?;
        Ok(scene)
    }

    /// Returns the problem of a scene; it is parsed from the part of the scene's text that contains
    /// the name and the settings of the problem.
    fn problem(
        &self,
        stated: &RawValue,
        scene: SceneText,
        given: &[String],
    ) -> Result<Problem, SceneError> {
        let text = scene.text;
        let stated = stated.trim().get_ron();
        let end = stated.find(|c: char| !(c.is_alphanumeric() || c == '_')).unwrap_or(stated.len());
        let (name, settings) = stated.split_at(end);
        let at = settings.as_ptr() as usize - text.as_ptr() as usize;
        if name.is_empty() {
            let reason = "expected the name of a problem, such as `Plate()`".into();
            return Err(Source::new("", text).fault_at(at..at, Fault::Form { reason }).into());
        }
        let known = self.problems.iter().map(Problem::name);
        if let (Some(kind), false) = (kind_of(name), known.clone().any(|known| known == name)) {
            return text::stated(scene, kind, (settings, at), given);
        }
        let known = known.chain(KINDS.iter().map(|(kind, _)| *kind));
        let problem = &self.problems[names::position("problem", name, known)?];
        problem.read(settings).map_err(|error| misread(&Source::new("", text), at, error).into())
    }
}

/// Returns the error for a text that is not a scene.
fn no_scene(text: &str, error: SpannedError) -> SceneError {
    let error = misread(&Source::new("", text), 0, error);
    match (&error.fault, text.contains("Scene(")) {
        (Fault::Form { .. }, false) => {
            error.with_help("begin a scene with `Scene(title: …, problem: …`").into()
        }
        _ => error.into(),
    }
}

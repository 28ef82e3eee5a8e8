//! The problem of a scene: an entry of a catalogue, with its settings.

use super::by_name;
use super::discretisation::{Discretisation, ProblemSettings, Solution, Started};
use super::error::SceneError;
use super::local::Local;
use super::notation::{options, written};
use super::plane::PlaneMap;
use super::profile::Profile;
use super::simulate::{Simulated, settled};
use crate::core::bvp::Guess;
use crate::core::cancel::CancelToken;
use crate::core::continuation::{Branch, SettingError, SpecialPoint};
use crate::core::hybrid::HybridEquations;
use crate::core::local_map::LocalMap;
use crate::core::orbit::HybridOrbit;
use crate::core::problem::UnknownName;
use crate::core::system::System;
use crate::language::xpp::Options;
use crate::language::{self, ModelError, Source, Statement};
use ron::error::SpannedError;
use ron::value::RawValue;
use serde::{Serialize, Serializer};
use std::fmt;
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// Names of parameters, and their defaults; `None` where there is no default.
pub(super) type Parameters = Vec<(String, Option<f64>)>;

const SIMULATED: &str = "only vector fields and hybrid systems are simulated";

/// Values of states by name, at a time in units of a segment's duration.
pub(super) type Profiles<'a> = &'a dyn Fn(f64) -> Vec<(String, f64)>;

/// What a problem with its settings answers for scenes: what a catalogue and a scene hold.
/// Capabilities that a kind of problem does not have are typed errors.
pub(super) trait Model: Adjustable {
    /// The kind of problem, in words.
    fn kind(&self) -> &'static str;

    fn parameters(&self) -> Parameters;

    /// The same with settings of growing accuracy and cost, for parameters that begin at `p` and go
    /// as far as `reach`; none if the problem has no discretisation.
    fn ladder(&self, _p: &[f64], _reach: &[f64]) -> Result<Vec<Box<dyn Model>>, SceneError> {
        Ok(Vec::new())
    }

    /// The same for a run that begins in some states, where these say what it follows; `None` if
    /// they say nothing.
    fn begun_at(&self, _start: &[(String, f64)], _p: &[f64]) -> Option<Box<dyn Model>> {
        None
    }

    /// The system for parameters that begin at `p`; `reach` lists for each of them how far it goes
    /// from there.
    fn system(&self, p: &[f64], reach: &[f64]) -> Result<Box<dyn System>, SceneError>;

    /// The unknowns of a solution with these profiles; `None` unless solutions are profiles.
    fn sampled(&self, _profiles: Profiles) -> Result<Option<Vec<f64>>, SceneError> {
        Ok(None)
    }

    /// The motion that is simulated and swept.
    fn motion(&self) -> Result<Arc<dyn HybridEquations>, SceneError> {
        Err(self.lacks(SIMULATED))
    }

    /// The system of the orbits like a simulated one, and that orbit.
    fn started(&self, _simulated: Guess<HybridOrbit>, _p: &[f64]) -> Result<Started, SceneError> {
        Err(self.lacks(SIMULATED))
    }

    /// The system of the orbits like the one on which a simulation settles, and that orbit.
    fn settled(
        &self,
        run: &str,
        simulated: &Simulated,
        p: &[f64],
        cancel: &CancelToken,
    ) -> Result<Started, SceneError> {
        self.started(settled(self.motion()?, run, simulated, p, cancel)?, p)
    }

    /// The local map at a grazing, for a run or a sweep.
    fn local_map(
        &self,
        _run: &str,
        _local: &Local,
        _at: (&Branch, &SpecialPoint),
        _cancel: &CancelToken,
    ) -> Result<LocalMap, SceneError> {
        Err(self.lacks("only hybrid systems graze and have local maps"))
    }

    /// The map, whose saddles have manifolds.
    fn plane(&self) -> Result<&dyn PlaneMap, SceneError> {
        let rule = "only saddles of maps have manifolds here: state the problem as a `Map`";
        Err(SceneError::invalid("the problem", self.kind(), rule))
    }

    /// The error of a capability that problems of this kind do not have.
    fn lacks(&self, needs: &'static str) -> SceneError {
        SceneError::Unsupported { needs, kind: self.kind() }
    }
}

/// The operations of all models on their settings.
pub(super) trait Adjustable: Send + Sync {
    fn boxed(&self) -> Box<dyn Model>;
    fn with_defaults(&self) -> Box<dyn Model>;
    fn read(&self, settings: &str) -> Result<Box<dyn Model>, SpannedError>;
    fn written(&self) -> String;
    /// The settings by name, with their values.
    fn settings(&self) -> Vec<(String, String)>;
    /// The names of all settings, under every choice.
    fn setting_names(&self) -> Vec<String>;
    /// Which solutions are followed, of problems with several kinds.
    fn solution(&self) -> Option<Solution>;
    /// The same problem, of which other solutions are followed; itself if it has one kind.
    fn following(&self, solution: Solution) -> Box<dyn Model>;
    /// The same problem on other intervals, if it is discretised by collocation.
    fn on_intervals(&self, count: usize) -> Box<dyn Model>;
    /// Whether a setting is the choice of a method.
    fn chooses(&self, name: &str) -> bool;
    /// Sets one setting by name; false if there is none of this name.
    fn assign(&mut self, name: &str, value: &str) -> Result<bool, SceneError>;
    fn check(&self) -> Result<(), SettingError>;
    /// The setting, with its value, under which one of these names has no effect.
    fn without_effect(&self, name: &str) -> Option<(String, String)>;
}

/// A problem with its settings.
#[derive(Clone)]
pub(super) struct Configured<P, S> {
    pub problem: P,
    pub settings: S,
}

impl<P: Clone, S> Configured<P, S>
where
    Self: Model + 'static,
{
    /// The problems with each of some settings.
    pub fn on(&self, settings: Vec<S>) -> Vec<Box<dyn Model>> {
        settings.into_iter().map(|settings| self.with(settings)).collect()
    }

    fn with(&self, settings: S) -> Box<dyn Model> {
        Box::new(Configured { problem: self.problem.clone(), settings })
    }
}

impl<P: Clone + Send + Sync + 'static, S: ProblemSettings> Adjustable for Configured<P, S>
where
    Self: Model,
{
    fn boxed(&self) -> Box<dyn Model> {
        Box::new(self.clone())
    }

    fn with_defaults(&self) -> Box<dyn Model> {
        self.with(S::default())
    }

    fn read(&self, settings: &str) -> Result<Box<dyn Model>, SpannedError> {
        Ok(self.with(options().from_str(settings)?))
    }

    fn written(&self) -> String {
        written(&self.settings)
    }

    fn settings(&self) -> Vec<(String, String)> {
        by_name::settings(&self.settings)
    }

    fn setting_names(&self) -> Vec<String> {
        names_of::<S>()
    }

    fn solution(&self) -> Option<Solution> {
        self.settings.clone().solution().copied()
    }

    fn following(&self, solution: Solution) -> Box<dyn Model> {
        let mut settings = self.settings.clone();
        settings.solution().into_iter().for_each(|own| *own = solution);
        self.with(settings)
    }

    fn on_intervals(&self, count: usize) -> Box<dyn Model> {
        let mut settings = self.settings.clone();
        if let Some(Discretisation::Collocation(own)) = settings.discretisation() {
            own.intervals = count;
        }
        self.with(settings)
    }

    fn chooses(&self, name: &str) -> bool {
        by_name::choice(&self.settings).is_some_and(|(choice, _)| choice == name)
    }

    fn assign(&mut self, name: &str, value: &str) -> Result<bool, SceneError> {
        by_name::assign(&mut self.settings, name, value)
    }

    fn check(&self) -> Result<(), SettingError> {
        self.settings.check()
    }

    fn without_effect(&self, name: &str) -> Option<(String, String)> {
        // The errors of meshes are settings of the continuation, and go with intervals.
        let name = if OF_MESHES.contains(&name) { INTERVALS } else { name };
        if !self.setting_names().iter().any(|known| known == name) {
            return None;
        }
        let own = self.settings.without_effect(name);
        own.map(|(under, value)| (under.to_string(), value)).or_else(|| {
            let has = self.settings().iter().any(|(known, _)| known == name);
            by_name::choice(&self.settings).filter(|_| !has)
        })
    }
}

/// The setting of collocation that settings of meshes go with.
const INTERVALS: &str = "intervals";

/// The settings of the continuation that concern meshes.
const OF_MESHES: [&str; 2] = ["target_mesh_error", "max_mesh_error"];

/// The names of settings, with each method.
pub(super) fn names_of<S: ProblemSettings>() -> Vec<String> {
    let usual = S::default();
    let mut names: Vec<String> = Vec::new();
    for settings in [usual.clone()].into_iter().chain(usual.with(Discretisation::methods())) {
        let all = by_name::settings(&settings).into_iter().map(|(name, _)| name);
        names.extend(all.filter(|name| !names.contains(name)).collect::<Vec<_>>());
    }
    names
}

/// A model with its statement, by which problems are told apart.
#[derive(Clone, Debug)]
pub(super) struct Stated {
    pub model: language::Model,
    /// The statement, as [`Statement::ron`] writes it: from its bracket on.
    pub written: String,
    /// The file that states it, if it is not stated in a scene.
    pub file: Option<PathBuf>,
    /// The lines of a file that have no effect, or another name here.
    pub notes: Vec<String>,
    /// How far a file says that its model is to be followed.
    pub options: Options,
}

impl Stated {
    /// Understands a statement, for a scene that gives some parameters.
    pub(super) fn new(
        statement: Statement,
        source: &Source,
        given: &[String],
    ) -> Result<Self, ModelError> {
        let written = language::statement_in(&statement.ron()).1.trim_end().to_string();
        let model = statement.model(source, given)?;
        let (notes, options) = (Vec::new(), Options::default());
        Ok(Stated { model, written, file: None, notes, options })
    }
}

/// A problem of a [`Catalogue`](super::Catalogue) with its settings.
pub struct Problem {
    name: &'static str,
    model: Box<dyn Model>,
    /// Its equations, if they are given as text.
    text: Option<Arc<Stated>>,
}

impl Problem {
    /// A problem with its default settings.
    pub(super) fn new<P, S: Default>(name: &'static str, problem: P) -> Self
    where
        Configured<P, S>: Model + 'static,
    {
        let model = Box::new(Configured { problem, settings: S::default() });
        Problem { name, model, text: None }
    }

    /// A problem whose equations are given as text.
    pub(super) fn stated(name: &'static str, model: Box<dyn Model>, text: Stated) -> Self {
        Problem { name, model, text: Some(Arc::new(text)) }
    }

    /// Its equations, if they are given as text.
    pub fn text(&self) -> Option<&language::Model> {
        self.text.as_ref().map(|text| &text.model)
    }

    /// The file that its equations were read from, if they have one of their own.
    pub fn file(&self) -> Option<&Path> {
        self.text.as_ref()?.file.as_deref()
    }

    /// The lines of a file of its equations that have no effect, or another name here.
    pub fn notes(&self) -> &[String] {
        self.text.as_ref().map_or(&[], |text| &text.notes)
    }

    /// Its equations as a file that [`from_file`](Self::from_file) reads, if they are given as
    /// text.
    pub fn equations(&self) -> String {
        self.text.as_ref().map_or(String::new(), |text| format!("{}{}", self.name, text.written))
    }

    /// How far a file of its equations says that they are to be followed.
    pub(super) fn options(&self) -> Options {
        self.text.as_ref().map_or(Options::default(), |text| text.options.clone())
    }

    /// Values of states, where motion and branches begin if nothing else is said.
    pub(super) fn initial(&self, p: &[f64]) -> Vec<(String, f64)> {
        self.text().map_or(Vec::new(), |text| text.initial(p))
    }

    /// The problem of a run that begins in some states, or where the problem says.
    pub(super) fn begun_at(&self, start: &[(String, f64)], p: &[f64]) -> Self {
        let states = [start, &self.initial(p)].concat();
        self.model.begun_at(&states, p).map_or_else(|| self.clone(), |model| self.with(model))
    }

    /// The unknowns of the profiles at which a branch begins; `None` unless solutions are profiles.
    /// States that the table omits start at `initial`, or at 0.
    pub(super) fn sampled(
        &self,
        p: &[f64],
        table: Option<&Profile>,
    ) -> Result<Option<Vec<f64>>, SceneError> {
        let text = self.text();
        if text.is_none() && table.is_none() {
            return Ok(None);
        }
        self.model.sampled(&|tau| {
            let stated = text.map_or(Vec::new(), |text| text.initial_along(tau, p));
            let tabled = table.map_or(Vec::new(), |table| table.at(tau));
            tabled.into_iter().chain(stated).collect()
        })
    }

    /// Its name in the catalogue.
    pub fn name(&self) -> &'static str {
        self.name
    }

    /// Names of the parameters and their default values; `None` where the problem states no
    /// default.
    pub fn parameters(&self) -> Parameters {
        self.model.parameters()
    }

    /// Names of the settings, and their values as text.
    pub fn settings(&self) -> Vec<(String, String)> {
        self.model.settings()
    }

    /// Which solutions are followed, of problems with several kinds.
    pub(super) fn solution(&self) -> Option<Solution> {
        self.model.solution()
    }

    /// Follows other solutions, if the problem has several kinds.
    pub(super) fn follow(&mut self, solution: Solution) {
        self.model = self.model.following(solution);
    }

    /// Takes other intervals, if the problem is discretised by collocation.
    pub(super) fn take_intervals(&mut self, count: usize) {
        self.model = self.model.on_intervals(count);
    }

    /// Names of everything that can be set.
    pub fn names(&self) -> Vec<String> {
        [self.parameter_names(), self.model.setting_names()].concat()
    }

    /// The names of the parameters.
    pub(super) fn parameter_names(&self) -> Vec<String> {
        self.parameters().into_iter().map(|(name, _)| name).collect()
    }

    /// Refuses a name that is no parameter.
    pub(super) fn require_parameter(&self, name: &str) -> Result<(), SceneError> {
        let known = self.parameter_names();
        if known.iter().any(|known| known == name) {
            return Ok(());
        }
        if let Some(line) = self.text().and_then(|text| text.line_of_definition(name)) {
            let rule = "only parameters can be set and varied: change it there, or move it to `parameters` (sizes of \
                        arrays must be definitions)";
            let found = format!("a definition ({line})");
            return Err(SceneError::invalid(format!("`{name}`"), found, rule));
        }
        Err(UnknownName::new("parameter", name, known).into())
    }

    pub(super) fn model(&self) -> &dyn Model {
        &*self.model
    }

    fn with(&self, model: Box<dyn Model>) -> Problem {
        Problem { name: self.name, model, text: self.text.clone() }
    }

    /// The problem with settings read from RON.
    pub(super) fn read(&self, settings: &str) -> Result<Problem, SpannedError> {
        Ok(self.with(self.model.read(settings)?))
    }

    /// The problem with default settings.
    pub(super) fn with_defaults(&self) -> Problem {
        self.with(self.model.with_defaults())
    }

    /// Its equations, if they are given as text, and its settings, as a scene has them.
    pub(super) fn written(&self) -> String {
        let settings = self.model.written();
        let Some(text) = &self.text else { return settings };
        let inner = |written: &str| {
            let inner = written.trim().strip_prefix('(').and_then(|rest| rest.strip_suffix(')'));
            inner
                .unwrap_or(written)
                .trim_matches(|c: char| c.is_whitespace() || c == ',')
                .to_string()
        };
        let parts = [inner(&text.written), inner(&settings)];
        let parts: Vec<String> = parts.into_iter().filter(|part| !part.is_empty()).collect();
        format!("({}\n)", parts.join(",\n    "))
    }

    /// Sets one setting by name; false if there is none of this name.
    pub(super) fn set(&mut self, name: &str, value: &str) -> Result<bool, SceneError> {
        if self.model.assign(name, value)? {
            return Ok(true);
        }
        if !self.model.setting_names().iter().any(|known| known == name) {
            return Ok(false);
        }
        // Only the choice of another method has it.
        match self.model.without_effect(name) {
            Some((under, value)) => Err(SceneError::no_effect_under(name, &under, &value)),
            None => Ok(false),
        }
    }

    /// The problem by discretisations of growing accuracy and cost; none if it has no
    /// discretisation.
    pub(super) fn ladder(&self, p: &[f64], reach: &[f64]) -> Result<Vec<Problem>, SceneError> {
        let ladder = self.model.ladder(p, reach)?;
        Ok(ladder.into_iter().map(|model| self.with(model)).collect())
    }
}

impl Clone for Problem {
    fn clone(&self) -> Self {
        self.with(self.model.boxed())
    }
}

/// Problems are equal if they have the same name and the same settings.
impl PartialEq for Problem {
    fn eq(&self, other: &Self) -> bool {
        self.name == other.name && self.written() == other.written()
    }
}

impl fmt::Debug for Problem {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        write!(f, "{}{}", self.name, self.written())
    }
}

impl Serialize for Problem {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let written = self.written();
        let settings = RawValue::from_ron(&written).map_err(serde::ser::Error::custom)?;
        serializer.serialize_newtype_variant("Problem", 0, self.name, settings)
    }
}

//! The problem of a scene: an entry of a catalogue, with its settings.

use super::by_name;
use super::discretisation::{Discretisation, ProblemSettings, Settled, Solution, Started};
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

/// The names of the parameters of a problem, with their default values; `None` for a parameter
/// without a default value.
pub(super) type Parameters = Vec<(String, Option<f64>)>;

/// The requirement of simulations.
pub(super) const SIMULATED: &str = "only vector fields and hybrid systems can be simulated";

/// The remedy for problems that cannot be simulated.
pub(super) const LUMPED: &str = "static equations have no motion to simulate: write a lumped model of the motion, such \
                                 as `Equations(states: [(\"x\", \"v\"), (\"v\", \"-x - 0.1*v + V^2/(1 - x)^2\")], \
                                 parameters: [(\"V\", 0.1)])`";

/// A function that returns the values of the states by name at a given time; the time is in units
/// of the duration of a segment.
pub(super) type Profiles<'a> = &'a dyn Fn(f64) -> Vec<(String, f64)>;

/// The interface of a problem with its settings, as catalogues and scenes store it. If a kind of
/// problem does not support a computation, the method for this computation returns a typed error.
pub(super) trait Model: Adjustable {
    /// Returns a description of the kind of problem.
    fn kind(&self) -> &'static str;

    fn parameters(&self) -> Parameters;

    /// Returns copies of the problem with settings of growing accuracy and cost, for parameters
    /// that start at the values `p` and vary as far as `reach`; the result is empty if the problem
    /// has no discretisation.
    fn ladder(&self, _p: &[f64], _reach: &[f64]) -> Result<Vec<Box<dyn Model>>, SceneError> {
        Ok(Vec::new())
    }

    /// Returns a copy of the problem for a run that starts in the given states, if these states
    /// determine whether equilibria or orbits are traced; otherwise returns `None`.
    fn begun_at(&self, _start: &[(String, f64)], _p: &[f64]) -> Option<Box<dyn Model>> {
        None
    }

    /// Returns the system of equations that the problem solves, for parameters that start at the
    /// values `p`; `reach` states how far each parameter varies from its start.
    fn system(&self, p: &[f64], reach: &[f64]) -> Result<Box<dyn System>, SceneError>;

    /// Returns the unknowns that represent a solution with the given profiles; `None` if the
    /// solutions of the problem are not profiles.
    fn sampled(&self, _profiles: Profiles) -> Result<Option<Vec<f64>>, SceneError> {
        Ok(None)
    }

    /// Returns the motion that simulations and sweeps compute.
    fn motion(&self) -> Result<Arc<dyn HybridEquations>, SceneError> {
        Err(self.lacks(SIMULATED, LUMPED))
    }

    /// Returns the system of equations for orbits that have the itinerary (the sequence of modes
    /// and events) of a simulated orbit, and the simulated orbit as its unknowns.
    fn started(&self, _simulated: Guess<HybridOrbit>, _p: &[f64]) -> Result<Started, SceneError> {
        Err(self.lacks(SIMULATED, LUMPED))
    }

    /// Returns the system of equations for orbits that have the itinerary (the sequence of modes
    /// and events) of a simulated attractor, and the orbit of the attractor as its unknowns; also
    /// returns a warning if the attractor is probably not the expected one.
    fn settled(
        &self,
        run: &str,
        simulated: &Simulated,
        p: &[f64],
        cancel: &CancelToken,
    ) -> Result<Settled, SceneError> {
        self.settled_on(self.motion()?, run, simulated, p, cancel)
    }

    /// Like [`Model::settled`], for the attractor of the given motion.
    fn settled_on(
        &self,
        motion: Arc<dyn HybridEquations>,
        run: &str,
        simulated: &Simulated,
        p: &[f64],
        cancel: &CancelToken,
    ) -> Result<Settled, SceneError> {
        let (orbit, warning) = settled(motion, run, simulated, p, cancel)?;
        Ok((self.started(orbit, p)?, warning))
    }

    /// Returns the local map at a grazing, for a run or a sweep.
    fn local_map(
        &self,
        _run: &str,
        _local: &Local,
        _at: (&Branch, &SpecialPoint),
        _cancel: &CancelToken,
    ) -> Result<LocalMap, SceneError> {
        Err(self.lacks(
            "only hybrid systems have grazings and local maps",
            "state the vector field as a hybrid system with one mode",
        ))
    }

    /// Returns the map whose saddles have stable and unstable manifolds.
    fn plane(&self) -> Result<&dyn PlaneMap, SceneError> {
        let kind = self.kind();
        let message =
            format!("manifolds are computed only for saddles of maps, but this problem is {kind}");
        Err(SceneError::invalid(message).with_help("state the problem as a `Map`"))
    }

    /// Returns the error for a requested computation that this kind of problem does not support.
    fn lacks(&self, needs: &'static str, remedy: &'static str) -> SceneError {
        SceneError::Unsupported { needs, kind: self.kind(), remedy }
    }
}

/// The operations on the settings of a problem that all problems support.
pub(super) trait Adjustable: Send + Sync {
    fn boxed(&self) -> Box<dyn Model>;
    fn with_defaults(&self) -> Box<dyn Model>;
    fn read(&self, settings: &str) -> Result<Box<dyn Model>, SpannedError>;
    fn written(&self) -> String;
    /// Returns the names of the problem's settings, with their values.
    fn settings(&self) -> Vec<(String, String)>;
    /// Whether the settings determine the equations, and not only the accuracy of their solutions.
    fn settings_define_equations(&self) -> bool;
    /// Returns the names of all settings of the problem, including the settings of methods that are
    /// not selected.
    fn setting_names(&self) -> Vec<String>;
    /// Returns the kind of solutions to trace, or `None` if the problem has only one kind of
    /// solutions.
    fn solution(&self) -> Option<Solution>;
    /// Returns a copy of the problem that traces another kind of solutions; the copy is unchanged
    /// if the problem has only one kind.
    fn following(&self, solution: Solution) -> Box<dyn Model>;
    /// Returns a copy of the problem with another number of mesh intervals; the copy is unchanged
    /// if the problem is not discretised by collocation.
    fn on_intervals(&self, count: usize) -> Box<dyn Model>;
    /// Returns whether a setting selects a method of discretisation.
    fn chooses(&self, name: &str) -> bool;
    /// Sets one setting of the problem by name; returns false if the name is unknown.
    fn assign(&mut self, name: &str, value: &str) -> Result<bool, SceneError>;
    fn check(&self) -> Result<(), SettingError>;
    /// Returns the setting that makes the named setting ineffective, with the value that has this
    /// effect.
    fn without_effect(&self, name: &str) -> Option<(String, String)>;
}

/// A problem together with its settings.
#[derive(Clone)]
pub(super) struct Configured<P, S> {
    pub problem: P,
    pub settings: S,
}

impl<P: Clone, S> Configured<P, S>
where
    Self: Model + 'static,
{
    /// Returns a copy of the problem for each of the given settings.
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

    fn settings_define_equations(&self) -> bool {
        S::define_equations()
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
        // The error tolerances of meshes are settings of the continuation, and belong to the
        // intervals.
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

/// The name of the setting of collocation that determines whether the settings of mesh adaptation
/// have an effect.
const INTERVALS: &str = "intervals";

/// The settings of the continuation that concern the adaptation of meshes.
const OF_MESHES: [&str; 2] = ["target_mesh_error", "max_mesh_error"];

/// Returns the names of all settings, including the settings of every method of discretisation.
pub(super) fn names_of<S: ProblemSettings>() -> Vec<String> {
    let usual = S::default();
    let mut names: Vec<String> = Vec::new();
    for settings in [usual.clone()].into_iter().chain(usual.with(Discretisation::methods())) {
        let all = by_name::settings(&settings).into_iter().map(|(name, _)| name);
        names.extend(all.filter(|name| !names.contains(name)).collect::<Vec<_>>());
    }
    names
}

/// A model whose equations are given as text; two such problems are compared by the text of their
/// equations.
#[derive(Clone, Debug)]
pub(super) struct Stated {
    pub model: language::Model,
    /// The text of the equations from its first bracket, in the form that [`Statement::ron`]
    /// writes.
    pub written: String,
    /// The file that contains the equations; `None` if the scene itself contains the equations.
    pub file: Option<PathBuf>,
    /// Notes about lines of the file of equations that have no effect, and about names that were
    /// changed.
    pub notes: Vec<String>,
    /// The numerical options given in a file, such as the bound on quantities and the duration of a
    /// simulation.
    pub options: Options,
}

impl Stated {
    /// Parses the equations of a model, for a scene that gives values to some parameters.
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

/// A problem from a [`Catalogue`](super::Catalogue), with its settings.
pub struct Problem {
    name: &'static str,
    model: Box<dyn Model>,
    /// The equations of the problem if they are given as text, otherwise `None`.
    text: Option<Arc<Stated>>,
    /// The scales that were estimated from the motion, by name.
    observed_scales: Vec<(String, f64)>,
}

impl Problem {
    /// Creates a problem with default settings.
    pub(super) fn new<P, S: Default>(name: &'static str, problem: P) -> Self
    where
        Configured<P, S>: Model + 'static,
    {
        let model = Box::new(Configured { problem, settings: S::default() });
        Problem { name, model, text: None, observed_scales: Vec::new() }
    }

    /// Creates a problem whose equations are given as text.
    pub(super) fn stated(name: &'static str, model: Box<dyn Model>, text: Stated) -> Self {
        Problem { name, model, text: Some(Arc::new(text)), observed_scales: Vec::new() }
    }

    /// Returns the equations if they are given as text, otherwise `None`.
    pub fn text(&self) -> Option<&language::Model> {
        self.text.as_ref().map(|text| &text.model)
    }

    /// Returns the file that contains the equations; `None` if the scene itself contains the
    /// equations.
    pub fn file(&self) -> Option<&Path> {
        self.text.as_ref()?.file.as_deref()
    }

    /// Returns notes about lines of the file of equations that have no effect, and about names that
    /// were changed.
    pub fn notes(&self) -> &[String] {
        self.text.as_ref().map_or(&[], |text| &text.notes)
    }

    /// Returns the equations in the form of a file that [`from_file`](Self::from_file) can read;
    /// the text is empty if the equations are not given as text.
    pub fn equations(&self) -> String {
        self.text.as_ref().map_or(String::new(), |text| format!("{}{}", self.name, text.written))
    }

    /// Returns the numerical options that are given in the file of equations.
    pub(super) fn options(&self) -> Options {
        self.text.as_ref().map_or(Options::default(), |text| text.options.clone())
    }

    /// Returns the default initial states of motions and branches.
    pub(super) fn initial(&self, p: &[f64]) -> Vec<(String, f64)> {
        self.text().map_or(Vec::new(), |text| text.initial(p))
    }

    /// Returns the problem of a run that starts in the given states; states that are not given have
    /// the problem's initial values.
    pub(super) fn begun_at(&self, start: &[(String, f64)], p: &[f64]) -> Self {
        let states = [start, &self.initial(p)].concat();
        self.model.begun_at(&states, p).map_or_else(|| self.clone(), |model| self.with(model))
    }

    /// Returns the scales that were estimated from the motion because the equations state no scales,
    /// by name; empty if all quantities have usual sizes.
    pub(super) fn observed_scales(&self) -> &[(String, f64)] {
        &self.observed_scales
    }

    /// Replaces the model by a model of the same equations whose scales were estimated.
    pub(super) fn take_scales(&mut self, model: Box<dyn Model>, observed: Vec<(String, f64)>) {
        (self.model, self.observed_scales) = (model, observed);
    }

    /// Returns the unknowns that represent the profiles at which a branch starts; `None` if the
    /// solutions of the problem are not profiles. States that do not occur in the table of profiles
    /// start at the values `initial`, or at 0.
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

    /// Returns the name of the problem in the catalogue.
    pub fn name(&self) -> &'static str {
        self.name
    }

    /// Returns the names of the parameters and their default values; `None` for a parameter without
    /// a default value.
    pub fn parameters(&self) -> Parameters {
        self.model.parameters()
    }

    /// Returns the names of the problem's settings, with their values as text.
    pub fn settings(&self) -> Vec<(String, String)> {
        self.model.settings()
    }

    /// Returns the names and values of the settings if they determine the equations, and not only
    /// the accuracy of their solutions.
    pub(super) fn defining_settings(&self) -> Vec<(String, String)> {
        if self.model.settings_define_equations() { self.settings() } else { Vec::new() }
    }

    /// Returns the kind of solutions to trace, or `None` if the problem has only one kind of
    /// solutions.
    pub(super) fn solution(&self) -> Option<Solution> {
        self.model.solution()
    }

    /// Selects the kind of solutions to trace, if the problem has several kinds of solutions.
    pub(super) fn follow(&mut self, solution: Solution) {
        self.model = self.model.following(solution);
    }

    /// Sets the number of mesh intervals; has no effect if the problem is not discretised by
    /// collocation.
    pub(super) fn take_intervals(&mut self, count: usize) {
        self.model = self.model.on_intervals(count);
    }

    /// Returns the names of all parameters and settings of the problem.
    pub fn names(&self) -> Vec<String> {
        [self.parameter_names(), self.model.setting_names()].concat()
    }

    /// Returns the names of the problem's parameters.
    pub(super) fn parameter_names(&self) -> Vec<String> {
        self.parameters().into_iter().map(|(name, _)| name).collect()
    }

    /// Returns an error if a name is not the name of a parameter.
    pub(super) fn require_parameter(&self, name: &str) -> Result<(), SceneError> {
        let known = self.parameter_names();
        if known.iter().any(|known| known == name) {
            return Ok(());
        }
        if let Some(line) = self.text().and_then(|text| text.line_of_definition(name)) {
            let message = format!(
                "`{name}` is a definition ({line}), but only parameters can be set and varied"
            );
            return Err(SceneError::invalid(message).with_help(format!(
                "change the definition, or move `{name}` to `parameters` (sizes of arrays must be definitions)"
            )));
        }
        Err(UnknownName::new("parameter", name, known).into())
    }

    pub(super) fn model(&self) -> &dyn Model {
        &*self.model
    }

    fn with(&self, model: Box<dyn Model>) -> Problem {
        let (text, observed_scales) = (self.text.clone(), self.observed_scales.clone());
        Problem { name: self.name, model, text, observed_scales }
    }

    /// Returns a copy of the problem with settings parsed from RON.
    pub(super) fn read(&self, settings: &str) -> Result<Problem, SpannedError> {
        Ok(self.with(self.model.read(settings)?))
    }

    /// Returns a copy of the problem with default settings.
    pub(super) fn with_defaults(&self) -> Problem {
        self.with(self.model.with_defaults())
    }

    /// Returns the text by which scenes state the problem: its equations, if they are given as
    /// text, and its settings.
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

    /// Sets one setting of the problem by name; returns false if the name is unknown.
    pub(super) fn set(&mut self, name: &str, value: &str) -> Result<bool, SceneError> {
        if self.model.assign(name, value)? {
            return Ok(true);
        }
        if !self.model.setting_names().iter().any(|known| known == name) {
            return Ok(false);
        }
        // The setting may belong to another method.
        match self.model.without_effect(name) {
            Some((under, value)) => Err(SceneError::no_effect_under(name, &under, &value)),
            None => Ok(false),
        }
    }

    /// Returns copies of the problem with discretisations of growing accuracy and cost; the result
    /// is empty if the problem has no discretisation.
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

/// Two problems are equal if they have the same name and the same settings.
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

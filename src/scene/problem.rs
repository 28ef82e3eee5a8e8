//! The problem of a scene: an entry of a catalogue, with its settings.

use super::discretisation::{ProblemSettings, Started};
use super::simulate::{Simulation, settled, simulate};
use super::slot::{self, Slots, options, written};
use super::{Capability, Local, SceneError, Simulated};
use crate::core::attractor::{StroboscopicError, StroboscopicMap};
use crate::core::bvp::Birth;
use crate::core::continuation::{Branch, SettingError, SpecialPoint};
use crate::core::grazing::LocalMap;
use crate::core::hybrid::{HybridEquations, HybridState};
use crate::core::orbit::HybridOrbit;
use crate::core::zero::System;
use ron::error::SpannedError;
use ron::value::RawValue;
use serde::{Serialize, Serializer};
use std::fmt;
use std::sync::Arc;

/// What a kind of problem answers for scenes, given its settings. Capabilities that a kind does not have are typed errors.
pub(super) trait Model: Send + Sync + 'static {
    /// The settings of such problems.
    type Settings: ProblemSettings;

    /// What kind of problem it is, in words.
    const KIND: &'static str;

    /// Names of the parameters, and their defaults; `None` where there is no default.
    fn parameters(&self, settings: &Self::Settings) -> Vec<(String, Option<f64>)>;

    /// Settings of growing accuracy and cost, for parameters that begin at `p` and go as far as `reach`; none if the problem
    /// has no discretisation.
    fn ladder(
        &self,
        _settings: &Self::Settings,
        _p: &[f64],
        _reach: &[f64],
    ) -> Result<Vec<Self::Settings>, SceneError> {
        Ok(Vec::new())
    }

    /// The system for parameters that begin at `p`; `reach` lists for each of them how far it goes from there.
    fn system(
        &self,
        settings: &Self::Settings,
        p: &[f64],
        reach: &[f64],
    ) -> Result<Box<dyn System>, SceneError>;

    /// The motion that is simulated.
    fn motion(&self) -> Result<Arc<dyn HybridEquations>, SceneError> {
        Err(Self::lacks(Capability::Simulation))
    }

    /// The system of the orbits like a simulated one, and that orbit.
    fn started(
        &self,
        _settings: &Self::Settings,
        _simulated: Birth<HybridOrbit>,
        _p: &[f64],
    ) -> Result<Started, SceneError> {
        Err(Self::lacks(Capability::Simulation))
    }

    /// The local map at a grazing, for a run or a sweep.
    fn local_map(
        &self,
        _settings: &Self::Settings,
        _run: &str,
        _local: &Local,
        _at: (&Branch, &SpecialPoint),
    ) -> Result<LocalMap, SceneError> {
        Err(Self::lacks(Capability::LocalMap))
    }

    /// The motions that sweeps follow.
    fn swept(&self) -> Result<&dyn Swept, SceneError> {
        Err(Self::lacks(Capability::Sweep))
    }

    /// The error of a capability that problems of this kind do not have.
    fn lacks(capability: Capability) -> SceneError {
        SceneError::Unsupported { capability, kind: Self::KIND }
    }
}

/// Motions that sweeps sample once a forcing period.
pub(super) trait Swept: Sync {
    /// The motion with these measures, followed with this tolerance.
    fn strobed(
        &self,
        measures: &[String],
        tolerance: f64,
    ) -> Result<Box<dyn StroboscopicMap + '_>, StroboscopicError>;
}

/// A model with settings, erased: what a catalogue and a scene hold.
pub(super) trait Entry: Send + Sync {
    fn boxed(&self) -> Box<dyn Entry>;
    fn with_defaults(&self) -> Box<dyn Entry>;
    fn read(&self, settings: &str) -> Result<Box<dyn Entry>, SpannedError>;
    fn written(&self) -> String;
    fn slots(&mut self) -> Slots<'_>;
    fn check(&self) -> Result<(), SettingError>;
    fn parameters(&self) -> Vec<(String, Option<f64>)>;
    fn ladder(&self, p: &[f64], reach: &[f64]) -> Result<Vec<Box<dyn Entry>>, SceneError>;
    fn system(&self, p: &[f64], reach: &[f64]) -> Result<Box<dyn System>, SceneError>;
    fn history(
        &self,
        run: &str,
        simulated: &Simulated,
        p: &[f64],
        start: Option<HybridState<f64>>,
    ) -> Result<Simulation, SceneError>;
    fn settled(&self, run: &str, simulated: &Simulated, p: &[f64]) -> Result<Started, SceneError>;
    fn local_map(
        &self,
        run: &str,
        local: &Local,
        at: (&Branch, &SpecialPoint),
    ) -> Result<LocalMap, SceneError>;
    fn swept(&self) -> Result<&dyn Swept, SceneError>;
}

/// A model with its settings.
struct Configured<M: Model> {
    model: Arc<M>,
    settings: M::Settings,
}

impl<M: Model> Configured<M> {
    fn with(&self, settings: M::Settings) -> Box<dyn Entry> {
        Box::new(Configured { model: self.model.clone(), settings })
    }
}

impl<M: Model> Entry for Configured<M> {
    fn boxed(&self) -> Box<dyn Entry> {
        self.with(self.settings.clone())
    }

    fn with_defaults(&self) -> Box<dyn Entry> {
        self.with(M::Settings::default())
    }

    fn read(&self, settings: &str) -> Result<Box<dyn Entry>, SpannedError> {
        Ok(self.with(options().from_str(settings)?))
    }

    fn written(&self) -> String {
        written(&self.settings)
    }

    fn slots(&mut self) -> Slots<'_> {
        self.settings.slots()
    }

    fn check(&self) -> Result<(), SettingError> {
        self.settings.check()
    }

    fn parameters(&self) -> Vec<(String, Option<f64>)> {
        self.model.parameters(&self.settings)
    }

    fn ladder(&self, p: &[f64], reach: &[f64]) -> Result<Vec<Box<dyn Entry>>, SceneError> {
        let ladder = self.model.ladder(&self.settings, p, reach)?;
        Ok(ladder.into_iter().map(|settings| self.with(settings)).collect())
    }

    fn system(&self, p: &[f64], reach: &[f64]) -> Result<Box<dyn System>, SceneError> {
        self.model.system(&self.settings, p, reach)
    }

    fn history(
        &self,
        run: &str,
        simulated: &Simulated,
        p: &[f64],
        start: Option<HybridState<f64>>,
    ) -> Result<Simulation, SceneError> {
        simulate(&*self.model.motion()?, run, simulated, p, start)
    }

    fn settled(&self, run: &str, simulated: &Simulated, p: &[f64]) -> Result<Started, SceneError> {
        let cycle = settled(self.model.motion()?, run, simulated, p)?;
        self.model.started(&self.settings, cycle, p)
    }

    fn local_map(
        &self,
        run: &str,
        local: &Local,
        at: (&Branch, &SpecialPoint),
    ) -> Result<LocalMap, SceneError> {
        self.model.local_map(&self.settings, run, local, at)
    }

    fn swept(&self) -> Result<&dyn Swept, SceneError> {
        self.model.swept()
    }
}

/// A problem of a [`Catalogue`](super::Catalogue) with its settings.
pub struct Problem {
    name: &'static str,
    entry: Box<dyn Entry>,
}

impl Problem {
    /// A model with its default settings.
    pub(super) fn new<M: Model>(name: &'static str, model: M) -> Self {
        let (model, settings) = (Arc::new(model), M::Settings::default());
        Problem { name, entry: Box::new(Configured { model, settings }) }
    }

    /// Its name in the catalogue.
    pub fn name(&self) -> &'static str {
        self.name
    }

    /// Names of the parameters and their default values; `None` where the problem states no default.
    pub fn parameters(&self) -> Vec<(String, Option<f64>)> {
        self.entry.parameters()
    }

    /// Names of the settings, and their values as text.
    pub fn settings(&self) -> Vec<(&'static str, String)> {
        let mut entry = self.entry.boxed();
        entry.slots().into_iter().map(|(name, slot)| (name, slot.written())).collect()
    }

    /// Names of everything that can be set.
    pub fn names(&self) -> Vec<String> {
        let settings = self.settings().into_iter().map(|(name, _)| name.to_string());
        self.parameters().into_iter().map(|(name, _)| name).chain(settings).collect()
    }

    /// What it answers.
    pub(super) fn entry(&self) -> &dyn Entry {
        &*self.entry
    }

    fn with(&self, entry: Box<dyn Entry>) -> Problem {
        Problem { name: self.name, entry }
    }

    /// The same problem with settings read from RON.
    pub(super) fn read(&self, settings: &str) -> Result<Problem, SpannedError> {
        Ok(self.with(self.entry.read(settings)?))
    }

    /// The same problem with default settings.
    pub(super) fn with_defaults(&self) -> Problem {
        self.with(self.entry.with_defaults())
    }

    /// Sets one setting by name; false if there is none of this name.
    pub(super) fn set(&mut self, name: &str, value: &str) -> Result<bool, SceneError> {
        slot::assign(self.entry.slots(), name, value)
    }

    /// The same problem by discretisations of growing accuracy and cost; none if it has no discretisation.
    pub(super) fn ladder(&self, p: &[f64], reach: &[f64]) -> Result<Vec<Problem>, SceneError> {
        let ladder = self.entry.ladder(p, reach)?;
        Ok(ladder.into_iter().map(|entry| self.with(entry)).collect())
    }
}

impl Clone for Problem {
    fn clone(&self) -> Self {
        self.with(self.entry.boxed())
    }
}

/// Problems are equal if they have the same name and the same settings.
impl PartialEq for Problem {
    fn eq(&self, other: &Self) -> bool {
        self.name == other.name && self.entry.written() == other.entry.written()
    }
}

impl fmt::Debug for Problem {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        write!(f, "{}{}", self.name, self.entry.written())
    }
}

impl Serialize for Problem {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let written = self.entry.written();
        let settings = RawValue::from_ron(&written).map_err(serde::ser::Error::custom)?;
        serializer.serialize_newtype_variant("Problem", 0, self.name, settings)
    }
}

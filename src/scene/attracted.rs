//! The attractor to which the motion of a scene converges at fixed parameter values.

use super::error::SceneError;
use super::simulate::{SAMPLES, Simulated, curves, moved, portrait, search, searched, stated};
use super::statement::{Scene, Start};
use crate::core::attractor::{CycleSearch, CycleSearchError};
use crate::core::cancel::CancelToken;
use crate::core::equilibrium::{equilibrium_near, place_in_words};
use crate::core::failure::one_line;
use crate::core::hybrid::{
    Cycle, CycleLeg, History, HybridEquations, HybridError, HybridFlow, HybridSettings,
    HybridState, Piece, time_scale,
};
use crate::core::problem::{Forcing, Profile};
use crate::output::significant;
use std::fmt;

/// The effort with which an attractor is searched.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Patience {
    /// A short simulation without a transient, for a start near the attractor.
    Short,
    /// A simulation with the same transient as in the search for the start of a branch of orbits,
    /// and with enough returns for a decision.
    Usual,
}

/// Heuristic: the number of returns and the time, in units of the time scale, after which a short
/// search ends.
const SHORT: (usize, f64) = (40, 150.0);
/// Heuristic: the number of returns after which a usual search ends; the number is small because a
/// page waits for searches from several states.
const RETURNS: usize = 200;
/// Heuristic: two durations of the curve of a motion that is not periodic, in forcing periods or in
/// units of the time scale; the first applies after a short search, the second after a usual search.
const SHOWN: [f64; 2] = [50.0, 200.0];

/// Heuristic: the distance of a nearby state from a state of the motion, in units of the scales.
const NUDGE: f64 = 1e-3;

/// Heuristic: the size of a motion, in units of the scales, up to which the motion counts as rest.
const REST: f64 = 1e-7;

/// The kind of an attractor.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub enum AttractorKind {
    /// The motion comes to rest at an equilibrium.
    Equilibrium,
    /// The motion is periodic.
    Cycle {
        /// The period.
        period: f64,
        /// The number of forcing periods in a period; `None` without forcing.
        forcing_periods: Option<usize>,
    },
    /// The motion did not repeat in the given number of returns of a usual search.
    NotPeriodic {
        /// The number of returns.
        returns: usize,
    },
    /// A short search was not long enough for a decision.
    Unsettled,
    /// The search failed, for example because the motion escapes.
    Failed {
        /// The reason.
        reason: String,
    },
}

impl fmt::Display for AttractorKind {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        match self {
            AttractorKind::Equilibrium => f.write_str("equilibrium"),
            AttractorKind::Cycle { period, forcing_periods } => {
                write!(f, "period {}", significant(*period, 5))?;
                match forcing_periods {
                    Some(1) => f.write_str(", the period of the forcing"),
                    Some(count) => write!(f, ", {count} periods of the forcing"),
                    None => Ok(()),
                }
            }
            AttractorKind::NotPeriodic { returns } => {
                write!(f, "not periodic: no repetition in {returns} returns")
            }
            AttractorKind::Unsettled => f.write_str("not settled yet"),
            AttractorKind::Failed { reason } => f.write_str(reason),
        }
    }
}

/// An attractor with its curves.
#[derive(Clone, Debug, PartialEq)]
pub struct Attracted {
    /// The kind of the attractor.
    pub kind: AttractorKind,
    /// The states over time: one period of a cycle, one point for an equilibrium, and otherwise a
    /// part of the motion.
    pub curves: Vec<Profile>,
    /// A state of the attractor, given by the names of the states of the first mode.
    pub end: Vec<(String, f64)>,
    /// The scales of the states of the first mode.
    pub scales: Vec<(String, f64)>,
}

impl Attracted {
    /// Returns the curve in the plane of two states; `None` if a state does not exist.
    pub fn portrait(&self, x: &str, y: &str) -> Option<Profile> {
        let curve = |name: &str| self.curves.iter().find(|curve| curve.name == name);
        Some(portrait(curve(x)?, curve(y)?))
    }
}

impl Scene {
    /// Returns the initial states of the first run; states that its start does not give have the
    /// problem's initial values, and states without initial values are omitted.
    ///
    /// # Errors
    /// [`SceneError`] if a parameter has no value, or if the problem has no motion that can be
    /// simulated.
    pub fn initial_states(&self) -> Result<Vec<(String, f64)>, SceneError> {
        let given = match self.runs.first().map(|run| &run.start) {
            Some(Start::Guess(state)) => state.clone(),
            Some(Start::Simulated(simulated)) => simulated.state.clone(),
            _ => Vec::new(),
        };
        let begun = Simulated { state: given, ..Simulated::default() };
        let mut state = begun.from(&self.problem.initial(&self.values()?)).state;
        let modes = self.problem.model().motion()?.modes();
        state.retain(|(name, _)| modes[0].states.contains(name));
        Ok(state)
    }

    /// Simulates the motion from a state of the first mode, given by name, and returns the
    /// attractor to which the motion converges; states that are not named are zero.
    ///
    /// ```
    /// use tangency::scene::{AttractorKind, Patience, Scene};
    /// // r' = r (m − r²) and φ' = 2 in the plane: a cycle of the period π for m > 0.
    /// let scene = |m: f64| Scene::parse(&format!("Scene(title: \"t\", parameters: [(\"m\", {m})],
    ///     problem: Equations(states: [(\"x\", \"m*x - 2*y - x*(x^2 + y^2)\"), (\"y\", \"2*x + m*y - y*(x^2 + y^2)\")]),
    ///     runs: [(name: \"r\", along: [(name: \"m\", low: -1, high: 1)])])"));
    /// let start = [("x".to_string(), 0.3)];
    /// let rest = scene(-0.5)?.attractor(&start, Patience::Usual)?;
    /// assert_eq!(rest.kind, AttractorKind::Equilibrium);
    /// // The motion leaves the unstable equilibrium.
    /// let kind = scene(0.5)?.attractor(&[], Patience::Short)?.kind;
    /// assert!(matches!(kind, AttractorKind::Cycle { .. }), "{kind}");
    /// let AttractorKind::Cycle { period, .. } = scene(0.5)?.attractor(&start, Patience::Usual)?.kind else { panic!("a cycle") };
    /// assert!((period - std::f64::consts::PI).abs() < 1e-5);
    /// let found = scene(-0.5)?.attractor(&[], Patience::Short)?;
    /// assert!(found.kind == AttractorKind::Equilibrium && found.end[0].1.abs() < 1e-9);
    /// # Ok::<(), tangency::scene::SceneError>(())
    /// ```
    ///
    /// # Errors
    /// [`SceneError`] if a state does not exist, or if the problem has no motion that can be
    /// simulated. A simulation that fails is reported as [`AttractorKind::Failed`].
    pub fn attractor(
        &self,
        state: &[(String, f64)],
        patience: Patience,
    ) -> Result<Attracted, SceneError> {
        let system = &*self.problem.model().motion()?;
        let (p, cancel) = (self.values()?, &self.settings.cancel);
        let start = stated(&system.modes()[0], state)?;
        let sought = patience.search(system, &p);
        let found = patience.attracting(system, &start, &sought, (&p, cancel));
        let forced = system.forcing() != Forcing::None;
        let (kind, pieces) = match found {
            Ok(cycle) => {
                let forcing_periods = forced.then_some(cycle.periods);
                let kind = AttractorKind::Cycle { period: cycle.duration(), forcing_periods };
                (kind, moved(cancel, |settings| around(system, settings, &cycle, &p)))
            }
            Err(CycleSearchError::Equilibrium { mode, states, .. }) => {
                let rest = Piece { mode, times: vec![0.0], states: vec![states] };
                (AttractorKind::Equilibrium, Ok(vec![rest]))
            }
            Err(cause) => {
                let times = patience.shown(system, &p, &sought);
                let wander = |settings| wandering(system, settings, (&start, times), &p);
                (patience.kind(&cause), moved(cancel, wander))
            }
        };
        let (kind, pieces) = match pieces {
            Ok(pieces) => (kind, pieces),
            Err(cause) => (AttractorKind::Failed { reason: one_line(&cause) }, Vec::new()),
        };
        Ok(attracted(system, kind, &pieces, &p))
    }
}

impl Patience {
    /// Returns the settings of the search.
    fn search(self, system: &dyn HybridEquations, p: &[f64]) -> CycleSearch {
        let usual = search(system, &Simulated::default(), p);
        let (returns, longest) = SHORT;
        match self {
            Patience::Short => CycleSearch { transient: 0.0, returns, longest, ..usual },
            Patience::Usual => CycleSearch { returns: RETURNS, ..usual },
        }
    }

    /// Searches for an attractor. A motion may converge to an unstable equilibrium or cycle, for
    /// example if the motion starts there: a short search therefore starts near the given state,
    /// and a usual search is repeated from a state near the attractor that it has found.
    fn attracting(
        self,
        system: &dyn HybridEquations,
        start: &HybridState<f64>,
        search: &CycleSearch,
        (p, cancel): (&[f64], &CancelToken),
    ) -> Result<Cycle, CycleSearchError> {
        let sought = |start: &HybridState<f64>| sought(system, start, search, (p, cancel));
        // The nearby state may be beyond a surface.
        let refused = |found: &Result<Cycle, CycleSearchError>| {
            matches!(found, Err(CycleSearchError::Motion(_))) && !system.guards().is_empty()
        };
        if self == Patience::Short {
            let found = sought(&nudged(system, start, p));
            return if refused(&found) { sought(start) } else { found };
        }
        let found = sought(start);
        let state = match &found {
            Err(CycleSearchError::Equilibrium { mode, states, .. }) => {
                HybridState { mode: *mode, time: start.time, x: states.clone() }
            }
            Ok(Cycle { legs, start, .. }) if !legs.is_empty() => {
                HybridState { mode: legs[0].mode, time: *start, x: legs[0].start.clone() }
            }
            _ => return found,
        };
        let again = sought(&nudged(system, &state, p));
        if refused(&again) { found } else { again }
    }

    /// Returns two durations: the duration of the transient, and the duration of the curve of a
    /// motion that is not periodic.
    fn shown(self, system: &dyn HybridEquations, p: &[f64], search: &CycleSearch) -> [f64; 2] {
        let unit = match system.forcing() {
            Forcing::None => time_scale(system, p),
            Forcing::Periodic { .. } => system.period(p),
        };
        [search.transient, unit * SHOWN[usize::from(self == Patience::Usual)]]
    }

    /// Returns the kind of an attractor on which the search found neither an equilibrium nor a
    /// cycle.
    fn kind(self, cause: &CycleSearchError) -> AttractorKind {
        match (self, cause) {
            (_, CycleSearchError::Motion(cause)) => {
                AttractorKind::Failed { reason: one_line(cause) }
            }
            (Patience::Short, _) => AttractorKind::Unsettled,
            (Patience::Usual, CycleSearchError::Unsettled { returns, .. }) => {
                AttractorKind::NotPeriodic { returns: *returns }
            }
            (Patience::Usual, cause) => AttractorKind::Failed { reason: one_line(cause) },
        }
    }
}

/// Searches for the attractor of a motion. Near an equilibrium, rounding errors and integration
/// errors may repeat periodically; such a motion counts as an equilibrium and not as a cycle.
fn sought(
    system: &dyn HybridEquations,
    start: &HybridState<f64>,
    search: &CycleSearch,
    (p, cancel): (&[f64], &CancelToken),
) -> Result<Cycle, CycleSearchError> {
    let found = searched(system, start, search, (p, cancel));
    let Ok(cycle) = &found else { return found };
    let [CycleLeg { mode, exit: None, start, .. }] = &cycle.legs[..] else { return found };
    let curve = moved(cancel, |settings| around(system, settings, cycle, p));
    let states = curve.iter().flatten().flat_map(|piece| &piece.states);
    let mut scales = system.scales_of(*mode, p);
    scales.resize(start.len(), 1.0);
    let moves = |x: &Vec<f64>| {
        x.iter().zip(start).zip(&scales).any(|((x, start), scale)| (x - start).abs() > REST * scale)
    };
    if system.forcing() != Forcing::None || curve.is_err() || states.clone().any(moves) {
        return found;
    }
    let (mode, time) = (*mode, cycle.start);
    let Some(states) = equilibrium_near(system, mode, start, p) else { return found };
    let place = place_in_words(system, mode, &states);
    Err(CycleSearchError::Equilibrium { time, place, mode, states })
}

/// Returns a state near a state of the motion. The distances differ from state to state, so that
/// the nearby state is not on an invariant plane of a symmetric system.
fn nudged(system: &dyn HybridEquations, state: &HybridState<f64>, p: &[f64]) -> HybridState<f64> {
    let mut scales = system.scales_of(state.mode, p);
    scales.resize(state.x.len(), 1.0);
    let mut nudged = state.clone();
    for (k, (x, scale)) in nudged.x.iter_mut().zip(scales).enumerate() {
        *x += NUDGE * scale * (1.0 + 0.37 * k as f64);
    }
    nudged
}

/// Returns one period of a cycle.
fn around(
    system: &dyn HybridEquations,
    settings: HybridSettings,
    cycle: &Cycle,
    p: &[f64],
) -> Result<Vec<Piece>, HybridError> {
    let Some(first) = cycle.legs.first() else { return Ok(Vec::new()) };
    let state = HybridState { mode: first.mode, time: cycle.start, x: first.start.clone() };
    recorded(HybridFlow::new(system, settings)?, state, cycle.duration(), p)
}

/// Returns a part of a motion after a transient.
fn wandering(
    system: &dyn HybridEquations,
    settings: HybridSettings,
    (start, [transient, duration]): (&HybridState<f64>, [f64; 2]),
    p: &[f64],
) -> Result<Vec<Piece>, HybridError> {
    let mut flow = HybridFlow::new(system, settings)?;
    let mut state = flow.initial(start.clone(), p);
    flow.advance(&mut state, transient, p, &mut ())?;
    recorded(flow, state, duration, p)
}

fn recorded(
    mut flow: HybridFlow<f64>,
    mut state: HybridState<f64>,
    duration: f64,
    p: &[f64],
) -> Result<Vec<Piece>, HybridError> {
    let mut history = History::new(SAMPLES);
    flow.advance(&mut state, duration, p, &mut history)?;
    Ok(history.pieces)
}

fn attracted(
    system: &dyn HybridEquations,
    kind: AttractorKind,
    pieces: &[Piece],
    p: &[f64],
) -> Attracted {
    let begin = pieces.first().and_then(|piece| piece.times.first()).copied();
    let curves = curves(system, pieces, begin.unwrap_or_default());
    let modes = system.modes();
    let last = |name: &String| {
        let piece = pieces.last()?;
        let column = modes[piece.mode].states.iter().position(|state| state == name)?;
        Some((name.clone(), piece.states.last()?[column]))
    };
    let mut sizes = system.scales_of(0, p);
    sizes.resize(modes[0].states.len(), 1.0);
    let end = modes[0].states.iter().filter_map(last).collect();
    let scales = modes[0].states.iter().cloned().zip(sizes).collect();
    Attracted { kind, curves, end, scales }
}

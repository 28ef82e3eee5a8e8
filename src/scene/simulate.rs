//! Simulated histories, for transients and for motions that do not converge to a periodic orbit.

use super::discretisation::no_start;
use super::error::SceneError;
use super::forecast;
use super::notation::values;
use super::observer::SceneObserver;
use crate::core::attractor::{CycleSearch, CycleSearchError};
use crate::core::bvp::Guess;
use crate::core::cancel::CancelToken;
use crate::core::continuation::{Branch, End, Point, Settings, SpecialPoint};
use crate::core::failure::FlowError;
use crate::core::hybrid::{
    Cycle, Guard, History, HybridEquations, HybridError, HybridFlow, HybridSettings, HybridState,
    Mode, Piece,
};
use crate::core::ode;
use crate::core::orbit::{HybridOrbit, Itinerary};
use crate::core::problem::{Forcing, Profile, distinct, position};
use crate::core::system::Kind;
use serde::{Deserialize, Serialize};
use std::error::Error;
use std::sync::Arc;

/// A simulation of a vector field or of a hybrid system; for a hybrid system, the simulation starts
/// in a state of the first mode. The simulation of a Filippov system starts in the mode that
/// belongs to the side of the surface on which the initial state lies. All times of a simulation
/// are in periods of the forcing, or in units of time for systems without forcing.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct Simulated {
    /// The initial states by name; states that are not named are zero.
    #[serde(deserialize_with = "values")]
    pub state: Vec<(String, f64)>,
    /// The name of an earlier simulated run; the final state of this run is used as the initial
    /// state.
    pub after: Option<String>,
    /// The duration of the transient; it precedes the history and is not saved.
    pub transient: f64,
    /// The duration of the saved history.
    pub duration: f64,
}

impl Default for Simulated {
    fn default() -> Self {
        Simulated { state: Vec::new(), after: None, transient: 200.0, duration: 1.0 }
    }
}

impl Simulated {
    /// Returns a copy of the simulation that starts in the initial states of the problem, except
    /// for states that the simulation itself specifies.
    pub(super) fn from(&self, initial: &[(String, f64)]) -> Self {
        let mut state = self.state.clone();
        let stated = |name: &String| self.state.iter().any(|(known, _)| known == name);
        state.extend(initial.iter().filter(|(name, _)| !stated(name)).cloned());
        Simulated { state, ..self.clone() }
    }
}

/// The name of the column that counts events: per period of the forcing, or in the whole history
/// for systems without forcing.
const EVENTS: &str = "events";

/// The number of samples per integration step in a history.
pub(super) const SAMPLES: usize = 8;

/// Simulates a system, first through a transient and then through a history; returns the history as
/// a branch with one point, and the final state.
pub(super) fn simulate(
    system: &dyn HybridEquations,
    name: &str,
    simulated: &Simulated,
    (p, cancel): (&[f64], &CancelToken),
    (start, observer): (Option<HybridState<f64>>, &mut dyn SceneObserver),
) -> Result<(Branch, HybridState<f64>), SceneError> {
    let failed = |cause: HybridError| SceneError::of_run(name, cause);
    let start = match start {
        Some(state) => state,
        None => stated(&system.modes()[0], &simulated.state)?,
    };
    let unit = system.period(p);
    let duration = (simulated.transient + simulated.duration) * unit;
    let state =
        HybridFlow::new(system, HybridSettings::default()).map_err(failed)?.initial(start, p);
    forecast::motion(name, system, &state, (duration, p), observer);
    moved(cancel, |settings| {
        let mut state = state.clone();
        let mut flow = HybridFlow::new(system, settings)?;
        flow.advance(&mut state, simulated.transient * unit, p, &mut ())?;
        // Large times lose digits; the time matters only modulo a period.
        state.time %= unit;
        let begin = state.time;
        let mut history = History::new(SAMPLES);
        flow.advance(&mut state, simulated.duration * unit, p, &mut history)?;
        let curves = curves(system, &history.pieces, begin);
        let events = history.events.len() as f64 / simulated.duration;
        Ok((branch(system, name, p, &curves, events), state))
    })
    .map_err(failed)
}

/// Runs a simulation that can be cancelled, with the default settings; if the vector field is
/// stiff, repeats the simulation with the implicit method.
pub(super) fn moved<T, E: Error + 'static>(
    cancel: &CancelToken,
    follow: impl Fn(HybridSettings) -> Result<T, E>,
) -> Result<T, E> {
    let settings = |flow| HybridSettings {
        flow: ode::Settings { cancel: cancel.clone(), ..flow },
        ..HybridSettings::default()
    };
    match follow(settings(ode::Settings::default())) {
        Err(cause) if is_stiff(&cause) => follow(settings(ode::Settings::implicit())),
        outcome => outcome,
    }
}

/// Returns whether an explicit integration method failed because the vector field is, or may be,
/// stiff.
fn is_stiff(cause: &(dyn Error + 'static)) -> bool {
    match cause.downcast_ref::<FlowError>() {
        Some(cause) => cause.is_stiff(),
        None => cause.source().is_some_and(is_stiff),
    }
}

/// Returns the settings of the search for periodic motion.
pub(super) fn search(
    system: &dyn HybridEquations,
    simulated: &Simulated,
    p: &[f64],
) -> CycleSearch {
    CycleSearch { transient: simulated.transient * system.period(p), ..CycleSearch::default() }
}

/// Estimates how long a simulation may take until it converges, and reports the estimate.
pub(super) fn foresee_settling(
    system: &dyn HybridEquations,
    run: &str,
    simulated: &Simulated,
    p: &[f64],
    observer: &mut dyn SceneObserver,
) -> Result<(), SceneError> {
    let start = stated(&system.modes()[0], &simulated.state)?;
    let search = search(system, simulated, p);
    let searched = match system.forcing() {
        Forcing::Periodic { .. } => search.returns as f64 * system.period(p),
        Forcing::None => search.longest_time(system, p),
    };
    forecast::motion(run, system, &start, (search.transient + searched, p), observer);
    Ok(())
}

/// Returns the periodic motion to which a simulation converges, as an orbit with its itinerary (the
/// sequence of its modes and events), and a warning if the motion lasts several periods of the
/// forcing.
pub(super) fn settled(
    system: Arc<dyn HybridEquations>,
    run: &str,
    simulated: &Simulated,
    p: &[f64],
    cancel: &CancelToken,
) -> Result<(Guess<HybridOrbit>, Option<String>), SceneError> {
    let unsettled = |cause: CycleSearchError| SceneError::of_run(run, cause);
    let cycle = found(&*system, simulated, p, cancel)?.map_err(unsettled)?;
    let orbit = HybridOrbit::of_cycle(system.clone(), &cycle, p).map_err(no_start)?;
    let warning = several_periods(&*system, orbit.problem.itinerary());
    Ok((orbit, warning))
}

/// Returns a warning if a motion lasts several periods of the forcing.
fn several_periods(system: &dyn HybridEquations, itinerary: &Itinerary) -> Option<String> {
    let Itinerary { periods, legs } = itinerary;
    if system.forcing() == Forcing::None || *periods < 2 {
        return None;
    }
    let guards = system.guards();
    let count = |(index, guard): (usize, &Guard)| {
        let count = legs.iter().filter(|leg| leg.exit == Some(index)).count();
        (count > 0).then(|| format!("{count} × `{}`", guard.name))
    };
    let events: Vec<String> = guards.iter().enumerate().filter_map(count).collect();
    let events = match events.is_empty() {
        true => String::new(),
        false => format!(" ({})", events.join(", ")),
    };
    Some(format!(
        "the branch starts from a motion of {periods} forcing periods{events}: other motions may be \
         reached from another parameter value or another state"
    ))
}

/// Returns the equilibrium to which a simulation converges, as the mode and the states of the
/// equilibrium.
pub(super) fn rested(
    system: &dyn HybridEquations,
    run: &str,
    simulated: &Simulated,
    p: &[f64],
    cancel: &CancelToken,
) -> Result<(usize, Vec<f64>), SceneError> {
    match found(system, simulated, p, cancel)? {
        Err(CycleSearchError::Equilibrium { mode, states, .. }) => Ok((mode, states)),
        Err(cause) => Err(SceneError::of_run(run, cause)),
        Ok(_) => {
            let message =
                format!("run `{run}`: the motion converges to a cycle, not to an equilibrium");
            Err(SceneError::invalid(message)
                .with_help("set `solution: orbit`, or start the motion at another state"))
        }
    }
}

/// Returns the attractor to which a simulation converges.
fn found(
    system: &dyn HybridEquations,
    simulated: &Simulated,
    p: &[f64],
    cancel: &CancelToken,
) -> Result<Result<Cycle, CycleSearchError>, SceneError> {
    let start = stated(&system.modes()[0], &simulated.state)?;
    Ok(searched(system, &start, &search(system, simulated, p), (p, cancel)))
}

/// Searches for the attractor to which a motion converges.
pub(super) fn searched(
    system: &dyn HybridEquations,
    start: &HybridState<f64>,
    search: &CycleSearch,
    (p, cancel): (&[f64], &CancelToken),
) -> Result<Cycle, CycleSearchError> {
    moved(cancel, |settings| {
        let mut flow = HybridFlow::new(system, settings)?;
        search.find(&mut flow, start.clone(), p)
    })
}

/// Returns a state of the first mode from values that are given by name; all other states are zero,
/// and the system then determines the mode in which the motion starts.
pub(super) fn stated(mode: &Mode, given: &[(String, f64)]) -> Result<HybridState<f64>, SceneError> {
    let mut x = vec![0.0; mode.states.len()];
    for (name, value) in given {
        x[position("state", name, &mode.states)?] = *value;
    }
    Ok(HybridState { mode: 0, time: 0.0, x })
}

/// Returns the history of every state of the system; of the cumulative states of a mode, only the
/// sum is returned.
pub(super) fn curves(system: &dyn HybridEquations, pieces: &[Piece], begin: f64) -> Vec<Profile> {
    let (modes, counted) = (system.modes(), system.cumulative_states());
    let mut curves: Vec<Profile> = Vec::new();
    for name in distinct(modes.iter().flat_map(|mode| &mode.states)) {
        let (mut points, mut before) = (Vec::new(), 0.0);
        for piece in pieces {
            let column = modes[piece.mode].states.iter().position(|state| state == name);
            let sum = counted.iter().any(|counted| counted == name);
            let base = if sum { before } else { 0.0 };
            match column {
                Some(k) => {
                    let values = piece.states.iter().map(|x| base + x[k]);
                    points.extend(piece.times.iter().zip(values).map(|(t, v)| [t - begin, v]));
                    before = points.last().map_or(before, |last: &[f64; 2]| last[1]);
                }
                None if sum => points.extend(piece.times.iter().map(|t| [t - begin, before])),
                None => {}
            }
        }
        curves.push(Profile { name: name.into(), along: "time".into(), points });
    }
    curves
}

/// Returns the names of the columns for the maximum and the minimum of a state.
fn extremes(state: &str) -> [String; 3] {
    [format!("max_{state}"), format!("min_{state}"), format!("{state}_range")]
}

/// Returns the names of the monitors that a history may have if its motion passes through the given
/// modes.
pub(super) fn history_columns(modes: &[Mode]) -> Vec<String> {
    let states = distinct(modes.iter().flat_map(|mode| &mode.states));
    [EVENTS.into()].into_iter().chain(states.into_iter().flat_map(extremes)).collect()
}

/// Returns a history as a branch with one point: the monitors of this point are the extremes of all
/// states, and its profiles are the states as functions of time.
fn branch(
    system: &dyn HybridEquations,
    name: &str,
    p: &[f64],
    curves: &[Profile],
    events: f64,
) -> Branch {
    let (mut monitors, mut values) = (vec![EVENTS.to_string()], vec![events]);
    for Profile { name, points, .. } in curves.iter().filter(|curve| !curve.points.is_empty()) {
        let extreme = |pick: fn(f64, f64) -> f64| points.iter().map(|q| q[1]).reduce(pick);
        monitors.extend(extremes(name));
        let (most, least) = (extreme(f64::max), extreme(f64::min));
        let range = most.zip(least).map(|(most, least)| most - least);
        values.extend([most, least, range].into_iter().flatten());
    }
    let parameters = system.parameters();
    let released: Vec<String> = parameters.first().cloned().into_iter().collect();
    let point = Point::new(p.to_vec(), values.clone(), None);
    let special = SpecialPoint {
        label: 1,
        kind: Kind::UZ,
        event: "history".into(),
        after: 0,
        parameters: p.to_vec(),
        monitors: values,
        unstable: None,
        undetermined: None,
        eigenvalues: Vec::new(),
        numbers: Vec::new(),
        sensitivities: Vec::new(),
        subkind: None,
        multiplicity: 1,
        error: 0.0,
        bracket: [p.first().copied().unwrap_or_default(); 2],
        converged: true,
        state: Vec::new(),
        tangent: vec![0.0; released.len()],
        slopes: None,
        mesh: Vec::new(),
        mesh_shift: Vec::new(),
        profiles: profiles(curves),
        fields: Vec::new(),
        without_phase_response: None,
    };
    Branch {
        name: name.into(),
        condition: None,
        itinerary: String::new(),
        method: String::new(),
        unknowns: Vec::new(),
        released,
        parameters,
        monitors,
        points: vec![point],
        special: vec![special],
        stretches: Vec::new(),
        ends: [End::Start, End::Start],
        warnings: Vec::new(),
        settings: Settings::default(),
    }
}

/// Returns the profiles of a history: the states as functions of time, and the phase portrait of
/// the first two states.
fn profiles(curves: &[Profile]) -> Vec<Profile> {
    let filled = curves.iter().filter(|curve| !curve.points.is_empty());
    let mut profiles: Vec<Profile> = filled.cloned().collect();
    if let [first, second, ..] = curves {
        profiles.push(portrait(first, second));
    }
    profiles
}

/// Returns the phase portrait of two states whose curves in time are given.
pub(super) fn portrait(first: &Profile, second: &Profile) -> Profile {
    // A mode without the second state (contact) is missing in the portrait.
    let value = |t: f64| second.points.iter().find(|q| q[0] >= t).map(|q| q[1]);
    let same = first.points.len() == second.points.len();
    let points = match same {
        true => first.points.iter().zip(&second.points).map(|(a, b)| [a[1], b[1]]).collect(),
        false => first.points.iter().filter_map(|a| Some([a[1], value(a[0])?])).collect(),
    };
    Profile { name: second.name.clone(), along: first.name.clone(), points }
}

//! The attractors of the motion at a point of a diagram in two parameters.

use super::pages::{Kept, Message};
use super::trouble::Trouble;
use crate::core::cancel::CancelToken;
use crate::core::problem::Profile;
use crate::scene::{Attracted, AttractorKind, Patience, Scene, SceneError};
use serde::{Deserialize, Serialize};
use serde_json::json;
use std::sync::mpsc::Sender;

/// The maximum number of points of a curve that is sent to the page.
const MOST: usize = 4_000;
/// Heuristic: two cycles or equilibria whose extents differ by less than this fraction of their size are
/// equal.
const EQUAL: f64 = 1e-3;
/// Heuristic: two motions that are not periodic count as equal if their extents differ by less than
/// this fraction of their size; the extents of such motions depend on the duration of the
/// simulation.
const SIMILAR: f64 = 0.2;
/// Heuristic: the size that is assumed for an equilibrium, in units of the scales of the states.
const AT_REST: f64 = 1e-2;
/// The name of the horizontal axis of motions with one state.
const TIME: &str = "time";

/// A state, by the names of its components.
type State = Vec<(String, f64)>;

/// A point of a diagram in two parameters, as sent by a page that shows the attractors there.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct Place {
    /// The values of the two parameters.
    at: Vec<(String, f64)>,
    /// The state at which the motion starts; empty for the initial state of the scene.
    from: State,
    /// The states on the axes of the phase portrait; by default the first two states.
    shown: [Option<String>; 2],
    /// Whether the search simulates long enough for a decision, and from several initial states.
    refined: bool,
}

/// An attractor, as it is sent to the page.
#[derive(Serialize)]
struct Shown<'a> {
    label: String,
    /// Whether the search has decided what the attractor is.
    certain: bool,
    /// Whether the attractor is one point.
    rests: bool,
    points: &'a [[f64; 2]],
    end: &'a State,
}

/// Sends the attractors at a point of a diagram in two parameters: the attractor that is reached
/// from the given state, and for a refined search also those reached from other initial states.
pub(super) fn attractors(
    kept: &Kept,
    place: &Place,
    (cancel, out): (&CancelToken, &Sender<Message>),
) {
    let found = match scene_at(kept, place, cancel) {
        Some(scene) => scene.and_then(|scene| search(&scene, kept, place, (cancel, out))),
        None => {
            let none = Trouble::plain("the diagram has no curve in these two parameters");
            let _ = out.send(Message::of(&json!({ "failed": none })));
            return;
        }
    };
    if let Err(cause) = found {
        let _ = out.send(Message::of(&json!({ "failed": Trouble::from(&cause) })));
    }
}

fn search(
    scene: &Scene,
    kept: &Kept,
    place: &Place,
    (cancel, out): (&CancelToken, &Sender<Message>),
) -> Result<(), SceneError> {
    let states = scene.sampling()?.states;
    let axes = axes(&states, &place.shown);
    let axes_message = json!({ "states": states, "shown": axes });
    let _ = out.send(Message::of(&axes_message));
    let initial = kept.scene.initial_states()?;
    let patience = if place.refined { Patience::Usual } else { Patience::Short };
    let first = if place.from.is_empty() { initial.clone() } else { place.from.clone() };
    let mut starts = vec![first];
    let mut known: Vec<Known> = Vec::new();
    let mut next = 0;
    while let Some(start) = starts.get(next) {
        let found = scene.attractor(start, patience)?;
        if cancel.is_cancelled() {
            return Ok(());
        }
        let curve = curve(&found, &axes);
        if next == 0 && place.refined {
            if !place.from.is_empty() {
                starts.push(initial.clone());
            }
            starts.extend(around(&initial, &found, &axes, &curve));
        }
        next += 1;
        let own = Known::of(&found, &axes, &curve);
        if known.iter().any(|known| known.is_equal(&own)) {
            continue;
        }
        let (certain, rests) = (is_certain(&found.kind), found.kind == AttractorKind::Equilibrium);
        let shown = Shown {
            label: found.kind.to_string(),
            certain,
            rests,
            points: &curve,
            end: &found.end,
        };
        let _ = out.send(Message::of(&json!({ "attractor": shown })));
        known.push(own);
    }
    let _ = out.send(Message::of(&json!({ "searched": { "starts": starts.len() } })));
    Ok(())
}

/// Returns the scene at a point of the plane of two parameters; the values of all other parameters
/// are taken from the curve of special points that is drawn in this plane. Returns `None` if the
/// plane does not contain such a curve.
fn scene_at(kept: &Kept, place: &Place, cancel: &CancelToken) -> Option<Result<Scene, SceneError>> {
    let branch = kept.document.branches.iter().find(|branch| {
        let released = |name: &String| branch.released.contains(name);
        branch.condition.is_some() && place.at.iter().all(|(name, _)| released(name))
    })?;
    Some(kept.alone(branch, &place.at, cancel))
}

/// Returns the quantities on the axes of the phase portrait: the chosen states, or by default the
/// first two states; for a motion with one state, the time and the state.
fn axes(states: &[String], chosen: &[Option<String>; 2]) -> [String; 2] {
    let usual = match states {
        [first, second, ..] => [first.clone(), second.clone()],
        [only] => [TIME.into(), only.clone()],
        [] => [TIME.into(), TIME.into()],
    };
    let known = |k: usize| chosen[k].clone().filter(|name| states.contains(name));
    [known(0).unwrap_or(usual[0].clone()), known(1).unwrap_or(usual[1].clone())]
}

/// Returns the curve of an attractor in the phase portrait, with a limited number of points.
fn curve(found: &Attracted, [x, y]: &[String; 2]) -> Vec<[f64; 2]> {
    let in_time = || found.curves.iter().find(|curve| curve.name == *y).cloned();
    let portrait: Option<Profile> = if x == TIME { in_time() } else { found.portrait(x, y) };
    let mut points = portrait.map_or(Vec::new(), |portrait| portrait.points);
    let every = points.len().div_ceil(MOST).max(1);
    let last = points.len().saturating_sub(1);
    let mut k = 0..;
    points.retain(|_| k.next().is_some_and(|k: usize| k.is_multiple_of(every) || k == last));
    points
}

/// Returns the lower and upper end of a curve on both axes.
fn extent(curve: &[[f64; 2]]) -> [[f64; 2]; 2] {
    [0, 1].map(|axis| {
        let values = || curve.iter().map(|at| at[axis]);
        [values().fold(f64::INFINITY, f64::min), values().fold(f64::NEG_INFINITY, f64::max)]
    })
}

/// Returns four initial states around a given state: each differs from the given state in one of
/// the two state variables of the phase portrait, upwards or downwards, by the size of the
/// attractor or the scale of the variable, whichever is larger.
fn around(
    initial: &State,
    found: &Attracted,
    axes: &[String; 2],
    curve: &[[f64; 2]],
) -> Vec<State> {
    let extent = extent(curve);
    let mut starts = Vec::new();
    for (axis, name) in axes.iter().enumerate() {
        let Some((_, scale)) = found.scales.iter().find(|(known, _)| known == name) else {
            continue;
        };
        let [low, high] = extent[axis];
        for distance in [(high - low).max(*scale), -(high - low).max(*scale)] {
            let mut start = initial.clone();
            match start.iter_mut().find(|(known, _)| known == name) {
                Some((_, value)) => *value += distance,
                None => start.push((name.clone(), distance)),
            }
            starts.push(start);
        }
    }
    starts
}

/// An attractor that has been found.
struct Known {
    kind: AttractorKind,
    extent: [[f64; 2]; 2],
    /// The scales of the quantities on the axes.
    scales: [f64; 2],
}

impl Known {
    fn of(found: &Attracted, axes: &[String; 2], curve: &[[f64; 2]]) -> Self {
        let scale = |axis: usize| found.scales.iter().find(|(name, _)| *name == axes[axis]);
        let scales = [0, 1].map(|axis| scale(axis).map_or(1.0, |(_, scale)| *scale));
        Known { kind: found.kind.clone(), extent: extent(curve), scales }
    }

    /// Returns whether two attractors are of the same kind and have nearly the same extents.
    fn is_equal(&self, other: &Known) -> bool {
        use AttractorKind::{Cycle, Equilibrium, Failed};
        let near = |a: f64, b: f64, tolerance: f64| (a - b).abs() <= tolerance;
        let (same, part) = match (&self.kind, &other.kind) {
            (Failed { reason }, Failed { reason: other }) => return reason == other,
            (
                Cycle { period, forcing_periods },
                Cycle { period: other, forcing_periods: others },
            ) => (forcing_periods == others && near(*period, *other, EQUAL * period), EQUAL),
            (Equilibrium, Equilibrium) => (true, EQUAL),
            (kind, other) => (kind == other, SIMILAR),
        };
        let close = |axis: usize| {
            let [a, b] = [self.extent[axis], other.extent[axis]];
            let size = (a[1] - a[0]).max(AT_REST * self.scales[axis]);
            (0..2).all(|end| near(a[end], b[end], part * size.max(EQUAL * a[end].abs())))
        };
        same && (0..2).all(close)
    }
}

/// Returns whether a search has decided what the attractor is.
fn is_certain(kind: &AttractorKind) -> bool {
    matches!(kind, AttractorKind::Equilibrium | AttractorKind::Cycle { .. })
}

//! The phase plane at a point: simulations from states that the user chooses, nullclines and
//! directions.

use super::pages::Kept;
use super::trouble::Trouble;
use crate::core::cancel::CancelToken;
use crate::core::continuation::Branch;
use crate::core::problem::Profile;
use crate::output::Bar;
use crate::scene::{PhaseSpace, Place};
use serde::{Deserialize, Serialize};
use std::time::Duration;

/// The maximum duration of a simulation, after which the server stops it.
pub(super) const LONGEST: Duration = Duration::from_secs(20);
/// The maximum number of values in all drawn rows of a history together, and the maximum number of
/// rows.
const VALUES: usize = 100_000;
const ROWS: usize = 4_000;
/// The distance between drawn states, as a fraction of the range of each state.
const FINE: f64 = 1.0 / 1500.0;
/// The margin at both ends of a state's range in the phase plane, as a fraction of the width of the
/// range.
const MARGIN: f64 = 0.25;

/// The relative size of a range that is zero to rounding error.
const ROUNDING: f64 = 1e-9;

/// A point of the last result of a page.
#[derive(Clone, Copy, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct Point {
    pub branch: usize,
    /// The index of the point, or the negative label of a special point.
    pub point: i64,
}

impl Point {
    /// Returns the place of the point on its branch.
    pub fn place(self) -> Option<Place> {
        match usize::try_from(self.point) {
            Ok(index) => Some(Place::Regular(index)),
            Err(_) => Some(Place::Special(usize::try_from(self.point.checked_neg()?).ok()?)),
        }
    }
}

/// The phase space at a point, as the page shows it.
#[derive(Serialize)]
pub(super) struct Plane {
    states: Vec<State>,
    duration: f64,
    /// The unit of durations in words.
    unit: &'static str,
    /// The mode in which simulations start, if there are several modes.
    mode: Option<String>,
    is_equilibrium: bool,
    /// Whether nullclines and directions can be drawn.
    has_field: bool,
}

/// A state with its value at the point, and its range in the phase plane.
#[derive(Serialize)]
struct State {
    name: String,
    value: f64,
    low: f64,
    high: f64,
}

/// Returns the phase space at a point; `None` if the problem has no motion, or if the states at the
/// point are not known.
pub(super) fn space(kept: &Kept, point: Point) -> Option<(&Branch, PhaseSpace)> {
    let branch = kept.document.branches.get(point.branch)?;
    let resolution = kept.scene.resolve(None).ok()?;
    let space = resolution.phase_space(branch, point.place()?)?;
    Some((branch, space))
}

/// Describes the phase space at a point.
pub(super) fn plane(kept: &Kept, point: Point) -> Option<Plane> {
    let (branch, space) = space(kept, point)?;
    let special = match point.place()? {
        Place::Regular(_) => None,
        Place::Special(label) => branch.labelled(label),
    };
    let profiles = special.map_or(&[][..], |special| &special.profiles);
    let state = |(name, value): &(String, f64)| {
        let [low, high] = range(branch, profiles, name, *value);
        State { name: name.clone(), value: *value, low, high }
    };
    Some(Plane {
        states: space.states.iter().map(state).collect(),
        duration: space.duration,
        unit: if space.is_forced() { "periods" } else { "units of time" },
        mode: space.first_mode(),
        is_equilibrium: space.is_equilibrium,
        has_field: space.is_plane(),
    })
}

/// Returns the range of a state in the phase plane: the range of its profile, or otherwise the range
/// of its values on the branch, with a margin, and extended so that the value at the point is not
/// near an end. The profile is not used if its range, compared with the range on the branch, is only
/// a rounding error.
fn range(branch: &Branch, profiles: &[Profile], name: &str, value: f64) -> [f64; 2] {
    let ends = |values: &mut dyn Iterator<Item = f64>| {
        let finite = values.filter(|value| value.is_finite());
        finite.fold([value; 2], |[low, high], value| [low.min(value), high.max(value)])
    };
    let columns = branch.columns_showing(name);
    let points = branch.points.iter();
    let on_branch =
        ends(&mut points.flat_map(|point| columns.iter().filter_map(|k| point.value(*k))));
    let own = profiles.iter().find(|it| it.name == name && it.points.len() > 1);
    let own = own.map(|profile| ends(&mut profile.points.iter().map(|point| point[1])));
    let width = |[low, high]: [f64; 2]| high - low;
    let [low, high] =
        own.filter(|it| width(*it) > ROUNDING * width(on_branch)).unwrap_or(on_branch);
    let least = if value == 0.0 { 1.0 } else { value.abs() };
    let width = if high - low > 1e-6 * least { high - low } else { 2.0 * least };
    let margin = MARGIN * width;
    [low.min(value - width / 2.0) - margin, high.max(value + width / 2.0) + margin]
}

/// The vector field in the plane of two states.
#[derive(Serialize)]
pub(super) struct Field {
    /// The lines on which the rate of each of the two states is zero.
    nullclines: [Vec<Vec<[f64; 2]>>; 2],
    /// Points of the plane, each with the direction of the vector field in units of the ranges.
    arrows: Vec<[[f64; 2]; 2]>,
}

/// Returns the vector field in a rectangle of the plane of two states.
pub(super) fn field(
    kept: &Kept,
    point: Point,
    (names, ranges): ([String; 2], [[f64; 2]; 2]),
) -> Result<Field, Trouble> {
    let (_, space) = space(kept, point).ok_or_else(|| Trouble::plain(NO_SPACE))?;
    let index = |name: &String| space.states.iter().position(|(known, _)| known == name);
    let fits = |[low, high]: &[f64; 2]| low < high && (high - low).is_finite();
    match [index(&names[0]), index(&names[1])] {
        [Some(x), Some(y)] if x != y && space.is_plane() && ranges.iter().all(fits) => Ok(Field {
            nullclines: space.nullclines([x, y], ranges),
            arrows: space.directions([x, y], ranges),
        }),
        _ => Err(Trouble::plain("the vector field cannot be drawn in this plane")),
    }
}

/// The error for a point that has no phase space.
const NO_SPACE: &str = "the states at the point are not known, or the problem has no motion";

/// A simulated history, as it is sent to the page.
#[derive(Serialize)]
pub(super) struct Simulated {
    /// The names of the states.
    states: Vec<String>,
    /// The time and the states, row by row; a state that a mode does not have is `null`.
    rows: Vec<Vec<Option<f64>>>,
    /// Whether rows that matter for the picture are omitted.
    is_thinned: bool,
}

/// Simulates from a state at the parameters of a point; returns the history for the page, and the
/// branch with the extremes of all states.
pub(super) fn simulate(
    kept: &Kept,
    point: Point,
    start: (Vec<(String, f64)>, f64),
    cancel: &CancelToken,
) -> Result<(Simulated, Branch), Trouble> {
    let (_, space) = space(kept, point).ok_or_else(|| Trouble::plain(NO_SPACE))?;
    if start.1.is_nan() || start.1 <= 0.0 {
        return Err(Trouble::plain("the duration of a simulation must be above 0"));
    }
    let resolution = space
        .simulation((*kept.scene).clone(), start, cancel)
        .and_then(|scene| scene.resolve(None))
        .map_err(|cause| Trouble::from(&cause))?;
    let mut outcome = resolution.trace(&mut ());
    if cancel.is_cancelled() {
        let seconds = LONGEST.as_secs();
        let message = format!("the simulation was stopped after {seconds} s: shorten its duration");
        return Err(Trouble::plain(message));
    }
    if let Some(cause) = outcome.error {
        return Err(Trouble::from(&cause).without_run());
    }
    let Some(mut history) = outcome.document.branches.pop() else {
        return Err(Trouble::plain("the simulation has no history"));
    };
    let profiles: Vec<Profile> =
        history.special.drain(..).flat_map(|special| special.profiles).collect();
    let (states, rows, is_complete) = table(&profiles);
    let (rows, is_thinned) = drawn(rows);
    let is_thinned = is_thinned || !is_complete;
    Ok((Simulated { states, rows, is_thinned }, history))
}

/// A time and the states at this time.
type Row = Vec<Option<f64>>;

/// Returns the names of the states in time histories, the rows of times and states, and whether the
/// rows contain all values; a state that has no value at a time is `None`. The times are the times of
/// the longest history.
fn table(profiles: &[Profile]) -> (Vec<String>, Vec<Row>, bool) {
    let histories: Vec<&Profile> = profiles.iter().filter(|it| it.along == "time").collect();
    let names = histories.iter().map(|it| it.name.clone()).collect();
    let longest = histories.iter().map(|it| &it.points[..]).max_by_key(|points| points.len());
    let (mut next, mut taken) = (vec![0; histories.len()], 0);
    let row = |[time, _]: &[f64; 2]| {
        let mut row = vec![Some(*time)];
        for (history, next) in histories.iter().zip(&mut next) {
            let points = &history.points;
            while points.get(*next).is_some_and(|point| point[0] < *time) {
                *next += 1;
            }
            let here = points.get(*next).filter(|point| point[0] == *time);
            row.push(here.map(|point| point[1]));
            *next += usize::from(here.is_some());
            taken += usize::from(here.is_some());
        }
        row
    };
    let rows = longest.unwrap_or_default().iter().map(row).collect();
    (names, rows, taken == histories.iter().map(|it| it.points.len()).sum::<usize>())
}

/// Returns the rows that a picture needs, and whether rows that matter for the picture are omitted.
fn drawn(rows: Vec<Row>) -> (Vec<Row>, bool) {
    let columns = rows.first().map_or(0, Vec::len);
    let mut ranges = vec![[f64::INFINITY, f64::NEG_INFINITY]; columns];
    for row in &rows {
        for ([low, high], value) in ranges.iter_mut().zip(row) {
            (*low, *high) = value.map_or((*low, *high), |it| (low.min(it), high.max(it)));
        }
    }
    let moved = |from: &Row, to: &Row| {
        let pairs = from.iter().zip(to).zip(&ranges);
        pairs.into_iter().any(|((from, to), [low, high])| match (from, to) {
            (Some(from), Some(to)) => (to - from).abs() > FINE * (high - low),
            _ => from != to,
        })
    };
    let last = rows.len().saturating_sub(1);
    let mut kept: Vec<Row> = Vec::new();
    for (k, row) in rows.into_iter().enumerate() {
        let is_next = kept.last().is_none_or(|from| moved(from, &row));
        if is_next || k == last {
            kept.push(row);
        }
    }
    let most = (VALUES / columns.max(1)).clamp(2, ROWS);
    let every = kept.len().div_ceil(most).max(1);
    let last = kept.len().saturating_sub(1);
    let numbered = kept.into_iter().enumerate();
    let thinned = numbered.filter(|(k, _)| k % every == 0 || *k == last);
    (thinned.map(|(_, row)| row).collect(), every > 1)
}

/// The range of a history over the diagram, with the number of its simulation.
#[derive(Serialize)]
pub(super) struct NumberedBar {
    number: u64,
    #[serde(flatten)]
    bar: Bar,
}

/// Returns the ranges of the simulated histories over the first diagram of a result.
pub(super) fn bars(kept: &Kept) -> Vec<NumberedBar> {
    let axes = [kept.axes[0].as_deref(), kept.axes[1].as_deref()];
    let histories = kept.histories.iter();
    let bars = histories.filter_map(|(number, history)| {
        let bar = Bar::of(history, &kept.document, axes)?;
        Some(NumberedBar { number: *number, bar })
    });
    bars.collect()
}

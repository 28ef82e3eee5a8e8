//! The tables of a sweep: a table with one row for each run, and a table with one row for each
//! recorded point.

use crate::core::attractor::{Attractor, EventRecord, Layout, Period};
use crate::core::hybrid::{HybridState, Mode};
use crate::core::problem::distinct;
use crate::core::sweep::Found;
use crate::output::Plot;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;

/// The format tag of files with sweeps, which contains the version of the format.
pub const SWEEPS: &str = "tangency-sweeps/2";

/// The sweeps of a scene, with the results of all finished runs.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Sweeps {
    /// Always [`SWEEPS`].
    pub format: String,
    /// The name of the scene.
    pub name: String,
    /// The title of the scene, in words.
    pub title: String,
    /// The complete text of the scene, with all settings; sweeps with the same text can be resumed
    /// and merged.
    pub scene: String,
    /// The default plot.
    pub plot: Plot,
    /// The sweeps of the scene; their names are unique.
    pub sweeps: Vec<SweepTable>,
}

/// The results of a run, as a row of numbers.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Row {
    /// The values of the run in the columns of the table of runs.
    pub values: Vec<f64>,
    /// The numbers in the columns of points, for all recorded points of the run, one point after
    /// another.
    pub points: Vec<f64>,
    /// The reason for the failure of the run, if it failed.
    pub failure: Option<String>,
}

impl Row {
    /// Returns whether two rows contain the same numbers, bit by bit; missing numbers are NaN.
    pub(super) fn is_identical(&self, other: &Row) -> bool {
        let bits = |numbers: &[f64]| numbers.iter().map(|x| x.to_bits()).collect::<Vec<_>>();
        let both = |row: &Row| (bits(&row.values), bits(&row.points));
        both(self) == both(other) && self.failure == other.failure
    }
}

/// The results of a sweep as tables.
///
/// The columns of a run are its number `run` and the number of its `start`; the values on the axes;
/// in a search for a crisis, the parameter value at the crisis, under the name of the parameter,
/// and `crisis_error`; the number of `periods` in its cycle (0 if the attractor is not a cycle);
/// for every event by name, the number of occurrences in a cycle (or in a period, if the attractor
/// is not a cycle), and the number of `accumulations` of infinitely many events; `exponent` and
/// `exponent_error`; `failed` (1 or 0); and the final state, as `end_mode`, `end_0`, `end_1`, ….
///
/// A row of the table of points describes either the beginning of a period (`event` is 0) or an
/// event (`event` is the number of the event, counted from 1, in the order of the columns of runs).
/// The columns of a point are the number of its `run`, the number of its `period`, its `event`, its
/// `time` in the period, all states by name, and, at the beginning of a period, the measures of the
/// period. Missing values in the tables are NaN.
///
/// This type serializes only names and failures; the numbers are stored as separate columns in the
/// file.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct SweepTable {
    /// The name of the sweep.
    pub name: String,
    /// The names of the quantities on the axes of the sweep.
    pub axes: Vec<String>,
    /// The names of the events that are recorded.
    pub events: Vec<String>,
    /// The total number of runs of the sweep.
    pub total: usize,
    /// The names of the columns in the table of runs.
    #[serde(rename = "runs")]
    pub run_columns: Vec<String>,
    /// The names of the columns in the table of recorded points.
    #[serde(rename = "points")]
    pub point_columns: Vec<String>,
    /// The rows of the finished runs, by run number.
    #[serde(rename = "failures", with = "failures")]
    pub rows: BTreeMap<usize, Row>,
}

/// Serializes only the failures in the rows, without their numbers.
mod failures {
    use super::{BTreeMap, Row};
    use serde::{Deserialize, Deserializer, Serialize, Serializer};

    type Rows = BTreeMap<usize, Row>;

    pub fn serialize<S: Serializer>(rows: &Rows, serializer: S) -> Result<S::Ok, S::Error> {
        let failed = rows.iter().filter_map(|(run, row)| Some((run, row.failure.as_ref()?)));
        failed.collect::<Vec<_>>().serialize(serializer)
    }

    pub fn deserialize<'de, D: Deserializer<'de>>(deserializer: D) -> Result<Rows, D::Error> {
        let failed = Vec::<(usize, String)>::deserialize(deserializer)?.into_iter();
        Ok(failed.map(|(run, why)| (run, Row { failure: Some(why), ..Row::default() })).collect())
    }
}

/// The name of the column with half the width of the parameter interval that contains a crisis;
/// this column follows the column with the middle of the interval.
const CRISIS_ERROR: &str = "crisis_error";

fn all_states(modes: &[Mode]) -> Vec<&str> {
    distinct(modes.iter().flat_map(|mode| &mode.states))
}

/// The columns of the table of points that precede the columns of the states.
const BEFORE_STATES: [&str; 4] = ["run", "period", "event", "time"];

impl SweepTable {
    /// Returns the name of the column of the table of points that contains the first state.
    pub(in crate::output) fn first_state(&self) -> Option<&str> {
        self.point_columns.get(BEFORE_STATES.len()).map(String::as_str)
    }

    /// Creates an empty table for a sweep, given the axes of the sweep, the parameter in which
    /// crises are searched (if any), and the modes and events of the motion.
    pub fn new(
        name: &str,
        (axes, crisis): (&[String], Option<&str>),
        total: usize,
        layout: &Layout,
    ) -> Self {
        let Layout { modes, events, measures } = layout;
        let own = |names: &[&str]| names.iter().map(|name| name.to_string()).collect::<Vec<_>>();
        let longest = modes.iter().map(|mode| mode.states.len()).max().unwrap_or(0);
        let mut run_columns = own(&["run", "start"]);
        run_columns.extend_from_slice(axes);
        run_columns.extend(crisis.into_iter().flat_map(|name| own(&[name, CRISIS_ERROR])));
        run_columns.push("periods".into());
        run_columns.extend_from_slice(events);
        let results = ["accumulations", "exponent", "exponent_error", "failed", "end_mode"];
        run_columns.extend(own(&results));
        run_columns.extend((0..longest).map(|k| format!("end_{k}")));
        let mut point_columns = own(&BEFORE_STATES);
        point_columns.extend(own(&all_states(modes)));
        point_columns.extend_from_slice(measures);
        SweepTable {
            name: name.into(),
            axes: axes.to_vec(),
            events: events.clone(),
            total,
            run_columns,
            point_columns,
            rows: BTreeMap::new(),
        }
    }

    /// Returns the position of a column among the columns of the table of runs.
    pub(super) fn run_column(&self, name: &str) -> Option<usize> {
        self.run_columns.iter().position(|known| known == name)
    }

    /// Returns the name of the parameter in which each run searches for a crisis, if any.
    pub fn crisis(&self) -> Option<&str> {
        let error = self.run_column(CRISIS_ERROR)?;
        self.run_columns.get(error.checked_sub(1)?).map(String::as_str)
    }

    /// Returns the number of runs that did not settle on a cycle, although no positive Lyapunov
    /// exponent shows that the motion is chaotic. A run that searches for a crisis does not count.
    pub fn unsettled(&self) -> usize {
        if self.crisis().is_some() {
            return 0;
        }
        let value =
            |row: &Row, name: &str| self.run_column(name).map_or(f64::NAN, |k| row.values[k]);
        let unsettled = |row: &&Row| {
            let chaotic = value(row, "exponent") > value(row, "exponent_error");
            row.failure.is_none() && value(row, "periods") == 0.0 && !chaotic
        };
        self.rows.values().filter(unsettled).count()
    }

    /// Returns whether all runs of the sweep are finished.
    pub fn is_complete(&self) -> bool {
        self.rows.len() == self.total
    }

    /// Adds the results of a finished run to the table.
    pub fn push(&mut self, found: &Found, start: usize, modes: &[Mode]) {
        let states = all_states(modes).len();
        let attractor = found.attractor.as_ref();
        let row = Row {
            values: self.values(found, start),
            points: attractor.map_or(Vec::new(), |a| points(found.run, a, modes, states)),
            failure: attractor.err().map(ToString::to_string),
        };
        self.rows.insert(found.run, row);
    }

    fn values(&self, found: &Found, start: usize) -> Vec<f64> {
        let mut values = vec![found.run as f64, start as f64];
        values.extend_from_slice(&found.values);
        if let Ok(attractor) = &found.attractor {
            let crisis = found.crisis.iter();
            values.extend(crisis.flat_map(|[a, b]| [0.5 * (a + b), 0.5 * (a - b).abs()]));
            values.push(attractor.periods.unwrap_or(0) as f64);
            values.extend(attractor.events.iter().map(|(_, count)| *count));
            values.push(attractor.accumulations);
            values.extend(attractor.exponent.map_or([f64::NAN; 2], |e| [e.value, e.error]));
            values.extend([0.0, attractor.end.mode as f64]);
            values.extend_from_slice(&attractor.end.x);
        }
        values.resize(self.run_columns.len(), f64::NAN);
        if let (Some(failed), Err(_)) = (self.run_column("failed"), &found.attractor) {
            values[failed] = 1.0;
        }
        values
    }

    /// Returns the final state of a finished run, with the given time as its time. The outer option
    /// is `None` if the run is not finished, the inner option is `None` if the run failed.
    pub fn end(&self, run: usize, time: f64, modes: &[Mode]) -> Option<Option<HybridState<f64>>> {
        let row = self.rows.get(&run)?;
        let first = self.run_column("end_mode")?;
        if row.failure.is_some() {
            return Some(None);
        }
        let mode = row.values[first] as usize;
        let length = modes.get(mode)?.states.len();
        let x = row.values[first + 1..first + 1 + length].to_vec();
        Some(Some(HybridState { mode, time, x }))
    }
}

/// Returns all recorded points of a run, one after another.
fn points(run: usize, attractor: &Attractor, modes: &[Mode], states: usize) -> Vec<f64> {
    let names = all_states(modes);
    let mut points = Vec::new();
    let mut put = |[period, event, time]: [f64; 3], state: &HybridState<f64>, measures: &[f64]| {
        points.extend([run as f64, period, event, time]);
        let first = points.len();
        points.resize(first + states, f64::NAN);
        for (name, value) in modes[state.mode].states.iter().zip(&state.x) {
            if let Some(k) = names.iter().position(|known| known == name) {
                points[first + k] = *value;
            }
        }
        points.extend_from_slice(measures);
    };
    let nothing = vec![f64::NAN; attractor.records.first().map_or(0, |p| p.measures.len())];
    for (period, Period { start, events, measures }) in attractor.records.iter().enumerate() {
        put([period as f64, 0.0, 0.0], start, measures);
        for EventRecord { event, time, before, .. } in events {
            put([period as f64, (event + 1) as f64, *time], before, &nothing);
        }
    }
    points
}

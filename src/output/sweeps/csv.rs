//! Writes sweeps as comma-separated values.

use super::table::{Row, SweepTable, Sweeps};
use crate::core::problem::distinct;
use crate::output::number::significant;
use crate::output::table::{Csv, quoted};

/// The first columns of the table of points; they identify a point.
const PLACE: [&str; 4] = ["run", "period", "event", "time"];

/// The columns of the table of runs that the table of points does not repeat, except for the columns
/// of the final state.
const OF_RUNS_ALONE: [&str; 3] = ["run", "start", "failed"];

/// Writes the attractors of sweeps as comma-separated values: for each recorded point, the `sweep`,
/// the number of the `run`, the values on all axes (`start NAME` for a state), the number of the
/// `period`, the `event` by name (empty at the beginning of a period), the `time` in the period,
/// all states, the measures, and the results of the whole run: a crisis, if the run searches for
/// one, the number of `periods` of the cycle, the number of occurrences of each event, the
/// `accumulations`, `exponent` and `exponent_error`. A result of the run is named `run NAME` if a
/// state or measure has the same name. A failed run without points is written as one row with its
/// `failure`. Numbers have 15 significant digits; a cell is empty if a sweep does not contain the
/// column.
pub(in crate::output) fn csv(sweeps: &[Sweeps]) -> String {
    let tables: Vec<&SweepTable> = sweeps.iter().flat_map(|sweeps| &sweeps.sweeps).collect();
    let axes = distinct(tables.iter().flat_map(|table| &table.axes));
    let mut points = distinct(tables.iter().flat_map(|table| &table.point_columns));
    points.retain(|name| !PLACE.contains(name));
    let results = distinct(tables.iter().flat_map(|table| table.results()));
    let title = |word: &str, name: &&str| match points.contains(name) {
        true => format!("{word} {name}"),
        false => (*name).to_owned(),
    };
    // A state may be an axis, by its initial value.
    let first: Vec<String> = axes.iter().map(|axis| title("start", axis)).collect();
    let last: Vec<String> = results.iter().map(|result| title("run", result)).collect();
    let [first, last] = [&first, &last].map(|all| all.iter().map(String::as_str));
    let first: Vec<&str> = first.collect();
    let others: Vec<&str> = PLACE[1..].iter().chain(&points).copied().chain(last).collect();
    let mut csv = Csv::new(&["sweep", PLACE[0]], &first, &others, &["failure"]);
    let columns = Columns { axes, points, results };
    for table in tables {
        for (run, row) in &table.rows {
            table.write(&mut csv, (*run, row), &columns);
        }
    }
    csv.0
}

/// The columns of the table of points.
struct Columns<'a> {
    axes: Vec<&'a str>,
    /// The states and measures of a point.
    points: Vec<&'a str>,
    /// The results of the run to which a point belongs.
    results: Vec<&'a str>,
}

impl SweepTable {
    /// Returns the columns of runs that contain results of a run.
    fn results(&self) -> impl Iterator<Item = &String> {
        let end = self.run_column("end_mode").unwrap_or(self.run_columns.len());
        self.run_columns[..end]
            .iter()
            .filter(|name| !OF_RUNS_ALONE.contains(&name.as_str()) && !self.axes.contains(name))
    }

    /// Writes the recorded points of a run.
    fn write(&self, csv: &mut Csv, (run, row): (usize, &Row), columns: &Columns) {
        let number = |value: Option<f64>| match value {
            Some(value) if !value.is_nan() => significant(value, 15),
            _ => String::new(),
        };
        let of_run =
            |column: Option<usize>| number(column.and_then(|k| row.values.get(k)).copied());
        let on_axis = |axis: &&str| {
            let own = self.axes.iter().any(|own| own == axis);
            of_run(self.run_column(axis).filter(|_| own))
        };
        let result = |name: &&str| {
            let own = self.results().any(|own| own == name);
            of_run(self.run_column(name).filter(|_| own))
        };
        let first: Vec<String> = [quoted(&self.name), run.to_string()]
            .into_iter()
            .chain(columns.axes.iter().map(on_axis))
            .collect();
        let failure = row.failure.as_deref().map_or(String::new(), quoted);
        let last: Vec<String> = columns.results.iter().map(result).chain([failure]).collect();
        let width = self.point_columns.len();
        if row.points.len() < width {
            let empty = vec![String::new(); PLACE.len() - 1 + columns.points.len()];
            csv.row(first.into_iter().chain(empty).chain(last));
            return;
        }
        for point in row.points.chunks_exact(width) {
            let value = |name: &str| {
                let column = self.point_columns.iter().position(|known| known == name)?;
                point.get(column).copied()
            };
            let event = value(PLACE[2]).filter(|event| *event >= 1.0);
            let event = event.and_then(|event| self.events.get(event as usize - 1));
            let place = [number(value(PLACE[1])), event.map_or(String::new(), |it| quoted(it))];
            let others = [PLACE[3]].into_iter().chain(columns.points.iter().copied());
            let others = others.map(|name| number(value(name)));
            csv.row(first.iter().cloned().chain(place).chain(others).chain(last.iter().cloned()));
        }
    }
}

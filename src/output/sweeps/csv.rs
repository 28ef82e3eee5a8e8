//! Writes sweeps as comma-separated values.

use super::table::{Row, SweepTable, Sweeps};
use crate::core::problem::distinct;
use crate::output::number::significant;
use crate::output::table::{Csv, quoted};

/// The first columns of the table of points; they identify a point.
const PLACE: [&str; 4] = ["run", "period", "event", "time"];

/// Writes the attractors of sweeps as comma-separated values: for each recorded point, the `sweep`,
/// the number of the `run`, the values on all axes (`start NAME` for a state), the number of the
/// `period`, the `event` by name (empty at the beginning of a period), the `time` in the period,
/// all states, and the measures. A failed run without points is written as one row with its
/// `failure`. Numbers have 15 significant digits; a cell is empty if a sweep does not contain the
/// column.
pub(in crate::output) fn csv(sweeps: &[Sweeps]) -> String {
    let tables: Vec<&SweepTable> = sweeps.iter().flat_map(|sweeps| &sweeps.sweeps).collect();
    let axes = distinct(tables.iter().flat_map(|table| &table.axes));
    let mut columns = distinct(tables.iter().flat_map(|table| &table.point_columns));
    columns.retain(|name| !PLACE.contains(name));
    // A state may be an axis, by its initial value.
    let title = |axis: &&str| match columns.contains(axis) {
        true => format!("start {axis}"),
        false => (*axis).to_owned(),
    };
    let titles: Vec<String> = axes.iter().map(title).collect();
    let titles: Vec<&str> = titles.iter().map(String::as_str).collect();
    let mut csv =
        Csv::new(&["sweep", PLACE[0]], &titles, &[&PLACE[1..], &columns].concat(), &["failure"]);
    for table in tables {
        for (run, row) in &table.rows {
            table.write(&mut csv, (*run, row), &axes, &columns);
        }
    }
    csv.0
}

impl SweepTable {
    /// Writes the recorded points of a run.
    fn write(&self, csv: &mut Csv, (run, row): (usize, &Row), axes: &[&str], columns: &[&str]) {
        let number = |value: Option<f64>| match value {
            Some(value) if !value.is_nan() => significant(value, 15),
            _ => String::new(),
        };
        let on_axis = |axis: &&str| {
            let own = self.axes.iter().any(|own| own == axis);
            let column = self.run_column(axis).filter(|_| own);
            number(column.and_then(|k| row.values.get(k)).copied())
        };
        let first: Vec<String> = [quoted(&self.name), run.to_string()]
            .into_iter()
            .chain(axes.iter().map(on_axis))
            .collect();
        let failure = row.failure.as_deref().map_or(String::new(), quoted);
        let width = self.point_columns.len();
        if row.points.len() < width {
            let empty = vec![String::new(); PLACE.len() - 1 + columns.len()];
            csv.row(first.into_iter().chain(empty).chain([failure]));
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
            let others = [PLACE[3]].into_iter().chain(columns.iter().copied());
            let others = others.map(|name| number(value(name)));
            csv.row(first.iter().cloned().chain(place).chain(others).chain([failure.clone()]));
        }
    }
}

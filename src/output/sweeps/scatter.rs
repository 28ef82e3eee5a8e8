//! Figures of sweeps: the points of the attractors, and basins of attraction.

use super::table::{Row, SweepTable};
use crate::output::figure::{Origin, Series, Style};
use crate::output::tile::{Hue, Tile, spacing};

/// The table from which the numbers in a column of a sweep are taken.
enum Source {
    /// The column contains one number for each run.
    Run(usize),
    /// The column contains one number for each point at the beginning of a period.
    Period(usize),
    /// The column contains one number for each occurrence of the event with this index.
    Event(usize, f64),
}

impl SweepTable {
    /// Returns the source of a column; the column is a column of runs, a column of points, or, in
    /// the form `EVENT.STATE`, a state at all events of one kind.
    fn source(&self, name: &str) -> Option<Source> {
        if let Some((event, state)) = name.split_once('.') {
            let number = self.events.iter().position(|known| known == event)?;
            let column = self.point_columns.iter().position(|known| known == state)?;
            return Some(Source::Event(column, (number + 1) as f64));
        }
        let point = || self.point_columns.iter().position(|known| known == name);
        self.run_column(name).map(Source::Run).or_else(|| point().map(Source::Period))
    }

    /// Returns whether the runs, points or events of the sweep have a column with this name.
    pub(crate) fn has_column(&self, name: &str) -> bool {
        self.source(name).is_some()
    }

    /// Describes the type of the attractor of a run.
    fn kind(&self, row: &Row) -> String {
        let value = |name: &str| self.run_column(name).map_or(f64::NAN, |k| row.values[k]);
        if row.failure.is_some() {
            return "failed".into();
        }
        if value("periods") == 0.0 {
            return "no cycle".into();
        }
        let counts = self.events.iter().map(|event| (event, value(event)));
        let seen: Vec<String> =
            counts.filter(|(_, n)| *n > 0.0).map(|(event, n)| format!("{n:.0} {event}")).collect();
        let events = if seen.is_empty() { "no events".into() } else { seen.join(", ") };
        match value("periods") {
            1.0 => format!("{events} in a period"),
            periods => format!("{events} in {periods} periods"),
        }
    }

    /// Returns the coordinates on two axes of the points recorded in a run.
    fn pairs(&self, row: &Row, x: &Source, y: &Source) -> Vec<[f64; 2]> {
        if let (Source::Run(x), Source::Run(y)) = (x, y) {
            return vec![[row.values[*x], row.values[*y]]];
        }
        const EVENT: usize = 2;
        let kind = match (x, y) {
            (Source::Event(_, number), _) | (_, Source::Event(_, number)) => *number,
            _ => 0.0,
        };
        let points = row.points.chunks(self.point_columns.len());
        let value = |source: &Source, point: &[f64]| match source {
            Source::Run(k) => row.values[*k],
            Source::Period(k) | Source::Event(k, _) => point[*k],
        };
        points.filter(|p| p[EVENT] == kind).map(|p| [value(x, p), value(y, p)]).collect()
    }
}

/// Returns the points of a sweep in the plane of two columns; empty if the sweep does not contain
/// both columns.
pub(in crate::output) fn scatter(sweep: &SweepTable, x: &str, y: &str) -> Vec<Series> {
    let (Some(from), Some(to)) = (sweep.source(x), sweep.source(y)) else { return Vec::new() };
    // Each run has one crisis.
    let crises = sweep.crisis().is_some_and(|crisis| [x, y].contains(&crisis));
    let style = if crises { Style::Dots } else { Style::Specks };
    let points = sweep.rows.iter().flat_map(|(run, row)| {
        sweep.pairs(row, &from, &to).into_iter().map(|at| (at, Origin::Run(*run)))
    });
    let finite = points.filter(|(at, _)| at.iter().all(|value| value.is_finite()));
    let series = Series::with_origins(sweep.name.clone(), style, finite);
    if sweep.rows.is_empty() { Vec::new() } else { vec![series] }
}

/// The colours of attractors, in the order in which the attractors occur.
const HUES: [Hue; 4] = [Hue::Blue, Hue::Yellow, Hue::Green, Hue::Red];

/// Returns the basins of attraction on a grid over the values of two columns: each run gives one
/// tile, coloured by the type of the run's attractor; the result is empty if the axes of the sweep
/// are other columns.
pub(in crate::output) fn basins(sweep: &SweepTable, x: &str, y: &str) -> Vec<Tile> {
    let grid = x != y && [x, y].iter().all(|name| sweep.axes.iter().any(|axis| axis == name));
    let (true, Some(Source::Run(x)), Some(Source::Run(y))) =
        (grid, sweep.source(x), sweep.source(y))
    else {
        return Vec::new();
    };
    let values = |column: usize| sweep.rows.values().map(move |row| row.values[column]);
    let [Some(width), Some(height)] = [spacing(values(x)), spacing(values(y))] else {
        return Vec::new();
    };
    let mut kinds: Vec<String> = Vec::new();
    let mut tiles: Vec<Tile> = Vec::new();
    for row in sweep.rows.values() {
        let meaning = sweep.kind(row);
        let number = kinds.iter().position(|kind| *kind == meaning).unwrap_or(kinds.len());
        if number == kinds.len() {
            kinds.push(meaning.clone());
        }
        let (hue, shade) = (HUES[number % HUES.len()], number / HUES.len());
        let (at, size) = ([row.values[x], row.values[y]], [width, height]);
        Tile { at, size, hue, shade, meaning }.add_to(&mut tiles, 1);
    }
    tiles
}

//! Computation of robustness maps: a method runs at every place of a grid.

use crate::{Cell, Class, Outcome, Region, RobustnessMap, Tried};
use std::fmt::Display;

/// The outcome of a method at one place of the grid.
#[derive(Clone, Debug)]
pub(super) struct Found {
    pub class: Class,
    name: &'static str,
    message: Option<String>,
}

impl Found {
    /// Creates the outcome of a method whose result is correct.
    pub fn right(name: &'static str) -> Self {
        Found { class: Class::Right, name, message: None }
    }

    /// Creates the outcome of a method that handed over to another method, whose result is correct.
    pub fn handed_over(name: &'static str) -> Self {
        Found { class: Class::HandedOver, name, message: None }
    }

    /// Creates the outcome of a method that reports a failure and its cause.
    pub fn reported(name: &'static str, why: impl Display) -> Self {
        Found { class: Class::Reported, name, message: Some(why.to_string()) }
    }

    /// Creates the outcome of a method whose result is wrong and that reports no failure.
    pub fn silent(name: &'static str) -> Self {
        Found { class: Class::Silent, name, message: None }
    }
}

/// Returns `count` equidistant values from `low` to `high`, both included.
pub(super) fn from_to(low: f64, high: f64, count: usize) -> Vec<f64> {
    let parts = (count - 1).max(1) as f64;
    (0..count).map(|k| low + (high - low) * k as f64 / parts).collect()
}

/// A method with its outcomes at all grid points; a finished map stores each outcome as an index
/// instead.
struct Attempt {
    name: String,
    naive: bool,
    places: Vec<([f64; 2], Found)>,
}

/// A panel under construction.
pub(super) struct Panel {
    title: String,
    labels: [String; 2],
    attempts: Vec<Attempt>,
}

impl Panel {
    /// Creates a panel with its title and the labels of its two axes.
    pub fn new(title: &str, x: &str, y: &str) -> Self {
        Panel { title: title.into(), labels: [x.into(), y.into()], attempts: Vec::new() }
    }

    /// Creates a panel of a single method, titled with the method's name.
    pub fn of(
        (name, naive): (&str, bool),
        [x, y]: [&str; 2],
        places: [&[f64]; 2],
        method: impl FnMut(f64, f64) -> Found,
    ) -> Self {
        Panel::new(name, x, y).over((name, naive), places, method)
    }

    /// Runs a method at every place of the panel's grid.
    pub fn over(
        mut self,
        (name, naive): (&str, bool),
        [xs, ys]: [&[f64]; 2],
        mut method: impl FnMut(f64, f64) -> Found,
    ) -> Self {
        let places = ys.iter().flat_map(|y| xs.iter().map(move |x| [*x, *y]));
        let places = places.map(|[x, y]| ([x, y], method(x, y))).collect();
        self.attempts.push(Attempt { name: name.into(), naive, places });
        self
    }

    /// Runs a method at every value of the panel's horizontal quantity, and adds the outcomes to
    /// the panel as a separate row.
    pub fn row(self, name: (&str, bool), xs: &[f64], mut method: impl FnMut(f64) -> Found) -> Self {
        let y = [self.attempts.len() as f64];
        self.over(name, [xs, &y], |x, _| method(x))
    }
}

/// Returns the robustness map that consists of the given panels.
pub(super) fn map(name: &str, panels: Vec<Panel>) -> RobustnessMap {
    let found = panels.iter().flat_map(|panel| &panel.attempts).flat_map(|a| &a.places);
    let mut outcomes: Vec<Outcome> = Vec::new();
    for (_, Found { class, name, .. }) in found {
        let outcome = Outcome { name: (*name).into(), class: *class };
        if !outcomes.contains(&outcome) {
            outcomes.push(outcome);
        }
    }
    outcomes.sort_by_key(|outcome| outcome.class);
    let region = |panel: Panel| {
        let [x, y] = panel.labels;
        let methods = panel.attempts.into_iter().map(|attempt| tried(attempt, &outcomes));
        Region { title: panel.title, x, y, methods: methods.collect() }
    };
    let panels = panels.into_iter().map(region).collect();
    RobustnessMap {
        name: format!("robustness-{name}"),
        panels,
        outcomes,
        ..RobustnessMap::default()
    }
}

/// Converts the outcomes of a method to indices in the map's list of outcomes; of each outcome,
/// only the first error message is kept.
fn tried(attempt: Attempt, outcomes: &[Outcome]) -> Tried {
    let mut cells: Vec<Cell> = Vec::new();
    for ([x, y], Found { class, name, message }) in attempt.places {
        let known = |outcome: &Outcome| outcome.name == name && outcome.class == class;
        let outcome = outcomes.iter().position(known).unwrap_or(0);
        let first = cells.iter().all(|cell| cell.outcome != outcome);
        cells.push(Cell { x, y, outcome, message: message.filter(|_| first) });
    }
    Tried { name: attempt.name, naive: attempt.naive, cells }
}

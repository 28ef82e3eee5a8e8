//! Robustness maps: the outcomes of methods on a grid of two quantities, as data (RON), as tables
//! (Markdown) and as figures (SVG).

use super::report::Report;
use serde::{Deserialize, Serialize};
use std::fmt::Write;
use tangency::output::{Figure, Hue, Tile, spacing};

/// The name and version of the file format of robustness maps.
pub const ROBUSTNESS: &str = "tangency-robustness/1";

/// The class of an outcome: how useful the result of a method is to the user.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
pub enum Class {
    /// The method's answer is right.
    Right,
    /// The answer is right, but another method computed it: the mapped method passed the problem on
    /// to this other method.
    HandedOver,
    /// The answer is missing or inaccurate, and the method reports so by a typed error or by its
    /// own error estimate.
    Reported,
    /// The answer is wrong, and the method reports no failure.
    Silent,
}

impl Class {
    /// All classes of outcomes, the best first.
    pub const ALL: [Class; 4] = [Class::Right, Class::HandedOver, Class::Reported, Class::Silent];

    /// Returns the name of the class in tables and legends.
    pub fn name(self) -> &'static str {
        match self {
            Class::Right => "right",
            Class::HandedOver => "handed over",
            Class::Reported => "reported",
            Class::Silent => "silent",
        }
    }

    fn hue(self) -> Hue {
        match self {
            Class::Right => Hue::Green,
            Class::HandedOver => Hue::Blue,
            Class::Reported => Hue::Yellow,
            Class::Silent => Hue::Red,
        }
    }
}

/// One kind of outcome that a method can have.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Outcome {
    /// The name of the outcome in tables and legends.
    pub name: String,
    /// The class.
    pub class: Class,
}

/// The outcome of a method at one place of the grid.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Cell {
    /// The horizontal quantity.
    pub x: f64,
    /// The vertical coordinate of the cell; in a panel of several methods, the index of the method,
    /// from 0.
    pub y: f64,
    /// The index of the cell's outcome in the list of the map's outcomes.
    pub outcome: usize,
    /// The error message of the method, kept only for the first cell of each outcome.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub message: Option<String>,
}

/// A method whose outcomes a panel shows.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Tried {
    /// The method.
    pub name: String,
    /// Whether the method is included for comparison only, because this library does not offer it.
    pub naive: bool,
    /// The outcomes.
    pub cells: Vec<Cell>,
}

/// A panel of a robustness map: one method on a grid of two quantities, or several methods over one
/// quantity, each in a separate row.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Region {
    /// The title.
    pub title: String,
    /// The horizontal quantity.
    pub x: String,
    /// The name of the vertical quantity; in a panel of several methods, a description of the
    /// methods.
    pub y: String,
    /// The methods.
    pub methods: Vec<Tried>,
}

/// A robustness map, which shows where methods succeed, where they report a failure, and where they
/// are silently wrong.
///
/// ```
/// use tangency_reports::{Cell, Class, RobustnessMap, Outcome, Region, Report, Tried};
/// let outcome = |name: &str, class| Outcome { name: name.into(), class };
/// let cell = |x, outcome, message: Option<&str>| Cell { x, y: 0.0, outcome, message: message.map(Into::into) };
/// let cells = vec![cell(0.0, 0, None), cell(1.0, 1, Some("the field is stiff")), cell(2.0, 1, None)];
/// let map = RobustnessMap {
///     name: "robustness-example".into(),
///     outcomes: vec![outcome("done", Class::Right), outcome("stiff", Class::Reported)],
///     panels: vec![Region {
///         title: "Integrators".into(),
///         x: "log₁₀ of the rate".into(),
///         y: "tolerance".into(),
///         methods: vec![Tried { name: "order 8".into(), naive: false, cells }],
///     }],
///     ..RobustnessMap::default()
/// };
/// assert_eq!(RobustnessMap::parse(&map.to_ron()?)?, map);
/// assert!(map.summary().contains("| order 8 | 1 | 2 |"));
/// assert!(map.summary().contains("order 8, stiff: the field is stiff."));
/// assert_eq!(map.at(0, "order 8", [1.1, 0.0]).map(|outcome| &*outcome.name), Some("stiff"));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct RobustnessMap {
    /// The format, [`ROBUSTNESS`].
    pub format: String,
    /// The name.
    pub name: String,
    /// The kinds of outcomes that occur in the map, the best first.
    pub outcomes: Vec<Outcome>,
    /// The panels.
    pub panels: Vec<Region>,
}

impl Default for RobustnessMap {
    fn default() -> Self {
        let (name, outcomes, panels) = Default::default();
        RobustnessMap { format: ROBUSTNESS.into(), name, outcomes, panels }
    }
}

impl RobustnessMap {
    /// Returns the outcome of one method of a panel in the grid cell that is nearest to given
    /// values of the panel's two quantities.
    pub fn at(&self, panel: usize, method: &str, [x, y]: [f64; 2]) -> Option<&Outcome> {
        let region = self.panels.get(panel)?;
        let tried = region.methods.iter().find(|tried| tried.name == method)?;
        let far = |cell: &&Cell| {
            (cell.x - x).abs() + if region.in_rows() { 0.0 } else { (cell.y - y).abs() }
        };
        let nearest = tried.cells.iter().min_by(|a, b| far(a).total_cmp(&far(b)))?;
        self.outcomes.get(nearest.outcome)
    }

    /// Returns the number of cells in which a method has a given outcome.
    pub fn count(&self, tried: &Tried, outcome: &str) -> usize {
        let named = |cell: &&Cell| self.outcomes[cell.outcome].name == outcome;
        tried.cells.iter().filter(named).count()
    }

    /// Returns the colour of an outcome: the hue shows its class, and the shade distinguishes the
    /// outcomes of one class.
    fn tint(&self, outcome: usize) -> (Hue, usize) {
        let class = self.outcomes[outcome].class;
        let before = self.outcomes[..outcome].iter().filter(|known| known.class == class);
        (class.hue(), before.count())
    }

    fn figure(&self, region: &Region) -> Figure {
        let mut figure = Figure::new(&region.title, &region.x, &region.y);
        if region.in_rows() {
            figure.y_names = region.methods.iter().map(|tried| tried.name.clone()).collect();
        }
        let cells = || region.methods.iter().flat_map(|tried| &tried.cells);
        let [x, y]: [Vec<f64>; 2] =
            [cells().map(|cell| cell.x).collect(), cells().map(|cell| cell.y).collect()];
        let size = [x, y].map(|values| spacing(values.into_iter()).unwrap_or(1.0));
        // The legend lists the best outcome first.
        for outcome in 0..self.outcomes.len() {
            let (hue, shade) = self.tint(outcome);
            let Outcome { name, class } = &self.outcomes[outcome];
            let meaning = format!("{}: {name}", class.name());
            for cell in cells().filter(|cell| cell.outcome == outcome) {
                let (at, meaning) = ([cell.x, cell.y], meaning.clone());
                Tile { at, size, hue, shade, meaning }.add_to(&mut figure.tiles, 0);
            }
        }
        figure
    }

    fn table(&self, region: &Region, text: &mut String) -> std::fmt::Result {
        let seen = |k: &usize| {
            region.methods.iter().any(|tried| tried.cells.iter().any(|cell| cell.outcome == *k))
        };
        let seen: Vec<usize> = (0..self.outcomes.len()).filter(seen).collect();
        writeln!(text, "### {}\n", region.title)?;
        write!(text, "| method |")?;
        for Outcome { name, class } in seen.iter().map(|k| &self.outcomes[*k]) {
            write!(text, " {}: {name} |", class.name())?;
        }
        writeln!(text, "\n|---|{}", "---|".repeat(seen.len()))?;
        for tried in &region.methods {
            write!(text, "| {} |", tried.name)?;
            for k in &seen {
                let count = tried.cells.iter().filter(|cell| cell.outcome == *k).count();
                write!(text, " {} |", if count == 0 { String::new() } else { count.to_string() })?;
            }
            writeln!(text)?;
        }
        let cells = region.methods.iter().flat_map(|t| t.cells.iter().map(move |c| (t, c)));
        let mut messages = cells.filter_map(|(t, c)| Some((t, c, c.message.as_ref()?))).peekable();
        if messages.peek().is_some() {
            writeln!(text, "\n```text")?;
            for (tried, cell, message) in messages {
                let outcome = &self.outcomes[cell.outcome].name;
                writeln!(text, "{}, {outcome}: {}.", tried.name, message.trim_end_matches('.'))?;
            }
            writeln!(text, "```")?;
        }
        writeln!(text)
    }
}

impl Region {
    /// Returns whether the panel shows each method in a separate row.
    fn in_rows(&self) -> bool {
        self.methods.len() > 1
    }
}

impl Report for RobustnessMap {
    fn name(&self) -> &str {
        &self.name
    }

    fn figures(&self) -> Vec<Figure> {
        self.panels.iter().map(|region| self.figure(region)).collect()
    }

    /// Returns a table of the number of cells of each outcome for each method, followed by the
    /// error messages.
    fn to_markdown(&self) -> String {
        let mut text = String::new();
        for region in &self.panels {
            // Writing into a string cannot fail.
            let _ = self.table(region, &mut text);
        }
        text.trim_end().to_string() + "\n"
    }

    fn summary(&self) -> String {
        self.to_markdown()
    }

    /// Serializes the map as RON, with one line for each cell.
    fn to_ron(&self) -> Result<String, ron::Error> {
        ron::ser::to_string_pretty(self, ron::ser::PrettyConfig::default().depth_limit(6))
    }
}

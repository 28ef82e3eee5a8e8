//! Work-precision diagrams: measurements of methods, as data (RON), as tables (Markdown) and as
//! figures (SVG).

use super::report::Report;
use serde::{Deserialize, Serialize};
use std::fmt::Write;
use tangency::output::{Figure, Mark, Series, Style, Symbol};

/// The name and version of the file format of work-precision diagrams.
pub const WORK_PRECISION: &str = "tangency-work-precision/1";

/// The machine, the compiler and the date of a set of measurements.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Circumstances {
    /// The processor.
    pub processor: String,
    /// The compiler and its build profile.
    pub compiler: String,
    /// The number of threads that the processor runs simultaneously.
    pub cores: usize,
    /// The date on which the measurements were made.
    pub date: String,
    /// The number of runs from which each median time is computed.
    pub runs: usize,
}

/// The measured result of one method with one setting: its work, time and error.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Measurement {
    /// The setting.
    pub setting: String,
    /// The amount of work that the method did, for example the number of evaluations of the vector
    /// field or the number of unknowns.
    pub work: f64,
    /// The time that the method took, in seconds, measured by the clock [`Measured::clock`].
    pub seconds: f64,
    /// The distance of the method's result from the reference result; NaN if the method failed.
    pub error: f64,
    /// The error message of the method; `None` if the method succeeded.
    pub failure: Option<String>,
}

/// The measurements of one method, in order of growing effort.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Line {
    /// The method.
    pub name: String,
    /// The measurements.
    pub points: Vec<Measurement>,
}

/// The quantities on the two axes of a figure; both axes are logarithmic.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[non_exhaustive]
pub enum Drawn {
    /// Error against time, the usual work-precision diagram.
    #[default]
    ErrorAgainstTime,
    /// Error against work, for methods whose work is measured by the size of the problem.
    ErrorAgainstWork,
    /// Time against the size of the problem.
    TimeAgainstWork,
}

/// The clock by which methods are timed.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[non_exhaustive]
pub enum Clock {
    /// CPU time of all threads together, which hardly depends on other load of the machine.
    #[default]
    Processor,
    /// Wall time, which shows the gain from several threads.
    Wall,
}

impl Clock {
    /// Returns the name of the time that the clock measures, such as `CPU time`.
    pub fn time(self) -> &'static str {
        match self {
            Clock::Processor => "CPU time",
            Clock::Wall => "wall time",
        }
    }
}

/// The measured times and errors of several methods on one problem.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Measured {
    /// The problem.
    pub title: String,
    /// The name of the quantity whose error is shown, with its units.
    pub error: String,
    /// The name of the unit in which the work of the methods is counted.
    pub work: String,
    /// A description of the reference from which errors are measured.
    pub reference: String,
    /// The methods.
    pub lines: Vec<Line>,
    /// The quantities on the axes of the figure.
    #[serde(default)]
    pub drawn: Drawn,
    /// Whether every point of the figure is labelled with its amount of work.
    #[serde(default)]
    pub marked: bool,
    /// The clock by which the methods are timed.
    #[serde(default)]
    pub clock: Clock,
    /// The recommended method and its recommended setting; scenes use both by default.
    pub recommended: Option<(String, String)>,
}

/// A work-precision diagram: measurements of several methods on one or several problems.
///
/// ```
/// use tangency_reports::{WorkPrecision, Line, Measured, Measurement, Report};
/// let point = |setting: &str, seconds, error| Measurement {
///     setting: setting.into(), work: 1.0, seconds, error, failure: None,
/// };
/// let lines = vec![
///     Line { name: "cheap".into(), points: vec![point("1", 1e-3, 1e-2), point("2", 1e-1, 1e-4)] },
///     Line { name: "good".into(), points: vec![point("3", 1e-2, 1e-8)] },
/// ];
/// let measured = Measured { lines, ..Measured::of("a problem") };
/// // The second setting of the cheap method is slower than the good one, and worse.
/// assert_eq!(measured.front(), [("cheap", "1"), ("good", "3")]);
/// let diagram = WorkPrecision { name: "example".into(), panels: vec![measured], ..WorkPrecision::default() };
/// assert_eq!(WorkPrecision::parse(&diagram.to_ron()?)?, diagram);
/// assert!(diagram.to_markdown().contains("| good | 3 | 1 | 10.000 | 1.0e-8 |"));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct WorkPrecision {
    /// The format, [`WORK_PRECISION`].
    pub format: String,
    /// The name.
    pub name: String,
    /// The problems.
    pub panels: Vec<Measured>,
    /// The machine, the compiler and the date of the measurements.
    pub circumstances: Circumstances,
}

impl Default for WorkPrecision {
    fn default() -> Self {
        let (name, panels, circumstances) = Default::default();
        WorkPrecision { format: WORK_PRECISION.into(), name, panels, circumstances }
    }
}

impl Measured {
    /// Creates a problem with a title and without measurements.
    pub fn of(title: impl Into<String>) -> Self {
        Measured { title: title.into(), ..Measured::default() }
    }

    /// Returns all measurements, each with the name of its method.
    fn all(&self) -> impl Iterator<Item = (&str, &Measurement)> {
        self.lines
            .iter()
            .flat_map(|line| line.points.iter().map(|point| (line.name.as_str(), point)))
    }

    /// Returns the methods and settings on the Pareto front, by increasing time: no other
    /// measurement is better in both time and error.
    pub fn front(&self) -> Vec<(&str, &str)> {
        let mut sorted: Vec<(&str, &Measurement)> =
            self.all().filter(|(_, point)| point.error.is_finite()).collect();
        sorted.sort_by(|(_, a), (_, b)| a.seconds.total_cmp(&b.seconds));
        let mut least = f64::INFINITY;
        sorted.retain(|(_, point)| {
            let better = point.error < least;
            least = least.min(point.error);
            better
        });
        sorted.iter().map(|(name, point)| (*name, point.setting.as_str())).collect()
    }

    /// Returns the measurement of a method with one setting.
    pub fn point(&self, name: &str, setting: &str) -> Option<&Measurement> {
        let known = self.all().find(|(known, point)| *known == name && point.setting == setting);
        known.map(|(_, point)| point)
    }

    /// Returns the error message of the first failure of each method that fails.
    pub fn failures(&self) -> Vec<(&str, &str)> {
        let mut failures = Vec::new();
        for line in &self.lines {
            let first = line.points.iter().find_map(|point| point.failure.as_deref());
            failures.extend(first.map(|failure| (line.name.as_str(), failure)));
        }
        failures
    }

    /// The smallest error shown in figures; smaller errors are due to rounding and are drawn at
    /// this value.
    const LEAST: f64 = 1e-16;

    fn figure(&self) -> Figure {
        let time = format!("{} in seconds", self.clock.time());
        let labels = [&time, &self.work, &self.error];
        // The quantity (time, work or error) on each axis.
        let axes: [usize; 2] = match self.drawn {
            Drawn::ErrorAgainstTime => [0, 2],
            Drawn::ErrorAgainstWork => [1, 2],
            Drawn::TimeAgainstWork => [1, 0],
        };
        let [x, y] = axes.map(|axis| format!("log₁₀ of {}", labels[axis]));
        let mut figure = Figure::new(&self.title, x, y);
        let at = |point: &Measurement| {
            let values = [point.seconds.max(1e-9), point.work, point.error.max(Self::LEAST)];
            axes.map(|axis| values[axis].log10())
        };
        for line in &self.lines {
            let points = line.points.iter().filter(|point| point.error.is_finite()).map(at);
            figure = figure.with(Series::new(&line.name, Style::DottedLine, points));
        }
        if self.marked {
            let points = self.all().filter(|(_, point)| point.error.is_finite());
            figure.marks.extend(points.map(|(_, point)| Mark {
                at: at(point),
                label: point.work.to_string(),
                meaning: self.work.clone(),
                symbol: Symbol::Number,
                origin: None,
            }));
        }
        if let Some((name, setting)) = &self.recommended
            && let Some(point) = self.point(name, setting)
        {
            let (at, label, meaning) = (at(point), setting.clone(), "recommended".into());
            figure.marks.push(Mark { at, label, meaning, symbol: Symbol::Star, origin: None });
        }
        figure
    }

    /// Writes a table of all measurements, or a table of the Pareto front and the recommended
    /// measurement only.
    fn table(&self, text: &mut String, all: bool) -> std::fmt::Result {
        writeln!(text, "### {}\n\n{}\n", self.title, self.reference)?;
        let (work, time, error) = (&self.work, self.clock.time(), &self.error);
        writeln!(text, "| method | setting | {work} | {time} in ms | {error} |")?;
        writeln!(text, "|---|---|---|---|---|")?;
        let front = self.front();
        for (name, Measurement { setting, work, seconds, error, failure }) in self.all() {
            let recommended = self.recommended.as_ref();
            let chosen = recommended.is_some_and(|(a, b)| (&**a, b) == (name, setting));
            let sized = self.drawn != Drawn::ErrorAgainstTime;
            if !(all || chosen || sized || front.contains(&(name, setting))) {
                continue;
            }
            let bold = chosen && !setting.is_empty();
            let setting = if bold { format!("**{setting}**") } else { setting.clone() };
            let name = if chosen && !bold { format!("**{name}**") } else { name.to_string() };
            let milliseconds = 1e3 * seconds;
            write!(text, "| {name} | {setting} | ")?;
            match failure {
                None => writeln!(text, "{work} | {milliseconds:.3} | {error:.1e} |")?,
                Some(_) => writeln!(text, "| | fails |")?,
            }
        }
        let failures = self.failures();
        if !failures.is_empty() {
            writeln!(text, "\n```text")?;
            for (name, failure) in failures {
                writeln!(text, "{name} fails: {}.", failure.trim_end_matches('.'))?;
            }
            writeln!(text, "```")?;
        }
        writeln!(text)
    }
}

impl WorkPrecision {
    fn tables(&self, all: bool) -> String {
        let mut text = String::new();
        let Circumstances { processor, compiler, cores, date, runs } = &self.circumstances;
        let of_one = |panel: &Measured| panel.clock == Clock::Processor;
        let threads = match self.panels.iter().all(of_one) {
            true => "one thread",
            false => "one thread unless a thread count is given",
        };
        for panel in &self.panels {
            // Writing into a string cannot fail.
            let _ = panel.table(&mut text, all);
        }
        format!(
            "{text}Each time is the median of {runs} runs on {processor}, {cores} cores, {threads}, \
             compiled by {compiler}, on {date}.\n"
        )
    }
}

impl Report for WorkPrecision {
    fn name(&self) -> &str {
        &self.name
    }

    /// Returns a figure for each problem, with error against time by default.
    fn figures(&self) -> Vec<Figure> {
        self.panels.iter().map(Measured::figure).collect()
    }

    /// Returns all measurements as Markdown tables, followed by the machine, compiler and date; the
    /// recommended setting is bold.
    fn to_markdown(&self) -> String {
        self.tables(true)
    }

    /// Returns Markdown tables of the Pareto front and of the recommended setting.
    fn summary(&self) -> String {
        self.tables(false)
    }
}

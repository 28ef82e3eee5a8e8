//! Tables of results: complete branches as comma-separated values, special points as lines on a
//! screen.

use super::document::Document;
use super::number::{certain_digits, significant};
use crate::core::continuation::{Branch, Number, Point, SpecialPoint};
use crate::core::problem::distinct;

/// Writes all points of the branches of one or several documents as comma-separated values:
/// `branch`, `point` (counted from 0), every parameter and monitor by name, `unstable`, and
/// `admissible`. If there are several documents, the first column, `file`, contains the names of
/// the documents. Numbers have 15 significant digits; a cell is empty if a branch does not contain
/// the column, and `unstable` is `?` if multipliers are not determined.
///
/// ```
/// use tangency::output::{Document, example_branch, table};
/// let document = Document::new("Pull-in", vec![example_branch()]);
/// let table = table(&[("plate", &document)]);
/// let lines: Vec<&str> = table.lines().collect();
/// assert_eq!(lines[0], "branch,point,load,aspect_ratio,deflection,unstable,admissible");
/// assert_eq!(lines[1], "plate,0,0,1.2,0,0,true");
/// ```
pub fn table<'a>(documents: &[(&'a str, &'a Document)]) -> String {
    let branches = |(file, document): &(&'a str, &'a Document)| {
        let file = *file;
        document.branches.iter().map(move |branch| (file, branch))
    };
    let all: Vec<(&str, &Branch)> = documents.iter().flat_map(branches).collect();
    let columns =
        |of: fn(&Branch) -> &Vec<String>| distinct(all.iter().flat_map(|(_, branch)| of(branch)));
    let (parameters, monitors) = (columns(|b| &b.parameters), columns(|b| &b.monitors));
    let last = ["unstable", "admissible"];
    let first = &["file", "branch", "point"][usize::from(documents.len() < 2)..];
    let mut table = Csv::new(first, &parameters, &monitors, &last);
    for (file, branch) in &all {
        for (index, point) in branch.points.iter().enumerate() {
            let unstable = count(point.unstable, &point.undetermined);
            let cells = cells(&parameters, &branch.parameters, &point.parameters).chain(cells(
                &monitors,
                &branch.monitors,
                &point.monitors,
            ));
            let file = (first.len() > 2).then(|| quoted(file)).into_iter();
            let place = file.chain([quoted(&branch.name), index.to_string()]);
            table.row(place.chain(cells).chain([unstable, point.admissible.to_string()]));
        }
    }
    table.0
}

/// Comma-separated values.
pub(super) struct Csv(pub String);

impl Csv {
    /// Creates a table without rows, with given columns before and after the columns of parameters
    /// and monitors. The title of a parameter or monitor is prefixed by `parameter` or `monitor` if
    /// another column has the same name.
    pub fn new(first: &[&str], parameters: &[&str], monitors: &[&str], last: &[&str]) -> Self {
        let own = || first.iter().chain(last);
        let parameter = |name: &&str| match own().any(|own| own == name) {
            true => quoted(&format!("parameter {name}")),
            false => quoted(name),
        };
        let monitor = |name: &&str| match own().chain(parameters).any(|other| other == name) {
            true => quoted(&format!("monitor {name}")),
            false => quoted(name),
        };
        let mut table = Csv(String::new());
        let [first, last] = [first, last].map(|own| own.iter().map(|name| name.to_string()));
        let columns = parameters.iter().map(parameter).chain(monitors.iter().map(monitor));
        table.row(first.chain(columns).chain(last));
        table
    }

    pub fn row(&mut self, cells: impl Iterator<Item = String>) {
        self.0.push_str(&cells.collect::<Vec<_>>().join(","));
        self.0.push('\n');
    }
}

/// Returns the contents of a point's row in the given columns.
fn cells<'a>(
    columns: &'a [&str],
    names: &'a [String],
    values: &'a [f64],
) -> impl Iterator<Item = String> + 'a {
    columns.iter().map(|column| cell(column, names, values))
}

fn cell(column: &str, names: &[String], values: &[f64]) -> String {
    let position = names.iter().position(|name| name == column);
    let value = position.and_then(|position| values.get(position));
    value.map_or(String::new(), |value| significant(*value, 15))
}

/// Formats a number of unstable eigenvalues; the text is empty if the solution has no stability,
/// and a question mark if the number is not determined.
pub(super) fn count(unstable: Option<usize>, undetermined: &Option<String>) -> String {
    match (unstable, undetermined) {
        (Some(count), _) => count.to_string(),
        (None, Some(_)) => "?".into(),
        (None, None) => String::new(),
    }
}

/// Replaces the separator of comma-separated values in a text, and the decimal point of numbers.
///
/// ```
/// use tangency::output::separated;
/// assert_eq!(separated("a,\"b,c\",d;e\n", ';', '.'), "a;\"b,c\";\"d;e\"\n");
/// assert_eq!(separated("x.y,\"1.5\",-1.5e-3\n", ';', ','), "x.y;\"1.5\";-1,5e-3\n");
/// ```
pub fn separated(csv: &str, separator: char, decimal: char) -> String {
    let written = |cell: &str| {
        if cell.parse::<f64>().is_ok() {
            cell.replace('.', &decimal.to_string())
        } else if cell.contains(separator) && !cell.starts_with('"') {
            format!("\"{cell}\"")
        } else {
            cell.to_owned()
        }
    };
    let (mut out, mut cell, mut in_quotes) = (String::new(), String::new(), false);
    for letter in csv.chars() {
        in_quotes ^= letter == '"';
        if in_quotes || !matches!(letter, ',' | '\n') {
            cell.push(letter);
            continue;
        }
        out.push_str(&written(&cell));
        cell.clear();
        out.push(if letter == ',' { separator } else { '\n' });
    }
    out + &cell
}

/// Puts a name in quotes if it contains characters that have a meaning in comma-separated values
/// (RFC 4180).
pub(super) fn quoted(name: &str) -> String {
    if name.contains([',', '"', '\n', '\r']) {
        format!("\"{}\"", name.replace('"', "\"\""))
    } else {
        name.into()
    }
}

/// Aligned lines for a screen, optionally of a given width in characters. The line for a special
/// point contains its label, its kind, the number of unstable eigenvalues or multipliers (`?` if
/// they are not determined), the varied parameters, and the monitors. Columns that do not fit into
/// the width are omitted, from the last column on.
///
/// ```
/// use tangency::output::{Screen, example_branch};
/// let branch = example_branch();
/// let screen = Screen::of(&branch, None);
/// assert_eq!(screen.header(), " label  kind  unstable                load          deflection");
/// assert_eq!(
///     screen.line(&branch.special[2]),
///     "     3  LP           0      0.148148148148      0.333333333333"
/// );
/// let narrow = Screen::of(&branch, Some(50));
/// assert_eq!(narrow.header(), " label  kind  unstable                load  +1");
/// ```
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Screen {
    /// The columns that are shown: the index of each column in a point, and the name of the column.
    columns: Vec<(usize, String)>,
    /// The number of columns that are omitted because they do not fit into the width of the screen.
    omitted: usize,
    /// The width of the screen, in characters.
    width: usize,
}

/// The largest number of characters that a number with 12 significant digits takes.
const WIDTH: usize = 18;
/// The number of characters reserved for label, kind and stability.
const FIRST: usize = 22;
/// The number of characters reserved for the number of omitted columns.
const MORE: usize = 5;

/// Returns the number of characters of a column, including the space before it.
fn width_of((_, name): &(usize, String)) -> usize {
    2 + name.chars().count().max(WIDTH).min(usize::from(u16::MAX))
}

fn number(value: Option<f64>) -> String {
    value.map_or(String::new(), |value| significant(value, 12))
}

impl Screen {
    /// Creates the layout of the lines for the special points of a branch on a screen with an
    /// optional width in characters. The branch need not be finished.
    pub fn of(branch: &Branch, width: Option<usize>) -> Self {
        let names = branch.released.iter().chain(&branch.monitors);
        let column = |name: &String| Some((branch.column(name)?, name.clone()));
        let mut columns: Vec<(usize, String)> = names.filter_map(column).collect();
        let (all, width) = (columns.len(), width.unwrap_or(usize::MAX));
        let mut room = width.saturating_sub(FIRST + MORE);
        let fitting = columns.iter().take_while(|column| {
            let fits = width_of(column) <= room;
            room = room.saturating_sub(width_of(column));
            fits
        });
        // The parameter is always shown.
        let kept = fitting.count().max(1).min(all);
        columns.truncate(kept);
        Screen { columns, omitted: all - kept, width }
    }

    /// Returns the header line: the names of the columns, and the number of omitted columns.
    pub fn header(&self) -> String {
        let names = self.assemble([" label", "kind", "unstable"], |(_, name)| name.clone());
        if self.omitted == 0 { names } else { format!("{names}  +{}", self.omitted) }
    }

    /// Returns the line for one point of the branch.
    pub fn point(&self, point: &Point) -> String {
        let unstable = count(point.unstable, &point.undetermined);
        self.assemble(["      ", "", &unstable], |(column, _)| number(point.value(*column)))
    }

    /// Returns the line for one special point, with the standard name of its kind and its numbers;
    /// if the point has not converged, the line is marked.
    pub fn line(&self, point: &SpecialPoint) -> String {
        let label = format!("{:>6}", point.label);
        let unstable = count(point.unstable, &point.undetermined);
        let first = [&label, &point.kind.to_string(), &unstable];
        let mut line =
            self.assemble(first.map(String::as_str), |(column, _)| number(point.value(*column)));
        let mut notes: Vec<String> = point.subkind.iter().cloned().collect();
        if !point.converged {
            let [from, to] = point.bracket.map(|end| significant(end, 12));
            notes.push(format!("not converged, between {from} and {to}"));
        }
        let numbers = point.numbers.iter().filter(|number| !number.is_detail());
        notes.extend(numbers.map(|number| {
            let Number { name, value, error } = number;
            if !number.is_certain() {
                return format!(
                    "{name} uncertain, at most {}",
                    significant(value.abs() + error, 1)
                );
            }
            match certain_digits(*value, *error) {
                0 => format!("{name} = {} ± {}", significant(*value, 2), significant(*error, 1)),
                digits => format!("{name} = {}", significant(*value, digits.min(12))),
            }
        }));
        if point.multiplicity > 1 {
            notes.push(format!("multiplicity {}", point.multiplicity));
        }
        // A doubt is shown even if it does not fit.
        let mut omitted = false;
        for note in notes {
            let width = line.chars().count() + 2 + note.chars().count();
            if width <= self.width || note.starts_with("not converged") {
                line.push_str(&format!("  {note}"));
            } else {
                omitted = true;
            }
        }
        if omitted { line + " …" } else { line }
    }

    fn assemble(
        &self,
        [label, kind, unstable]: [&str; 3],
        cell: impl Fn(&(usize, String)) -> String,
    ) -> String {
        let mut line = format!("{label}  {kind:<4}  {unstable:>8}");
        for column in &self.columns {
            let width = width_of(column) - 2;
            line.push_str(&format!("  {:>width$}", cell(column)));
        }
        line
    }
}

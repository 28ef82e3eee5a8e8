//! Tables: special points and whole branches as comma-separated values, special points as lines on
//! a screen.

use super::document::Document;
use super::number::significant;
use crate::core::continuation::{Branch, SpecialPoint};
use crate::core::problem::distinct;

/// The special points of several branches as comma-separated values: `branch,label,kind`, every
/// parameter, then every monitor and every number that belongs to special points by name, in the
/// order in which the branches first mention them, then `error`, the estimated absolute error of
/// the continued parameter, `unstable`, the number of unstable eigenvalues or multipliers,
/// `converged`: where it is `false` no digit is promised, and there is no error; and
/// `multiplicity`, how many eigenvalues or pairs are critical together. Numbers have 15 significant digits. A cell is empty where a branch
/// lacks the column, and `unstable` where stability is not meant; `?` stands where multipliers are
/// not determined. A parameter or monitor with the name of another column is `parameter error`, say, or `monitor error`.
///
/// ```
/// let table = tangency::output::csv(&[tangency::output::example_branch()]);
/// let lines: Vec<&str> = table.lines().collect();
/// assert_eq!(lines[0], "branch,label,kind,load,aspect_ratio,deflection,error,unstable,converged,multiplicity");
/// assert_eq!(lines[3], "plate,3,LP,0.148148148148148,1.2,0.333333333333333,2.5e-15,0,true,1");
/// ```
pub fn csv(branches: &[Branch]) -> String {
    let parameters = distinct(branches.iter().flat_map(|branch| &branch.parameters));
    let numbers = branches.iter().flat_map(|branch| &branch.special).flat_map(|it| &it.numbers);
    let monitors = branches.iter().flat_map(|branch| &branch.monitors);
    let monitors = distinct(monitors.chain(numbers.map(|(name, _)| name)));
    let last = ["error", "unstable", "converged", "multiplicity"];
    let mut table = Csv::new(&["branch", "label", "kind"], &parameters, &monitors, &last);
    for branch in branches {
        for point in &branch.special {
            let (names, values): (Vec<String>, Vec<f64>) = point.numbers.iter().cloned().unzip();
            let recorded = [&branch.monitors[..], &names].concat();
            let own = [&point.monitors[..], &values].concat();
            let error = point.converged.then(|| significant(point.error, 15));
            let first = [quoted(&branch.name), point.label.to_string(), point.kind.to_string()];
            let last = [
                error.unwrap_or_default(),
                count(point.unstable, &point.undetermined),
                point.converged.to_string(),
                point.multiplicity.to_string(),
            ];
            let cells = cells(&parameters, &branch.parameters, &point.parameters)
                .chain(cells(&monitors, &recorded, &own));
            table.row(first.into_iter().chain(cells).chain(last));
        }
    }
    table.0
}

/// All points of the branches of some documents as comma-separated values: `branch`, `point`,
/// counted from 0, every parameter and monitor by name, `unstable`, and `admissible`. Of several
/// documents, each branch has the name of its document before its own. Numbers have 15 significant
/// digits; a cell is empty where a branch lacks the column, and `unstable` is `?` where multipliers
/// are not determined.
///
/// ```
/// use tangency::output::{Document, example_branch, table};
/// let document = Document::new("Pull-in", vec![example_branch()]);
/// let table = table(&[("plate", &document)]);
/// let lines: Vec<&str> = table.lines().collect();
/// assert_eq!(lines[0], "branch,point,load,aspect_ratio,deflection,unstable,admissible");
/// assert_eq!(lines[1], "plate,0,0,1.2,0,0,true");
/// ```
pub fn table<'a>(documents: &[(&str, &'a Document)]) -> String {
    let name = |document: &str, branch: &Branch| match documents.len() {
        1 => branch.name.clone(),
        _ => format!("{document}: {}", branch.name),
    };
    let branches = |(stem, document): &(&str, &'a Document)| {
        document.branches.iter().map(|branch| (name(stem, branch), branch)).collect::<Vec<_>>()
    };
    let all: Vec<(String, &Branch)> = documents.iter().flat_map(branches).collect();
    let columns =
        |of: fn(&Branch) -> &Vec<String>| distinct(all.iter().flat_map(|(_, branch)| of(branch)));
    let (parameters, monitors) = (columns(|b| &b.parameters), columns(|b| &b.monitors));
    let last = ["unstable", "admissible"];
    let mut table = Csv::new(&["branch", "point"], &parameters, &monitors, &last);
    for (name, branch) in &all {
        for (index, point) in branch.points.iter().enumerate() {
            let unstable = count(point.unstable, &point.undetermined);
            let cells = cells(&parameters, &branch.parameters, &point.parameters).chain(cells(
                &monitors,
                &branch.monitors,
                &point.monitors,
            ));
            let first = [quoted(name), index.to_string()].into_iter();
            table.row(first.chain(cells).chain([unstable, point.admissible.to_string()]));
        }
    }
    table.0
}

/// Comma-separated values.
pub(super) struct Csv(pub String);

impl Csv {
    /// A table without rows: columns of its own before and behind those of parameters and monitors.
    /// A parameter or monitor with the name of another column says what it is.
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

/// The cells of some columns.
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

/// A number of unstable eigenvalues; nothing where stability is not meant, and a question mark
/// where it is not determined.
fn count(unstable: Option<usize>, undetermined: &Option<String>) -> String {
    match (unstable, undetermined) {
        (Some(count), _) => count.to_string(),
        (None, Some(_)) => "?".into(),
        (None, None) => String::new(),
    }
}

/// A name in quotes if it would otherwise break the table (RFC 4180).
pub(super) fn quoted(name: &str) -> String {
    if name.contains([',', '"', '\n', '\r']) {
        format!("\"{}\"", name.replace('"', "\"\""))
    } else {
        name.into()
    }
}

/// Aligned lines for a screen, one for each special point: its label, its kind, the number of
/// unstable eigenvalues or multipliers (`?` where they are not determined), the parameters that
/// vary, the monitors.
///
/// ```
/// use tangency::output::{Screen, example_branch};
/// let branch = example_branch();
/// let screen = Screen::of(&branch);
/// assert_eq!(screen.header(), " label  kind  unstable                load          deflection");
/// assert_eq!(
///     screen.line(&branch.special[2]),
///     "     3  LP           0      0.148148148148      0.333333333333"
/// );
/// ```
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Screen {
    /// The columns of a point, and their names.
    columns: Vec<(usize, String)>,
}

/// A number of 12 significant digits has at most 18 letters.
const WIDTH: usize = 18;

impl Screen {
    /// The lines of a branch, also of one that is still being traced.
    pub fn of(branch: &Branch) -> Self {
        let names = branch.released.iter().chain(&branch.monitors);
        let column = |name: &String| Some((branch.column(name)?, name.clone()));
        Screen { columns: names.filter_map(column).collect() }
    }

    /// The names above the columns.
    pub fn header(&self) -> String {
        self.assemble([" label", "kind", "unstable"], |(_, name)| name.clone())
    }

    /// The line of one special point, with what the field calls it and the numbers that belong to
    /// it; one that has not converged says so.
    pub fn line(&self, point: &SpecialPoint) -> String {
        let label = format!("{:>6}", point.label);
        let unstable = count(point.unstable, &point.undetermined);
        let first = [&label, &point.kind.to_string(), &unstable];
        let mut line = self.assemble(first.map(String::as_str), |(column, _)| {
            point.value(*column).map_or(String::new(), |value| significant(value, 12))
        });
        if let Some(subkind) = &point.subkind {
            line.push_str(&format!("  {subkind}"));
        }
        for (name, value) in &point.numbers {
            line.push_str(&format!("  {name} = {}", significant(*value, 12)));
        }
        if point.multiplicity > 1 {
            line.push_str(&format!("  multiplicity {}", point.multiplicity));
        }
        if !point.converged {
            let [from, to] = point.bracket.map(|end| significant(end, 12));
            line.push_str(&format!("  not converged, between {from} and {to}"));
        }
        line
    }

    fn assemble(
        &self,
        [label, kind, unstable]: [&str; 3],
        cell: impl Fn(&(usize, String)) -> String,
    ) -> String {
        let mut line = format!("{label}  {kind:<4}  {unstable:>8}");
        for column in &self.columns {
            let width = column.1.chars().count().max(WIDTH).min(usize::from(u16::MAX));
            line.push_str(&format!("  {:>width$}", cell(column)));
        }
        line
    }
}

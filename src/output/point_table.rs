//! Special points of many documents in one table, as in the command `tangency table`.

use super::document::Document;
use super::names::{differing, setting, sort};
use super::number::significant;
use super::table::{count, quoted};
use crate::core::continuation::{Branch, Sensitivity, SpecialPoint};
use crate::core::problem::{UnknownName, distinct};
use crate::core::system::Kind;

/// A table of the special points of several documents, restricted to given kinds, with one row for
/// each point. The rows are sorted by the settings in which the documents differ.
///
/// ```
/// use tangency::core::system::Kind;
/// use tangency::output::{Columns, Document, PointTable, Selection, example_branch};
/// let mut thick = Document::new("Pull-in", vec![example_branch()]);
/// let mut thin = thick.clone();
/// thick.settings.push(("thickness".into(), "2".into()));
/// thin.settings.push(("thickness".into(), "1".into()));
/// let documents = [("a", &thick), ("b", &thin)];
/// let columns = Columns::Named(&["thickness", "load", "error"]);
/// let selection = Selection { kinds: &[Kind::LP], columns, ..Selection::default() };
/// let table = PointTable::of(&documents, selection)?;
/// assert_eq!(
///     table.csv(),
///     "thickness,load,error\n1,0.148148148148148,2.5e-15\n2,0.148148148148148,2.5e-15\n"
/// );
/// # Ok::<(), tangency::core::problem::UnknownName>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct PointTable {
    columns: Vec<String>,
    rows: Vec<Vec<Cell>>,
}

/// The selection of special points and columns for a table.
#[derive(Clone, Copy, Debug, Default)]
pub struct Selection<'a> {
    /// The kinds of the special points in the table; empty for all kinds.
    pub kinds: &'a [Kind],
    /// The columns.
    pub columns: Columns<'a>,
    /// Whether to append the columns of all sensitivities, such as `dload/dgap`; they are not
    /// appended if the selected columns already contain a sensitivity.
    pub sensitivities: bool,
}

/// The columns of a table of special points.
#[derive(Clone, Copy, Debug, Default)]
pub enum Columns<'a> {
    /// The default columns: the settings in which the documents differ, the branch, label and kind
    /// of each special point, the varied parameters, the monitors and the error.
    #[default]
    Usual,
    /// All columns of [`csv`]; if the table contains special points of several documents, the
    /// columns `file` and the settings in which the documents differ come first.
    All,
    /// The columns with the given names: settings of documents, parameters, monitors, named numbers
    /// that special points store, `file`, `branch`, `label`, `kind`, `error`, `unstable`,
    /// `converged`, `multiplicity`, the `itinerary` of hybrid orbits, and sensitivities.
    Named(&'a [&'a str]),
}

/// The content of a cell of a table.
#[derive(Clone, Debug, PartialEq)]
enum Cell {
    Text(String),
    Number(f64),
}

impl Cell {
    /// Creates a cell from a setting: a number if the setting is a number, otherwise a text.
    fn of(text: &str) -> Self {
        text.parse().map_or_else(|_| Cell::Text(text.to_owned()), Cell::Number)
    }

    fn written(&self, digits: usize) -> String {
        match self {
            Cell::Text(text) => text.clone(),
            Cell::Number(value) => significant(*value, digits),
        }
    }
}

/// The number of significant digits with which numbers are written in files.
const DIGITS: usize = 15;
/// The number of significant digits with which numbers are shown on a screen.
const SHOWN: usize = 10;

/// The columns that every special point has: `PLACE` is to the left of the columns that depend on
/// the system, and `QUALITY` is to their right.
const PLACE: [&str; 3] = ["branch", "label", "kind"];
const QUALITY: [&str; 4] = ["error", "unstable", CONVERGED, "multiplicity"];
const FILE: &str = "file";
const CONVERGED: &str = "converged";
const ITINERARY: &str = "itinerary";

/// A special point with its branch and its document.
struct Found<'a> {
    file: &'a str,
    document: Option<&'a Document>,
    branch: &'a Branch,
    point: &'a SpecialPoint,
}

/// A column of the table: its title, the name of its values, and the source of its values.
struct Column {
    title: String,
    name: String,
    source: Source,
}

/// The source from which the values of a column of the table are taken.
#[derive(Clone, Copy, PartialEq)]
enum Source {
    /// The value comes from the first source that contains the column's name: named numbers that
    /// special points store, monitors, parameters, settings, sensitivities.
    Any,
    Parameters,
    Monitors,
    Settings,
}

impl Column {
    fn new(title: impl Into<String>, name: &str, source: Source) -> Self {
        Column { title: title.into(), name: name.to_owned(), source }
    }

    fn any(name: &str) -> Self {
        Column::new(name, name, Source::Any)
    }

    /// Creates the column of a setting in which the documents differ.
    fn setting(name: &str) -> Self {
        match PLACE.contains(&name) || QUALITY.contains(&name) || name == FILE {
            true => Column::new(format!("setting {name}"), name, Source::Settings),
            false => Column::any(name),
        }
    }
}

/// Writes the special points of several branches as comma-separated values. The first columns are
/// `branch,label,kind`. They are followed by every parameter, every monitor and every named number
/// that special points store, in the order of their first occurrence. The last columns are `error`
/// (the estimated absolute error of the continuation parameter), `unstable` (the number of unstable
/// eigenvalues or multipliers), `converged` (if `false`, no digit is reliable, and the error is
/// missing), and `multiplicity` (the number of simultaneously critical eigenvalues or pairs).
/// Numbers in the table have 15 significant digits. A cell is empty if a branch does not contain
/// the column, and `unstable` is `?` if multipliers are not determined. The title of a parameter or
/// monitor gets a prefix if another column has the same name, for example `parameter error` or
/// `monitor error`.
///
/// ```
/// let table = tangency::output::csv(&[tangency::output::example_branch()]);
/// let lines: Vec<&str> = table.lines().collect();
/// assert_eq!(lines[0], "branch,label,kind,load,aspect_ratio,deflection,error,unstable,converged,multiplicity");
/// assert_eq!(lines[3], "plate,3,LP,0.148148148148148,1.2,0.333333333333333,2.5e-15,0,true,1");
/// ```
pub fn csv(branches: &[Branch]) -> String {
    let found: Vec<Found> = branches.iter().flat_map(|branch| found("", None, branch)).collect();
    PointTable::new(complete(Vec::new(), &found), &found).csv()
}

impl PointTable {
    /// Collects the special points of documents into a table. If any special point of the table has
    /// not converged, the column `converged` is added, except with [`Columns::All`].
    ///
    /// # Errors
    /// [`UnknownName`] for a column that does not exist in any document.
    pub fn of(
        documents: &[(&str, &Document)],
        Selection { kinds, columns, sensitivities }: Selection,
    ) -> Result<Self, UnknownName> {
        let (found, derivatives) = (chosen(documents, kinds), derivatives(documents, kinds));
        let further = derivatives.iter().filter(|_| sensitivities).map(|name| Column::any(name));
        let mut columns: Vec<Column> = match columns {
            Columns::All => {
                let mut columns = complete(places(documents), &found);
                columns.extend(further);
                return Ok(PointTable::new(columns, &found));
            }
            Columns::Usual => usual(documents, &found),
            Columns::Named(names) => {
                let known = known(documents);
                let is_known = |column: &&&str| {
                    known.contains(*column) || derivatives.iter().any(|name| name == **column)
                };
                if let Some(wanted) = names.iter().find(|column| !is_known(column)) {
                    // Only the existing derivatives resemble a derivative.
                    let only = is_derivative(wanted) && !derivatives.is_empty();
                    let others = known.into_iter().filter(|_| !only);
                    let all = others.chain(derivatives.iter().map(String::as_str));
                    return Err(UnknownName::new("column", *wanted, all));
                }
                let mut wanted: Vec<&str> = Vec::new();
                for name in names {
                    if !wanted.contains(name) {
                        wanted.push(name);
                    }
                }
                wanted.into_iter().map(Column::any).collect()
            }
        };
        // Named sensitivities are a choice among all.
        let chosen = columns.iter().any(|column| derivatives.contains(&column.name));
        for column in further.filter(|_| !chosen) {
            if columns.iter().all(|known| known.title != column.title) {
                columns.push(column);
            }
        }
        let doubtful = found.iter().any(|found| !found.point.converged);
        if doubtful && columns.iter().all(|column| column.name != CONVERGED) {
            columns.push(Column::any(CONVERGED));
        }
        Ok(PointTable::new(columns, &found))
    }

    fn new(columns: Vec<Column>, found: &[Found]) -> Self {
        let row = |found: &Found| columns.iter().map(|column| found.cell(column)).collect();
        let rows = found.iter().map(row).collect();
        PointTable { rows, columns: columns.into_iter().map(|column| column.title).collect() }
    }

    /// Returns the table as comma-separated values. Numbers in the table have 15 significant
    /// digits.
    pub fn csv(&self) -> String {
        let line = |cells: Vec<String>| {
            cells.iter().map(|cell| quoted(cell)).collect::<Vec<_>>().join(",") + "\n"
        };
        self.lines(DIGITS).map(line).collect()
    }

    /// Returns the lines of the table: first the titles of the columns, then the rows, in which
    /// numbers are written with the given number of digits.
    fn lines(&self, digits: usize) -> impl Iterator<Item = Vec<String>> {
        let rows = self.rows.iter();
        let rows = rows.map(move |row| row.iter().map(|cell| cell.written(digits)).collect());
        std::iter::once(self.columns.clone()).chain(rows)
    }

    /// Returns the table as lines with aligned columns. Numbers in these lines have 10 significant
    /// digits.
    pub fn screen(&self) -> String {
        let lines: Vec<Vec<String>> = self.lines(SHOWN).collect();
        let letters = |cell: &String| cell.chars().count();
        let width = |k: usize| lines.iter().map(|row| letters(&row[k])).max().unwrap_or(0);
        let widths: Vec<usize> = (0..self.columns.len()).map(width).collect();
        let line = |row: &Vec<String>| {
            let padding =
                |(cell, width): (&String, &usize)| " ".repeat(width - letters(cell)) + cell;
            row.iter().zip(&widths).map(padding).collect::<Vec<_>>().join("  ") + "\n"
        };
        lines.iter().map(line).collect()
    }
}

/// Returns the given first columns, followed by all other columns that the listed special points
/// have.
fn complete(first: Vec<Column>, found: &[Found]) -> Vec<Column> {
    let mut parameters = distinct(found.iter().flat_map(|found| &found.branch.parameters));
    // A parameter in which documents differ is among the first columns.
    let first_has = |name: &str| first.iter().any(|column| column.title == name);
    parameters.retain(|name| *name == FILE || !first_has(name));
    let numbers = found.iter().flat_map(|found| &found.point.numbers).map(|it| &it.name);
    let monitors = found.iter().flat_map(|found| &found.branch.monitors);
    let monitors = distinct(monitors.chain(numbers));
    let own = |name: &str| first_has(name) || PLACE.contains(&name) || QUALITY.contains(&name);
    let parameter = |name| match own(name) {
        true => Column::new(format!("parameter {name}"), name, Source::Parameters),
        false => Column::new(name, name, Source::Parameters),
    };
    let monitor = |name| match own(name) || parameters.contains(&name) {
        true => Column::new(format!("monitor {name}"), name, Source::Monitors),
        false => Column::new(name, name, Source::Monitors),
    };
    let parameters: Vec<Column> = parameters.iter().copied().map(parameter).collect();
    let monitors: Vec<Column> = monitors.iter().copied().map(monitor).collect();
    let mut columns = first;
    columns.extend(PLACE.map(Column::any));
    columns.extend(parameters.into_iter().chain(monitors).chain(QUALITY.map(Column::any)));
    columns
}

/// Returns the special points of a branch for a table.
fn found<'a>(
    file: &'a str,
    document: Option<&'a Document>,
    branch: &'a Branch,
) -> impl Iterator<Item = Found<'a>> {
    branch.special.iter().map(move |point| Found { file, document, branch, point })
}

/// Returns the special points of documents, either of the given kinds or of all kinds.
fn chosen<'a>(documents: &[(&'a str, &'a Document)], kinds: &[Kind]) -> Vec<Found<'a>> {
    let mut documents = documents.to_vec();
    let keys: Vec<String> = differing(&documents).into_iter().map(String::from).collect();
    sort(&mut documents, |(_, document)| document, &keys);
    let branches = documents.into_iter().flat_map(|(file, document)| {
        document.branches.iter().flat_map(move |branch| found(file, Some(document), branch))
    });
    branches.filter(|found| kinds.is_empty() || kinds.contains(&found.point.kind)).collect()
}

/// Returns the names of all columns that a table of the special points can have.
fn known<'a>(documents: &[(&str, &'a Document)]) -> Vec<&'a str> {
    let documents = || documents.iter().map(|(_, document)| *document);
    let branches = || documents().flat_map(|document| &document.branches);
    let settings = documents().flat_map(|document| document.settings.iter().map(|(key, _)| key));
    let differences = documents().flat_map(|document| &document.differences);
    let differences = differences.flat_map(|(_, set)| set.iter().map(|(key, _)| key));
    let columns = branches().flat_map(|branch| branch.parameters.iter().chain(&branch.monitors));
    let points = branches().flat_map(|branch| &branch.special);
    let numbers = points.flat_map(|point| point.numbers.iter().map(|number| &number.name));
    let mut known: Vec<&str> = [&[FILE], &PLACE[..], &QUALITY].concat();
    known.extend(distinct(settings.chain(differences).chain(columns).chain(numbers)));
    if !known.contains(&ITINERARY) && branches().any(|branch| !branch.itinerary.is_empty()) {
        known.push(ITINERARY);
    }
    known
}

/// Returns whether a name has the form `dA/dB` of a sensitivity.
fn is_derivative(name: &str) -> bool {
    name.split_once('/').is_some_and(|(of, by)| of.starts_with('d') && by.starts_with('d'))
}

/// Returns the names of all sensitivities of special points of the given kinds.
fn derivatives(documents: &[(&str, &Document)], kinds: &[Kind]) -> Vec<String> {
    let mut names: Vec<String> = Vec::new();
    for found in chosen(documents, kinds) {
        for (name, _) in found.derivatives() {
            if !names.contains(&name) {
                names.push(name);
            }
        }
    }
    names
}

/// Returns the columns by which the special points of different documents can be distinguished.
fn places(documents: &[(&str, &Document)]) -> Vec<Column> {
    let file = (documents.len() > 1).then(|| Column::any(FILE));
    file.into_iter().chain(differing(documents).into_iter().map(Column::setting)).collect()
}

/// Returns the columns that a table has by default.
fn usual<'a>(documents: &[(&str, &'a Document)], found: &[Found<'a>]) -> Vec<Column> {
    let mut columns = places(documents);
    let keys = differing(documents);
    let values =
        |document: &'a Document| keys.iter().map(|key| setting(document, key)).collect::<Vec<_>>();
    let all: Vec<_> = documents.iter().map(|(_, document)| values(document)).collect();
    let repeated = all.iter().enumerate().any(|(k, values)| all[..k].contains(values));
    if documents.len() > 1 && !repeated {
        // The settings already identify the file.
        columns.remove(0);
    }
    columns.extend(PLACE.map(Column::any));
    let varying = distinct(found.iter().flat_map(|found| &found.branch.released));
    let monitors = distinct(found.iter().flat_map(|found| &found.branch.monitors));
    for column in varying.into_iter().chain(monitors) {
        if columns.iter().all(|known| known.title != column) {
            columns.push(Column::any(column));
        }
    }
    columns.push(Column::any(QUALITY[0]));
    columns
}

impl Found<'_> {
    fn cell(&self, Column { name, source, .. }: &Column) -> Cell {
        let own = if *source == Source::Any { self.own(name) } else { None };
        let number = || match source {
            Source::Settings => None,
            source => self.number(name, *source).map(Cell::Number),
        };
        let cell = own.or_else(number).or_else(|| self.setting(name).map(Cell::of));
        let cell = cell.or_else(|| self.derivative(name).map(Cell::Number));
        cell.unwrap_or(Cell::Text(String::new()))
    }

    /// Returns the content of a cell in one of the columns that exist for every special point.
    fn own(&self, name: &str) -> Option<Cell> {
        let Found { file, branch, point, .. } = self;
        Some(Cell::Text(match name {
            FILE => (*file).to_owned(),
            "branch" => branch.name.clone(),
            "label" => point.label.to_string(),
            "kind" => point.kind.to_string(),
            "error" if !point.converged => String::new(),
            "error" => return Some(Cell::Number(point.error)),
            "unstable" => count(point.unstable, &point.undetermined),
            CONVERGED => point.converged.to_string(),
            "multiplicity" => point.multiplicity.to_string(),
            ITINERARY if !branch.itinerary.is_empty() => branch.itinerary.clone(),
            _ => return None,
        }))
    }

    fn number(&self, name: &str, source: Source) -> Option<f64> {
        let Found { branch: Branch { parameters, monitors, .. }, point, .. } = self;
        let of = |names: &[String], values: &[f64], from: Source| {
            let position = names.iter().position(|it| it == name).filter(|_| source != from)?;
            values.get(position).copied()
        };
        let mut numbers = point.numbers.iter().filter(|_| source != Source::Parameters);
        if let Some(number) = numbers.find(|number| number.name == name) {
            return Some(number.value).filter(|_| number.is_certain());
        }
        of(monitors, &point.monitors, Source::Parameters)
            .or_else(|| of(parameters, &point.parameters, Source::Monitors))
    }

    /// Returns the derivative of a varied parameter with respect to another parameter.
    fn derivative(&self, name: &str) -> Option<f64> {
        let mut all = self.derivatives();
        all.find(|(own, _)| own == name).map(|(_, slope)| slope)
    }

    fn derivatives(&self) -> impl Iterator<Item = (String, f64)> {
        let released = &self.branch.released;
        self.point.sensitivities.iter().flat_map(move |Sensitivity { by, slopes }| {
            let named = released.iter().zip(slopes);
            named.map(move |(of, slope)| (format!("d{of}/d{by}"), *slope))
        })
    }

    /// Returns the value of a setting, which belongs to the branch or to its document.
    fn setting(&self, name: &str) -> Option<&str> {
        let Found { document, branch, .. } = self;
        let Document { differences, settings, .. } = (*document)?;
        let own = differences.iter().find(|(of, _)| *of == branch.name);
        let mut all = own.map_or(&[][..], |(_, set)| set).iter().chain(settings);
        all.find(|(key, _)| key == name).map(|(_, value)| value.as_str())
    }
}

//! Results as an interactive page: one HTML file that works without a network.
//!
//! Plotly 4.1.1 (`assets/plotly-gl3d.min.js`, licence in the same folder) draws the page. The HTML
//! file contains all data of the page as JSON: the figures that pictures also show, and the values
//! in the documents. The HTML file contains Plotly, or refers to a file that several pages share.

use super::diagram::spine;
use super::document::{Document, Plot};
use super::drawing::{hexadecimal, shade};
use super::error::FigureError;
use super::figure::{Beside, Figure, Origin, Series, Style};
use super::regions::MEANING;
use super::summary::Summary;
use super::symbols::distinguish;
use crate::core::continuation::{Branch, Number, Sensitivity, SpecialPoint};
use crate::core::problem::Profile;
use serde::Serialize;
use std::collections::BTreeMap;

const TEMPLATE: &str = include_str!("page/page.html");
const LOOK: &str = include_str!("page/page.css");
const CODE: &str = include_str!("page/page.js");
/// The script of Plotly, which draws interactive pages. Several pages can load the script from one
/// file ([`Results::plotly`](super::Results::plotly)).
///
/// ```
/// use tangency::output::{Document, Format, PLOTLY, Render, Results, example_branch};
/// let document = Document::new("Pull-in", vec![example_branch()]);
/// let documents = [("plate", &document)];
/// let whole = Results { documents: &documents, ..Results::default() };
/// let sharing = Results { plotly: Some("plotly.min.js"), ..whole };
/// let [whole, sharing] = [whole.render(Format::Html)?, sharing.render(Format::Html)?];
/// assert!(whole.len() > PLOTLY.len() && sharing.len() < 100_000);
/// # Ok::<(), tangency::output::RenderError>(())
/// ```
pub const PLOTLY: &str = include_str!("../../assets/plotly-gl3d.min.js");

/// Returns the interactive page of named documents and their figures. The page loads Plotly from
/// the address `plotly`, relative to the page; without an address the page contains Plotly.
///
/// # Errors
/// [`FigureError`] if a figure cannot be drawn.
pub(super) fn page(
    documents: &[(&str, &Document)],
    figures: &[Figure],
    plotly: Option<&str>,
) -> Result<String, FigureError> {
    for figure in figures {
        figure.extent()?;
    }
    // The branches in other columns have the symbols of the panels.
    let mut all: Vec<Figure> = figures.iter().cloned().chain([spine(documents)]).collect();
    distinguish(&mut all);
    let (spine, figures) = (all.pop().unwrap_or_default(), all);
    let data = Data {
        title: figures.first().map_or("", |figure| &figure.title),
        colours: hexadecimal(),
        logarithmic: documents.first().map_or(&[], |(_, document)| &document.plot.logarithmic),
        regions: MEANING,
        documents: documents.iter().map(|(name, it)| PageDocument::new(name, it)).collect(),
        panels: figures.iter().map(Panel::new).collect(),
        spine: Panel::new(&spine),
    };
    let title = data.title;
    let data = serde_json::to_string(&data);
    let data = data.map_err(|error| FigureError::Drawing(error.to_string()))?;
    // Without this letter no text can end the script, or start a comment in it.
    let data = data.replace('<', "\\u003c");
    let (origin, script) = match plotly {
        Some(address) => (" 'self'", format!("<script src=\"{}\"></script>", escaped(address))),
        None => ("", format!("<script>{PLOTLY}</script>")),
    };
    let head = [("origin", origin.into()), ("title", escaped(title)), ("look", LOOK.into())];
    let body = [("data", data), ("plotly", script), ("code", CODE.into())];
    Ok(filled(head.into_iter().chain(body)))
}

/// Returns the page: the template, in which each named placeholder is replaced by its content. The
/// parts must be in the order of the placeholders.
fn filled(parts: impl Iterator<Item = (&'static str, String)>) -> String {
    let mut page = String::new();
    let mut rest = TEMPLATE;
    for (name, content) in parts {
        let place = format!("{{{{{name}}}}}");
        let Some((before, after)) = rest.split_once(&place) else { continue };
        page.push_str(before);
        page.push_str(&content);
        rest = after;
    }
    page + rest
}

/// Escapes the special characters of HTML in a text.
fn escaped(text: &str) -> String {
    text.replace('&', "&amp;").replace('<', "&lt;").replace('"', "&quot;")
}

/// All data that the page contains.
#[derive(Serialize)]
struct Data<'a> {
    title: &'a str,
    colours: Vec<String>,
    /// The names of the columns with logarithmic axes.
    logarithmic: &'a [String],
    /// The explanation, for legends, of the texts beside bifurcation curves.
    regions: &'static str,
    documents: Vec<PageDocument<'a>>,
    panels: Vec<Panel<'a>>,
    /// The curves and marks of all branches, without coordinates. The page takes the coordinates of
    /// these curves and marks from the columns that the user chooses for the axes.
    spine: Panel<'a>,
}

#[derive(Serialize)]
struct PageDocument<'a> {
    name: &'a str,
    settings: &'a [(String, String)],
    /// The labels of columns and of the abscissae of profiles. The list excludes columns whose
    /// values are converted before they are shown, for example to deviations.
    labels: BTreeMap<&'a str, &'a str>,
    branches: Vec<PageBranch<'a>>,
}

impl<'a> PageDocument<'a> {
    fn new(name: &'a str, document: &'a Document) -> Self {
        let Plot { labels, deviations, shifts, .. } = &document.plot;
        let changed = |column: &str| {
            deviations.iter().any(|it| it.column == column)
                || shifts.iter().any(|(_, shifted, _)| shifted == column)
        };
        let labels = labels.iter().filter(|(column, _)| !changed(column));
        PageDocument {
            name,
            settings: &document.settings,
            labels: labels.map(|(column, label)| (&**column, &**label)).collect(),
            branches: document.branches.iter().map(PageBranch::new).collect(),
        }
    }
}

#[derive(Serialize)]
struct PageBranch<'a> {
    name: &'a str,
    /// The summary of the branch in one sentence.
    summary: String,
    warnings: &'a [String],
    released: &'a [String],
    columns: Vec<&'a str>,
    /// The names of possible axes, each with the columns that an axis of this name shows.
    shows: BTreeMap<&'a str, Vec<usize>>,
    /// The values of all points of the branch, column by column; null for missing values.
    values: Vec<Vec<Option<f64>>>,
    unstable: Vec<Option<usize>>,
    admissible: Vec<bool>,
    special: Vec<PagePoint<'a>>,
}

impl<'a> PageBranch<'a> {
    fn new(branch: &'a Branch) -> Self {
        let columns: Vec<&str> = branch.columns().collect();
        let states = columns.iter().filter_map(|column| column.strip_prefix("max_"));
        let names = columns.iter().copied().chain(states);
        let shows = names.map(|name| (name, branch.columns_showing(name)));
        let value = |column: usize| branch.points.iter().map(move |point| point.value(column));
        PageBranch {
            name: &branch.name,
            summary: Summary(branch).to_string(),
            warnings: &branch.warnings,
            released: &branch.released,
            shows: shows.collect(),
            values: (0..columns.len()).map(|column| value(column).collect()).collect(),
            unstable: branch.points.iter().map(|point| point.unstable).collect(),
            admissible: branch.points.iter().map(|point| point.admissible).collect(),
            special: branch.special.iter().map(PagePoint::new).collect(),
            columns,
        }
    }
}

#[derive(Serialize)]
struct PagePoint<'a> {
    label: usize,
    kind: String,
    meaning: &'a str,
    event: &'a str,
    /// The index of the point of the branch that precedes the special point.
    after: usize,
    converged: bool,
    /// The estimated error of the continuation parameter at the special point.
    error: f64,
    values: Vec<f64>,
    unstable: Option<usize>,
    eigenvalues: &'a [(f64, f64)],
    numbers: &'a [Number],
    sensitivities: &'a [Sensitivity],
    profiles: Vec<PageProfile<'a>>,
}

impl<'a> PagePoint<'a> {
    fn new(point: &'a SpecialPoint) -> Self {
        PagePoint {
            label: point.label,
            kind: point.kind.to_string(),
            meaning: point.kind.meaning(),
            event: &point.event,
            after: point.after,
            converged: point.converged,
            error: point.error,
            values: point.parameters.iter().chain(&point.monitors).copied().collect(),
            unstable: point.unstable,
            eigenvalues: &point.eigenvalues,
            numbers: &point.numbers,
            sensitivities: &point.sensitivities,
            profiles: point.profiles.iter().map(PageProfile::new).collect(),
        }
    }
}

#[derive(Serialize)]
struct PageProfile<'a> {
    name: &'a str,
    along: &'a str,
    points: &'a [[f64; 2]],
}

impl<'a> PageProfile<'a> {
    fn new(profile: &'a Profile) -> Self {
        PageProfile { name: &profile.name, along: &profile.along, points: &profile.points }
    }
}

/// A figure in the form that the page reads.
#[derive(Serialize)]
pub(crate) struct Panel<'a> {
    title: &'a str,
    labels: [&'a str; 2],
    /// The names of the curves in the figure, in the order of their colours.
    names: Vec<&'a str>,
    curves: Vec<Curve<'a>>,
    marks: Vec<PageMark<'a>>,
    meanings: Vec<(String, &'a str)>,
    beside: Vec<PageBeside<'a>>,
    tiles: Vec<PageTile<'a>>,
    heights: &'a [String],
    /// For each wall, the axis on which the wall is at a constant coordinate, and this coordinate.
    walls: Vec<(usize, f64)>,
    logarithmic: [bool; 2],
    /// The chosen range of each of the two axes: its lower end and its upper end.
    ends: [[Option<f64>; 2]; 2],
}

impl<'a> Panel<'a> {
    pub(crate) fn new(figure: &'a Figure) -> Self {
        let symbol = |symbol| format!("{symbol:?}");
        let marks = figure.marks.iter().map(|mark| PageMark {
            at: mark.at,
            label: &mark.label,
            meaning: &mark.meaning,
            symbol: symbol(mark.symbol),
            from: mark.origin.as_ref().map(place_of),
        });
        let tiles = figure.tiles.iter().map(|tile| PageTile {
            at: tile.at,
            size: tile.size,
            colour: shade(tile),
            meaning: &tile.meaning,
        });
        let style = |(style, meaning): &'a (Style, String)| (format!("{style:?}"), &**meaning);
        Panel {
            title: &figure.title,
            labels: [&figure.x_label, &figure.y_label],
            names: figure.names(),
            curves: figure.series.iter().filter(|it| !it.points.is_empty()).map(curve).collect(),
            marks: marks.collect(),
            meanings: figure.styles.iter().map(style).collect(),
            beside: figure.beside.iter().map(PageBeside::new).collect(),
            tiles: tiles.collect(),
            heights: &figure.y_names,
            walls: figure.walls.iter().map(|wall| (wall.axis, wall.at)).collect(),
            logarithmic: figure.logarithmic,
            ends: figure.ends,
        }
    }
}

#[derive(Serialize)]
struct Curve<'a> {
    name: &'a str,
    style: String,
    points: &'a [[f64; 2]],
    /// The origin of each point: the document, the branch, and the point or the label of the
    /// special point on the branch.
    from: Vec<Place>,
}

fn curve(series: &Series) -> Curve<'_> {
    Curve {
        name: &series.name,
        style: format!("{:?}", series.style),
        points: &series.points,
        from: series.origins.iter().map(place_of).collect(),
    }
}

/// The origin of a point: for a branch, the document, the branch, and the index of the point or the
/// negative label of the special point; for a sweep, only the run.
#[derive(Serialize)]
#[serde(untagged)]
enum Place {
    Branch(usize, usize, isize),
    Run([usize; 1]),
}

fn place_of(origin: &Origin) -> Place {
    match *origin {
        Origin::Point { document, branch, point } => {
            Place::Branch(document, branch, point as isize)
        }
        Origin::Special { document, branch, label } => {
            Place::Branch(document, branch, -(label as isize))
        }
        Origin::Run(run) => Place::Run([run]),
    }
}

#[derive(Serialize)]
struct PageMark<'a> {
    at: [f64; 2],
    label: &'a str,
    meaning: &'a str,
    symbol: String,
    from: Option<Place>,
}

/// Texts on the left and on the right of a part of a curve.
#[derive(Serialize)]
struct PageBeside<'a> {
    curve: &'a str,
    points: &'a [[f64; 2]],
    sides: &'a [String; 2],
}

impl<'a> PageBeside<'a> {
    fn new(Beside { curve, points, sides }: &'a Beside) -> Self {
        PageBeside { curve, points, sides }
    }
}

#[derive(Serialize)]
struct PageTile<'a> {
    at: [f64; 2],
    size: [f64; 2],
    colour: String,
    meaning: &'a str,
}

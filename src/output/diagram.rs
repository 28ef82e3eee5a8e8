//! Branches as a figure: stable parts solid, unstable parts dashed, special points marked.

use super::axis::{Scale, clip};
use super::document::{Document, Plot};
use super::error::FigureError;
use super::figure::{Figure, Mark, Origin, Series, Style, Symbol};
use crate::core::continuation::{Branch, Point};
use crate::core::problem::UnknownName;
use crate::core::system::Kind;

/// The diagram of all branches of some documents, each given with a name that tells its branches
/// from those of the others. Title, axes and labels are those of the first document; `x` and `y`
/// name other columns.
///
/// Every curve is drawn through its special points, and changes between solid (stable) and dashed
/// (unstable) exactly there. On the axis of a state, orbits are drawn twice: by the state's largest
/// and by its smallest value.
///
/// # Errors
/// [`FigureError::UnknownColumn`] with the columns that exist, [`FigureError::NoMonitor`] if
/// nothing says what to draw, [`FigureError::NoOrigin`] without the special point that deviations
/// are measured from, [`FigureError::Empty`] without a branch.
///
/// ```
/// use tangency::output::{Document, diagram, example_branch};
/// let document = Document::new("Pull-in", vec![example_branch()]);
/// let figure = diagram(&[("plate", &document)], None, None)?;
/// assert_eq!((figure.x_label.as_str(), figure.y_label.as_str()), ("load", "deflection"));
/// // The stable part ends in the fold, where the unstable one begins.
/// assert_eq!(figure.series[0].points.last(), Some(&[4.0 / 27.0, 1.0 / 3.0]));
/// assert_eq!(figure.series[1].points.first(), Some(&[4.0 / 27.0, 1.0 / 3.0]));
/// # Ok::<(), tangency::output::FigureError>(())
/// ```
pub fn diagram(
    documents: &[(&str, &Document)],
    x: Option<&str>,
    y: Option<&str>,
) -> Result<Figure, FigureError> {
    drawn(documents, x, y, named(documents))
}

/// The diagram of those branches that have two columns; of none, why.
pub(super) fn panel(
    documents: &[(&str, &Document)],
    x: &str,
    y: &str,
) -> Result<Figure, FigureError> {
    let all = named(documents);
    let has = |named: &&Named| {
        [x, y].iter().all(|column| !named.branch.columns_showing(column).is_empty())
    };
    let some: Vec<Named> = all.iter().filter(has).cloned().collect();
    drawn(documents, Some(x), Some(y), if some.is_empty() { all } else { some })
}

fn drawn(
    documents: &[(&str, &Document)],
    x: Option<&str>,
    y: Option<&str>,
    branches: Vec<Named>,
) -> Result<Figure, FigureError> {
    let (Some((_, document)), Some(Named { branch: first, .. })) =
        (documents.first(), branches.first())
    else {
        let title = documents.first().map(|(_, document)| document.title.clone());
        return Err(FigureError::Empty { title: title.unwrap_or_default() });
    };
    let plot = &document.plot;
    let (x, y) = axes(first, plot, x, y)?;
    let scales = [Scale::of(document, x)?, Scale::of(document, y)?];
    let mut figure = Figure::new(&document.title, plot.label(x), plot.label(y));
    for Named { name, branch, place } in &branches {
        let shift = [x, y].map(|column| plot.shift(&branch.name, column));
        let name = match shift.iter().find(|shift| **shift != 0.0) {
            Some(shift) => &format!("{name} (shifted by {shift})"),
            None => name,
        };
        let [x, y] = [columns(branch, x)?, columns(branch, y)?];
        for columns in y.into_iter().map(|y| [x[0], y]) {
            let place = *place;
            Curve { name, branch, place, columns, scales: &scales, shift }.add_to(&mut figure);
        }
    }
    let ranges = [x, y].map(|column| plot.range(column));
    clip(&mut figure, ranges);
    hide_starts(&mut figure);
    let mut points = branches.iter().flat_map(|named| &named.branch.points);
    if points.clone().any(|point| point.unstable.is_some()) {
        figure.styles = stability();
    }
    if points.clone().any(|point| point.admissible && point.undetermined.is_some()) {
        figure.styles.push((Style::DottedLine, "stability not determined".into()));
    }
    if points.any(|point| !point.admissible) {
        figure.styles.push((Style::Thin, "virtual, beyond a grazing".into()));
    }
    Ok(figure)
}

/// A branch that starts at a special point of another one needs no mark of its own there.
fn hide_starts(figure: &mut Figure) {
    // A figure that cannot be drawn is refused when it is.
    let Ok([x, y]) = figure.extent() else { return };
    let others = figure.marks.iter().filter(|mark| mark.symbol != Symbol::Ring);
    let others: Vec<[f64; 2]> = others.map(|mark| mark.at).collect();
    let near = |a: f64, b: f64, range: [f64; 2]| (a - b).abs() <= 1e-4 * (range[1] - range[0]);
    figure.marks.retain(|mark| {
        let same = |at: &[f64; 2]| near(at[0], mark.at[0], x) && near(at[1], mark.at[1], y);
        mark.symbol != Symbol::Ring || !others.iter().any(same)
    });
}

/// A branch that is drawn.
#[derive(Clone)]
struct Named<'a> {
    name: String,
    branch: &'a Branch,
    /// The positions of its document, and of the branch there.
    place: [usize; 2],
}

/// The branches with names that are unique, and that say what a curve of events is made of.
fn named<'a>(documents: &[(&str, &'a Document)]) -> Vec<Named<'a>> {
    let mut branches: Vec<Named> = Vec::new();
    for (at, (document_name, document)) in documents.iter().enumerate() {
        let curves = &document.plot.curves;
        let drawn =
            |(_, branch): &(usize, &Branch)| curves.is_empty() || curves.contains(&branch.name);
        for (index, branch) in document.branches.iter().enumerate().filter(drawn) {
            let mut name = match documents.len() {
                1 => branch.name.clone(),
                _ => format!("{document_name}: {}", branch.name),
            };
            if let Some(kind) = branch.condition {
                name.push_str(&format!(" ({} curve)", kind.meaning()));
            }
            while branches.iter().any(|other| other.name == name) {
                name.push('′');
            }
            branches.push(Named { name, branch, place: [at, index] });
        }
    }
    branches
}

fn axes<'a>(
    branch: &'a Branch,
    plot: &'a Plot,
    x: Option<&'a str>,
    y: Option<&'a str>,
) -> Result<(&'a str, &'a str), FigureError> {
    let second = match branch.condition {
        Some(_) => branch.released.get(1),
        None => None,
    };
    let no_monitor = || FigureError::NoMonitor {
        branch: branch.name.clone(),
        available: branch.columns().map(String::from).collect(),
    };
    let x = x.or(plot.x.as_deref()).or(branch.released.first().map(String::as_str));
    let y = y.or(plot.y.as_deref());
    let y = y.or(second.or(branch.monitors.first()).map(String::as_str));
    x.zip(y).ok_or_else(no_monitor)
}

/// The columns that show a quantity, at least one.
fn columns(branch: &Branch, name: &str) -> Result<Vec<usize>, FigureError> {
    let columns = branch.columns_showing(name);
    if columns.is_empty() {
        let source = UnknownName::new("column", name, branch.columns());
        return Err(FigureError::UnknownColumn { branch: branch.name.clone(), source });
    }
    Ok(columns)
}

/// One branch, seen in two of its columns.
struct Curve<'a> {
    name: &'a str,
    branch: &'a Branch,
    /// The positions of the document, and of the branch there.
    place: [usize; 2],
    /// The columns for the two axes, what is shown of their values, and what is added to that.
    columns: [usize; 2],
    scales: &'a [Scale<'a>; 2],
    shift: [f64; 2],
}

impl Curve<'_> {
    fn add_to(&self, figure: &mut Figure) {
        let mut pieces = Pieces { name: self.name, series: Vec::new() };
        let [document, branch] = self.place;
        let points = &self.branch.points;
        for (index, point) in points.iter().enumerate() {
            match self.at(|column| point.value(column)) {
                Some(at) => {
                    let origin = Origin::Point { document, branch, point: index };
                    pieces.vertex(at, origin, style_of(point));
                }
                // Eigenvalues are not known everywhere.
                None => pieces.interrupt(),
            }
            // Beyond the last point there is nothing whose stability could be taken.
            let next = points.get(index + 1).unwrap_or(point);
            for special in self.branch.special.iter().filter(|special| special.after == index) {
                let Some(at) = self.at(|column| special.value(column)) else { continue };
                let style = match special.kind {
                    // Stability does not change here.
                    Kind::EP | Kind::UZ | Kind::MX => pieces.style(),
                    _ => style_of(next),
                };
                let origin = Origin::Special { document, branch, label: special.label };
                pieces.vertex(at, origin, style);
            }
        }
        let pieces = pieces.series.into_iter().filter(|piece| !piece.points.is_empty());
        figure.series.extend(pieces);
        figure.marks.extend(self.branch.special.iter().filter_map(|special| {
            Some(Mark {
                at: self.at(|column| special.value(column))?,
                label: special.kind.to_string(),
                meaning: special.kind.meaning().into(),
                symbol: symbol(special.kind),
            })
        }));
    }

    /// A point on the axes, if it has a value on both.
    fn at(&self, value: impl Fn(usize) -> Option<f64>) -> Option<[f64; 2]> {
        let on = |axis: usize| {
            Some(self.scales[axis].shown(value(self.columns[axis])?) + self.shift[axis])
        };
        Some([on(0)?, on(1)?])
    }
}

/// The pieces of a curve, each of one style.
struct Pieces<'a> {
    name: &'a str,
    series: Vec<Series>,
}

impl Pieces<'_> {
    /// Goes on to a point, and from there in a style.
    fn vertex(&mut self, at: [f64; 2], origin: Origin, style: Style) {
        let same = self.style() == style;
        let begun = || Series::with_origins(self.name, style, [(at, origin)]);
        match self.series.last_mut() {
            Some(last) if last.points.is_empty() => *last = begun(),
            Some(last) => {
                last.points.push(at);
                last.origins.push(origin);
            }
            None => self.series.push(begun()),
        }
        if !same && self.series.last().is_some_and(|last| last.points.len() > 1) {
            self.series.push(begun());
        }
    }

    /// Leaves a gap before the next point.
    fn interrupt(&mut self) {
        if self.series.last().is_some_and(|last| !last.points.is_empty()) {
            self.series.push(Series::new(self.name, self.style(), []));
        }
    }

    fn style(&self) -> Style {
        self.series.last().map_or(Style::Solid, |last| last.style)
    }
}

/// The meanings of the styles of branches and profiles.
pub(super) fn stability() -> Vec<(Style, String)> {
    vec![(Style::Solid, "stable".into()), (Style::Dashed, "unstable".into())]
}

/// The style of a point's surroundings.
fn style_of(point: &Point) -> Style {
    match (point.admissible, &point.undetermined) {
        (false, _) => Style::Thin,
        (true, Some(_)) => Style::DottedLine,
        (true, None) => style(point.unstable),
    }
}

/// The style of what has this number of unstable eigenvalues.
pub(super) fn style(unstable: Option<usize>) -> Style {
    match unstable {
        Some(1..) => Style::Dashed,
        Some(0) | None => Style::Solid,
    }
}

fn symbol(kind: Kind) -> Symbol {
    match kind {
        Kind::LP => Symbol::Disc,
        Kind::EP | Kind::RG => Symbol::Ring,
        Kind::BP => Symbol::Square,
        Kind::HB => Symbol::Diamond,
        Kind::CP | Kind::GH | Kind::GD | Kind::GF => Symbol::Star,
        Kind::BT | Kind::R1 | Kind::R2 | Kind::GL | Kind::GP => Symbol::Triangle,
        Kind::PD => Symbol::Pentagon,
        Kind::TR => Symbol::Hexagon,
        Kind::G => Symbol::TriangleLeft,
        Kind::UZ => Symbol::TriangleDown,
        // MX, ND, and whatever has no symbol of its own.
        _ => Symbol::Cross,
    }
}

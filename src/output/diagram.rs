//! Draws branches as a figure: stable parts solid, unstable parts dashed, special points marked.

use super::axis::{Scale, clip, keep_positive};
use super::cubic::{Knot, between};
use super::document::{Document, Plot};
use super::error::FigureError;
use super::figure::{Beside, Figure, Mark, Origin, Series, Style, Symbol};
use super::number::significant;
use super::regions::{Region, regions};
use super::symbols::{distinguish, symbol};
use super::units::with_prefix;
use crate::core::continuation::{Branch, End, Point, SpecialPoint};
use crate::core::problem::UnknownName;
use crate::core::system::Kind;

/// The name `period`: the column with the period of orbits has this name, and so has the unknown if
/// the period is free.
pub(super) const PERIOD: &str = "period";

/// Draws the diagram of all branches of one or several documents. In the diagram of a single
/// document each branch has its own colour; in the diagram of several documents all branches of a
/// document have one colour and the document's given name. The first document determines the title,
/// axes and labels; the arguments `x` and `y` choose other columns for the axes. Several columns may
/// share the vertical axis; each of them has its own colour. By default the axes are the continuation
/// parameter and the first state.
///
/// Every curve passes through its special points, and changes between solid (stable) and dashed
/// (unstable) exactly at special points. If an axis shows a state, each branch of orbits is drawn
/// twice: with the largest and with the smallest value of the state along the orbit. Branches that
/// lack a column of the axes are omitted. Curves of special points are drawn only if the two axes
/// show the two parameters of the curves; on these axes, branches of solutions are omitted if such
/// curves exist.
///
/// # Errors
/// [`FigureError::UnknownColumn`] with the existing columns, [`FigureError::NoMonitor`] if no
/// column is chosen and the branch has no monitor, [`FigureError::NoOrigin`] if the special point
/// from which deviations are measured does not exist, [`FigureError::Empty`] if the documents
/// contain no branch.
///
/// ```
/// use tangency::output::{Document, diagram, example_branch};
/// let document = Document::new("Pull-in", vec![example_branch()]);
/// let figure = diagram(&[("plate", &document)], None, &[])?;
/// assert_eq!((figure.x_label.as_str(), figure.y_label.as_str()), ("load", "deflection"));
/// // The stable part ends in the fold, where the unstable one begins.
/// assert_eq!(figure.series[0].points.last(), Some(&[4.0 / 27.0, 1.0 / 3.0]));
/// assert_eq!(figure.series[1].points.first(), Some(&[4.0 / 27.0, 1.0 / 3.0]));
/// # Ok::<(), tangency::output::FigureError>(())
/// ```
pub fn diagram(
    documents: &[(&str, &Document)],
    x: Option<&str>,
    y: &[&str],
) -> Result<Figure, FigureError> {
    let branches = named(documents);
    let (Some((_, document)), Some(first)) = (documents.first(), first_of(&branches)) else {
        let title = documents.first().map(|(_, document)| document.title.clone());
        return Err(FigureError::Empty { title: title.unwrap_or_default() });
    };
    let (x, ys) = axes(first, &document.plot, x, y)?;
    let labels = ys.iter().map(|y| document.plot.label(y)).collect::<Vec<_>>().join(", ");
    let mut figure = Figure::new(&document.title, document.plot.label(x), labels);
    let shown = living_in(&branches, x, &ys)?;
    // Each of several columns has its own colour.
    let curve_name = |named: &Named, y: &str| match &ys[..] {
        [_] => named.name.clone(),
        _ if branches.len() == 1 => document.plot.label(y).to_string(),
        _ => format!("{}, {}", named.name, document.plot.label(y)),
    };
    for named in &branches {
        let is_shown = shown.iter().any(|shown| shown.place == named.place);
        for y in &ys {
            let (name, before) = (curve_name(named, y), figure.series.len());
            if is_shown {
                Named { name: name.clone(), ..named.clone() }.add_to(
                    &mut figure,
                    document,
                    [x, y],
                )?;
            }
            // An omitted curve keeps an empty series, so that the colours of the others do not change.
            if figure.series.len() == before {
                figure.series.push(Series::new(&name, Style::Solid, []));
            }
        }
    }
    let logarithmic = |column: &str| document.plot.is_logarithmic(column);
    figure.logarithmic = [logarithmic(x), ys.iter().all(|y| logarithmic(y))];
    keep_positive(&mut figure);
    let ranges = [x, ys[0]].map(|column| document.plot.range(column));
    clip(&mut figure, ranges);
    hide_starts(&mut figure);
    hide_repeated(&mut figure, &[&[x], &ys[..]].concat());
    let mut points = shown.iter().flat_map(|named| &named.branch.points);
    if points.clone().any(|point| point.unstable.is_some()) {
        figure.styles = stability();
    }
    if points.clone().any(|point| point.admissible && point.undetermined.is_some()) {
        figure.styles.push((Style::DottedLine, "stability not determined".into()));
    }
    if points.any(|point| !point.admissible) {
        figure.styles.push((Style::Thin, "virtual, beyond a grazing".into()));
    }
    distinguish(std::slice::from_mut(&mut figure));
    Ok(figure)
}

/// Returns the curves and marks of all drawn branches, for uses that need only their order, styles
/// and origins, but no coordinates on particular axes. Both coordinates of every returned point are
/// the value of the continuation parameter.
pub(super) fn spine(documents: &[(&str, &Document)]) -> Figure {
    let mut figure = Figure::default();
    for Named { name, branch, place } in &named(documents) {
        let released = branch.released.first().and_then(|name| branch.column(name));
        let columns = [released.unwrap_or_default(); 2];
        let scales = &[Scale::PLAIN; 2];
        let (place, plot, shift) = (*place, &documents[place[0]].1.plot, [0.0; 2]);
        let curve = Curve { name, branch, place, plot, columns, scales, shift };
        curve.add_to(&mut figure, false);
    }
    figure
}

/// Hides the mark at the start of a branch if a special point with another mark is at the same
/// position.
fn hide_starts(figure: &mut Figure) {
    // An invalid figure is reported when it is drawn.
    let Ok([x, y]) = figure.extent() else { return };
    let others = figure.marks.iter().filter(|mark| mark.symbol != Symbol::Ring);
    let others: Vec<[f64; 2]> = others.map(|mark| mark.at).collect();
    let logarithmic = figure.logarithmic;
    let near = |axis: usize, a: f64, b: f64, range: [f64; 2]| {
        let [a, b, low, high] =
            [a, b, range[0], range[1]].map(|it| if logarithmic[axis] { it.ln() } else { it });
        (a - b).abs() <= 1e-4 * (high - low)
    };
    figure.marks.retain(|mark| {
        let same = |at: &[f64; 2]| near(0, at[0], mark.at[0], x) && near(1, at[1], mark.at[1], y);
        mark.symbol != Symbol::Ring || !others.iter().any(same)
    });
}

/// Heuristic: if at least this number of user-defined points have the same label, and an axis shows
/// the column that the label names, the labels of these points are omitted.
const REPEATED: usize = 3;

/// Removes labels such as `gap = 1` from user-defined points if three or more of these points have
/// the same label and an axis shows `gap`.
fn hide_repeated(figure: &mut Figure, axes: &[&str]) {
    let of_axis = |mark: &Mark| {
        let column = mark.label.split_once(" = ").map(|(column, _)| column);
        mark.symbol == Symbol::TriangleDown && column.is_some_and(|name| axes.contains(&name))
    };
    let labels: Vec<String> =
        figure.marks.iter().filter(|it| of_axis(it)).map(|it| it.label.clone()).collect();
    for mark in figure.marks.iter_mut().filter(|mark| of_axis(mark)) {
        if labels.iter().filter(|label| **label == mark.label).count() >= REPEATED {
            mark.label.clear();
        }
    }
}

/// A branch that a diagram draws.
#[derive(Clone)]
struct Named<'a> {
    name: String,
    branch: &'a Branch,
    /// The index of the document among the drawn documents, and the index of the branch in this
    /// document.
    place: [usize; 2],
}

/// Returns the default axes of the diagram; `None` if the documents contain no branch.
pub(crate) fn usual_axes(documents: &[(&str, &Document)]) -> Option<[String; 2]> {
    let branches = named(documents);
    let (x, y) = axes(first_of(&branches)?, &documents.first()?.1.plot, None, &[]).ok()?;
    Some([x.to_owned(), y[0].to_owned()])
}

/// Returns the branch that determines the default axes: the first branch of solutions.
fn first_of<'a>(branches: &[Named<'a>]) -> Option<&'a Branch> {
    let solutions = branches.iter().find(|named| named.branch.condition.is_none());
    solutions.or(branches.first()).map(|named| named.branch)
}

/// Returns the branches that can be drawn on the given axes.
///
/// # Errors
/// [`FigureError::UnknownColumn`] if no branch contains the columns of the axes.
fn living_in<'a>(
    branches: &[Named<'a>],
    x: &str,
    ys: &[&str],
) -> Result<Vec<Named<'a>>, FigureError> {
    let shows = |named: &Named, column: &str| !named.branch.columns_showing(column).is_empty();
    let has = |named: &&Named| shows(named, x) && ys.iter().any(|y| shows(named, y));
    let known: Vec<&Named> = branches.iter().filter(has).collect();
    for name in std::iter::once(&x).chain(ys) {
        let missing = !known.iter().any(|named| shows(named, name));
        if let Some(without) = branches.iter().find(|named| missing && !shows(named, name)) {
            columns(without.branch, name)?;
        }
    }
    let is_axis = |name: &String| name == x || ys.contains(&name.as_str());
    let in_plane = |named: &&&Named| {
        named.branch.condition.is_some() && named.branch.released.iter().all(is_axis)
    };
    let of_solutions = |named: &&&Named| named.branch.condition.is_none();
    let chosen: Vec<&Named> = match known.iter().any(|named| in_plane(&named)) {
        true => known.iter().filter(in_plane).copied().collect(),
        false => known.iter().filter(of_solutions).copied().collect(),
    };
    // Curves of special points alone may be drawn in any of their columns.
    Ok((if chosen.is_empty() { known } else { chosen }).into_iter().cloned().collect())
}

impl Named<'_> {
    /// Adds the branch to a figure whose axes show two columns, if the branch contains both
    /// columns.
    fn add_to(
        &self,
        figure: &mut Figure,
        document: &Document,
        axes: [&str; 2],
    ) -> Result<(), FigureError> {
        let Named { name, branch, place } = self;
        let scales = [Scale::of(document, axes[0])?, Scale::of(document, axes[1])?];
        let shift = axes.map(|column| document.plot.shift(&branch.name, column));
        let name = match axes.iter().zip(shift).find(|(_, shift)| *shift != 0.0) {
            Some((column, shift)) => {
                let sign = if shift > 0.0 { '+' } else { '−' };
                &format!("{name} ({column} {sign} {})", significant(shift.abs(), 6))
            }
            None => name,
        };
        let [x, y] = axes.map(|column| branch.columns_showing(column));
        for columns in x.first().into_iter().flat_map(|x| y.iter().map(|y| [*x, *y])) {
            let place = *place;
            let plot = &document.plot;
            let curve = Curve { name, branch, place, plot, columns, scales: &scales, shift };
            curve.add_to(figure, true);
            if document.plot.regions && scales.iter().all(Scale::is_plain) {
                curve.add_regions(figure);
            }
        }
        Ok(())
    }
}

/// Returns the branches with the names that the diagram shows. In a diagram of a single document,
/// names are unique, and the name of a curve of special points describes their kind; in a diagram
/// of several documents, each branch has the name and colour of its document.
fn named<'a>(documents: &[(&str, &'a Document)]) -> Vec<Named<'a>> {
    let mut document_names: Vec<String> = Vec::new();
    for (name, _) in documents {
        let mut name = (*name).to_owned();
        while document_names.contains(&name) {
            name.push('′');
        }
        document_names.push(name);
    }
    let mut branches: Vec<Named> = Vec::new();
    for (at, (_, document)) in documents.iter().enumerate() {
        let curves = &document.plot.curves;
        let drawn =
            |(_, branch): &(usize, &Branch)| curves.is_empty() || curves.contains(&branch.name);
        for (index, branch) in document.branches.iter().enumerate().filter(drawn) {
            if documents.len() > 1 {
                branches.push(Named {
                    name: document_names[at].clone(),
                    branch,
                    place: [at, index],
                });
                continue;
            }
            let mut name = branch.name.clone();
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

/// Returns the name of the curve that shows a branch of one of the documents in the diagram.
pub(super) fn curve_name(documents: &[(&str, &Document)], branch: &Branch) -> Option<String> {
    let named = named(documents).into_iter();
    named.filter(|named| std::ptr::eq(named.branch, branch)).map(|named| named.name).next()
}

fn axes<'a>(
    branch: &'a Branch,
    plot: &'a Plot,
    x: Option<&'a str>,
    y: &[&'a str],
) -> Result<(&'a str, Vec<&'a str>), FigureError> {
    let second = match branch.condition {
        Some(_) => branch.released.get(1),
        None => None,
    };
    let no_monitor = || FigureError::NoMonitor {
        branch: branch.name.clone(),
        available: branch.columns().map(String::from).collect(),
    };
    let x = x.or(plot.x.as_deref()).or(branch.released.first().map(String::as_str));
    let x = x.ok_or_else(no_monitor)?;
    if !y.is_empty() {
        return Ok((x, y.to_vec()));
    }
    let y = plot.y.as_deref().or(second.map(String::as_str));
    let y = y.or_else(|| first_quantity(branch)).ok_or_else(no_monitor)?;
    Ok((x, vec![y]))
}

/// Returns the branches of a document that are drawn.
pub(super) fn drawn_of(document: &Document) -> impl Iterator<Item = &Branch> {
    let curves = &document.plot.curves;
    document.branches.iter().filter(|it| curves.is_empty() || curves.contains(&it.name))
}

/// Returns whether the solutions of a branch are orbits with an unknown period; the unknown is
/// either the period itself or the durations of parts of the orbit.
pub(super) fn has_free_period(branch: &Branch) -> bool {
    let any = |known: fn(&str) -> bool| branch.unknowns.iter().any(|group| known(&group.name));
    let durations = any(|name| name.starts_with("duration[")) && !any(|name| name == "start");
    branch.column(PERIOD).is_some() && (any(|name| name == PERIOD) || durations)
}

/// Returns the name of the first recorded quantity of a branch other than the period; for orbits it
/// is the first state.
fn first_quantity(branch: &Branch) -> Option<&str> {
    let mut others = branch.monitors.iter().map(String::as_str).filter(|name| *name != PERIOD);
    let first = others.next().or(branch.monitors.first().map(String::as_str))?;
    let state = first.strip_prefix("max_");
    let has_least = |state: &&str| branch.column(&format!("min_{state}")).is_some();
    Some(state.filter(has_least).unwrap_or(first))
}

/// Returns the columns of a branch that show a quantity: for a state of orbits, its maximum and its
/// minimum.
fn columns(branch: &Branch, name: &str) -> Result<Vec<usize>, FigureError> {
    let columns = branch.columns_showing(name);
    if columns.is_empty() {
        let source = UnknownName::new("column", name, branch.columns());
        return Err(FigureError::UnknownColumn { branch: branch.name.clone(), source });
    }
    Ok(columns)
}

/// A branch, drawn with two of its columns as axes.
struct Curve<'a> {
    name: &'a str,
    branch: &'a Branch,
    /// The index of the document among the drawn documents, and the index of the branch in this
    /// document.
    place: [usize; 2],
    plot: &'a Plot,
    /// The columns on the two axes, the scales of these columns, and the numbers that are added to
    /// the shown values.
    columns: [usize; 2],
    scales: &'a [Scale<'a>; 2],
    shift: [f64; 2],
}

impl Curve<'_> {
    /// Adds the curve and its marks to a figure: either cubics between the points, or the points
    /// connected by lines.
    fn add_to(&self, figure: &mut Figure, cubic: bool) {
        figure.series.extend(self.pieces(cubic));
        self.add_marks(figure);
    }

    /// Returns the pieces of the drawn branch, each with one line style.
    fn pieces(&self, cubic: bool) -> Vec<Series> {
        let mut pieces = Pieces { name: self.name, series: Vec::new() };
        let [document, branch] = self.place;
        let points = &self.branch.points;
        let ranges = self.ranges();
        let mut last: Option<(Knot, Origin)> = None;
        let mut reach = |pieces: &mut Pieces, knot: Option<Knot>, origin: Origin| {
            if let (true, Some((from, origin)), Some(to)) = (cubic, &last, &knot) {
                for vertex in between(from, to, ranges) {
                    let at = self.at(|column| Some(vertex[usize::from(column != self.columns[0])]));
                    let style = pieces.style();
                    at.into_iter().for_each(|at| pieces.vertex(at, *origin, style));
                }
            }
            last = knot.map(|knot| (knot, origin));
        };
        for (index, point) in points.iter().enumerate() {
            let origin = Origin::Point { document, branch, point: index };
            reach(&mut pieces, Knot::of_point(point, self.columns), origin);
            match self.at(|column| point.value(column)) {
                Some(at) => pieces.vertex(at, origin, style_of(point)),
                // Eigenvalues are not known everywhere.
                None => pieces.interrupt(),
            }
            // After the last point no stability is defined.
            let next = points.get(index + 1).unwrap_or(point);
            let known = |special: &&SpecialPoint| special.after == index && special.converged;
            for special in self.branch.special.iter().filter(known) {
                let Some(at) = self.at(|column| special.value(column)) else { continue };
                let style = match special.kind {
                    // Stability does not change here.
                    Kind::EP | Kind::UZ | Kind::RG | Kind::MX => pieces.style(),
                    _ => style_of(next),
                };
                let origin = Origin::Special { document, branch, label: special.label };
                reach(&mut pieces, Knot::of_special(special, self.columns), origin);
                pieces.vertex(at, origin, style);
            }
        }
        pieces.series.into_iter().filter(|piece| !piece.points.is_empty()).collect()
    }

    /// Returns the lengths of the ranges of the two columns along the branch.
    fn ranges(&self) -> [f64; 2] {
        self.columns.map(|column| {
            let values = self.branch.points.iter().filter_map(|point| point.value(column));
            let ends = values.fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], value| {
                [value.min(low), value.max(high)]
            });
            (ends[1] - ends[0]).max(f64::MIN_POSITIVE)
        })
    }

    /// Adds the marks of the special points to a figure. Regular points that were saved on request
    /// are not marked, because they may be many.
    fn add_marks(&self, figure: &mut Figure) {
        let Curve { plot, .. } = *self;
        let [document, branch] = self.place;
        let marks = |it: &&SpecialPoint| it.kind != Kind::RG && !self.is_bound(it);
        let marked = self.branch.special.iter().filter(marks);
        figure.marks.extend(marked.filter_map(|special| {
            let at = self.at(|column| special.value(column))?;
            let (kind, meaning) = (special.kind.to_string(), special.kind.meaning().into());
            let symbol = symbol(special.kind);
            let origin = Some(Origin::Special { document, branch, label: special.label });
            Some(match (special.converged, special.kind) {
                (false, Kind::MX) | (true, _) if special.kind != Kind::UZ => {
                    Mark { at, label: kind, meaning, symbol, origin }
                }
                (true, _) => {
                    let label = event(plot, special);
                    Mark { at, label, meaning, symbol, origin }
                }
                (false, _) => {
                    let (label, symbol) = (format!("{kind}?"), Symbol::Doubtful);
                    Mark { at, label, meaning: "not converged".into(), symbol, origin }
                }
            })
        }));
    }

    /// Adds the numbers of unstable directions on the two sides of a bifurcation curve to a figure.
    fn add_regions(&self, figure: &mut Figure) {
        let beside = |Region { points: [first, last], sides }: Region| {
            let points = self.branch.points.get(first..=last).unwrap_or_default().iter();
            let points = points.filter_map(|point| self.at(|column| point.value(column)));
            Beside { curve: self.name.to_owned(), points: points.collect(), sides }
        };
        figure.beside.extend(regions(self.branch, self.columns).into_iter().map(beside));
    }

    /// Returns whether a special point is only the end of the branch at a bound of a parameter or
    /// monitor; such ends are not marked.
    fn is_bound(&self, special: &SpecialPoint) -> bool {
        let all = &self.branch.special;
        let ends = [all.first(), all.last()].into_iter().zip(&self.branch.ends);
        let at_bound = |(point, end): (Option<&SpecialPoint>, &End)| {
            let bound = matches!(end, End::ParameterBound { .. } | End::MonitorBound { .. });
            bound && point.is_some_and(|point| point.label == special.label)
        };
        special.kind == Kind::EP && ends.into_iter().any(at_bound)
    }

    /// Returns a point in the coordinates of the axes, if the point has values for both axes.
    fn at(&self, value: impl Fn(usize) -> Option<f64>) -> Option<[f64; 2]> {
        let on = |axis: usize| {
            Some(self.scales[axis].shown(value(self.columns[axis])?) + self.shift[axis])
        };
        Some([on(0)?, on(1)?])
    }
}

/// Returns the label of a user-defined point, such as `gap = 2 µm`, with the unit prefix of the
/// axis that shows the column.
pub(super) fn event(plot: &Plot, special: &SpecialPoint) -> String {
    let parts = special.event.split_once(" = ");
    let shown = parts.and_then(|(column, value)| {
        let value = with_prefix(value.parse().ok()?, plot.label(column))?;
        Some(format!("{column} = {value}"))
    });
    shown.unwrap_or_else(|| special.event.clone())
}

/// The pieces of a curve, each with one line style.
struct Pieces<'a> {
    name: &'a str,
    series: Vec<Series>,
}

impl Pieces<'_> {
    /// Extends the curve to a point, and sets the line style that begins at this point.
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

    /// Inserts a gap into the drawn curve before its next point.
    fn interrupt(&mut self) {
        if self.series.last().is_some_and(|last| !last.points.is_empty()) {
            self.series.push(Series::new(self.name, self.style(), []));
        }
    }

    fn style(&self) -> Style {
        self.series.last().map_or(Style::Solid, |last| last.style)
    }
}

/// Returns the line styles of branches and profiles with their meanings.
pub(super) fn stability() -> Vec<(Style, String)> {
    vec![(Style::Solid, "stable".into()), (Style::Dashed, "unstable".into())]
}

/// Returns the line style of a branch at a point.
fn style_of(point: &Point) -> Style {
    match (point.admissible, &point.undetermined) {
        (false, _) => Style::Thin,
        (true, Some(_)) => Style::DottedLine,
        (true, None) => style(point.unstable),
    }
}

/// Returns the line style of solutions with a given number of unstable eigenvalues.
pub(super) fn style(unstable: Option<usize>) -> Style {
    match unstable {
        Some(1..) => Style::Dashed,
        Some(0) | None => Style::Solid,
    }
}

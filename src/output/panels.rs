//! The figures of a document: diagrams, and profiles of special points.

use super::axis::{Scale, clip, keep_positive};
use super::diagram::{PERIOD, diagram, drawn_of, has_free_period, usual_axes};
use super::document::{Against, Document, Enlargement, Plot};
use super::error::{FigureError, UnknownPoint};
use super::fields::fields;
use super::figure::{Figure, Series, Style};
use super::profiles::{TIME, named, portrait, profiles};
#[cfg(feature = "live")]
use super::sweeps::SweepTable;
use super::sweeps::{Sweeps, basins, scatter};
use super::symbols::distinguish;
use super::tile::Tile;
use super::units::parts;
use crate::core::continuation::Branch;
use crate::core::problem::UnknownName;
use std::collections::BTreeSet;

/// Returns the figures of one or several documents: the diagram, its enlargements, the additional
/// panels that the first document defines, panels for curves of special points that no other panel
/// shows, and one figure for each kind of profile (mode shapes, time histories, phase portraits)
/// and for each field of special points. If the first document defines neither axes nor panels, a
/// panel of the period is added for orbits with a free period. The settings [`Plot::profiles`] and
/// [`Plot::points`] of the first document select the profiles to draw, and the special points whose
/// profiles are drawn. By default, the figures show a phase portrait and a time history of up to
/// three different orbits; for other solutions, they show the profiles of the user-defined points
/// and, for comparison, of the first end of the branch. If `x` or `y` is given, only the diagram
/// with these columns on its axes is returned; for simulated histories, these columns may be states
/// and the time.
///
/// [`Plot::profiles`]: super::Plot::profiles
/// [`Plot::points`]: super::Plot::points
///
/// # Errors
/// The errors of [`diagram`]; [`FigureError::UnknownPoint`] and [`FigureError::UnknownProfile`] for
/// points and profiles that do not exist.
///
/// ```
/// use tangency::output::{Document, example_branch, figures};
/// let document = Document::new("Pull-in", vec![example_branch()]);
/// assert_eq!(figures(&[("plate", &document)], &[], None, &[])?.len(), 1);
/// # Ok::<(), tangency::output::FigureError>(())
/// ```
pub fn figures(
    documents: &[(&str, &Document)],
    sweeps: &[Sweeps],
    x: Option<&str>,
    y: &[&str],
) -> Result<Vec<Figure>, FigureError> {
    let plots = documents.iter().map(|(_, document)| &document.plot);
    let plot = plots.chain(sweeps.iter().map(|sweep| &sweep.plot)).next();
    plot.map_or(Ok(()), |plot| check_logarithmic(plot, documents, sweeps))?;
    let asked = x.is_some() || !y.is_empty();
    let of_histories =
        sweeps.is_empty() && documents.iter().all(|(_, document)| of_histories(document));
    if let (true, true, Some(portrait)) = (of_histories, asked, portrait(documents, x, y)?) {
        let figures = vec![portrait];
        check_axes(plot, &figures)?;
        return Ok(figures);
    }
    // The diagram of histories would have one point.
    let histories = of_histories && !asked;
    let mut figures = match (histories, sweeps.is_empty()) {
        (true, _) => Vec::new(),
        (false, true) => vec![diagram(documents, x, y)?],
        (false, false) => vec![together(documents, sweeps, x, y)?],
    };
    if x.is_some() || !y.is_empty() {
        check_axes(plot, &figures)?;
        return Ok(figures);
    }
    let Some(plot) = plot else { return Ok(figures) };
    // An enlargement belongs to the columns that the scene draws.
    let mut columns = [&plot.x, &plot.y].into_iter().flatten();
    let replaced = !sweeps.is_empty() && !columns.all(|it| has(it, documents, sweeps));
    for Enlargement { x, y } in plot.enlargements.iter().filter(|_| !histories && !replaced) {
        let mut part = Figure { title: String::new(), ..figures[0].clone() };
        clip(&mut part, [*x, *y]);
        figures.push(part);
    }
    let swept = plot.swept.iter().filter(|_| !sweeps.is_empty());
    for (x, y) in plot.panels.iter().chain(swept) {
        let mut panel = match sweeps.is_empty() {
            true => diagram(documents, Some(x), &[y])?,
            false => together(documents, sweeps, Some(x), &[y])?,
        };
        panel.title = String::new();
        figures.push(panel);
    }
    let usual = if histories { Vec::new() } else { usual_panels(documents, plot) };
    for (x, y) in &usual {
        let mut panel = match sweeps.is_empty() {
            true => diagram(documents, Some(x), &[y])?,
            false => together(documents, sweeps, Some(x), &[y])?,
        };
        panel.title = String::new();
        // Branches that have just started have no points.
        if !matches!(panel.extent(), Err(FigureError::Empty { .. })) {
            figures.push(panel);
        }
    }
    for (_, document) in documents {
        for against in &document.plot.against {
            figures.push(special_points_against(document, against));
        }
    }
    let drawn = figures.first().map_or(Vec::new(), Figure::names);
    let drawn: Vec<String> = drawn.into_iter().map(String::from).collect();
    figures.extend(profiles(documents, drawn)?);
    figures.extend(fields(documents)?);
    check_axes(Some(plot), &figures)?;
    if let (true, Some(first), Some((_, document))) =
        (histories, figures.first_mut(), documents.first())
    {
        first.title.clone_from(&document.title);
    }
    distinguish(&mut figures);
    Ok(figures)
}

/// Whether a branch or a sweep has a column with the given name.
fn has(name: &str, documents: &[(&str, &Document)], sweeps: &[Sweeps]) -> bool {
    let mut branches = documents.iter().flat_map(|(_, document)| &document.branches);
    let mut tables = sweeps.iter().flat_map(|sweeps| &sweeps.sweeps);
    tables.any(|table| table.has_column(name))
        || branches.any(|branch| !branch.columns_showing(name).is_empty())
}

/// Returns an error if a logarithmic axis is requested for a column that does not exist.
fn check_logarithmic(
    plot: &Plot,
    documents: &[(&str, &Document)],
    sweeps: &[Sweeps],
) -> Result<(), FigureError> {
    let unknown = plot.logarithmic.iter().find(|name| !has(name, documents, sweeps));
    let Some(unknown) = unknown else { return Ok(()) };
    let branches = documents.iter().flat_map(|(_, document)| &document.branches);
    let of_branches = branches.flat_map(Branch::columns);
    let tables = sweeps.iter().flat_map(|sweeps| &sweeps.sweeps);
    let of_tables = tables.flat_map(|table| table.run_columns.iter().chain(&table.point_columns));
    let known: BTreeSet<&str> = of_branches.chain(of_tables.map(String::as_str)).collect();
    Err(FigureError::NoColumn(UnknownName::new("column", unknown, known)))
}

/// Returns an error if logarithmic axes are requested but no figure has an axis that shows the
/// columns.
fn check_axes(plot: Option<&Plot>, figures: &[Figure]) -> Result<(), FigureError> {
    let names = plot.map_or(&[][..], |plot| &plot.logarithmic);
    let has = figures.iter().any(|figure| figure.logarithmic != [false; 2]);
    match names.is_empty() || has {
        true => Ok(()),
        false => Err(FigureError::NotLogarithmic { names: names.to_vec() }),
    }
}

/// Restricts the plot of a document to the columns, curves and ranges that the document's own branches
/// have; for example, a restarted scene has only one branch.
pub(crate) fn restrict_plot(document: &mut Document) {
    restrict_columns(document);
    drop_missing_profiles(document);
}

fn restrict_columns(document: &mut Document) {
    document.plot = document.plot.restricted(&document.branches);
    let drawn = |document: &Document| diagram(&[("", document)], None, &[]);
    if drawn(document).is_ok_and(|whole| whole.extent().is_err()) {
        document.plot.ranges.clear();
    }
    let Ok(whole) = drawn(document) else { return };
    document.plot.enlargements.retain(|Enlargement { x, y }| {
        let mut part = whole.clone();
        clip(&mut part, [*x, *y]);
        part.extent().is_ok()
    });
}

/// Removes the chosen profiles from a document's plot if the shown special points lack one of them.
fn drop_missing_profiles(document: &mut Document) {
    if matches!(profiles(&[("", document)], Vec::new()), Err(FigureError::UnknownProfile(_))) {
        document.plot.profiles.clear();
    }
}

/// Restricts the plot of a document to the finished branches, because some runs of the scene were not
/// traced. Unlike a restart, an early end of the scene leaves the labels of special points unchanged.
pub(crate) fn restrict_to_finished(document: &mut Document) {
    let points = document.plot.points.clone();
    restrict_columns(document);
    document.plot.points = points;
    remove_missing_points(document, |_| true);
    drop_missing_profiles(document);
}

/// Removes special points from a document's plot if the named branches do not have them, for example
/// because a changed setting ended a branch early, and adds a warning for each removed point.
pub(crate) fn drop_missing_points(document: &mut Document) {
    let lacks = |cause: &FigureError| {
        use UnknownPoint::{Form, Label};
        matches!(cause, FigureError::UnknownPoint(Label { .. } | Form(_)))
    };
    for (wanted, cause) in remove_missing_points(document, lacks) {
        let of_branch = wanted.rsplit_once('/').map(|(branch, _)| branch.trim());
        let branches = &mut document.branches;
        let own = branches.iter().position(|branch| Some(&*branch.name) == of_branch);
        if let Some(branch) = branches.get_mut(own.unwrap_or(0)) {
            branch.warnings.push(format!(
                "the picture lacks the special point `{wanted}` that the scene names: {cause}"
            ));
        }
    }
}

/// Removes special points from a document's plot if they are missing for a reason that `counts`, and
/// returns the removed points with the reasons.
fn remove_missing_points(
    document: &mut Document,
    counts: impl Fn(&FigureError) -> bool,
) -> Vec<(String, FigureError)> {
    let mut removed = Vec::new();
    for wanted in std::mem::take(&mut document.plot.points) {
        match named(&[("", document)], std::slice::from_ref(&wanted)).map(|_| ()) {
            Err(cause) if counts(&cause) => removed.push((wanted, cause)),
            _ => document.plot.points.push(wanted),
        }
    }
    removed
}

/// Returns the panels that are added by default: a panel of the free period, if the first document
/// does not define its plot, and panels of curves of special points that no other panel shows.
fn usual_panels(documents: &[(&str, &Document)], plot: &Plot) -> Vec<(String, String)> {
    let Some([x, y]) = usual_axes(documents) else { return Vec::new() };
    let branches = || documents.iter().flat_map(|(_, document)| drawn_of(document));
    let mut panels = Vec::new();
    let own = plot.y.is_none() && plot.panels.is_empty();
    if own && y != PERIOD && branches().any(|it| has_free_period(it) && it.column(&x).is_some()) {
        panels.push((x.clone(), PERIOD.to_owned()));
    }
    for branch in branches().filter(|branch| branch.condition.is_some()) {
        let [first, second, ..] = &branch.released[..] else { continue };
        let mut known = plot.panels.iter().chain(&panels).chain(&plot.swept);
        let shows =
            |[x, y]: [&String; 2]| (x == first && y == second) || (x == second && y == first);
        if !shows([&x, &y]) && !known.any(|(x, y)| shows([x, y])) {
            panels.push((first.clone(), second.clone()));
        }
    }
    panels
}

/// Returns whether a document contains only simulated histories, without varied parameters.
pub(super) fn of_histories(document: &Document) -> bool {
    let in_time = |branch: &Branch| {
        let mut profiles = branch.special.iter().flat_map(|point| &point.profiles);
        branch.points.len() == 1 && profiles.any(|profile| profile.along == TIME)
    };
    !document.branches.is_empty() && document.branches.iter().all(in_time)
}

/// Returns an error if the diagram or a panel uses columns that the branches of a document do not
/// contain. The check also works for branches that do not contain any points yet, so that errors
/// are reported before the computation.
pub(crate) fn check_columns(document: &Document) -> Result<(), FigureError> {
    let mut plain = document.clone();
    // Special points are not known yet.
    plain.plot.deviations.clear();
    let documents = [("", &plain)];
    check_logarithmic(&plain.plot, &documents, &[])?;
    diagram(&documents, None, &[])?;
    for (x, y) in &document.plot.panels {
        diagram(&documents, Some(x), &[y])?;
    }
    Ok(())
}

/// Returns one diagram of the branches of documents and the results of sweeps. If sweeps are drawn,
/// a column of the axes need not exist in all branches and sweeps.
fn together(
    documents: &[(&str, &Document)],
    sweeps: &[Sweeps],
    x: Option<&str>,
    y: &[&str],
) -> Result<Figure, FigureError> {
    let (Some(first), Some(table)) = (sweeps.first(), sweeps.iter().find_map(|s| s.sweeps.first()))
    else {
        return diagram(documents, x, y);
    };
    let plot = documents.first().map_or(&first.plot, |(_, document)| &document.plot);
    let title = documents.first().map_or(&first.title, |(_, document)| &document.title);
    let tables = || sweeps.iter().flat_map(|sweeps| &sweeps.sweeps);
    // The scene may draw columns of branches that sweeps lack.
    let [stated_x, stated_y] = [&plot.x, &plot.y]
        .map(|column| column.as_deref().filter(|name| has(name, documents, sweeps)));
    let x = x.or(stated_x).or(table.axes.first().map(String::as_str)).unwrap_or("run");
    // By default the second axis of a grid, or the first state.
    let own = table.axes.get(1).map(String::as_str).or(table.first_state());
    let y = y.first().copied().or(stated_y).or(own).unwrap_or("periods");
    let mut tiles: Vec<Tile> = tables().flat_map(|table| basins(table, x, y)).collect();
    let mut scattered: Vec<Series> = match tiles.is_empty() {
        true => tables().flat_map(|table| scatter(table, x, y)).collect(),
        false => Vec::new(),
    };
    if let Some((_, document)) = documents.first() {
        rescale(document, [x, y], &mut scattered)?;
        let scales = [Scale::of(document, x)?, Scale::of(document, y)?];
        for Tile { at, size, .. } in &mut tiles {
            *size = [0, 1].map(|k| scales[k].shown(at[k] + size[k]) - scales[k].shown(at[k]));
            *at = [0, 1].map(|k| scales[k].shown(at[k]));
        }
    }
    let mut figure = match diagram(documents, Some(x), &[y]) {
        Ok(figure) => figure,
        Err(FigureError::Empty { .. } | FigureError::UnknownColumn { .. })
            if !(scattered.is_empty() && tiles.is_empty()) =>
        {
            Figure::new(title, swept_label(plot, x), swept_label(plot, y))
        }
        Err(FigureError::Empty { .. }) => {
            let known = table.run_columns.iter().chain(&table.point_columns).map(String::as_str);
            let wanted = if scatter(table, x, "run").is_empty() { x } else { y };
            let source = UnknownName::new("column", wanted, known);
            return Err(FigureError::UnknownColumn { branch: table.name.clone(), source });
        }
        Err(error) => return Err(error),
    };
    figure.title.clone_from(title);
    // Only the last of several sweeps has small dots, so that coincident points of all sweeps are
    // visible.
    let last = scattered.iter().rposition(|series| series.style == Style::Specks);
    for series in scattered.iter_mut().take(last.unwrap_or_default()) {
        if series.style == Style::Specks {
            series.style = Style::Blots;
        }
    }
    // Specks and blots have the first colours, single dots the last ones.
    let (first, last): (Vec<Series>, Vec<Series>) =
        scattered.into_iter().partition(|series| series.style != Style::Dots);
    figure.series.splice(0..0, first);
    figure.series.extend(last);
    figure.tiles = tiles;
    figure.logarithmic = [x, y].map(|column| plot.is_logarithmic(column));
    keep_positive(&mut figure);
    clip(&mut figure, [x, y].map(|column| plot.range(column)));
    Ok(figure)
}

/// Converts the points of sweeps to the units of the axes of a document's diagram.
fn rescale(
    document: &Document,
    axes: [&str; 2],
    scattered: &mut [Series],
) -> Result<(), FigureError> {
    let scales = [Scale::of(document, axes[0])?, Scale::of(document, axes[1])?];
    for at in scattered.iter_mut().flat_map(|series| &mut series.points) {
        *at = [0, 1].map(|k| scales[k].shown(at[k]));
    }
    Ok(())
}

/// Returns the points of a sweep in the axes of a document's diagram.
///
/// # Errors
/// [`FigureError::NoOrigin`] if the special point from which deviations are measured does not exist.
#[cfg(feature = "live")]
pub(crate) fn specks(
    document: &Document,
    table: &SweepTable,
    axes: [&str; 2],
) -> Result<Vec<[f64; 2]>, FigureError> {
    let mut scattered = scatter(table, axes[0], axes[1]);
    rescale(document, axes, &mut scattered)?;
    Ok(scattered.into_iter().flat_map(|series| series.points).collect())
}

/// Returns the label of a column that sweeps show. A state at an event gets the label of the state
/// and the name of the event: `velocity at impact (m/s)` for `impact.v`.
fn swept_label(plot: &Plot, column: &str) -> String {
    let label = plot.label(column);
    match column.split_once('.').filter(|_| label == column) {
        Some((event, state)) if plot.label(state) != state => match parts(plot.label(state)) {
            Some((words, unit)) => format!("{words} at {event} ({unit})"),
            None => format!("{} at {event}", plot.label(state)),
        },
        _ => label.to_owned(),
    }
}

/// Returns a figure of the special points of a document's branches against a setting that differs
/// between the branches. Branches for which that setting is not recorded are omitted.
fn special_points_against(document: &Document, against: &Against) -> Figure {
    let Against { kind, setting, column } = against;
    let label = document.plot.label(column);
    let mut figure = Figure::new("", document.plot.label(setting), label);
    for (name, differences) in &document.differences {
        let number = differences.iter().find(|(key, _)| key == setting);
        let number = number.and_then(|(_, value)| value.parse::<f64>().ok());
        let point = document
            .branch(name)
            .ok()
            .and_then(|branch| branch.of_kind(*kind).next()?.value(branch.column(column)?));
        let (Some(x), Some(y)) = (number, point) else { continue };
        let others = differences.iter().filter(|(key, _)| key != setting);
        let name = others.map(|(_, value)| value.as_str()).collect::<Vec<_>>().join(", ");
        match figure.series.iter_mut().find(|series| series.name == name) {
            Some(series) => series.points.push([x, y]),
            None => figure.series.push(Series::new(name, Style::DottedLine, vec![[x, y]])),
        }
    }
    figure
}

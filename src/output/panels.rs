//! Everything that a document says about its own drawing: diagrams, and profiles of special points.

use super::axis::clip;
use super::diagram::{diagram, panel};
use super::document::{Against, Document, Enlargement};
use super::error::FigureError;
use super::figure::{Figure, Series, Style};
use super::profiles::profiles;

/// The figures of some documents: the diagram, its enlargements and the further panels that the first document
/// names, and one figure for each kind of profile (mode shapes, time histories, phase portraits) that special points
/// carry. [`Plot::profiles`] and [`Plot::points`] of the first document choose among profiles and points;
/// without them every kind of profile is drawn, for up to eight points: of orbits the folds, period
/// doublings, torus and branch points, grazings and user's points and, where that makes no more than five
/// curves, the last end of each branch; of other solutions the user's points and, to compare, the first
/// end. Where `x` or `y` is given, the diagram in these columns alone.
///
/// [`Plot::profiles`]: super::Plot::profiles
/// [`Plot::points`]: super::Plot::points
///
/// # Errors
/// As [`diagram`]; [`FigureError::UnknownPoint`] and [`FigureError::UnknownProfile`] for points and
/// profiles that do not exist.
///
/// ```
/// use tangency::output::{Document, example_branch, figures};
/// let document = Document::new("Pull-in", vec![example_branch()]);
/// assert_eq!(figures(&[("plate", &document)], None, None)?.len(), 1);
/// # Ok::<(), tangency::output::FigureError>(())
/// ```
pub fn figures(
    documents: &[(&str, &Document)],
    x: Option<&str>,
    y: Option<&str>,
) -> Result<Vec<Figure>, FigureError> {
    let mut figures = vec![diagram(documents, x, y)?];
    if x.is_some() || y.is_some() {
        return Ok(figures);
    }
    let enlargements =
        documents.first().map_or(&[][..], |(_, document)| &document.plot.enlargements);
    for Enlargement { x, y } in enlargements {
        let mut part = Figure { title: String::new(), ..figures[0].clone() };
        clip(&mut part, [*x, *y]);
        figures.push(part);
    }
    let panels = documents.first().map_or(&[][..], |(_, document)| &document.plot.panels);
    for (x, y) in panels {
        let mut panel = panel(documents, x, y)?;
        panel.title = String::new();
        figures.push(panel);
    }
    for (_, document) in documents {
        for against in &document.plot.against {
            figures.push(special_points_against(document, against));
        }
    }
    figures.extend(profiles(documents)?);
    Ok(figures)
}

/// Special points of a document's branches against a setting in which the branches differ. A branch
/// without that setting has no place in it.
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

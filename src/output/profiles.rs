//! Figures of the profiles that special points carry: mode shapes, time histories, phase portraits.

use super::diagram::{stability, style};
use super::document::Document;
use super::error::{FigureError, UnknownPoint};
use super::figure::{Figure, Series};
use super::number::significant;
use crate::core::continuation::{Branch, SpecialPoint};
use crate::core::problem::{Profile, UnknownName};
use crate::core::system::Kind;

/// A figure does not show more curves than this unless their points are named one by one.
const MOST_CURVES: usize = 8;
/// Nor ends of branches, if there are more curves than this.
const MOST_WITH_ENDS: usize = 5;

/// Special points whose solutions are worth a look.
const SHOWN: [Kind; 6] = [Kind::LP, Kind::PD, Kind::TR, Kind::BP, Kind::G, Kind::UZ];

/// A special point, and the name of its curve.
struct Shown<'a> {
    name: String,
    point: &'a SpecialPoint,
}

/// One figure for each kind of profile, as [`figures`](super::figures) says.
pub(super) fn profiles(documents: &[(&str, &Document)]) -> Result<Vec<Figure>, FigureError> {
    let Some((_, first)) = documents.first() else { return Ok(Vec::new()) };
    let plot = &first.plot;
    let shown = match plot.points.is_empty() {
        true => usual(documents),
        false => named(documents, &plot.points)?,
    };
    let mut figures: Vec<(&Profile, Figure)> = Vec::new();
    for Shown { name, point } in &shown {
        for profile in &point.profiles {
            let kind = (&profile.along, &profile.name);
            let same = |(p, _): &(&Profile, Figure)| (&p.along, &p.name) == kind;
            let index = figures.iter().position(same).unwrap_or_else(|| {
                let [x, y] = [plot.label(&profile.along), plot.label(&profile.name)];
                figures.push((profile, Figure::new("", x, y)));
                figures.len() - 1
            });
            let series = Series::new(name, style(point.unstable), profile.points.clone());
            figures[index].1.series.push(series);
        }
    }
    let mut figures = chosen(figures, &plot.profiles)?;
    if shown.iter().any(|shown| shown.point.unstable.is_some()) {
        figures.iter_mut().for_each(|figure| figure.styles = stability());
    }
    Ok(figures)
}

/// The figures of the kinds of profiles that were asked for, in that order; all if none was.
fn chosen(
    mut figures: Vec<(&Profile, Figure)>,
    kinds: &[(String, String)],
) -> Result<Vec<Figure>, FigureError> {
    if kinds.is_empty() || figures.is_empty() {
        return Ok(figures.into_iter().map(|(_, figure)| figure).collect());
    }
    let written = |along: &str, name: &str| format!("{name} along {along}");
    let mut found = Vec::new();
    for (along, name) in kinds {
        let meant = |(p, _): &(&Profile, Figure)| (&p.along, &p.name) == (along, name);
        match figures.iter().position(meant) {
            Some(index) => found.push(figures.remove(index).1),
            None => {
                let known = figures.iter().map(|(p, _)| written(&p.along, &p.name));
                let unknown = UnknownName::new("profile", written(along, name), known);
                return Err(FigureError::UnknownProfile(unknown));
            }
        }
    }
    Ok(found)
}

/// The points whose profiles are shown where nobody says so.
fn usual<'a>(documents: &[(&str, &'a Document)]) -> Vec<Shown<'a>> {
    let mut shown: Vec<Shown> = Vec::new();
    for (document, content) in documents {
        for branch in content.branches.iter().filter(|branch| branch.condition.is_none()) {
            let points = interesting(branch).into_iter();
            let points = points.filter(|point| !point.profiles.is_empty());
            shown.extend(points.map(|point| {
                let name = name(documents, document, branch, point);
                Shown { name, point }
            }));
        }
    }
    let ends = |shown: &Shown| matches!(shown.point.kind, Kind::EP | Kind::MX);
    if shown.len() > MOST_WITH_ENDS && !shown.iter().all(ends) {
        shown.retain(|shown| !ends(shown));
    }
    shown.truncate(MOST_CURVES);
    shown
}

/// The points of a branch whose profiles are worth a look.
fn interesting(branch: &Branch) -> Vec<&SpecialPoint> {
    let special = || branch.special.iter();
    let users = || special().filter(|point| point.kind == Kind::UZ);
    if special().any(|point| !point.mesh.is_empty()) {
        let last = special().next_back().map(|last| last.label);
        let own = |point: &&SpecialPoint| SHOWN.contains(&point.kind) || Some(point.label) == last;
        return special().filter(own).collect();
    }
    match users().next() {
        Some(_) => {
            special().find(|point| point.kind == Kind::EP).into_iter().chain(users()).collect()
        }
        None => Vec::new(),
    }
}

/// The points that are named as `LABEL` or `BRANCH/LABEL`, in all documents that have them.
fn named<'a>(
    documents: &[(&str, &'a Document)],
    names: &[String],
) -> Result<Vec<Shown<'a>>, FigureError> {
    let mut shown = Vec::new();
    for wanted in names {
        let (branch, label) = match wanted.rsplit_once('/') {
            Some((branch, label)) => (Some(branch), label),
            None => (None, wanted.as_str()),
        };
        let label = label.trim().parse().map_err(|_| UnknownPoint::Form(wanted.clone()))?;
        let before = shown.len();
        let mut missing = None;
        for named in documents {
            match named.1.special_point(branch.map(str::trim), label) {
                Ok((branch, point)) => {
                    shown.push(Shown { name: name(documents, named.0, branch, point), point });
                }
                Err(error) => missing = missing.or(Some(error)),
            }
        }
        if let (Some(error), true) = (missing, shown.len() == before) {
            return Err(error.into());
        }
    }
    Ok(shown)
}

/// The name of a point's curve: branch, label, kind (or the user's event), and the continued
/// parameter.
fn name(
    documents: &[(&str, &Document)],
    document: &str,
    branch: &Branch,
    point: &SpecialPoint,
) -> String {
    let place = match documents.len() {
        1 => branch.name.clone(),
        _ => format!("{document}: {}", branch.name),
    };
    let kind = match point.kind {
        Kind::UZ => point.event.clone(),
        kind => kind.to_string(),
    };
    let released = branch.released.first();
    let value = released.and_then(|name| {
        let value = point.value(branch.column(name)?)?;
        Some(format!(", {name} = {}", significant(value, 6)))
    });
    format!("{place}/{} {kind}{}", point.label, value.unwrap_or_default())
}

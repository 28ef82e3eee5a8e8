//! Checks of a document's contents, such as unique names, lengths of lists and finite numbers.

use super::document::Document;
use super::error::FormatError;
use super::tag::FORMAT;
use super::words::{Invalid, text};
use crate::core::continuation::{Branch, End, Sensitivity, Slopes, SpecialPoint, Stretch};
use crate::core::problem::PlaneField;
use std::collections::HashSet;

/// The result of checking a part of a document: an error for an invalid value.
type Checked = Result<(), Invalid>;

/// Checks a document: its format tag, unique names without control characters, lists of the right
/// length, and finite numbers.
pub(super) fn document(document: &Document) -> Result<(), FormatError> {
    if document.format != FORMAT {
        return Err(FormatError::Version { found: document.format.clone() });
    }
    text("the title", &document.title)?;
    let settings = document.settings.iter().map(|(name, _)| name);
    settings.clone().try_for_each(|name| text("the name of a setting", name))?;
    unique("the name of a setting", settings)?;
    for (column, label) in &document.plot.labels {
        text(&format!("plot, the label of `{column}`"), label)?;
    }
    for (branch, column, shift) in &document.plot.shifts {
        finite(&format!("plot, shift of `{column}` of `{branch}`"), *shift)?;
    }
    unique("the column of a label", document.plot.labels.iter().map(|(column, _)| column))?;
    unique("the name of a branch", document.branches.iter().map(|branch| &branch.name))?;
    Ok(document.branches.iter().try_for_each(branch)?)
}

fn branch(branch: &Branch) -> Checked {
    text("the name of a branch", &branch.name)?;
    let place = format!("branch `{}`", branch.name);
    branch.columns().try_for_each(|name| text(&format!("{place}: a column"), name))?;
    let groups = branch.unknowns.iter().map(|group| &group.name);
    groups.into_iter().try_for_each(|name| text(&format!("{place}: an unknown"), name))?;
    for group in &branch.unknowns {
        let (count, place) = (group.count(), format!("{place}: the indices of `{}`", group.name));
        let fits = count > 0 && group.length.is_multiple_of(count);
        require(fits, &place, format!("{:?}", group.indices), || {
            format!(
                "the length of a group of unknowns, {}, must be a multiple of the number of \
                 elements in the index ranges of the group",
                group.length
            )
        })?;
    }
    unique(&format!("{place}: a column"), branch.columns())?;
    unique(&format!("{place}: a label"), branch.special.iter().map(|point| point.label))?;
    for name in &branch.released {
        require(branch.parameters.contains(name), &format!("{place}: released"), name, || {
            format!(
                "a released parameter must be one of the parameters {}",
                branch.parameters.join(", ")
            )
        })?;
    }
    for (index, point) in branch.points.iter().enumerate() {
        let place = format!("{place}, point {index}");
        values(&place, branch, &point.parameters, &point.monitors)?;
        slopes(&place, branch, point.slopes.as_ref())?;
    }
    let dimension: usize = branch.unknowns.iter().map(|group| group.length).sum();
    for point in &branch.special {
        special(&format!("{place}, label {}", point.label), branch, dimension, point)?;
    }
    let order = branch.special.windows(2).find(|pair| pair[1].after < pair[0].after);
    if let Some([first, second]) = order {
        let place = format!("{place}, label {}: after", second.label);
        require(false, &place, second.after, || {
            format!(
                "the position of a special point must be at least {}, which is the position of the \
                 preceding special point (label {})",
                first.after, first.label
            )
        })?;
    }
    for (index, Stretch { points: [first, last], .. }) in branch.stretches.iter().enumerate() {
        let place = format!("{place}, stretch {index}: points");
        let most = branch.points.len().saturating_sub(1);
        require(first <= last && *last <= most, &place, format!("{first}, {last}"), || {
            format!(
                "the first position of a stretch (a part of a curve between two special points) \
                 must not be larger than the second position, and both positions must be at most \
                 {most}, the position of the last point"
            )
        })?;
    }
    branch.ends.iter().try_for_each(|e| end(&place, e))?;
    branch.settings.check().map_err(|error| Invalid {
        place: format!("{place}: the setting `{}`", error.name),
        found: error.value.to_string(),
        rule: format!("must be {}", error.range),
    })
}

/// Checks the derivatives of the columns at a point, if the point contains derivatives.
fn slopes(place: &str, branch: &Branch, slopes: Option<&Slopes>) -> Checked {
    let Some(Slopes { position, columns }) = slopes else { return Ok(()) };
    finite(&format!("{place}, position"), *position)?;
    length(&format!("{place}, slopes"), columns.len(), branch.columns().count(), "the columns")?;
    let known: Vec<f64> = columns.iter().flatten().copied().collect();
    all_finite(&format!("{place}, slopes"), &known)
}

fn special(place: &str, branch: &Branch, dimension: usize, point: &SpecialPoint) -> Checked {
    require(point.label > 0, place, point.label, || "must be counted from 1".into())?;
    require(point.kind.is_known(), &format!("{place}, kind"), point.kind, || {
        "the kind of a special point must be a kind that the library knows".into()
    })?;
    text(&format!("{place}, event"), &point.event)?;
    let most = dimension.max(1);
    require((1..=most).contains(&point.multiplicity), place, point.multiplicity, || {
        format!(
            "the multiplicity of a special point must be from 1 to {most}, the number of \
                 unknowns"
        )
    })?;
    for number in &point.numbers {
        text(&format!("{place}, a number"), &number.name)?;
        let place = format!("{place}, number `{}`", number.name);
        all_finite(&place, &[number.value, number.error])?;
    }
    for Sensitivity { by, slopes } in &point.sensitivities {
        let place = format!("{place}, the sensitivity with respect to `{by}`");
        require(branch.parameters.contains(by), &place, by, || "must be a parameter".into())?;
        length(&place, slopes.len(), branch.released.len(), "the released parameters")?;
        all_finite(&place, slopes)?;
    }
    let last = branch.points.len().saturating_sub(1);
    require(point.after <= last, &format!("{place}: after"), point.after, || {
        format!(
            "the position of a special point must be at most {last}, the position of the last \
                 point"
        )
    })?;
    values(place, branch, &point.parameters, &point.monitors)?;
    slopes(place, branch, point.slopes.as_ref())?;
    finite(&format!("{place}, error"), point.error)?;
    point.bracket.iter().try_for_each(|end| finite(&format!("{place}, bracket"), *end))?;
    // A point on its own mesh has as many unknowns as the mesh requires.
    let dimension = if point.mesh.is_empty() { dimension } else { point.state.len() };
    length(&format!("{place}, state"), point.state.len(), dimension, "the unknowns")?;
    all_finite(&format!("{place}, state, component"), &point.state)?;
    let directions = dimension + branch.released.len();
    let names = "the unknowns and released parameters";
    length(&format!("{place}, tangent"), point.tangent.len(), directions, names)?;
    all_finite(&format!("{place}, tangent, component"), &point.tangent)?;
    all_finite(&format!("{place}, mesh, point"), &point.mesh)?;
    point.fields.iter().try_for_each(|PlaneField { name, along: [rows, columns], values }| {
        text(&format!("{place}, a field"), name)?;
        let (place, count) = (format!("{place}, field `{name}`"), rows.len() * columns.len());
        length(&place, values.len(), count, "the indices")?;
        all_finite(&format!("{place}, component"), values)
    })?;
    point.profiles.iter().try_for_each(|profile| {
        text(&format!("{place}, a profile"), &profile.name)?;
        let place = format!("{place}, profile `{}`, number", profile.name);
        all_finite(&place, profile.points.as_flattened())
    })
}

fn values(place: &str, branch: &Branch, parameters: &[f64], monitors: &[f64]) -> Checked {
    let lists =
        [("parameters", &branch.parameters, parameters), ("monitors", &branch.monitors, monitors)];
    for (what, names, values) in lists {
        length(&format!("{place}, {what}"), values.len(), names.len(), "the names")?;
        if let Some((name, value)) = names.iter().zip(values).find(|(_, value)| !value.is_finite())
        {
            finite(&format!("{place}, column `{name}`"), *value)?;
        }
    }
    Ok(())
}

fn end(place: &str, end: &End) -> Checked {
    match end {
        End::ParameterBound { value, .. } | End::MonitorBound { value, .. } => {
            finite(&format!("{place}, ends, value"), *value)
        }
        End::ConvergesTo { point } => all_finite(&format!("{place}, ends, point"), point),
        End::StepTooSmall { step, .. } => finite(&format!("{place}, ends, step"), *step),
        _ => Ok(()),
    }
}

fn unique<T: std::fmt::Display + Eq + std::hash::Hash>(
    what: &str,
    names: impl Iterator<Item = T>,
) -> Checked {
    let mut seen = HashSet::new();
    for name in names {
        let found = format!("`{name}`");
        require(seen.insert(name), what, found, || "occurs twice: rename one of them".into())?;
    }
    Ok(())
}

fn length(place: &str, found: usize, expected: usize, of: &str) -> Checked {
    require(found == expected, place, format!("a list of {found}"), || {
        format!("the list must have {expected} entries, one for each of {of}")
    })
}

fn finite(place: &str, value: f64) -> Checked {
    require(value.is_finite(), place, value, || "must be a finite number".into())
}

fn all_finite(place: &str, values: &[f64]) -> Checked {
    match values.iter().position(|value| !value.is_finite()) {
        Some(index) => finite(&format!("{place} {index}"), values[index]),
        None => Ok(()),
    }
}

fn require(
    holds: bool,
    place: &str,
    found: impl std::fmt::Display,
    rule: impl FnOnce() -> String,
) -> Checked {
    if holds {
        return Ok(());
    }
    Err(Invalid { place: place.into(), found: found.to_string(), rule: rule() })
}

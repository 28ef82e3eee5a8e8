//! The values and profiles at one point of a branch, and the runs that can continue from this
//! point.

use super::pages::Kept;
use super::plane::{Plane, Point as At, plane};
use crate::core::continuation::{Branch, Point, SpecialPoint};
use crate::core::problem::Profile;
use crate::output::significant;
use crate::scene::{FollowUp, Place};
use serde::Serialize;

/// The number of significant digits with which values are shown.
const DIGITS: usize = 12;
const ERROR_DIGITS: usize = 2;

/// The details of a point of a branch.
#[derive(Serialize)]
pub(super) struct Details<'a> {
    title: String,
    /// Names and values.
    rows: Vec<[String; 2]>,
    profiles: Vec<Shown<'a>>,
    follow_ups: Vec<FollowUp>,
    /// The phase space at the point; `None` if the problem has no motion, or if the states at the
    /// point are not known.
    plane: Option<Plane>,
}

/// A profile.
#[derive(Serialize)]
struct Shown<'a> {
    name: &'a str,
    along: &'a str,
    points: &'a [[f64; 2]],
}

impl<'a> From<&'a Profile> for Shown<'a> {
    fn from(profile: &'a Profile) -> Self {
        Shown { name: &profile.name, along: &profile.along, points: &profile.points }
    }
}

/// Returns the details of a point; `None` if the point does not exist.
pub(super) fn details(kept: &Kept, at: At) -> Option<Details<'_>> {
    let branch = kept.document.branches.get(at.branch)?;
    let plane = plane(kept, at);
    let label = match at.place()? {
        Place::Regular(index) => {
            return Some(of_point(branch, (index, branch.points.get(index)?), plane));
        }
        Place::Special(label) => label,
    };
    let special = branch.labelled(label)?;
    let follow_ups = kept.scene.resolve(None).map(|it| it.follow_ups(branch, special.label));
    Some(Details {
        title: title(branch, special),
        rows: rows(branch, special),
        profiles: special.profiles.iter().map(Shown::from).collect(),
        follow_ups: follow_ups.unwrap_or_default(),
        plane,
    })
}

fn row(name: impl Into<String>, value: f64) -> [String; 2] {
    [name.into(), significant(value, DIGITS)]
}

fn title(branch: &Branch, special: &SpecialPoint) -> String {
    let SpecialPoint { kind, label, converged, subkind, .. } = special;
    let subkind = subkind.iter().map(|subkind| format!(", {subkind}")).collect::<String>();
    let doubt = if *converged { "" } else { " (not converged)" };
    format!("{}: {kind} {label}, {}{subkind}{doubt}", branch.name, kind.meaning())
}

/// Returns the columns of a branch with their values at one point of the branch, the varied
/// parameters first.
fn columns(branch: &Branch, value: impl Fn(usize) -> Option<f64>) -> Vec<[String; 2]> {
    let mut names: Vec<(usize, &str)> = branch.columns().enumerate().collect();
    names.sort_by_key(|(_, name)| !branch.released.iter().any(|it| it == name));
    names.into_iter().filter_map(|(column, name)| Some(row(name, value(column)?))).collect()
}

fn of_point<'a>(
    branch: &Branch,
    (index, point): (usize, &Point),
    plane: Option<Plane>,
) -> Details<'a> {
    let mut rows = columns(branch, |column| point.value(column));
    if let Some(unstable) = point.unstable {
        rows.push(["unstable directions".into(), unstable.to_string()]);
    }
    if !point.admissible {
        rows.push(["virtual".into(), "beyond a grazing".into()]);
    }
    let title = format!("{}, point {index}", branch.name);
    Details { title, rows, profiles: Vec::new(), follow_ups: Vec::new(), plane }
}

/// Returns the rows that describe a special point: values of columns, normal-form coefficients,
/// eigenvalues and sensitivities.
fn rows(branch: &Branch, special: &SpecialPoint) -> Vec<[String; 2]> {
    let mut rows = columns(branch, |column| special.value(column));
    if let (Some(first), false) = (rows.first_mut(), branch.released.is_empty()) {
        first[1] += &format!(" ± {}", significant(special.error, ERROR_DIGITS));
    }
    if let Some(unstable) = special.unstable {
        rows.push(["unstable directions".into(), unstable.to_string()]);
    }
    rows.extend(special.numbers.iter().map(|number| row(&number.name, number.value)));
    for (k, (real, imaginary)) in special.eigenvalues.iter().enumerate() {
        let sign = if *imaginary < 0.0 { '−' } else { '+' };
        let imaginary = match imaginary.abs() {
            0.0 => String::new(),
            size => format!(" {sign} {} i", significant(size, DIGITS)),
        };
        let value = significant(*real, DIGITS) + &imaginary;
        rows.push([format!("eigenvalue or multiplier {}", k + 1), value]);
    }
    for sensitivity in &special.sensitivities {
        let slopes = branch.released.iter().zip(&sensitivity.slopes);
        rows.extend(
            slopes.map(|(name, slope)| row(format!("d{name}/d{}", sensitivity.by), *slope)),
        );
    }
    rows
}

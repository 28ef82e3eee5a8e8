//! Comparison of two documents (files of results), as in the command `tangency compare`: finds
//! special points that appeared, disappeared or moved.

use super::document::Document;
use super::number::significant;
use crate::core::continuation::{Branch, SpecialPoint};
use crate::core::system::Kind;
use std::fmt;

/// A difference between two documents.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub enum Difference {
    /// A branch that exists in only one of the two documents.
    Branch {
        /// The name of the branch.
        branch: String,
        /// Whether the branch is in the new document rather than the old one.
        new: bool,
    },
    /// A branch that is continued in different parameters in the two documents.
    Continued {
        /// The name of the branch.
        branch: String,
        /// The continuation parameters in the old document, and in the new document.
        parameters: [Vec<String>; 2],
    },
    /// A column of a branch that exists in only one of the two documents.
    Column {
        /// The name of the branch.
        branch: String,
        /// The parameter or the monitor.
        column: String,
        /// Whether the column is in the new document rather than the old one.
        new: bool,
    },
    /// A parameter that is constant along a branch, and differs between the two documents.
    Parameter {
        /// The name of the branch.
        branch: String,
        /// The parameter.
        name: String,
        /// The value of the constant parameter in the old document, and its value in the new
        /// document.
        values: [f64; 2],
    },
    /// A special point that exists in only one of the two documents.
    Point {
        /// The branch of the special point.
        branch: String,
        /// The kind of the special point.
        kind: Kind,
        /// The continuation parameter, and its value at the special point.
        at: (String, f64),
        /// Whether the special point is in the new document rather than the old one.
        new: bool,
    },
    /// A special point whose value in a column differs between the two documents.
    Value {
        /// The branch of the special point.
        branch: String,
        /// The kind of the special point.
        kind: Kind,
        /// The name of the continuation parameter, and its value at the point in the old document.
        at: (String, f64),
        /// The name of the column that differs: the continuation parameter, another parameter, a
        /// monitor or another number of the point.
        column: String,
        /// The value of the column in the old document, and the value in the new document.
        values: [f64; 2],
        /// The allowed difference.
        allowed: f64,
    },
    /// A special point for which a property, such as its stability, differs between the two
    /// documents.
    Property {
        /// The branch of the special point.
        branch: String,
        /// The kind of the special point.
        kind: Kind,
        /// The continuation parameter, and its value at the special point.
        at: (String, f64),
        /// The name of the property that differs.
        property: &'static str,
        /// The value of the property in the old document, and its value in the new document.
        values: [String; 2],
    },
}

impl fmt::Display for Difference {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        let which = |new: &bool| if *new { "new" } else { "missing" };
        let place = |(name, value): &(String, f64)| format!("{name} = {}", significant(*value, 12));
        match self {
            Difference::Branch { branch, new } => {
                write!(f, "the branch `{branch}` is {}", which(new))
            }
            Difference::Continued { branch, parameters } => {
                let [from, to] = parameters.each_ref().map(|names| names.join(" and "));
                write!(
                    f,
                    "{branch}: the branch was continued in {from} and is now continued in {to}"
                )
            }
            Difference::Column { branch, column, new } => {
                write!(f, "{branch}: the column {column} is {}", which(new))
            }
            Difference::Parameter { branch, name, values } => {
                let [from, to] = values.map(|value| significant(value, 12));
                write!(f, "{branch}: the parameter {name} was {from} and is now {to}")
            }
            Difference::Point { branch, kind, at, new } => {
                write!(f, "{branch}: {kind} at {} is {}", place(at), which(new))
            }
            Difference::Value { branch, kind, at, column, values: [old, new], allowed } => {
                let [from, to] = [old, new].map(|value| significant(*value, 12));
                let by = (new - old).abs();
                let rule = format!("by {by:.1e}, more than the allowed {allowed:.1e}");
                match *column == at.0 {
                    true => {
                        write!(f, "{branch}: {kind} moved from {column} = {from} to {to}, {rule}")
                    }
                    false => write!(
                        f,
                        "{branch}: at the {kind} with {}, {column} was {from} and is now {to}, a change {rule}",
                        place(at)
                    ),
                }
            }
            Difference::Property { branch, kind, at, property, values: [old, new] } => {
                write!(
                    f,
                    "{branch}: at the {kind} with {}, {property} was {old} and is now {new}",
                    place(at)
                )
            }
        }
    }
}

/// The relative rounding error by which values of two documents may differ in addition to their
/// stated errors.
const ROUNDING: f64 = 1e-12;

/// The allowed difference between the values of two documents in a column without a stated error,
/// relative to the largest value of the column along both branches.
const COLUMNS: f64 = 1e-6;

/// The largest distance at which a special point of the old document and a special point of the new
/// document are compared as the same point, relative to the largest values along the branches.
const FAR: f64 = 0.2;

/// Returns the differences of a new document from an old one: branches are matched by name, special
/// points of a branch by kind and position. The continuation parameter may differ by the sum of the
/// stated errors of the two documents, every other column by 10⁻⁶ of its largest value along the
/// branches. If one of two matched special points has not converged, only the intervals that
/// contain the two points are compared. Different continuation parameters, columns that only one of
/// the documents has, and constant parameters whose values differ are reported before the special
/// points, once for each branch; monitors of different methods of discretisation may differ. Points
/// that were saved on request (`RG`) and the number of points of a branch are not compared.
///
/// ```
/// use tangency::output::{Document, compare, example_branch};
/// let old = Document::new("plate", vec![example_branch()]);
/// let mut new = old.clone();
/// assert!(compare(&old, &new).is_empty());
/// new.branches[0].special[2].parameters[0] += 1e-6;
/// let found = compare(&old, &new);
/// assert_eq!(
///     found[0].to_string(),
///     "plate: LP moved from load = 0.148148148148 to 0.148149148148, by 1.0e-6, more than the allowed 1.5e-13"
/// );
/// ```
pub fn compare(old: &Document, new: &Document) -> Vec<Difference> {
    compare_within(old, new, 0.0)
}

/// Returns the differences of a new document from an old one as [`compare`] does, but allows values
/// to differ, in addition, by a fraction of the largest value of their column along the branches.
///
/// ```
/// use tangency::output::{Document, compare_within, example_branch};
/// let old = Document::new("plate", vec![example_branch()]);
/// let mut new = old.clone();
/// new.branches[0].special[2].parameters[0] *= 1.0005;
/// assert!(compare_within(&old, &new, 1e-3).is_empty());
/// assert_eq!(compare_within(&old, &new, 1e-4).len(), 1);
/// ```
pub fn compare_within(old: &Document, new: &Document, allowed: f64) -> Vec<Difference> {
    let named = |document: &Document, name: &str| {
        document.branches.iter().any(|branch| branch.name == name)
    };
    let mut found = Vec::new();
    for branch in &old.branches {
        match new.branches.iter().find(|other| other.name == branch.name) {
            Some(other) => found.extend(of_branches(branch, other, allowed)),
            None => found.push(Difference::Branch { branch: branch.name.clone(), new: false }),
        }
    }
    let came = new.branches.iter().filter(|branch| !named(old, &branch.name));
    found.extend(came.map(|it| Difference::Branch { branch: it.name.clone(), new: true }));
    found
}

/// Returns the differences between two branches of the same name.
fn of_branches(old: &Branch, new: &Branch, allowed: f64) -> Vec<Difference> {
    let constant = constants(old, new, allowed);
    let names: Vec<&str> = constant.iter().map(|(name, _)| name.as_str()).collect();
    let both = Both { old, new, constant: &names, allowed };
    let (mut gone, mut came): (Vec<_>, Vec<_>) = (counted(old).collect(), counted(new).collect());
    let mut pairs = Vec::new();
    // The nearest pairs are matched first, so that a missing point does not shift the others.
    loop {
        let all = gone.iter().enumerate().flat_map(|(i, a)| {
            let alike = came.iter().enumerate().filter(|(_, b)| b.kind == a.kind);
            alike.map(move |(j, b)| (i, j, both.distance(a, b)))
        });
        let near = all.filter(|(.., distance)| *distance <= FAR);
        let Some((i, j, _)) = near.min_by(|a, b| a.2.total_cmp(&b.2)) else { break };
        pairs.push((gone.remove(i), came.remove(j)));
    }
    pairs.sort_by_key(|(point, _)| point.label);
    let parameter = |(name, values): &(String, [f64; 2])| {
        let (branch, name, values) = (old.name.clone(), name.clone(), *values);
        Difference::Parameter { branch, name, values }
    };
    let mut found = of_columns(old, new);
    found.extend(constant.iter().map(parameter));
    found.extend(pairs.iter().flat_map(|(a, b)| both.differences(a, b)));
    found.extend(gone.into_iter().map(|point| alone(old, point, false)));
    found.extend(came.into_iter().map(|point| alone(new, point, true)));
    found
}

/// Returns the continuation parameters and the columns in which two branches of the same name differ.
fn of_columns(old: &Branch, new: &Branch) -> Vec<Difference> {
    let name = || old.name.clone();
    let continued = || {
        let parameters = [old, new].map(|branch| branch.released.clone());
        Difference::Continued { branch: name(), parameters }
    };
    // Methods of discretisation have monitors of their own.
    let count = |of: &Branch| match old.method == new.method {
        true => of.parameters.len() + of.monitors.len(),
        false => of.parameters.len(),
    };
    let only = |of: &Branch, other: &Branch, new: bool| {
        let columns = of.columns().take(count(of));
        let columns = columns.filter(|column| other.column(column).is_none());
        let column =
            |column: &str| Difference::Column { branch: name(), column: column.into(), new };
        columns.map(column).collect::<Vec<_>>()
    };
    let mut found: Vec<Difference> =
        (old.released != new.released).then(continued).into_iter().collect();
    found.extend(only(old, new, false));
    found.extend(only(new, old, true));
    found
}

/// Returns the parameters that are constant along both branches and have different values, with
/// these values.
fn constants(old: &Branch, new: &Branch, allowed: f64) -> Vec<(String, [f64; 2])> {
    let value = |branch: &Branch, name: &str| {
        let column = branch.parameters.iter().position(|known| known == name)?;
        branch.points.first()?.parameters.get(column).copied()
    };
    let varies = |name: &&String| [old, new].iter().any(|it| it.released.contains(name));
    let fixed = old.parameters.iter().filter(|name| !varies(name));
    let values =
        fixed.filter_map(|name| Some((name.clone(), [value(old, name)?, value(new, name)?])));
    let allowed = allowed.max(COLUMNS);
    let differ = |[a, b]: &[f64; 2]| (a - b).abs() > allowed * a.abs().max(b.abs());
    values.filter(|(_, values)| differ(values)).collect()
}

/// Returns the special points of a branch that are compared: all points except the kind `RG`.
fn counted(branch: &Branch) -> impl Iterator<Item = &SpecialPoint> {
    branch.special.iter().filter(|point| point.kind != Kind::RG)
}

fn alone(branch: &Branch, point: &SpecialPoint, new: bool) -> Difference {
    let (branch, kind, at) = (branch.name.clone(), point.kind, place(branch, point));
    Difference::Point { branch, kind, at, new }
}

/// Returns the name of the continuation parameter and its value at a special point.
fn place(branch: &Branch, point: &SpecialPoint) -> (String, f64) {
    let name = branch.released.first().cloned().unwrap_or_default();
    let value = branch.column(&name).and_then(|column| point.value(column));
    (name, value.unwrap_or(f64::NAN))
}

/// Two branches of the same name, from the old and the new document.
#[derive(Clone, Copy)]
struct Both<'a> {
    old: &'a Branch,
    new: &'a Branch,
    /// The parameters that are constant along each branch but differ between the two branches; each
    /// is reported once.
    constant: &'a [&'a str],
    /// The allowed difference of values, as a fraction of the largest value of the column along the
    /// branches, in addition to errors.
    allowed: f64,
}

impl Both<'_> {
    /// Returns the columns of the two branches, each with its values at one special point of each
    /// branch and its largest value along the branches.
    fn columns<'b>(
        self,
        point: &'b SpecialPoint,
        there: &'b SpecialPoint,
    ) -> impl Iterator<Item = (&'b str, [f64; 2], f64)>
    where
        Self: 'b,
    {
        let Both { old, new, constant, .. } = self;
        old.columns().filter(move |name| !constant.contains(name)).filter_map(move |name| {
            let (k, l) = (old.column(name)?, new.column(name)?);
            let values = [point.value(k)?, there.value(l)?];
            let along = |branch: &Branch, column: usize| {
                let values = branch.points.iter().filter_map(|point| point.value(column));
                values.fold(0.0, |most: f64, value| most.max(value.abs()))
            };
            let size = along(old, k).max(along(new, l));
            Some((name, values, values.iter().fold(size, |most, value| most.max(value.abs()))))
        })
    }

    /// Returns the distance between two special points: the largest difference in any column,
    /// relative to the largest value in the column.
    fn distance(self, point: &SpecialPoint, there: &SpecialPoint) -> f64 {
        let parts = self.columns(point, there).filter(|(.., size)| *size > 0.0);
        parts.map(|(_, [a, b], size)| (a - b).abs() / size).fold(0.0, f64::max)
    }

    /// Returns the differences between two matching special points.
    fn differences(self, point: &SpecialPoint, there: &SpecialPoint) -> Vec<Difference> {
        let (at, branch, kind) = (place(self.old, point), self.old.name.clone(), point.kind);
        let value = |column: &str, values: [f64; 2], allowed: f64| {
            let difference = (values[0] - values[1]).abs();
            let differs = difference > allowed || difference.is_nan();
            differs.then(|| {
                let (branch, at, column) = (branch.clone(), at.clone(), column.to_string());
                Difference::Value { branch, kind, at, column, values, allowed }
            })
        };
        let converged = point.converged && there.converged;
        let columns = self.columns(point, there).filter_map(|(name, values, size)| {
            let errors = point.error + there.error + (ROUNDING + self.allowed) * size;
            match (name == at.0, converged) {
                (true, true) => value(name, values, errors),
                (true, false) => value(name, values, gap(point, there).max(self.allowed * size)),
                (false, true) => value(name, values, COLUMNS.max(self.allowed) * size),
                (false, false) => None,
            }
        });
        let numbers = point.numbers.iter().filter(|_| converged).filter_map(|old| {
            let new = there.number(&old.name)?;
            let errors = old.error + new.error;
            let size = old.value.abs().max(new.value.abs());
            let allowed = errors + COLUMNS.max(self.allowed) * size;
            value(&old.name, [old.value, new.value], allowed)
        });
        let mut found: Vec<Difference> = columns.chain(numbers).collect();
        let different = properties(point).into_iter().zip(properties(there));
        let different = different.filter(|((_, was), (_, is))| was != is);
        found.extend(different.map(|((property, was), (_, is))| {
            let (branch, at) = (branch.clone(), at.clone());
            Difference::Property { branch, kind, at, property, values: [was, is] }
        }));
        found
    }
}

/// Returns the allowed difference between two special points if at least one of them has not
/// converged: infinite if the intervals that contain the points overlap, otherwise 0.
fn gap(point: &SpecialPoint, there: &SpecialPoint) -> f64 {
    let ends = |point: &SpecialPoint| {
        let [a, b] = point.bracket;
        [a.min(b), a.max(b)]
    };
    let ([a, b], [c, d]) = (ends(point), ends(there));
    if b < c || d < a { 0.0 } else { f64::INFINITY }
}

/// Returns the properties of a special point that are not numbers.
fn properties(point: &SpecialPoint) -> [(&'static str, String); 4] {
    let unstable = match (point.unstable, &point.undetermined) {
        (Some(count), _) => count.to_string(),
        (None, Some(_)) => "not determined".into(),
        (None, None) => "not defined".into(),
    };
    [
        ("unstable", unstable),
        ("converged", point.converged.to_string()),
        ("multiplicity", point.multiplicity.to_string()),
        ("subkind", point.subkind.clone().unwrap_or_else(|| "none".into())),
    ]
}

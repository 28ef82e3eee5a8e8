//! Branches as data: the result of a trace, which can be saved, drawn, restarted and tested.

use super::end::End;
use super::settings::Settings;
use super::slopes::Slopes;
use super::stretch::Stretch;
use crate::core::bifurcation::DETAILS;
use crate::core::linalg::Spectrum;
use crate::core::problem::{Group, PlaneField, Profile, columns_showing};
use crate::core::system::{Kind, Solution};
use serde::{Deserialize, Serialize};
use std::sync::Arc;

/// A regular point of a branch.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Point {
    /// All parameters, in the order of [`Branch::parameters`].
    pub parameters: Vec<f64>,
    /// All monitors, in the order of [`Branch::monitors`].
    pub monitors: Vec<f64>,
    /// The number of unstable eigenvalues; `None` if stability is not defined, or not
    /// [determined](Self::undetermined).
    pub unstable: Option<usize>,
    /// The reason why eigenvalues or multipliers are not determined, if so. Test functions that
    /// depend on them are not evaluated at the point.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub undetermined: Option<String>,
    /// The leading eigenvalues or multipliers, [`Settings::eigenvalues`] in number, as (real part,
    /// imaginary part), by decreasing real part. Empty at the ends of the branch, where one is
    /// infinite (at a grazing), and if stability is not defined.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub eigenvalues: Spectrum,
    /// False for virtual solutions: orbits that cross a surface without its event.
    #[serde(default = "yes", skip_serializing_if = "bool::clone")]
    pub admissible: bool,
    /// The position along the branch, and the derivatives of the columns with respect to the
    /// position, if known.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub slopes: Option<Slopes>,
    /// The solution, from which a branch can start, if [`Settings::keep_solutions`] is set; it is
    /// not saved to files.
    #[serde(skip)]
    pub solution: Option<Arc<Solution>>,
}

fn yes() -> bool {
    true
}

fn one() -> usize {
    1
}

fn is_one(count: &usize) -> bool {
    *count == 1
}

/// A special point of a branch: a point at which a defining system holds, or an end of the branch.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct SpecialPoint {
    /// The label, unique within the branch: 1, 2, … in the order in which the points were found.
    pub label: usize,
    /// The kind of the point.
    pub kind: Kind,
    /// The name of the event: `fold`, `frequency_ratio = 0.12`, `end of the branch`.
    pub event: String,
    /// The standard name of the point beyond its kind, if any: `grazing-sliding`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub subkind: Option<String>,
    /// The special point lies between `Branch::points[after]` and the next point.
    pub after: usize,
    /// All parameters, in the order of [`Branch::parameters`].
    pub parameters: Vec<f64>,
    /// All monitors, in the order of [`Branch::monitors`].
    pub monitors: Vec<f64>,
    /// The number of noncritical unstable eigenvalues; `None` if stability is not defined, or not
    /// [determined](Self::undetermined).
    pub unstable: Option<usize>,
    /// The reason why eigenvalues or multipliers are not determined, if so.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub undetermined: Option<String>,
    /// The leading eigenvalues or multipliers, at most [`SpecialPoint::EIGENVALUES`], in the order
    /// of a [`Point`].
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub eigenvalues: Spectrum,
    /// Numbers of the point: the frequency of a Hopf point, the angle of a torus point, the
    /// coefficients of normal forms.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub numbers: Vec<Number>,
    /// The derivatives of the point's released parameters with respect to the other parameters.
    /// Empty if the point has no defining system.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub sensitivities: Vec<Sensitivity>,
    /// The number of simultaneously critical eigenvalues, or pairs, if greater than one.
    #[serde(default = "one", skip_serializing_if = "is_one")]
    pub multiplicity: usize,
    /// The estimated absolute error of the continued parameter (of the first released one on a
    /// curve of events), from Newton's last correction, rounding, and the discretisation where the
    /// problem can be refined.
    pub error: f64,
    /// Values of the continued parameter at the two points of the branch that enclose it.
    pub bracket: [f64; 2],
    /// Whether Newton's method converged on the defining system; otherwise `error` is the width of
    /// the bracket, and tables show the bracket only.
    pub converged: bool,
    /// The unknowns `z` on the branch's own discretisation, from which the branch can be restarted.
    pub state: Vec<f64>,
    /// The direction of the branch at the point, from its first point to its last: `(z, released
    /// parameters)`, of scaled length 1.
    pub tangent: Vec<f64>,
    /// The position along the branch, and the derivatives of the columns at the point, if known.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub slopes: Option<Slopes>,
    /// The mesh of the unknowns; empty if there is no mesh.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub mesh: Vec<f64>,
    /// For each released parameter, the difference between the value for which `state` solves the
    /// equations on this mesh and the refined value in `parameters`; empty if zero.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub mesh_shift: Vec<f64>,
    /// Curves of the solution that the problem provides.
    pub profiles: Vec<Profile>,
    /// The arrays with two indices among the unknowns, thinned out.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub fields: Vec<PlaneField>,
    /// The reason why the phase response is missing from the profiles, if it was requested.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub without_phase_response: Option<String>,
}

/// A named number of a special point.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Number {
    /// The name: `hopf_frequency`, `l1`.
    pub name: String,
    /// The value.
    pub value: f64,
    /// The estimated absolute error.
    pub error: f64,
}

impl Number {
    /// Whether the number is a detail, omitted from the summary lines of the command line.
    ///
    /// ```
    /// use tangency::core::continuation::Number;
    /// let number = |name: &str| Number { name: name.into(), value: 1.0, error: 1e-15 };
    /// assert!(number("c1_im").is_detail() && !number("l1").is_detail());
    /// ```
    pub fn is_detail(&self) -> bool {
        DETAILS.contains(&self.name.as_str())
    }

    /// Whether the value is larger than its error. Tables leave the other values empty.
    ///
    /// ```
    /// use tangency::core::continuation::Number;
    /// let number = |value, error| Number { name: "fold_b".into(), value, error };
    /// assert!(number(2.0, 1.0).is_certain() && !number(6.7e10, 3e11).is_certain());
    /// ```
    pub fn is_certain(&self) -> bool {
        self.error < self.value.abs() || self.error == 0.0
    }
}

/// The sensitivity of a special point's location to a parameter that is constant along the branch.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Sensitivity {
    /// The constant parameter.
    pub by: String,
    /// The derivatives of the released parameters at the special point by the constant parameter,
    /// in the order of [`Branch::released`].
    pub slopes: Vec<f64>,
}

/// A branch: a curve of zeros with the data recorded along it.
///
/// Points run from one end to the other; `ends[0]` belongs to the first point, `ends[1]` to the
/// last.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Branch {
    /// The name, unique within a document.
    pub name: String,
    /// The kind of the curve: `None` for solutions, `Some(LP)` for a curve of folds, and so on.
    pub condition: Option<Kind>,
    /// The itinerary of hybrid orbits in words, if solutions of the problem have different
    /// itineraries.
    #[serde(default, skip_serializing_if = "String::is_empty")]
    pub itinerary: String,
    /// The discretisation method, such as `collocation(4)`; empty if solutions are not discretised.
    #[serde(default, skip_serializing_if = "String::is_empty")]
    pub method: String,
    /// Groups of unknowns, in the order of the states.
    pub unknowns: Vec<Group>,
    /// Names of all parameters.
    pub parameters: Vec<String>,
    /// Names of the parameters that vary along the branch, the continued one first.
    pub released: Vec<String>,
    /// Names of all monitors.
    pub monitors: Vec<String>,
    /// The regular points, from one end to the other.
    pub points: Vec<Point>,
    /// The special points, in the order of the branch.
    pub special: Vec<SpecialPoint>,
    /// The solutions on the two sides of a curve in two parameters, between its special points.
    /// Empty for branches of solutions, and if unknown.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub stretches: Vec<Stretch>,
    /// The reasons why the branch ended, at its first and at its last point.
    pub ends: [End; 2],
    /// Events that were passed but could not be evaluated, with the reasons.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub warnings: Vec<String>,
    /// The settings of the trace.
    pub settings: Settings,
}

impl Branch {
    /// The special points of one kind, in the order of the branch.
    pub fn of_kind(&self, kind: Kind) -> impl Iterator<Item = &SpecialPoint> {
        self.special.iter().filter(move |point| point.kind == kind)
    }

    /// The converged special points of one kind, in the order of the branch.
    pub fn converged_points(&self, kind: Kind) -> impl Iterator<Item = &SpecialPoint> {
        self.of_kind(kind).filter(|point| point.converged)
    }

    /// Returns the special point with a label.
    pub fn labelled(&self, label: usize) -> Option<&SpecialPoint> {
        self.special.iter().find(|point| point.label == label)
    }

    /// Returns the solution at a special point, for
    /// [`System::resume_from`](crate::core::system::System::resume_from). A trace does not change
    /// the caller's system, which may have another mesh, period or itinerary.
    pub fn solution(&self, special: &SpecialPoint) -> Solution {
        let (n, mut slopes) = (special.state.len(), vec![0.0; special.parameters.len()]);
        let known = special.tangent.len() == n + self.released.len();
        let released = special.tangent.iter().skip(n).zip(&self.released);
        // For two critical pairs, the frequency of the pair that is not critical along the whole
        // curve.
        let mut names = ["second_frequency", "second_angle", "hopf_frequency"].into_iter();
        let frequency = names.find_map(|name| special.number(name));
        for (slope, name) in released.filter(|_| known) {
            let places = slopes.iter_mut().zip(&self.parameters).filter(|it| it.1 == name);
            places.for_each(|it| *it.0 = *slope);
        }
        let mut shift = vec![0.0; special.parameters.len()];
        for (value, name) in special.mesh_shift.iter().zip(&self.released) {
            let places = shift.iter_mut().zip(&self.parameters).filter(|it| it.1 == name);
            places.for_each(|it| *it.0 = *value);
        }
        Solution {
            kind: special.kind,
            condition: self.condition,
            itinerary: self.itinerary.clone(),
            method: self.method.clone(),
            mesh: special.mesh.clone(),
            state: special.state.clone(),
            parameters: special.parameters.clone(),
            tangent: known.then(|| (special.tangent[..n].to_vec(), slopes)),
            mesh_shift: Some(shift).filter(|_| !special.mesh_shift.is_empty()),
            multiplicity: special.multiplicity,
            frequency: frequency.map(|number| number.value),
            error: special.error,
            switch: None,
            beside: None,
        }
    }

    /// The names of the columns common to all points: parameters, then monitors.
    pub fn columns(&self) -> impl Iterator<Item = &str> {
        self.parameters.iter().chain(&self.monitors).map(String::as_str)
    }

    /// Returns the position of a parameter or a monitor among [`columns`](Branch::columns); after
    /// them, of the real or imaginary part of an eigenvalue or multiplier stored with points:
    /// `eigenvalue[0]`, `eigenvalue[0].imaginary`, ….
    ///
    /// ```
    /// use tangency::core::continuation::Settings;
    /// use tangency::output::example_branch;
    /// // Two parameters and a monitor.
    /// let mut branch = example_branch();
    /// assert_eq!((branch.column("deflection"), branch.column("eigenvalue[0]")), (Some(2), None));
    /// branch.settings = Settings { eigenvalues: 1, ..branch.settings };
    /// branch.points[0].eigenvalues = vec![(-0.5, 0.0)];
    /// let column = branch.column("eigenvalue[0]").expect("it is kept");
    /// assert_eq!((branch.points[0].value(column), branch.points[1].value(column)), (Some(-0.5), None));
    /// ```
    pub fn column(&self, name: &str) -> Option<usize> {
        self.columns().position(|column| column == name).or_else(|| {
            let (real, imaginary) = match name.strip_suffix(".imaginary") {
                Some(real) => (real, 1),
                None => (name, 0),
            };
            let rank: usize = real.strip_prefix("eigenvalue[")?.strip_suffix(']')?.parse().ok()?;
            let kept = rank < self.settings.eigenvalues;
            kept.then(|| self.parameters.len() + self.monitors.len() + 2 * rank + imaginary)
        })
    }

    /// Returns the columns that show a quantity: the [column](Self::column) of its name. For
    /// equilibria, `max_x` and `min_x` also select `x`; for orbits, `x` also selects `max_x` and
    /// `min_x`.
    ///
    /// ```
    /// use tangency::output::example_branch;
    /// let mut branch = example_branch();
    /// assert_eq!(branch.columns_showing("max_deflection"), [2]);
    /// branch.monitors = vec!["max_v".into(), "min_v".into()];
    /// assert_eq!((branch.columns_showing("v"), branch.columns_showing("w")), (vec![2, 3], vec![]));
    /// ```
    pub fn columns_showing(&self, name: &str) -> Vec<usize> {
        let names = columns_showing(name, |name| self.column(name).is_some());
        names.iter().filter_map(|name| self.column(name)).collect()
    }
}

impl Point {
    /// Creates an admissible point without eigenvalues.
    pub fn new(parameters: Vec<f64>, monitors: Vec<f64>, unstable: Option<usize>) -> Self {
        Point {
            parameters,
            monitors,
            unstable,
            undetermined: None,
            eigenvalues: Vec::new(),
            admissible: true,
            slopes: None,
            solution: None,
        }
    }

    /// The value of a column: parameters first, then monitors, then eigenvalues.
    pub fn value(&self, column: usize) -> Option<f64> {
        let eigenvalues = self.eigenvalues.iter().flat_map(|(real, imaginary)| [real, imaginary]);
        self.parameters.iter().chain(&self.monitors).chain(eigenvalues).nth(column).copied()
    }
}

impl SpecialPoint {
    /// The maximal number of eigenvalues stored with a special point.
    pub const EIGENVALUES: usize = 10;

    /// Creates a special point without values.
    pub(crate) fn new(kind: Kind, event: impl Into<String>) -> Self {
        SpecialPoint {
            label: 0,
            kind,
            event: event.into(),
            subkind: None,
            after: 0,
            parameters: Vec::new(),
            monitors: Vec::new(),
            unstable: None,
            undetermined: None,
            eigenvalues: Vec::new(),
            numbers: Vec::new(),
            sensitivities: Vec::new(),
            multiplicity: 1,
            error: 0.0,
            bracket: [0.0; 2],
            converged: true,
            state: Vec::new(),
            tangent: Vec::new(),
            slopes: None,
            mesh: Vec::new(),
            mesh_shift: Vec::new(),
            profiles: Vec::new(),
            fields: Vec::new(),
            without_phase_response: None,
        }
    }

    /// Returns the number of this name.
    pub fn number(&self, name: &str) -> Option<&Number> {
        self.numbers.iter().find(|number| number.name == name)
    }

    /// Converts the special point to a regular point.
    pub(super) fn point(&self) -> Point {
        let (undetermined, slopes) = (self.undetermined.clone(), self.slopes.clone());
        let point = Point::new(self.parameters.clone(), self.monitors.clone(), self.unstable);
        Point { undetermined, slopes, ..point }
    }

    /// The value of a column: parameters first, then monitors.
    pub fn value(&self, column: usize) -> Option<f64> {
        self.parameters.iter().chain(&self.monitors).nth(column).copied()
    }
}

/// A point or special point of a branch while it is traced.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub enum Traced {
    /// A regular point was computed; the start comes first.
    Point(Point),
    /// A special point was found, before the next regular point.
    Special(Box<SpecialPoint>),
}

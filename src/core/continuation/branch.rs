//! The data of branches: the result of a continuation, which can be saved, plotted, and used to
//! start other branches.

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
    /// The reason why the eigenvalues or multipliers could not be determined; `None` if they were
    /// determined. Test functions that depend on undetermined eigenvalues are not evaluated at the
    /// point.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub undetermined: Option<String>,
    /// The leading eigenvalues or multipliers, [`Settings::eigenvalues`] in number, as (real part,
    /// imaginary part), by decreasing real part. The list is empty at the ends of the branch, at
    /// points with an infinite multiplier (at a grazing), and if stability is not defined.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub eigenvalues: Spectrum,
    /// Whether the solution is admissible; false for virtual solutions, which are orbits that cross
    /// a surface without its event.
    #[serde(default = "yes", skip_serializing_if = "bool::clone")]
    pub admissible: bool,
    /// The arclength position along the branch, and the derivatives of parameters and monitors with
    /// respect to this position, if known.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub slopes: Option<Slopes>,
    /// The solution at the point, from which a branch can start. The solution is kept only if
    /// [`Settings::keep_solutions`] is set, and is not saved to files.
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

/// The event at which the two halves of a cycle become equal.
pub(super) const HALVED: &str = "period doubling of the orbit of half the period";

/// A special point of a branch: a point at which a defining system holds, or an end of the branch.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct SpecialPoint {
    /// The label of the special point, unique within the branch: 1, 2, … in the order in which
    /// special points were found.
    pub label: usize,
    /// The kind of the special point.
    pub kind: Kind,
    /// The name of the event at the special point, such as `fold`, `frequency_ratio = 0.12` or `end
    /// of the branch`.
    pub event: String,
    /// A standard name of the special point that is more specific than its kind, such as
    /// `grazing-sliding`; `None` if the point has no such name.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub subkind: Option<String>,
    /// The index of the preceding regular point: the special point lies between
    /// `Branch::points[after]` and the next regular point.
    pub after: usize,
    /// All parameters, in the order of [`Branch::parameters`].
    pub parameters: Vec<f64>,
    /// All monitors, in the order of [`Branch::monitors`].
    pub monitors: Vec<f64>,
    /// The number of unstable eigenvalues, not counting the eigenvalues that are critical at the
    /// special point; `None` if stability is not defined, or not [determined](Self::undetermined).
    pub unstable: Option<usize>,
    /// The reason why the eigenvalues or multipliers could not be determined; `None` if they were
    /// determined.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub undetermined: Option<String>,
    /// The leading eigenvalues or multipliers, at most [`SpecialPoint::EIGENVALUES`] in number, in
    /// the same order as in a [`Point`].
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub eigenvalues: Spectrum,
    /// Named numbers that characterise the special point, such as the frequency of a Hopf point,
    /// the angle of a torus point, or the coefficients of normal forms.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub numbers: Vec<Number>,
    /// The sensitivities of the special point: the derivatives of the released parameters at the
    /// point with respect to the other parameters. The list of sensitivities is empty if the kind
    /// of the special point has no defining system.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub sensitivities: Vec<Sensitivity>,
    /// The number of simultaneously critical eigenvalues, or pairs of eigenvalues, if this number
    /// is greater than one.
    #[serde(default = "one", skip_serializing_if = "is_one")]
    pub multiplicity: usize,
    /// The estimated absolute error of the continued parameter (the first released parameter on a
    /// curve of special points). The estimate includes Newton's last correction, rounding, and, if
    /// the problem can be refined, the discretisation error.
    pub error: f64,
    /// The values of the continued parameter at two points of the branch that enclose the special
    /// point.
    pub bracket: [f64; 2],
    /// Whether Newton's method converged on the defining system. If Newton's method did not
    /// converge, `error` is the width of the bracket around the special point, and tables show only
    /// this bracket.
    pub converged: bool,
    /// The unknowns `z` on the discretisation of the branch, from which the branch can be
    /// restarted.
    pub state: Vec<f64>,
    /// The direction of the branch at the point, from its first point to its last: `(z, released
    /// parameters)`, of scaled length 1.
    pub tangent: Vec<f64>,
    /// The arclength position along the branch, and the derivatives of parameters and monitors with
    /// respect to this position at the special point, if known.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub slopes: Option<Slopes>,
    /// The mesh of the unknowns; empty if the solutions have no mesh.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub mesh: Vec<f64>,
    /// For each released parameter, the difference between two values: the value for which `state`
    /// solves the equations on the mesh of the branch, and the refined value in `parameters`. The
    /// list is empty if the refined value of every released parameter equals its value on the mesh
    /// of the branch.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub mesh_shift: Vec<f64>,
    /// Curves that show the solution, such as profiles of the states, if the problem provides them.
    pub profiles: Vec<Profile>,
    /// The unknowns that are two-dimensional arrays, reduced to fewer entries for output.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub fields: Vec<PlaneField>,
    /// The reason why the phase response curve is missing from `profiles`, if it was requested and
    /// could not be computed.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub without_phase_response: Option<String>,
}

/// A named number of a special point.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Number {
    /// The name of the number, such as `hopf_frequency` or `l1`.
    pub name: String,
    /// The value.
    pub value: f64,
    /// The estimated absolute error of the number.
    pub error: f64,
}

impl Number {
    /// Whether the number is a detail that the command line omits from summary lines.
    ///
    /// ```
    /// use tangency::core::continuation::Number;
    /// let number = |name: &str| Number { name: name.into(), value: 1.0, error: 1e-15 };
    /// assert!(number("c1_im").is_detail() && !number("l1").is_detail());
    /// ```
    pub fn is_detail(&self) -> bool {
        DETAILS.contains(&self.name.as_str())
    }

    /// Whether the value is larger than its error. Tables show an empty cell for a value that is
    /// smaller than its error.
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
    /// The derivatives of the released parameters at the special point with respect to the constant
    /// parameter, in the order of [`Branch::released`].
    pub slopes: Vec<f64>,
}

/// A branch: a curve of zeros of the equations, with the data recorded along the curve.
///
/// Points are stored in order from one end of the branch to the other; `ends[0]` describes the end
/// at the first point, `ends[1]` the end at the last point.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Branch {
    /// The name of the branch, unique within a document.
    pub name: String,
    /// The kind of the points of the curve: `None` for a branch of solutions, `Some(LP)` for a
    /// curve of folds, and so on.
    pub condition: Option<Kind>,
    /// The itinerary of hybrid orbits, described in words, if solutions of the problem can have
    /// different itineraries.
    #[serde(default, skip_serializing_if = "String::is_empty")]
    pub itinerary: String,
    /// The discretisation method, such as `collocation(4)`; empty if solutions are not discretised.
    #[serde(default, skip_serializing_if = "String::is_empty")]
    pub method: String,
    /// The groups of unknowns, in the order in which `state` stores them.
    pub unknowns: Vec<Group>,
    /// The names of all parameters.
    pub parameters: Vec<String>,
    /// The names of the parameters that vary along the branch; the continued parameter comes first.
    pub released: Vec<String>,
    /// The names of all monitors.
    pub monitors: Vec<String>,
    /// The regular points, in order from one end of the branch to the other.
    pub points: Vec<Point>,
    /// The special points, in their order along the branch.
    pub special: Vec<SpecialPoint>,
    /// For a bifurcation curve in two parameters, the solutions on both sides of each part between
    /// successive special points. The list is empty for branches of solutions, and if the solutions
    /// on the two sides are unknown.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub stretches: Vec<Stretch>,
    /// The reasons why the branch ended: at its first point and at its last point.
    pub ends: [End; 2],
    /// Warnings about events that were passed but could not be evaluated, with the reasons.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub warnings: Vec<String>,
    /// The settings with which the branch was traced.
    pub settings: Settings,
}

impl Branch {
    /// Returns the special points of one kind, in their order along the branch.
    pub fn of_kind(&self, kind: Kind) -> impl Iterator<Item = &SpecialPoint> {
        self.special.iter().filter(move |point| point.kind == kind)
    }

    /// Returns the converged special points of one kind, in their order along the branch.
    pub fn converged_points(&self, kind: Kind) -> impl Iterator<Item = &SpecialPoint> {
        self.of_kind(kind).filter(|point| point.converged)
    }

    /// Returns the special point with the given label.
    pub fn labelled(&self, label: usize) -> Option<&SpecialPoint> {
        self.special.iter().find(|point| point.label == label)
    }

    /// Returns the solution at a special point, for
    /// [`System::resume_from`](crate::core::system::System::resume_from). Tracing a branch does not
    /// change the system of the caller, so that system may have another mesh, period or itinerary
    /// than the solution.
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

    /// Returns the names of the columns common to all points: the parameters, followed by the
    /// monitors.
    pub fn columns(&self) -> impl Iterator<Item = &str> {
        self.parameters.iter().chain(&self.monitors).map(String::as_str)
    }

    /// Returns the index of a column: of a parameter or a monitor among
    /// [`columns`](Branch::columns), or of the real or imaginary part of a stored eigenvalue or
    /// multiplier (`eigenvalue[0]`, `eigenvalue[0].imaginary`, …), whose columns follow the
    /// monitors.
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

    /// Returns the columns that show a quantity: usually the single [column](Self::column) with its
    /// name. For equilibria, `max_x` and `min_x` also select `x`; for orbits, `x` also selects
    /// `max_x` and `min_x`.
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
    /// Creates a regular point of an admissible solution, without eigenvalues.
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

    /// Returns the value in a column; the columns are the parameters, the monitors and the
    /// eigenvalues, in this order.
    pub fn value(&self, column: usize) -> Option<f64> {
        let eigenvalues = self.eigenvalues.iter().flat_map(|(real, imaginary)| [real, imaginary]);
        self.parameters.iter().chain(&self.monitors).chain(eigenvalues).nth(column).copied()
    }
}

impl SpecialPoint {
    /// The maximal number of eigenvalues stored with a special point.
    pub const EIGENVALUES: usize = 10;

    /// Whether the two halves of the cycle are equal at this special point, which is the end of the
    /// branch: the branch emanates here from cycles of half the period.
    pub fn halves_the_period(&self) -> bool {
        self.event == HALVED
    }

    /// Creates a special point whose values are not yet set.
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

    /// Returns the named number of the special point with this name.
    pub fn number(&self, name: &str) -> Option<&Number> {
        self.numbers.iter().find(|number| number.name == name)
    }

    /// Converts the special point to a regular point.
    pub(super) fn point(&self) -> Point {
        let (undetermined, slopes) = (self.undetermined.clone(), self.slopes.clone());
        let point = Point::new(self.parameters.clone(), self.monitors.clone(), self.unstable);
        Point { undetermined, slopes, ..point }
    }

    /// Returns the value in a column; the columns are the parameters followed by the monitors.
    pub fn value(&self, column: usize) -> Option<f64> {
        self.parameters.iter().chain(&self.monitors).nth(column).copied()
    }
}

/// A regular or special point, reported while a branch is traced.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub enum Traced {
    /// A regular point was computed. The first point that is reported is the start of the branch.
    Point(Point),
    /// A special point was found; it is reported before the next regular point.
    Special(Box<SpecialPoint>),
}

//! Branches as data: what a trace leaves behind, to be saved, drawn, restarted and tested.

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
    /// The number of unstable eigenvalues; `None` where stability is not meant, or is not
    /// [determined](Self::undetermined).
    pub unstable: Option<usize>,
    /// The reason why eigenvalues or multipliers are not determined, if they are not. Test
    /// functions that depend on them are not evaluated at the point.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub undetermined: Option<String>,
    /// As many of the eigenvalues or multipliers as [`Settings::eigenvalues`] asks for, as (real
    /// part, imaginary part): those that decide stability, by falling real parts. Empty at the
    /// branch's ends, where one is infinite (at a grazing), and where stability is not meant.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub eigenvalues: Spectrum,
    /// Whether the equations say something about the world there: a solution beyond a grazing,
    /// which passes through a surface, is virtual.
    #[serde(default = "yes", skip_serializing_if = "bool::clone")]
    pub admissible: bool,
    /// The position along the branch, and the derivatives of the columns by the position, where they
    /// are known.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub slopes: Option<Slopes>,
    /// The solution, from which a branch can start, where [`Settings::keep_solutions`] is set; it
    /// is not saved.
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

/// A special point of a branch: where a condition holds, or where the branch begins or ends.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct SpecialPoint {
    /// Its label, unique within its branch: 1, 2, … in the order in which they were found.
    pub label: usize,
    /// Its kind.
    pub kind: Kind,
    /// Which event it is, in words: `fold`, `frequency_ratio = 0.12`, `end of the branch`.
    pub event: String,
    /// What the field calls it beyond its kind, if it has such a name: `grazing-sliding`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub subkind: Option<String>,
    /// It lies behind `Branch::points[after]` and before the next point.
    pub after: usize,
    /// All parameters, in the order of [`Branch::parameters`].
    pub parameters: Vec<f64>,
    /// All monitors, in the order of [`Branch::monitors`].
    pub monitors: Vec<f64>,
    /// The number of unstable eigenvalues, without those that are critical there; `None` where
    /// stability is not meant, or is not [determined](Self::undetermined).
    pub unstable: Option<usize>,
    /// The reason why eigenvalues or multipliers are not determined, if they are not.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub undetermined: Option<String>,
    /// The leading eigenvalues or multipliers, at most [`SpecialPoint::EIGENVALUES`], as those of a
    /// [`Point`].
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub eigenvalues: Spectrum,
    /// Numbers that belong to such a point: the frequency of a Hopf point, the angle of a torus
    /// point, the coefficients of normal forms.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub numbers: Vec<Number>,
    /// How the released parameters of the point depend on the others, to first order. Empty where
    /// the point has no defining system.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub sensitivities: Vec<Sensitivity>,
    /// How many eigenvalues, or pairs, are critical together, where it is more than one.
    #[serde(default = "one", skip_serializing_if = "is_one")]
    pub multiplicity: usize,
    /// The estimated absolute error of the continued parameter (of the first released one on a
    /// curve of events), from Newton's last correction, rounding, and the discretisation where the
    /// problem can be refined.
    pub error: f64,
    /// Values of the continued parameter at the two points of the branch that enclose it.
    pub bracket: [f64; 2],
    /// Whether Newton converged on the defining system; otherwise `error` is that of the bracket,
    /// and tables show the bracket only.
    pub converged: bool,
    /// The unknowns `z` on the branch's own discretisation, from which the branch can be restarted.
    pub state: Vec<f64>,
    /// The direction of the branch there, from its first point to its last:
    /// `(z, released parameters)`, of scaled length 1.
    pub tangent: Vec<f64>,
    /// The position along the branch, and the derivatives of the columns there, where they are known.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub slopes: Option<Slopes>,
    /// The mesh that the unknowns are values on; empty if they are on none.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub mesh: Vec<f64>,
    /// Curves that belong to the solution, as the problem offers them.
    pub profiles: Vec<Profile>,
    /// The arrays of two indices among the unknowns, thinned.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub fields: Vec<PlaneField>,
    /// The reason why there is no phase response among them, where one was wanted.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub without_phase_response: Option<String>,
}

/// A number that belongs to a special point.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Number {
    /// Its name: `hopf_frequency`, `l1`.
    pub name: String,
    /// Its value.
    pub value: f64,
    /// Its estimated absolute error.
    pub error: f64,
}

impl Number {
    /// Whether the number is a detail, which lines on a screen leave out.
    ///
    /// ```
    /// use tangency::core::continuation::Number;
    /// let number = |name: &str| Number { name: name.into(), value: 1.0, error: 1e-15 };
    /// assert!(number("c1_im").is_detail() && !number("l1").is_detail());
    /// ```
    pub fn is_detail(&self) -> bool {
        DETAILS.contains(&self.name.as_str())
    }
}

/// How the location of a special point depends on a parameter that is held along the branch.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Sensitivity {
    /// The parameter.
    pub by: String,
    /// The derivatives of the released parameters, in the order of [`Branch::released`], at the
    /// special point as the parameter changes.
    pub slopes: Vec<f64>,
}

/// A branch: a curve of zeros with what was recorded along it.
///
/// Points run from one end to the other; `ends[0]` belongs to the first point, `ends[1]` to the
/// last.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Branch {
    /// Its name, unique within a document.
    pub name: String,
    /// What the curve is made of: `None` for solutions, `Some(LP)` for a curve of folds, and so on.
    pub condition: Option<Kind>,
    /// What solutions go through, in words, where that is not the same for all solutions of the
    /// problem: the itinerary of hybrid orbits.
    #[serde(default, skip_serializing_if = "String::is_empty")]
    pub itinerary: String,
    /// The method by which solutions are discretised, such as `collocation(4)`; empty if they are
    /// not.
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
    /// The solutions on both sides of a curve in two parameters, between its special points. Empty for
    /// branches of solutions, and where it is not known.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub stretches: Vec<Stretch>,
    /// Why the branch ended, at its first and at its last point.
    pub ends: [End; 2],
    /// Events that were passed but could not be evaluated, and why.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub warnings: Vec<String>,
    /// The settings that made it.
    pub settings: Settings,
}

impl Branch {
    /// The special points of one kind, in the order of the branch.
    pub fn of_kind(&self, kind: Kind) -> impl Iterator<Item = &SpecialPoint> {
        self.special.iter().filter(move |point| point.kind == kind)
    }

    /// The special points of one kind that have converged, in the order of the branch.
    pub fn converged_points(&self, kind: Kind) -> impl Iterator<Item = &SpecialPoint> {
        self.of_kind(kind).filter(|point| point.converged)
    }

    /// The special point with a label.
    pub fn labelled(&self, label: usize) -> Option<&SpecialPoint> {
        self.special.iter().find(|point| point.label == label)
    }

    /// The solution at a special point, for
    /// [`System::resume_from`](crate::core::system::System::resume_from): a trace does
    /// not change the system of the caller, which may have another mesh, period or itinerary.
    pub fn solution(&self, special: &SpecialPoint) -> Solution {
        let (n, mut slopes) = (special.state.len(), vec![0.0; special.parameters.len()]);
        let known = special.tangent.len() == n + self.released.len();
        let released = special.tangent.iter().skip(n).zip(&self.released);
        // Of two critical pairs, the frequency of the one that the curve is not made of.
        let mut names = ["second_frequency", "second_angle", "hopf_frequency"].into_iter();
        let frequency = names.find_map(|name| special.number(name));
        for (slope, name) in released.filter(|_| known) {
            let places = slopes.iter_mut().zip(&self.parameters).filter(|it| it.1 == name);
            places.for_each(|it| *it.0 = *slope);
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
            multiplicity: special.multiplicity,
            frequency: frequency.map(|number| number.value),
            error: special.error,
            switch: None,
            beside: None,
        }
    }

    /// The names of all columns that every point has: parameters, then monitors.
    pub fn columns(&self) -> impl Iterator<Item = &str> {
        self.parameters.iter().chain(&self.monitors).map(String::as_str)
    }

    /// The position of a parameter or a monitor among [`columns`](Branch::columns); behind them, of
    /// the real or imaginary part of an eigenvalue or multiplier that is kept with points:
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

    /// The columns that show a quantity: the [column](Self::column) of its name. Where motion rests,
    /// `x` shows `max_x` and `min_x`; where motion goes on, `max_x` and `min_x` show `x`.
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
    /// An admissible point without eigenvalues.
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
    /// How many eigenvalues are kept with a special point.
    pub const EIGENVALUES: usize = 10;

    /// A point without values.
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
            profiles: Vec::new(),
            fields: Vec::new(),
            without_phase_response: None,
        }
    }

    /// The number with this name that belongs to the point.
    pub fn number(&self, name: &str) -> Option<&Number> {
        self.numbers.iter().find(|number| number.name == name)
    }

    /// Its values as those of a regular point.
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
    /// A point was reached, the start first.
    Point(Point),
    /// A special point was found, before the next point.
    Special(Box<SpecialPoint>),
}

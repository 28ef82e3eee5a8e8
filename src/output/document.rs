//! Documents: branches with the settings of their computation, and their plots.

use super::chosen::Chosen;
use super::error::UnknownPoint;
use super::tag::FORMAT;
use crate::core::continuation::{Branch, SpecialPoint};
use crate::core::problem::{UnknownName, position};
use crate::core::system::Kind;
use serde::{Deserialize, Serialize};

/// A collection of branches with the settings of their computation and their default plot.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Document {
    /// Always [`FORMAT`].
    pub format: String,
    /// The title of the document, in words.
    pub title: String,
    /// The settings with which all branches were computed, by unique name, for example the scene,
    /// its terms, and the number of its modes.
    #[serde(default)]
    pub settings: Vec<(String, String)>,
    /// The settings that were chosen to achieve a requested accuracy.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub chosen: Option<Chosen>,
    /// The default plot of the branches.
    #[serde(default)]
    pub plot: Plot,
    /// Settings that differ between branches: the name of each such branch, and the settings of
    /// this branch by name.
    #[serde(default)]
    pub differences: Vec<(String, Vec<(String, String)>)>,
    /// The branches of the document; their names are unique.
    pub branches: Vec<Branch>,
}

/// The default plot of branches.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct Plot {
    /// The column on the horizontal axis of the plot; by default the first varied parameter.
    pub x: Option<String>,
    /// The column on the vertical axis of the plot; by default the first monitor (for a curve of
    /// special points, the second varied parameter).
    pub y: Option<String>,
    /// The labels of columns on axes, with units: `("load", "load V² (1)")`. The label of a column
    /// without an entry is its name.
    pub labels: Vec<(String, String)>,
    /// Additional panels of diagrams, each given by the two columns on its horizontal and vertical
    /// axis. Branches that do not contain both columns of a panel are omitted from it.
    pub panels: Vec<(String, String)>,
    /// Additional panels in plots of parameter sweeps, each given by the two columns on its
    /// horizontal and vertical axis.
    pub swept: Vec<(String, String)>,
    /// The profiles to draw for each special point, as pairs (abscissa, ordinate):
    /// `("displacement", "velocity")` is the phase portrait, `("time", "velocity")` a time history.
    /// By default all.
    pub profiles: Vec<(String, String)>,
    /// The special points whose profiles are drawn, as `LABEL` or `BRANCH/LABEL`; by default a
    /// selection is drawn.
    pub points: Vec<String>,
    /// The names of the branches that diagrams show; by default all branches.
    pub curves: Vec<String>,
    /// The numbers that diagrams add to the values of a branch in a column, to compare curves of
    /// different height: name of the branch, name of the column, number.
    pub shifts: Vec<(String, String, f64)>,
    /// The columns that diagrams show as deviations from the value at a special point, or as roots
    /// of such deviations.
    pub deviations: Vec<Deviation>,
    /// The ranges of axes, as (column, lower end, upper end), in the units of the numbers written
    /// on the axis.
    pub ranges: Vec<(String, f64, f64)>,
    /// The columns with logarithmic axes; an axis of several columns is logarithmic if all its
    /// columns are named. Points with a zero or negative value in a column with a logarithmic axis
    /// are not drawn.
    pub logarithmic: Vec<String>,
    /// Whether curves of bifurcations in two parameters are labelled on both sides with the number
    /// of unstable directions.
    #[serde(skip_serializing_if = "std::ops::Not::not")]
    pub regions: bool,
    /// Parts of the diagram that are enlarged in separate panels; the ranges of these parts are in
    /// the units of the axes.
    pub enlargements: Vec<Enlargement>,
    /// Plots of special points from all branches against a setting in which the branches differ.
    pub against: Vec<Against>,
}

/// A part of a diagram to enlarge, given by its ranges on both axes.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Enlargement {
    /// The range of the enlarged part on the horizontal axis.
    pub x: [f64; 2],
    /// The range of the enlarged part on the vertical axis.
    pub y: [f64; 2],
}

/// A column that diagrams show as its deviation from the value at a special point: `V − V*` for an
/// orbit that grazes at `V*`, or `√(V − V*)`, which straightens curves that emanate from the
/// special point like a square root.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Deviation {
    /// The column that is shown as a deviation.
    pub column: String,
    /// The branch that contains the special point.
    pub branch: String,
    /// The exponent `p` of the shown deviation: diagrams show `|v|^p` with the sign of `v`, where
    /// `v` is the deviation.
    pub kind: Kind,
    /// The exponent of the absolute deviation: diagrams show the absolute deviation raised to this
    /// power, with the sign of the deviation.
    #[serde(default = "one")]
    pub power: f64,
}

fn one() -> f64 {
    1.0
}

impl Deviation {
    /// Returns the number that an axis shows for a value of the column, given the value at the
    /// special point.
    ///
    /// ```
    /// use tangency::core::system::Kind;
    /// use tangency::output::Deviation;
    /// let (column, branch) = ("voltage".into(), "nonimpacting".into());
    /// let root = Deviation { column, branch, kind: Kind::G, power: 0.5 };
    /// assert_eq!((root.shown(0.2, 0.16), root.shown(0.12, 0.16)), (0.2, -0.2));
    /// ```
    pub fn shown(&self, value: f64, at: f64) -> f64 {
        let deviation = value - at;
        deviation.abs().powf(self.power).copysign(deviation)
    }
}

/// A plot of the special points of one kind against a setting that differs between branches, for
/// example pull-in against the number of modes. Branches that also differ in other settings form
/// separate series, one for each combination of values of these settings.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Against {
    /// The kind of the special points; the first special point of this kind on each branch is used.
    pub kind: Kind,
    /// The name of the numerical setting on the horizontal axis.
    pub setting: String,
    /// The name of the parameter or monitor on the vertical axis.
    pub column: String,
}

impl Plot {
    /// Returns the label of an axis that shows a column.
    pub fn label<'a>(&'a self, column: &'a str) -> &'a str {
        let entry = self.labels.iter().find(|(name, _)| name == column);
        entry.map_or(column, |(_, label)| label)
    }

    /// Returns a copy of the plot for the given branches only: parts that concern other branches,
    /// or columns that the given branches lack, are removed.
    ///
    /// ```
    /// use tangency::output::{Plot, example_branch};
    /// let columns = |x: &str, y: &str| (x.to_string(), y.to_string());
    /// let panels = vec![columns("load", "deflection"), columns("load", "period")];
    /// let plot = Plot { y: Some("period".into()), panels, ..Plot::default() };
    /// let own = plot.restricted(&[example_branch()]);
    /// assert_eq!((own.y, own.panels), (None, vec![columns("load", "deflection")]));
    /// ```
    pub fn restricted(&self, branches: &[Branch]) -> Plot {
        let shows = |branch: &Branch, name: &str| !branch.columns_showing(name).is_empty();
        let has = |name: &str| branches.iter().any(|branch| shows(branch, name));
        let named = |name: &str| branches.iter().any(|branch| branch.name == name);
        let mut own = self.clone();
        let both =
            |x: &str, y: &str| branches.iter().any(|branch| shows(branch, x) && shows(branch, y));
        own.x = own.x.filter(|name| has(name));
        let beside = own.x.clone();
        own.y = own.y.filter(|y| beside.as_ref().map_or(has(y), |x| both(x, y)));
        own.panels.retain(|(x, y)| both(x, y));
        own.swept.clear();
        // Labels may have changed.
        own.points.clear();
        own.curves.retain(|name| named(name));
        // If an axis is removed, its column is no longer logarithmic.
        let is_axis = |plot: &Plot, column: &str| {
            [&plot.x, &plot.y].iter().any(|it| it.as_deref() == Some(column))
        };
        let kept = |it: &&String| has(it) && is_axis(self, it) == is_axis(&own, it);
        own.logarithmic = self.logarithmic.iter().filter(kept).cloned().collect();
        own.shifts.retain(|(branch, column, _)| named(branch) && has(column));
        own.deviations.retain(|deviation| {
            let of_branch = branches.iter().find(|branch| branch.name == deviation.branch);
            of_branch.is_some_and(|branch| branch.of_kind(deviation.kind).next().is_some())
        });
        // A range in the numbers of a deviation is not valid without the deviation.
        let deviates =
            |plot: &Plot, column: &str| plot.deviations.iter().any(|it| it.column == column);
        let kept = |column: &str| has(column) && deviates(self, column) == deviates(&own, column);
        let ranges = self.ranges.iter().filter(|(column, ..)| kept(column)).cloned().collect();
        own.ranges = ranges;
        if (&own.x, &own.y, &own.deviations) != (&self.x, &self.y, &self.deviations) {
            own.enlargements.clear();
        }
        own.against.retain(|against| {
            let has_point = |branch: &Branch| branch.of_kind(against.kind).next().is_some();
            branches.len() > 1 && branches.iter().all(has_point)
        });
        own
    }

    /// Returns the range of a column that the plot shows.
    pub(super) fn range(&self, column: &str) -> [f64; 2] {
        let given = self.ranges.iter().find(|(name, ..)| name == column);
        given.map_or([f64::NEG_INFINITY, f64::INFINITY], |(_, low, high)| [*low, *high])
    }

    /// Returns whether the axis of a column is logarithmic.
    pub(super) fn is_logarithmic(&self, column: &str) -> bool {
        self.logarithmic.iter().any(|name| name == column)
    }

    /// Returns the number that diagrams add to the values of a branch in a column.
    pub(super) fn shift(&self, branch: &str, column: &str) -> f64 {
        let meant = |entry: &&(String, String, f64)| entry.0 == branch && entry.1 == column;
        self.shifts.iter().find(meant).map_or(0.0, |(_, _, shift)| *shift)
    }
}

impl Document {
    /// Creates a document without settings, with the default plot.
    pub fn new(title: impl Into<String>, branches: Vec<Branch>) -> Self {
        Document {
            format: FORMAT.into(),
            title: title.into(),
            settings: Vec::new(),
            chosen: None,
            plot: Plot::default(),
            differences: Vec::new(),
            branches,
        }
    }

    /// Returns the value of a setting of the document.
    pub fn setting(&self, name: &str) -> Option<&str> {
        self.settings.iter().find(|(key, _)| key == name).map(|(_, value)| value.as_str())
    }

    /// Returns the branch with the given name.
    ///
    /// # Errors
    /// [`UnknownName`] with the names of the existing branches, if no branch has the given name.
    pub fn branch(&self, name: &str) -> Result<&Branch, UnknownName> {
        let names = self.branches.iter().map(|branch| &branch.name);
        Ok(&self.branches[position("branch", name, names)?])
    }

    /// Returns the special point with a given label: on the named branch, or, without a name, on
    /// the only branch that contains the label.
    ///
    /// # Errors
    /// [`UnknownPoint`] if the branch or the label does not exist, or if several branches contain
    /// the label.
    ///
    /// ```
    /// use tangency::output::{Document, example_branch};
    /// let document = Document::new("plate", vec![example_branch()]);
    /// let (branch, fold) = document.special_point(None, 3)?;
    /// assert_eq!((branch.name.as_str(), fold.event.as_str()), ("plate", "fold"));
    /// assert_eq!(
    ///     document.special_point(Some("plate"), 9).unwrap_err().to_string(),
    ///     "no special point has the label 9"
    /// );
    /// # Ok::<(), tangency::output::UnknownPoint>(())
    /// ```
    pub fn special_point(
        &self,
        branch: Option<&str>,
        label: usize,
    ) -> Result<(&Branch, &SpecialPoint), UnknownPoint> {
        let meant: Vec<&Branch> = match branch {
            Some(name) => vec![self.branch(name)?],
            None => self.branches.iter().collect(),
        };
        let full = |branch: &Branch, label: usize| format!("{}/{label}", branch.name);
        let found: Vec<_> =
            meant.iter().filter_map(|b| b.labelled(label).map(|point| (*b, point))).collect();
        match found[..] {
            [only] => Ok(only),
            [] => Err(UnknownPoint::Label {
                label,
                known: meant
                    .iter()
                    .flat_map(|b| b.special.iter().map(|point| full(b, point.label)))
                    .collect(),
            }),
            _ => Err(UnknownPoint::Ambiguous {
                label,
                candidates: found.iter().map(|(b, point)| full(b, point.label)).collect(),
            }),
        }
    }
}

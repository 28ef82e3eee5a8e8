//! Documents: branches, what made them and how they are drawn, as RON.

use super::check;
use super::chosen::Chosen;
use super::error::{FileError, FormatError, UnknownPoint};
use super::write::write_atomically;
use crate::core::continuation::{Branch, Kind, SpecialPoint};
use crate::core::names::UnknownName;
use ron::extensions::Extensions;
use ron::ser::PrettyConfig;
use serde::{Deserialize, Serialize};
use std::path::Path;

/// The tag by which a document is known, with the version of its format.
pub const FORMAT: &str = "tangency/1";

/// Branches with what made them and how they are drawn by default.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Document {
    /// Always [`FORMAT`].
    pub format: String,
    /// The title, in words.
    pub title: String,
    /// What made the branches, by unique name: the scene, its terms, the number of its modes.
    #[serde(default)]
    pub settings: Vec<(String, String)>,
    /// What of the settings was chosen for an accuracy.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub chosen: Option<Chosen>,
    /// How the branches are drawn by default.
    #[serde(default)]
    pub plot: Plot,
    /// In what branches differ from the settings: a branch's name, and its own settings by name.
    #[serde(default)]
    pub differences: Vec<(String, Vec<(String, String)>)>,
    /// The branches; their names are unique.
    pub branches: Vec<Branch>,
}

/// How branches are drawn by default.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct Plot {
    /// The column for the horizontal axis; if it is not given, the first released parameter.
    pub x: Option<String>,
    /// The column for the vertical axis; if it is not given, the first monitor (on a curve of events
    /// the second released parameter).
    pub y: Option<String>,
    /// What stands at an axis that shows a column, with its unit: `("load", "load V² (1)")`.
    /// A column without an entry is shown by its name.
    pub labels: Vec<(String, String)>,
    /// Further panels, as pairs of columns for the horizontal and the vertical axis. Branches that lack one of
    /// them are left out.
    pub panels: Vec<(String, String)>,
    /// Further panels where sweeps are drawn.
    pub swept: Vec<(String, String)>,
    /// The kinds of profiles that are drawn, as pairs (abscissa, ordinate): `("displacement", "velocity")` is
    /// the phase portrait, `("time", "velocity")` a time history. If none is given, all.
    pub profiles: Vec<(String, String)>,
    /// The special points whose profiles are drawn, as `LABEL` or `BRANCH/LABEL`; if none is given, those of
    /// interest.
    pub points: Vec<String>,
    /// The branches that diagrams show, by name; if none is given, all.
    pub curves: Vec<String>,
    /// What is added to a column of a branch in diagrams, to compare curves of different height: branch,
    /// column, shift.
    pub shifts: Vec<(String, String, f64)>,
    /// Columns that are shown as deviations from a special point, or as roots of these.
    pub deviations: Vec<Deviation>,
    /// The part of a column that is shown, in the numbers of its axis: column, low, high.
    pub ranges: Vec<(String, f64, f64)>,
    /// Parts of the diagram that are shown again in panels of their own, in the numbers of its axes.
    pub enlargements: Vec<Enlargement>,
    /// Special points of all branches against a setting in which the branches differ.
    pub against: Vec<Against>,
}

/// A part of a diagram: its ends on both axes.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Enlargement {
    /// On the horizontal axis.
    pub x: [f64; 2],
    /// On the vertical axis.
    pub y: [f64; 2],
}

/// A column that diagrams show as its deviation from a special point: `V − V*` where an orbit grazes at `V*`, or
/// `√(V − V*)`, in which what begins there like a root is a line.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Deviation {
    /// The column.
    pub column: String,
    /// The branch with the special point.
    pub branch: String,
    /// Its kind; the first one of the branch counts.
    pub kind: Kind,
    /// The power of the deviation that is shown, negative where the deviation is.
    #[serde(default = "one")]
    pub power: f64,
}

fn one() -> f64 {
    1.0
}

impl Deviation {
    /// What is shown for a value, where the special point has another one.
    ///
    /// ```
    /// use tangency::core::continuation::Kind;
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

/// Special points of one kind against a setting in which branches differ: pull-in against the number
/// of modes. Branches that differ in other settings as well make one series for each of these.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Against {
    /// The kind of special point; the first one of each branch counts.
    pub kind: Kind,
    /// The setting, a number.
    pub setting: String,
    /// The parameter or monitor for the vertical axis.
    pub column: String,
}

impl Plot {
    /// What stands at an axis that shows a column.
    pub fn label<'a>(&'a self, column: &'a str) -> &'a str {
        let entry = self.labels.iter().find(|(name, _)| name == column);
        entry.map_or(column, |(_, label)| label)
    }

    /// The part of a column that is shown.
    pub(super) fn range(&self, column: &str) -> [f64; 2] {
        let given = self.ranges.iter().find(|(name, ..)| name == column);
        given.map_or([f64::NEG_INFINITY, f64::INFINITY], |(_, low, high)| [*low, *high])
    }

    /// What is added to a column of a branch.
    pub(super) fn shift(&self, branch: &str, column: &str) -> f64 {
        let meant = |entry: &&(String, String, f64)| entry.0 == branch && entry.1 == column;
        self.shifts.iter().find(meant).map_or(0.0, |(_, _, shift)| *shift)
    }
}

impl Document {
    /// A document without settings, drawn as it comes.
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

    /// The value of a setting.
    pub fn setting(&self, name: &str) -> Option<&str> {
        self.settings.iter().find(|(key, _)| key == name).map(|(_, value)| value.as_str())
    }

    /// The branch with a name.
    ///
    /// # Errors
    /// [`UnknownName`] with the names of the branches that exist.
    pub fn branch(&self, name: &str) -> Result<&Branch, UnknownName> {
        self.branches.iter().find(|branch| branch.name == name).ok_or_else(|| {
            UnknownName::new("branch", name, self.branches.iter().map(|branch| &*branch.name))
        })
    }

    /// The special point with a label, on a named branch or on the only branch that has it.
    ///
    /// # Errors
    /// [`UnknownPoint`] if there is no such branch, no such label, or if several branches have it.
    ///
    /// ```
    /// use tangency::output::{Document, example_branch};
    /// let document = Document::new("plate", vec![example_branch()]);
    /// let (branch, fold) = document.special_point(None, 3)?;
    /// assert_eq!((branch.name.as_str(), fold.event.as_str()), ("plate", "fold"));
    /// assert_eq!(
    ///     document.special_point(Some("plate"), 9).unwrap_err().to_string(),
    ///     "no special point has the label 9; known: plate/1, plate/2, plate/3, plate/4"
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

    /// The document as RON, one line a point, every number with all its digits.
    ///
    /// # Errors
    /// [`FormatError::Invalid`] if the text could not be read back: a number that is not finite, a
    /// list of the wrong length, a name twice.
    pub fn to_ron(&self) -> Result<String, FormatError> {
        check::document(self)?;
        let pretty = PrettyConfig::new()
            .depth_limit(4)
            .indentor("  ")
            // Written into the text, so that any reader of RON understands it.
            .extensions(Extensions::IMPLICIT_SOME);
        let mut text = ron::ser::to_string_pretty(self, pretty)
            .map_err(|error| FormatError::Unwritable(error.to_string()))?;
        text.push('\n');
        Ok(text)
    }

    /// Reads a document from its RON.
    ///
    /// # Errors
    /// [`FormatError`] with line and column, or with branch, point and column of a value that makes
    /// no sense.
    ///
    /// ```
    /// use tangency::output::Document;
    /// let error = Document::parse("(width: 3.0)").unwrap_err().to_string();
    /// assert!(error.starts_with("not a tangency document (line 1, column "), "{error}");
    /// ```
    pub fn parse(text: &str) -> Result<Self, FormatError> {
        let document: Document = options().from_str(text).map_err(|error| explain(text, &error))?;
        check::document(&document)?;
        Ok(document)
    }

    /// Saves the document, whole or not at all.
    ///
    /// # Errors
    /// [`FileError::Write`] if the file cannot be written, [`FileError::Format`] if it could not be
    /// read back.
    pub fn save(&self, path: impl AsRef<Path>) -> Result<(), FileError> {
        let path = path.as_ref();
        let text =
            self.to_ron().map_err(|source| FileError::Format { path: path.into(), source })?;
        write_atomically(path, &text)
    }

    /// Loads a document.
    ///
    /// # Errors
    /// [`FileError::Read`] if the file cannot be read, [`FileError::Format`] if it is no document.
    ///
    /// ```
    /// use tangency::output::{Document, example_branch};
    /// let folder = tempfile::tempdir()?;
    /// let path = folder.path().join("plate.ron");
    /// let document = Document::new("plate", vec![example_branch()]);
    /// document.save(&path)?;
    /// assert_eq!(Document::load(&path)?, document);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn load(path: impl AsRef<Path>) -> Result<Self, FileError> {
        let path = path.as_ref();
        let text = std::fs::read_to_string(path)
            .map_err(|source| FileError::Read { path: path.into(), source })?;
        Document::parse(&text).map_err(|source| FileError::Format { path: path.into(), source })
    }
}

fn options() -> ron::Options {
    ron::Options::default().with_default_extension(Extensions::IMPLICIT_SOME)
}

/// Says whether a text that could not be read is foreign, of another version, cut short or mistaken.
fn explain(text: &str, error: &ron::error::SpannedError) -> FormatError {
    let (line, column) = (error.span.start.line, error.span.start.col);
    let reason = error.code.to_string();
    match tag(text) {
        None => FormatError::Foreign { line, column, reason },
        Some(tag) if tag != FORMAT => FormatError::Version { found: tag.into() },
        Some(_) if reaches_the_end(text, &error.span) => FormatError::Truncated { line, column },
        Some(_) => FormatError::Syntax { line, column, found: found(text, &error.span), reason },
    }
}

/// The tag of a text that may be mistaken elsewhere.
fn tag(text: &str) -> Option<&str> {
    let start = text.find("\"tangency/")? + 1;
    text[start..].split('"').next()
}

fn reaches_the_end(text: &str, span: &ron::error::Span) -> bool {
    let text = text.trim_end();
    let lines = text.lines().count().max(1);
    let last = text.lines().last().unwrap_or_default().chars().count();
    span.end.line > lines || (span.end.line == lines && span.end.col > last)
}

/// What stands where reading failed, to the end of the entry or the line: at most 40 letters.
fn found(text: &str, span: &ron::error::Span) -> String {
    let line = text.lines().nth(span.start.line.saturating_sub(1)).unwrap_or_default();
    let same_line = span.start.line == span.end.line;
    let known = if same_line { span.end.col.saturating_sub(span.start.col) } else { 0 };
    let letters = line.chars().skip(span.start.col.saturating_sub(1)).take(40).enumerate();
    let piece: String = letters
        .take_while(|(index, letter)| match known {
            // The reader stopped at the first letter of what it could not read.
            0 | 1 => *index == 0 || !",)]}".contains(*letter),
            _ => *index < known,
        })
        .map(|(_, letter)| letter)
        .collect();
    piece.trim().into()
}

//! Reports, the common trait of work-precision diagrams and robustness maps: data in RON, tables in
//! Markdown, figures in SVG, and a summary for a page.

use serde::Serialize;
use serde::de::DeserializeOwned;
use std::path::{Path, PathBuf};
use tangency::output::{
    Figure, Format, FormatError, PAGE, Render, RenderError, SaveError, draw, save,
};

/// A report: named results on one subject, which can be saved as data, shown as tables and figures,
/// and inserted into pages.
///
/// ```
/// use tangency_reports::{Measured, Report, WorkPrecision};
/// let panels = vec![Measured::of("New")];
/// let diagram = WorkPrecision { name: "work-precision-a".into(), panels, ..WorkPrecision::default() };
/// assert_eq!(WorkPrecision::parse(&diagram.to_ron()?)?, diagram);
/// let page = diagram.put_into("# Page\n\n<!-- work-precision-a -->\nold\n<!-- end -->\n\nText.\n");
/// assert!(page.starts_with("# Page\n\n<!-- work-precision-a -->\n\n### New\n"));
/// assert!(page.ends_with("<!-- end -->\n\nText.\n"));
/// assert!(!page.contains("old"));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub trait Report: Serialize + DeserializeOwned {
    /// Returns the name of the report, which is also the name of its files and the name in the
    /// comment `<!-- NAME -->` that marks its place in a page.
    fn name(&self) -> &str;

    /// Returns the figures of the report, one for each panel.
    fn figures(&self) -> Vec<Figure>;

    /// Returns all results of the report as Markdown tables.
    fn to_markdown(&self) -> String;

    /// Returns the summary of the results that is inserted into a page, in Markdown.
    fn summary(&self) -> String;

    /// Returns the given page, with the text between `<!-- NAME -->` and `<!-- end -->` replaced by
    /// the summary of the report.
    fn put_into(&self, page: &str) -> String {
        let begin = format!("<!-- {} -->\n", self.name());
        let place = page.split_once(&begin).and_then(|(before, rest)| {
            let end = rest.find("<!-- end -->")?;
            Some((before, &rest[end..]))
        });
        match place {
            Some((before, after)) => format!("{before}{begin}\n{}\n{after}", self.summary()),
            None => page.into(),
        }
    }

    /// Serializes the report as RON.
    ///
    /// # Errors
    /// [`ron::Error`] if the report cannot be serialized.
    fn to_ron(&self) -> Result<String, ron::Error> {
        ron::ser::to_string_pretty(self, ron::ser::PrettyConfig::default())
    }

    /// Parses a report from RON.
    ///
    /// # Errors
    /// [`ron::error::SpannedError`] if the text is not a valid report; the error contains its
    /// position in the text.
    fn parse(text: &str) -> Result<Self, ron::error::SpannedError> {
        ron::from_str(text)
    }

    /// Writes the report to a folder as three files: `NAME.ron`, `NAME.md` and `NAME.svg`.
    ///
    /// # Errors
    /// [`SaveError`] if a file cannot be written, or if the report contains no figure to draw.
    fn save(&self, folder: &Path) -> Result<Vec<PathBuf>, SaveError> {
        let formats = [Format::Ron, Format::Markdown, Format::Svg];
        save(&Files(self), &folder.join(self.name()), &formats)
    }
}

/// A report in the form in which it is saved: each file contains the report in one format.
struct Files<'a, R>(&'a R);

impl<R: Report> Render for Files<'_, R> {
    fn render(&self, format: Format) -> Result<Vec<u8>, RenderError> {
        match format {
            Format::Ron => match self.0.to_ron() {
                Ok(text) => Ok(text.into_bytes()),
                Err(cause) => Err(FormatError::Unwritable(cause.to_string()).into()),
            },
            Format::Markdown => Ok(self.0.to_markdown().into_bytes()),
            Format::Svg => Ok(draw(&self.0.figures(), PAGE)?.into_bytes()),
            _ => Err(RenderError::Unsuited("a report has .ron, .md and .svg")),
        }
    }
}

/// An entry of the list of reports: the name, a description and the function that computes the
/// report.
#[derive(Clone, Copy)]
pub struct Entry<M> {
    /// The name.
    pub name: &'static str,
    /// A description of the report's contents in one line.
    pub shows: &'static str,
    /// The function that computes the report.
    pub make: M,
}

macro_rules! entries {
    ($($name:literal: $shows:literal, $make:path;)*) => {
        &[$($crate::Entry { name: $name, shows: $shows, make: $make }),*]
    };
}
pub(crate) use entries;

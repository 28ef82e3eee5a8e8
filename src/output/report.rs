//! What charts and maps share: they are data in RON, tables in Markdown, a figure, and a part of a page.

use super::error::{FigureError, FileError};
use super::figure::Figure;
use super::write::write_atomically;
use serde::Serialize;
use serde::de::DeserializeOwned;
use std::path::Path;

/// Results of one subject under a name: kept as data, shown as tables and as a figure, put into pages.
///
/// ```
/// use tangency::output::{Chart, Measured, Report};
/// let chart = Chart { name: "chart-a".into(), panels: vec![Measured::of("New")], ..Chart::default() };
/// assert_eq!(Chart::parse(&chart.to_ron()?)?, chart);
/// let page = chart.put_into("# Page\n\n<!-- chart-a -->\nold\n<!-- end -->\n\nText.\n");
/// assert!(page.starts_with("# Page\n\n<!-- chart-a -->\n\n### New\n") && page.ends_with("<!-- end -->\n\nText.\n"));
/// assert!(!page.contains("old"));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub trait Report: Serialize + DeserializeOwned {
    /// The name: of its files, and of its place in a page.
    fn name(&self) -> &str;

    /// What is drawn, panel by panel.
    fn figures(&self) -> Vec<Figure>;

    /// All results as tables in Markdown.
    fn to_markdown(&self) -> String;

    /// The results that a page shows, in Markdown.
    fn summary(&self) -> String;

    /// A page with the summaries of reports, each between `<!-- NAME -->` and `<!-- end -->`, put in anew.
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

    /// The report in RON.
    ///
    /// # Errors
    /// [`ron::Error`] if it cannot be written.
    fn to_ron(&self) -> Result<String, ron::Error> {
        ron::ser::to_string_pretty(self, ron::ser::PrettyConfig::default())
    }

    /// Reads a report from RON.
    ///
    /// # Errors
    /// [`ron::error::SpannedError`] says where it is none.
    fn parse(text: &str) -> Result<Self, ron::error::SpannedError> {
        ron::from_str(text)
    }

    /// Writes `NAME.ron`, `NAME.md` and `NAME.svg` into a folder.
    ///
    /// # Errors
    /// [`ReportError`] if a file cannot be written, or there is nothing to draw.
    fn save(&self, folder: &Path) -> Result<(), ReportError> {
        let at = |ending: &str| folder.join(format!("{}.{ending}", self.name()));
        write_atomically(at("ron"), self.to_ron()?)?;
        write_atomically(at("md"), self.to_markdown())?;
        Ok(write_atomically(at("svg"), super::draw(&self.figures())?)?)
    }
}

/// Why a report is not saved.
#[derive(Debug, thiserror::Error)]
pub enum ReportError {
    /// It cannot be written in RON.
    #[error(transparent)]
    Format(#[from] ron::Error),
    /// A file.
    #[error(transparent)]
    File(#[from] FileError),
    /// The figure.
    #[error(transparent)]
    Figure(#[from] FigureError),
}

//! Reads and writes documents as RON files.

use super::check;
use super::document::Document;
use super::error::{FileError, FormatError};
use super::files::{SizeLimit, read_text, write_atomically};
use super::tag::FORMAT;
use crate::misread::{Place, part_of, reason, remedy};
use ron::extensions::Extensions;
use ron::ser::PrettyConfig;
use std::path::Path;

impl Document {
    /// Serializes the document as RON, with one line for each point, and every number with all its
    /// digits.
    ///
    /// # Errors
    /// [`FormatError::Invalid`] if the serialized text could not be parsed again, because the
    /// document contains a number that is not finite, a list of the wrong length, or a duplicate
    /// name.
    pub fn to_ron(&self) -> Result<String, FormatError> {
        check::document(self)?;
        let pretty = PrettyConfig::new()
            .depth_limit(4)
            .indentor("  ")
            // The extension is written into the text, so that any RON parser can read it.
            .extensions(Extensions::IMPLICIT_SOME);
        let mut text = ron::ser::to_string_pretty(self, pretty)
            .map_err(|error| FormatError::Unwritable(error.to_string()))?;
        text.push('\n');
        Ok(text)
    }

    /// Parses a document from its RON text.
    ///
    /// # Errors
    /// [`FormatError`] with the line and column of a syntax error, or with the branch, point and
    /// column of an invalid value.
    ///
    /// ```
    /// use tangency::output::Document;
    /// let error = Document::parse("(width: 3.0)").unwrap_err().to_string();
    /// assert!(error.starts_with("not a tangency document (line 1, column "), "{error}");
    /// ```
    pub fn parse(text: &str) -> Result<Self, FormatError> {
        let options = ron::Options::default().with_default_extension(Extensions::IMPLICIT_SOME);
        let document: Document = options.from_str(text).map_err(|error| explain(text, &error))?;
        check::document(&document)?;
        Ok(document)
    }

    /// Saves the document to a file atomically.
    ///
    /// # Errors
    /// [`FileError::Write`] if the file cannot be written, [`FileError::Format`] if the written
    /// document could not be read again.
    pub fn save(&self, path: impl AsRef<Path>) -> Result<(), FileError> {
        let path = path.as_ref();
        write_atomically(path, self.to_ron().map_err(|source| FileError::format(path, source))?)
    }

    /// Loads a document.
    ///
    /// # Errors
    /// [`FileError::Read`] if the file cannot be read, [`FileError::Format`] if the file is not a
    /// document, [`FileError::TooLarge`] if the file is larger than [`SizeLimit::default`].
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
        Document::load_within(SizeLimit::default(), path)
    }

    /// Loads a document from a file of limited size.
    ///
    /// # Errors
    /// As [`load`](Self::load); [`FileError::TooLarge`].
    pub fn load_within(limit: SizeLimit, path: impl AsRef<Path>) -> Result<Self, FileError> {
        let path = path.as_ref();
        let text = read_text(path, limit)?;
        Document::parse(&text).map_err(|source| FileError::format(path, source))
    }
}

/// Determines why a text could not be parsed: it is not a document, has another version of the
/// format, is truncated, or is invalid.
fn explain(text: &str, error: &ron::error::SpannedError) -> FormatError {
    let (line, column) = (error.span.start.line, error.span.start.col);
    let known = remedy(&error.code).map_or(String::new(), |known| format!("; {known}"));
    let reason = reason(&error.code) + &known;
    match tag(text) {
        None => FormatError::Foreign { line, column, reason },
        Some(tag) if tag != FORMAT => FormatError::Version { found: tag.into() },
        Some(_) if reaches_the_end(text, &error.span) => FormatError::Truncated { line, column },
        Some(_) => {
            let place = Place { line: Some(line), ..Place::within(text, part_of(text, error)) };
            FormatError::Syntax { place: Box::new(place), reason }
        }
    }
}

/// Returns the format tag of a text that may contain errors after the tag.
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

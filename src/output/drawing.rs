//! Draws figures as SVG, PDF and PNG pictures.
//!
//! The backends of the plotters library round to whole pixels, so everything is drawn on a [canvas]
//! with finer pixels. The charts of the plotters library do not support sizing a legend or keeping
//! labels off the curves, so only its basic elements are used.

mod backend;
mod canvas;
mod coincident;
mod labels;
mod layout;
mod legend;
mod panel;
mod pdf;
mod pen;
mod smooth;
mod spots;
mod text;
mod ticks;

use super::error::FigureError;
use super::figure::Figure;
use canvas::Canvas;
use layout::Layout;
pub(super) use panel::letter;
pub(crate) use pen::hexadecimal;
pub(super) use pen::shade;

/// The width of a journal's column, in millimetres.
pub const COLUMN: f64 = 84.0;
/// The width of a journal's page, in millimetres.
pub const PAGE: f64 = 170.0;

/// Draws figures as the panels of one picture with a width in millimetres: each row contains as
/// many panels of at least 70 mm width as possible. The first panel is wider if otherwise a row
/// would be incomplete. The text size is 7.5 points for every width of the picture. If the picture
/// has several panels, each has a letter, and the title of the first panel is above all panels if
/// no other panel has a title. The names of up to four curves are written next to the curves; a
/// legend below all panels explains everything else.
///
/// # Errors
/// [`FigureError`] if a coordinate is not finite, the figures contain nothing to draw, or the width
/// is not between 40 and 1000.
///
/// ```
/// use tangency::output::{COLUMN, Figure, Series, Style, draw};
/// let line = Series::new("line", Style::Solid, [[0.0, 0.0], [1.0, 2.0]]);
/// let svg = draw(&[Figure::new("A line", "x (mm)", "λ (1)").with(line)], COLUMN)?;
/// assert!(svg.starts_with("<svg width=\"84mm\" height="));
/// # Ok::<(), tangency::output::FigureError>(())
/// ```
pub fn draw(figures: &[Figure], width: f64) -> Result<String, FigureError> {
    let layout = Layout::new(figures, width)?;
    canvas::svg(layout.size(), width, |canvas: &Canvas| layout.draw(canvas))
}

/// Draws the picture of [`draw`] as a PDF page, with letters as outlines, so that no fonts are
/// needed.
///
/// # Errors
/// As [`draw`].
///
/// ```
/// use tangency::output::{COLUMN, Figure, Series, Style, pdf};
/// let line = Series::new("line", Style::Solid, [[0.0, 0.0], [1.0, 2.0]]);
/// let picture = pdf(&[Figure::new("A line", "x (mm)", "λ (1)").with(line)], COLUMN)?;
/// assert!(picture.starts_with(b"%PDF-1.7"));
/// # Ok::<(), tangency::output::FigureError>(())
/// ```
pub fn pdf(figures: &[Figure], width: f64) -> Result<Vec<u8>, FigureError> {
    let layout = Layout::new(figures, width)?;
    canvas::pdf(layout.size(), width, |canvas: &Canvas| layout.draw(canvas))
}

/// Draws the picture of [`draw`] as a PNG file, with 300 pixels per inch. The PNG is drawn without
/// system fonts.
///
/// # Errors
/// The errors of [`draw`], and [`FigureError::Drawing`] if a side of the picture would have more
/// than 16 384 pixels.
///
/// ```
/// use tangency::output::{COLUMN, Figure, Series, Style, png};
/// let line = Series::new("line", Style::Solid, [[0.0, 0.0], [1.0, 2.0]]);
/// let picture = png(&[Figure::new("A line", "x (mm)", "λ (1)").with(line)], COLUMN)?;
/// assert!(picture.starts_with(b"\x89PNG"));
/// # Ok::<(), tangency::output::FigureError>(())
/// ```
pub fn png(figures: &[Figure], width: f64) -> Result<Vec<u8>, FigureError> {
    let layout = Layout::new(figures, width)?;
    canvas::png(layout.size(), width, |canvas: &Canvas| layout.draw(canvas))
}

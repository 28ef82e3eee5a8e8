//! Figures as SVG, PDF and PNG pictures.
//!
//! The backends of plotters round to whole pixels, so everything is drawn on a [canvas] of finer
//! ones. Its charts do not support sizing a legend or keeping labels off the curves, so only its
//! elements are used.

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

/// Draws figures as the panels of one picture, of a width in millimetres: as many side by side as
/// are at least 70 mm wide. The first panel is wider if the rows would not be full. Text has 7.5
/// points for every width. Several panels have letters, and the title of the first one, if no other
/// has any, is above all. The names of up to four curves are next to the curves; a legend below all
/// panels explains everything else.
///
/// # Errors
/// [`FigureError`] if a coordinate is not finite, there is nothing to draw, or the width is not
/// between 40 and 1000.
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

/// Draws the picture of [`draw`] as PNG, with 300 pixels per inch. No system fonts are needed.
///
/// # Errors
/// As [`draw`]; [`FigureError::Drawing`] if a side would have more than 16 384 pixels.
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

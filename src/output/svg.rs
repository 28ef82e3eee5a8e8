//! Figures as SVG.
//!
//! The backend of plotters rounds to whole pixels, so everything is drawn on a canvas
//! [ten times larger](canvas) that is shown at its normal size. Its charts know neither the room a
//! legend needs nor labels that keep off the curves, so that only its elements are used.

mod canvas;
mod labels;
mod legend;
mod panel;
mod pen;
mod ticks;

use super::error::FigureError;
use super::figure::Figure;
use canvas::Canvas;
use panel::{Panel, WIDTH};

/// Draws figures side by side: one in a row, up to four in two columns, more in three. Every panel
/// is 720 pixels wide and as high as its legend needs.
///
/// # Errors
/// [`FigureError`] if a coordinate is not finite or there is nothing to draw.
///
/// ```
/// use tangency::output::{Figure, Series, Style, draw};
/// let line = Series::new("line", Style::Solid, [[0.0, 0.0], [1.0, 2.0]]);
/// let svg = draw(&[Figure::new("A line", "x (mm)", "λ (1)").with(line)])?;
/// assert!(svg.starts_with("<svg width=\"720\" height=\"480\" viewBox=\"0 0 7200 4800\""));
/// # Ok::<(), tangency::output::FigureError>(())
/// ```
pub fn draw(figures: &[Figure]) -> Result<String, FigureError> {
    let panels = figures.iter().map(Panel::new).collect::<Result<Vec<_>, _>>()?;
    let columns = match panels.len() {
        0 => return Err(FigureError::Empty { title: String::new() }),
        1 => 1,
        2..=4 => 2,
        _ => 3,
    };
    let rows: Vec<&[Panel]> = panels.chunks(columns).collect();
    let height = |row: &[Panel]| row.iter().map(Panel::height).fold(0.0, f64::max);
    let total: f64 = rows.iter().map(|row| height(row)).sum();
    canvas::render(WIDTH * columns as f64, total, |canvas: &Canvas| {
        let mut top = 0.0;
        for row in &rows {
            for (index, panel) in row.iter().enumerate() {
                panel.draw(canvas, [WIDTH * index as f64, top])?;
            }
            top += height(row);
        }
        Ok(())
    })
}

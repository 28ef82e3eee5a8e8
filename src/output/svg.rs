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
mod smooth;
mod ticks;

use super::error::FigureError;
use super::figure::Figure;
use canvas::Canvas;
use panel::{Panel, WIDTH, heading};

/// Draws figures side by side: one in a row, up to four in two columns, more in three. Every panel
/// is 720 pixels wide and as high as its legend needs; the first one is wider where the rows would
/// not be full. Several panels have letters, and the title of the first one, if no other has any,
/// stands above all.
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
    let count = figures.len();
    let columns = match count {
        0 => return Err(FigureError::Empty { title: String::new() }),
        1 => 1,
        2..=4 => 2,
        _ => 3,
    };
    let first = 1 + count.next_multiple_of(columns) - count;
    let across = count > 1 && figures[1..].iter().all(|figure| figure.title.is_empty());
    let panel = |(index, figure)| {
        let width = WIDTH * if index == 0 { first as f64 } else { 1.0 };
        let letter = (count > 1).then(|| letter(index));
        Panel::new(figure, width, letter, !across)
    };
    let panels = figures.iter().enumerate().map(panel).collect::<Result<Vec<_>, _>>()?;
    let (top_row, others) = panels.split_at(columns + 1 - first);
    let rows: Vec<&[Panel]> = [top_row].into_iter().chain(others.chunks(columns)).collect();
    let height = |row: &[Panel]| row.iter().map(Panel::height).fold(0.0, f64::max);
    let total: f64 = rows.iter().map(|row| height(row)).sum();
    let width = WIDTH * columns as f64;
    canvas::render(width, total, |canvas: &Canvas| {
        let mut top = 0.0;
        for row in &rows {
            let mut left = 0.0;
            for panel in *row {
                panel.draw(canvas, [left, top])?;
                left += panel.width();
            }
            top += height(row);
        }
        if across { heading(canvas, &figures[0].title, [0.0, 0.0], width) } else { Ok(()) }
    })
}

/// The letter of a panel: a, b, … z, aa, ab, …
fn letter(index: usize) -> String {
    let last = char::from(b'a' + (index % 26) as u8);
    match index / 26 {
        0 => last.to_string(),
        more => letter(more - 1) + &last.to_string(),
    }
}

//! A canvas in pixels with fractions, on plotters' SVG backend.

use crate::output::error::FigureError;
use plotters::coord::Shift;
use plotters::prelude::*;
use plotters::style::text_anchor::{HPos, Pos, VPos};
use std::collections::BTreeSet;

/// How many pixels of the backend make one of the canvas.
const FINENESS: f64 = 10.0;

/// The side of a speck, in pixels.
const SPECK: f64 = 1.3;

/// Text and axes.
pub(super) const INK: RGBColor = RGBColor(38, 38, 38);
/// Lines of the grid.
pub(super) const FAINT: RGBColor = RGBColor(228, 228, 228);

/// The result of drawing.
pub(super) type Painted = Result<(), FigureError>;

/// A drawing area in pixels with fractions, `y` downwards.
pub(super) struct Canvas<'a> {
    area: DrawingArea<SVGBackend<'a>, Shift>,
}

/// Where a text stands: its point of reference, and its turning.
#[derive(Clone, Copy)]
pub(super) enum Anchor {
    /// The point is in the middle of its left side.
    Left,
    /// The point is in its middle.
    Middle,
    /// The point is in the middle of its right side.
    Right,
    /// The point is in its middle; it reads upwards.
    Upwards,
}

/// Draws on a canvas of a size in pixels and returns the SVG.
pub(super) fn render(
    width: f64,
    height: f64,
    draw: impl FnOnce(&Canvas) -> Painted,
) -> Result<String, FigureError> {
    let fine = |length: f64| (length * FINENESS).round() as u32;
    let mut svg = String::new();
    {
        let backend = SVGBackend::with_string(&mut svg, (fine(width), fine(height)));
        let canvas = Canvas { area: backend.into_drawing_area() };
        canvas.area.fill(&WHITE).map_err(failed)?;
        draw(&canvas)?;
        canvas.area.present().map_err(failed)?;
    }
    let size = |w: String, h: String| format!("width=\"{w}\" height=\"{h}\"");
    let drawn = size(fine(width).to_string(), fine(height).to_string());
    let shown = size(width.round().to_string(), height.round().to_string());
    Ok(svg.replacen(&drawn, &shown, 1))
}

fn failed<E: std::error::Error + Send + Sync>(error: DrawingAreaErrorKind<E>) -> FigureError {
    FigureError::Drawing(error.to_string())
}

fn fine(at: [f64; 2]) -> (i32, i32) {
    ((at[0] * FINENESS).round() as i32, (at[1] * FINENESS).round() as i32)
}

fn stroke(colour: RGBColor, width: f64) -> ShapeStyle {
    colour.stroke_width((width * FINENESS).round() as u32)
}

impl Canvas<'_> {
    /// A line through points.
    pub fn line(&self, points: &[[f64; 2]], colour: RGBColor, width: f64) -> Painted {
        // Points nearer than the backend can tell apart only make the file longer.
        let mut path: Vec<(i32, i32)> = points.iter().map(|at| fine(*at)).collect();
        path.dedup();
        self.area.draw(&PathElement::new(path, stroke(colour, width))).map_err(failed)
    }

    /// A dashed line through points.
    pub fn dashed(&self, points: &[[f64; 2]], colour: RGBColor, width: f64) -> Painted {
        dashes(points).iter().try_for_each(|dash| self.line(dash, colour, width))
    }

    /// A filled polygon with an outline.
    pub fn polygon(&self, corners: &[[f64; 2]], fill: RGBColor, outline: RGBColor) -> Painted {
        let mut path: Vec<(i32, i32)> = corners.iter().map(|at| fine(*at)).collect();
        self.area.draw(&Polygon::new(path.clone(), fill.filled())).map_err(failed)?;
        path.extend_from_within(..path.len().min(2));
        self.area.draw(&PathElement::new(path, stroke(outline, 1.0))).map_err(failed)
    }

    /// A rectangle between two opposite corners.
    pub fn rectangle(&self, corners: [[f64; 2]; 2], fill: RGBColor) -> Painted {
        self.area.draw(&Rectangle::new(corners.map(fine), fill.filled())).map_err(failed)
    }

    /// A filled disc with an outline.
    pub fn disc(
        &self,
        centre: [f64; 2],
        radius: f64,
        fill: RGBColor,
        outline: RGBColor,
    ) -> Painted {
        let radius = (radius * FINENESS).round() as i32;
        self.area.draw(&Circle::new(fine(centre), radius, fill.filled())).map_err(failed)?;
        self.area.draw(&Circle::new(fine(centre), radius, stroke(outline, 1.0))).map_err(failed)
    }

    /// The smallest spot that can be seen at every point. Of spots in one place one is drawn, and
    /// those on top of each other are one line: the file does not grow with the points.
    pub fn specks(&self, points: &[[f64; 2]], colour: RGBColor) -> Painted {
        let cell = |at: &[f64; 2]| at.map(|x| (x / SPECK).floor() as i32);
        let cells: BTreeSet<[i32; 2]> = points.iter().map(cell).collect();
        let corner = |column: i32, row: i32| {
            fine([(f64::from(column) + 0.5) * SPECK, f64::from(row) * SPECK])
        };
        let line = |[column, top, bottom]: [i32; 3]| {
            let path = vec![corner(column, top), corner(column, bottom + 1)];
            self.area.draw(&PathElement::new(path, stroke(colour, SPECK))).map_err(failed)
        };
        let mut open: Option<[i32; 3]> = None;
        for [column, row] in cells {
            match &mut open {
                Some([same, _, bottom]) if *same == column && *bottom + 1 == row => *bottom = row,
                _ => {
                    open.take().map_or(Ok(()), line)?;
                    open = Some([column, row, row]);
                }
            }
        }
        open.map_or(Ok(()), line)
    }

    /// A veil over a rectangle about a centre, on which a text can be read.
    pub fn veil(&self, centre: [f64; 2], [w, h]: [f64; 2]) -> Painted {
        let corners = [-0.5, 0.5].map(|side| fine([centre[0] + side * w, centre[1] + side * h]));
        self.area.draw(&Rectangle::new(corners, WHITE.mix(0.75).filled())).map_err(failed)
    }

    /// A text of a size in pixels.
    pub fn text(&self, text: &str, at: [f64; 2], size: f64, anchor: Anchor) -> Painted {
        // The backend divides the size by 1.24.
        let mut font = ("sans-serif", size * FINENESS * 1.24).into_font().color(&INK);
        if let Anchor::Upwards = anchor {
            font = font.transform(FontTransform::Rotate270);
        }
        let side = match anchor {
            Anchor::Left => HPos::Left,
            Anchor::Middle | Anchor::Upwards => HPos::Center,
            Anchor::Right => HPos::Right,
        };
        // The backend puts the foot of the letters 0.76 of the size below a point at their top;
        // half the height of a digit is 0.36 of the size.
        let shift = size * (0.76 - 0.36);
        let at = match anchor {
            Anchor::Upwards => [at[0] - shift, at[1]],
            _ => [at[0], at[1] - shift],
        };
        let style = font.pos(Pos::new(side, VPos::Top));
        self.area.draw(&Text::new(well_formed(text), fine(at), style)).map_err(failed)
    }
}

/// A text without the letters that XML does not have.
fn well_formed(text: &str) -> String {
    let foreign = |letter: char| letter.is_control() || ('\u{fffe}'..='\u{ffff}').contains(&letter);
    text.replace(foreign, "\u{fffd}")
}

/// The width of a text in pixels: an estimate, since the font is the reader's.
pub(super) fn text_width(text: &str, size: f64) -> f64 {
    let narrow = |letter: char| "fijlrt.,:;|'()[] ".contains(letter);
    let wide = |letter: char| letter.is_uppercase() || "mw–".contains(letter);
    let widths = text.chars().map(|letter| match letter {
        letter if narrow(letter) => 0.36,
        letter if wide(letter) => 0.74,
        _ => 0.6,
    });
    widths.sum::<f64>() * size
}

/// Cuts a line into dashes. The corners of the line stay corners of the dashes.
fn dashes(points: &[[f64; 2]]) -> Vec<Vec<[f64; 2]>> {
    const LENGTHS: [f64; 2] = [7.0, 4.5];
    let mut dashes = Vec::new();
    let mut dash: Vec<[f64; 2]> = points.first().copied().into_iter().collect();
    let mut gap = false;
    let mut left = LENGTHS[0];
    for pair in points.windows(2) {
        let [from, to] = [pair[0], pair[1]];
        let length = (to[0] - from[0]).hypot(to[1] - from[1]);
        let mut done = 0.0;
        while length - done > left {
            done += left;
            let t = done / length;
            let at = [from[0] + t * (to[0] - from[0]), from[1] + t * (to[1] - from[1])];
            if gap {
                dash = vec![at];
            } else {
                dash.push(at);
                dashes.push(std::mem::take(&mut dash));
            }
            gap = !gap;
            left = LENGTHS[usize::from(gap)];
        }
        left -= length - done;
        if !gap {
            dash.push(to);
        }
    }
    if dash.len() > 1 {
        dashes.push(dash);
    }
    dashes
}

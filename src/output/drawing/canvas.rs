//! A canvas with fractional coordinates, on backends of the plotters library.

use super::backend::Backend;
use super::pdf::Page;
use super::spots::{joined, stacks};
use super::text::{FOOT, SIZES, lacking};
use crate::output::error::FigureError;
use crate::output::number::significant;
use plotters::coord::Shift;
use plotters::prelude::*;
use plotters::style::text_anchor::{HPos, Pos, VPos};

/// The number of backend pixels per unit of length in an SVG.
const FINENESS: f64 = 10.0;

/// The number of pixels of a PNG per millimetre, for 300 dots per inch.
const DENSITY: f64 = 300.0 / 25.4;
/// The number of backend pixels along each side of a pixel of the PNG; averaging the backend pixels
/// smooths edges.
const SMOOTHING: u32 = 3;
/// The largest allowed side length of a PNG, in pixels.
const LONGEST: f64 = 16_384.0;

/// The size of normal text, in units of the canvas.
pub(super) const TEXT: f64 = 12.0;

/// The colour of text and axes.
pub(super) const INK: RGBColor = RGBColor(38, 38, 38);
/// The colour of secondary text, which is less important than the curves.
pub(super) const LIGHT: RGBColor = RGBColor(110, 110, 110);
/// The colour of grid lines.
pub(super) const FAINT: RGBColor = RGBColor(228, 228, 228);

/// The result of a drawing operation.
pub(super) type Painted = Result<(), FigureError>;

/// A drawing area with fractional coordinates, where `y` increases downwards.
pub(super) struct Canvas<'a> {
    area: DrawingArea<Backend<'a>, Shift>,
    /// The number of backend pixels per unit of the canvas.
    fineness: f64,
    /// Whether text is drawn with the built-in font.
    own_font: bool,
}

/// The alignment of a text at its reference point, and its direction.
#[derive(Clone, Copy)]
pub(super) enum Anchor {
    /// The reference point is the middle of the left side of the text's rectangle.
    Left,
    /// The reference point is the centre of the text's rectangle.
    Middle,
    /// The reference point is the middle of the right side of the text's rectangle.
    Right,
    /// The reference point is the centre of the text's rectangle, and the text reads upwards.
    Upwards,
}

/// Draws on a canvas with a given size in units and a given printed width in millimetres, and
/// returns the picture as SVG.
pub(super) fn svg(
    size: [f64; 2],
    millimetres: f64,
    draw: impl FnOnce(&Canvas) -> Painted,
) -> Result<String, FigureError> {
    let (width, height) = pixels(size, FINENESS);
    let mut svg = String::new();
    let backend = SVGBackend::with_string(&mut svg, (width, height));
    Canvas::paint(Backend::Lines(backend), FINENESS, draw)?;
    let sides = |w: String, h: String| format!("width=\"{w}\" height=\"{h}\"");
    let drawn = sides(width.to_string(), height.to_string());
    let shown = [millimetres, size[1] / size[0] * millimetres];
    let [w, h] = shown.map(|side| format!("{}mm", significant(side, 5)));
    Ok(joined(&svg).replacen(&drawn, &sides(w, h), 1))
}

/// Draws on a canvas with a given size in units and a given printed width in millimetres, and
/// returns the picture as PDF.
pub(super) fn pdf(
    size: [f64; 2],
    millimetres: f64,
    draw: impl FnOnce(&Canvas) -> Painted,
) -> Result<Vec<u8>, FigureError> {
    let points = millimetres / 25.4 * 72.0;
    let mut page = Page::new(pixels(size, FINENESS), points);
    Canvas::paint(Backend::Page(&mut page), FINENESS, draw)?;
    page.finish([points, size[1] / size[0] * points])
        .map_err(|error| FigureError::Drawing(error.to_string()))
}

/// Draws on a canvas with a given size in units and a given printed width in millimetres, and
/// returns the picture as PNG.
pub(super) fn png(
    size: [f64; 2],
    millimetres: f64,
    draw: impl FnOnce(&Canvas) -> Painted,
) -> Result<Vec<u8>, FigureError> {
    let fineness = DENSITY * millimetres / size[0];
    if size.iter().any(|side| side * fineness > LONGEST) {
        let [wide, high] = size.map(|side| (side * fineness).round());
        return Err(FigureError::Drawing(format!(
            "the picture would have {wide} × {high} pixels, but each side may have at most \
             {LONGEST} pixels: make the picture narrower, or draw an SVG"
        )));
    }
    let (width, height) = pixels(size, fineness);
    let (wide, high) = (width * SMOOTHING, height * SMOOTHING);
    let mut fine = vec![0; 3 * wide as usize * high as usize];
    let backend = BitMapBackend::with_buffer(&mut fine, (wide, high));
    Canvas::paint(Backend::Pixels(backend), fineness * f64::from(SMOOTHING), draw)?;
    let coarse = smoothed(&fine, width as usize, height as usize);
    encoded(&coarse, width, height).map_err(|error| FigureError::Drawing(error.to_string()))
}

fn pixels(size: [f64; 2], fineness: f64) -> (u32, u32) {
    let [width, height] = size.map(|side| (side * fineness).round() as u32);
    (width, height)
}

/// Reduces an image: each pixel of the result is the mean of a square of pixels.
fn smoothed(fine: &[u8], width: usize, height: usize) -> Vec<u8> {
    let side = SMOOTHING as usize;
    let mut coarse = Vec::with_capacity(3 * width * height);
    for row in 0..height {
        for column in 0..width {
            for colour in 0..3 {
                let at = |k: usize| {
                    let (dy, dx) = (k / side, k % side);
                    fine[3 * ((row * side + dy) * width * side + column * side + dx) + colour]
                };
                let sum: u32 = (0..side * side).map(|k| u32::from(at(k))).sum();
                coarse.push((sum / (side * side) as u32) as u8);
            }
        }
    }
    coarse
}

/// Encodes pixels as a PNG file with their physical size.
fn encoded(pixels: &[u8], width: u32, height: u32) -> Result<Vec<u8>, png::EncodingError> {
    let mut file = Vec::new();
    let mut encoder = png::Encoder::new(&mut file, width, height);
    encoder.set_color(png::ColorType::Rgb);
    let metre = (DENSITY * 1000.0).round() as u32;
    let dimensions = png::PixelDimensions { xppu: metre, yppu: metre, unit: png::Unit::Meter };
    encoder.set_pixel_dims(Some(dimensions));
    let mut writer = encoder.write_header()?;
    writer.write_image_data(pixels)?;
    writer.finish()?;
    Ok(file)
}

fn failed<E: std::error::Error + Send + Sync>(error: DrawingAreaErrorKind<E>) -> FigureError {
    FigureError::Drawing(error.to_string())
}

/// The cosine of the sharpest angle by which a single path may turn: at sharper turns, such as
/// cusps, backends would draw a spike.
const SHARP: f64 = -0.5;

/// Splits a path at turns that are too sharp for a single path.
fn between_spikes(path: &[(i32, i32)]) -> Vec<&[(i32, i32)]> {
    let side = |a: (i32, i32), b: (i32, i32)| [f64::from(b.0 - a.0), f64::from(b.1 - a.1)];
    let is_sharp = |at: &[(i32, i32)]| {
        let ([a, b], [c, d]) = (side(at[0], at[1]), side(at[1], at[2]));
        a * c + b * d < SHARP * a.hypot(b) * c.hypot(d)
    };
    let turns = path.windows(3).enumerate().filter(|(_, at)| is_sharp(at)).map(|(k, _)| k + 1);
    let mut begin = 0;
    let mut pieces: Vec<&[(i32, i32)]> = Vec::new();
    for turn in turns {
        pieces.push(&path[begin..=turn]);
        begin = turn;
    }
    pieces.push(&path[begin..]);
    pieces
}

impl<'a> Canvas<'a> {
    fn paint(
        backend: Backend<'a>,
        fineness: f64,
        draw: impl FnOnce(&Canvas) -> Painted,
    ) -> Painted {
        let own_font = !matches!(backend, Backend::Lines(_));
        let canvas = Canvas { area: backend.into_drawing_area(), fineness, own_font };
        canvas.area.fill(&WHITE).map_err(failed)?;
        draw(&canvas)?;
        canvas.area.present().map_err(failed)
    }

    fn fine(&self, at: [f64; 2]) -> (i32, i32) {
        let [x, y] = at.map(|side| (side * self.fineness).round() as i32);
        (x, y)
    }

    fn stroke(&self, colour: RGBColor, width: f64) -> ShapeStyle {
        colour.stroke_width((width * self.fineness).round() as u32)
    }

    /// Draws a line through points.
    pub fn line(&self, points: &[[f64; 2]], colour: RGBColor, width: f64) -> Painted {
        // Points closer than the backend's resolution only enlarge the file.
        let mut path: Vec<(i32, i32)> = points.iter().map(|at| self.fine(*at)).collect();
        path.dedup();
        for piece in between_spikes(&path) {
            let piece = PathElement::new(piece, self.stroke(colour, width));
            self.area.draw(&piece).map_err(failed)?;
        }
        Ok(())
    }

    /// Draws a dashed line through points, with given lengths of dashes and gaps, colour and width.
    pub fn dashed(
        &self,
        points: &[[f64; 2]],
        lengths: [f64; 2],
        (colour, width): (RGBColor, f64),
    ) -> Painted {
        dashes(points, lengths).iter().try_for_each(|dash| self.line(dash, colour, width))
    }

    /// Draws a filled polygon with an outline.
    pub fn polygon(&self, corners: &[[f64; 2]], fill: RGBColor, outline: RGBColor) -> Painted {
        let mut path: Vec<(i32, i32)> = corners.iter().map(|at| self.fine(*at)).collect();
        self.area.draw(&Polygon::new(path.clone(), fill.filled())).map_err(failed)?;
        path.extend_from_within(..path.len().min(2));
        self.area.draw(&PathElement::new(path, self.stroke(outline, 1.0))).map_err(failed)
    }

    /// Draws a rectangle between two opposite corners.
    pub fn rectangle(&self, corners: [[f64; 2]; 2], fill: RGBColor) -> Painted {
        self.area
            .draw(&Rectangle::new(corners.map(|at| self.fine(at)), fill.filled()))
            .map_err(failed)
    }

    /// Draws a filled disc with an outline.
    pub fn disc(
        &self,
        centre: [f64; 2],
        radius: f64,
        fill: RGBColor,
        outline: RGBColor,
    ) -> Painted {
        let radius = (radius * self.fineness).round() as i32;
        self.area.draw(&Circle::new(self.fine(centre), radius, fill.filled())).map_err(failed)?;
        self.area
            .draw(&Circle::new(self.fine(centre), radius, self.stroke(outline, 1.0)))
            .map_err(failed)
    }

    /// Draws a square spot of a given size exactly at every point. Spots that touch each other in one
    /// column are drawn as one line.
    pub fn spots(&self, points: &[[f64; 2]], colour: RGBColor, size: f64) -> Painted {
        let side = (size * self.fineness).round() as i32;
        let centres = points.iter().map(|at| self.fine(*at));
        stacks(centres, side).into_iter().try_for_each(|[column, top, bottom]| {
            let path = vec![(column, top), (column, bottom)];
            self.area.draw(&PathElement::new(path, self.stroke(colour, size))).map_err(failed)
        })
    }

    /// Draws a translucent rectangle around a centre, as a background that keeps text readable.
    pub fn veil(&self, centre: [f64; 2], [w, h]: [f64; 2]) -> Painted {
        let corners =
            [-0.5, 0.5].map(|side| self.fine([centre[0] + side * w, centre[1] + side * h]));
        self.area.draw(&Rectangle::new(corners, WHITE.mix(0.75).filled())).map_err(failed)
    }

    /// Draws a text with the given letter size in units.
    pub fn text(&self, text: &str, at: [f64; 2], size: f64, anchor: Anchor) -> Painted {
        self.coloured(text, at, (size, INK), anchor)
    }

    /// Draws a text with the given letter size in units, in a given colour.
    pub fn coloured(
        &self,
        text: &str,
        at: [f64; 2],
        (size, colour): (f64, RGBColor),
        anchor: Anchor,
    ) -> Painted {
        if let Some(letter) = lacking(text).filter(|_| self.own_font) {
            return Err(FigureError::Letter { letter, text: text.into() });
        }
        // The backend divides the size by 1.24.
        let mut font = ("sans-serif", size * self.fineness * SIZES).into_font().color(&colour);
        if let Anchor::Upwards = anchor {
            font = font.transform(FontTransform::Rotate270);
        }
        let side = match anchor {
            Anchor::Left => HPos::Left,
            Anchor::Middle | Anchor::Upwards => HPos::Center,
            Anchor::Right => HPos::Right,
        };
        // The backend puts the baseline 0.76 of the size below a point at the top; half the height
        // of a digit is 0.36 of the size.
        let shift = size * (FOOT - 0.36);
        let at = match anchor {
            Anchor::Upwards => [at[0] - shift, at[1]],
            _ => [at[0], at[1] - shift],
        };
        let style = font.pos(Pos::new(side, VPos::Top));
        self.area.draw(&Text::new(well_formed(text), self.fine(at), style)).map_err(failed)
    }
}

/// Removes characters that are invalid in XML.
fn well_formed(text: &str) -> String {
    let foreign = |letter: char| letter.is_control() || ('\u{fffe}'..='\u{ffff}').contains(&letter);
    text.replace(foreign, "\u{fffd}")
}

/// Estimates the width of a text in units; the width is not known exactly because the viewer of an
/// SVG chooses the font.
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

/// Divides a line into dashes. Dashes follow the corners of the line.
fn dashes(points: &[[f64; 2]], lengths: [f64; 2]) -> Vec<Vec<[f64; 2]>> {
    let mut dashes = Vec::new();
    let mut dash: Vec<[f64; 2]> = points.first().copied().into_iter().collect();
    let mut gap = false;
    let mut left = lengths[0];
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
            left = lengths[usize::from(gap)];
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

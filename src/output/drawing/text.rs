//! Text as pixels or outlines, in a built-in font, so that pictures look the same on every system.

use ab_glyph::{Font, FontRef, Glyph, OutlineCurve, Point, PxScale, PxScaleFont, ScaleFont, point};
use plotters_backend::{
    BackendColor, BackendCoord, BackendTextStyle, FontTransform, text_anchor::HPos,
};
use std::sync::LazyLock;

/// The font file, which contains the letters, digits and signs of DejaVu Sans; the licence of the
/// font is in the same folder.
static FONT: LazyLock<Option<FontRef<'static>>> = LazyLock::new(|| {
    FontRef::try_from_slice(include_bytes!("../../../assets/DejaVuSans-subset.ttf")).ok()
});

/// The ratio of the size of the font to the letter size in plotters; and the distance of the
/// baseline from the top of the text, relative to the size of the font, as in the SVG backend of
/// plotters.
pub(super) const SIZES: f64 = 1.24;
pub(super) const FOOT: f64 = 0.76;

/// Returns the first character of a text that is missing in the font.
pub(super) fn lacking(text: &str) -> Option<char> {
    let lacks = |letter: &char| match &*FONT {
        Some(font) => font.glyph_id(*letter).0 == 0,
        None => true,
    };
    text.chars().find(lacks)
}

/// Returns the letters of a text with their positions relative to the left end of the text, and the
/// length of the text.
fn glyphs(text: &str, font: &PxScaleFont<&FontRef<'static>>, size: f64) -> (Vec<Glyph>, f32) {
    let (mut pen, mut last) = (0.0, None);
    let mut glyphs = Vec::new();
    for letter in text.chars() {
        let id = font.glyph_id(letter);
        pen += last.map_or(0.0, |last| font.kern(last, id));
        let foot = point(pen, (FOOT * size) as f32);
        glyphs.push(id.with_scale_and_position(font.scale(), foot));
        pen += font.h_advance(id);
        last = Some(id);
    }
    (glyphs, pen)
}

/// Returns the horizontal offset from the reference point of a text to the left end of the text,
/// given the length of the text.
fn left<S: BackendTextStyle>(style: &S, length: f32) -> f32 {
    match style.anchor().h_pos {
        HPos::Left => 0.0,
        HPos::Center => -0.5 * length,
        HPos::Right => -length,
    }
}

/// Returns the font of a text style, and its letter size in pixels.
fn scaled<S: BackendTextStyle>(
    font: &'static FontRef<'static>,
    style: &S,
) -> (PxScaleFont<&'static FontRef<'static>>, f64) {
    let size = style.size() / SIZES;
    let em = font.units_per_em().unwrap_or(1.0);
    (font.as_scaled(PxScale::from(size as f32 * font.height_unscaled() / em)), size)
}

/// A segment of the outline of letters.
pub(super) enum Stroke {
    /// The start of a new closed outline, at the given point.
    To([f32; 2]),
    /// A straight line.
    Line([f32; 2]),
    /// A cubic curve, given by its two control points and its end point.
    Curve([f32; 2], [f32; 2], [f32; 2]),
}

/// Returns the outlines of the letters of a text at a point, with the same alignment as [`write`].
pub(super) fn outlines<S: BackendTextStyle>(
    text: &str,
    style: &S,
    (x, y): BackendCoord,
) -> Vec<Stroke> {
    let Some(font) = &*FONT else { return Vec::new() };
    let (font, size) = scaled(font, style);
    let (glyphs, length) = glyphs(text, &font, size);
    let left = left(style, length);
    let upwards = matches!(style.transform(), FontTransform::Rotate270);
    let mut strokes = Vec::new();
    for glyph in glyphs {
        let Some(outline) = font.font.outline(glyph.id) else { continue };
        let [across, down] = [font.h_scale_factor(), -font.v_scale_factor()];
        let place = |at: Point| {
            let [dx, dy] =
                [left + glyph.position.x + across * at.x, glyph.position.y + down * at.y];
            if upwards { [x as f32 + dy, y as f32 - dx] } else { [x as f32 + dx, y as f32 + dy] }
        };
        let mut last = None;
        for curve in outline.curves {
            let (from, to) = match &curve {
                OutlineCurve::Line(from, to)
                | OutlineCurve::Quad(from, _, to)
                | OutlineCurve::Cubic(from, _, _, to) => (*from, *to),
            };
            if last != Some(from) {
                strokes.push(Stroke::To(place(from)));
            }
            last = Some(to);
            // A quadratic curve equals the cubic one whose control points are 2/3 of the way to its
            // control point.
            let towards = |end: Point, control: Point| {
                point(
                    end.x + 2.0 / 3.0 * (control.x - end.x),
                    end.y + 2.0 / 3.0 * (control.y - end.y),
                )
            };
            strokes.push(match curve {
                OutlineCurve::Line(_, to) => Stroke::Line(place(to)),
                OutlineCurve::Quad(from, by, to) => {
                    Stroke::Curve(place(towards(from, by)), place(towards(to, by)), place(to))
                }
                OutlineCurve::Cubic(_, a, b, to) => Stroke::Curve(place(a), place(b), place(to)),
            });
        }
    }
    strokes
}

/// Writes an antialiased text, whose reference point is the middle of its left side, of its right
/// side, or of the whole text.
pub(super) fn write<E, S: BackendTextStyle>(
    text: &str,
    style: &S,
    (x, y): BackendCoord,
    mut draw: impl FnMut(BackendCoord, BackendColor) -> Result<(), E>,
) -> Result<(), E> {
    let Some(font) = &*FONT else { return Ok(()) };
    let (font, size) = scaled(font, style);
    let (glyphs, length) = glyphs(text, &font, size);
    let left = left(style, length);
    let upwards = matches!(style.transform(), FontTransform::Rotate270);
    for mut glyph in glyphs {
        glyph.position.x += left;
        let Some(outline) = font.outline_glyph(glyph) else { continue };
        let corner = outline.px_bounds().min;
        let mut result = Ok(());
        outline.draw(|dx, dy, covered| {
            let [dx, dy] = [corner.x as i32 + dx as i32, corner.y as i32 + dy as i32];
            let at = if upwards { (x + dy, y - dx) } else { (x + dx, y + dy) };
            let colour = style.color();
            let colour =
                BackendColor { alpha: colour.alpha * f64::from(covered.min(1.0)), ..colour };
            if result.is_ok() && at.0 >= 0 && at.1 >= 0 {
                result = draw(at, colour);
            }
        });
        result?;
    }
    Ok(())
}

//! Text in pixels, in a font that the program brings: pictures look the same on every system.

use ab_glyph::{Font, FontRef, PxScale, ScaleFont, point};
use plotters_backend::{
    BackendColor, BackendCoord, BackendTextStyle, FontTransform, text_anchor::HPos,
};
use std::sync::LazyLock;

/// Letters, digits and signs of DejaVu Sans; its licence is beside the file.
static FONT: LazyLock<Option<FontRef<'static>>> = LazyLock::new(|| {
    FontRef::try_from_slice(include_bytes!("../../../assets/DejaVuSans-subset.ttf")).ok()
});

/// plotters' sizes as multiples of the sizes of letters, and how far the foot of the letters is below
/// the top, as a part of their size (as its SVG backend has them).
pub(super) const SIZES: f64 = 1.24;
pub(super) const FOOT: f64 = 0.76;

/// The first letter of a text that the font lacks.
pub(super) fn lacking(text: &str) -> Option<char> {
    let lacks = |letter: &char| match &*FONT {
        Some(font) => font.glyph_id(*letter).0 == 0,
        None => true,
    };
    text.chars().find(lacks)
}

/// Writes a text with the middle of the left side, the right side or the text itself at a point, by
/// pixels that are partly covered.
pub(super) fn write<E, S: BackendTextStyle>(
    text: &str,
    style: &S,
    (x, y): BackendCoord,
    mut draw: impl FnMut(BackendCoord, BackendColor) -> Result<(), E>,
) -> Result<(), E> {
    let Some(font) = &*FONT else { return Ok(()) };
    let size = style.size() / SIZES;
    let em = font.units_per_em().unwrap_or(1.0);
    let font = font.as_scaled(PxScale::from(size as f32 * font.height_unscaled() / em));
    let mut pen = 0.0;
    let mut glyphs = Vec::new();
    let mut last = None;
    for letter in text.chars() {
        let id = font.glyph_id(letter);
        pen += last.map_or(0.0, |last| font.kern(last, id));
        let foot = point(pen, (FOOT * size) as f32);
        glyphs.push(id.with_scale_and_position(font.scale(), foot));
        pen += font.h_advance(id);
        last = Some(id);
    }
    let left = match style.anchor().h_pos {
        HPos::Left => 0.0,
        HPos::Center => -0.5 * pen,
        HPos::Right => -pen,
    };
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

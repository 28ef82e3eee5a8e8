//! Figures as PNG.

use super::error::FigureError;
use resvg::tiny_skia::{Pixmap, Transform};
use resvg::usvg::{Options, Tree};

/// How many pixels of a PNG make one of the SVG: sharp on screens of high resolution, and in print.
const SCALE: f32 = 2.0;

/// The largest side, in pixels.
const LARGEST: u32 = 32_768;

/// Draws an SVG in pixels, with the fonts of the system.
///
/// # Errors
/// [`FigureError::NoFont`] if the system has none, [`FigureError::Drawing`] for what is no SVG, or
/// too large.
///
/// ```
/// use tangency::output::{Figure, Series, Style, draw, png};
/// let line = Series::new("line", Style::Solid, [[0.0, 0.0], [1.0, 2.0]]);
/// let picture = png(&draw(&[Figure::new("A line", "x", "y").with(line)])?)?;
/// assert!(picture.starts_with(b"\x89PNG"));
/// # Ok::<(), tangency::output::FigureError>(())
/// ```
pub fn png(svg: &str) -> Result<Vec<u8>, FigureError> {
    let failed = |reason: String| FigureError::Drawing(reason);
    let mut options = Options::default();
    let fonts = options.fontdb_mut();
    fonts.load_system_fonts();
    let first = fonts.faces().flat_map(|face| &face.families).map(|(name, _)| name.clone()).next();
    let Some(first) = first else { return Err(FigureError::NoFont) };
    // The SVG asks for any font without serifs; the name of one differs from system to system.
    let known = ["DejaVu Sans", "Liberation Sans", "Noto Sans", "Arial", "Helvetica"];
    let has = |wanted: &&str| {
        fonts.faces().any(|face| face.families.iter().any(|(name, _)| name == *wanted))
    };
    let family = known.iter().copied().find(has).map_or(first, String::from);
    fonts.set_sans_serif_family(family);
    let tree = Tree::from_str(svg, &options).map_err(|error| failed(error.to_string()))?;
    let size = tree.size().to_int_size().scale_by(SCALE);
    let size = size.filter(|size| size.width().max(size.height()) <= LARGEST);
    let pixels = size.and_then(|size| Pixmap::new(size.width(), size.height()));
    let mut pixels = pixels.ok_or_else(|| failed("the picture is too large for pixels".into()))?;
    resvg::render(&tree, Transform::from_scale(SCALE, SCALE), &mut pixels.as_mut());
    pixels.encode_png().map_err(|error| failed(error.to_string()))
}

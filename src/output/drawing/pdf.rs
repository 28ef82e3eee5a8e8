//! A PDF page as a backend of the plotters library: lines and areas as vector graphics, letters as
//! outlines.

use super::text::{Stroke, outlines};
use flate2::Compression;
use flate2::write::ZlibEncoder;
use pdf_writer::types::{LineCapStyle, LineJoinStyle};
use pdf_writer::{Content, Filter, Finish, Name, Pdf, Rect, Ref};
use plotters_backend::{
    BackendColor, BackendCoord, BackendStyle, BackendTextStyle, DrawingBackend, DrawingErrorKind,
};
use std::collections::BTreeSet;
use std::convert::Infallible;
use std::io::Write;

/// The distance of the control points from the ends of a quarter circle, relative to the radius:
/// the cubic then approximates the circle to 2.7e-4.
const QUARTER: f32 = 0.552_284_8;

/// A PDF page on which a backend draws.
pub(super) struct Page {
    content: Content,
    size: (u32, u32),
    /// The opacities of colours that are used on the page, in percent.
    veils: BTreeSet<u8>,
}

type Drawn = Result<(), DrawingErrorKind<Infallible>>;

impl Page {
    /// Creates a page with a given size in pixels and a given printed width in points.
    pub fn new(size: (u32, u32), width: f64) -> Self {
        let mut content = Content::new();
        let scale = (width / f64::from(size.0)) as f32;
        // Rows of a page are counted from below.
        content.transform([scale, 0.0, 0.0, -scale, 0.0, scale * size.1 as f32]);
        content.set_line_cap(LineCapStyle::ButtCap);
        content.set_line_join(LineJoinStyle::RoundJoin);
        Page { content, size, veils: BTreeSet::new() }
    }

    /// Returns the PDF file; the lengths of the page's sides are in points.
    pub fn finish(self, sides: [f64; 2]) -> std::io::Result<Vec<u8>> {
        let [catalog, pages, page, content] = [1, 2, 3, 4].map(Ref::new);
        let mut pdf = Pdf::new();
        pdf.catalog(catalog).pages(pages);
        pdf.pages(pages).kids([page]).count(1);
        let mut encoder = ZlibEncoder::new(Vec::new(), Compression::default());
        encoder.write_all(&self.content.finish())?;
        let stream = encoder.finish()?;
        pdf.stream(content, &stream).filter(Filter::FlateDecode);
        let mut of = pdf.page(page);
        of.parent(pages).contents(content);
        of.media_box(Rect::new(0.0, 0.0, sides[0] as f32, sides[1] as f32));
        let mut resources = of.resources();
        let mut states = resources.ext_g_states();
        for percent in &self.veils {
            let share = f32::from(*percent) / 100.0;
            let name = veil(*percent);
            let mut state = states
                .insert(Name(name.as_bytes()))
                .start::<pdf_writer::writers::ExtGraphicsState>();
            state.non_stroking_alpha(share).stroking_alpha(share);
        }
        states.finish();
        resources.finish();
        of.finish();
        Ok(pdf.finish())
    }

    /// Sets the colour and opacity of the following drawing operations.
    fn paint(&mut self, colour: BackendColor, draw: impl FnOnce(&mut Content)) -> Drawn {
        if colour.alpha == 0.0 {
            return Ok(());
        }
        let (r, g, b) = colour.rgb;
        let [r, g, b] = [r, g, b].map(|part| f32::from(part) / 255.0);
        let percent = (100.0 * colour.alpha).round() as u8;
        self.content.save_state();
        if percent < 100 {
            self.veils.insert(percent);
            self.content.set_parameters(Name(veil(percent).as_bytes()));
        }
        self.content.set_stroke_rgb(r, g, b).set_fill_rgb(r, g, b);
        draw(&mut self.content);
        self.content.restore_state();
        Ok(())
    }
}

/// Returns the name that denotes an opacity in the resources of the PDF page.
fn veil(percent: u8) -> String {
    format!("A{percent}")
}

fn float((x, y): BackendCoord) -> [f32; 2] {
    [x as f32, y as f32]
}

/// Adds a path through points to the page.
fn path(content: &mut Content, points: impl IntoIterator<Item = BackendCoord>) {
    for (k, at) in points.into_iter().enumerate() {
        let [x, y] = float(at);
        if k == 0 {
            content.move_to(x, y);
        } else {
            content.line_to(x, y);
        }
    }
}

impl DrawingBackend for Page {
    type ErrorType = Infallible;

    fn get_size(&self) -> (u32, u32) {
        self.size
    }

    fn ensure_prepared(&mut self) -> Drawn {
        Ok(())
    }

    fn present(&mut self) -> Drawn {
        Ok(())
    }

    fn draw_pixel(&mut self, at: BackendCoord, colour: BackendColor) -> Drawn {
        let [x, y] = float(at);
        self.paint(colour, |content| _ = content.rect(x, y, 1.0, 1.0).fill_nonzero())
    }

    fn draw_line<S: BackendStyle>(
        &mut self,
        from: BackendCoord,
        to: BackendCoord,
        style: &S,
    ) -> Drawn {
        self.draw_path([from, to], style)
    }

    fn draw_rect<S: BackendStyle>(
        &mut self,
        from: BackendCoord,
        to: BackendCoord,
        style: &S,
        fill: bool,
    ) -> Drawn {
        let ([left, top], [right, bottom]) = (float(from), float(to));
        let width = style.stroke_width() as f32;
        self.paint(style.color(), |content| {
            content.set_line_width(width).rect(left, top, right - left, bottom - top);
            _ = if fill { content.fill_nonzero() } else { content.stroke() };
        })
    }

    fn draw_path<S: BackendStyle, I: IntoIterator<Item = BackendCoord>>(
        &mut self,
        points: I,
        style: &S,
    ) -> Drawn {
        let width = style.stroke_width() as f32;
        self.paint(style.color(), |content| {
            content.set_line_width(width);
            path(content, points);
            content.stroke();
        })
    }

    fn draw_circle<S: BackendStyle>(
        &mut self,
        centre: BackendCoord,
        radius: u32,
        style: &S,
        fill: bool,
    ) -> Drawn {
        let ([x, y], r, width) = (float(centre), radius as f32, style.stroke_width() as f32);
        let q = QUARTER * r;
        self.paint(style.color(), |content| {
            content.set_line_width(width).move_to(x + r, y);
            content.cubic_to(x + r, y + q, x + q, y + r, x, y + r);
            content.cubic_to(x - q, y + r, x - r, y + q, x - r, y);
            content.cubic_to(x - r, y - q, x - q, y - r, x, y - r);
            content.cubic_to(x + q, y - r, x + r, y - q, x + r, y);
            _ = if fill { content.fill_nonzero() } else { content.stroke() };
        })
    }

    fn fill_polygon<S: BackendStyle, I: IntoIterator<Item = BackendCoord>>(
        &mut self,
        corners: I,
        style: &S,
    ) -> Drawn {
        self.paint(style.color(), |content| {
            path(content, corners);
            content.fill_nonzero();
        })
    }

    fn draw_text<S: BackendTextStyle>(&mut self, text: &str, style: &S, at: BackendCoord) -> Drawn {
        let strokes = outlines(text, style, at);
        if strokes.is_empty() {
            return Ok(());
        }
        self.paint(style.color(), |content| {
            for stroke in strokes {
                match stroke {
                    Stroke::To([x, y]) => content.move_to(x, y),
                    Stroke::Line([x, y]) => content.line_to(x, y),
                    Stroke::Curve([a, b], [c, d], [x, y]) => content.cubic_to(a, b, c, d, x, y),
                };
            }
            content.fill_nonzero();
        })
    }
}

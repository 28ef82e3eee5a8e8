//! A common backend of the plotters library: vector graphics for SVG or PDF, or pixels for PNG.

use super::pdf::Page;
use super::text::write;
use plotters::prelude::{BitMapBackend, DrawingBackend, SVGBackend};
use plotters_backend::{
    BackendColor, BackendCoord, BackendStyle, BackendTextStyle, DrawingErrorKind,
};

/// The plotters backend of one file format.
pub(super) enum Backend<'a> {
    Lines(SVGBackend<'a>),
    Page(&'a mut Page),
    Pixels(BitMapBackend<'a>),
}

/// The error of a failed drawing operation.
#[derive(Debug, miette::Diagnostic, thiserror::Error)]
#[error("{0}")]
pub(super) struct Failed(String);

type Drawn = Result<(), DrawingErrorKind<Failed>>;

fn failed<E: std::error::Error + Send + Sync>(
    error: DrawingErrorKind<E>,
) -> DrawingErrorKind<Failed> {
    DrawingErrorKind::DrawingError(Failed(error.to_string()))
}

/// Delegates a call of a drawing method to the backend of the format.
macro_rules! each {
    ($self:expr, $backend:ident => $call:expr) => {
        match $self {
            Backend::Lines($backend) => $call.map_err(failed),
            Backend::Page($backend) => $call.map_err(failed),
            Backend::Pixels($backend) => $call.map_err(failed),
        }
    };
}

impl DrawingBackend for Backend<'_> {
    type ErrorType = Failed;

    fn get_size(&self) -> (u32, u32) {
        match self {
            Backend::Lines(backend) => backend.get_size(),
            Backend::Page(page) => page.get_size(),
            Backend::Pixels(backend) => backend.get_size(),
        }
    }

    fn ensure_prepared(&mut self) -> Drawn {
        each!(self, backend => backend.ensure_prepared())
    }

    fn present(&mut self) -> Drawn {
        each!(self, backend => backend.present())
    }

    fn draw_pixel(&mut self, at: BackendCoord, colour: BackendColor) -> Drawn {
        each!(self, backend => backend.draw_pixel(at, colour))
    }

    fn draw_line<S: BackendStyle>(
        &mut self,
        from: BackendCoord,
        to: BackendCoord,
        style: &S,
    ) -> Drawn {
        each!(self, backend => backend.draw_line(from, to, style))
    }

    fn draw_rect<S: BackendStyle>(
        &mut self,
        from: BackendCoord,
        to: BackendCoord,
        style: &S,
        fill: bool,
    ) -> Drawn {
        each!(self, backend => backend.draw_rect(from, to, style, fill))
    }

    fn draw_path<S: BackendStyle, I: IntoIterator<Item = BackendCoord>>(
        &mut self,
        path: I,
        style: &S,
    ) -> Drawn {
        match self {
            Backend::Lines(backend) => backend.draw_path(path, style).map_err(failed),
            Backend::Page(page) => page.draw_path(path, style).map_err(failed),
            // A thick line that crosses or repeats itself, as the outline of a triangle does, would
            // have holes there: each piece is a segment, joined to the one before it.
            Backend::Pixels(backend) => {
                let path: Vec<BackendCoord> = path.into_iter().collect();
                let mut pieces = (1..path.len()).map(|end| &path[end.saturating_sub(2)..=end]);
                pieces.try_for_each(|piece| {
                    backend.draw_path(piece.iter().copied(), style).map_err(failed)
                })
            }
        }
    }

    fn draw_circle<S: BackendStyle>(
        &mut self,
        centre: BackendCoord,
        radius: u32,
        style: &S,
        fill: bool,
    ) -> Drawn {
        each!(self, backend => backend.draw_circle(centre, radius, style, fill))
    }

    fn fill_polygon<S: BackendStyle, I: IntoIterator<Item = BackendCoord>>(
        &mut self,
        corners: I,
        style: &S,
    ) -> Drawn {
        each!(self, backend => backend.fill_polygon(corners, style))
    }

    /// Draws a text: as a text element in an SVG, as letters of the built-in font in other formats.
    fn draw_text<S: BackendTextStyle>(&mut self, text: &str, style: &S, at: BackendCoord) -> Drawn {
        match self {
            Backend::Lines(backend) => backend.draw_text(text, style, at).map_err(failed),
            Backend::Page(page) => page.draw_text(text, style, at).map_err(failed),
            Backend::Pixels(backend) => {
                write(text, style, at, |at, colour| backend.draw_pixel(at, colour)).map_err(failed)
            }
        }
    }
}

//! One figure: title, axes, curves, marks, and the legend below.

use super::canvas::{Anchor, Canvas, FAINT, INK, Painted, text_width};
use super::labels::{place, sampled};
use super::legend::Legend;
use super::pen::{colour, curve, mark, tint};
use super::smooth::smooth;
use super::ticks::Ticks;
use crate::output::error::FigureError;
use crate::output::figure::{Figure, Series, Style};

/// The width of a usual panel, in pixels.
pub(super) const WIDTH: f64 = 720.0;
const TITLE: f64 = 16.0;
const TEXT: f64 = 12.0;
const NAME: f64 = 14.0;
const PLOT_HEIGHT: f64 = 480.0;
/// Room for the title, for the last tick's label, and for ticks and name of the horizontal axis.
const MARGINS: [f64; 3] = [46.0, 34.0, 52.0];

/// A figure laid out, with the origin in the upper left corner of the panel.
pub(super) struct Panel<'a> {
    figure: &'a Figure,
    legend: Legend<'a>,
    x: Ticks,
    y: Ticks,
    /// The rectangle of the data: left, top, right, bottom.
    frame: [f64; 4],
    width: f64,
    letter: Option<String>,
    /// Whether the title stands above this panel.
    titled: bool,
}

/// Writes a title in the middle above a width.
pub(super) fn heading(canvas: &Canvas, title: &str, [x, y]: [f64; 2], width: f64) -> Painted {
    let size = fitting(title, TITLE, width - 80.0);
    canvas.text(title, [x + width / 2.0, y + 22.0], size, Anchor::Middle)
}

impl<'a> Panel<'a> {
    /// Lays a figure out.
    pub fn new(
        figure: &'a Figure,
        width: f64,
        letter: Option<String>,
        titled: bool,
    ) -> Result<Self, FigureError> {
        let [x, y] = figure.extent()?;
        let y = match figure.y_names.is_empty() {
            true => Ticks::new(y, 7.0)?,
            false => Ticks::named(y, &figure.y_names),
        };
        let widest = |ticks: &Ticks| {
            ticks.ticks.iter().map(|(_, label)| text_width(label, TEXT)).fold(0.0, f64::max)
        };
        let left = 46.0 + widest(&y);
        let right = width - MARGINS[1];
        let mut x_ticks = Ticks::new(x, 8.0 * width / WIDTH)?;
        // Labels that would touch each other are thinned out.
        let room = |ticks: &Ticks| (right - left) / (widest(ticks) + 16.0);
        if x_ticks.ticks.len() as f64 > room(&x_ticks) {
            x_ticks = Ticks::new(x, room(&x_ticks).max(1.0) * 0.7)?;
        }
        let frame = [left, MARGINS[0], right, PLOT_HEIGHT - MARGINS[2]];
        let legend = Legend::new(figure, right - left);
        Ok(Panel { figure, legend, x: x_ticks, y, frame, width, letter, titled })
    }

    /// Its width in pixels.
    pub fn width(&self) -> f64 {
        self.width
    }

    /// Its height in pixels.
    pub fn height(&self) -> f64 {
        match self.legend.height() {
            0.0 => PLOT_HEIGHT,
            legend => PLOT_HEIGHT + legend + 16.0,
        }
    }

    /// Draws it with its upper left corner at a point.
    pub fn draw(&self, canvas: &Canvas, corner: [f64; 2]) -> Painted {
        let [dx, dy] = corner;
        let [left, top, right, bottom] = self.frame;
        let frame = [left + dx, top + dy, right + dx, bottom + dy];
        for tile in &self.figure.tiles {
            let corners = tile.corners().map(|corner| self.pixel(frame, corner));
            canvas.rectangle(corners, tint(tile.hue, tile.shade))?;
        }
        self.axes(canvas, frame)?;
        if self.titled {
            heading(canvas, &self.figure.title, corner, self.width)?;
        }
        if let Some(letter) = &self.letter {
            canvas.text(&format!("({letter})"), [dx + 12.0, dy + 36.0], NAME, Anchor::Left)?;
        }
        self.curves(canvas, frame)?;
        self.marks(canvas, frame)?;
        self.legend.draw(canvas, [frame[0], dy + PLOT_HEIGHT + 4.0])
    }

    fn axes(&self, canvas: &Canvas, frame: [f64; 4]) -> Painted {
        let [left, top, right, bottom] = frame;
        for (value, label) in &self.x.ticks {
            let [x, _] = self.pixel(frame, [*value, self.y.range[0]]);
            canvas.line(&[[x, top], [x, bottom]], FAINT, 0.8)?;
            canvas.line(&[[x, bottom], [x, bottom + 5.0]], INK, 1.0)?;
            canvas.text(label, [x, bottom + 15.0], TEXT, Anchor::Middle)?;
        }
        for (value, label) in &self.y.ticks {
            let [_, y] = self.pixel(frame, [self.x.range[0], *value]);
            canvas.line(&[[left, y], [right, y]], FAINT, 0.8)?;
            canvas.line(&[[left - 5.0, y], [left, y]], INK, 1.0)?;
            canvas.text(label, [left - 9.0, y], TEXT, Anchor::Right)?;
        }
        canvas.line(&[[left, top], [left, bottom], [right, bottom]], INK, 1.0)?;
        canvas.text(&self.x.factor, [right, bottom + 36.0], TEXT, Anchor::Right)?;
        canvas.text(&self.y.factor, [left, top - 10.0], TEXT, Anchor::Left)?;
        let [across, up] = [(left + right) / 2.0, (top + bottom) / 2.0];
        let name = &self.figure.x_label;
        let size = fitting(name, NAME, right - left);
        canvas.text(name, [across, bottom + 37.0], size, Anchor::Middle)?;
        let edge = left - self.frame[0] + 18.0;
        let name = &self.figure.y_label;
        canvas.text(name, [edge, up], fitting(name, NAME, bottom - top), Anchor::Upwards)
    }

    fn curves(&self, canvas: &Canvas, frame: [f64; 4]) -> Painted {
        let names = self.figure.names();
        let all = &self.figure.series;
        for (k, series) in all.iter().enumerate().filter(|(_, series)| !series.points.is_empty()) {
            let index = names.iter().position(|name| *name == series.name).unwrap_or(0);
            let points = self.points(frame, k);
            curve(canvas, series.style, &points, colour(index))?;
        }
        Ok(())
    }

    /// The points of a series in pixels. Branches are smooth, over their pieces; what else is drawn
    /// may jump.
    fn points(&self, frame: [f64; 4], k: usize) -> Vec<[f64; 2]> {
        let all = &self.figure.series;
        let Series { name, style, points, origins } = &all[k];
        let pixel = |at: &[f64; 2]| self.pixel(frame, *at);
        let own: Vec<_> = points.iter().map(pixel).collect();
        let is_line = matches!(style, Style::Solid | Style::Dashed | Style::Thin);
        if !is_line || origins.is_empty() {
            return own;
        }
        let piece = |k: Option<usize>| all.get(k?).filter(|other| other.name == *name);
        let before = piece(k.checked_sub(1)).filter(|it| it.points.last() == points.first());
        let after = piece(Some(k + 1)).filter(|it| it.points.first() == points.last());
        let before = before.and_then(|it| it.points.iter().nth_back(1)).map(pixel);
        smooth(&own, before, after.and_then(|it| it.points.get(1)).map(pixel))
    }

    fn marks(&self, canvas: &Canvas, frame: [f64; 4]) -> Painted {
        let pixel = |at: &[f64; 2]| self.pixel(frame, *at);
        let series = self.figure.series.iter().filter(|series| series.style != Style::Specks);
        let curves: Vec<_> = series
            .flat_map(|series| sampled(&series.points.iter().map(pixel).collect::<Vec<_>>()))
            .collect();
        let seen = |at: &[f64; 2]| {
            let inside = |k: usize, range: [f64; 2]| range[0] <= at[k] && at[k] <= range[1];
            inside(0, self.x.range) && inside(1, self.y.range)
        };
        let drawn: Vec<_> = self.figure.marks.iter().filter(|mark| seen(&mark.at)).collect();
        let marks: Vec<_> = drawn
            .iter()
            .map(|mark| (pixel(&mark.at), &*mark.label, [text_width(&mark.label, TEXT), TEXT]))
            .collect();
        // Labels may stand a little beyond the data.
        let room = [frame[0], frame[1] - 8.0, frame[2] + 24.0, frame[3]];
        let centres = place(&marks, &curves, room);
        let labels = || centres.iter().zip(&marks).filter_map(|(c, mark)| Some(((*c)?, mark)));
        for (centre, (_, _, [width, height])) in labels() {
            canvas.veil(centre, [*width, *height])?;
        }
        for (drawn, (at, _, _)) in drawn.iter().zip(&marks) {
            mark(canvas, drawn.symbol, *at)?;
        }
        labels().try_for_each(|(at, (_, label, _))| canvas.text(label, at, TEXT, Anchor::Middle))
    }

    fn pixel(&self, frame: [f64; 4], [x, y]: [f64; 2]) -> [f64; 2] {
        let part = |range: [f64; 2], value: f64| (value - range[0]) / (range[1] - range[0]);
        [
            frame[0] + part(self.x.range, x) * (frame[2] - frame[0]),
            frame[3] - part(self.y.range, y) * (frame[3] - frame[1]),
        ]
    }
}

/// The size of a text that must not be longer than the room it has.
fn fitting(text: &str, size: f64, room: f64) -> f64 {
    size * (room / text_width(text, size).max(1.0)).min(1.0)
}

//! Draws one figure: axes, curves and marks, and the names next to the curves.

use super::canvas::{Anchor, Canvas, FAINT, INK, LIGHT, Painted, TEXT, text_width};
use super::coincident::{Hidden, Line, hidden};
use super::labels::{Room, Wanted, sampled};
use super::pen::{colour, curve, darker, is_spots, mark, pale, spot_sizes, tint};
use super::smooth::{CORNER, SLIGHT, smooth};
use super::ticks::Ticks;
use crate::output::error::FigureError;
use crate::output::figure::{Beside, Figure, Mark, Series, Style, Wall};

const TITLE: f64 = 16.0;
const NAME: f64 = 13.0;
/// The size of the texts beside curves.
const SMALL: f64 = 10.0;
/// The margin above the plotted data for the letter of a panel, and the margin for a title.
const ABOVE: f64 = 26.0;
const ABOVE_WITH_TITLE: f64 = 46.0;
/// The margin to the right of the plotted data for the label of the last tick, and the margin below
/// the data for the tick labels and the name of the horizontal axis.
const RIGHT: f64 = 20.0;
const BELOW: f64 = 48.0;
/// The approximate distances between ticks on the horizontal and on the vertical axis, in units.
const BETWEEN_TICKS: [f64; 2] = [85.0, 58.0];

/// The number of points above which a curve is smoothed, if the curve is not a branch.
const ENOUGH: usize = 20;

/// The distance between the strokes that hatch a wall, and the extent of a stroke along and across
/// the wall.
const HATCH: f64 = 7.0;

/// A figure together with its layout in a picture.
pub(super) struct Panel<'a> {
    pub figure: &'a Figure,
    x: Ticks,
    y: Ticks,
    /// The place of the panel: left, top, width and height.
    place: [f64; 4],
    /// The rectangle of the plotted data: left, top, right, bottom.
    frame: [f64; 4],
    letter: Option<String>,
    /// Whether the figure's title is written above this panel.
    titled: bool,
    /// The visible marks, with the centres of their labels.
    marks: Vec<(&'a Mark, Option<[f64; 2]>)>,
    /// The names next to curves, with the centres of the names and the indices of their colours.
    names: Vec<(String, [f64; 2], usize)>,
    /// The texts beside curves, with the centres of the texts.
    beside: Vec<(&'a str, [f64; 2])>,
    room: Room,
}

/// Writes a title that is centred above a rectangle of a given width.
pub(super) fn heading(canvas: &Canvas, title: &str, [x, y]: [f64; 2], width: f64) -> Painted {
    let size = TITLE * ((width - 60.0) / text_width(title, TITLE).max(1.0)).min(1.0);
    canvas.text(title, [x + width / 2.0, y + 20.0], size, Anchor::Middle)
}

/// Returns the letter of a panel: a, b, … z, aa, ab, …
pub(in crate::output) fn letter(index: usize) -> String {
    let last = char::from(b'a' + (index % 26) as u8);
    match index / 26 {
        0 => last.to_string(),
        more => letter(more - 1) + &last.to_string(),
    }
}

impl<'a> Panel<'a> {
    /// Lays out a figure in a rectangle: left, top, width and height.
    pub fn new(
        figure: &'a Figure,
        place: [f64; 4],
        letter: Option<String>,
        titled: bool,
    ) -> Result<Self, FigureError> {
        let [left, top, width, height] = place;
        let titled = titled && !figure.title.is_empty();
        let [x, y] = figure.extent()?;
        let above = if titled { ABOVE_WITH_TITLE } else { ABOVE };
        let data_height = height - above - BELOW;
        let y = match figure.y_names.is_empty() {
            true => {
                let count = data_height / BETWEEN_TICKS[1];
                Ticks::of(y, figure.ends[1], count, figure.logarithmic[1])?
            }
            false => Ticks::named(y, figure.ends[1], &figure.y_names),
        };
        let widest = |ticks: &Ticks| {
            ticks.ticks.iter().map(|(_, label)| text_width(label, TEXT)).fold(0.0, f64::max)
        };
        let data_left = left + 42.0 + widest(&y);
        let right = left + width - RIGHT;
        let across = |count: f64| Ticks::of(x, figure.ends[0], count, figure.logarithmic[0]);
        let mut x_ticks = across((right - data_left) / BETWEEN_TICKS[0])?;
        // Labels that would touch each other are thinned out.
        let room = |ticks: &Ticks| (right - data_left) / (widest(ticks) + 16.0);
        if x_ticks.ticks.len() as f64 > room(&x_ticks) {
            x_ticks = across(room(&x_ticks).max(1.0) * 0.7)?;
        }
        let frame = [data_left, top + above, right, top + height - BELOW];
        let mut panel = Panel {
            figure,
            x: x_ticks,
            y,
            place,
            frame,
            letter,
            titled,
            marks: Vec::new(),
            names: Vec::new(),
            beside: Vec::new(),
            // Labels may extend a little beyond the data.
            room: Room::new([frame[0], frame[1] - 8.0, frame[2] + 18.0, frame[3]]),
        };
        panel.place_marks();
        Ok(panel)
    }

    /// Returns the height.
    pub fn height(&self) -> f64 {
        self.place[3]
    }

    /// Returns whether a curve with the given name has a point in this panel.
    pub fn shows(&self, name: &str) -> bool {
        self.figure.series.iter().any(|series| series.name == name && !series.points.is_empty())
    }

    /// Chooses the places of the labels of marks.
    fn place_marks(&mut self) {
        let figure = self.figure;
        let series = figure.series.iter().filter(|series| !is_spots(series.style));
        let curves = series.flat_map(|series| self.sampled(series)).collect();
        let marks: Vec<&Mark> = figure.marks.iter().filter(|mark| self.sees(&mark.at)).collect();
        let size = |mark: &Mark| [text_width(&mark.label, TEXT), TEXT];
        let wanted =
            |it: &&'a Mark| Wanted { at: self.pixel(it.at), label: &it.label, size: size(it) };
        let wanted: Vec<Wanted> = marks.iter().map(wanted).collect();
        let places = self.room.place_labels(&wanted, curves);
        self.marks = marks.into_iter().zip(places).collect();
    }

    /// Returns whether a data point lies within the ranges of both axes of the panel.
    fn sees(&self, at: &[f64; 2]) -> bool {
        let inside = |range: [f64; 2], value: f64| range[0] <= value && value <= range[1];
        inside(self.x.range, at[0]) && inside(self.y.range, at[1])
    }

    /// Writes the name of a curve next to the curve, if space is available.
    pub fn name(&mut self, curve: &str, name: &str, colour: usize) -> bool {
        let series = self.figure.series.iter().filter(|series| series.name == curve);
        let lines = series.filter(|it| !(is_spots(it.style) || it.style == Style::Dots));
        let points: Vec<[f64; 2]> = lines.flat_map(|series| self.sampled(series)).collect();
        let place = self.room.place_name(&points, [text_width(name, TEXT), TEXT]);
        self.names.extend(place.map(|at| (name.to_owned(), at, colour)));
        place.is_some()
    }

    /// Places the texts beside curves, if space is available.
    pub fn place_beside(&mut self) {
        for Beside { points, sides, .. } in &self.figure.beside {
            let pixels = points.windows(2).filter(|pair| pair.iter().all(|at| self.sees(at)));
            let pixels = pixels.map(|pair| [self.pixel(pair[0]), self.pixel(pair[1])]);
            let mut own: Vec<[f64; 2]> = pixels.flat_map(|pair| sampled(&pair)).collect();
            own.dedup();
            let sizes = [0, 1].map(|k| [text_width(&sides[k], SMALL), SMALL]);
            let places = self.room.place_beside(&own, sizes);
            let placed = sides.iter().zip(places);
            self.beside.extend(placed.filter_map(|(text, at)| Some((text.as_str(), at?))));
        }
    }

    /// Removes the names that are written next to curves from the panel.
    pub fn forget_names(&mut self) {
        self.room.release(self.names.len());
        self.names.clear();
    }

    /// Draws the panel.
    pub fn draw(&self, canvas: &Canvas) -> Painted {
        for tile in &self.figure.tiles {
            let corners = tile.corners().map(|corner| self.pixel(corner));
            canvas.rectangle(corners, tint(tile.hue, tile.shade))?;
        }
        self.axes(canvas)?;
        let [left, top, width, _] = self.place;
        if self.titled {
            heading(canvas, &self.figure.title, [left, top], width)?;
        }
        if let Some(letter) = &self.letter {
            canvas.text(
                &format!("({letter})"),
                [left + 8.0, self.frame[1] - 12.0],
                NAME,
                Anchor::Left,
            )?;
        }
        self.walls(canvas)?;
        self.curves(canvas)?;
        self.labels(canvas)
    }

    fn axes(&self, canvas: &Canvas) -> Painted {
        let [left, top, right, bottom] = self.frame;
        for (value, label) in &self.x.ticks {
            let [x, _] = self.pixel([*value, self.y.range[0]]);
            canvas.line(&[[x, top], [x, bottom]], FAINT, 0.8)?;
            canvas.line(&[[x, bottom], [x, bottom + 5.0]], INK, 1.0)?;
            canvas.text(label, [x, bottom + 14.0], TEXT, Anchor::Middle)?;
        }
        for (value, label) in &self.y.ticks {
            let [_, y] = self.pixel([self.x.range[0], *value]);
            canvas.line(&[[left, y], [right, y]], FAINT, 0.8)?;
            canvas.line(&[[left - 5.0, y], [left, y]], INK, 1.0)?;
            canvas.text(label, [left - 9.0, y], TEXT, Anchor::Right)?;
        }
        canvas.line(&[[left, top], [left, bottom], [right, bottom]], INK, 1.0)?;
        let (x_label, x_factor) = self.x.label(&self.figure.x_label);
        let (y_label, y_factor) = self.y.label(&self.figure.y_label);
        canvas.text(&x_factor, [right, bottom + 33.0], TEXT, Anchor::Right)?;
        canvas.text(&y_factor, [left, top - 10.0], TEXT, Anchor::Left)?;
        let [across, up] = [(left + right) / 2.0, (top + bottom) / 2.0];
        let size = fitting(&x_label, NAME, right - left);
        canvas.text(&x_label, [across, bottom + 33.0], size, Anchor::Middle)?;
        let edge = self.place[0] + 15.0;
        canvas.text(&y_label, [edge, up], fitting(&y_label, NAME, bottom - top), Anchor::Upwards)
    }

    fn curves(&self, canvas: &Canvas) -> Painted {
        let names = self.figure.names();
        let shown = self.figure.series.iter().enumerate().filter(|(_, it)| !it.points.is_empty());
        let mut lines: Vec<Line> = shown
            .map(|(k, series)| Line {
                style: series.style,
                points: self.points(k),
                name: names.iter().position(|name| *name == series.name).unwrap_or(0),
            })
            .collect();
        // Spots are drawn after all lines, small spots last.
        let depth = |line: &Line| match line.style {
            Style::Specks => 2,
            Style::Blots => 1,
            _ => 0,
        };
        lines.sort_by_key(depth);
        for Hidden { points, name, width } in hidden(&lines) {
            canvas.line(&points, pale(colour(name)), width)?;
        }
        // All sweeps of a panel have spots of the same two sizes.
        let spots = spot_sizes(self.figure.series.iter());
        lines.iter().try_for_each(|it| curve(canvas, it.style, &it.points, colour(it.name), spots))
    }

    /// Draws walls with their hatching.
    fn walls(&self, canvas: &Canvas) -> Painted {
        let [left, top, right, bottom] = self.frame;
        for Wall { axis, at, side } in &self.figure.walls {
            let range = [self.x.range, self.y.range][*axis];
            if !(range[0]..=range[1]).contains(at) {
                continue;
            }
            let place = self.pixel(if *axis == 0 {
                [*at, self.y.range[0]]
            } else {
                [self.x.range[0], *at]
            });
            let (ends, length) = match axis {
                0 => ([[place[0], top], [place[0], bottom]], bottom - top),
                _ => ([[left, place[1]], [right, place[1]]], right - left),
            };
            canvas.line(&ends, INK, 1.0)?;
            // Rows are counted downwards.
            let out = if *axis == 0 { *side } else { -side } * HATCH;
            for k in 1..=(length / HATCH) as usize {
                let along = HATCH * k as f64;
                let stroke = match axis {
                    0 => [[place[0], top + along], [place[0] + out, top + along - HATCH]],
                    _ => [[left + along, place[1]], [left + along - HATCH, place[1] + out]],
                };
                canvas.line(&stroke, INK, 0.6)?;
            }
        }
        Ok(())
    }

    /// Returns the points of a series in units of the canvas. The pieces of branches are smoothed;
    /// other curves with enough points are smoothed only where they turn little, since trajectories
    /// may have corners.
    fn points(&self, k: usize) -> Vec<[f64; 2]> {
        let all = &self.figure.series;
        let Series { name, style, points, origins } = &all[k];
        let pixel = |at: &[f64; 2]| self.pixel(*at);
        let own: Vec<_> = points.iter().map(pixel).collect();
        let is_line = matches!(style, Style::Solid | Style::Dashed | Style::Thin);
        match (is_line, origins.is_empty()) {
            (true, false) => {}
            (true, true) if own.len() >= ENOUGH => return smooth(&own, [None, None], SLIGHT),
            _ => return own,
        }
        let piece = |k: Option<usize>| all.get(k?).filter(|other| other.name == *name);
        let before = piece(k.checked_sub(1)).filter(|it| it.points.last() == points.first());
        let after = piece(Some(k + 1)).filter(|it| it.points.first() == points.last());
        let before = before.and_then(|it| it.points.iter().nth_back(1)).map(pixel);
        smooth(&own, [before, after.and_then(|it| it.points.get(1)).map(pixel)], CORNER)
    }

    /// Draws the marks and their labels, and the names of curves.
    fn labels(&self, canvas: &Canvas) -> Painted {
        let labels = || self.marks.iter().filter_map(|(mark, at)| Some((*mark, (*at)?)));
        for (mark, at) in labels() {
            canvas.veil(at, [text_width(&mark.label, TEXT), TEXT])?;
        }
        for (name, at, _) in &self.names {
            canvas.veil(*at, [text_width(name, TEXT), TEXT])?;
        }
        for (drawn, _) in &self.marks {
            mark(canvas, drawn.symbol, self.pixel(drawn.at))?;
        }
        for (mark, at) in labels() {
            canvas.text(&mark.label, at, TEXT, Anchor::Middle)?;
        }
        for (text, at) in &self.beside {
            canvas.coloured(text, *at, (SMALL, LIGHT), Anchor::Middle)?;
        }
        let mut names = self.names.iter();
        names.try_for_each(|(name, at, index)| {
            canvas.coloured(name, *at, (TEXT, darker(*index)), Anchor::Middle)
        })
    }

    /// Samples a series at closely spaced points.
    fn sampled(&self, series: &Series) -> Vec<[f64; 2]> {
        sampled(&series.points.iter().map(|at| self.pixel(*at)).collect::<Vec<_>>())
    }

    /// Returns the position on the canvas of a data point.
    fn pixel(&self, [x, y]: [f64; 2]) -> [f64; 2] {
        let [left, top, right, bottom] = self.frame;
        [left + self.x.part(x) * (right - left), bottom - self.y.part(y) * (bottom - top)]
    }
}

/// Returns the letter size at which a text fits into a given length.
fn fitting(text: &str, size: f64, room: f64) -> f64 {
    size * (room / text_width(text, size).max(1.0)).min(1.0)
}

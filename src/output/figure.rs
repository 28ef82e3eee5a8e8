//! Figures: curves and marks that are ready to draw.

use super::error::FigureError;
use super::tile::Tile;
use crate::core::problem::distinct;

/// Curves and marks that share one pair of axes.
///
/// ```
/// use tangency::output::{Figure, Series, Style, PAGE, draw};
/// let curve = |name: &str, style, k: f64| {
///     let points = (0..=50).map(|i| f64::from(i) / 50.0).map(|x| [x, (k * x).sin()]);
///     Series::new(name, style, points)
/// };
/// let figure = Figure::new("Modes along the centre line", "x/a (1)", "w (1)")
///     .with(curve("first", Style::Solid, 3.14))
///     .with(curve("second", Style::Dashed, 6.28));
/// assert!(draw(&[figure], PAGE)?.contains("Modes along the centre line"));
/// # Ok::<(), tangency::output::FigureError>(())
/// ```
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Figure {
    /// The title of the figure; may be empty.
    pub title: String,
    /// The label of the horizontal axis, with its unit.
    pub x_label: String,
    /// The label of the vertical axis, with its unit.
    pub y_label: String,
    /// The curves. The curves of the figure; curves with the same name are pieces of one curve, and
    /// share a colour and an entry in the legend.
    pub series: Vec<Series>,
    /// Names of curves in the order of their colours; the curves with other names have the next
    /// colours, in the order of the curves. A name without a curve keeps its colour free.
    pub colours: Vec<String>,
    /// The marks.
    pub marks: Vec<Mark>,
    /// The texts on the two sides of curves, such as numbers of unstable directions.
    pub beside: Vec<Beside>,
    /// The line styles with their meanings, if any: `(Dashed, "unstable")`.
    pub styles: Vec<(Style, String)>,
    /// Coloured rectangles drawn before all curves, as a background.
    pub tiles: Vec<Tile>,
    /// The labels at 0, 1, 2, … on the vertical axis; if empty, the axis is labelled with numbers.
    pub y_names: Vec<String>,
    /// Walls (surfaces at which the motion is reset), on axes that show the coordinate bounded by
    /// the wall.
    pub walls: Vec<Wall>,
    /// For each of the two axes, whether the axis is logarithmic. All coordinates on a logarithmic
    /// axis must be positive.
    pub logarithmic: [bool; 2],
    /// The lower and the upper end of each of the two axes; an end that is not given follows from
    /// the data, with a margin.
    pub ends: [[Option<f64>; 2]; 2],
}

/// A curve, or a piece of a curve.
#[derive(Clone, Debug, PartialEq)]
pub struct Series {
    /// The name of the curve in the legend; the legend lists the curves if the figure contains
    /// curves of more than one name.
    pub name: String,
    /// The drawing style.
    pub style: Style,
    /// The points `[x, y]` in the units of the axes.
    pub points: Vec<[f64; 2]>,
    /// The origin of each point (the document, branch and point from which the point was drawn);
    /// empty for curves without origins. A vertex that was interpolated between two points of a
    /// branch has the origin of the first of these two points.
    pub origins: Vec<Origin>,
}

/// Texts beside a part of a curve, on its two sides, such as numbers of unstable directions.
///
/// ```
/// use tangency::output::{Beside, COLUMN, Figure, Series, Style, draw};
/// let points = vec![[0.0, 0.0], [1.0, 2.0]];
/// let mut figure = Figure::new("", "x", "y").with(Series::new("a", Style::Solid, points.clone()));
/// let sides = ["above".into(), "below".into()];
/// figure.beside.push(Beside { curve: "a".into(), points, sides });
/// let svg = draw(&[figure], COLUMN)?;
/// assert!(svg.contains("above") && svg.contains("below"));
/// # Ok::<(), tangency::output::FigureError>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct Beside {
    /// The name of the curve that has the texts.
    pub curve: String,
    /// The points `[x, y]` of the part of the curve, in the units of the axes.
    pub points: Vec<[f64; 2]>,
    /// The texts on the left and on the right of the part of the curve, as seen in the direction
    /// from its first point to its last point.
    pub sides: [String; 2],
}

/// The origin of a drawn point: the place in the results from which the point was drawn.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum Origin {
    /// The origin is a point of a branch.
    Point {
        /// The position of the document among the drawn documents.
        document: usize,
        /// The position of the branch in the document.
        branch: usize,
        /// The position of the point on the branch.
        point: usize,
    },
    /// The origin is a special point of a branch.
    Special {
        /// The position of the document among the drawn documents.
        document: usize,
        /// The position of the branch in the document.
        branch: usize,
        /// The label of the special point.
        label: usize,
    },
    /// The origin is a run of a sweep; the name of the curve is the name of the sweep.
    Run(usize),
}

/// The drawing style of a series.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub enum Style {
    /// A solid line.
    Solid,
    /// A dashed line.
    Dashed,
    /// A thin line.
    Thin,
    /// A dotted line.
    Dotted,
    /// A dot at every point of the curve, without a line.
    Dots,
    /// A dot at every point, and a line through the dots.
    DottedLine,
    /// A small spot at every point of the curve, drawn after all lines.
    Specks,
    /// A larger spot at every point; these spots are drawn after all lines, and before the small
    /// spots of other curves.
    Blots,
}

/// A wall along a line of constant `x` or `y`, hatched on its far side.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Wall {
    /// The axis on which the wall is at a constant coordinate: 0 for `x`, 1 for `y`.
    pub axis: usize,
    /// The coordinate.
    pub at: f64,
    /// The hatched side of the wall: 1 towards larger coordinates, −1 towards smaller coordinates.
    pub side: f64,
}

/// A marked point.
#[derive(Clone, Debug, PartialEq)]
pub struct Mark {
    /// The position of the mark in the figure, in the units of the axes.
    pub at: [f64; 2],
    /// The label of the mark, which is written next to the mark.
    pub label: String,
    /// The meaning of the mark, which the legend shows.
    pub meaning: String,
    /// The appearance.
    pub symbol: Symbol,
    /// The special point that the mark shows, if any.
    pub origin: Option<Origin>,
}

/// The appearance of a mark.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub enum Symbol {
    /// A red disc.
    Disc,
    /// A small white disc.
    Ring,
    /// A black square.
    Square,
    /// A blue diamond.
    Diamond,
    /// A yellow star of five points.
    Star,
    /// A green triangle.
    Triangle,
    /// A white triangle on its tip.
    TriangleDown,
    /// A violet pentagon.
    Pentagon,
    /// A brown hexagon.
    Hexagon,
    /// An orange triangle that points to the left.
    TriangleLeft,
    /// A black diagonal cross.
    Cross,
    /// A black upright cross.
    Plus,
    /// A dark red star of four points.
    FourStar,
    /// An olive star of six points.
    SixStar,
    /// A white star of five points with a yellow outline.
    OpenStar,
    /// A white triangle with a green outline.
    OpenTriangle,
    /// A light blue triangle that points to the right.
    TriangleRight,
    /// A white diamond with a blue outline.
    OpenDiamond,
    /// A white square with a black outline.
    OpenSquare,
    /// A white pentagon with a violet outline.
    OpenPentagon,
    /// A white hexagon with a brown outline.
    OpenHexagon,
    /// A grey ring, for a point that may not exist; the ranges of the axes do not depend on this
    /// point.
    Doubtful,
    /// No symbol; only the label of the mark is drawn, which is a number.
    Number,
}

impl Figure {
    /// Creates a figure without curves.
    pub fn new(
        title: impl Into<String>,
        x_label: impl Into<String>,
        y_label: impl Into<String>,
    ) -> Self {
        Figure {
            title: title.into(),
            x_label: x_label.into(),
            y_label: y_label.into(),
            ..Figure::default()
        }
    }

    /// Adds a curve.
    pub fn with(mut self, series: Series) -> Self {
        self.series.push(series);
        self
    }

    /// Returns the distinct names of the curves, in the order of their colours: first the names in
    /// [`Figure::colours`], then all other names in the order of the curves.
    pub fn names(&self) -> Vec<&str> {
        distinct(self.colours.iter().chain(self.series.iter().map(|series| &series.name)))
    }

    /// Returns the ranges of `x` and `y` that contain all points of the figure.
    ///
    /// # Errors
    /// [`FigureError::NotFinite`] with the place of a coordinate that is NaN or infinite,
    /// [`FigureError::NotPositive`] for a coordinate that a logarithmic axis cannot show,
    /// [`FigureError::Empty`] if the figure contains no points.
    ///
    /// ```
    /// use tangency::output::{Figure, Series, Style};
    /// let line = Series::new("line", Style::Solid, [[0.0, 3.0], [2.0, 1.0]]);
    /// assert_eq!(Figure::new("", "x", "y").with(line).extent()?, [[0.0, 2.0], [1.0, 3.0]]);
    /// # Ok::<(), tangency::output::FigureError>(())
    /// ```
    pub fn extent(&self) -> Result<[[f64; 2]; 2], FigureError> {
        let series = self.series.iter().flat_map(|series| {
            series.points.iter().enumerate().map(|(i, at)| (series.name.as_str(), i, *at))
        });
        let marks = self.marks.iter().enumerate();
        let marks = marks.filter(|(_, mark)| mark.symbol != Symbol::Doubtful);
        let marks = marks.map(|(i, mark)| (&*mark.label, i, mark.at));
        let mut extent = [[f64::INFINITY, f64::NEG_INFINITY]; 2];
        let tiles = self.tiles.iter().enumerate();
        let tiles = tiles.flat_map(|(i, tile)| tile.corners().map(|at| (&*tile.meaning, i, at)));
        for (name, index, at) in series.chain(marks).chain(tiles) {
            if !at.iter().all(|value| value.is_finite()) {
                return Err(FigureError::NotFinite { series: name.into(), index, at });
            }
            if (0..2).any(|k| self.logarithmic[k] && at[k] <= 0.0) {
                return Err(FigureError::NotPositive { series: name.into(), index, at });
            }
            for (range, value) in extent.iter_mut().zip(at) {
                *range = [range[0].min(value), range[1].max(value)];
            }
        }
        match extent[0][0] <= extent[0][1] {
            true => Ok(extent),
            false => Err(FigureError::Empty { title: self.title.clone() }),
        }
    }
}

impl Series {
    /// Creates a named curve through points `[x, y]`.
    pub fn new(
        name: impl Into<String>,
        style: Style,
        points: impl IntoIterator<Item = [f64; 2]>,
    ) -> Self {
        let (name, points) = (name.into(), points.into_iter().collect());
        Series { name, style, points, origins: Vec::new() }
    }

    /// Creates a named curve through points; each point comes with the place in a document from
    /// which it is taken.
    pub(super) fn with_origins(
        name: impl Into<String>,
        style: Style,
        points: impl IntoIterator<Item = ([f64; 2], Origin)>,
    ) -> Self {
        let (points, origins) = points.into_iter().unzip();
        Series { name: name.into(), style, points, origins }
    }
}

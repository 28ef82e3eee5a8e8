//! Tiles: coloured rectangles of a figure.

/// A coloured rectangle.
#[derive(Clone, Debug, PartialEq)]
pub struct Tile {
    /// The centre of the rectangle, in the units of the axes.
    pub at: [f64; 2],
    /// The width and height of the rectangle, in the units of the axes.
    pub size: [f64; 2],
    /// The hue.
    pub hue: Hue,
    /// The index of the shade, counted from 0; shades distinguish rectangles of one hue.
    pub shade: usize,
    /// The meaning of the tile's colour, in words, for the legend.
    pub meaning: String,
}

/// The hue of a tile: a family of colours.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub enum Hue {
    /// Bluish green.
    Green,
    /// Blue.
    Blue,
    /// Yellow to orange.
    Yellow,
    /// Colours from dark red to purple.
    Red,
    /// Colours of nine levels of a field, from pale yellow over green to dark blue.
    Level,
}

impl Tile {
    /// Returns two opposite corners of the rectangle.
    pub(super) fn corners(&self) -> [[f64; 2]; 2] {
        [-0.5, 0.5].map(|part| [0, 1].map(|k| self.at[k] + part * self.size[k]))
    }

    /// Adds the tile to a list of tiles; if a tile next to it along an axis has the same meaning,
    /// the two tiles are merged.
    ///
    /// ```
    /// use tangency::output::{Hue, Tile};
    /// let tile = |x: f64| {
    ///     Tile { at: [x, 0.0], size: [1.0, 1.0], hue: Hue::Blue, shade: 0, meaning: "cycle".into() }
    /// };
    /// let mut tiles = vec![tile(0.0)];
    /// tile(1.0).add_to(&mut tiles, 0);
    /// assert_eq!((tiles.len(), tiles[0].at, tiles[0].size), (1, [0.5, 0.0], [2.0, 1.0]));
    /// ```
    pub fn add_to(self, tiles: &mut Vec<Tile>, axis: usize) {
        if let Some(last) = tiles.last_mut() {
            let step = self.size[axis];
            let distance = self.at[axis] - last.at[axis] - 0.5 * (last.size[axis] + step);
            if last.meaning == self.meaning
                && last.at[1 - axis] == self.at[1 - axis]
                && distance.abs() < 1e-6 * step
            {
                last.at[axis] += 0.5 * step;
                last.size[axis] += step;
                return;
            }
        }
        tiles.push(self);
    }
}

/// Returns the smallest distance between two different values of a list; `None` if all values are
/// equal.
///
/// ```
/// assert_eq!(tangency::output::spacing([0.0, 2.0, 1.5].into_iter()), Some(0.5));
/// ```
pub fn spacing(values: impl Iterator<Item = f64>) -> Option<f64> {
    let mut sorted: Vec<f64> = values.collect();
    sorted.sort_by(f64::total_cmp);
    let gaps = sorted.windows(2).map(|pair| pair[1] - pair[0]);
    gaps.filter(|gap| *gap > 0.0).reduce(f64::min)
}

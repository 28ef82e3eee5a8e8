//! Colours of curves and tiles, and the drawing of curves and symbols.

use super::canvas::{Canvas, INK, Painted};
use super::spots::sizes;
use crate::output::figure::{Series, Style, Symbol};
use crate::output::tile::{Hue, Tile};
use plotters::style::{RGBColor, WHITE};

/// The colours of curves, distinct also for colour-blind readers (after Okabe, Ito and Tol). After
/// the last colour, the sequence of colours is repeated.
const COLOURS: [RGBColor; 10] = [
    RGBColor(0, 114, 178),
    RGBColor(230, 159, 0),
    RGBColor(0, 158, 115),
    RGBColor(204, 121, 167),
    RGBColor(86, 180, 233),
    RGBColor(136, 34, 85),
    RGBColor(153, 153, 51),
    RGBColor(51, 34, 136),
    RGBColor(120, 120, 120),
    RGBColor(17, 119, 51),
];

/// Returns the colour of a curve, by its index among the names of a figure.
pub(super) fn colour(index: usize) -> RGBColor {
    COLOURS[index % COLOURS.len()]
}

/// Returns the colours of curves in HTML notation.
pub(crate) fn hexadecimal() -> Vec<String> {
    COLOURS.iter().map(|RGBColor(r, g, b)| format!("#{r:02x}{g:02x}{b:02x}")).collect()
}

/// Returns the colour of a tile in HTML notation.
pub(in crate::output) fn shade(tile: &Tile) -> String {
    let RGBColor(r, g, b) = tint(tile.hue, tile.shade);
    format!("#{r:02x}{g:02x}{b:02x}")
}

/// Returns the colour in which the name of a curve is written, darker than the curve for
/// readability.
pub(super) fn darker(index: usize) -> RGBColor {
    let RGBColor(r, g, b) = colour(index);
    let [r, g, b] = [r, g, b].map(|part| (f64::from(part) * 0.8) as u8);
    RGBColor(r, g, b)
}

/// Returns the mixture of equal parts of a colour and white.
pub(super) fn pale(RGBColor(r, g, b): RGBColor) -> RGBColor {
    let [r, g, b] = [r, g, b].map(|part| part / 2 + 128);
    RGBColor(r, g, b)
}

/// Returns the colour of a tile: shades of one hue differ in lightness, and the hues can be
/// distinguished also by colour-blind readers. After the last shade, the sequence of shades is
/// repeated, starting with the lightest shade.
pub(super) fn tint(hue: Hue, shade: usize) -> RGBColor {
    let shades: &[(u8, u8, u8)] = match hue {
        Hue::Green => &[(178, 226, 204), (102, 194, 164), (35, 139, 105), (0, 88, 66)],
        Hue::Blue => &[(133, 180, 226), (66, 133, 196), (33, 91, 158), (8, 48, 107)],
        Hue::Yellow => &[(255, 237, 160), (254, 204, 92), (240, 160, 40), (196, 118, 10)],
        Hue::Red => &[(206, 60, 100), (158, 1, 66), (100, 0, 86), (50, 0, 30)],
        // Shades of decreasing lightness, after C. Brewer.
        Hue::Level => &[
            (255, 255, 217),
            (237, 248, 177),
            (199, 233, 180),
            (127, 205, 187),
            (65, 182, 196),
            (29, 145, 192),
            (34, 94, 168),
            (37, 52, 148),
            (8, 29, 88),
        ],
    };
    let (r, g, b) = shades[shade % shades.len()];
    RGBColor(r, g, b)
}

/// The lengths of the dashes of dashed lines, and of the gaps between the dashes.
const DASHES: [f64; 2] = [7.0, 4.5];
const DOTS: [f64; 2] = [1.5, 2.5];

/// Returns whether a curve is drawn as spots that are too small to be recognised as a line.
pub(super) fn is_spots(style: Style) -> bool {
    matches!(style, Style::Specks | Style::Blots)
}

/// Returns the side lengths of the spots of all sweeps in figures with the given curves.
pub(super) fn spot_sizes<'a>(curves: impl Iterator<Item = &'a Series>) -> [f64; 2] {
    let spots = curves.filter(|curve| is_spots(curve.style));
    sizes(spots.map(|curve| curve.points.len()).max().unwrap_or_default())
}

/// Draws a curve through points that are given in pixels; `small` and `large` are the side lengths of
/// its spots.
pub(super) fn curve(
    canvas: &Canvas,
    style: Style,
    points: &[[f64; 2]],
    colour: RGBColor,
    [small, large]: [f64; 2],
) -> Painted {
    match style {
        Style::Solid if points.len() > 1 => canvas.line(points, colour, 2.0),
        Style::Dashed => canvas.dashed(points, DASHES, (colour, 2.0)),
        Style::Dotted => canvas.dashed(points, DOTS, (colour, 1.0)),
        Style::Thin if points.len() > 1 => canvas.line(points, colour, 0.8),
        Style::Thin | Style::Solid => Ok(()),
        Style::Specks => canvas.spots(points, colour, small),
        Style::Blots => canvas.spots(points, colour, large),
        Style::Dots | Style::DottedLine => {
            if style == Style::DottedLine {
                canvas.line(points, colour, 1.5)?;
            }
            points.iter().try_for_each(|at| canvas.disc(*at, 3.5, colour, WHITE))
        }
    }
}

/// The colours of symbols of special points.
const RED: RGBColor = RGBColor(213, 60, 0);
const BLUE: RGBColor = RGBColor(0, 72, 140);
const YELLOW: RGBColor = RGBColor(200, 140, 0);
const GREEN: RGBColor = RGBColor(0, 120, 85);
const VIOLET: RGBColor = RGBColor(120, 40, 140);
const BROWN: RGBColor = RGBColor(120, 75, 40);
const ORANGE: RGBColor = RGBColor(230, 110, 0);
const DARK_RED: RGBColor = RGBColor(160, 0, 60);
const OLIVE: RGBColor = RGBColor(110, 110, 0);
const LIGHT_BLUE: RGBColor = RGBColor(40, 150, 210);
const GRAY: RGBColor = RGBColor(140, 140, 140);

/// Draws a symbol at a point that is given in pixels.
pub(super) fn mark(canvas: &Canvas, symbol: Symbol, at: [f64; 2]) -> Painted {
    // A polygon or a star, given by its radii, with a fill and an outline.
    let outlined = |corners: usize, radii: [f64; 2], first: f64, [fill, outline]: [RGBColor; 2]| {
        let corner = |i: usize| {
            let angle = first + std::f64::consts::TAU * i as f64 / corners as f64;
            let radius = radii[i % 2];
            [at[0] + radius * angle.sin(), at[1] - radius * angle.cos()]
        };
        let corners: Vec<_> = (0..corners).map(corner).collect();
        canvas.polygon(&corners, fill, outline)
    };
    let filled =
        |corners, radius, first, fill| outlined(corners, [radius, radius], first, [fill, WHITE]);
    let open = |corners, radius, first, outline| {
        outlined(corners, [radius, radius], first, [WHITE, outline])
    };
    let arms = |arms: [[f64; 2]; 2]| {
        arms.iter().try_for_each(|[dx, dy]| {
            canvas.line(&[[at[0] - dx, at[1] - dy], [at[0] + dx, at[1] + dy]], INK, 2.2)
        })
    };
    let quarter = std::f64::consts::FRAC_PI_4;
    match symbol {
        Symbol::Disc => canvas.disc(at, 4.8, RED, WHITE),
        Symbol::Ring => canvas.disc(at, 3.6, WHITE, INK),
        Symbol::Square => filled(4, 6.2, quarter, INK),
        Symbol::Diamond => filled(4, 6.6, 0.0, BLUE),
        Symbol::Star => outlined(10, [8.0, 3.4], 0.0, [YELLOW, WHITE]),
        Symbol::Triangle => filled(3, 6.8, 0.0, GREEN),
        Symbol::TriangleDown => open(3, 6.0, 4.0 * quarter, INK),
        Symbol::Pentagon => filled(5, 6.2, 0.0, VIOLET),
        Symbol::Hexagon => filled(6, 6.2, 0.0, BROWN),
        Symbol::TriangleLeft => filled(3, 6.8, -2.0 * quarter, ORANGE),
        Symbol::Cross => arms([[4.5, 4.5], [4.5, -4.5]]),
        Symbol::Plus => arms([[5.6, 0.0], [0.0, 5.6]]),
        Symbol::FourStar => outlined(8, [8.0, 3.0], 0.0, [DARK_RED, WHITE]),
        Symbol::SixStar => outlined(12, [7.6, 4.0], 0.0, [OLIVE, WHITE]),
        Symbol::OpenStar => outlined(10, [8.0, 3.4], 0.0, [WHITE, YELLOW]),
        Symbol::OpenTriangle => open(3, 6.4, 0.0, GREEN),
        Symbol::TriangleRight => filled(3, 6.8, 2.0 * quarter, LIGHT_BLUE),
        Symbol::OpenDiamond => open(4, 6.2, 0.0, BLUE),
        Symbol::OpenSquare => open(4, 5.8, quarter, INK),
        Symbol::OpenPentagon => open(5, 5.8, 0.0, VIOLET),
        Symbol::OpenHexagon => open(6, 5.8, 0.0, BROWN),
        Symbol::Doubtful => canvas.disc(at, 4.2, WHITE, GRAY),
        Symbol::Number => Ok(()),
    }
}

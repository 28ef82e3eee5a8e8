//! Promise: numbers, axes, lines and labels of figures are what a reader expects.

use proptest::prelude::*;
use tangency::core::spelling::suggest;
use tangency::output::{
    COLUMN, Document, Figure, FigureError, Mark, PAGE, Series, Style, Symbol, Wall, diagram, draw,
    example_branch, pdf, png, significant,
};

#[test]
fn numbers_have_their_shortest_form() {
    for (value, text) in [
        (-0.0, "0"),
        (1200.0, "1200"),
        (1e14, "100000000000000"),
        (1e15, "1e15"),
        (1e-5, "0.00001"),
        (9.9e-6, "9.9e-6"),
        (0.999_999_999_999_999_9, "1"),
        (f64::MAX, "1.79769313486232e308"),
    ] {
        assert_eq!(significant(value, 15), text);
    }
}

proptest! {
    #[test]
    fn within_half_a_unit_of_the_last_digit(value in -1e20..1e20_f64, scale in -30..30_i32) {
        let value = value * 10f64.powi(scale);
        let read: f64 = significant(value, 15).parse().unwrap();
        prop_assert!((read - value).abs() <= 5.1e-15 * value.abs());
    }
}

/// The texts of an SVG with their places, in pixels.
fn texts(svg: &str) -> Vec<([f64; 2], String)> {
    let elements = svg.split("<text ").skip(1);
    let text = |element: &str| {
        let (attributes, rest) = element.split_once('>').expect("a text");
        let number = |name: &str| {
            let (_, value) = attributes.split_once(&format!("{name}=\"")).expect("an attribute");
            value.split('"').next().and_then(|value| value.parse::<f64>().ok()).expect("a number")
        };
        let content = rest.split("</text>").next().unwrap_or_default().trim().to_string();
        ([0.1 * number("x"), 0.1 * number("y")], content)
    };
    elements.map(text).collect()
}

/// The lines of a colour in an SVG, in pixels.
fn lines(svg: &str, colour: &str) -> Vec<Vec<[f64; 2]>> {
    let stroke = format!("stroke=\"{colour}\"");
    let elements = svg.split("<polyline ").skip(1).filter(|element| element.contains(&stroke));
    let line = |element: &str| {
        let (_, points) = element.split_once("points=\"").expect("points");
        let points = points.split('"').next().unwrap_or_default().split_whitespace();
        let point = |text: &str| {
            let (x, y) = text.split_once(',').expect("two coordinates");
            [x, y].map(|value| 0.1 * value.parse::<f64>().expect("a coordinate"))
        };
        points.map(point).collect()
    };
    elements.map(line).collect()
}

/// The colour of the first curve.
const FIRST: &str = "#0072B2";

/// Branches are drawn without corners: 24 points of a circle look like a circle.
#[test]
fn branches_are_smooth() {
    let mut document = Document::new("", vec![example_branch()]);
    let branch = &mut document.branches[0];
    branch.special.clear();
    branch.points.truncate(24);
    for (k, point) in branch.points.iter_mut().enumerate() {
        let angle = std::f64::consts::TAU * k as f64 / 24.0;
        (point.parameters[0], point.monitors[0]) = (angle.cos(), angle.sin());
        point.unstable = None;
    }
    let figure = diagram(&[("circle", &document)], None, &[]).unwrap();
    assert_eq!(figure.series[0].points.len(), 24);
    let drawn = lines(&draw(&[figure], PAGE).unwrap(), FIRST).into_iter();
    let drawn = drawn.max_by_key(Vec::len).unwrap();
    let [[left, right], [top, bottom]] = [0, 1].map(|k| {
        let values = || drawn.iter().map(|at| at[k]);
        [values().fold(f64::MAX, f64::min), values().fold(f64::MIN, f64::max)]
    });
    for [x, y] in &drawn {
        let [a, b] =
            [(2.0 * x - left - right) / (right - left), (2.0 * y - top - bottom) / (bottom - top)];
        assert!((a.hypot(b) - 1.0).abs() < 2e-3, "{a} {b}");
    }
    let turn = |three: &[[f64; 2]]| {
        let [a, b] = [0, 1].map(|k| [0, 1].map(|i| three[k + 1][i] - three[k][i]));
        (a[0] * b[1] - a[1] * b[0]).atan2(a[0] * b[0] + a[1] * b[1]).abs()
    };
    assert!(drawn.windows(3).all(|three| turn(three) < 0.13), "a corner");
}

fn drawn(style: Style, points: &[[f64; 2]]) -> Figure {
    Figure::new("", "", "").with(Series::new("a", style, points.iter().copied()))
}

/// The texts at the horizontal axis of a figure with data from `low` to `high`.
fn labels(low: f64, high: f64) -> Vec<String> {
    let svg = draw(&[drawn(Style::Solid, &[[low, 0.0], [high, 1.0]])], PAGE).unwrap();
    let texts = texts(&svg);
    let lowest = texts.iter().map(|([_, y], _)| *y).fold(f64::NEG_INFINITY, f64::max);
    // The labels of the vertical axis are above.
    let found = texts.into_iter().filter(|([_, y], _)| lowest - y < 40.0);
    found.map(|(_, text)| text).collect()
}

/// Steps of one, two or five times a power of ten, with as many decimals everywhere.
#[test]
fn labels_of_axes_are_round_and_have_the_same_decimals() {
    let decimals = |text: &String| text.split_once('.').map_or(0, |(_, decimals)| decimals.len());
    for [low, high] in [[0.0, 1.0], [-100.0, 100.0], [172.963, 172.964], [0.0, 6e-9], [0.0, 3e7]] {
        let texts: Vec<String> =
            labels(low, high).iter().map(|text| text.replace('−', "-")).collect();
        let (values, texts): (Vec<f64>, Vec<&String>) =
            texts.iter().filter_map(|text| Some((text.parse::<f64>().ok()?, text))).unzip();
        assert!(values.len() > 4, "{texts:?}");
        assert!(texts.iter().all(|text| decimals(text) == decimals(texts[0])), "{texts:?}");
        let step = values[1] - values[0];
        let mantissa = step / 10_f64.powf((step.log10() + 1e-9).floor());
        assert!([1.0, 2.0, 5.0].iter().any(|m| (mantissa / m - 1.0).abs() < 1e-6), "{texts:?}");
        let even = |pair: &[f64]| (pair[1] - pair[0] - step).abs() < 1e-6 * step;
        assert!(values.windows(2).all(even), "{texts:?}");
    }
    // Very large and very small values share a power of ten.
    assert!(labels(0.0, 4e-9).iter().any(|text| text.contains("×10⁻⁹")));
    assert!(labels(0.0, 3e7).iter().any(|text| text.contains("×10⁶")));
}

#[test]
fn no_range_is_too_small_and_an_infinite_one_is_refused() {
    for [low, high] in [[3.0, 3.0], [0.0, 0.0], [0.0, 5e-324]] {
        assert!(!labels(low, high).is_empty());
    }
    let wide = draw(&[drawn(Style::Solid, &[[-f64::MAX, 0.0], [f64::MAX, 1.0]])], PAGE);
    assert!(matches!(wide, Err(FigureError::TooWide { .. })), "{wide:?}");
}

#[test]
fn dashes_follow_the_corners_and_end_with_the_line() {
    let corner = [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0]];
    let [solid, dashed] = [Style::Solid, Style::Dashed]
        .map(|style| lines(&draw(&[drawn(style, &corner)], PAGE).unwrap(), FIRST));
    let [whole] = &solid[..] else { panic!("{solid:?}") };
    let length = |line: &[[f64; 2]]| -> f64 {
        line.windows(2).map(|p| (p[1][0] - p[0][0]).hypot(p[1][1] - p[0][1])).sum()
    };
    assert!(dashed.len() > 5 && dashed[0][0] == whole[0]);
    let (last, all) = dashed.split_last().unwrap();
    assert!(all.iter().all(|dash| (length(dash) - 7.0).abs() < 0.25), "{dashed:?}");
    assert!(length(last) < 7.25);
    for pair in dashed.windows(2) {
        let (end, start) = (pair[0][pair[0].len() - 1], pair[1][0]);
        // Gaps are straight but for the one about the corner.
        let gap = (start[0] - end[0]).abs() + (start[1] - end[1]).abs();
        assert!((gap - 4.5).abs() < 0.25, "{gap}");
    }
    // A dash that goes round the corner has it as a point.
    let on = |p: &[f64; 2]| (p[0] - whole[1][0]).abs() < 0.1 || (p[1] - whole[1][1]).abs() < 0.1;
    assert!(dashed.iter().flatten().all(on), "{dashed:?}");
    // A single point has no dash.
    assert!(lines(&draw(&[drawn(Style::Dashed, &[[1.0, 1.0]])], PAGE).unwrap(), FIRST).len() <= 1);
}

#[test]
fn labels_keep_off_the_curve_and_off_each_other() {
    let mark = |x: f64, label: &str| Mark {
        at: [x, 0.5],
        label: label.into(),
        meaning: "marked".into(),
        symbol: Symbol::Disc,
        origin: None,
    };
    let mut figure = drawn(Style::Solid, &[[0.0, 0.5], [1.0, 0.5]]);
    figure.marks = vec![mark(0.50, "LP"), mark(0.51, "BP")];
    let svg = draw(&[figure.clone()], PAGE).unwrap();
    let curve = lines(&svg, FIRST)[0][0][1];
    let place = |svg: &str, label: &str| -> Vec<[f64; 2]> {
        texts(svg).into_iter().filter(|(_, text)| text == label).map(|(at, _)| at).collect()
    };
    let ([first], [second]) = (&place(&svg, "LP")[..], &place(&svg, "BP")[..]) else {
        panic!("{:?}", texts(&svg))
    };
    // The top of a text of ten pixels is given.
    for [_, y] in [first, second] {
        assert!(*y > curve || y + 10.0 < curve, "{y} {curve}");
    }
    let apart = [first[0] - second[0], first[1] - second[1]].map(f64::abs);
    assert!(apart[0] > 14.0 || apart[1] > 9.0, "{apart:?}");
    // A label that repeats another in the same place is left out.
    figure.marks = vec![mark(0.5, "EP"), mark(0.5, "EP")];
    assert_eq!(place(&draw(&[figure], PAGE).unwrap(), "EP").len(), 1);
}

/// A figure with parallel lines of some names, each with a stable and an unstable part.
fn named(names: &[&str]) -> Figure {
    let mut figure = Figure::new("lines", "x", "y");
    figure.styles = vec![(Style::Solid, "stable".into()), (Style::Dashed, "unstable".into())];
    for (k, name) in names.iter().enumerate() {
        let piece = |style, x: f64| Series::new(*name, style, [[x, k as f64], [x + 1.0, k as f64]]);
        figure.series.extend([piece(Style::Solid, 0.0), piece(Style::Dashed, 1.0)]);
    }
    figure
}

/// The place of the only text like this.
fn only(svg: &str, wanted: &str) -> [f64; 2] {
    let found: Vec<_> = texts(svg).into_iter().filter(|(_, text)| text == wanted).collect();
    assert_eq!(found.len(), 1, "{wanted}: {found:?}");
    found[0].0
}

/// Up to four curves have their names beside them, in the first panel alone; more are in the one
/// legend below all panels, which explains styles once.
#[test]
fn names_are_at_few_curves_and_in_one_legend() {
    let few = named(&["a", "b", "c", "d"]);
    let svg = draw(&[few.clone(), few], PAGE).unwrap();
    let stable = only(&svg, "stable");
    let lowest = texts(&svg).iter().map(|(at, _)| at[1]).fold(0.0, f64::max);
    assert_eq!(stable[1], lowest);
    for (index, name) in ["a", "b", "c", "d"].iter().enumerate() {
        let at = only(&svg, name);
        assert!(at[0] < 385.0 && at[1] < stable[1] - 40.0, "{name} at {at:?}");
        let curve = lines(&svg, ["#0072B2", "#E69F00", "#009E73", "#CC79A7"][index]);
        // The top of the text is given.
        let distance = (at[1] + 4.3 - curve[0][0][1]).abs();
        let ends = || curve.iter().flatten().map(|at| at[0]).filter(|x| *x < 385.0);
        let beyond = ends().all(|end| end < at[0]) || ends().all(|end| end > at[0]);
        assert!(distance < 14.0 && (distance > 6.0 || beyond), "{name}: {distance}");
    }
    let names = ["a", "b", "c", "d", "e"];
    let other = named(&["f", "g", "h", "i", "j"]);
    let svg = draw(&[named(&names), named(&names), other], PAGE).unwrap();
    let [first, second] = ["1\u{2002}a", "1\u{2002}f"].map(|name| only(&svg, name));
    assert!(first[1] < second[1] && second[1] < only(&svg, "stable")[1]);
    assert!((only(&svg, "(a), (b)")[1] - first[1]).abs() < 1.0);
    // The numbers are beside the curves of all panels.
    assert_eq!(texts(&svg).iter().filter(|(_, text)| text == "5").count(), 3);
}

/// Letters have the same size in print whatever the width; narrow pictures have one column.
#[test]
fn pictures_have_widths_in_millimetres() {
    let four = vec![named(&["a"]); 4];
    for (width, columns) in [(84.0, 1), (170.0, 2), (280.0, 4)] {
        let svg = draw(&four, width).unwrap();
        let unit = |text: &str| -> f64 {
            let (_, rest) = svg.split_once(text).unwrap();
            rest.split(['"', 'm', ' ']).next().unwrap().parse().unwrap()
        };
        assert_eq!(unit("<svg width=\""), width);
        // 7.5 points are 2.6458 mm, and 120 units of the SVG.
        assert!((unit("viewBox=\"0 0 ") / width - 120.0 / 2.6458).abs() < 0.01);
        let letters = texts(&svg).into_iter().filter(|(_, text)| text.starts_with('('));
        let tops: Vec<f64> = letters.map(|(at, _)| at[1]).collect();
        assert_eq!(tops.iter().filter(|top| **top == tops[0]).count(), columns, "{tops:?}");
    }
    for width in [39.0, 1001.0, f64::NAN] {
        assert!(matches!(draw(&four, width), Err(FigureError::Width { .. })));
    }
}

/// Pixels have the size of the picture in print, and show texts without fonts of the system.
#[test]
fn pixels_have_a_size_and_texts() {
    let [mut a, mut b] = [named(&["a"]), named(&["a"])];
    (a.title, b.title) = ("α".into(), "β".into());
    let [a, b] = [a, b].map(|figure| png(&[figure], COLUMN).unwrap());
    let number = |at: usize| u32::from_be_bytes(a[at..at + 4].try_into().unwrap());
    // 84 mm at 300 pixels per inch.
    assert_eq!(number(16), 992);
    let density = a.windows(4).position(|name| name == b"pHYs").unwrap();
    assert_eq!((number(density + 4), number(density + 8), a[density + 12]), (11811, 11811, 1));
    assert_ne!(a, b);
}

/// A page of PDF has the size of the picture, and one stream for everything.
#[test]
fn a_page_has_a_size() {
    let page = pdf(&[named(&["α"])], COLUMN).unwrap();
    let text = String::from_utf8_lossy(&page);
    // 84 mm are 238.11 points.
    assert!(text.starts_with("%PDF-1.7") && text.contains("/MediaBox [0 0 238.11"), "{text}");
    assert!(text.trim_end().ends_with("%%EOF"));
    let lacking = pdf(&[named(&["汉", "字"])], COLUMN).unwrap_err();
    assert!(matches!(lacking, FigureError::Letter { .. }), "{lacking}");
}

/// The colour of the first curve, half-way to white.
const PALE: &str = "#80B9D9";

/// A curve below another one is seen as a band beside it; curves that cross have none.
#[test]
fn curves_that_hide_each_other_have_a_band() {
    let curve = |name: &str, points: &[[f64; 2]]| Series::new(name, Style::Solid, points.to_vec());
    let line = [[0.0, 0.0], [0.5, 0.5], [1.0, 0.0]];
    let apart = [[0.0, 0.6], [1.0, 0.2]];
    let bands = |second: &[[f64; 2]]| {
        let figure = Figure::new("", "x", "y").with(curve("a", &line)).with(curve("b", second));
        lines(&draw(&[figure], PAGE).unwrap(), PALE)
    };
    assert_eq!(bands(&apart), [[[0.0; 2]; 0]; 0]);
    // The second curve goes along the first half of the first one only.
    let half = bands(&[[0.0, 0.0], [0.5, 0.5], [1.0, 1.0]]);
    assert_eq!(half.len(), 1);
    let [first, last] = [half[0][0], *half[0].last().unwrap()];
    let whole = bands(&line);
    let end = *whole[0].last().unwrap();
    // Of three the lowest has the widest band.
    let figure = ["a", "b", "c"]
        .iter()
        .fold(Figure::new("", "x", "y"), |figure, name| figure.with(curve(name, &line)));
    let svg = draw(&[figure], PAGE).unwrap();
    assert!(svg.contains(&format!("stroke=\"{PALE}\" stroke-width=\"70\"")));
    assert!(svg.contains("stroke=\"#F3CF80\" stroke-width=\"50\""));
    assert!(first[1] > last[1] && last[0] - first[0] < 0.55 * (end[0] - first[0]), "{half:?}");
}

/// Walls are hatched on the side where nothing moves.
#[test]
fn walls_are_hatched_outside() {
    let mut figure = drawn(Style::Solid, &[[0.0, 0.0], [1.0, 1.0]]);
    let ink = "#262626";
    let strokes = |figure: &Figure| lines(&draw(std::slice::from_ref(figure), PAGE).unwrap(), ink);
    let before = strokes(&figure).len();
    figure.walls = vec![Wall { axis: 0, at: 1.0, side: 1.0 }];
    let all = strokes(&figure);
    let slanted = |line: &&Vec<[f64; 2]>| line[0][0] != line[1][0] && line[0][1] != line[1][1];
    let hatching: Vec<_> = all.iter().filter(slanted).collect();
    assert_eq!(all.len(), before + 1 + hatching.len());
    assert!(hatching.len() > 20 && hatching.iter().all(|line| line[1][0] > line[0][0]));
    // A wall beyond the axes is not seen.
    figure.walls[0].at = 3.0;
    assert_eq!(strokes(&figure).len(), before);
}

/// On a logarithmic axis equal ratios are equally far from each other, and the ticks are powers of ten.
#[test]
fn logarithmic_axes_have_decades() {
    let points = [[1e-6, 1.0], [1e-3, 2.0], [1.0, 3.0], [1e3, 4.0]];
    let mut figure = drawn(Style::Solid, &points);
    figure.logarithmic = [true, false];
    let svg = draw(&[figure.clone()], PAGE).unwrap();
    let curve = &lines(&svg, FIRST)[0];
    let steps: Vec<f64> = curve.windows(2).map(|pair| pair[1][0] - pair[0][0]).collect();
    assert!(steps.iter().all(|step| (step - steps[0]).abs() < 0.3), "{steps:?}");
    let shown: Vec<String> = texts(&svg).into_iter().map(|(_, text)| text).collect();
    for tick in ["10⁻⁶", "1", "10²"] {
        assert!(shown.iter().any(|text| text == tick), "{tick}: {shown:?}");
    }
    let ticks = |low: f64, high: f64, width: f64| -> Vec<String> {
        let mut figure = drawn(Style::Solid, &[[low, 1.0], [high, 2.0]]);
        figure.logarithmic = [true, false];
        let svg = draw(&[figure], width).unwrap();
        let below = texts(&svg).iter().map(|(at, _)| at[1]).fold(0.0, f64::max) - 20.0;
        let row = texts(&svg)
            .into_iter()
            .filter(|(at, text)| (at[1] - below).abs() < 8.0 && !text.is_empty());
        row.map(|(_, text)| text).collect()
    };
    assert_eq!(ticks(8.0, 70.0, PAGE), ["10", "20", "50"]);
    assert!((3..10).contains(&ticks(1.1, 1.85, PAGE).len()), "{:?}", ticks(1.1, 1.85, PAGE));
    let few = ticks(1e-6, 0.1, 50.0);
    assert!((1..4).contains(&few.len()), "{few:?}");
    figure.series[0].points[0][0] = 0.0;
    assert!(matches!(draw(&[figure], PAGE), Err(FigureError::NotPositive { index: 0, .. })));
    // A diagram leaves such points out: the load of a plate begins at 0.
    let mut document = Document::new("t", vec![example_branch()]);
    document.plot.logarithmic = vec!["load".into()];
    let figure = diagram(&[("t", &document)], None, &[]).unwrap();
    let points = figure.series.iter().flat_map(|series| &series.points);
    assert!(points.clone().count() > 30 && points.clone().all(|at| at[0] > 0.0));
}

/// Small lengths are in µm: a prefix of the unit takes the place of the power of ten.
#[test]
fn units_have_prefixes() {
    for (label, high, shown, factor) in [
        ("gap (m)", 4e-6, "gap (µm)", ""),
        ("force (N)", 3e-4, "force (µN)", ""),
        ("stiffness (Pa)", 2e11, "stiffness (GPa)", ""),
        ("length (m)", 2e6, "length (m)", "×10⁶"),
        ("max_x (m), min_x (m)", 4e-6, "max_x (m), min_x (m)", "×10⁻⁶"),
        ("f(s)", 4e-6, "f(s)", "×10⁻⁶"),
        ("rate (1/s)", 4e-6, "rate (1/s)", "×10⁻⁶"),
        ("gap (m)", 2.0, "gap (m)", ""),
    ] {
        let mut figure = drawn(Style::Solid, &[[0.0, 0.0], [high, 1.0]]);
        figure.x_label = label.into();
        let svg = draw(&[figure], PAGE).unwrap();
        only(&svg, shown);
        assert_eq!(svg.contains("×10"), !factor.is_empty(), "{label}");
        assert!(svg.contains(factor));
    }
}

/// The branch `load = u (1 − u)²` is cut where it leaves the range.
#[test]
fn a_line_is_cut_where_it_leaves() {
    let mut document = Document::new("Pull-in", vec![example_branch()]);
    document.plot.ranges = vec![("load".into(), 0.0, 0.1)];
    let figure = diagram(&[("a", &document)], None, &[]).unwrap();
    let pieces: Vec<&Series> = figure.series.iter().filter(|s| !s.points.is_empty()).collect();
    assert_eq!(pieces.len(), 2, "{pieces:?}");
    let ends = |series: &Series| [series.points[0], series.points[series.points.len() - 1]];
    let ([_, leaves], [enters, _]) = (ends(pieces[0]), ends(pieces[1]));
    for [load, _] in [leaves, enters] {
        assert!((load - 0.1).abs() < 1e-12, "{load}");
    }
    assert!(leaves[1] < 1.0 / 3.0 && enters[1] > 1.0 / 3.0);
    assert!(pieces.iter().all(|s| s.points.iter().all(|[load, _]| *load <= 0.1 + 1e-12)));
}

/// Insertions, deletions, replacements and swaps of neighbours count, up to a third of the letters;
/// case does not.
#[test]
fn names_are_suggested_by_their_distance() {
    assert_eq!(suggest("laod", ["load"]), Some("load"));
    assert_eq!(suggest("Λ", ["λ"]), Some("λ"));
    assert_eq!(suggest("kitten", ["sitting"]), None, "three changes of six letters");
    assert_eq!(suggest("kittingen", ["sittingxx"]), Some("sittingxx"), "three of nine");
    assert_eq!(suggest("", ["abc"]), None);
    assert_eq!(suggest("abcd", ["abxy", "abxd"]), Some("abxd"));
}

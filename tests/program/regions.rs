//! Promise: pictures in two parameters have the numbers of unstable directions on the sides that the
//! curves divide, on no curve, if they are asked for.

use crate::program::command::tangency;
use std::path::Path;
use std::process::Output;
use tangency::core::continuation::Stretch;
use tangency::core::failure::one_line;
use tangency::core::system::Kind;
use tangency::output::{
    Beside, COLUMN, Document, Figure, Series, Style, diagram, draw, example_branch,
};

/// The texts in parentheses of an SVG with their places, in units of the picture, and `y` downwards.
fn regions(svg: &str) -> Vec<([f64; 2], String)> {
    let elements = svg.split("<text ").skip(1);
    let text = |element: &str| {
        let (attributes, rest) = element.split_once('>')?;
        let number = |name: &str| {
            let (_, value) = attributes.split_once(&format!("{name}=\""))?;
            value.split('"').next()?.parse::<f64>().ok()
        };
        let content = rest.split("</text>").next()?.trim().to_string();
        let is_region = content.starts_with('(') && content.ends_with(')');
        is_region.then_some(([0.1 * number("x")?, 0.1 * number("y")?], content))
    };
    elements.filter_map(text).collect()
}

/// A line that rises has its left side above; one that falls back has it below.
#[test]
fn texts_are_on_their_sides_and_on_no_curve() {
    for reversed in [false, true] {
        let mut points: Vec<[f64; 2]> =
            (0..=60).map(|k| f64::from(k) / 60.0).map(|x| [x, x * x]).collect();
        if reversed {
            points.reverse();
        }
        let line = Series::new("a", Style::Solid, points.clone());
        let mut figure = Figure::new("", "x", "y").with(line);
        let sides = ["(1)".to_string(), "(22)".to_string()];
        figure.beside.push(Beside { curve: "a".into(), points, sides });
        let svg = draw(&[figure], COLUMN).unwrap();
        let found = regions(&svg);
        let place = |text: &str| found.iter().find(|it| it.1 == text).unwrap().0;
        let ([x, above], [other, below]) = match reversed {
            false => (place("(1)"), place("(22)")),
            true => (place("(22)"), place("(1)")),
        };
        assert!(above < below && x < other, "{found:?}");
        // The curve passes between, at least as far away as half the height of the letters.
        assert!((x - other).hypot(above - below) > 12.0, "{found:?}");
    }
}

/// A branch in two parameters: up along `load = 0.5`, or seen with the axes exchanged.
#[test]
fn exchanged_axes_exchange_the_sides() {
    let mut branch = example_branch();
    branch.condition = Some(Kind::HB);
    branch.released = vec!["load".into(), "aspect_ratio".into()];
    branch.special.clear();
    for (k, point) in branch.points.iter_mut().enumerate() {
        point.parameters = vec![0.5, 1.0 + k as f64];
    }
    branch.stretches = vec![Stretch { points: [2, 38], left: vec![0], right: vec![2] }];
    let mut document = Document::new("", vec![branch]);
    let none = diagram(&[("", &document)], None, &[]).unwrap();
    assert!(none.beside.is_empty());
    document.plot.regions = true;
    let sides = |x: &str, y: &str| {
        let figure = diagram(&[("", &document)], Some(x), &[y]).unwrap();
        figure.beside.iter().map(|it| it.sides.clone()).collect::<Vec<_>>()
    };
    assert_eq!(sides("load", "aspect_ratio"), [["(0)".to_string(), "(2)".to_string()]]);
    assert_eq!(sides("aspect_ratio", "load"), [["(2)".to_string(), "(0)".to_string()]]);
    assert!(sides("load", "deflection").is_empty());
    let again = Document::parse(&document.to_ron().unwrap()).unwrap();
    assert_eq!(again, document);
    document.branches[0].stretches[0].points[1] = 99;
    let error = one_line(&document.to_ron().unwrap_err());
    assert!(error.contains("stretch 0: points"), "{error}");
}

const TAKENS: &str = "Equations(states: [(\"x\", \"y\"), (\"y\", \"e1 + e2*y + x^2 - x*y\")], \
    parameters: [(\"e1\", -0.81), (\"e2\", -0.5)], initial: [(\"x\", -0.9), (\"y\", 0)])";

fn run(folder: &Path, arguments: &[&str]) -> (bool, String) {
    let Output { status, stderr, .. } = tangency(folder, arguments);
    (status.success(), String::from_utf8(stderr).unwrap())
}

#[test]
fn a_picture_of_regions_by_one_command() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path();
    std::fs::write(path.join("takens.ron"), TAKENS).unwrap();
    let along = ["trace", "takens.ron", "--along", "e1=-1..0.5", "--along", "e2=-0.8..0.7"];
    let all = ["--hold", "LP", "--switch", "all", "--regions"];
    let (traced, said) = run(path, &[&along[..], &all].concat());
    assert!(traced, "{said}");
    let texts = |file: &str| {
        let found = regions(&std::fs::read_to_string(path.join(file)).unwrap());
        let mut texts: Vec<String> = found.into_iter().map(|it| it.1).collect();
        texts.sort();
        texts
    };
    let drawn = texts("out/takens.svg");
    for text in ["(0+1)", "(1+2)", "(–)", "(0)", "(2)"] {
        assert!(drawn.iter().any(|it| it == text), "{text} is not among {drawn:?}");
    }
    // The document keeps the choice.
    assert!(run(path, &["plot", "out/takens.ron", "--out", "again.svg"]).0);
    assert_eq!(texts("again.svg"), drawn);
    let (traced, said) = run(path, &[&along[..4], &["--out", "one"]].concat());
    assert!(traced, "{said}");
    let (drawn, said) = run(path, &["plot", "one/takens.ron", "--regions", "--out", "none.svg"]);
    assert!(!drawn && said.contains("--regions needs a curve"), "{said}");
}

//! Pictures as a reader meets them: symbols, colours, labels and ranges of axes.

use crate::program::command::{failure, refused, succeeds, tangency};
use std::collections::BTreeSet;
use tangency::core::problem::Profile;
use tangency::core::system::Kind;
use tangency::output::{
    COLUMN, Document, Figure, Format, Mark, Render, Results, Series, Style, Symbol, diagram, draw,
    example_branch, figures, png,
};
use tangency::scene::{Scene, execute};

fn mark(label: &str, symbol: Symbol) -> Mark {
    Mark { at: [0.5, 0.5], label: label.into(), meaning: label.into(), symbol, origin: None }
}

/// The dark pixels of a PNG, as columns and rows.
fn dark(png: &[u8]) -> Vec<[usize; 2]> {
    let mut reader = ::png::Decoder::new(std::io::Cursor::new(png)).read_info().unwrap();
    let mut pixels = vec![0; reader.output_buffer_size().unwrap()];
    let width = reader.next_frame(&mut pixels).unwrap().width as usize;
    let of = pixels.chunks(3).enumerate().filter(|(_, rgb)| rgb.iter().all(|part| *part < 110));
    of.map(|(k, _)| [k % width, k / width]).collect()
}

/// Regular points that are saved on request do not move the bounds of stability: at `a = 0` the
/// equilibrium `x = y = 0` loses its stability.
#[test]
fn saved_regular_points_do_not_change_stability() {
    let folder = tempfile::tempdir().unwrap();
    let at = folder.path();
    let model = r#"Equations(states: [("x", "a*x - y - x*(x^2 + y^2)"), ("y", "x + a*y - y*(x^2 + y^2)")],
        parameters: [("a", -1)])"#;
    std::fs::write(at.join("m.ron"), model).unwrap();
    for every in ["0", "1", "2", "3"] {
        let set = format!("save_every={every}");
        let said = succeeds(at, &["trace", "m.ron", "--along", "a=-1..1.1", "--set", &set]);
        let stable = said.split("stable from -1 to ").nth(1).unwrap_or_else(|| panic!("{said}"));
        let end: f64 = stable.split_whitespace().next().unwrap().parse().unwrap();
        assert!(end.abs() < 1e-9, "{every}: {said}");
    }
}

/// A triangle has three edges: as much of its outline is on the left as on the right.
#[test]
fn triangles_have_all_edges() {
    let at = |points: [[f64; 2]; 2]| Series::new("", Style::Dots, points);
    let plain = Figure::new("", "", "").with(at([[0.0, 0.0], [1.0, 1.0]]));
    let mut marked = plain.clone();
    marked.marks.push(mark("", Symbol::TriangleDown));
    for width in [40.0, COLUMN] {
        let [without, with] = [&plain, &marked].map(|figure| {
            let figures = std::slice::from_ref(figure);
            dark(&png(figures, width).unwrap()).into_iter().collect::<BTreeSet<_>>()
        });
        // The legend lies below the picture without marks.
        let below = without.iter().map(|at| at[1]).max().unwrap();
        let new: Vec<_> = with.difference(&without).filter(|at| at[1] < below).collect();
        let [left, right] = [new.iter().map(|at| at[0]).min(), new.iter().map(|at| at[0]).max()];
        let middle = (left.unwrap() + right.unwrap()) as f64 / 2.0;
        let side = |sign: f64| new.iter().filter(|at| sign * (at[0] as f64 - middle) > 1.0).count();
        let [left, right] = [side(-1.0), side(1.0)];
        assert!(left.abs_diff(right) * 4 <= left.max(right), "{width}: {left} {right}");
    }
}

/// The legend explains user's points, which have no label of their own where an axis shows them.
#[test]
fn the_legend_explains_all_marks() {
    let document = Document::new("Pull-in", vec![example_branch()]);
    let figure = diagram(&[("a", &document)], None, &[]).unwrap();
    let drawn = draw(&[figure], COLUMN).unwrap().replace("&apos;", "'");
    assert!(drawn.contains("user's point"));
}

/// Kinds that share a symbol elsewhere have different ones in one picture, the same in all panels.
#[test]
fn every_kind_has_its_own_symbol() {
    let kinds = [Kind::CP, Kind::GH, Kind::EP, Kind::BT, Kind::ZH, Kind::HOM];
    let mut document = Document::new("Pull-in", vec![example_branch()]);
    let special = document.branches[0].special[2].clone();
    let points = kinds.iter().enumerate().map(|(k, kind)| {
        let mut point = special.clone();
        (point.kind, point.label) = (*kind, k + 1);
        // The mark of an end is hidden below other marks.
        (point.parameters[0], point.monitors[0]) = (0.01 * k as f64, 0.1 * k as f64);
        point
    });
    document.branches[0].special = points.collect();
    let columns = |x: &str, y: &str| (x.to_string(), y.to_string());
    document.plot.panels = vec![columns("deflection", "load")];
    let drawn = figures(&[("a", &document)], &[], None, &[]).unwrap();
    let symbols = |figure: &Figure| -> BTreeSet<(String, String)> {
        let of = |mark: &Mark| (mark.meaning.clone(), format!("{:?}", mark.symbol));
        figure.marks.iter().map(of).collect()
    };
    assert_eq!(symbols(&drawn[0]), symbols(&drawn[1]));
    let all = symbols(&drawn[0]);
    let different: BTreeSet<&String> = all.iter().map(|(_, symbol)| symbol).collect();
    assert_eq!((all.len(), different.len()), (kinds.len(), kinds.len()), "{all:?}");
}

/// A curve has the same place among the names of all panels, also if one panel lacks another curve.
#[test]
fn an_orbit_has_one_colour() {
    let mut document = Document::new("Orbits", vec![example_branch()]);
    let profile = |along: &str, name: &str| Profile {
        name: name.into(),
        along: along.into(),
        points: vec![[0.0, 0.0], [1.0, 1.0]],
    };
    let special = &mut document.branches[0].special;
    special[1].profiles = vec![profile("time", "x")];
    special[2].profiles = vec![profile("time", "x"), profile("x", "y")];
    document.plot.points = vec!["2".into(), "3".into()];
    let drawn = figures(&[("a", &document)], &[], None, &[]).unwrap();
    let names = ["plate/2 deflection = 0.15, load = 0.108375", "plate/3 LP, load = 0.148148"];
    assert_eq!(drawn[1].names(), names);
    assert_eq!(drawn[2].names(), names);
    assert!(drawn[2].series.iter().all(|series| series.name == names[1]));
    // A point at a value of the parameter states the value once.
    document.branches[0].special[1].event = "load = 0.108375".into();
    let drawn = figures(&[("a", &document)], &[], None, &[]).unwrap();
    assert_eq!(drawn[1].names()[0], "plate/2 load = 0.108375");
}

/// Values at marks have the prefix of the axis, and a shift of a curve names the shifted column.
#[test]
fn labels_have_the_units_of_axes() {
    let mut document = Document::new("Pull-in", vec![example_branch()]);
    document.plot.labels = vec![("gap".into(), "gap (m)".into())];
    document.branches[0].special[1].event = "gap = 0.000002".into();
    let figure = diagram(&[("a", &document)], None, &[]).unwrap();
    assert!(figure.marks.iter().any(|mark| mark.label == "gap = 2 µm"), "{:?}", figure.marks);
    document.plot.shifts = vec![("plate".into(), "load".into(), -120.0)];
    let figure = diagram(&[("a", &document)], None, &[]).unwrap();
    assert_eq!(figure.names()[0], "plate (load − 120)");
}

/// Regular points that were saved on request are in the data, but have no marks in pictures.
#[test]
fn regular_points_have_no_marks() {
    let mut document = Document::new("Pull-in", vec![example_branch()]);
    let count = |document: &Document| diagram(&[("a", document)], None, &[]).unwrap().marks.len();
    let before = count(&document);
    document.branches[0].special[1].kind = Kind::RG;
    let figure = diagram(&[("a", &document)], None, &[]).unwrap();
    assert_eq!(figure.marks.len(), before - 1);
    assert!(figure.marks.iter().all(|mark| mark.label != "RG"));
}

/// A mark within a thousandth of a chosen range lies on the border of the range.
#[test]
fn marks_on_the_border_are_drawn() {
    let mut document = Document::new("Pull-in", vec![example_branch()]);
    let count = |document: &Document| {
        let figure = diagram(&[("a", document)], None, &[]).unwrap();
        figure.marks.iter().filter(|mark| mark.label == "LP").count()
    };
    let fold = 1.0 / 3.0;
    for (low, marks) in [(fold + 1e-5, 1), (fold + 0.1, 0)] {
        document.plot.ranges = vec![("deflection".into(), low, f64::INFINITY)];
        assert_eq!(count(&document), marks, "{low}");
    }
}

/// Documents that differ in one number are sorted by this number in the legend.
#[test]
fn legends_are_sorted_by_numbers() {
    let folder = tempfile::tempdir().unwrap();
    let at = folder.path();
    let model = "Equations(states: [(\"x\", \"a - c*x\")], parameters: [(\"a\", 0), (\"c\", 1)])";
    std::fs::write(at.join("m.ron"), model).unwrap();
    let mut plot = vec!["plot".to_string()];
    for c in ["10", "2.5", "3"] {
        let set = format!("c={c}");
        succeeds(at, &["trace", "m.ron", "--along", "a=0..1", "--set", &set, "--out", &set]);
        plot.push(format!("{set}/m.ron"));
    }
    plot.extend(["--out", "all.svg"].map(String::from));
    succeeds(at, &plot.iter().map(String::as_str).collect::<Vec<_>>());
    let svg = std::fs::read_to_string(at.join("all.svg")).unwrap();
    let place = |c: &str| svg.rfind(&format!("c = {c}\n")).unwrap();
    assert!(place("2.5") < place("3") && place("3") < place("10"));
}

/// The title of a scene does not state values that were changed.
#[test]
fn titles_do_not_state_changed_values() {
    let text = "Scene(title: \"Fold, a = 0.5, b = −2\", problem: Equations(states: [(\"x\", \"a - b*x^2\")]),
        parameters: [(\"a\", 0.5), (\"b\", -2)], runs: [(name: \"r\", along: [(name: \"a\", low: 0, high: 1)])])";
    let titled = |name: &str, value: &str| {
        let mut scene = Scene::parse(text).unwrap();
        scene.set(name, value).unwrap();
        scene.title
    };
    assert_eq!(titled("b", "-3"), "Fold, a = 0.5");
    assert_eq!(titled("a", "0.7"), "Fold, b = −2");
    assert_eq!(titled("a", "0.5"), "Fold, a = 0.5, b = −2");
}

/// The unit of a monitor is the unit of the monitor's extremes along orbits.
#[test]
fn extremes_of_monitors_have_units() {
    let text = "Scene(title: \"t\", problem: Equations(states: [(\"x\", \"a*cos(t) - x\")], parameters: [(\"a\", 0.5)],
        monitors: [(\"depth\", \"1 - x\")], period: \"2*pi\", labels: [(\"depth\", \"depth\")], units: [(\"depth\", \"m\")]),
        runs: [(name: \"r\", along: [(name: \"a\", low: 0.5, high: 1)])])";
    let document = execute(&Scene::parse(text).unwrap(), None, &mut ()).document;
    assert_eq!(document.plot.label("max_depth"), "largest depth (m)");
    assert_eq!(document.plot.label("min_depth"), "smallest depth (m)");
}

/// The axis of a boundary-value problem has the name of its variable, and pictures of sweeps have the
/// labels of the model.
#[test]
fn labels_of_models_are_everywhere() {
    let problem = |more: &str| {
        let text = format!(
            "Scene(title: \"t\", problem: Boundary(states: [(\"u\", \"w\"), (\"w\", \"-a\")],
                conditions: [\"u(0)\", \"u(1)\"], length: \"1\", parameters: [(\"a\", 1)]{more}),
                runs: [(name: \"r\", along: [(name: \"a\", low: 1, high: 2)], marks: [(\"a\", 1.5)])])"
        );
        let document = execute(&Scene::parse(&text).unwrap(), None, &mut ()).document;
        figures(&[("t", &document)], &[], None, &[]).unwrap()[1].x_label.clone()
    };
    assert_eq!(problem(""), "t");
    assert_eq!(problem(", units: [(\"t\", \"m\")]"), "t (m)");
    assert_eq!(problem(", labels: [(\"t\", \"time\")]"), "time");
    let text =
        "Scene(title: \"t\", problem: Equations(states: [(\"x\", \"a*cos(t) - x\")],
        parameters: [(\"a\", 0.5)], period: \"2*pi\", labels: [(\"a\", \"gain\")], units: [(\"x\", \"mm\")]),
        sweeps: [(name: \"up\", order: up, over: [(name: \"a\", low: 0.1, high: 0.5, count: 3)])])";
    let scene = Scene::parse(text).unwrap();
    let sweeps =
        tangency::scene::sweep(&scene, "t", tangency::core::sweep::Part::WHOLE, None, &mut ());
    let drawn = figures(&[], &[sweeps.unwrap()], None, &[]).unwrap();
    assert_eq!([&*drawn[0].x_label, &*drawn[0].y_label], ["gain", "x (mm)"]);
}

/// `--x-range`, `--y-range` and `--title`.
#[test]
fn ranges_and_titles_are_chosen() {
    let document = Document::new("Pull-in", vec![example_branch()]);
    let render = |ends, title| {
        let documents = &[("a", &document)][..];
        let results = Results { documents, ends, title, ..Results::default() };
        String::from_utf8(results.render(Format::Svg).unwrap()).unwrap()
    };
    let whole = render([[None; 2]; 2], None);
    assert!(whole.contains("Pull-in") && whole.contains("\nLP\n"));
    let part = render([[Some(0.0), Some(0.1)], [None, Some(2.0)]], Some("A part"));
    assert!(part.contains("A part") && !part.contains("Pull-in"));
    assert!(part.contains("\n2.0\n") && part.contains("\n0.10\n"), "the axes end there");
    assert!(!part.contains("\nLP\n"), "the fold lies beyond");

    let folder = tempfile::tempdir().unwrap();
    let at = folder.path();
    document.save(at.join("a.ron")).unwrap();
    let more = ["--x-range", "..0.1", "--y-range", "-1..1", "--title", "A part"];
    let said = succeeds(at, &[&["plot", "a.ron"][..], &more].concat());
    assert_eq!(said, "a-x-range=..0.1-y-range=-1..1-title.svg\n");
    for (range, why) in [("5", "LOW..HIGH"), ("2..1", "must be below"), ("..", "LOW..HIGH")] {
        let output = tangency(at, &["plot", "a.ron", "--x-range", range]);
        assert!(failure(&output, 2).contains(why), "{range}");
    }
    refused(at, &["plot", "a.ron", "--title", "b", "--out", "a.csv"], &["--title"]);
}

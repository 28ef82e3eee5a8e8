//! Tables and diagrams: every special point is there, and line styles change exactly where they
//! should.

use tangency::core::continuation::{End, Point};
use tangency::core::failure::one_line;
use tangency::core::system::Kind;
use tangency::output::{
    Columns, Document, Figure, FigureError, Format, PAGE, PointTable, Render, Results, Screen,
    Selection, Series, Style, Symbol, csv, diagram, draw, example_branch, figures,
};
use tangency::scene::{Scene, execute};

fn document() -> Document {
    Document::new("Pull-in", vec![example_branch()])
}

#[test]
fn a_table_has_the_columns_of_all_branches_and_empty_cells() {
    let mut second = example_branch();
    second.name = "with, comma".into();
    second.monitors.push("width \"b\"".into());
    second.special.truncate(1);
    second.special[0].monitors.push(-1e-7 / 3.0);
    let table = r#"branch,label,kind,load,aspect_ratio,deflection,"width ""b""",error,unstable,converged,multiplicity
plate,1,EP,0,1.2,0,,0,0,true,1
plate,2,UZ,0.108375,1.2,0.15,,2.5e-15,0,true,1
plate,3,LP,0.148148148148148,1.2,0.333333333333333,,2.5e-15,0,true,1
plate,4,EP,0.032,1.2,0.8,,0,1,true,1
"with, comma",1,EP,0,1.2,0,-3.33333333333333e-8,0,0,true,1
"#;
    assert_eq!(csv(&[example_branch(), second]), table);
}

/// The itinerary of a branch, not the setting of a scene, which is empty if a simulation found the
/// orbit.
#[test]
fn a_table_has_the_itineraries_of_orbits() {
    let mut orbits = example_branch();
    orbits.itinerary = "2* free:hit".into();
    let mut document = Document::new("Impacts", vec![orbits]);
    document.settings.push(("itinerary".into(), String::new()));
    let columns = Columns::Named(&["label", "itinerary"]);
    let selection = Selection { kinds: &[Kind::LP], columns, ..Selection::default() };
    let table = PointTable::of(&[("a", &document)], selection).unwrap();
    assert_eq!(table.csv(), "label,itinerary\n3,2* free:hit\n");
}

#[test]
fn screen_lines_are_aligned() {
    let branch = example_branch();
    let screen = Screen::of(&branch, None);
    let lines =
        std::iter::once(screen.header()).chain(branch.special.iter().map(|p| screen.line(p)));
    let expected = [
        " label  kind  unstable                load          deflection",
        "     1  EP           0                   0                   0",
        "     2  UZ           0            0.108375                0.15",
        "     3  LP           0      0.148148148148      0.333333333333",
        "     4  EP           1               0.032                 0.8",
    ];
    assert_eq!(lines.collect::<Vec<_>>(), expected);
}

/// The style of each piece with its first and last point's `y`.
fn pieces(figure: &Figure) -> Vec<(Style, f64, f64)> {
    let ends = |s: &Series| (s.style, s.points[0][1], s.points[s.points.len() - 1][1]);
    figure.series.iter().map(ends).collect()
}

#[test]
fn a_curve_changes_from_solid_to_dashed_at_its_fold() {
    let figure = diagram(&[("a", &document())], None, &[]).unwrap();
    let fold = 1.0 / 3.0;
    assert_eq!(pieces(&figure), [(Style::Solid, 0.0, fold), (Style::Dashed, fold, 0.8)]);
    assert!(
        figure.series[0].points.contains(&[0.15 * (1.0_f64 - 0.15).powi(2), 0.15]),
        "the user's point"
    );
    let symbols: Vec<Symbol> = figure.marks.iter().map(|mark| mark.symbol).collect();
    assert_eq!(symbols, [Symbol::Ring, Symbol::TriangleDown, Symbol::Disc], "none at a bound");
}

#[test]
fn of_several_special_points_in_one_step_the_fold_decides() {
    for (order, kinds) in [("before", [Kind::UZ, Kind::LP]), ("behind", [Kind::LP, Kind::UZ])] {
        let mut document = document();
        let branch = &mut document.branches[0];
        for (point, (kind, u)) in
            branch.special[1..3].iter_mut().zip(kinds.iter().zip([0.325, 0.333]))
        {
            (point.kind, point.after, point.monitors[0]) = (*kind, 16, u);
        }
        let fold = if order == "before" { 0.333 } else { 0.325 };
        let figure = diagram(&[("a", &document)], None, &[]).unwrap();
        assert_eq!(pieces(&figure)[0], (Style::Solid, 0.0, fold), "{order}");
    }
}

#[test]
fn a_change_of_stability_without_a_special_point_is_drawn_all_the_same() {
    let mut document = document();
    document.branches[0].special.remove(2);
    let figure = diagram(&[("a", &document)], None, &[]).unwrap();
    assert_eq!(pieces(&figure), [(Style::Solid, 0.0, 0.34), (Style::Dashed, 0.34, 0.8)]);
}

#[test]
fn curves_of_special_points_are_drawn_in_their_two_parameters_without_stability() {
    let mut document = document();
    let branch = &mut document.branches[0];
    branch.condition = Some(Kind::LP);
    branch.released = vec!["load".into(), "aspect_ratio".into()];
    branch.points.iter_mut().for_each(|point: &mut Point| point.unstable = None);
    let figure = diagram(&[("a", &document)], None, &[]).unwrap();
    assert_eq!((&*figure.x_label, &*figure.y_label), ("load", "aspect_ratio"));
    assert_eq!((figure.series.len(), figure.styles.len()), (1, 0));
    assert_eq!(figure.names(), ["plate (fold curve)"]);
}

#[test]
fn several_documents_keep_distinct_names() {
    let (a, b) = (document(), document());
    let figure = diagram(&[("a", &a), ("b", &b), ("b", &b)], None, &[]).unwrap();
    assert_eq!(figure.names(), ["a", "b", "b′"]);
    let svg = draw(&[figure], PAGE).unwrap();
    assert!(svg.contains(">\na\n<") && svg.contains(">\nb′\n<"));
}

#[test]
fn the_plot_of_the_document_names_columns_and_units() {
    let mut document = document();
    document.plot.x = Some("deflection".into());
    document.plot.y = Some("load".into());
    document.plot.labels = vec![("load".into(), "load λ (1)".into())];
    let figure = diagram(&[("a", &document)], None, &[]).unwrap();
    assert_eq!((&*figure.x_label, &*figure.y_label), ("deflection", "load λ (1)"));
    let figure = diagram(&[("a", &document)], Some("aspect_ratio"), &[]).unwrap();
    assert_eq!((&*figure.x_label, &*figure.y_label), ("aspect_ratio", "load λ (1)"));
    draw(&[figure], PAGE).unwrap();
}

#[test]
fn unknown_columns_are_answered_with_those_that_exist() {
    let error = diagram(&[("a", &document())], Some("laod"), &[]).unwrap_err();
    assert_eq!(
        one_line(&error),
        "branch `plate`: unknown column `laod`; did you mean `load`? \
         Known: load, aspect_ratio, deflection"
    );
    let mut bare = document();
    bare.branches[0].monitors.clear();
    let error = diagram(&[("a", &bare)], None, &[]).unwrap_err();
    assert!(matches!(error, FigureError::NoMonitor { .. }) && one_line(&error).contains("load"));
}

#[test]
fn what_cannot_be_drawn_is_refused() {
    assert!(matches!(draw(&[], PAGE), Err(FigureError::Empty { .. })));
    assert!(matches!(draw(&[Figure::new("a", "x", "y")], PAGE), Err(FigureError::Empty { .. })));
    let draw_points = |points: &[[f64; 2]]| {
        let series = Series::new("curve", Style::Solid, points.iter().copied());
        draw(&[Figure::new("a", "x", "y").with(series)], PAGE)
    };
    let error = draw_points(&[[0.0, 1.0], [1.0, f64::NAN]]).unwrap_err();
    assert_eq!(
        error.to_string(),
        "the curve `curve` cannot be drawn: its point 1, (1, NaN), is not finite"
    );
    let error = draw_points(&[[0.0, f64::MAX], [1.0, -f64::MAX]]).unwrap_err();
    assert!(matches!(error, FigureError::TooWide { .. }));
    for extreme in [[0.0, 0.0], [1e300, 1e-300], [5e-324, -5e-324], [1e307, 1.0]] {
        draw_points(&[extreme]).unwrap();
        draw_points(&[extreme, [extreme[0], 0.0]]).unwrap();
    }
}

#[test]
fn a_drawing_names_axes_styles_and_kinds_and_escapes_what_it_must() {
    let mut document = document();
    document.title = "a < b & \"c\"".into();
    document.plot.labels = vec![("load".into(), "load λ (V²)".into())];
    let figure = diagram(&[("a", &document)], None, &[]).unwrap();
    let svg = draw(std::slice::from_ref(&figure), PAGE).unwrap();
    for text in [
        "a &lt; b &amp;",
        "load λ (V²)",
        "deflection",
        "unstable",
        "LP\u{2002}fold",
        "deflection = 0.15",
    ] {
        assert!(svg.contains(text), "{text}");
    }
    assert!(!svg.contains("NaN") && !svg.contains("inf"));
    let grid = draw(&vec![figure; 5], PAGE).unwrap();
    assert!(grid.starts_with("<svg width=\"170mm\""), "{}", &grid[..60]);
}

/// An orbit of a mesh with two profiles, at a period doubling and at the end.
fn orbits() -> Document {
    let mut document = document();
    let circle: Vec<[f64; 2]> =
        (0..=20).map(|k| f64::from(k) * 0.314).map(|t| [t.cos(), t.sin()]).collect();
    let profile = |along: &str, name: &str| tangency::core::problem::Profile {
        name: name.into(),
        along: along.into(),
        points: circle.clone(),
    };
    for point in &mut document.branches[0].special {
        point.mesh = vec![0.0, 1.0];
        point.profiles = vec![profile("time", "x"), profile("x", "y")];
    }
    let branch = &mut document.branches[0];
    branch.special[1].kind = Kind::PD;
    branch.monitors.extend(["period".into(), "max_x".into()]);
    let extended = |monitors: &mut Vec<f64>| monitors.extend([6.5, monitors[0]]);
    branch.points.iter_mut().for_each(|point| extended(&mut point.monitors));
    branch.special.iter_mut().for_each(|point| extended(&mut point.monitors));
    document
}

#[test]
fn profiles_of_orbits_are_those_of_special_points_and_of_the_end() {
    let document = orbits();
    let drawn = figures(&[("a", &document)], &[], None, &[]).unwrap();
    assert_eq!(drawn.len(), 3, "the diagram, a time history, a phase portrait");
    assert_eq!([&*drawn[2].x_label, &*drawn[2].y_label], ["x", "y"]);
    let names =
        ["plate/2 PD, load = 0.108375", "plate/3 LP, load = 0.148148", "plate/4 EP, load = 0.032"];
    assert_eq!(drawn[2].names(), names);
    let styles: Vec<Style> = drawn[2].series.iter().map(|series| series.style).collect();
    assert_eq!(styles, [Style::Solid, Style::Solid, Style::Dashed]);
}

/// Resets are dotted, and a history whose phase is free begins after one.
#[test]
fn resets_are_dotted() {
    let mut document = orbits();
    let times = [0.0, 0.5, 1.0, 1.0, 1.5, 2.0];
    let height = [1.0, 0.75, 0.0, 0.0, 0.75, 1.0];
    let velocity = [0.0, -1.0, -2.0, 2.0, 1.0, 0.0];
    let profile =
        |along: &str, name: &str, a: [f64; 6], b: [f64; 6]| tangency::core::problem::Profile {
            name: name.into(),
            along: along.into(),
            points: a.into_iter().zip(b).map(|(a, b)| [a, b]).collect(),
        };
    let branch = &mut document.branches[0];
    for point in &mut branch.special {
        point.profiles = vec![
            profile("time", "h", times, height),
            profile("time", "v", times, velocity),
            profile("h", "v", height, velocity),
        ];
    }
    let mut period = branch.unknowns[0].clone();
    period.name = "period".into();
    branch.unknowns.push(period);
    document.plot.points = vec!["2".into()];
    let drawn = figures(&[("a", &document)], &[], Some("load"), &["period"]);
    assert_eq!(drawn.unwrap().len(), 1);
    let drawn = figures(&[("a", &document)], &[], None, &[]).unwrap();
    let of = |x: &str, y: &str| {
        let figure = drawn.iter().find(|it| it.x_label == x && it.y_label == y).unwrap();
        let series = figure.series.iter().map(|series| (series.style, series.points.clone()));
        (series.collect::<Vec<_>>(), figure.styles.iter().any(|(style, _)| *style == Style::Dotted))
    };
    let arc = vec![[0.0, 0.0], [0.5, 0.75], [1.0, 1.0], [1.5, 0.75], [2.0, 0.0], [2.0, 0.0]];
    assert_eq!(of("time", "h"), (vec![(Style::Solid, arc)], false));
    let (pieces, said) = of("time", "v");
    let falls = vec![[0.0, 2.0], [0.5, 1.0], [1.0, 0.0], [1.5, -1.0], [2.0, -2.0]];
    assert_eq!(
        pieces[..2],
        [(Style::Solid, falls), (Style::Dotted, vec![[2.0, -2.0], [2.0, 2.0]]),]
    );
    assert!(said);
    let (pieces, _) = of("h", "v");
    assert_eq!(pieces[1], (Style::Dotted, vec![[0.0, -2.0], [0.0, 2.0]]));
    assert_eq!(pieces.iter().map(|(_, points)| points.len()).collect::<Vec<_>>(), [3, 2, 3]);
}

#[test]
fn profiles_and_points_are_chosen_by_name() {
    let mut document = orbits();
    document.plot.profiles = vec![("x".into(), "y".into())];
    document.plot.points = vec!["plate/1".into(), "4".into()];
    let drawn = figures(&[("a", &document)], &[], None, &[]).unwrap();
    assert_eq!(drawn.len(), 2);
    assert_eq!(drawn[1].names(), ["plate/1 EP, load = 0", "plate/4 EP, load = 0.032"]);
    document.plot.profiles = vec![("x".into(), "z".into())];
    let error = figures(&[("a", &document)], &[], None, &[]).unwrap_err();
    assert!(matches!(error, FigureError::UnknownProfile(_)), "{error:?}");
    assert!(one_line(&error).contains("`z along x`"), "{error}");
    // A kind selects all points of this kind.
    document.plot.profiles = vec![("x".into(), "y".into())];
    for kind in ["EP", "plate/ep"] {
        document.plot.points = vec![kind.into()];
        let drawn = figures(&[("a", &document)], &[], None, &[]).unwrap();
        assert_eq!(drawn[1].names(), ["plate/1 EP, load = 0", "plate/4 EP, load = 0.032"]);
    }
    document.plot.points = vec!["HOM".into()];
    let error = figures(&[("a", &document)], &[], None, &[]).unwrap_err();
    assert!(one_line(&error).contains("`HOM` is not of the form LABEL"), "{error}");
    document.plot.points = vec!["9".into()];
    let error = figures(&[("a", &document)], &[], None, &[]).unwrap_err();
    assert!(matches!(error, FigureError::UnknownPoint(_)), "{error:?}");
}

#[test]
fn more_profiles_than_can_be_read_are_left_out_ends_first() {
    let mut document = orbits();
    let branch = &mut document.branches[0];
    let middle = branch.special[2].clone();
    for label in 5..=12 {
        let mut point = middle.clone();
        point.label = label;
        point.monitors[2] += 0.04 * (label as f64 - 4.0);
        branch.special.insert(3, point);
    }
    let drawn = figures(&[("a", &document)], &[], None, &[]).unwrap();
    assert_eq!(drawn[2].series.len(), 3);
    assert!(drawn[2].names().iter().all(|name| !name.contains("EP")));
    for point in &mut document.branches[0].special[3..11] {
        point.monitors[2] = 1.0 / 3.0;
    }
    let drawn = figures(&[("a", &document)], &[], None, &[]).unwrap();
    assert!(drawn[2].names()[2].contains("EP"), "orbits that look alike count once");
}

/// A point that has not converged may not exist.
#[test]
fn doubtful_points_are_marked_and_change_nothing_else() {
    let mut document = orbits();
    let fold = &mut document.branches[0].special[2];
    (fold.converged, fold.monitors[0]) = (false, 20.0);
    let drawn = figures(&[("a", &document)], &[], None, &[]).unwrap();
    let mark = drawn[0].marks.iter().find(|mark| mark.label == "LP?").unwrap();
    assert_eq!((mark.symbol, &*mark.meaning), (Symbol::Doubtful, "not converged"));
    assert_eq!(drawn[0].extent().unwrap()[1], [0.0, 0.8]);
    assert!(drawn[2].names().iter().all(|name| !name.contains("LP")));
    assert!(!draw(&drawn[..1], PAGE).unwrap().contains("LP?"), "it lies outside");
}

/// Hopf's normal form: a picture that nobody describes.
#[test]
fn the_first_picture_has_the_first_state_the_period_and_a_few_orbits() {
    let text = r#"Scene(title: "Hopf", problem: Equations(states: [
            ("x", "x*(r - x^2 - y^2) - y*(1 + x^2)"), ("y", "y*(r - x^2 - y^2) + x*(1 + x^2)")]),
        parameters: [("r", -0.5)], runs: [
            (name: "rest", set: [("solution", "equilibrium")], along: [(name: "r", low: -0.5, high: 1)]),
            (name: "cycles", start: From(run: "rest", kind: HB, switch: true), along: [(name: "r", low: -0.5, high: 1)])])"#;
    let document = execute(&Scene::parse(text).unwrap(), None, &mut ()).document;
    let drawn = figures(&[("hopf", &document)], &[], None, &[]).unwrap();
    let labels: Vec<[&str; 2]> =
        drawn.iter().map(|figure| [&*figure.x_label, &*figure.y_label]).collect();
    assert_eq!(labels, [["r", "x"], ["r", "period"], ["time", "x"], ["x", "y"]]);
    let cycles = drawn[0].series.iter().filter(|series| series.name == "cycles");
    let amplitudes = cycles.map(|series| series.points[series.points.len() - 1][1]);
    assert_eq!(amplitudes.map(f64::signum).collect::<Vec<_>>(), [1.0, -1.0]);
    assert!(drawn[1].series.iter().all(|it| it.name == "cycles" || it.points.is_empty()));
    // The first orbit has the colour of its branch.
    let [rest, orbit, ..] = drawn[2].names()[..] else { panic!("no orbit") };
    assert_eq!((drawn[0].names(), rest), (vec!["rest", "cycles"], "rest"));
    assert!(orbit.starts_with("cycles/") && orbit == drawn[3].series[0].name, "{orbit}");
    let history = &drawn[2].series[0].points;
    let largest = history.iter().map(|at| at[1]).fold(f64::MIN, f64::max);
    assert_eq!(history[0], [0.0, largest], "it begins at its crest");
    assert!(history.windows(2).all(|pair| pair[0][0] < pair[1][0]));
    // Columns that some branches lack, and several of them.
    let period = diagram(&[("hopf", &document)], None, &["period"]).unwrap();
    assert!(period.series.iter().any(|series| !series.points.is_empty()));
    let both = diagram(&[("hopf", &document)], None, &["max_x", "min_y"]).unwrap();
    assert_eq!(both.y_label, "max_x, min_y");
    assert!(diagram(&[("hopf", &document)], None, &["max_z"]).is_err());
    assert!(diagram(&[("hopf", &document)], None, &["x", "perod"]).is_err());
    // Orbits that are not drawn have no panel.
    let mut rest = document.clone();
    rest.plot.curves = vec!["rest".into()];
    let drawn = figures(&[("hopf", &rest)], &[], None, &[]).unwrap();
    assert!(drawn.iter().all(|figure| figure.y_label != "period"));
}

/// Curves of special points are drawn in their two parameters alone, wherever these are axes.
#[test]
fn curves_of_special_points_have_a_panel() {
    let mut document = document();
    let mut folds = document.branches[0].clone();
    (folds.name, folds.condition) = ("folds".into(), Some(Kind::LP));
    folds.released = vec!["load".into(), "aspect_ratio".into()];
    document.branches.push(folds);
    let drawn = figures(&[("a", &document)], &[], None, &[]).unwrap();
    let labels: Vec<[&str; 2]> =
        drawn.iter().map(|figure| [&*figure.x_label, &*figure.y_label]).collect();
    assert_eq!(labels, [["load", "deflection"], ["load", "aspect_ratio"]]);
    for (figure, name) in drawn.iter().zip(["plate", "folds (fold curve)"]) {
        assert!(figure.series.iter().all(|it| (it.name == name) != it.points.is_empty()));
    }
    document.plot.panels = vec![("aspect_ratio".into(), "load".into())];
    assert_eq!(figures(&[("a", &document)], &[], None, &[]).unwrap().len(), 2);
}

/// Documents are named by the settings in which they differ.
#[test]
fn documents_are_named_by_their_settings() {
    let documents = ["0.8", "1.5"].map(|c| {
        let mut document = document();
        let setting = |name: &str, value: &str| (name.to_string(), value.to_string());
        document.settings = vec![setting("c", c), setting("k", "2"), setting("load", c)];
        document
    });
    let named = documents.each_ref().map(|document| ("stop", document));
    let results = Results { documents: &named, ..Results::default() };
    let svg = String::from_utf8(results.render(Format::Svg).unwrap()).unwrap();
    assert!(svg.contains("c = 0.8") && svg.contains("c = 1.5"));
    assert!(!svg.contains("stop") && !svg.contains("load = "), "what varies names nothing");
}

#[test]
fn a_start_on_a_special_point_of_another_branch_has_no_mark() {
    let mut document = document();
    let mut second = document.branches[0].clone();
    second.name = "second".into();
    let fold = second.special.remove(2);
    second.special.truncate(1);
    second.special[0].parameters = fold.parameters;
    second.special[0].monitors = fold.monitors;
    second.ends = [End::Start, End::Start];
    document.branches.push(second);
    let figure = diagram(&[("a", &document)], None, &[]).unwrap();
    assert_eq!(figure.marks.len(), 3);
}

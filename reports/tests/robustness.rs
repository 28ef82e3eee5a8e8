//! Promise: each failure of this library is reported by a typed error or an error estimate, or
//! handed over to a method that succeeds; only naive methods are silently wrong. The page of
//! robustness maps is what the command prints.

use std::path::Path;
use std::process::Command;
use std::sync::LazyLock;
use tangency_reports::robustness::{MAPS, map};
use tangency_reports::{Cell, Class, Region, Report, RobustnessMap, Tried};

/// All maps.
static NOW: LazyLock<Vec<RobustnessMap>> = LazyLock::new(|| MAPS.iter().map(map).collect());

fn named(name: &str) -> &'static RobustnessMap {
    let name = format!("robustness-{name}");
    NOW.iter().find(|map| map.name == name).expect("a map")
}

/// A panel of one method.
fn only(map: &'static RobustnessMap, panel: usize) -> &'static Tried {
    let Region { methods, title, .. } = &map.panels[panel];
    assert_eq!(methods.len(), 1, "{title}");
    &methods[0]
}

/// How often a method of a panel ends in a class.
fn of_class(map: &RobustnessMap, tried: &Tried, class: Class) -> usize {
    tried.cells.iter().filter(|cell| map.outcomes[cell.outcome].class == class).count()
}

/// The outcome of a panel's only method at a place is this one.
#[track_caller]
fn ends(map: &'static RobustnessMap, panel: usize, at: [f64; 2], outcome: &str) {
    let found = map.at(panel, &only(map, panel).name, at).expect("a cell");
    assert_eq!(found.name, outcome, "{}, panel {panel} at {at:?}", map.name);
}

/// The same of a method in a row.
#[track_caller]
fn ends_in_row(map: &'static RobustnessMap, panel: usize, method: &str, x: f64, outcome: &str) {
    let found = map.at(panel, method, [x, 0.0]).expect("a cell");
    assert_eq!(found.name, outcome, "{}, {method} at {x}", map.name);
}

#[test]
fn no_method_of_the_library_is_silently_wrong() {
    for map in &*NOW {
        for tried in map.panels.iter().flat_map(|panel| &panel.methods).filter(|t| !t.naive) {
            for cell in &tried.cells {
                let outcome = &map.outcomes[cell.outcome];
                assert!(
                    outcome.class != Class::Silent,
                    "{}, {}, {cell:?}: {}",
                    map.name,
                    tried.name,
                    outcome.name
                );
            }
            // The message of each outcome is kept once.
            for (k, outcome) in map.outcomes.iter().enumerate() {
                let mut cells = tried.cells.iter().filter(|cell| cell.outcome == k);
                let message = cells.next().map(|cell| cell.message.as_deref().unwrap_or_default());
                let expected = outcome.class == Class::Reported;
                assert!(
                    message.is_none_or(|m| m.is_empty() != expected),
                    "{}, {}",
                    map.name,
                    outcome.name
                );
                assert!(cells.all(|cell| cell.message.is_none()));
            }
        }
    }
}

#[test]
fn naive_methods_are_silently_wrong() {
    for (name, panel, method) in [
        ("newton", 0, "Newton's formula at a fixed load"),
        ("steps", 0, "Steps of fixed length, without step control"),
        ("events", 0, "ends of steps"),
        ("events", 0, "8192 parts"),
        ("chatter", 3, "Steps of fixed length"),
        ("polynomials", 0, "powers, 7 digits"),
        ("polynomials", 0, "powers, 16 digits"),
        ("quadrature", 0, "Gauss points"),
    ] {
        let map = named(name);
        let tried = map.panels[panel].methods.iter().find(|tried| tried.name == method);
        let tried = tried.unwrap_or_else(|| panic!("{method}"));
        assert!(tried.naive && of_class(map, tried, Class::Silent) > 10, "{name}, {method}");
    }
}

#[test]
fn newton_stagnates_beyond_the_fold_and_hands_over_to_arclength() {
    let newton = named("newton");
    // Before the fold, from rest, at the load.
    for panel in [0, 1, 3] {
        ends(newton, panel, [0.75, 0.05], "the stable deflection");
        ends(newton, panel, [0.75, 0.65], "the unstable deflection");
    }
    ends(newton, 2, [0.75, 0.05], "a point of the branch");
    // Behind the electrode there is a third root, which is no deflection.
    ends(newton, 0, [0.91, 1.25], "a deflection beyond the electrode");
    ends(newton, 1, [0.91, 1.25], "left the domain");
    ends(newton, 3, [0.91, 1.25], "continuation from rest finds both solutions");
    // Beyond the fold there is no deflection at all.
    ends(newton, 1, [1.05, 0.35], "stagnation");
    ends(newton, 3, [1.05, 0.35], "the fold comes before this load");
    ends(newton, 2, [1.05, 0.35], "a point of the branch");
    let held = only(newton, 1);
    assert!(held.cells.iter().all(|cell| {
        let found = newton.outcomes[cell.outcome].class;
        cell.x < 1.0 || found == Class::Reported
    }));
}

#[test]
fn steps_do_not_leave_their_branch() {
    let steps = named("steps");
    // The step that scenes have by default, and a bend a hundred times as sharp.
    ends(steps, 0, [-3.0, -1.0], "jumped to the other branch");
    ends(steps, 1, [-3.0, -1.0], "no step small enough");
    ends(steps, 2, [-3.0, -1.0], "followed");
    let adapted = only(steps, 2);
    // Branches nearer than that count as crossing, unless a step has seen them turn.
    let (near, far): (Vec<_>, Vec<_>) = adapted.cells.iter().partition(|cell| cell.x < -3.5);
    let found = |cell: &Cell| steps.outcomes[cell.outcome].name.as_str();
    assert!(far.iter().all(|cell| found(cell) == "followed"));
    let crossed = near.iter().filter(|cell| found(cell) == "reported as a branch point").count();
    let followed = near.iter().filter(|cell| found(cell) == "followed").count();
    assert_eq!((crossed + followed, crossed > followed), (near.len(), true), "{crossed}");
    let messages = only(steps, 1).cells.iter().filter_map(|cell| cell.message.as_deref());
    assert!(messages.into_iter().any(|message| message.contains("another branch")));
}

#[test]
fn segments_and_collocation_go_where_shooting_ends() {
    let shooting = named("shooting");
    ends_in_row(shooting, 0, "shooting", 5.0, "nine digits");
    ends_in_row(shooting, 0, "shooting", 20.0, "deviations grow too far");
    for method in ["4 segments", "8 segments", "16 segments", "collocation"] {
        let tried = shooting.panels[0].methods.iter().find(|tried| tried.name == method).unwrap();
        assert_eq!(of_class(shooting, tried, Class::Right), tried.cells.len(), "{method}");
    }
    let single = &shooting.panels[0].methods[0];
    assert!(shooting.count(single, "digits lost, by its own estimate") > 0);
}

#[test]
fn crossings_are_found_up_to_the_touch() {
    let events = named("events");
    for x in [-14.0, -10.0, -6.0, -1.0] {
        ends_in_row(events, 0, "hybrid motion", x, "both crossings");
        let by_mesh = if x > -2.0 { "both crossings" } else { "crossings missed" };
        ends_in_row(events, 0, "16 parts", x, by_mesh);
    }
    ends_in_row(events, 0, "largest value", -6.0, "the height beyond the level");
    ends_in_row(events, 0, "largest value", -14.0, "no crossing, to the tolerance of the flow");
    ends_in_row(events, 1, "clear of the stop", -2.0, "the grazing");
    ends_in_row(events, 1, "through the stop", -2.0, "refused: the orbit passes through the stop");
}

#[test]
fn infinitely_many_impacts_are_completed_or_refused() {
    let chatter = named("chatter");
    for x in [-2.0, -1.0, -0.5] {
        for panel in [0, 1, 2] {
            ends(chatter, panel, [x, 0.5], "impacts one by one");
        }
        ends(chatter, 0, [x, 1.25], "impacts completed in closed form, then rest");
        ends(chatter, 1, [x, 1.25], "accumulation without a mode for rest");
        ends(chatter, 2, [x, 1.25], "time stands still");
    }
    // Without restitution nothing accumulates: the first impact is the last.
    ends(chatter, 1, [0.0, 1.25], "time stands still");
}

#[test]
fn recurrences_keep_digits_and_powers_lose_them() {
    let polynomials = named("polynomials");
    for order in [5.0, 30.0, 60.0] {
        let all = "four fifths of the digits, or more";
        ends_in_row(polynomials, 0, "functions of plates", order, all);
        ends_in_row(polynomials, 0, "recurrence, 7 digits", order, all);
    }
    ends_in_row(polynomials, 0, "powers, 16 digits", 30.0, "less than half of the digits");
    ends_in_row(polynomials, 0, "powers, 16 digits", 50.0, "no digit left");
    ends_in_row(polynomials, 0, "powers, 7 digits", 30.0, "no digit left");
}

#[test]
fn plates_end_before_their_load_is_no_longer_integrated() {
    let quadrature = named("quadrature");
    ends(quadrature, 0, [-0.5, 20.0], "nine digits");
    ends(quadrature, 0, [-2.0, 10.0], "fewer than six digits");
    for tried in &quadrature.panels[1].methods {
        for cell in &tried.cells {
            let ended =
                quadrature.outcomes[cell.outcome].name == "the branch ends before the electrode";
            // The model ends at 0.96 of the gap.
            assert_eq!(ended, cell.x < 0.04_f64.log10(), "{}, {cell:?}", tried.name);
        }
    }
}

#[test]
fn stiff_fields_are_refused_and_go_to_the_implicit_method() {
    let stiffness = named("stiffness");
    for panel in [0, 1] {
        ends(stiffness, panel, [6.0, -6.0], "refused as stiff");
        ends(stiffness, panel, [2.0, -6.0], "done, by more evaluations than Rodas5P");
    }
    ends(stiffness, 3, [6.0, -6.0], "done by Rodas5P after order 8 failed");
    let implicit = only(stiffness, 2);
    assert_eq!(stiffness.count(implicit, "done"), implicit.cells.len());
}

/// On another machine, rounding may decide otherwise in a cell of a hundred.
#[test]
fn the_page_is_what_the_command_has_printed() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../docs/evidence");
    let page = std::fs::read_to_string(folder.join("speed-and-accuracy.md")).unwrap();
    for (entry, now) in MAPS.iter().zip(&*NOW) {
        let path = folder.join("measured").join(format!("robustness-{}.ron", entry.name));
        let then = RobustnessMap::parse(&std::fs::read_to_string(path).unwrap()).unwrap();
        assert!(page.contains(&then.summary()), "{}: the page has another table", entry.name);
        let places = |map: &RobustnessMap| -> Vec<(String, [f64; 2], String)> {
            let tried = map.panels.iter().flat_map(|panel| &panel.methods);
            let cells = tried.flat_map(|tried| tried.cells.iter().map(move |cell| (tried, cell)));
            let named = |(tried, cell): (&Tried, &tangency_reports::Cell)| {
                let outcome = map.outcomes[cell.outcome].name.clone();
                (tried.name.clone(), [cell.x, cell.y], outcome)
            };
            cells.map(named).collect()
        };
        let (then, now) = (places(&then), places(now));
        assert_eq!(then.len(), now.len(), "{}", entry.name);
        let other = then.iter().zip(&now).filter(|(then, now)| then != now).count();
        assert!(100 * other <= then.len(), "{}: {other} cells of {}", entry.name, then.len());
    }
}

#[test]
fn the_command_saves_maps_and_explains_itself() {
    let folder = tempfile::tempdir().unwrap();
    let tangency = |arguments: &[&str]| {
        let mut command = Command::new(env!("CARGO_BIN_EXE_tangency-reports"));
        command.current_dir(folder.path()).args(arguments).output().unwrap()
    };
    let listed = tangency(&["robustness"]);
    let names = String::from_utf8(listed.stdout).unwrap();
    assert!(MAPS.iter().all(|entry| names.contains(entry.name)), "{names}");
    let page = folder.path().join("page.md");
    std::fs::write(&page, "Before.\n<!-- robustness-newton -->\n<!-- end -->\nAfter.\n").unwrap();
    let done = tangency(&["robustness", "newton", "--out", "here", "--page", "page.md"]);
    assert!(done.status.success(), "{done:?}");
    let written =
        ["svg", "md", "ron"].map(|e| folder.path().join(format!("here/robustness-newton.{e}")));
    assert!(written.iter().all(|path| path.exists()));
    let page = std::fs::read_to_string(&page).unwrap();
    assert!(page.contains("### Newton's formula") && page.ends_with("<!-- end -->\nAfter.\n"));
    let svg = std::fs::read_to_string(&written[0]).unwrap();
    assert!(svg.contains("reported: stagnation") && svg.contains("guess of the deflection"));
    let unknown = tangency(&["robustness", "newtno"]);
    let message = String::from_utf8(unknown.stderr).unwrap();
    assert!(
        message.contains("did you mean `newton`?")
            && message.contains("`tangency-reports robustness`")
    );
}

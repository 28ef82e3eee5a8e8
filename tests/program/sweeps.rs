//! `tangency sweep` and `tangency merge` as a user meets them: files that others read,
//! interruption, parts.

use crate::common::close;
use crate::program::command::{bytes, failure, tangency};
use crate::program::scenarios::{built_in, traced};
use std::collections::BTreeMap;
use std::f64::consts::{FRAC_PI_2, TAU};
use std::num::NonZeroUsize;
use std::path::Path;
use std::process::{Child, Command, Output, Stdio};
use std::time::Duration;
use tangency::core::failure::one_line;
use tangency::core::problem::Measure;
use tangency::core::scalar::Scalar;
use tangency::core::sweep::{Order, Part};
use tangency::core::system::Kind;
use tangency::hybrid_system;
use tangency::output::{MergeError, Row, Sweeps, figures, merge};
use tangency::scene::{BUILT_IN, Catalogue, Grid, Scene, SceneError, sweep as swept};

/// A sweep of many short runs.
const SCENE: &str = r#"Scene(
    title: "Chaos", problem: Mita(), parameters: [("frequency", 0.5)],
    plot: (y: "displacement_range", swept: [("voltage", "front.velocity"), ("voltage", "exponent")]),
    sweeps: [
        (name: "up", order: up, strands: 3, over: [(name: "voltage", low: 0.3, high: 0.7, count: 31)],
         search: (transient: 40, recorded_periods: 20, lyapunov_periods: 40), measures: ["displacement_range"]),
        (name: "starts", over: [(name: "displacement", low: -0.3, high: 0.3, count: 3), (name: "velocity", low: 0, high: 0.2, count: 3)],
         set: [("voltage", "0.2")], search: (transient: 200, recorded_periods: 40, lyapunov_periods: 0)),
    ],
)"#;

fn folder() -> tempfile::TempDir {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("chaos.ron"), SCENE).unwrap();
    folder
}

/// On one thread or two, killed in the middle and resumed, or in parts that are merged: the same
/// bytes.
#[test]
fn a_sweep_has_the_same_bytes_however_it_was_done() {
    let folder = folder();
    let run = |out: &str, more: &[&str]| {
        let output =
            tangency(folder.path(), &[&["sweep", "chaos.ron", "--out", out], more].concat());
        assert!(output.status.success(), "{output:?}");
    };
    run("one", &["--threads", "1"]);
    let whole = bytes(folder.path(), "one/chaos.npz");
    run("two", &["--threads", "2"]);
    assert!(bytes(folder.path(), "two/chaos.npz") == whole);
    for number in ["1/3", "2/3", "3/3"] {
        run("parts", &["--part", number]);
    }
    let parts = [1, 2, 3].map(|number| format!("parts/chaos.part-{number}-of-3.npz"));
    let arguments = ["merge", "--out", "merged", &parts[0], &parts[2], &parts[1]];
    let output = tangency(folder.path(), &arguments);
    assert!(output.status.success(), "{output:?}");
    assert!(bytes(folder.path(), "merged/chaos.npz") == whole);
    // A part alone is no whole.
    let output = tangency(folder.path(), &["merge", "--out", "alone", &parts[0]]);
    assert!(failure(&output, 1).contains("are missing in all parts"), "{output:?}");
}

/// Long enough to be ended between its first save and its end.
fn long_folder() -> tempfile::TempDir {
    let folder = tempfile::tempdir().unwrap();
    let long = SCENE.replace("transient: 40", "transient: 1500");
    std::fs::write(folder.path().join("chaos.ron"), long).unwrap();
    folder
}

const LONG: [&str; 4] = ["sweep", "chaos.ron", "--checkpoint", "0.01"];

/// A sweep into the folder `early` that `end` ends after its first save.
fn ended_early(folder: &Path, end: impl FnOnce(&mut Child)) -> Output {
    let mut child = Command::new(env!("CARGO_BIN_EXE_tangency"))
        .current_dir(folder)
        .args(LONG)
        .args(["--out", "early"])
        .stdout(Stdio::null())
        .stderr(Stdio::piped())
        .spawn()
        .unwrap();
    let saved = folder.join("early/chaos.npz");
    let mut waited = 0;
    while !saved.exists() && waited < 6000 {
        std::thread::sleep(Duration::from_millis(10));
        waited += 1;
    }
    end(&mut child);
    let output = child.wait_with_output().unwrap();
    let begun = Sweeps::load(&saved).unwrap();
    let done: usize = begun.sweeps.iter().map(|sweep| sweep.rows.len()).sum();
    assert!(done > 0 && done < 40, "{done} runs are done");
    output
}

/// The same command does the rest, to the bytes of a sweep that was not ended.
fn is_resumed(folder: &Path) {
    for out in ["early", "whole"] {
        let output = tangency(folder, &[&LONG[..], &["--out", out]].concat());
        assert!(output.status.success(), "{output:?}");
    }
    assert!(bytes(folder, "early/chaos.npz") == bytes(folder, "whole/chaos.npz"));
}

/// A sweep that is killed leaves a file with whole runs.
#[test]
fn a_killed_sweep_is_resumed() {
    let folder = long_folder();
    ended_early(folder.path(), |child| child.kill().unwrap());
    is_resumed(folder.path());
}

/// Schedulers send SIGTERM before they kill: the program saves what is done, and says so.
#[cfg(unix)]
#[test]
fn a_terminated_sweep_is_saved_and_resumed() {
    let folder = long_folder();
    let output = ended_early(folder.path(), |child| {
        let id = child.id().to_string();
        assert!(Command::new("kill").args(["-TERM", &id]).status().unwrap().success());
    });
    assert!(
        failure(&output, 1).contains("all results computed before the interruption are saved"),
        "{output:?}"
    );
    is_resumed(folder.path());
}

/// Independent runs divide evenly into any number of parts; strands go on being dealt from sweep to
/// sweep, and where there are too few of them, `--part` says so and how many would do.
#[test]
fn parts_are_even_or_say_why_not() {
    let folder = tempfile::tempdir().unwrap();
    let over = "over: [(name: \"amplitude\", low: 1, high: 2, count: 8)]";
    let search = "search: (transient: 2, recorded_periods: 1, lyapunov_periods: 0)";
    let write = |name: &str, sweeps: &[(&str, &str)]| {
        let one =
            |(name, order): &(&str, &str)| format!("(name: \"{name}\", {order}{over}, {search})");
        let sweeps: Vec<String> = sweeps.iter().map(one).collect();
        let scene = format!(
            "Scene(title: \"t\", problem: ImpactOscillator(), sweeps: [{}])",
            sweeps.join(", ")
        );
        std::fs::write(folder.path().join(format!("{name}.ron")), scene).unwrap();
    };
    write("grids", &[("one", ""), ("two", "")]);
    write("chains", &[("up", "order: up, strands: 2, "), ("down", "order: down, strands: 2, ")]);
    let part = |scene: &str, number: usize, of: usize, more: &[&str]| {
        let (file, part) = (format!("{scene}.ron"), format!("{number}/{of}"));
        let output = tangency(folder.path(), &[&["sweep", &file, "--part", &part], more].concat());
        assert!(output.status.success(), "{output:?}");
        let saved = folder.path().join(format!("out/{scene}.part-{number}-of-{of}.npz"));
        let runs = Sweeps::load(saved).unwrap().sweeps.iter().map(|sweep| sweep.rows.len()).sum();
        (runs, String::from_utf8(output.stdout).unwrap())
    };
    let parts = |scene: &str, of: usize, more: &[&str]| -> Vec<usize> {
        (1..=of).map(|number| part(scene, number, of, more).0).collect()
    };
    // 16 runs in 3, 5 and 20 parts: sizes differ by one at most.
    for of in [3, 5, 20] {
        let (sizes, (_, said)) = (parts("grids", of, &["--afresh"]), part("grids", 1, of, &[]));
        let [least, most] = [sizes.iter().min(), sizes.iter().max()].map(|size| *size.unwrap());
        assert!(sizes.iter().sum::<usize>() == 16 && most - least <= 1, "{of}: {sizes:?}");
        assert!(!said.contains("strands"), "{said}");
    }
    // Two sweeps of two strands are four: a part for each.
    assert_eq!(parts("chains", 4, &[]), [4; 4]);
    assert!(!part("chains", 1, 4, &[]).1.contains("strands"));
    // Eight parts need more of them. Half of the parts have nothing to do …
    let (_, said) = part("chains", 8, 8, &[]);
    assert!(
        said.contains("cannot be divided evenly into 8 parts: the largest part has 4 of 16 runs"),
        "{said}"
    );
    assert!(
        said.contains(
            "to reduce the largest part to 2 runs, add `--set strands=4` to the commands of all parts;"
        ),
        "{said}"
    );
    assert_eq!(parts("chains", 8, &[]), [4, 4, 4, 4, 0, 0, 0, 0]);
    let files: Vec<String> =
        (1..=8).map(|number| format!("out/chains.part-{number}-of-8.npz")).collect();
    let merge: Vec<&str> =
        ["merge", "--out", "merged"].into_iter().chain(files.iter().map(|file| &**file)).collect();
    let output = tangency(folder.path(), &merge);
    assert!(output.status.success(), "{output:?}");
    // … unless they do as the program says.
    assert_eq!(parts("chains", 8, &["--set", "strands=4", "--afresh"]), [2; 8]);
    assert!(!part("chains", 1, 8, &["--set", "strands=4"]).1.contains("divide"));
    // Where no run follows another there is nothing to set.
    let output = tangency(folder.path(), &["sweep", "grids.ron", "--set", "strands=4"]);
    assert!(failure(&output, 1).contains("`strands`"), "{output:?}");
}

/// What is in the file: columns of one length, names, and numbers that say what happened.
#[test]
fn the_file_says_what_happened() {
    let folder = folder();
    assert!(tangency(folder.path(), &["sweep", "chaos.ron"]).status.success());
    let sweeps = Sweeps::load(folder.path().join("out/chaos.npz")).unwrap();
    let [up, starts] = &sweeps.sweeps[..] else { panic!("{}", sweeps.sweeps.len()) };
    let columns: BTreeMap<&str, usize> =
        up.run_columns.iter().enumerate().map(|(k, name)| (name.as_str(), k)).collect();
    assert!(up.is_complete() && up.rows.len() == 31);
    let first = &up.rows[&0].values;
    assert_eq!(
        [first[columns["voltage"]], first[columns["periods"]], first[columns["front"]]],
        [0.3, 1.0, 1.0]
    );
    assert!(first[columns["exponent"]] < 0.0 && first[columns["failed"]] == 0.0);
    // One period: where it begins, an impact, and the rest of the frame.
    assert_eq!(up.rows[&0].points.len(), 3 * up.point_columns.len());
    // Two attractors at V = 0.2: without impacts, and with one.
    let counts: Vec<f64> = starts.rows.values().map(|row| row.values[5]).collect();
    assert!(counts.len() == 9 && counts.contains(&0.0) && counts.contains(&1.0), "{counts:?}");
    let svg = std::fs::read_to_string(folder.path().join("out/chaos.svg")).unwrap();
    assert!(svg.contains("Chaos") && svg.contains("front.velocity"));
    // The figure again, from the file alone.
    let output = tangency(folder.path(), &["plot", "out/chaos.npz", "--y", "exponent"]);
    assert!(output.status.success(), "{output:?}");
    let output = tangency(folder.path(), &["plot", "out/chaos.npz", "--y", "expnent"]);
    assert!(failure(&output, 1).contains("did you mean `exponent`"), "{output:?}");
}

#[test]
fn bad_input_is_explained() {
    let folder = folder();
    let fails = |arguments: &[&str], expected: &str| {
        let output = tangency(folder.path(), arguments);
        let message = failure(&output, 1);
        assert!(message.contains(expected), "{arguments:?}: {message}");
    };
    fails(&["sweep", "lure"], "has no sweeps");
    fails(&["trace", "mita-lyapunov"], "has no branches to trace");
    fails(&["sweep", "chaos.ron", "--set", "count=0"], "the count of an axis is 0");
    fails(&["sweep", "chaos.ron", "--set", "transiemt=5"], "did you mean `transient`?");
    fails(&["sweep", "chaos.ron", "--set", "transient_periods=5"], "did you mean `transient`?");
    let smooth =
        SCENE.replace("Mita()", "Lure()").replace("frequency", "alpha").replace("voltage", "alpha");
    let smooth = smooth.replace("displacement_range", "max_x");
    std::fs::write(folder.path().join("smooth.ron"), smooth).unwrap();
    fails(&["sweep", "smooth.ron"], "the system has no forcing");
    let over = "over: [(name: \"load\", low: 0, high: 1, count: 2)]";
    let fixed =
        format!("Scene(title: \"t\", problem: Plate(), sweeps: [(name: \"loads\", {over})])");
    std::fs::write(folder.path().join("static.ron"), fixed).unwrap();
    fails(&["sweep", "static.ron"], "only vector fields and hybrid systems can be simulated");
    let measured = SCENE.replace("\"displacement_range\"]", "\"displacment_range\"]");
    std::fs::write(folder.path().join("measured.ron"), measured).unwrap();
    fails(
        &["sweep", "measured.ron"],
        "unknown measure `displacment_range`\nhelp: did you mean `displacement_range`?",
    );
    assert!(tangency(folder.path(), &["sweep", "chaos.ron"]).status.success());
    fails(&["sweep", "chaos.ron", "--set", "frequency=0.49"], "are from another scene");
    std::fs::write(folder.path().join("broken.npz"), b"PK").unwrap();
    fails(&["plot", "broken.npz"], "not a file of sweeps");
    let whole = Sweeps::load(folder.path().join("out/chaos.npz")).unwrap();
    assert_eq!(merge(Vec::new()), Err(MergeError::Nothing));
    let (mut other, mut wrong) = (whole.clone(), whole.clone());
    other.scene.push(' ');
    assert_eq!(merge(vec![whole.clone(), other]), Err(MergeError::Different { number: 2 }));
    if let Some(row) = wrong.sweeps[0].rows.get_mut(&3) {
        row.values[2] = 9.0;
    }
    let contradiction = MergeError::Contradiction { number: 2, sweep: "up".into(), run: 3 };
    assert_eq!(merge(vec![whole, wrong]), Err(contradiction));
}

/// A sweep warns of runs whose transients have not decayed, unless their motion is chaotic.
#[test]
fn runs_that_do_not_settle_are_counted() {
    let folder = tempfile::tempdir().unwrap();
    let model = "Equations(states: [(\"x\", \"v\"), (\"v\", \"f*cos(t) - c*v - 4*x\")], parameters: [(\"f\", 1), (\"c\", 0.01)],
        period: \"2*pi\")";
    std::fs::write(folder.path().join("m.ron"), model).unwrap();
    let said = |transient: &str| {
        let search = ["--set", "recorded_periods=4", "--set", "lyapunov_periods=0", "--set"];
        let sweep = ["sweep", "m.ron", "--over", "x=1..2:3", "--out", transient];
        let output =
            tangency(folder.path(), &[&sweep[..], &search, &[transient, "--quiet"]].concat());
        assert!(output.status.success(), "{output:?}");
        String::from_utf8(output.stderr).unwrap()
    };
    let warning = "3 of 3 runs did not settle on a cycle: increase `transient` or `max_period`";
    assert!(said("transient=2").contains(warning));
    assert!(!said("transient=1000").contains("settle"));
}

/// What the bifurcation diagram at ω = 0.5 shows, by branches to their digits, by brute force to
/// those of its grid: P(2,2) ends where it grazes; chaos, where P(2,1) begins at its fold; P(3,1)
/// where it grazes; P(4,1) is stable from its doubling on; above V = 0.872 impacts are infinitely
/// many.
#[test]
fn the_diagram_shows_its_events() {
    let scene = built_in("mita-diagram");
    let document = traced(&scene);
    for (branch, kind, nth, voltage) in [
        ("P(2,2)", Kind::G, 0, 0.580285066),
        ("P(2,1)", Kind::LP, 1, 0.717839660),
        ("P(3,1)", Kind::G, 0, 0.834671331),
        ("P(4,1)", Kind::PD, 0, 0.839470615),
    ] {
        let branch = document.branch(branch).unwrap();
        let found = branch.of_kind(kind).nth(nth).unwrap();
        close(found.value(branch.column("voltage").unwrap()).unwrap(), voltage, 1e-9);
    }
    let at = |voltages: [f64; 2], count: usize, order: Order| {
        let mut scene = scene.clone();
        scene.sweeps.truncate(1);
        let sweep = &mut scene.sweeps[0];
        sweep.over[0] = Grid { name: "voltage".into(), low: voltages[0], high: voltages[1], count };
        (sweep.order, sweep.strands) = (order, 1);
        sweep.starts = vec![vec![("displacement".into(), 0.1), ("velocity".into(), -0.2)]];
        (sweep.search.transient, sweep.search.lyapunov_periods) = (1500, 0);
        let found = swept(&scene, "diagram", Part::WHOLE, None, &mut ()).unwrap();
        let table = found.sweeps[0].clone();
        let column = |name: &str| table.run_columns.iter().position(|known| known == name).unwrap();
        let columns = ["periods", "front", "accumulations"].map(column);
        [0, count - 1].map(|run| columns.map(|column| table.rows[&run].values[column]))
    };
    // Beyond its grazing the doubled orbit is gone; P(3,2), with three impacts in two periods, is
    // there before.
    let [before, beyond] = at([0.579, 0.5805], 2, Order::Up);
    assert_eq!((before[0], beyond[0], beyond[1]), (2.0, 2.0, 3.0));
    let [chaos, cycle] = at([0.7168, 0.7185], 2, Order::Up);
    assert_eq!((chaos[0], cycle[0], cycle[1]), (0.0, 1.0, 2.0));
    // P(7,2) is there before P(3,1) grazes: from below, motion is still on the latter.
    let [_, three] = at([0.82, 0.834], 29, Order::Up);
    let [four, _] = at([0.8396, 0.841], 2, Order::Up);
    assert_eq!((three[0], three[1], four[0], four[1]), (1.0, 3.0, 1.0, 4.0));
    let [many, infinite] = at([0.871, 0.8725], 2, Order::Anew);
    assert!(many[1].is_finite() && many[2] == 0.0, "{many:?}");
    assert_eq!((infinite[0], infinite[1], infinite[2]), (1.0, f64::INFINITY, 1.0));
}

/// Every built-in sweep runs, coarsely, and is drawn. Crises at two frequencies, where bisection at
/// one of them has V = 0.2353 (`tests/hybrid/attractors.rs`), as dots; where there is none, a run
/// says so.
#[test]
fn crises_are_found_by_sweeps() {
    let text = "Scene(title: \"Crises\", problem: Mita(), plot: (x: \"frequency\", y: \"voltage\"), sweeps: [
        (name: \"crisis\", over: [(name: \"frequency\", low: 0.45, high: 0.455, count: 2)],
         starts: [[(\"displacement\", 0.1), (\"velocity\", -0.2)]], search: (transient: 600, recorded_periods: 50, lyapunov_periods: 0),
         crisis: (name: \"voltage\", from: 0.25, to: 0.22, steps: 6, tolerance: 2e-4)),
        (name: \"none\", over: [(name: \"frequency\", low: 0.45, high: 0.45, count: 1)],
         search: (transient: 100, recorded_periods: 50, lyapunov_periods: 0),
         crisis: (name: \"voltage\", from: 0.1, to: 0.05, steps: 2, tolerance: 1e-3)),
    ])";
    let scene = Scene::parse(text).unwrap();
    let sweeps = swept(&scene, "crises", Part::WHOLE, None, &mut ()).unwrap();
    let [crisis, none] = &sweeps.sweeps[..] else { panic!("{}", sweeps.sweeps.len()) };
    assert_eq!(crisis.crisis(), Some("voltage"));
    let column = |name: &str| crisis.run_columns.iter().position(|known| known == name).unwrap();
    let [at, error] = ["voltage", "crisis_error"].map(column);
    for (run, voltage) in [(0, 0.2353), (1, 0.2256)] {
        close(crisis.rows[&run].values[at], voltage, 5e-4);
        assert!(crisis.rows[&run].values[error] <= 1e-4);
    }
    let failure = none.rows[&0].failure.as_deref().unwrap();
    assert!(
        failure.contains("no crisis was found in 2 steps of the parameter from 0.1 to 0.05"),
        "{failure}"
    );
    let drawn = figures(&[], std::slice::from_ref(&sweeps), None, &[]).unwrap();
    assert!(drawn[0].series.iter().any(|series| series.points.len() == 2));
    let unknown = text.replace("(name: \"voltage\", from", "(name: \"voltages\", from");
    assert!(one_line(&Scene::parse(&unknown).unwrap_err()).contains("did you mean `voltage`"));
}

#[test]
fn built_in_sweeps_run_and_are_drawn() {
    let folder = tempfile::tempdir().unwrap();
    for scene in BUILT_IN.iter().filter(|scene| scene.text.contains("sweeps: [")) {
        let mut arguments = vec!["sweep", scene.name];
        // A crisis is none if motion is not given the time to leave.
        let few = match scene.text.contains("crisis: (") {
            true => ["count=2", "transient=400", "recorded_periods=20", "lyapunov_periods=0"],
            false => ["count=5", "transient=30", "recorded_periods=20", "lyapunov_periods=40"],
        };
        few.iter().for_each(|setting| arguments.extend(["--set", setting]));
        let output = tangency(folder.path(), &arguments);
        assert!(output.status.success(), "{}: {output:?}", scene.name);
        let text = std::str::from_utf8(&output.stdout).unwrap();
        assert!(!text.contains("failed"), "{text}");
    }
}

/// Basins at ω = 0.5, V = 0.2: the orbit without impacts and P(1,1) attract, beside each other,
/// with the same bytes on one thread and two.
#[test]
fn basins_have_both_attractors_on_any_number_of_threads() {
    let mut scene = built_in("mita-basins");
    scene.set("transient", "200").unwrap();
    for (grid, count) in scene.sweeps[0].over.iter_mut().zip([7, 9]) {
        grid.count = count;
    }
    let on = |threads: usize| {
        let part = Part { threads: NonZeroUsize::new(threads), ..Part::WHOLE };
        swept(&scene, "basins", part, None, &mut ()).unwrap()
    };
    let found = on(1);
    let table = &found.sweeps[0];
    let column = |name: &str| table.run_columns.iter().position(|known| known == name).unwrap();
    let [periods, front] = ["periods", "front"].map(column);
    let of = |impacts: f64| {
        let settled = |row: &&Row| (row.values[periods], row.values[front]) == (1.0, impacts);
        table.rows.values().filter(settled).count()
    };
    assert!(table.is_complete() && of(0.0) + of(1.0) == 63 && of(0.0) > 5 && of(1.0) > 5);
    let folder = tempfile::tempdir().unwrap();
    let saved = |threads: usize, sweeps: &Sweeps| {
        let name = format!("{threads}.npz");
        sweeps.save(folder.path().join(&name)).unwrap();
        bytes(folder.path(), &name)
    };
    assert!(saved(1, &found) == saved(2, &on(2)));
}

hybrid_system! {
    /// A linear oscillator in two modes, above and below its middle; its distance from there is a
    /// monitor of either mode.
    struct Halves { measured: &'static str } [frequency = 1.5; t] {
        period = frequency.recip() * TAU;
        mode above [x, v] {
            d/dt x = v;
            d/dt v = (frequency * t).cos() - x - v * 0.2;
            event down: x => below;
        }
        mode below [x, v] {
            d/dt x = v;
            d/dt v = (frequency * t).cos() - x - v * 0.2;
            event up: -x => above;
        }
        fn monitors(&self) -> Vec<String> {
            vec!["distance_from_middle".into()]
        }
        fn monitor<T: Scalar>(&self, _monitor: usize, mode: usize, _t: T, x: &[T], _p: &[T]) -> T {
            if mode == 0 { x[0] } else { -x[0] }
        }
        fn measures(&self) -> Vec<(String, Measure)> {
            vec![
                ("mean".into(), Measure::mean("distance_from_middle")),
                ("largest".into(), Measure::Maximum(self.measured.into())),
            ]
        }
    }
}

/// Monitors of one's own, defined mode by mode, are columns of branches and of sweeps, with one
/// meaning: of a sinusoid with the amplitude A, `mean |x| = 2A/π` and `max |x| = A`.
#[test]
fn monitors_of_several_modes_are_columns_of_branches_and_sweeps() {
    let scene = "Scene(
        title: \"Halves\", problem: Halves(),
        runs: [(name: \"orbits\", start: Simulated(state: [(\"x\", 0.1)]), along: [(name: \"frequency\", low: 1.5, high: 1.8)])],
        sweeps: [(
            name: \"motions\", over: [(name: \"frequency\", low: 1.5, high: 1.8, count: 2)],
            starts: [[(\"x\", 0.1)]], measures: [\"mean\", \"largest\"],
        )],
    )";
    let catalogue = |measured| Catalogue::empty().hybrid("Halves", Halves { measured });
    let refused = catalogue("distance_from_midle").parse(scene).unwrap_err();
    assert!(matches!(refused, SceneError::UnknownName(_)));
    assert!(one_line(&refused).contains("did you mean `distance_from_middle`?"), "{refused}");
    let scene = catalogue("distance_from_middle").parse(scene).unwrap();
    let exact = |frequency: f64| {
        let amplitude = (1.0 - frequency * frequency).hypot(0.2 * frequency).recip();
        [amplitude / FRAC_PI_2, amplitude]
    };
    let branch = &traced(&scene).branches[0];
    let columns = ["frequency", "mean", "largest"].map(|name| branch.column(name).unwrap());
    for point in &branch.points {
        let [frequency, mean, largest] = columns.map(|column| point.value(column).unwrap());
        close(mean, exact(frequency)[0], 1e-9);
        close(largest, exact(frequency)[1], 1e-9);
    }
    let found = swept(&scene, "halves", Part::WHOLE, None, &mut ()).unwrap();
    let table = &found.sweeps[0];
    for (row, frequency) in table.rows.values().zip([1.5, 1.8]) {
        let period = &row.points[..table.point_columns.len()];
        let [mean, largest] = ["mean", "largest"].map(|name| {
            period[table.point_columns.iter().position(|known| known == name).unwrap()]
        });
        close(mean, exact(frequency)[0], 1e-8);
        close(largest, exact(frequency)[1], 1e-8);
    }
}

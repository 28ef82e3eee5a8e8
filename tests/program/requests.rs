//! Commands as strangers type them: starts, names, files, sizes, and the messages where they err.

use crate::program::command::{failure, refused, stderr, succeeds, tangency};
use std::fmt::Write;
use std::io::Read;
use tangency::core::continuation::Branch;
use tangency::core::failure::one_line;
use tangency::core::system::Kind;
use tangency::output::{Document, Origin, Sweeps, diagram};
use tempfile::{TempDir, tempdir};

fn folder() -> TempDir {
    tempdir().expect("a folder")
}

/// A mass on a spring that is stiffer on one side: orbits of one shape end at two grazings, and the
/// family between these grazings is followed once.
#[test]
fn a_family_between_two_grazings_is_followed_once() {
    let folder = folder();
    let at = folder.path();
    let model = r#"HybridEquations(
        modes: [
            (name: "soft", states: [("x", "v"), ("v", "cos(w*t) - 0.04*v - x")]),
            (name: "stiff", states: [("x", "v"), ("v", "cos(w*t) - 0.04*v - 4*x")]),
        ],
        guards: [
            (name: "in", modes: ["soft"], function: "x", next: "stiff"),
            (name: "out", modes: ["stiff"], function: "-x", next: "soft"),
        ],
        parameters: [("w", 2)], initial: [("x", 0.1), ("v", 0)], period: "2*pi/w")"#;
    std::fs::write(at.join("m.ron"), model).unwrap();
    succeeds(
        at,
        &["trace", "m.ron", "--along", "w=1.9..2.1", "--settle", "200", "--switch", "all"],
    );
    let document = Document::load(at.join("out/m.ron")).unwrap();
    let [branch, beyond] = &document.branches[..] else { panic!("{}", document.branches.len()) };
    let values = |branch: &Branch, kind: Kind| -> Vec<f64> {
        let mut values: Vec<f64> = branch.of_kind(kind).map(|it| it.parameters[0]).collect();
        values.sort_by(f64::total_cmp);
        values
    };
    let grazings = values(branch, Kind::G);
    let ends = [&beyond.special[0], beyond.special.last().unwrap()].map(|end| end.parameters[0]);
    assert_eq!(grazings.len(), 2);
    assert!(grazings.iter().all(|g| ends.iter().any(|end| (g - end).abs() < 1e-9)), "{ends:?}");
    for (found, known) in values(beyond, Kind::LP).iter().zip([1.91503368, 2.02793741]) {
        assert!((found - known).abs() < 1e-8, "{found} {known}");
    }
}

/// A saved end is no start beyond a bound that the branch did not end at.
#[test]
fn ends_are_no_starts_beyond_other_bounds() {
    let folder = folder();
    let at = folder.path();
    std::fs::write(
        at.join("m.ron"),
        "Equations(states: [(\"x\", \"a - x\")], parameters: [(\"a\", 0)])",
    )
    .unwrap();
    let trace = ["trace", "m.ron", "--along", "a=0..2", "--bound"];
    succeeds(at, &[&trace[..], &["x=..0.5"]].concat());
    let start = ["--start", "out/m.ron:branch/2", "--out", "b"];
    succeeds(at, &[&trace[..], &["x=..0.5"], &start].concat());
    refused(
        at,
        &[&trace[..], &["x=..0.49"], &start].concat(),
        &["x = 0.5", "is not in the range of x"],
    );
}

/// Values of a sweep are stated once, and go up and down whatever end comes first.
#[test]
fn sweeps_of_models_go_both_ways() {
    let folder = folder();
    let at = folder.path();
    std::fs::write(at.join("m.ron"), "Equations(states: [(\"x\", \"r*cos(t) - x\")], period: \"2*pi\", parameters: [(\"r\", 3)])").unwrap();
    succeeds(at, &["sweep", "m.ron", "--over", "r=2..1:3", "--both"]);
    let sweeps = Sweeps::load(at.join("out/m-sweep.npz")).unwrap();
    let [up, down] = &sweeps.sweeps[..] else { panic!("{}", sweeps.sweeps.len()) };
    let column = up.run_columns.iter().position(|name| name == "r").unwrap();
    for (sweep, name) in [(up, "up"), (down, "down")] {
        let values: Vec<f64> = sweep.rows.values().map(|row| row.values[column]).collect();
        assert_eq!((sweep.name.as_str(), values), (name, vec![1.0, 1.5, 2.0]));
    }
    for (more, said) in [
        (&["--over", "r=1..2:3"][..], "`r` is given twice"),
        (&["--from", "x=1,x=2"], "`x` is given twice"),
        (&["--over", "x=0..1:2", "--both"], "sweeps the values of one parameter"),
    ] {
        refused(at, &[&["sweep", "m.ron", "--over", "r=1..2:3"][..], more].concat(), &[said]);
    }
}

/// A sweep records the monitors that a branch shows: `x' = r cos t − x` has the amplitude `r/√2`.
#[test]
fn sweeps_of_models_record_monitors() {
    let folder = folder();
    let at = folder.path();
    let model =
        r#"Equations(states: [("x", "r*cos(t) - x")], period: "2*pi", parameters: [("r", 3)])"#;
    std::fs::write(at.join("m.ron"), model).unwrap();
    let sweep = ["sweep", "m.ron", "--over", "r=1..2:3"];
    succeeds(at, &[&sweep[..], &["--measure", "max_x,min_x"]].concat());
    let sweeps = Sweeps::load(at.join("out/m-sweep.npz")).unwrap();
    assert_eq!(sweeps.plot.y.as_deref(), Some("max_x"));
    let table = &sweeps.sweeps[0];
    let column = |name| table.point_columns.iter().position(|known| known == name).unwrap();
    for (row, r) in table.rows.values().zip([1.0, 1.5, 2.0]) {
        for (name, exact) in [("max_x", r / 2.0_f64.sqrt()), ("min_x", -r / 2.0_f64.sqrt())] {
            assert!((row.points[column(name)] / exact - 1.0).abs() < 1e-8, "{name} at r = {r}");
        }
    }
    for command in [&sweep[..], &["simulate", "m.ron", "--time", "1"]] {
        let quiet = [command, &["--quiet", "--out", "quiet"]].concat();
        let output = tangency(at, &quiet);
        let said = String::from_utf8_lossy(&output.stdout);
        assert!(output.status.success() && said.is_empty(), "{command:?}: {said}");
    }
    assert!(at.join("quiet/m-sweep.npz").exists() && at.join("quiet/m-history.npz").exists());
    // A sweep without the column of the axis is named.
    succeeds(at, &["trace", "m.ron", "--along", "r=1..2"]);
    let plot = |column: &str| {
        let both = ["plot", "out/m.ron", "out/m-sweep.npz", "--y", column, "--out", "both.svg"];
        stderr(&tangency(at, &both))
    };
    assert_eq!(plot("max_x"), "");
    let said = plot("mesh_error");
    assert!(
        said.contains("the sweep `up` has no column `mesh_error` and is not drawn (known: "),
        "{said}"
    );
    assert!(!said.contains("--measure"), "{said}");
    succeeds(at, &[&sweep[..], &["--out", "bare"]].concat());
    let bare = ["plot", "out/m.ron", "bare/m-sweep.npz", "--y", "max_x", "--out", "bare.svg"];
    let said = stderr(&tangency(at, &bare));
    assert!(said.contains("is not drawn: repeat the sweep with `--measure max_x`"), "{said}");
    let unknown = [&sweep[..], &["--measure", "max_y", "--afresh"]].concat();
    refused(at, &unknown, &["unknown measure `max_y`", "max_x"]);
}

/// A picture of several results names them by the settings in which they differ, with their units: a
/// sweep has the name of its direction, too, if there are several directions.
#[test]
fn results_have_the_names_of_their_settings() {
    let folder = folder();
    let at = folder.path();
    let model = r#"Equations(
        states: [("x", "r*cos(t) - x + gap/d")], period: "2*pi",
        parameters: [("r", 3), ("gap", 1), ("d", 2e-4)], units: [("gap", "m")],
    )"#;
    std::fs::write(at.join("m.ron"), model).unwrap();
    for (out, set) in [("a", "gap=1.5e-6"), ("b", "gap=2e-6"), ("c", "d=1e-4")] {
        for both in [&[][..], &["--both", "--afresh"]] {
            let over = ["sweep", "m.ron", "--over", "r=1..2:3", "--out"];
            let folder = if both.is_empty() { out.to_owned() } else { format!("{out}{out}") };
            succeeds(at, &[&over[..], &[&folder, "--set", set], both].concat());
        }
        succeeds(at, &["trace", "m.ron", "--along", "r=1..2", "--set", set, "--out", out]);
    }
    let drawn = |files: [&str; 2], out: &str| {
        succeeds(at, &["plot", files[0], files[1], "--out", out]);
        std::fs::read_to_string(at.join(out)).unwrap()
    };
    let has = |text: &str, words: [&str; 2]| words.iter().all(|word| text.contains(word));
    let microns = ["gap = 1.5 µm", "gap = 2 µm"];
    assert!(has(&drawn(["a/m.ron", "b/m.ron"], "d.svg"), microns));
    assert!(has(&drawn(["a/m-sweep.npz", "b/m-sweep.npz"], "s.svg"), microns));
    let table = drawn(["aa/m-sweep.npz", "bb/m-sweep.npz"], "s.csv");
    assert!(has(&table, ["\n\"gap = 1.5 µm, up\",0,", "\n\"gap = 2 µm, down\",0,"]), "{table}");
    let base = ["trace", "m.ron", "--along", "r=1..2", "--out", "base"];
    succeeds(at, &base);
    assert!(has(&drawn(["base/m.ron", "c/m.ron"], "e.svg"), ["d = 2e-4", "d = 1e-4"]));
}

/// Forced systems have no equilibria to find in a box: the error names the search for orbits.
#[test]
fn a_box_of_a_forced_system_is_refused() {
    let folder = folder();
    let at = folder.path();
    let model =
        r#"Equations(states: [("x", "r*cos(t) - x")], period: "2*pi", parameters: [("r", 3)])"#;
    std::fs::write(at.join("m.ron"), model).unwrap();
    let said = ["forced systems have no equilibria", "sweep over initial states"];
    refused(at, &["find", "m.ron", "--box", "x=-1..1"], &said);
    refused(
        at,
        &["trace", "m.ron", "--along", "r=1..2", "--start", "all", "--box", "x=-1..1"],
        &said,
    );
}

/// Arrays of unknowns are drawn over their index, and written as data.
#[test]
fn arrays_have_profiles() {
    let folder = folder();
    let at = folder.path();
    let model = r#"Residual(
        unknowns: [("u[i=1..n]", "(u[i-1] - 2*u[i] + u[i+1])*(n + 1)^2 + lambda*exp(u[i])")],
        definitions: [("n", 19), ("u[0]", 0), ("u[n+1]", 0)], parameters: [("lambda", 0)])"#;
    std::fs::write(at.join("bratu.ron"), model).unwrap();
    let bound = ["--along", "lambda=0..5", "--bound", "norm_u=..9"];
    succeeds(at, &[&["trace", "bratu.ron"][..], &bound].concat());
    let document = Document::load(at.join("out/bratu.ron")).unwrap();
    let fold = document.branches[0].of_kind(Kind::LP).next().unwrap();
    let [profile] = &fold.profiles[..] else { panic!("{}", fold.profiles.len()) };
    assert_eq!((profile.name.as_str(), profile.along.as_str()), ("u", "index"));
    let points = &profile.points;
    assert_eq!((points.len(), points[0][0], points[18][0]), (19, 1.0, 19.0));
    // Solutions are even about the middle, where they are largest.
    for k in 0..9 {
        assert!((points[k][1] - points[18 - k][1]).abs() < 1e-9 && points[k][1] < points[k + 1][1]);
    }
    let label = fold.label.to_string();
    succeeds(at, &["plot", "out/bratu.ron", "--points", &label, "--out", "u.csv"]);
    let table = std::fs::read_to_string(at.join("u.csv")).unwrap();
    assert_eq!(table.lines().count(), 20);
    assert!(std::fs::read_to_string(at.join("out/bratu.svg")).unwrap().contains("index"));
}

/// Results of another scene are replaced, and that is said.
#[test]
fn results_of_another_scene_are_not_lost_silently() {
    let folder = folder();
    let at = folder.path();
    std::fs::create_dir(at.join("b")).unwrap();
    for (file, title) in [("m.ron", "one"), ("b/m.ron", "other")] {
        let scene = format!(
            "Scene(title: \"{title}\", problem: Equations(states: [(\"x\", \"a - x\")], solution: equilibrium),
            parameters: [(\"a\", 1)], runs: [(name: \"r\", along: [(name: \"a\", low: 0, high: 2)])])"
        );
        std::fs::write(at.join(file), scene).unwrap();
    }
    for (file, said) in [("m.ron", false), ("m.ron", false), ("b/m.ron", true), ("b/m.ron", false)]
    {
        let message = stderr(&tangency(at, &["trace", file]));
        let warning =
            "out/m.ron contained the results of another scene, `one`, and is now replaced";
        assert_eq!(message.contains(warning), said, "{file}: {message}");
    }
}

/// Names of branches and files may hold equals signs and colons.
#[test]
fn points_of_any_names_are_started_from() {
    let folder = folder();
    let at = folder.path();
    for name in ["α = 1.0", "a:b", "a/b"] {
        let text = format!(
            "Scene(title: \"t\", problem: Equations(states: [(\"x\", \"a - x\")], solution: equilibrium), parameters: [(\"a\", 1)],
                runs: [(name: \"{name}\", along: [(name: \"a\", low: 0, high: 2)])])"
        );
        std::fs::write(at.join("n:m.ron"), text).unwrap();
        succeeds(at, &["trace", "n:m.ron", "--out", "o"]);
        let start = format!("o/n:m.ron:{name}/2");
        succeeds(at, &["trace", "n:m.ron", "--start", &start, "--out", "p"]);
    }
    std::fs::write(
        at.join("m.ron"),
        "Equations(states: [(\"x\", \"a - x\")], parameters: [(\"a\", 1)])",
    )
    .unwrap();
    succeeds(at, &["trace", "m.ron", "--along", "a=0..2", "--start", "x=max(1,2)"]);
}

/// A history needs no parameters.
#[test]
fn models_without_parameters_have_histories() {
    let folder = folder();
    let at = folder.path();
    std::fs::write(at.join("m.ron"), "Equations(states: [(\"x\", \"1 - x\")])").unwrap();
    succeeds(at, &["simulate", "m.ron", "--from", "x=3", "--time", "2"]);
    let table = std::fs::read_to_string(at.join("out/m-history.csv")).unwrap();
    let last = table.lines().last().unwrap().rsplit_once(',').unwrap().1;
    assert!((last.parse::<f64>().unwrap() - (1.0 + 2.0 * (-2.0_f64).exp())).abs() < 1e-9, "{last}");
    for ending in ["ron", "svg"] {
        assert!(at.join("out/m-history").with_extension(ending).exists());
    }
    succeeds(at, &["table", "out/m-history.ron"]);
    refused(
        at,
        &["simulate", "m.ron", "--time", "0"],
        &["duration is 0, but a history needs a positive duration"],
    );
}

/// The axes of a picture of a history show the time and the states: a circle is a circle.
#[test]
fn histories_are_drawn_in_any_of_their_columns() {
    let folder = folder();
    let at = folder.path();
    std::fs::write(at.join("m.ron"), r#"Equations(states: [("x", "v"), ("v", "-x")])"#).unwrap();
    succeeds(at, &["simulate", "m.ron", "--from", "x=1", "--time", "6"]);
    let document = Document::load(at.join("out/m-history.ron")).unwrap();
    let documents = [("m", &document)];
    let drawn = |x, y: &[&str]| tangency::output::figures(&documents, &[], x, y).unwrap();
    let [plane] = &drawn(Some("v"), &["x"])[..] else { panic!("not one panel") };
    assert!(plane.marks.is_empty() && plane.series[0].points.len() > 20);
    assert!(plane.series[0].points.iter().all(|[v, x]| (v.hypot(*x) - 1.0).abs() < 1e-6));
    let [course] = &drawn(None, &["v"])[..] else { panic!("not one panel") };
    assert!(course.series[0].points.iter().all(|[t, v]| (t.sin() + v).abs() < 1e-6));
    let plot = ["plot", "out/m-history.ron", "--x", "time", "--y", "x,v"];
    let output = tangency(at, &plot);
    assert!(output.status.success() && stderr(&output).is_empty(), "{}", stderr(&output));
    refused(at, &[&plot[..], &["--points", "all"]].concat(), &["help: omit --x", "`--panel c`"]);
}

/// Systems with impacts are simulated, too, with parameters of their scene that are changed.
#[test]
fn scenes_are_simulated() {
    let folder = folder();
    let at = folder.path();
    succeeds(
        at,
        &[
            "simulate",
            "bouncing-ball",
            "--set",
            "amplitude=0.9",
            "--time",
            "5",
            "--transient",
            "50",
        ],
    );
    let table = std::fs::read_to_string(at.join("out/bouncing-ball-history.csv")).unwrap();
    assert!(table.lines().count() > 20);
    // The same numbers as arrays.
    let archive = std::fs::File::open(at.join("out/bouncing-ball-history.npz")).unwrap();
    let mut archive = zip::ZipArchive::new(archive).unwrap();
    let mut array = Vec::new();
    archive.by_name("time.npy").unwrap().read_to_end(&mut array).unwrap();
    let count = table.lines().count() - 1;
    // What `numpy.save` writes: version 1.0, and a header that fills 128 bytes.
    let header = format!("{{'descr': '<f8', 'fortran_order': False, 'shape': ({count},), }}");
    let start = [b"\x93NUMPY\x01\x00\x76\x00", format!("{header:<117}\n").as_bytes()].concat();
    assert_eq!(array[..128], start);
    let times: Vec<f64> =
        array[128..].as_chunks().0.iter().map(|bytes| f64::from_le_bytes(*bytes)).collect();
    assert_eq!(times.len(), count);
    for (time, line) in times.iter().zip(table.lines().skip(1)) {
        let listed: f64 = line.split(',').nth(1).unwrap().parse().unwrap();
        assert!((time - listed).abs() <= 1e-14 * listed.abs());
    }
    refused(
        at,
        &["simulate", "bratu"],
        &[
            "only vector fields and hybrid systems can be simulated",
            "help: static equations",
            "a lumped model",
        ],
    );
    refused(
        at,
        &["simulate", "lorenz", "--set", "max_points=4"],
        &["no effect on simulated histories"],
    );
    refused(at, &["simulate", "lorenz", "--from", "w=1"], &["unknown state `w`"]);
}

/// All equilibria and fixed points in a box are found, with their stability.
#[test]
fn equilibria_and_fixed_points_are_found() {
    let folder = folder();
    let at = folder.path();
    let lorenz = ["find", "lorenz", "--set", "rho=28", "--box", "x=-20..20,y=-20..20,z=0..50"];
    let said = succeeds(at, &lorenz);
    // ±√72 and 27.
    assert!(said.contains("-8.48528137424") && said.contains("   8.48528137424"), "{said}");
    assert!(
        said.lines().count() == 5
            && said.contains("solutions inside the box: 3; solutions outside the box: 0"),
        "{said}"
    );
    let map = "Map(states: [(\"x\", \"1 - a*x^2 + y\"), (\"y\", \"b*x\")], parameters: [(\"a\", 1.4), (\"b\", 0.3)])";
    std::fs::write(at.join("henon.ron"), map).unwrap();
    let said = succeeds(at, &["find", "henon.ron", "--box", "x=-2..2,y=-1..1"]);
    // (−0.7 ± √6.09)/2.8
    assert!(said.contains("0.63135447709") && said.contains("-1.13135447709"), "{said}");
    assert!(said.contains("solutions inside the box: 2"), "{said}");
    refused(at, &["find", "henon.ron", "--box", "x=-2..2"], &["the box needs a range for `y`"]);
    refused(at, &["find", "henon.ron", "--box", "x=-2..2,w=0..1"], &["unknown component `w`"]);
    refused(
        at,
        &["find", "bratu", "--box", "u=0..1"],
        &["only for problems whose unknowns are single numbers"],
    );
}

/// Branches begin at all solutions over the range of the parameter: the isola x² + a² = 1/4 is one
/// branch, though it does not come to the start, a = −1, and the pitchfork is two branches.
#[test]
fn branches_begin_at_all_solutions() {
    let folder = folder();
    let at = folder.path();
    for (name, rate, range, points) in [
        ("isola", "(x - 3)*(x^2 + a^2 - 1/4)", "a=-1..1", &[("branch 2", Kind::LP, [-0.5, 0.5])]),
        ("fork", "x*(a - x^2)", "a=-1.5..1.5", &[("branch", Kind::BP, [0.0, 0.0])]),
    ] {
        let text = format!("Equations(states: [(\"x\", \"{rate}\")], parameters: [(\"a\", -1)])");
        std::fs::write(at.join(format!("{name}.ron")), text).unwrap();
        let model = format!("{name}.ron");
        let traced = ["trace", &model, "--along", range, "--start", "all", "--box", "x=-4..4"];
        succeeds(at, &traced);
        let found = Document::load(at.join(format!("out/{name}.ron"))).unwrap();
        let names: Vec<&str> = found.branches.iter().map(|branch| branch.name.as_str()).collect();
        assert_eq!(names, ["branch", "branch 2"], "{name}");
        for (branch, kind, exact) in points {
            let branch = found.branch(branch).unwrap();
            let mut values: Vec<f64> = branch.of_kind(*kind).map(|it| it.parameters[0]).collect();
            values.sort_by(f64::total_cmp);
            let near = |value: &f64| exact.iter().any(|exact| (value - exact).abs() < 1e-10);
            assert!(!values.is_empty() && values.iter().all(near), "{name}: {values:?}");
        }
    }
    refused(
        at,
        &["trace", "fork.ron", "--along", "a=0.15..1", "--start", "all"],
        &["must be given together"],
    );
    refused(
        at,
        &["trace", "fork.ron", "--along", "a=0.15..1", "--box", "x=0..1"],
        &["must be given together"],
    );
    let empty = ["trace", "fork.ron", "--along", "a=0.15..1", "--start", "all", "--box", "x=7..8"];
    refused(at, &empty, &["was found in the box", "larger box"]);
}

/// Where motion rests, the columns are its states; where it goes on, their extremes, and a bound or
/// a diagram of the state means both.
#[test]
fn equilibria_and_orbits_share_the_axis_of_a_state() {
    let folder = folder();
    let at = folder.path();
    let text = "Equations(states: [(\"x\", \"mu*x - y - x*(x^2 + y^2)\"), (\"y\", \"x + mu*y - y*(x^2 + y^2)\")], parameters: [(\"mu\", -1)])";
    std::fs::write(at.join("hopf.ron"), text).unwrap();
    let along = ["trace", "hopf.ron", "--along", "mu=-1..3", "--switch", "all"];
    succeeds(at, &[&along[..], &["--bound", "y=..1.5"]].concat());
    let document = Document::load(at.join("out/hopf.ron")).unwrap();
    let [rest, orbits] = &document.branches[..] else { panic!("{:?}", document.branches.len()) };
    assert_eq!(
        (&rest.monitors[..], &orbits.monitors[1..5]),
        (
            &["x".to_string(), "y".into()][..],
            &["max_x", "min_x", "max_y", "min_y"].map(String::from)[..],
        )
    );
    // The orbit has the radius √μ, and its bound is that of its largest y.
    let last = orbits.points.last().unwrap().parameters[0];
    assert!((last - 2.25).abs() < 1e-9, "{last}");
    let figure = diagram(&[("hopf", &document)], None, &[]).unwrap();
    assert_eq!(figure.y_label, "x");
    let of_orbits = figure.series.iter().filter(|series| series.name == orbits.name);
    let heights: Vec<f64> = of_orbits.flat_map(|series| &series.points).map(|at| at[1]).collect();
    let [low, high] = [f64::min, f64::max].map(|of| heights.iter().copied().fold(0.0, of));
    assert!((low + 1.5).abs() < 1e-8 && (high - 1.5).abs() < 1e-8, "{low} {high}");
    // Each point knows the row that it shows.
    for series in &figure.series {
        assert_eq!(series.points.len(), series.origins.len());
        let mut last = None;
        for (at, origin) in series.points.iter().zip(&series.origins) {
            // Vertices between two points have the row of the first one.
            if last.replace(*origin) == Some(*origin) {
                continue;
            }
            let value = match *origin {
                Origin::Point { branch, point, .. } => {
                    document.branches[branch].points[point].parameters[0]
                }
                Origin::Special { branch, label, .. } => {
                    document.branches[branch].labelled(label).unwrap().parameters[0]
                }
                ref other => panic!("{other:?}"),
            };
            assert_eq!(at[0], value);
        }
    }
}

/// A mistake in a picture is known before the work.
#[test]
fn labels_are_stated_once() {
    let text = "Scene(title: \"t\", problem: Equations(states: [(\"x\", \"a - x\")]), parameters: [(\"a\", 1)],
        plot: (labels: [(\"x\", \"one\"), (\"x\", \"two\")]), runs: [(name: \"r\", along: [(name: \"a\", low: 0, high: 1)])])";
    let error = one_line(&tangency::scene::Scene::parse(text).unwrap_err());
    assert!(error.contains("column of a label `x`"), "{error}");
}

/// Shells complete commands, and there is a manual page.
#[test]
fn shells_and_readers_know_the_commands() {
    let folder = folder();
    for shell in ["bash", "zsh", "fish"] {
        let script = succeeds(folder.path(), &["completions", shell]);
        assert!(
            ["simulate", "along", "switch"].iter().all(|word| script.contains(word)),
            "{shell}"
        );
    }
    let pages = succeeds(folder.path(), &["man"]);
    assert!(pages.contains(".TH tangency 1") && pages.contains("Trace a scene or a model"));
}

/// Limits of sizes hold for all files.
#[test]
fn sizes_are_limited_everywhere() {
    let folder = folder();
    let at = folder.path();
    let blanks = "\n".repeat(2_000_000);
    std::fs::write(at.join("m.ode"), format!("x'=a-x\npar a=1\ndone\n{blanks}")).unwrap();
    std::fs::write(
        at.join("m.ron"),
        format!("Equations(states: [(\"x\", \"a - x\")], parameters: [(\"a\", 1)]){blanks}"),
    )
    .unwrap();
    let scene = "Scene(title: \"t\", problem: Equations(model: \"m.ron\", solution: equilibrium), runs: [(name: \"r\", along: [(name: \"a\", low: 0, high: 1)])])";
    std::fs::write(at.join("s.ron"), scene).unwrap();
    for command in
        [&["import", "m.ode"][..], &["trace", "s.ron"], &["trace", "m.ron", "--along", "a=0.15..1"]]
    {
        succeeds(at, command);
        let limited = [&["--max-size", "1"], command].concat();
        refused(at, &limited, &["larger than the limit of 1 MB"]);
    }
}

/// A name may have any length, chains of definitions too, and many parameters are no burden.
#[test]
fn large_statements_are_read() {
    let folder = folder();
    let at = folder.path();
    let long = "x".repeat(65_536);
    let text =
        format!("Equations(states: [(\"{long}\", \"p - {long}\")], parameters: [(\"p\", 1)])");
    std::fs::write(at.join("long.ron"), text).unwrap();
    succeeds(at, &["trace", "long.ron", "--along", "p=0.5..1.5"]);
    let mut chain = String::from(
        "Equations(states: [(\"x\", \"p - d1999\")], parameters: [(\"p\", 1)], definitions: [(\"d0\", \"x\")",
    );
    for k in 1..2000 {
        write!(chain, ", (\"d{k}\", \"d{}*1.0001\")", k - 1).unwrap();
    }
    std::fs::write(at.join("chain.ron"), chain + "])").unwrap();
    succeeds(at, &["trace", "chain.ron", "--along", "p=0.5..1.5"]);
    let parameters: Vec<String> = (0..4000).map(|k| format!("(\"p{k}\", {k})")).collect();
    let text = format!(
        "Equations(states: [(\"x\", \"p0 - x\")], parameters: [{}])",
        parameters.join(", ")
    );
    std::fs::write(at.join("many.ron"), text).unwrap();
    let output = tangency(at, &["trace", "many.ron", "--along", "p0=0.5..1.5"]);
    assert!(output.status.success());
    let said = stderr(&output);
    assert!(
        said.lines().count() < 10 && said.contains("no formula uses 3994 further parameters"),
        "{said}"
    );
}

/// Messages name the mistake and the remedy.
#[test]
fn mistakes_are_named() {
    let folder = folder();
    let at = folder.path();
    let write = |name: &str, text: &str| std::fs::write(at.join(name), text).unwrap();
    write(
        "big.ron",
        "Equations(states: [(\"x[i=1..1000000001]\", \"a\")], parameters: [(\"a\", 1)])",
    );
    refused(
        at,
        &["trace", "big.ron", "--along", "a=0.15..1"],
        &["the last index, 1000000001", "must be between -1000000000 and 1000000000"],
    );
    write("secret", "root:x:0");
    let scene = |model: &str| {
        format!(
            "Scene(title: \"t\", model: \"{model}\", runs: [(name: \"r\", along: [(name: \"a\")])])"
        )
    };
    write("stranger.ron", &scene("secret"));
    let said = failure(&tangency(at, &["trace", "stranger.ron"]), 1).to_string();
    assert!(said.contains("is not a file of equations") && !said.contains("root"), "{said}");
    write("plain.ron", "Equations(states: [(\"x\", \"a - x\")], parameters: [(\"a\", 1)])");
    refused(at, &["sweep", "plain.ron"], &["has no sweeps"]);
    let text = "Scene(title: \"t\", problem: Equations(states: [(\"x\", \"a - x\")], solution: equilibrium), parameters: [(\"a\", \"1/2\")],
        runs: [(name: \"r\", along: [(name: \"a\", low: \"-1/3\", high: \"4/3\")], marks: [(\"a\", \"1/4\")], bounds: [(name: \"max_x\", high: \"5/4\")])])";
    write("formulas.ron", text);
    let found = succeeds(at, &["trace", "formulas.ron"]);
    assert!(
        found.contains("-0.333333333333") && found.contains("0.25") && found.contains("1.25"),
        "{found}"
    );
    write(
        "held.ron",
        &text
            .replace("bounds:", "hold: G, bounds:")
            .replace("runs: [(name: \"r\"", "runs: [(name: \"r\", start: Guess([(\"x\", 0.5)])"),
    );
    let said = failure(&tangency(at, &["trace", "held.ron"]), 1).to_string();
    assert!(!said.contains("hold_condition"), "{said}");
    write("file", "");
    refused(at, &["trace", "formulas.ron", "--out", "file"], &["file is a file, not a folder"]);
    let name = "n".repeat(240);
    write(&format!("{name}.ron"), text);
    refused(
        at,
        &["trace", &format!("{name}.ron")],
        &["the name of the result", "at most 220 bytes are allowed"],
    );
    let document = std::fs::read_to_string(at.join("out/formulas.ron")).unwrap();
    write("hidden.ron", &document.replace("name: \"r\"", "name: \"r\u{202e}\""));
    refused(at, &["table", "hidden.ron"], &["control characters"]);
    write(
        "many.ron",
        &document.replacen("label: 1,", "label: 1, multiplicity: 18446744073709551615,", 1),
    );
    refused(at, &["table", "many.ron"], &["must be from 1 to 1"]);
}

/// Sweeps have no special points, and archives are no text.
#[test]
fn archives_are_told_from_documents() {
    let folder = folder();
    let at = folder.path();
    let scene = "Scene(title: \"t\", problem: ImpactOscillator(), parameters: [(\"frequency\", 2.2)],
        sweeps: [(name: \"up\", order: up, over: [(name: \"amplitude\", low: 1, high: 5, count: 3)])])";
    std::fs::write(at.join("up.ron"), scene).unwrap();
    succeeds(at, &["sweep", "up.ron"]);
    refused(
        at,
        &["plot", "out/up.npz", "--points", "7", "--out", "p.svg"],
        &["--points needs a document"],
    );
    refused(at, &["table", "out/up.npz"], &["is not a text file", "tangency plot"]);
    for (name, words) in
        [("max_step=0.2", "no effect on sweeps"), ("amplitude=2", "which varies `amplitude`")]
    {
        refused(at, &["sweep", "up.ron", "--set", name, "--afresh"], &[words]);
    }
}

/// An orbit that does not exist at a changed first value is reached along its branch.
#[test]
fn a_start_that_was_moved_away_is_replaced_by_a_mark() {
    let folder = folder();
    let at = folder.path();
    let moved = ["trace", "mita-type-1", "--set", "voltage=0.5"];
    refused(at, &moved, &["replace `--set voltage=0.5` by `--mark voltage=0.5`"]);
}

/// Messages about values with units, settings of orbits, and points of orbits state the remedy.
#[test]
fn remedies_name_what_to_type() {
    let folder = folder();
    let at = folder.path();
    let model = r#"Equations(states: [("x", "y"), ("y", "a*y - x - x^2*y")], parameters: [("a", -1), ("b", 1)])"#;
    std::fs::write(at.join("m.ron"), model).unwrap();
    let trace = ["trace", "m.ron", "--along", "a=-1..-0.5"];
    for (more, said) in [
        (&["--set", "b=1.5um"][..], "a number is written without a unit (1.5 µm is 1.5e-6"),
        (&["--set", "b=0,004"], "its decimal sign is a point"),
        (&["--set", "intervals=50"], "orbits that emanate from Hopf points with `--switch HB`"),
        (
            &["--along", "b=1..2", "--hold", "HOM"],
            "`--switch HB`, and then start at their HOM point with `--start FILE:LABEL`",
        ),
    ] {
        refused(at, &[&trace[..], more].concat(), &[said]);
    }
    // A branch that ends in the middle names its limit.
    let limited = [&trace[..], &["--set", "max_points=3"]].concat();
    assert!(succeeds(at, &limited).contains("(max_points)"));
    let output = tangency(at, &[&limited[..], &["--strict"]].concat());
    assert!(failure(&output, 3).contains("allows: increase `max_points` to trace the rest"));
    let table = ["table", "out/m.ron", "--columns", "da/dc"];
    refused(at, &table, &["unknown column `da/dc`"]);
}

/// The names of settings in AUTO, XPPAUT and MatCont lead to the names of the same settings.
#[test]
fn settings_of_other_programs_are_named() {
    let folder = folder();
    let at = folder.path();
    let model = r#"Equations(states: [("x", "y"), ("y", "-x")], parameters: [("a", 0)])"#;
    std::fs::write(at.join("m.ron"), model).unwrap();
    for (name, own) in
        [("NTST", "intervals"), ("Dsmax", "max_step"), ("MaxNumPoints", "max_points")]
    {
        let set = format!("{name}=50");
        let said = format!("`{name}` of other programs is called `{own}` here");
        refused(at, &["trace", "m.ron", "--along", "a=0..1", "--set", &set], &[&said]);
    }
    for (name, option) in [("STOP", "--bound"), ("ISW", "--switch"), ("UZR", "--mark")] {
        let set = format!("{name}=-1");
        let said = format!("instead of `{name}` of other programs, use the option `{option} ");
        refused(at, &["trace", "m.ron", "--along", "a=0..1", "--set", &set], &[&said]);
    }
    let said = "instead of `IPS` of other programs, use the kind of the model";
    refused(at, &["trace", "m.ron", "--along", "a=0..1", "--set", "IPS=2"], &[said]);
    let output = tangency(at, &["trace", "m.ron", "--along", "a=0..1", "--hold", "NS"]);
    assert!(failure(&output, 2).contains("are called `TR` here"));
}

/// A mark near the grazing at which a branch begins is located at its own value: the branch with an
/// impact in a period begins at V = 0.22717758, turns, and comes back to the marks.
#[test]
fn marks_near_a_grazing_are_located() {
    let folder = folder();
    let at = folder.path();
    for mark in [0.2265, 0.2271, 0.2272, 0.228] {
        let marked = format!("voltage={mark}");
        succeeds(at, &["trace", "mita-type-1", "--mark", &marked, "--out", &marked]);
        let document = Document::load(at.join(&marked).join("mita-type-1.ron")).unwrap();
        let branch = document.branches.iter().find(|branch| branch.name == "P(1,1)").unwrap();
        let voltage = branch.column("voltage").unwrap();
        let marks: Vec<f64> =
            branch.of_kind(Kind::UZ).filter_map(|point| point.value(voltage)).collect();
        assert!(!marks.is_empty(), "{mark}");
        for value in marks.into_iter().filter(|value| (value - mark).abs() < 2e-3) {
            assert!((value - mark).abs() < 1e-10, "{value} at the mark {mark}");
        }
    }
}

/// A setting of the request takes precedence over the option of an `.ode` file.
#[test]
fn requests_take_precedence_over_options_of_files() {
    let folder = folder();
    let at = folder.path();
    let model = "x'=a*x-y-x*(x^2+y^2)\ny'=x+a*y-y*(x^2+y^2)\npar a=-1\n@ ntst=50,npr=40\ndone\n";
    std::fs::write(at.join("h.ode"), model).unwrap();
    let show = ["show", "h.ode", "--along", "a=-1..1", "--switch", "HB"];
    let stated = |more: &[&str]| succeeds(at, &[&show[..], more].concat());
    let own = stated(&[]);
    assert!(own.contains("intervals:50") && own.contains("save_every: 40"), "{own}");
    let set = stated(&["--set", "intervals=30", "--set", "save_every=7"]);
    assert!(set.contains("intervals:30") && set.contains("save_every: 7"), "{set}");
}

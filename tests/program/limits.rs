//! Sizes that no machine has, and tables that no scene writes, are refused before anything is
//! allocated.

use crate::program::command::{bytes, failure, signal, succeeds, tangency};
use std::path::Path;
use std::process::Command;
use tangency::core::failure::one_line;
use tangency::output::{Sweeps, merge};
use tangency::scene::Scene;

fn refused(folder: &Path, arguments: &[&str]) -> String {
    let output = tangency(folder, arguments);
    assert!(output.stdout.is_empty(), "refused before any work: {arguments:?}");
    failure(&output, 1).into()
}

const SCENE: &str = r#"Scene(title: "t", problem: ImpactOscillator(), parameters: [("frequency", 2.2)],
    runs: [Run(name: "r", start: Simulated(), along: [(name: "amplitude", low: 0.01, high: 0.2)])],
    sweeps: [(name: "up", over: [(name: "amplitude", low: 1, high: 5, count: 3)],
        search: (transient: 20, recorded_periods: 10, lyapunov_periods: 0))])"#;

fn folder() -> tempfile::TempDir {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("a.ron"), SCENE).unwrap();
    folder
}

#[test]
fn counts_have_limits() {
    let folder = folder();
    let with = |setting: &str| refused(folder.path(), &["sweep", "a.ron", "--set", setting]);
    for count in ["18446744073709551615", "1000000000000", "4000001"] {
        let message = with(&format!("count={count}"));
        assert!(message.contains(count) && message.contains("4000000 runs"), "{message}");
    }
    assert!(with("count=0").contains("the count of an axis is 0"));
    assert!(with("recorded_periods=0").contains(
        "the setting `recorded_periods` of the sweep is 0, but must be between 1 and 1000000"
    ));
    assert!(
        with("transient=1000000000000").contains(
            "the setting `transient` of the sweep is 1000000000000, but must be between 0"
        )
    );
    assert!(with("flow_tolerance=1e300").contains("must be between 1e-14 and 1e-3"));
    assert!(with("flow_tolerance=nan").contains("flow_tolerance"));
}

/// The product of counts is 2 in arithmetic that wraps.
#[test]
fn products_of_counts_have_limits() {
    let folder = tempfile::tempdir().unwrap();
    let axis =
        |name: &str, count: u64| format!("(name: \"{name}\", low: 0, high: 1, count: {count})");
    for (first, second) in [(6_148_914_691_236_517_206, 3), (1 << 32, 1 << 32), (2001, 2001)] {
        let over = axis("displacement", first) + "," + &axis("velocity", second);
        let text = SCENE.replace("(name: \"amplitude\", low: 1, high: 5, count: 3)", &over);
        std::fs::write(folder.path().join("a.ron"), text).unwrap();
        let message = refused(folder.path(), &["sweep", "a.ron"]);
        assert!(message.contains(&format!("{first} × {second}")), "{message}");
    }
}

#[test]
fn threads_are_no_more_than_the_work_there_is() {
    let folder = folder();
    for threads in ["3000", "18446744073709551615"] {
        let output = tangency(folder.path(), &["sweep", "a.ron", "--afresh", "--threads", threads]);
        assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    }
}

/// A matrix so large that threads eliminate its parts: the file is the same, byte for byte.
#[test]
fn results_do_not_depend_on_the_number_of_threads() {
    let (folder, m) = (folder(), 105);
    let model = format!(
        r#"Residual(unknowns: [("u[i=1..m, j=1..m]",
            "(u[i-1,j] + u[i+1,j] + u[i,j-1] + u[i,j+1] - 4*u[i,j])*(m+1)^2 + lambda*exp(u[i,j])")],
        definitions: [("m", {m}), ("u[i=0..m+1, j=0..m+1]", 0)], parameters: [("lambda", 0)],
        monitors: [("middle", "u[(m+1)/2, (m+1)/2]")], dynamics: flow)"#
    );
    std::fs::write(folder.path().join("plane.ron"), model).unwrap();
    let traced = |threads: &str| {
        let output = Command::new(env!("CARGO_BIN_EXE_tangency"))
            .env("RAYON_NUM_THREADS", threads)
            .current_dir(folder.path())
            .args(["trace", "plane.ron", "--along", "lambda=0..8", "--out", threads])
            .args(["--set", "eigenvalues=4", "--set", "max_points=3"])
            .output()
            .unwrap();
        assert!(output.status.success(), "{output:?}");
        bytes(folder.path(), &format!("{threads}/plane.ron"))
    };
    assert_eq!(traced("1"), traced("4"));
}

#[test]
fn values_are_refused_with_what_may_be_written() {
    let folder = folder();
    let with = |setting: &str| refused(folder.path(), &["trace", "a.ron", "--set", setting]);
    assert!(with("method=3").contains("known: collocation, shooting"));
    assert!(with("segments=f").contains("cannot be `f`: expected a whole number"));
    assert!(with("max_step=fast").contains("expected a number"));
    for value in ["7.5", "7, scheme: Radau5", "7)", "("] {
        let said = with(&format!("segments={value}"));
        assert!(said.contains(&format!("`segments` cannot be `{value}`: ")), "{said}");
    }
    let scene = |text: &str| Scene::parse(text).unwrap().set("orders", "3").unwrap_err();
    let plate = "Scene(title: \"t\", problem: Plate(), runs: [Run(name: \"r\", along: [(name: \"load\", low: 0, high: 1)])])";
    assert!(
        scene(plate).to_string().contains("`orders` cannot be `3`: expected `Orders(…)`"),
        "{}",
        scene(plate)
    );
}

/// What is changed in an archive, and what is said then.
type Change = (&'static str, fn(&mut Sweeps));

/// Saves an archive that was changed.
fn saved(whole: &Sweeps, change: fn(&mut Sweeps), path: &Path) -> Sweeps {
    let mut changed = whole.clone();
    change(&mut changed);
    changed.save(path).unwrap();
    changed
}

/// Archives whose tables are not those of the scene are neither continued nor merged.
#[test]
fn tables_must_be_those_of_the_scene() {
    let folder = folder();
    let path = folder.path().join("out/a.npz");
    assert!(tangency(folder.path(), &["sweep", "a.ron"]).status.success());
    let whole = Sweeps::load(&path).unwrap();
    let changes: [Change; 5] = [
        ("the sweeps of the file differ", |all| all.sweeps.clear()),
        ("the numbers of runs", |all| all.sweeps[0].total = 7),
        ("the events", |all| all.sweeps[0].events.clear()),
        ("the columns of runs", |all| {
            all.sweeps[0].run_columns.pop();
            all.sweeps[0].rows.values_mut().for_each(|row| {
                let _ = row.values.pop();
            });
        }),
        ("the columns of points", |all| {
            all.sweeps[0].point_columns.pop();
            all.sweeps[0].rows.values_mut().for_each(|row| row.points.clear());
        }),
    ];
    for (what, change) in changes {
        let changed = saved(&whole, change, &path);
        let message = refused(folder.path(), &["sweep", "a.ron", "--set", "max_points=5"]);
        assert!(message.contains("another scene"), "{message}");
        let output = tangency(folder.path(), &["sweep", "a.ron"]);
        let message = String::from_utf8(output.stderr).unwrap();
        assert!(output.status.code() == Some(1) && message.contains(what), "{what}: {message}");
        let merged = merge(vec![whole.clone(), changed]).unwrap_err().to_string();
        assert!(merged.contains(what), "{merged}");
    }
}

/// Rows that there cannot be are refused where an archive is read.
#[test]
fn rows_must_be_of_the_runs_there_are() {
    let folder = folder();
    let path = folder.path().join("out/a.npz");
    assert!(tangency(folder.path(), &["sweep", "a.ron"]).status.success());
    let whole = Sweeps::load(&path).unwrap();
    let changes: [Change; 5] = [
        ("must be 0 to 1", |all| all.sweeps[0].total = 2),
        ("number 0.5", |all| all.sweeps[0].rows.get_mut(&1).unwrap().values[0] = 0.5),
        ("number -1", |all| all.sweeps[0].rows.get_mut(&1).unwrap().values[0] = -1.0),
        ("the run 2 twice", |all| all.sweeps[0].rows.get_mut(&1).unwrap().values[0] = 2.0),
        ("must begin with the columns `run, period, event, time`", |all| {
            all.sweeps[0].point_columns.clear();
            all.sweeps[0].rows.clear();
        }),
    ];
    for (what, change) in changes {
        saved(&whole, change, &path);
        let message = one_line(&Sweeps::load(&path).unwrap_err());
        assert!(message.contains(what), "{what}: {message}");
    }
}

/// Ten thousand runs are checked in a time that is not felt: each by itself.
#[test]
fn scenes_of_many_runs_are_read() {
    let run = |k: usize| {
        format!(
            "Run(name: \"r{k}\", set: [(\"frequency\", \"2\")], start: Simulated(), along: [(name: \
             \"amplitude\", low: 0.1, high: 0.2)])"
        )
    };
    let runs: Vec<String> = (0..10_000).map(run).collect();
    let text =
        format!("Scene(title: \"t\", problem: ImpactOscillator(), runs: [{}])", runs.join(","));
    assert_eq!(Scene::parse(&text).unwrap().runs.len(), 10_000);
}

/// Work of more than a minute is said before it begins, and ends inside a run when a signal asks
/// for it.
#[test]
#[cfg(unix)]
fn long_work_is_announced_and_can_be_ended() {
    use std::io::Read;
    let folder = folder();
    let mut child = Command::new(env!("CARGO_BIN_EXE_tangency"))
        .current_dir(folder.path())
        .args(["sweep", "a.ron", "--set", "transient=1000000000"])
        .stdout(std::process::Stdio::null())
        .stderr(std::process::Stdio::piped())
        .spawn()
        .unwrap();
    let mut stderr = child.stderr.take().unwrap();
    let mut said = vec![0; 20];
    stderr.read_exact(&mut said).unwrap();
    signal("-INT", &child);
    let mut rest = String::new();
    stderr.read_to_string(&mut rest).unwrap();
    let said = String::from_utf8(said).unwrap() + &rest;
    assert_eq!(child.wait().unwrap().code(), Some(1), "{said}");
    assert!(said.contains("`up`: 3 runs of up to 1000000010 periods, on "), "{said}");
    assert!(said.contains("interrupted"), "{said}");
}

/// A run that is ended within its start, by simulation or by correction, has no point; what was
/// done before is kept.
#[test]
#[cfg(unix)]
fn long_starts_can_be_ended() {
    use std::io::{BufRead, BufReader, Read};
    let folder = tempfile::tempdir().unwrap();
    // The period of the forcing has 10⁵ of the motion's own in the second run.
    let text = r#"Scene(title: "t",
        problem: Equations(states: [("x", "v"), ("v", "a*cos(t) - w^2*x - v")], period: "2*pi", solution: orbit, method: shooting(segments: 500)),
        parameters: [("a", 1), ("w", 2)],
        runs: [Run(name: "slow", along: [(name: "a", low: 0.5, high: 3)]),
            Run(name: "fast", START set: [("w", "1e5")], along: [(name: "a", low: 0.5, high: 3)])])"#;
    for (start, announced) in
        [("", ""), ("start: Simulated(transient: 1e6),", "motion over a time of ")]
    {
        std::fs::write(folder.path().join("b.ron"), text.replace("START", start)).unwrap();
        let mut command = Command::new(env!("CARGO_BIN_EXE_tangency"));
        command.current_dir(folder.path()).args(["trace", "b.ron"]);
        let pipe = std::process::Stdio::piped;
        let mut child = command.stdout(pipe()).stderr(pipe()).spawn().unwrap();
        let mut lines = BufReader::new(child.stdout.take().unwrap()).lines().map(Result::unwrap);
        // The second end of the first run.
        let ends = lines.by_ref().filter(|line| line.contains(" EP "));
        assert_eq!(ends.take(2).count(), 2);
        let mut stderr = child.stderr.take().unwrap();
        let mut said = vec![0; announced.len()];
        stderr.read_exact(&mut said).unwrap();
        signal("-INT", &child);
        let rest: Vec<String> = lines.collect();
        let mut more = String::new();
        stderr.read_to_string(&mut more).unwrap();
        let said = String::from_utf8(said).unwrap() + &more;
        assert_eq!(child.wait().unwrap().code(), Some(1), "{said}");
        assert!(said.contains(announced) && said.contains("interrupted"), "{said}");
        assert!(!rest.iter().any(|line| line.contains("fast")), "{rest:?}");
        let document = tangency::output::Document::load(folder.path().join("out/b.ron")).unwrap();
        assert_eq!(document.branches.len(), 1);
    }
}

/// A picture in columns that nothing will have is refused before any work.
#[test]
fn pictures_are_checked_before_the_work() {
    let folder = folder();
    let scene = |name: &str| {
        let built_in = tangency::scene::BUILT_IN.iter().find(|scene| scene.name == name);
        Scene::parse(built_in.unwrap().text).unwrap()
    };
    // Sweeps, local maps and histories, too.
    for name in ["mita-diagram", "mita-near-grazing-1", "mita-histories", "mita-basins"] {
        let mut scene = scene(name);
        assert_eq!(scene.check_plot(), Ok(()), "{name}");
        scene.plot.panels.push(("velocty".into(), "velocty".into()));
        let message = one_line(&scene.check_plot().unwrap_err());
        assert!(message.contains("unknown column `velocty`"), "{name}: {message}");
    }
    let text = SCENE.replace("sweeps:", "plot: (y: Some(\"speed\")), sweeps:");
    std::fs::write(folder.path().join("a.ron"), text).unwrap();
    for command in ["trace", "sweep"] {
        let message = refused(folder.path(), &[command, "a.ron"]);
        assert!(message.contains("unknown column `speed`"), "{message}");
    }
}

/// Values without a physical meaning are refused by the problems.
#[test]
fn values_without_a_meaning_are_refused() {
    let folder = folder();
    for (scene, value, said) in [
        ("plate-clamped", "gap_ratio=-1", "gap_ratio = -1"),
        ("mita-type-1", "restitution=-0.5", "restitution = -5.0"),
        ("mita-type-1", "damping=-1", "damping = -1"),
        ("mita-type-1", "static_friction=-1", "static_friction = -1"),
    ] {
        let output = tangency(folder.path(), &["trace", scene, "--set", value]);
        let message = String::from_utf8(output.stderr).unwrap();
        assert_eq!(output.status.code(), Some(1), "{message}");
        assert!(message.contains(said) && message.contains("positive value or 0"), "{message}");
    }
}

/// Settings of another method or model are refused, unless a run uses it.
#[test]
fn settings_without_effect_are_refused() {
    let folder = folder();
    for (scene, setting, said) in [
        ("bratu", "segments=10", "`segments` has no effect where `method` is `collocation`"),
        ("mita-type-1", "intervals=10", "`intervals` has no effect where `method` is `shooting`"),
        ("plate-clamped", "modes=10000", "`modes` has no effect where `model` is `ritz`"),
    ] {
        let message = refused(folder.path(), &["trace", scene, "--set", setting]);
        assert!(message.contains(said) && message.contains("or keep it and change"), "{message}");
    }
    let both = ["show", "bratu", "--set", "segments=10", "--set", "method=shooting"];
    assert!(tangency(folder.path(), &both).status.success());
}

/// Messages are short, and lists are cut between names.
#[test]
fn messages_are_short_and_whole() {
    let folder = folder();
    let at = folder.path();
    let unknown = refused(at, &["trace", "nosuchscene"]);
    let (_, list) = unknown.split_once("known: ").unwrap();
    let (list, _) = list.split_once("(58 in all)").unwrap_or((list, ""));
    let known = succeeds(at, &["scenes"]);
    for name in list.split([',', ' ']).filter(|name| !name.is_empty() && *name != "…") {
        assert!(known.lines().any(|line| line.split_whitespace().next() == Some(name)), "{name}");
    }
    let threads = tangency(at, &["sweep", "a.ron", "--threads", "0"]);
    assert!(failure(&threads, 2).contains("a whole number of at least 1"));
    let grows = "Equations(states: [(\"x\", \"x^2\")], initial: [(\"x\", 1)])";
    std::fs::write(at.join("grows.ron"), grows).unwrap();
    let message = refused(at, &["simulate", "grows.ron", "--time", "2"]);
    assert!(message.contains("the solution grows without bound: at t = 1.0"), "{message}");
    assert!(!message.contains("in mode"), "{message}");
    // This solution is singular where x vanishes, but bounded.
    let stops = "Equations(states: [(\"x\", \"-1/x\")], initial: [(\"x\", 1)])";
    std::fs::write(at.join("stops.ron"), stops).unwrap();
    let message = refused(at, &["simulate", "stops.ron", "--time", "2"]);
    assert!(!message.contains("without bound"), "{message}");
    let decay = "Equations(states: [(\"x\", \"a - x\")], parameters: [(\"a\", 0)])";
    std::fs::write(at.join("decay.ron"), decay).unwrap();
    let trace = ["trace", "decay.ron", "--set", "solution=equilibrium", "--along", "a=0..9"];
    let said = succeeds(at, &[&trace[..], &["--set", "max_points=5"]].concat());
    let line = said.lines().find(|line| line.starts_with("branch: ")).unwrap();
    assert_eq!(line.matches("max_points").count(), 1, "{line}");
}

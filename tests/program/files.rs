//! Files that are read and written: what is refused, what is replaced, and that results belong
//! together.

use crate::program::command::{bytes, failure, refused, signal, succeeds, tangency};
use std::path::Path;
use std::process::{Command, Stdio};
use tangency::output::{Document, Sweeps, example_branch};

/// Two short sweeps, and a branch.
pub(super) const SCENE: &str = r#"Scene(
    title: "Up", plot: (x: "amplitude", y: "max_displacement"), problem: ImpactOscillator(), parameters: [("frequency", 2.2), ("amplitude", 0.5)],
    runs: [(name: "P(0,1)", start: Simulated(state: [("displacement", 0.0)], transient: 50), along: [(name: "amplitude", low: 0.5, high: 1.0)])],
    sweeps: [(name: "up", order: up, strands: 3, over: [(name: "amplitude", low: 1, high: 5, count: 6)],
        search: (transient: 40, recorded_periods: 20, lyapunov_periods: 0), measures: ["max_displacement"])],
)"#;

/// A folder with `a.ron`, a document, and `up.ron`, a scene.
pub(super) fn folder() -> tempfile::TempDir {
    let folder = tempfile::tempdir().unwrap();
    let document = Document::new("Pull-in", vec![example_branch()]);
    document.save(folder.path().join("a.ron")).unwrap();
    std::fs::write(folder.path().join("up.ron"), SCENE).unwrap();
    folder
}

pub(super) fn names(folder: &Path) -> Vec<String> {
    let entries = folder.read_dir().unwrap();
    let mut names: Vec<String> =
        entries.map(|entry| entry.unwrap().file_name().into_string().unwrap()).collect();
    names.sort();
    names
}

/// C2. Devices, FIFOs, sockets and folders are not replaced; symbolic links to regular files are
/// followed.
#[cfg(unix)]
#[test]
fn only_regular_files_are_replaced() {
    use std::os::unix::fs::symlink;
    let folder = folder();
    let at = folder.path();
    assert!(Command::new("mkfifo").arg(at.join("fifo.svg")).status().unwrap().success());
    let _socket = std::os::unix::net::UnixListener::bind(at.join("socket.svg")).unwrap();
    std::fs::create_dir(at.join("folder.svg")).unwrap();
    std::fs::write(at.join("target"), "old").unwrap();
    symlink("target", at.join("link.svg")).unwrap();
    symlink("/dev/null", at.join("null.svg")).unwrap();
    symlink("nowhere", at.join("dangling.svg")).unwrap();
    for (name, said) in [
        ("fifo.svg", "is a FIFO"),
        ("socket.svg", "is a socket"),
        ("folder.svg", "is a folder"),
        ("null.svg", "is a symbolic link to something other than a regular file"),
        ("dangling.svg", "is a dangling symbolic link"),
    ] {
        let kind = |name: &str| at.join(name).symlink_metadata().unwrap().file_type();
        let before = kind(name);
        refused(at, &["plot", "a.ron", "--out", name], &[name, said, "--out"]);
        assert_eq!(kind(name), before);
    }
    succeeds(at, &["plot", "a.ron", "--out", "link.svg"]);
    assert!(at.join("link.svg").symlink_metadata().unwrap().is_symlink());
    assert!(bytes(at, "target").starts_with(b"<svg"));
    // Results of a trace are refused before the work.
    std::fs::create_dir(at.join("out")).unwrap();
    symlink("/dev/null", at.join("out/bratu.svg")).unwrap();
    refused(at, &["trace", "bratu"], &["out/bratu.svg is a symbolic link to something other"]);
    assert_eq!(names(&at.join("out")), ["bratu.svg"]);
}

/// C3. Control characters are refused where files are read, and escaped in messages.
#[test]
fn control_characters_are_refused_and_escaped() {
    let folder = folder();
    let at = folder.path();
    let text = String::from_utf8(bytes(at, "a.ron")).unwrap();
    for (from, to, place) in [
        (
            "title: \"Pull-in\"",
            "title: \"Pull\\u{1b}[31m-in\"",
            "the title is \"Pull\\u{1b}[31m-in\"",
        ),
        ("name: \"plate\"", "name: \"pl\\nate\"", "the name of a branch is \"pl\\nate\""),
        ("\"deflection\"", "\"de\\u{0}\"", "branch `plate`: a column is"),
    ] {
        assert!(text.contains(from), "{from}");
        std::fs::write(at.join("bad.ron"), text.replace(from, to)).unwrap();
        for command in ["table", "plot"] {
            refused(at, &[command, "bad.ron"], &["bad.ron: ", place, "control characters"]);
        }
    }
    for (from, to, place) in [
        ("title: \"Up\"", "title: \"\\u{7}\"", "the title is \"\\u{7}\""),
        ("name: \"P(0,1)\"", "name: \"\\u{1b}\"", "the name of a run is \"\\u{1b}\""),
        ("name: \"up\"", "name: \"\\t\"", "the name of a sweep is \"\\t\""),
    ] {
        std::fs::write(at.join("bad.ron"), SCENE.replace(from, to)).unwrap();
        refused(at, &["sweep", "bad.ron"], &["bad.ron: ", place, "control characters"]);
    }
    // No argument holds any, whatever it is.
    for argument in ["\u{1b}[2J", "a\nb", "a\u{1b}b.ron"] {
        let output = tangency(at, &["plot", "a.ron", "--y", argument]);
        let message = std::str::from_utf8(&output.stderr).unwrap();
        assert_eq!(output.status.code(), Some(2), "{message}");
        assert!(message.contains("contains control characters"), "{message}");
        assert!(!message.trim_end().contains(char::is_control), "{message:?}");
    }
}

/// Figures of a library's user may hold anything: the SVG is well-formed.
#[test]
fn svg_is_well_formed_whatever_it_says() {
    use tangency::output::{Figure, PAGE, Series, Style, draw};
    let strange = "<b>&\u{0}\u{1b}\u{ffff}\"'\n";
    let line = |name| Series::new(name, Style::Solid, [[0.0, 0.0], [1.0, 2.0]]);
    let figure = Figure::new(strange, strange, strange).with(line(strange)).with(line("b"));
    let svg = draw(&[figure], PAGE).unwrap();
    let foreign = |c: char| (c.is_control() && c != '\n') || c == '\u{ffff}';
    assert!(!svg.contains(foreign) && !svg.contains("<b>") && svg.contains("&lt;b&gt;&amp;"));
}

/// C4. What is read is never overwritten, by any command.
#[test]
fn inputs_are_never_overwritten() {
    let folder = folder();
    let at = folder.path();
    succeeds(at, &["sweep", "up.ron"]);
    let before = bytes(at, "out/up.npz");
    refused(
        at,
        &["merge", "out/up.npz"],
        &["out/up.npz is also an input file, and input files are not overwritten"],
    );
    let link = "./out/../out/up.npz";
    refused(
        at,
        &["merge", link, "--out", "out"],
        &["is also an input file, and input files are not overwritten"],
    );
    refused(at, &["sweep", "up.ron", "--out", "."], &["./up.ron is also an input", "--out"]);
    refused(at, &["plot", "a.ron", "out/up.npz", "--out", "a.ron"], &["a.ron is also an input"]);
    // The file that a scene reads its equations from is one, too.
    let equations = "Equations(states: [(\"x\", \"r - x\")], parameters: [(\"r\", 1)])";
    let scene =
        "Scene(title: \"t\", problem: Equations(model: \"out/s.ron\", solution: equilibrium),
        runs: [Run(name: \"r\", along: [(name: \"r\", low: 0, high: 2)])])";
    std::fs::write(at.join("out/s.ron"), equations).unwrap();
    std::fs::write(at.join("s.ron"), scene).unwrap();
    refused(
        at,
        &["trace", "s.ron"],
        &["out/s.ron is also an input file, and input files are not overwritten"],
    );
    succeeds(at, &["trace", "s.ron", "--out", "else"]);
    assert!(bytes(at, "out/up.npz") == before && bytes(at, "up.ron") == SCENE.as_bytes());
}

/// C5. A device is read up to the limit, a FIFO only if somebody writes to it.
#[cfg(unix)]
#[test]
fn devices_and_fifos_are_read_up_to_the_limit() {
    let folder = folder();
    let at = folder.path();
    refused(
        at,
        &["table", "/dev/zero", "--max-size", "1"],
        &["/dev/zero is larger than the limit of 1 MB"],
    );
    let fifo = at.join("fifo.ron");
    assert!(Command::new("mkfifo").arg(&fifo).status().unwrap().success());
    refused(at, &["table", "fifo.ron"], &["fifo.ron is a FIFO", "produced no data"]);
    let content = bytes(at, "a.ron");
    let writer = std::thread::spawn(move || std::fs::write(fifo, content).unwrap());
    assert_eq!(succeeds(at, &["table", "fifo.ron"]).lines().count(), 5);
    writer.join().unwrap();
}

/// While a command waits for somebody who writes to a FIFO, nothing is done yet: a signal ends the
/// program at once.
#[cfg(unix)]
#[test]
fn a_signal_ends_the_wait_for_a_fifo() {
    use std::os::unix::process::ExitStatusExt;
    use std::time::{Duration, Instant};
    let folder = tempfile::tempdir().unwrap();
    assert!(Command::new("mkfifo").arg(folder.path().join("f.ron")).status().unwrap().success());
    for command in ["trace", "find", "sweep", "simulate"] {
        let mut program = Command::new(env!("CARGO_BIN_EXE_tangency"));
        let program = program.current_dir(folder.path()).args([command, "f.ron"]);
        let child = program.stderr(Stdio::piped()).spawn().unwrap();
        // The program opens the FIFO in another thread.
        let tasks = format!("/proc/{}/task", child.id());
        let began = Instant::now();
        while std::fs::read_dir(&tasks).is_ok_and(|tasks| tasks.count() < 2)
            && began.elapsed() < Duration::from_secs(3)
        {
            std::thread::sleep(Duration::from_millis(5));
        }
        signal("-INT", &child);
        let output = child.wait_with_output().unwrap();
        assert_eq!(output.status.signal(), Some(2), "{command}");
        assert!(output.stderr.is_empty(), "{command}: {}", String::from_utf8_lossy(&output.stderr));
    }
}

/// D7. A standard output that is closed, as `>&-` does, is like `/dev/null`: what is saved is whole.
#[cfg(unix)]
#[test]
fn a_closed_standard_output_loses_no_file() {
    let folder = folder();
    let program = env!("CARGO_BIN_EXE_tangency");
    for (out, closed) in [("open", ""), ("closed", " >&-")] {
        let line = format!("{program} trace up.ron --out {out}{closed}");
        let status = Command::new("sh").args(["-c", &line]).current_dir(folder.path()).output();
        assert!(status.unwrap().status.success());
    }
    for name in ["up.ron", "up.svg"] {
        let [open, closed] =
            ["open", "closed"].map(|out| bytes(folder.path(), &format!("{out}/{name}")));
        assert!(open == closed, "{name}");
    }
}

/// A trace of many short steps, when it is under way.
#[cfg(unix)]
fn trace_begun(folder: &Path) -> std::process::Child {
    use std::io::{BufRead, BufReader};
    let mut command = Command::new(env!("CARGO_BIN_EXE_tangency"));
    command.current_dir(folder).args(["trace", "plate-clamped"]);
    for setting in
        ["max_step=0.0002", "max_points=100000", "orders=(transverse: (8, 8), in_plane: (10, 10))"]
    {
        command.args(["--set", setting]);
    }
    let mut child = command.stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().unwrap();
    // The name, the header and the start.
    BufReader::new(child.stdout.as_mut().unwrap())
        .lines()
        .take(3)
        .for_each(|line| drop(line.unwrap()));
    child
}

/// E1. SIGTERM and SIGHUP keep what is done.
#[cfg(unix)]
#[test]
fn signals_that_ask_for_the_end_keep_what_is_done() {
    for name in ["-TERM", "-HUP"] {
        let folder = tempfile::tempdir().unwrap();
        let mut child = trace_begun(folder.path());
        signal(name, &child);
        // So that a full pipe does not keep it from ending.
        std::io::copy(child.stdout.as_mut().unwrap(), &mut std::io::sink()).unwrap();
        let output = child.wait_with_output().unwrap();
        assert_eq!(
            failure(&output, 1),
            "error: the command was interrupted; all results computed before the interruption are saved\n"
        );
        assert_eq!(names(&folder.path().join("out")), ["plate-clamped.ron", "plate-clamped.svg"]);
        let document = Document::load(folder.path().join("out/plate-clamped.ron")).unwrap();
        assert!(!document.branches[0].points.is_empty());
    }
}

/// Under `nohup` a run outlives its terminal.
#[cfg(target_os = "linux")]
#[test]
fn nohup_is_respected() {
    let folder = tempfile::tempdir().unwrap();
    let script = "trap '' HUP; '$0' trace bratu & kill -HUP $!; wait $!";
    let script = script.replace("'$0'", &format!("'{}'", env!("CARGO_BIN_EXE_tangency")));
    let output =
        Command::new("sh").args(["-c", &script]).current_dir(folder.path()).output().unwrap();
    assert!(output.status.success(), "{output:?}");
    assert_eq!(names(&folder.path().join("out")), ["bratu.ron", "bratu.svg"]);
}

/// A result that another run is writing is refused, with its process; a killed run is in nobody's
/// way.
#[cfg(unix)]
#[test]
fn two_runs_do_not_write_one_result() {
    let folder = tempfile::tempdir().unwrap();
    let at = folder.path();
    let mut child = trace_begun(at);
    let process = format!("process {},", child.id());
    let said = ["another run, ", &process, "is writing out/plate-clamped", "another folder"];
    refused(at, &["trace", "plate-clamped"], &said);
    assert_eq!(names(&at.join("out")), [".plate-clamped.lock"]);
    // Another result in the same folder is nobody's business.
    succeeds(at, &["trace", "bratu"]);
    child.kill().unwrap();
    child.wait().unwrap();
    assert!(names(&at.join("out")).contains(&".plate-clamped.lock".to_string()));
    succeeds(at, &["trace", "plate-clamped"]);
    let all = ["bratu.ron", "bratu.svg", "plate-clamped.ron", "plate-clamped.svg"];
    assert_eq!(names(&at.join("out")), all);
}

/// E2. Temporary files of killed runs are removed by the next run that writes there, those of live
/// ones are not.
#[test]
fn temporary_files_without_a_writer_are_removed() {
    let folder = tempfile::tempdir().unwrap();
    let at = folder.path();
    std::fs::create_dir(at.join("out")).unwrap();
    for name in [
        ".bratu.ron.12345.tmp",
        ".bratu.svg.99-1.tmp",
        ".bratu.svg.77.tmp",
        // None of these is a temporary file of this result.
        ".bratu.ron.tmp",
        ".bratu.ron.x.tmp",
        ".other.ron.12345.tmp",
        "bratu.ron.12345.tmp",
    ] {
        std::fs::write(at.join("out").join(name), "half").unwrap();
    }
    // Its writer is alive.
    let live = std::fs::File::options().write(true).open(at.join("out/.bratu.svg.77.tmp")).unwrap();
    live.lock().unwrap();
    succeeds(at, &["trace", "bratu"]);
    let left = [
        ".bratu.ron.tmp",
        ".bratu.ron.x.tmp",
        ".bratu.svg.77.tmp",
        ".other.ron.12345.tmp",
        "bratu.ron",
        "bratu.ron.12345.tmp",
        "bratu.svg",
    ];
    assert_eq!(names(&at.join("out")), left);
}

/// E3. If one file of a result cannot be written, none is replaced.
#[test]
fn files_of_a_result_are_replaced_together() {
    use tangency::output::write_together;
    let folder = tempfile::tempdir().unwrap();
    let [a, b, c] = ["a.ron", "b.svg", "file/c.svg"].map(|name| folder.path().join(name));
    write_together(&[(&a, "1"), (&b, "1")]).unwrap();
    std::fs::write(folder.path().join("file"), "in the way").unwrap();
    write_together(&[(&a, "2"), (&b, "2"), (&c, "2")]).unwrap_err();
    assert_eq!([&a, &b].map(|path| std::fs::read_to_string(path).unwrap()), ["1", "1"]);
    assert_eq!(names(folder.path()), ["a.ron", "b.svg", "file"]);
}

/// A picture that cannot be drawn is refused before the work, which leaves everything as it was.
#[test]
fn no_work_is_done_for_a_picture_that_cannot_be() {
    let folder = folder();
    let at = folder.path();
    succeeds(at, &["sweep", "up.ron"]);
    let scene = SCENE.replace("y: \"max_displacement\"", "y: \"nothing\"");
    std::fs::write(at.join("up.ron"), scene).unwrap();
    let old = bytes(at, "out/up.npz");
    refused(at, &["sweep", "up.ron", "--afresh"], &["unknown column `nothing`"]);
    assert!(bytes(at, "out/up.npz") == old);
    assert_eq!(names(&at.join("out")), ["up.npz", "up.ron", "up.svg"]);
}

/// Orbits as data: the profiles of special points, with a row for each time.
#[test]
fn orbits_are_written_as_tables_and_arrays() {
    let folder = folder();
    let at = folder.path();
    succeeds(at, &["trace", "up.ron"]);
    succeeds(at, &["plot", "out/up.ron", "--points", "1", "--out", "orbit.csv"]);
    let table = String::from_utf8(bytes(at, "orbit.csv")).unwrap();
    let mut lines = table.lines();
    assert_eq!(lines.next(), Some("branch,label,time,displacement,velocity"));
    assert!(lines.all(|line| line.starts_with("\"P(0,1)\",1,")), "{table}");
    succeeds(at, &["plot", "out/up.ron", "--points", "1", "--out", "orbit.npz"]);
    let archive = bytes(at, "orbit.npz");
    let holds = |name: &str| archive.windows(name.len()).any(|bytes| bytes == name.as_bytes());
    assert!(["time.npy", "displacement.npy", "velocity.npy"].into_iter().all(holds));
    // Orbits of two documents have distinct names, and options without effect are refused.
    std::fs::copy(at.join("out/up.ron"), at.join("b.ron")).unwrap();
    succeeds(at, &["plot", "out/up.ron", "b.ron", "--points", "1,1", "--out", "two.csv"]);
    let table = String::from_utf8(bytes(at, "two.csv")).unwrap();
    assert!(table.contains("up.ron: P(0,1)\",1,") && table.contains("\"b.ron: P(0,1)\",1,"));
    for more in [["--y", "max_velocity", "c.npz"], ["--x", "amplitude", "c.svg"]] {
        let [option, column, out] = more;
        let arguments = ["plot", "out/up.ron", "--points", "1", option, column, "--out", out];
        refused(at, &arguments, &["cannot be combined with", option]);
    }
    // A picture of other columns does not replace the one that was traced.
    let traced = bytes(at, "out/up.svg");
    let said = succeeds(at, &["plot", "out/up.ron", "--y", "min_displacement"]);
    assert_eq!(said.trim(), "out/up-min_displacement.svg");
    assert_eq!(bytes(at, "out/up.svg"), traced);
}

/// The format of a picture follows the ending of its name.
#[test]
fn formats_follow_endings() {
    let folder = folder();
    let at = folder.path();
    succeeds(at, &["plot", "a.ron", "--out", "b.SVG"]);
    succeeds(at, &["plot", "a.ron", "a.ron", "--out", "b.csv"]);
    let table = String::from_utf8(bytes(at, "b.csv")).unwrap();
    let points = example_branch().points.len();
    assert_eq!(table.lines().count(), 1 + 2 * points);
    assert!(
        table.starts_with("file,branch,point,load,aspect_ratio,deflection,unstable,admissible\n")
    );
    assert!(table.contains("\na.ron,plate,0,"), "{table}");
    for name in ["b.jpg", "b", "b.svg.gif"] {
        let known = "known: .svg, .png, .pdf, .html, .csv";
        refused(at, &["plot", "a.ron", "--out", name], &[name, known]);
    }
    for (name, beginning) in [("b.pdf", "%PDF-1.7"), ("b.html", "<!doctype html>")] {
        succeeds(at, &["plot", "a.ron", "--out", name]);
        assert!(bytes(at, name).starts_with(beginning.as_bytes()), "{name}");
    }
    refused(at, &["plot", "a.ron", "--out", "b.html", "--width", "84"], &["--width"]);
    succeeds(at, &["plot", "a.ron", "--log", "load"]);
    assert!(bytes(at, "a-log-load.svg").starts_with(b"<svg"));
    refused(at, &["plot", "a.ron", "--log", "loads"], &["loads", "did you mean `load`"]);
    let other = ["plot", "a.ron", "--log", "aspect_ratio"];
    refused(at, &other, &["no axis shows only aspect_ratio"]);
    for more in [&["--x", "load"][..], &["--y", "load"]] {
        let arguments = [&["plot", "a.ron", "--out", "c.csv"][..], more].concat();
        refused(at, &arguments, &["cannot be combined with", more[0]]);
    }
    succeeds(at, &["plot", "a.ron", "--out", "b.png"]);
    assert!(bytes(at, "b.png").starts_with(b"\x89PNG"));
    succeeds(at, &["plot", "a.ron", "--out", "b.csv", "--separator", ";"]);
    let other = String::from_utf8(bytes(at, "b.csv")).unwrap();
    assert!(other.starts_with("branch;point;load;aspect_ratio;deflection;unstable;admissible\n"));
    let only = ["--separator and --decimal apply to comma-separated values"];
    refused(at, &["plot", "a.ron", "--separator", ";"], &only);
    refused(at, &["table", "a.ron", "--decimal", "comma"], &only);
    // Spreadsheets in German read commas in numbers.
    for decimal in ["plot", "table"] {
        succeeds(at, &[decimal, "a.ron", "--out", "g.csv", "--decimal", "comma"]);
        let table = String::from_utf8(bytes(at, "g.csv")).unwrap();
        assert!(table.contains(";0,14") && !table.contains("0."), "{table}");
    }
    refused(
        at,
        &["plot", "a.ron", "--out", "g.csv", "--decimal", "comma", "--separator", ","],
        &["a comma cannot be both the separator of columns and the decimal sign", "help: "],
    );
    succeeds(at, &["plot", "a.ron", "--out", "b.json"]);
    let json: serde_json::Value = serde_json::from_slice(&bytes(at, "b.json")).unwrap();
    let special = &json["branches"][0]["special"][2];
    assert_eq!((&special["kind"], &special["parameters"][0]), (&"LP".into(), &(4.0 / 27.0).into()));
    succeeds(at, &["sweep", "up.ron"]);
    succeeds(at, &["plot", "out/up.npz", "--out", "up.csv"]);
    let table = String::from_utf8(bytes(at, "up.csv")).unwrap();
    let header = "sweep,run,amplitude,period,event,time,displacement,velocity,max_displacement,\
                  periods,impact,leave,accumulations,exponent,exponent_error,failure\n";
    assert!(table.starts_with(header), "{}", &table[..120]);
    let rows: Vec<Vec<&str>> = table.lines().skip(1).map(|row| row.split(',').collect()).collect();
    for run in 0..6 {
        let own = || rows.iter().filter(|row| row[1] == run.to_string());
        assert!(own().any(|row| row[4].is_empty() && row[5] == "0"), "no period of {run}");
        let amplitude = 1.0 + 0.8 * f64::from(run);
        assert!(own().all(|row| (row[2].parse::<f64>().unwrap() - amplitude).abs() < 1e-14));
    }
    // Every row of a run contains the results of the run.
    let saved = Sweeps::load(at.join("out/up.npz")).unwrap();
    for row in &rows {
        let run = &saved.sweeps[0].rows[&row[1].parse().unwrap()];
        let column = |name| saved.sweeps[0].run_columns.iter().position(|it| it == name).unwrap();
        for (cell, name) in [(9, "periods"), (10, "impact"), (13, "exponent")] {
            let (cell, value) = (row[cell].parse().unwrap_or(f64::NAN), run.values[column(name)]);
            let same = cell == value || cell.is_nan() && value.is_nan();
            assert!(same || (cell - value).abs() <= 1e-12, "{name}: {cell} instead of {value}");
        }
    }
    let named = ["plot", "out/up.npz", "--out", "up.json"];
    let output = tangency(at, &named);
    let said = failure(&output, 1);
    assert!(
        said.contains("one whole document of branches") && !said.contains("--points"),
        "{said}"
    );
    // The wall is at 1.
    let impacts: Vec<_> = rows.iter().filter(|row| row[4] == "impact").collect();
    assert!(!impacts.is_empty() && impacts.iter().all(|row| row[6] == "1"), "{impacts:?}");
    refused(at, &["plot", "a.ron", "a.ron", "--out", "b.json"], &["contains one whole document"]);
    succeeds(at, &["plot", "a.ron", "--width", "84", "--panel", "a"]);
    let picture = String::from_utf8(bytes(at, "a-panel=a-width=84.svg")).unwrap();
    assert!(picture.starts_with("<svg width=\"84mm\""));
    refused(at, &["plot", "a.ron", "--panel", "b"], &["no panel `b`; its panels are a"]);
    refused(at, &["plot", "a.ron", "--width", "3"], &["between 40 and 1000 mm"]);
    refused(
        at,
        &["plot", "a.ron", "--out", "b.csv", "--width", "84"],
        &["cannot be combined with --width"],
    );
}

/// D4. How often a sweep saves has a range.
#[test]
fn checkpoints_have_a_range() {
    let folder = folder();
    for seconds in ["nan", "-1", "inf", "1e7", "x"] {
        let argument = format!("--checkpoint={seconds}");
        let output = tangency(folder.path(), &["sweep", "up.ron", &argument]);
        let message = String::from_utf8(output.stderr).unwrap();
        assert_eq!(output.status.code(), Some(2), "{message}");
        assert!(message.contains("between 0 and 1e6"), "{message}");
    }
    succeeds(folder.path(), &["sweep", "up.ron", "--checkpoint", "0"]);
}

/// A3. A regression test on the table sees what has not converged.
#[test]
fn tables_say_what_has_not_converged() {
    let folder = tempfile::tempdir().unwrap();
    let mut document = Document::new("Pull-in", vec![example_branch()]);
    document.branches[0].special[2].converged = false;
    document.save(folder.path().join("a.ron")).unwrap();
    let table = succeeds(folder.path(), &["table", "a.ron", "--csv"]);
    let column = table.lines().next().unwrap().split(',').position(|name| name == "converged");
    let cells: Vec<&str> =
        table.lines().map(|line| line.split(',').nth(column.unwrap()).unwrap()).collect();
    assert_eq!(cells, ["converged", "true", "true", "false", "true"]);
    // What has not converged has no error, only a bracket.
    let column = table.lines().next().unwrap().split(',').position(|name| name == "error");
    let cells: Vec<bool> = table
        .lines()
        .map(|line| line.split(',').nth(column.unwrap()).unwrap().is_empty())
        .collect();
    assert_eq!(cells, [false, false, false, true, false]);
}

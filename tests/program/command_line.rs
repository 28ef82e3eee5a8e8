//! The binary as a user meets it: outputs, messages and exit codes.

use crate::program::command::{failure, tangency};
use std::path::Path;
use std::process::{Command, Output, Stdio};
use tangency::output::{Document, example_branch};
use tangency::scene::{BUILT_IN, LIBRARY};

/// A folder with `a.ron` and `b.ron`.
fn folder() -> tempfile::TempDir {
    let folder = tempfile::tempdir().unwrap();
    let document = Document::new("Pull-in", vec![example_branch()]);
    document.save(folder.path().join("a.ron")).unwrap();
    document.save(folder.path().join("b.ron")).unwrap();
    folder
}

fn stdout(output: &Output) -> &str {
    std::str::from_utf8(&output.stdout).unwrap()
}

#[test]
fn special_points_are_a_table() {
    let folder = folder();
    let output = tangency(folder.path(), &["table", "a.ron", "--csv"]);
    assert!(output.status.success());
    let lines: Vec<&str> = stdout(&output).lines().collect();
    assert_eq!(
        lines[0],
        "branch,label,kind,load,aspect_ratio,deflection,error,unstable,converged,multiplicity"
    );
    assert_eq!(lines[3], "plate,3,LP,0.148148148148148,1.2,0.333333333333333,2.5e-15,0,true,1");
    assert_eq!(lines.len(), 5);
}

#[test]
fn a_reader_may_leave() {
    let folder = tempfile::tempdir().unwrap();
    let mut document = Document::new("Pull-in", Vec::new());
    // More than a pipe holds.
    for index in 0..1000 {
        let mut branch = example_branch();
        branch.name = format!("branch {index}");
        branch.points.truncate(1);
        branch.special.iter_mut().for_each(|point| point.after = 0);
        document.branches.push(branch);
    }
    document.save(folder.path().join("a.ron")).unwrap();
    let mut child = Command::new(env!("CARGO_BIN_EXE_tangency"))
        .args(["table", "a.ron", "--csv"])
        .current_dir(folder.path())
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .unwrap();
    drop(child.stdout.take());
    let output = child.wait_with_output().unwrap();
    let message = String::from_utf8_lossy(&output.stderr);
    assert_eq!((output.status.code(), &*message), (Some(0), ""), "nobody reads on");
    let full = std::fs::OpenOptions::new().write(true).open("/dev/full").unwrap();
    let mut points = Command::new(env!("CARGO_BIN_EXE_tangency"));
    let points = points.args(["table", "a.ron", "--csv"]).current_dir(folder.path());
    let output = points.stdout(full).stderr(Stdio::piped()).output().unwrap();
    let message = String::from_utf8_lossy(&output.stderr);
    assert_eq!(output.status.code(), Some(1));
    assert!(message.starts_with("error: cannot write to the standard output"), "{message}");
}

/// Where something is open, a strict command ends with a code of its own; what it found is saved.
#[test]
fn strict_commands_have_an_exit_code() {
    let folder = tempfile::tempdir().unwrap();
    let model = "Equations(states: [(\"x\", \"r - x^2\")], parameters: [(\"r\", 1)], initial: [(\"x\", 1)])";
    std::fs::write(folder.path().join("fold.ron"), model).unwrap();
    let trace = ["trace", "fold.ron", "--along", "r=-1..2", "--strict"];
    assert_eq!(tangency(folder.path(), &trace).status.code(), Some(0));
    let output = tangency(folder.path(), &[&trace[..], &["--set", "max_points=4"]].concat());
    assert!(failure(&output, 3).contains("4 points, as many as `max_points` allows"));
    assert!(folder.path().join("out/fold.ron").exists());
    // A reader who leaves hides nothing.
    let program = env!("CARGO_BIN_EXE_tangency");
    let line = format!("({program} {} --set max_points=4; echo $? >&2) | true", trace.join(" "));
    let output =
        Command::new("sh").args(["-c", &line]).current_dir(folder.path()).output().unwrap();
    assert!(String::from_utf8_lossy(&output.stderr).ends_with("3\n"), "{output:?}");
}

#[test]
fn plot_draws_beside_the_first_document_and_says_where() {
    let folder = folder();
    let output = tangency(folder.path(), &["plot", "a.ron", "b.ron"]);
    assert_eq!((output.status.code(), stdout(&output)), (Some(0), "a.svg\n"));
    let svg = std::fs::read_to_string(folder.path().join("a.svg")).unwrap();
    assert!(svg.starts_with("<svg") && svg.contains(">\na\n<") && svg.contains(">\nb\n<"));
    let arguments = ["plot", "a.ron", "--x", "deflection", "--y", "load", "--out", "new/c.svg"];
    assert!(tangency(folder.path(), &arguments).status.success());
    assert!(folder.path().join("new/c.svg").exists());
}

#[test]
fn plot_never_replaces_an_input() {
    let folder = folder();
    let before = std::fs::read_to_string(folder.path().join("b.ron")).unwrap();
    let output = tangency(folder.path(), &["plot", "a.ron", "b.ron", "--out", "./b.ron"]);
    assert!(
        failure(&output, 1)
            .contains("./b.ron is also an input file, and input files are not overwritten")
    );
    assert_eq!(std::fs::read_to_string(folder.path().join("b.ron")).unwrap(), before);
    std::fs::rename(folder.path().join("a.ron"), folder.path().join("a.svg")).unwrap();
    failure(&tangency(folder.path(), &["plot", "a.svg"]), 1);
}

#[test]
fn unknown_columns_are_answered_with_a_suggestion() {
    let output = tangency(folder().path(), &["plot", "a.ron", "--y", "deflecton"]);
    let message = failure(&output, 1);
    assert!(message.contains("did you mean `deflection`?"), "{message}");
    assert!(message.contains("Known: load, aspect_ratio, deflection"), "{message}");
}

#[test]
fn an_output_that_cannot_be_written_is_named() {
    let output = tangency(folder().path(), &["plot", "a.ron", "--out", "b.ron/c.svg"]);
    let message = failure(&output, 1);
    assert!(message.contains("b.ron is a file, not a folder"), "{message}");
    assert!(message.contains("choose a folder with --out"), "{message}");
}

#[test]
fn files_that_are_no_documents_are_refused_by_name_and_place() {
    let folder = folder();
    let text = std::fs::read_to_string(folder.path().join("a.ron")).unwrap();
    let cases = [
        ("(modes: 3)".to_owned(), "not a tangency document"),
        (text[..text.len() / 2].to_owned(), "the file is truncated"),
        (text.replace("[0.019208,", "[NaN,"), "point 1, column `load` is NaN"),
        (text.replace("  title:", "  title: \"\", title:"), "line 4, column "),
    ];
    for (content, expected) in cases {
        std::fs::write(folder.path().join("c.ron"), content).unwrap();
        for command in ["table", "plot"] {
            let output = tangency(folder.path(), &[command, "c.ron"]);
            let message = failure(&output, 1);
            assert!(message.contains(expected) && message.contains("c.ron: "), "{message}");
        }
    }
    assert!(!folder.path().join("c.svg").exists());
    assert!(
        failure(&tangency(folder.path(), &["table", "d.ron"]), 1).contains("cannot read d.ron")
    );
}

#[test]
fn arguments_that_cannot_be_understood_end_with_two() {
    let folder = folder();
    for arguments in [&["tabel", "a.ron"][..], &["plot"], &["table", "a.ron", "--speed", "--csv"]] {
        failure(&tangency(folder.path(), arguments), 2);
    }
    let output = tangency(folder.path(), &["--help"]);
    assert!(output.status.success() && stdout(&output).contains("table"));
}

/// A folder with nothing in it.
fn empty() -> tempfile::TempDir {
    tempfile::tempdir().unwrap()
}

/// The built-in scenes, one line each: name and summary.
#[test]
fn scenes_are_listed_one_line_each() {
    let output = tangency(empty().path(), &["scenes"]);
    assert_eq!(output.status.code(), Some(0));
    let lines: Vec<&str> = stdout(&output).lines().collect();
    let all = || BUILT_IN.iter().chain(LIBRARY);
    assert_eq!(lines.len(), all().count());
    for (line, scene) in lines.iter().zip(all()) {
        let (name, summary) = line.split_once("  ").unwrap();
        assert_eq!(name, scene.name);
        let stated = format!("summary: \"{}\"", summary.trim());
        assert!(scene.text.contains(&stated), "{name}: {summary}");
    }
}

/// A trace prints a line for each special point, in AUTO's manner, and writes a document and a
/// picture into `out`; the table of the document has the same points.
#[test]
fn a_trace_prints_its_special_points_and_writes_two_files() {
    let folder = empty();
    let output = tangency(folder.path(), &["trace", "plate-clamped"]);
    assert_eq!(output.status.code(), Some(0));
    let lines: Vec<&str> = stdout(&output).lines().collect();
    assert_eq!(lines[0], "plate");
    let header: Vec<&str> = lines[1].split_whitespace().collect();
    assert_eq!(
        header,
        [
            "label",
            "kind",
            "unstable",
            "load",
            "deflection",
            "max_deflection",
            "frequency",
            "frequency_ratio"
        ]
    );
    let fold: Vec<&str> =
        lines.iter().find(|line| line.contains("LP")).unwrap().split_whitespace().collect();
    let load: f64 = fold[3].parse().unwrap();
    assert!((load / 191.915137112 - 1.0).abs() < 1e-8, "{load}");
    assert_eq!(fold.len(), 8);
    let [document, picture] = ["out/plate-clamped.ron", "out/plate-clamped.svg"];
    assert_eq!(lines[lines.len() - 2..], [document, picture]);
    assert!(lines[lines.len() - 3].contains("(max_deflection = 0.9)"));
    let svg = std::fs::read_to_string(folder.path().join(picture)).unwrap();
    assert!(svg.starts_with("<svg") && svg.contains("Clamped microplate through pull-in"));
    let points = tangency(folder.path(), &["table", document]);
    let rows: Vec<&str> = stdout(&points).lines().skip(1).collect();
    let printed = lines.iter().filter(|line| {
        let mut words = line.split_whitespace();
        words.next().is_some_and(|label| label.parse::<usize>().is_ok())
    });
    assert_eq!(rows.len(), printed.count());
    let names: Vec<_> = std::fs::read_dir(folder.path().join("out")).unwrap().collect();
    assert_eq!(names.len(), 2, "nothing but the two files: {names:?}");
}

/// `--set` and `--out`, and a restart from a labelled point of the result, which finds the same
/// fold.
#[test]
fn a_trace_is_changed_by_name_and_restarted_from_a_label() {
    let folder = empty();
    let changed = ["trace", "plate-supported", "--set", "gap_ratio=2", "--set", "in_plane=free"];
    let output = tangency(folder.path(), &[&changed[..], &["--out", "a/b"]].concat());
    assert_eq!(output.status.code(), Some(0));
    let first = Document::load(folder.path().join("a/b/plate-supported.ron")).unwrap();
    let fold = |document: &Document| {
        let fold = document.branches[0].special.iter().find(|point| point.event == "fold");
        fold.unwrap().parameters[0]
    };
    assert!((fold(&first) / 61.243306692 - 1.0).abs() < 1e-8);
    let end = first.branches[0].special.last().unwrap().label;
    let start = format!("a/b/plate-supported.ron:plate/{end}");
    let again = [&changed[..], &["--out", "c", "--start", &start]].concat();
    let output = tangency(folder.path(), &again);
    assert_eq!(output.status.code(), Some(0), "{output:?}");
    let second = Document::load(folder.path().join("c/plate-supported.ron")).unwrap();
    assert!((fold(&second) / fold(&first) - 1.0).abs() < 1e-9);
}

/// A grazing stands in the table with its kind, the branch being unstable there, and on the screen.
#[test]
fn a_grazing_is_printed_with_its_kind() {
    let folder = empty();
    let output = tangency(folder.path(), &["trace", "mita-nonimpacting"]);
    assert_eq!(output.status.code(), Some(0), "{output:?}");
    let line = stdout(&output).lines().find(|line| line.contains("  G  ")).unwrap();
    assert_eq!(line.split_whitespace().nth(2), Some("1"), "{line}");
    let points = tangency(folder.path(), &["table", "out/mita-nonimpacting.ron", "--csv"]);
    let rows: Vec<&str> = stdout(&points).lines().collect();
    assert!(
        rows[0].starts_with("branch,label,kind,voltage,frequency,damping,period"),
        "{}",
        rows[0]
    );
    assert!(rows[0].ends_with(",error,unstable,converged,multiplicity"));
    let row = rows.iter().find(|row| row.contains(",G,")).unwrap();
    let cells: Vec<&str> = row.split(',').collect();
    let voltage: f64 = cells[3].parse().unwrap();
    assert!((voltage - 0.228618817738).abs() < 1e-11, "{voltage}");
    assert_eq!(cells[cells.len() - 3..], ["1", "true", "1"]);
}

/// A point of an orbit is restarted from its file, by its branch; profiles are drawn of the points
/// asked for.
#[test]
fn orbits_are_restarted_and_drawn_from_their_labels() {
    let folder = empty();
    assert!(tangency(folder.path(), &["trace", "lure"]).status.success());
    let again = ["trace", "lure", "--start", "out/lure.ron:orbits/3", "--out", "again"];
    let output = tangency(folder.path(), &again);
    assert_eq!(output.status.code(), Some(0), "{output:?}");
    assert_eq!(stdout(&output).lines().next(), Some("orbits"));
    assert!(stdout(&output).contains("0.63030200616"));
    let plot = ["plot", "out/lure.ron", "--points", "orbits/2,doubled/3", "--out", "two.svg"];
    assert!(tangency(folder.path(), &plot).status.success());
    let svg = std::fs::read_to_string(folder.path().join("two.svg")).unwrap();
    assert!(svg.contains("orbits/2 PD, alpha = 0.630302") && svg.contains("doubled/3 EP"));
    assert!(!svg.contains("doubled/2"));
    for (points, said) in [
        ("orbits/9", "no special point has the label 9"),
        ("2", "several branches have a special point with the label 2"),
        ("orbit/2", "did you mean `orbits`"),
        ("orbits", "not of the form LABEL or BRANCH/LABEL"),
    ] {
        let output = tangency(folder.path(), &["plot", "out/lure.ron", "--points", points]);
        let message = failure(&output, 1);
        assert!(message.contains(said), "{message}");
    }
}

/// What is asked of a trace and cannot be had is answered with the place, the value and the remedy;
/// no file is written.
#[test]
fn a_trace_that_cannot_begin_says_why() {
    let folder = empty();
    std::fs::write(folder.path().join("file"), "").unwrap();
    std::fs::write(folder.path().join("foreign.ron"), "(modes: 3)").unwrap();
    let clamped =
        |arguments: &[&'static str]| [&["trace", "plate-clamped"][..], arguments].concat();
    let set = |change: &'static str| clamped(&["--set", change]);
    for (arguments, said) in [
        (vec!["trace", "plate-clampt"], vec!["`plate-clampt`", "did you mean `plate-clamped`?"]),
        (vec!["trace", "nowhere.ron"], vec!["cannot read nowhere.ron"]),
        (vec!["trace", "foreign.ron"], vec!["foreign.ron", "line 1,", "begin a scene with"]),
        (set("gap_ration=2"), vec!["`gap_ration`", "did you mean `gap_ratio`?"]),
        (set("aspect=-1"), vec!["aspect", "-1", "positive"]),
        (set("nu=0.7"), vec!["nu", "7", "between −1 and ½"]),
        (set("gap_ratio=NaN"), vec!["`gap_ratio`", "NaN", "finite"]),
        (set("supports=XXXX"), vec!["XXXX", "four letters"]),
        (set("in_plane=movable"), vec!["`in_plane`", "movable", "slide"]),
        (set("refinement=2"), vec!["`refinement`", "2", "between 0 and 1"]),
        (clamped(&["--set", "model=modal", "--set", "modes=0"]), vec!["0", "modes"]),
        (
            clamped(&["--out", "file/below"]),
            vec!["file is a file, not a folder", "choose a folder with --out"],
        ),
        (clamped(&["--start", "nothing.ron:1"]), vec!["cannot read nothing.ron"]),
    ] {
        let output = tangency(folder.path(), &arguments);
        let message = failure(&output, 1);
        for part in said {
            assert!(message.contains(part), "{arguments:?}: {message}");
        }
        assert!(!folder.path().join("out").exists(), "{arguments:?} left a file");
    }
    for change in ["gap_ratio", "=2", "gap_ratio="] {
        let message = tangency(folder.path(), &set(change));
        assert!(failure(&message, 2).contains("NAME=VALUE"));
    }
}

/// A scene's file, or the document that is started from, is never overwritten.
#[test]
fn a_trace_never_replaces_its_inputs() {
    let folder = empty();
    let scene = BUILT_IN.iter().find(|scene| scene.name == "plate-supported").unwrap();
    let path = folder.path().join("mine.ron");
    std::fs::write(&path, scene.text).unwrap();
    let output = tangency(folder.path(), &["trace", "mine.ron", "--out", "."]);
    assert!(
        failure(&output, 1).contains("is also an input file, and input files are not overwritten")
    );
    assert_eq!(std::fs::read_to_string(&path).unwrap(), scene.text);
    assert!(tangency(folder.path(), &["trace", "mine.ron"]).status.success());
    let before = std::fs::read_to_string(folder.path().join("out/mine.ron")).unwrap();
    let again = ["trace", "mine.ron", "--start", "out/mine.ron:plate/1"];
    assert!(
        failure(&tangency(folder.path(), &again), 1).contains("input files are not overwritten")
    );
    assert_eq!(std::fs::read_to_string(folder.path().join("out/mine.ron")).unwrap(), before);
}

/// A trace of the clamped plate that is under way.
fn trace_begun(folder: &Path, settings: &[&str]) -> std::process::Child {
    Command::new(env!("CARGO_BIN_EXE_tangency"))
        .args(["trace", "plate-clamped"])
        .args(settings.iter().flat_map(|setting| ["--set", setting]))
        .current_dir(folder)
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .unwrap()
}

/// The reader of a trace's lines may leave: the files are saved all the same.
#[test]
fn a_reader_of_a_trace_may_leave() {
    let folder = empty();
    let mut child = trace_begun(folder.path(), &["orders=(transverse: (4, 4), in_plane: (6, 6))"]);
    drop(child.stdout.take());
    let output = child.wait_with_output().unwrap();
    assert_eq!((output.status.code(), &output.stderr[..]), (Some(0), &b""[..]), "{output:?}");
    assert!(folder.path().join("out/plate-clamped.ron").exists());
}

/// A quiet trace says nothing; a verbose one says all points; what is piped has all columns.
#[test]
fn a_trace_tells_as_much_as_is_asked() {
    let folder = empty();
    let lines = |more: &[&str]| {
        let output = tangency(folder.path(), &[&["trace", "lorenz"][..], more].concat());
        assert_eq!((output.status.code(), &output.stderr[..]), (Some(0), &b""[..]));
        stdout(&output).lines().map(String::from).collect::<Vec<_>>()
    };
    assert!(lines(&["-q"]).is_empty());
    let usual = lines(&[]);
    let document = Document::load(folder.path().join("out/lorenz.ron")).unwrap();
    let points: usize = document.branches.iter().map(|branch| branch.points.len()).sum();
    assert_eq!(lines(&["-v"]).len(), usual.len() + points);
    failure(&tangency(folder.path(), &["trace", "lorenz", "-q", "-v"]), 2);
}

/// Ctrl-C keeps what is traced: a document and a picture of a part of the branch, and a message.
#[cfg(unix)]
#[test]
fn an_interrupted_trace_is_kept() {
    use std::io::{BufRead, BufReader};
    use tangency::core::continuation::End;
    let folder = empty();
    let orders = "orders=(transverse: (8, 8), in_plane: (10, 10))";
    let long = ["max_step=0.0002", "max_points=100000", orders];
    let mut child = trace_begun(folder.path(), &long);
    let mut lines = BufReader::new(child.stdout.take().unwrap()).lines();
    // The name, the header and the start: the trace is under way.
    for _ in 0..3 {
        lines.next().unwrap().unwrap();
    }
    let id = child.id().to_string();
    assert!(Command::new("kill").args(["-INT", &id]).status().unwrap().success());
    let rest: Vec<String> = lines.map(Result::unwrap).collect();
    let output = child.wait_with_output().unwrap();
    assert!(failure(&output, 1).contains(
        "the command was interrupted; all results computed before the interruption are saved"
    ));
    assert!(rest.iter().any(|line| line.contains("(interrupted)")), "{rest:?}");
    let document = Document::load(folder.path().join("out/plate-clamped.ron")).unwrap();
    let branch = &document.branches[0];
    assert_eq!(branch.ends[1], End::Interrupted);
    assert!(branch.points.len() < 5000 && branch.special.len() >= 2);
    assert!(folder.path().join("out/plate-clamped.svg").exists());
    // And it goes on from there.
    let label = branch.special.last().unwrap().label;
    let start = format!("out/plate-clamped.ron:{label}");
    let output = tangency(
        folder.path(),
        &[
            "trace",
            "plate-clamped",
            "--set",
            "orders=(transverse: (8, 8), in_plane: (10, 10))",
            "--start",
            &start,
            "--out",
            "next",
        ],
    );
    assert_eq!(output.status.code(), Some(0), "{output:?}");
    assert!(stdout(&output).contains("  LP  "));
}

/// Clap checks its own arguments where they are shown.
#[test]
fn every_command_explains_its_arguments() {
    let folder = folder();
    let help = tangency(folder.path(), &["--help"]);
    let text = stdout(&help);
    let commands: Vec<&str> = text
        .lines()
        .skip_while(|line| !line.starts_with("Commands:"))
        .skip(1)
        .map_while(|line| line.split_whitespace().next())
        .collect();
    assert!(commands.contains(&"trace") && commands.contains(&"sweep"), "{commands:?}");
    for command in commands {
        let output = tangency(folder.path(), &[command, "--help"]);
        assert!(output.status.success() && stdout(&output).contains("Usage:"), "{command}");
    }
}

#[test]
fn arguments_are_read_in_all_their_parts() {
    let folder = folder();
    let start =
        |start: &str| tangency(folder.path(), &["trace", "plate-clamped", "--start", start]);
    // A file in a folder, with and without a branch.
    for text in ["c/x.ron:12", "c/x.ron:branch/2"] {
        let output = start(text);
        assert!(failure(&output, 1).contains("c/x.ron"), "{output:?}");
    }
    let output = start("a.ron:plate/9");
    let message = failure(&output, 1);
    assert!(message.contains("a.ron") && message.contains('9'), "{message}");
    for text in ["a.ron", "a.ron:", "a.ron:x", ":3", "a.ron:0", "a.ron:/3", "a.ron:b/-1"] {
        failure(&start(text), 2);
    }
    let set = |text: &str| tangency(folder.path(), &["trace", "plate-clamped", "--set", text]);
    for text in ["load", "=3", "load=", " = "] {
        let output = set(text);
        let expected = format!("`{text}` is not of the form NAME=VALUE");
        assert!(failure(&output, 2).contains(&expected), "{output:?}");
    }
    // Spaces and a second equals sign belong to the value.
    let output = set("k = a=b");
    let message = failure(&output, 1);
    assert!(message.contains("`k`"), "{message}");
}

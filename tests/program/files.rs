//! Files that are read and written: what is refused, what is replaced, and that results belong together.

use crate::program::command::{bytes, failure, signal, tangency};
use std::path::Path;
use std::process::{Command, Stdio};
use tangency::output::{Document, Sweeps, example_branch};

fn succeeds(folder: &Path, arguments: &[&str]) -> String {
    let output = tangency(folder, arguments);
    assert!(output.status.success(), "{arguments:?}: {output:?}");
    String::from_utf8(output.stdout).unwrap()
}

/// A command fails with a message that says all of this, and holds no control characters.
fn refused(folder: &Path, arguments: &[&str], expected: &[&str]) {
    let output = tangency(folder, arguments);
    let message = failure(&output, 1);
    for part in expected {
        assert!(message.contains(part), "{arguments:?}: `{part}` is not in {message}");
    }
}

/// Two short sweeps, and a branch.
const SCENE: &str = r#"Scene(
    title: "Up", plot: (x: "amplitude", y: "max_displacement"), problem: ImpactOscillator(), parameters: [("frequency", 2.2), ("amplitude", 0.5)],
    runs: [(name: "P(0,1)", start: Simulated(state: [("displacement", 0.0)], transient: 50), along: [(name: "amplitude", low: 0.5, high: 1.0)])],
    sweeps: [(name: "up", order: up, strands: 3, over: [(name: "amplitude", low: 1, high: 5, count: 6)],
        search: (transient: 40, recorded_periods: 20, lyapunov_periods: 0), measures: ["max_displacement"])],
)"#;

/// A folder with `a.ron`, a document, and `up.ron`, a scene.
fn folder() -> tempfile::TempDir {
    let folder = tempfile::tempdir().unwrap();
    let document = Document::new("Pull-in", vec![example_branch()]);
    document.save(folder.path().join("a.ron")).unwrap();
    std::fs::write(folder.path().join("up.ron"), SCENE).unwrap();
    folder
}

fn names(folder: &Path) -> Vec<String> {
    let entries = folder.read_dir().unwrap();
    let mut names: Vec<String> =
        entries.map(|entry| entry.unwrap().file_name().into_string().unwrap()).collect();
    names.sort();
    names
}

/// An archive like another one, but for what is changed in its text `about`: written past all checks.
fn forged(folder: &Path, from: &str, to: &str, change: &dyn Fn(&str) -> String) {
    use npyz::WriterBuilder;
    use std::io::{Cursor, Read, Write};
    let mut old = zip::ZipArchive::new(Cursor::new(bytes(folder, from))).unwrap();
    let mut new = zip::ZipWriter::new(Cursor::new(Vec::new()));
    for index in 0..old.len() {
        let mut entry = old.by_index(index).unwrap();
        let (name, mut content) = (entry.name().unwrap().into_owned(), Vec::new());
        entry.read_to_end(&mut content).unwrap();
        if name == "about.npy" {
            let about = npyz::NpyFile::new(&content[..]).unwrap().into_vec::<u8>().unwrap();
            let about = change(std::str::from_utf8(&about).unwrap());
            content.clear();
            let options = npyz::WriteOptions::new().default_dtype();
            let mut writer = options.writer(Cursor::new(&mut content)).begin_1d().unwrap();
            writer.extend(about.bytes()).unwrap();
            writer.finish().unwrap();
        }
        new.start_file(name, zip::write::SimpleFileOptions::default()).unwrap();
        new.write_all(&content).unwrap();
    }
    std::fs::write(folder.join(to), new.finish().unwrap().into_inner()).unwrap();
}

/// C1. Names in an archive choose no path; neither do those of sweeps in a scene.
#[test]
fn names_in_files_choose_no_paths() {
    let folder = folder();
    let at = folder.path();
    succeeds(at, &["sweep", "up.ron"]);
    let absolute = at.join("elsewhere").display().to_string();
    for name in ["../../escaped", &absolute, "", "..", "a\\\\b", "a\\u{1b}b"] {
        let renamed = |about: &str| about.replacen("name:\"up\"", &format!("name:\"{name}\""), 1);
        forged(at, "out/up.npz", "forged.npz", &renamed);
        let said = ["forged.npz: the scene's name is \"", "control characters"];
        let rule = if name.contains('u') && name.contains("1b") { 2 } else { 1 };
        for command in [&["merge", "forged.npz", "--out", "m"][..], &["plot", "forged.npz"]] {
            refused(at, command, &said[..rule]);
        }
    }
    assert_eq!(names(at), ["a.ron", "forged.npz", "out", "up.ron"]);
    let sweep = |about: &str| about.replace("name:\"up\",axes", "name:\"../up\",axes");
    forged(at, "out/up.npz", "forged.npz", &sweep);
    refused(
        at,
        &["plot", "forged.npz"],
        &["the name of a sweep is \"../up\"", "an entry in an archive"],
    );
    let scene = SCENE.replace("name: \"up\"", "name: \"../up\"");
    std::fs::write(at.join("bad.ron"), scene).unwrap();
    refused(at, &["sweep", "bad.ron"], &["bad.ron: the name of a sweep is \"../up\""]);
    // A scene in an archive names no files.
    let model = |about: &str| about.replace("problem:ImpactOscillator", "problem:Equations");
    let model = |about: &str| {
        let about = model(about);
        let begin = about.find("problem:Equations(").unwrap() + "problem:Equations(".len();
        let end = begin + about[begin..].find(')').unwrap();
        format!("{}model:\\\"up.ron\\\"{}", &about[..begin], &about[end..])
    };
    forged(at, "out/up.npz", "forged.npz", &model);
    refused(at, &["merge", "forged.npz", "--out", "m"], &["names no files"]);
}

/// C2. Devices, FIFOs, sockets and folders are not replaced; symbolic links to regular files are followed.
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
        ("null.svg", "is a symbolic link to something else than a regular file"),
        ("dangling.svg", "is a symbolic link that leads to no file"),
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
    refused(at, &["trace", "bratu"], &["out/bratu.svg is a symbolic link to something else"]);
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
        for command in ["points", "plot"] {
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
        assert!(message.contains("holds control characters"), "{message}");
        assert!(!message.trim_end().contains(char::is_control), "{message:?}");
    }
}

/// Figures of a library's user may hold anything: the SVG is well-formed.
#[test]
fn svg_is_well_formed_whatever_it_says() {
    use tangency::output::{Figure, Series, Style, draw};
    let strange = "<b>&\u{0}\u{1b}\u{ffff}\"'\n";
    let line = |name| Series::new(name, Style::Solid, [[0.0, 0.0], [1.0, 2.0]]);
    let figure = Figure::new(strange, strange, strange).with(line(strange)).with(line("b"));
    let svg = draw(&[figure]).unwrap();
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
    refused(at, &["merge", "out/up.npz"], &["out/up.npz is an input and is not overwritten"]);
    let link = "./out/../out/up.npz";
    refused(at, &["merge", link, "--out", "out"], &["is an input and is not overwritten"]);
    refused(at, &["sweep", "up.ron", "--out", "."], &["./up.ron is an input", "--out"]);
    refused(at, &["plot", "a.ron", "out/up.npz", "--out", "a.ron"], &["a.ron is an input"]);
    // The file that a scene reads its equations from is one, too.
    let equations = "Equations(states: [(\"x\", \"r - x\")], parameters: [(\"r\", 1)])";
    let scene =
        "Scene(title: \"t\", problem: Equations(model: \"out/s.ron\", solution: equilibrium),
        runs: [Run(name: \"r\", along: [(name: \"r\", low: 0, high: 2)])])";
    std::fs::write(at.join("out/s.ron"), equations).unwrap();
    std::fs::write(at.join("s.ron"), scene).unwrap();
    refused(at, &["trace", "s.ron"], &["out/s.ron is an input and is not overwritten"]);
    succeeds(at, &["trace", "s.ron", "--out", "else"]);
    assert!(bytes(at, "out/up.npz") == before && bytes(at, "up.ron") == SCENE.as_bytes());
}

/// C4. A merged result is that of the whole run, the branches in its picture and their document included.
#[test]
fn merged_results_are_those_of_the_whole_run() {
    let folder = folder();
    let at = folder.path();
    succeeds(at, &["sweep", "up.ron", "--out", "whole"]);
    let parts: Vec<String> = (1..=3).map(|k| format!("parts/up.part-{k}-of-3.npz")).collect();
    for part in ["1/3", "2/3", "3/3"] {
        succeeds(at, &["sweep", "up.ron", "--out", "parts", "--part", part]);
    }
    let arguments = ["merge", &parts[2], &parts[0], &parts[1], "--out", "merged"];
    let text = succeeds(at, &arguments);
    assert!(text.ends_with("merged/up.ron\nmerged/up.npz\nmerged/up.svg\n"), "{text}");
    assert_eq!(names(&at.join("merged")), ["up.npz", "up.ron", "up.svg"]);
    for name in ["up.npz", "up.ron", "up.svg"] {
        assert!(
            bytes(at, &format!("merged/{name}")) == bytes(at, &format!("whole/{name}")),
            "{name}"
        );
    }
    assert!(String::from_utf8(bytes(at, "merged/up.svg")).unwrap().contains("P(0,1)"));
}

/// C5. Sizes are limited before files fill the memory, and the limit can be raised.
#[test]
fn sizes_are_limited() {
    let folder = folder();
    let at = folder.path();
    // 3 MB of blanks, and an archive that unpacks to 8 MB.
    std::fs::write(at.join("large.ron"), vec![b' '; 3_000_000]).unwrap();
    let said = ["large.ron is larger than 2 MB", "--max-size"];
    refused(at, &["points", "large.ron", "--max-size", "2"], &said);
    refused(at, &["trace", "large.ron", "--max-size", "2"], &said);
    refused(at, &["points", "large.ron"], &["not a tangency document"]);
    succeeds(at, &["sweep", "up.ron"]);
    let title = "a".repeat(8_000_000);
    let large = |about: &str| about.replacen("title:\"Up\"", &format!("title:\"{title}\""), 1);
    forged(at, "out/up.npz", "bomb.npz", &large);
    assert!(bytes(at, "bomb.npz").len() < 100_000);
    let said = ["bomb.npz: the archive unpacks to more than 4 MB", "--max-size"];
    refused(at, &["plot", "bomb.npz", "--max-size", "1"], &said);
    // A sparse file has no bytes, and a size.
    let sparse = std::fs::File::create(at.join("sparse.npz")).unwrap();
    sparse.set_len(100_000_000_000).unwrap();
    refused(at, &["plot", "sparse.npz"], &["sparse.npz is larger than 256 MB"]);
    for size in ["0", "-1", "nan", "1e9"] {
        let output = tangency(at, &["points", "a.ron", &format!("--max-size={size}")]);
        assert_eq!(output.status.code(), Some(2), "{size}");
    }
}

/// C5. A device is read up to the limit, a FIFO only if somebody writes to it.
#[cfg(unix)]
#[test]
fn devices_and_fifos_are_read_up_to_the_limit() {
    let folder = folder();
    let at = folder.path();
    refused(at, &["points", "/dev/zero", "--max-size", "1"], &["/dev/zero is larger than 1 MB"]);
    let fifo = at.join("fifo.ron");
    assert!(Command::new("mkfifo").arg(&fifo).status().unwrap().success());
    refused(at, &["points", "fifo.ron"], &["fifo.ron is a FIFO", "nothing has come from it"]);
    let content = bytes(at, "a.ron");
    let writer = std::thread::spawn(move || std::fs::write(fifo, content).unwrap());
    assert_eq!(succeeds(at, &["points", "fifo.ron"]).lines().count(), 5);
    writer.join().unwrap();
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
        assert_eq!(failure(&output, 1), "error: interrupted; what was done until then is kept\n");
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

/// A result that another run is writing is refused, with its process; a killed run is in nobody's way.
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

/// E2. Temporary files of killed runs are removed by the next run that writes there, those of live ones are not.
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
    assert!(table.starts_with("branch,point,load,aspect_ratio,deflection,unstable,admissible\n"));
    assert!(table.contains("\na: plate,0,"), "{table}");
    for name in ["b.jpg", "b", "b.svg.pdf"] {
        refused(at, &["plot", "a.ron", "--out", name], &[name, "known: .svg, .csv, .png"]);
    }
    for more in [&["--x", "load"][..], &["--points", "2"]] {
        let arguments = [&["plot", "a.ron", "--out", "c.csv"][..], more].concat();
        refused(at, &arguments, &["cannot be with", more[0]]);
    }
    if cfg!(feature = "png") {
        succeeds(at, &["plot", "a.ron", "--out", "b.png"]);
        assert!(bytes(at, "b.png").starts_with(b"\x89PNG"));
    } else {
        refused(at, &["plot", "a.ron", "--out", "b.png"], &["--features png"]);
    }
}

/// D4. How often a sweep saves has a range.
#[test]
fn save_every_has_a_range() {
    let folder = folder();
    for seconds in ["nan", "-1", "inf", "1e7", "x"] {
        let argument = format!("--save-every={seconds}");
        let output = tangency(folder.path(), &["sweep", "up.ron", &argument]);
        let message = String::from_utf8(output.stderr).unwrap();
        assert_eq!(output.status.code(), Some(2), "{message}");
        assert!(message.contains("from 0 to 1e6"), "{message}");
    }
    succeeds(folder.path(), &["sweep", "up.ron", "--save-every", "0"]);
}

/// Archives with numbers of runs that cannot be, and with a table in place of another, are refused.
#[test]
fn damaged_archives_are_refused() {
    let folder = folder();
    let at = folder.path();
    succeeds(at, &["sweep", "up.ron"]);
    let fewer = |about: &str| about.replace("total:6", "total:3");
    forged(at, "out/up.npz", "total.npz", &fewer);
    refused(at, &["merge", "total.npz", "--out", "m"], &["total.npz: ", "its numbers are 0 to 2"]);
    let text = |about: &str| about.replace("tangency-sweeps/", "tangency-swepps/");
    forged(at, "out/up.npz", "format.npz", &text);
    refused(at, &["plot", "format.npz"], &["its format is `tangency-swepps/1`"]);
    assert!(Sweeps::load(at.join("out/up.npz")).unwrap().sweeps[0].is_complete());
}

/// A3. A regression test on the table sees what has not converged.
#[test]
fn tables_say_what_has_not_converged() {
    let folder = tempfile::tempdir().unwrap();
    let mut document = Document::new("Pull-in", vec![example_branch()]);
    document.branches[0].special[2].converged = false;
    document.save(folder.path().join("a.ron")).unwrap();
    let table = succeeds(folder.path(), &["points", "a.ron"]);
    let column = table.lines().next().unwrap().split(',').position(|name| name == "converged");
    let cells: Vec<&str> =
        table.lines().map(|line| line.split(',').nth(column.unwrap()).unwrap()).collect();
    assert_eq!(cells, ["converged", "true", "true", "false", "true"]);
}

/// Merging and going on need the scene from the archive: what is written there is read as the same scene.
#[test]
fn scenes_in_archives_are_read_back() {
    use tangency::scene::{BUILT_IN, Catalogue, Scene};
    let catalogue = Catalogue::built_in();
    for named in BUILT_IN {
        let scene = Scene::parse(named.text).unwrap();
        assert_eq!(catalogue.parse_alone(&scene.in_words()).unwrap(), scene, "{}", named.name);
    }
}

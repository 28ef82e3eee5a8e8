//! The binary as a user meets it: outputs, messages and exit codes.

use std::path::Path;
use std::process::{Command, Output, Stdio};
use tangency::output::{Document, example_branch};

fn tangency(folder: &Path, arguments: &[&str]) -> Output {
    let mut command = Command::new(env!("CARGO_BIN_EXE_tangency"));
    command.current_dir(folder).args(arguments).output().unwrap()
}

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

/// The message of a failure, after checking its form and exit code.
fn failure(output: &Output, code: i32) -> &str {
    let message = std::str::from_utf8(&output.stderr).unwrap();
    assert_eq!(output.status.code(), Some(code), "{message}");
    assert!(message.starts_with("error: ") && !message.contains("panicked"), "{message}");
    message
}

#[test]
fn points_prints_the_table() {
    let folder = folder();
    let output = tangency(folder.path(), &["points", "a.ron"]);
    assert!(output.status.success());
    let lines: Vec<&str> = stdout(&output).lines().collect();
    assert_eq!(lines[0], "branch,label,kind,load,aspect_ratio,deflection,error");
    assert_eq!(lines[3], "plate,3,LP,0.148148148148148,1.2,0.333333333333333,2.5e-15");
    assert_eq!(lines.len(), 5);
}

#[test]
fn a_reader_who_leaves_is_no_failure() {
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
        .args(["points", "a.ron"])
        .current_dir(folder.path())
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .unwrap();
    drop(child.stdout.take());
    let output = child.wait_with_output().unwrap();
    assert_eq!((output.status.code(), output.stderr.len()), (Some(0), 0));
}

#[test]
fn plot_draws_beside_the_first_document_and_says_where() {
    let folder = folder();
    let output = tangency(folder.path(), &["plot", "a.ron", "b.ron"]);
    assert_eq!((output.status.code(), stdout(&output)), (Some(0), "a.svg\n"));
    let svg = std::fs::read_to_string(folder.path().join("a.svg")).unwrap();
    assert!(svg.starts_with("<svg") && svg.contains("a: plate") && svg.contains("b: plate"));
    let arguments = ["plot", "a.ron", "--x", "deflection", "--y", "load", "--out", "new/c.svg"];
    assert!(tangency(folder.path(), &arguments).status.success());
    assert!(folder.path().join("new/c.svg").exists());
}

#[test]
fn plot_never_replaces_an_input() {
    let folder = folder();
    let before = std::fs::read_to_string(folder.path().join("b.ron")).unwrap();
    let output = tangency(folder.path(), &["plot", "a.ron", "b.ron", "--out", "./b.ron"]);
    assert!(failure(&output, 1).contains("./b.ron is an input and is not overwritten"));
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
    assert!(message.contains("cannot write b.ron/c.svg"), "{message}");
    assert!(message.contains("choose a folder that can be written to"), "{message}");
}

#[test]
fn files_that_are_no_documents_are_refused_by_name_and_place() {
    let folder = folder();
    let text = std::fs::read_to_string(folder.path().join("a.ron")).unwrap();
    let cases = [
        ("(modes: 3)".to_owned(), "not a tangency document"),
        (text[..text.len() / 2].to_owned(), "the file was cut short"),
        (text.replace("[0.019208,", "[NaN,"), "point 1, column `load` is NaN"),
        (text.replace("  title:", "  title: \"\", title:"), "line 4, column "),
    ];
    for (content, expected) in cases {
        std::fs::write(folder.path().join("c.ron"), content).unwrap();
        for command in ["points", "plot"] {
            let output = tangency(folder.path(), &[command, "c.ron"]);
            let message = failure(&output, 1);
            assert!(message.contains(expected) && message.contains("c.ron: "), "{message}");
        }
    }
    assert!(!folder.path().join("c.svg").exists());
    assert!(
        failure(&tangency(folder.path(), &["points", "d.ron"]), 1).contains("cannot read d.ron")
    );
}

#[test]
fn arguments_that_cannot_be_understood_end_with_two() {
    let folder = folder();
    for arguments in [&["pionts", "a.ron"][..], &["plot"], &["points", "a.ron", "--speed"]] {
        failure(&tangency(folder.path(), arguments), 2);
    }
    let output = tangency(folder.path(), &["--help"]);
    assert!(output.status.success() && stdout(&output).contains("points"));
}

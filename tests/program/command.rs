//! The binary, run as a user runs it.

use std::path::Path;
use std::process::{Command, Output};

/// Runs the program in a folder, to its end.
pub fn tangency(folder: &Path, arguments: &[&str]) -> Output {
    let mut command = Command::new(env!("CARGO_BIN_EXE_tangency"));
    command.current_dir(folder).args(arguments).output().unwrap()
}

/// The message of a failure, after warnings, after checking its form and exit code.
#[track_caller]
pub fn failure(output: &Output, code: i32) -> &str {
    let mut message = std::str::from_utf8(&output.stderr).unwrap();
    while message.starts_with("warning: ") {
        message = message.split_once('\n').unwrap_or_default().1;
    }
    assert_eq!(output.status.code(), Some(code), "{message}");
    assert!(message.starts_with("error: ") && !message.contains("panicked"), "{message}");
    let hidden = |letter: char| letter.is_control() && letter != '\n';
    assert!(!message.contains(hidden), "{message:?}");
    message
}

/// Sends a signal to a program that runs.
#[cfg(unix)]
#[track_caller]
pub fn signal(name: &str, child: &std::process::Child) {
    let id = child.id().to_string();
    assert!(Command::new("kill").args([name, &id]).status().unwrap().success());
}

/// A file of the folder.
pub fn bytes(folder: &Path, name: &str) -> Vec<u8> {
    std::fs::read(folder.join(name)).unwrap()
}

/// Runs a command that must succeed: what it prints.
#[track_caller]
pub fn succeeds(folder: &Path, arguments: &[&str]) -> String {
    let output = tangency(folder, arguments);
    assert!(output.status.success(), "{arguments:?}: {output:?}");
    String::from_utf8(output.stdout).unwrap()
}

/// A command fails with a message that says all of this, and holds no control characters.
#[track_caller]
pub fn refused(folder: &Path, arguments: &[&str], expected: &[&str]) {
    let output = tangency(folder, arguments);
    let message = failure(&output, 1);
    for part in expected {
        assert!(message.contains(part), "{arguments:?}: `{part}` is not in {message}");
    }
}

/// The text on the error stream of a command.
pub fn stderr(output: &Output) -> String {
    String::from_utf8_lossy(&output.stderr).into_owned()
}

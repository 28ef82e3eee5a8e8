//! What a run must not do.

use super::cases::Case;
use super::runner::Ended;
use std::path::Path;

/// The signal of Ctrl-C, which ends a program that has not begun to watch for it.
const SIGINT: i32 = 2;

/// What a run did wrong.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Fault {
    Panic,
    Signal(i32),
    Hang,
    Code(i32),
    /// The message is not what a message must be.
    Message(String),
    /// Files are not what they must be.
    Files(String),
}

/// All that is wrong with how a case ended.
pub fn faults(case: &Case, ended: &Ended) -> Vec<Fault> {
    let mut faults = Vec::new();
    let panicked = ended.code == Some(101) || ended.message.contains("panicked at");
    match (ended.code, ended.signal) {
        _ if panicked => faults.push(Fault::Panic),
        _ if ended.hung => faults.push(Fault::Hang),
        (_, Some(SIGINT)) if ended.interrupted => {}
        (_, Some(signal)) => faults.push(Fault::Signal(signal)),
        (Some(130), _) if ended.interrupted => {}
        (Some(0..=2) | None, _) => {}
        (Some(code), _) => faults.push(Fault::Code(code)),
    }
    if faults.is_empty() {
        faults.extend(of_message(case, ended).map(Fault::Message));
    }
    faults.extend(of_files(case).map(Fault::Files));
    faults
}

/// What is wrong with the error stream.
fn of_message(case: &Case, ended: &Ended) -> Option<String> {
    let message = &ended.message;
    let control = message.chars().find(|c| c.is_control() && *c != '\n');
    if let Some(control) = control {
        return Some(format!("holds the control character {control:?}"));
    }
    let values = case.arguments.iter().map(|text| text.split_once('=').map_or(&**text, |(_, v)| v));
    if values.into_iter().any(|text| text.contains('\n') && message.contains(text)) {
        return Some("has a line break that an argument brought in".into());
    }
    if message.lines().count() > 20 {
        return Some("has more than 20 lines".into());
    }
    if message.lines().any(|line| line.chars().count() > 720) {
        return Some("has a line of more than 720 characters".into());
    }
    let mut lines = message.lines().skip_while(|line| line.starts_with("warning: "));
    match ended.code {
        Some(1 | 2) if !lines.next().is_some_and(|line| line.starts_with("error: ")) => {
            Some("does not begin with `error: `".into())
        }
        Some(1) if ended.interrupted => None,
        Some(1) if !case.subjects.iter().any(|subject| message.contains(subject)) => {
            Some("names neither file nor option".into())
        }
        Some(0) if lines.next().is_some() => {
            Some("of success has other lines than warnings".into())
        }
        _ => None,
    }
}

/// What is wrong with the files: inputs changed, others in wrong places, unfinished ones.
fn of_files(case: &Case) -> Option<String> {
    for (path, bytes) in &case.inputs {
        if std::fs::read(path).ok().as_ref() != Some(bytes) {
            return Some(format!("the input {} was changed", name(path)));
        }
    }
    for (path, kind) in &case.special {
        if std::fs::symlink_metadata(path).map(|data| data.file_type()).ok() != Some(*kind) {
            return Some(format!("{} was replaced", name(path)));
        }
    }
    let known = ["stdout", "stderr", "work"];
    let beside = entries(&case.root).into_iter().find(|name| !known.contains(&name.as_str()));
    if let Some(name) = beside {
        return Some(format!("{name:?} was written outside of the folder"));
    }
    of_folder(case, &case.folder)
}

/// What is wrong with files that the program has written in a folder and those in it.
fn of_folder(case: &Case, folder: &Path) -> Option<String> {
    entries(folder).into_iter().find_map(|name| {
        let path = folder.join(&name);
        // Whoever names a file so wants it.
        if name.contains(char::is_control) && !case.arguments.contains(&name) {
            return Some(format!("the name {name:?} of a file has control characters"));
        }
        if name.starts_with(".tmp") {
            return Some("a temporary file was left".into());
        }
        if path.is_symlink() {
            return None;
        }
        if path.is_dir() {
            return of_folder(case, &path);
        }
        let is_svg = path.is_file() && name.ends_with(".svg");
        let text = if is_svg { std::fs::read_to_string(&path).ok() } else { None }?;
        of_svg(&text).map(|wrong| format!("{name}: {wrong}"))
    })
}

/// What is wrong with a picture.
fn of_svg(text: &str) -> Option<String> {
    if let Some(control) = text.chars().find(|c| c.is_control() && !"\n\t\r".contains(*c)) {
        return Some(format!("the picture holds {control:?}"));
    }
    let whole = text.trim_start().starts_with("<svg") && text.trim_end().ends_with("</svg>");
    (!whole).then(|| "the picture is not whole".into())
}

fn entries(folder: &Path) -> Vec<String> {
    let entries = std::fs::read_dir(folder).into_iter().flatten().flatten();
    entries.map(|entry| entry.file_name().to_string_lossy().into_owned()).collect()
}

fn name(path: &Path) -> String {
    path.file_name().unwrap_or_default().to_string_lossy().into_owned()
}

//! Arguments of all kinds, on files that are none.

use super::Case;
use crate::bases::{Bases, TINY};
use crate::dice::Dice;
use crate::words::{TEXTS, value};
use std::process::Command;

const COMMANDS: &[&str] = &[
    "trace",
    "trace",
    "show",
    "simulate",
    "compare",
    "find",
    "sweep",
    "sweep",
    "merge",
    "plot",
    "table",
    "import",
    "scenes",
    "compare",
    "completions",
    "tracer",
    "",
];

/// Where results may go. Nothing here may be a device of the machine on which tests run: a program
/// that replaces it must do so in the folder of the case.
const OUTPUTS: &[&str] = &[
    "out",
    "a/b/c",
    ".",
    "",
    "file",
    "folder",
    "fifo",
    "link",
    "dangling",
    "file/below",
    "λ",
    "a\u{1b}[1mb",
    "-",
];

/// What is read.
const INPUTS: &[&str] = &[
    "tiny.ron",
    "tiny.ron",
    "saved.ron",
    "tiny.npz",
    "ball.ode",
    "missing.ron",
    "missing",
    "file",
    "folder",
    "folder/",
    "fifo",
    "fifo.ron",
    "fifo.npz",
    "link",
    "dangling",
    "empty.ron",
    "empty.npz",
    "empty.ode",
    "/dev/null",
    "/dev/zero",
    ".",
    "..",
    "",
    "lure",
    "plate",
    "bratu",
    "Lure",
    "a\u{1b}[1mb",
    "a\nb.ron",
    "large.ron",
    "other.npz",
];

pub fn make(case: &mut Case, bases: &Bases, dice: &mut Dice) -> std::io::Result<()> {
    let command = dice.word(COMMANDS);
    case.arguments(&[command]);
    let inputs = match command {
        "merge" | "plot" => 1 + dice.below(3),
        "compare" => 2,
        _ => 1,
    };
    for _ in 0..inputs + usize::from(dice.chance(1, 20)) {
        let input = dice.word(INPUTS);
        prepare(case, input, bases)?;
        case.arguments(&[input]);
        case.subjects.push(input.into());
    }
    if inputs == 0 {
        case.arguments(&[format!("x{}", dice.word(TEXTS))]);
        case.subjects.push(format!("`tangency {command}`"));
    }
    for _ in 0..dice.below(4) {
        option(case, command, bases, dice)?;
    }
    if matches!(command, "trace" | "show") {
        case.arguments(&["--set", "max_points=4"]);
    }
    Ok(())
}

/// An option, mostly one that the command knows.
fn option(case: &mut Case, command: &str, bases: &Bases, dice: &mut Dice) -> std::io::Result<()> {
    let known: &[&str] = match command {
        "trace" | "show" => &[
            "--set", "--out", "--start", "--along", "--bound", "--settle", "--hold", "--depth",
            "--switch", "--check",
        ],
        "find" => &["--set", "--box", "--starts"],
        "simulate" => &["--set", "--out", "--from", "--time", "--transient"],
        "sweep" => &["--set", "--out", "--part", "--threads", "--checkpoint", "--afresh"],
        "plot" => &["--x", "--y", "--points", "--out"],
        _ => &["--out"],
    };
    let name = match dice.chance(1, 10) {
        true => {
            dice.word(&["--sets", "-x", "--", "--help", "--version", "--threads", "--part", "--x"])
        }
        false => dice.word(known),
    };
    let value = match name {
        "--out" => {
            let out = dice.word(OUTPUTS);
            prepare(case, out, bases)?;
            out.to_string()
        }
        "--set" => format!("{}={}", dice.pick(&bases.words), value(dice)),
        "--along" | "--bound" => {
            format!("{}={}..{}", dice.pick(&bases.words), value(dice), value(dice))
        }
        "--start" => dice
            .word(&["x=1", "x=", "=1", "x=1,y", "saved.ron:1", "missing:1", ":1", "a:0", "fifo:1"])
            .to_string(),
        "--part" => dice
            .word(&["1/2", "2/2", "0/1", "3/2", "1/18446744073709551615", "1/0", "a/b", "1"])
            .to_string(),
        "--threads" => {
            dice.word(&["1", "0", "3", "1000", "18446744073709551615", "-1", "x"]).to_string()
        }
        "--checkpoint" => {
            dice.word(&["0", "1", "-1", "nan", "inf", "1e300", "1e-300", "x"]).to_string()
        }
        _ => value(dice).to_string(),
    };
    match name {
        "--afresh" | "--" | "--help" | "--version" => case.arguments(&[name]),
        _ => case.option(name, &value),
    }
    Ok(())
}

/// Makes the file of a name.
fn prepare(case: &mut Case, name: &str, bases: &Bases) -> std::io::Result<()> {
    let path = case.folder.join(name);
    if std::fs::symlink_metadata(&path).is_ok() {
        return Ok(());
    }
    match name {
        "tiny.ron" => case.input(name, TINY.into()),
        "saved.ron" => case.input(name, bases.documents[1].1.clone().into_bytes()),
        "tiny.npz" | "other.npz" => {
            case.input(name, bases.archives[usize::from(name == "other.npz")].clone())
        }
        "ball.ode" => case.input(name, bases.xppaut[0].1.into()),
        "file" | "empty.ron" | "empty.npz" | "empty.ode" => case.input(name, Vec::new()),
        "large.ron" => case.input(name, vec![b'('; 3_000_000]),
        "folder" | "folder/" => std::fs::create_dir_all(path),
        "fifo" | "fifo.ron" | "fifo.npz" => {
            if Command::new("mkfifo").arg(&path).status()?.success() {
                let kind = std::fs::symlink_metadata(&path)?.file_type();
                case.special.push((path, kind));
            }
            Ok(())
        }
        "link" | "dangling" => {
            let to = if name == "link" { "target.ron" } else { "nowhere.ron" };
            if name == "link" {
                std::fs::write(case.folder.join(to), TINY)?;
            }
            link(to, &path)?;
            let kind = std::fs::symlink_metadata(&path)?.file_type();
            case.special.push((path, kind));
            Ok(())
        }
        _ => Ok(()),
    }
}

#[cfg(unix)]
fn link(to: &str, path: &std::path::Path) -> std::io::Result<()> {
    std::os::unix::fs::symlink(to, path)
}

#[cfg(not(unix))]
fn link(to: &str, path: &std::path::Path) -> std::io::Result<()> {
    std::fs::write(path, to)
}

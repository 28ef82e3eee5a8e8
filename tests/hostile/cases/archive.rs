//! Changed archives of sweeps: merged, drawn, and continued.

use super::Case;
use crate::bases::{Bases, TINY};
use crate::dice::Dice;
use crate::mutate::{by_bytes, by_grammar};
use crate::words::{TEXTS, number};
use std::io::{Cursor, Read, Write};
use std::path::Path;
use tangency::output::{Row, SweepTable, Sweeps};
use zip::write::SimpleFileOptions;
use zip::{ZipArchive, ZipWriter};

pub fn make(case: &mut Case, bases: &Bases, dice: &mut Dice) -> std::io::Result<()> {
    let which = dice.below(3);
    let bytes = match dice.below(8) {
        0 => {
            let mut bytes = bases.archives[which].clone();
            by_bytes(&mut bytes, dice);
            bytes
        }
        1 | 2 => with_an_entry_changed(&bases.archives[which], bases, dice),
        _ => {
            let mut sweeps = bases.sweeps[which].clone();
            for _ in 0..=dice.below(2) {
                change(&mut sweeps, bases, &case.root, dice);
            }
            let path = case.root.join("work/changed.npz");
            let saved = sweeps.save(&path).map(|()| std::fs::read(&path));
            let _ = std::fs::remove_file(&path);
            // What cannot be saved is no file to be read.
            saved.unwrap_or(Ok(bases.archives[which].clone()))?
        }
    };
    let part = ["", "1/2", "2/2"][which];
    match dice.below(4) {
        0 | 1 => {
            case.input("tiny.ron", TINY.into())?;
            let name = match part.split_once('/') {
                None => "out/tiny.npz".into(),
                Some((number, of)) => format!("out/tiny.part-{number}-of-{of}.npz"),
            };
            case.file(&name, &bytes)?;
            case.arguments(&["sweep", "tiny.ron", "--threads", "1"]);
            if which > 0 {
                case.option("--part", part);
            }
        }
        2 => {
            case.input("changed.npz", bytes)?;
            case.arguments(&["plot", "changed.npz"]);
            if dice.chance(1, 4) {
                let column = dice.word(&["a", "x", "hit", "hit.v", "nothing", ""]).to_string();
                case.option(dice.word(&["--x", "--y"]), &column);
            }
        }
        _ => {
            case.input("changed.npz", bytes)?;
            case.arguments(&["merge", "changed.npz"]);
            // The other part, before or after.
            if which > 0 {
                case.input("other.npz", bases.archives[3 - which].clone())?;
                case.arguments.insert(1 + dice.below(2), "other.npz".into());
            }
        }
    }
    Ok(())
}

/// An archive of which one entry is missing, doubled, or not what it was.
fn with_an_entry_changed(archive: &[u8], bases: &Bases, dice: &mut Dice) -> Vec<u8> {
    let mut zip = ZipArchive::new(Cursor::new(archive)).expect("the program's own archive");
    let mut entries: Vec<(String, Vec<u8>)> = Vec::new();
    for k in 0..zip.len() {
        let mut entry = zip.by_index(k).expect("an entry");
        let mut bytes = Vec::new();
        entry.read_to_end(&mut bytes).expect("the program's own entry");
        let name = entry.name().expect("the program's own name").into_owned();
        entries.push((name, bytes));
    }
    // The first one is the text about all others.
    let at = if dice.chance(1, 2) { 0 } else { dice.below(entries.len()) };
    let (name, bytes) = &mut entries[at];
    match dice.below(5) {
        0 => by_bytes(bytes, dice),
        1 => *name = dice.word(TEXTS).to_string(),
        2 => bytes.resize(1 << dice.below(26), 0),
        3 if at > 0 => replace(bytes, dice),
        _ => {
            // The text follows a header of 128 bytes, which states the length of the text.
            let text = String::from_utf8_lossy(&bytes[128.min(bytes.len())..]).into_owned();
            let text = by_grammar(&text, &bases.words, dice);
            let header =
                format!("{{'descr': '|u1', 'fortran_order': False, 'shape': ({},), }}", text.len());
            *bytes = [b"\x93NUMPY\x01\x00\x76\x00", format!("{header:<117}\n").as_bytes()].concat();
            bytes.extend(text.into_bytes());
        }
    }
    let mut zip = ZipWriter::new(Cursor::new(Vec::new()));
    for (name, bytes) in &entries {
        if zip.start_file(name.as_str(), SimpleFileOptions::default()).is_ok() {
            zip.write_all(bytes).expect("memory");
        }
    }
    zip.finish().expect("memory").into_inner()
}

/// Changes what the header of an array says.
fn replace(bytes: &mut Vec<u8>, dice: &mut Dice) {
    let header = String::from_utf8_lossy(&bytes[10..128.min(bytes.len())]).into_owned();
    let new = match dice.below(4) {
        0 => header.replace("<f8", dice.word(&["<i4", ">f8", "|O", "<U9", "|S4", "<c16", "|b1"])),
        1 => header.replace("False", "True"),
        2 => header.replace("(", &format!("({}, ", number(dice))),
        _ => header.replace("(", "(9"),
    };
    bytes.splice(10..128.min(bytes.len()), format!("{:<117.117}\n", new.trim_end()).into_bytes());
}

/// Changes what an archive says about itself.
fn change(sweeps: &mut Sweeps, bases: &Bases, root: &Path, dice: &mut Dice) {
    match dice.below(10) {
        0 => {
            let outside = root.join("outside").display().to_string();
            let further = [outside, "../../outside".into()];
            sweeps.name = match dice.chance(1, 2) {
                true => dice.pick(&further).clone(),
                false => dice.word(TEXTS).to_string(),
            };
        }
        1 => sweeps.title = dice.word(TEXTS).to_string(),
        2 => {
            sweeps.format =
                dice.word(&["", "tangency-sweeps/2", "\u{1b}[2J", "tangency/1"]).to_string()
        }
        3 => sweeps.scene = by_grammar(&sweeps.scene, &bases.words, dice),
        4 => {
            let axis = if dice.chance(1, 2) { &mut sweeps.plot.x } else { &mut sweeps.plot.y };
            *axis = Some(dice.word(TEXTS).to_string());
        }
        5 => {
            let at = dice.below(sweeps.sweeps.len());
            match dice.below(3) {
                0 => sweeps.sweeps.clear(),
                1 if at < sweeps.sweeps.len() => drop(sweeps.sweeps.remove(at)),
                _ => {
                    let more = sweeps
                        .sweeps
                        .first()
                        .map(|table| SweepTable { name: "more".into(), ..table.clone() });
                    sweeps.sweeps.extend(more);
                }
            }
        }
        _ => {
            let at = dice.below(sweeps.sweeps.len());
            if let Some(table) = sweeps.sweeps.get_mut(at) {
                change_table(table, dice);
            }
        }
    }
}

/// Changes the names and numbers of a table; every row keeps a number for each column.
fn change_table(table: &mut SweepTable, dice: &mut Dice) {
    let text = dice.word(TEXTS).to_string();
    match dice.below(9) {
        0 => table.name = text,
        1 => {
            let rows = table.rows.len();
            table.total = *dice.pick(&[0, rows / 2, rows + 1, 1 << 40, usize::MAX]);
        }
        2 => rename(&mut table.events, text, dice),
        3 => rename(&mut table.axes, text, dice),
        4 => rename(&mut table.run_columns, text, dice),
        5 => rename(&mut table.point_columns, text, dice),
        6 => {
            // A column of runs less.
            let at = dice.below(table.run_columns.len());
            if at < table.run_columns.len() {
                table.run_columns.remove(at);
                for row in table.rows.values_mut() {
                    row.values.remove(at);
                }
            }
        }
        7 => {
            let number = *dice.pick(&[0.5, -1.0, f64::NAN, f64::INFINITY, 1e300, 1e18, 7.0]);
            let at = dice.below(table.run_columns.len());
            if let Some(row) = table.rows.values_mut().next()
                && let Some(slot) = row.values.get_mut(at)
            {
                *slot = number;
            }
            let in_points = dice.chance(1, 2);
            let row = table.rows.values_mut().last().filter(|_| in_points);
            if let Some(slot) = row.and_then(|row| row.points.first_mut()) {
                *slot = number;
            }
        }
        _ => change_row(&mut table.rows, text, dice),
    }
}

/// Another name in a list, or a name less.
fn rename(names: &mut Vec<String>, text: String, dice: &mut Dice) {
    let at = dice.below(names.len());
    match names.get_mut(at) {
        Some(name) => *name = text,
        None => names.push(text),
    }
}

/// Rows less, at another number, or failed.
fn change_row(rows: &mut std::collections::BTreeMap<usize, Row>, text: String, dice: &mut Dice) {
    let Some(first) = rows.keys().next().copied() else { return };
    match dice.below(3) {
        0 => drop(rows.remove(&first)),
        1 => {
            let mut row = rows.remove(&first).unwrap_or_default();
            let to = *dice.pick(&[99, 1 << 40, usize::MAX]);
            if let Some(number) = row.values.first_mut() {
                *number = to as f64;
            }
            rows.insert(to, row);
        }
        _ => {
            if let Some(row) = rows.get_mut(&first) {
                row.failure = Some(text);
            }
        }
    }
}

//! Archives of sweeps: what is refused of those that were changed, and how parts become a whole.

use super::files::{SCENE, folder, names};
use crate::program::command::{bytes, refused, succeeds, tangency};
use std::io::{Cursor, Read, Write};
use std::path::Path;
use tangency::output::Sweeps;

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
        &["the name of a sweep is \"../up\"", "an entry of an archive"],
    );
    let scene = SCENE.replace("name: \"up\"", "name: \"../up\"");
    std::fs::write(at.join("bad.ron"), scene).unwrap();
    refused(at, &["sweep", "bad.ron"], &["bad.ron: the name of a sweep is \"../up\""]);
    // A scene in an archive names no files.
    let model = |about: &str| about.replace("problem:ImpactOscillator", "problem:Equations");
    let model = |about: &str| {
        let about = model(about);
        let begin = about.find("problem:Equations(").unwrap() + "problem:Equations(".len();
        let end = begin + about[begin..].find("),parameters").unwrap();
        format!("{}model:\\\"up.ron\\\"{}", &about[..begin], &about[end..])
    };
    forged(at, "out/up.npz", "forged.npz", &model);
    refused(at, &["merge", "forged.npz", "--out", "m"], &["must not refer to other files"]);
}

/// C4. A merged result is that of the whole run, the branches in its picture and their document
/// included.
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
    let said = ["large.ron is larger than the limit of 2 MB", "--max-size"];
    refused(at, &["table", "large.ron", "--max-size", "2"], &said);
    refused(at, &["trace", "large.ron", "--max-size", "2"], &said);
    refused(at, &["table", "large.ron"], &["not a tangency document"]);
    succeeds(at, &["sweep", "up.ron"]);
    let title = "a".repeat(8_000_000);
    let large = |about: &str| about.replacen("title:\"Up\"", &format!("title:\"{title}\""), 1);
    forged(at, "out/up.npz", "bomb.npz", &large);
    assert!(bytes(at, "bomb.npz").len() < 100_000);
    let said = ["bomb.npz: the archive unpacks to more than the limit of 4 MB", "--max-size"];
    refused(at, &["plot", "bomb.npz", "--max-size", "1"], &said);
    // A sparse file has no bytes, and a size.
    let sparse = std::fs::File::create(at.join("sparse.npz")).unwrap();
    sparse.set_len(100_000_000_000).unwrap();
    refused(at, &["plot", "sparse.npz"], &["sparse.npz is larger than the limit of 256 MB"]);
    for size in ["0", "-1", "nan", "1e9"] {
        let output = tangency(at, &["table", "a.ron", &format!("--max-size={size}")]);
        assert_eq!(output.status.code(), Some(2), "{size}");
    }
}

/// A column has one axis: the lengths of several, which may be more than a number holds when they
/// are multiplied, are not read.
#[test]
fn arrays_of_several_axes_are_refused() {
    let folder = folder();
    let at = folder.path();
    succeeds(at, &["sweep", "up.ron"]);
    for shape in ["(4294967296, 4294967296,)", "(9223372036854775807, 2)", "(6, 1)"] {
        let change = |name: &str, content: Vec<u8>| match name.ends_with("amplitude.npy") {
            true => with_shape(&content, shape),
            false => content,
        };
        rewritten(at, "out/up.npz", "axes.npz", &change);
        let said = ["amplitude`", "a column must have one axis, but this array has several axes"];
        refused(at, &["plot", "axes.npz"], &said);
    }
}

/// Arrays of other numbers, or of fewer or more than the header states, are refused.
#[test]
fn arrays_that_are_no_columns_are_refused() {
    let folder = folder();
    let at = folder.path();
    succeeds(at, &["sweep", "up.ron"]);
    type Change = dyn Fn(&[u8]) -> Vec<u8>;
    let cases: [(&Change, &str); 5] = [
        (
            &|c| with_type(c, "<i4"),
            "the array contains numbers of the type `<i4`, but a column must contain `<f8`",
        ),
        (&|c| with_shape(c, "(7,)"), "the header states 7 numbers of 8 bytes, but 48 bytes follow"),
        (&|c| with_shape(c, "()"), "a column must have one axis, but this array has no axes"),
        (&|c| with_shape(c, "(x,)"), "the header of the array has no readable field `shape`"),
        (&|c| c[1..].to_vec(), "the entry of the archive is not an array in NumPy's format"),
    ];
    for (change, said) in cases {
        let changed = |name: &str, content: Vec<u8>| match name.ends_with("runs/amplitude.npy") {
            true => change(&content),
            false => content,
        };
        rewritten(at, "out/up.npz", "changed.npz", &changed);
        refused(at, &["plot", "changed.npz"], &["amplitude`", said]);
    }
}

/// Header and numbers of a file of an array.
fn numbers(content: &[u8]) -> (&[u8], &[u8]) {
    content.split_at(10 + usize::from(u16::from_le_bytes([content[8], content[9]])))
}

/// A file of an array, with another type of its numbers.
fn with_type(content: &[u8], kind: &str) -> Vec<u8> {
    let (header, numbers) = numbers(content);
    let at = header.windows(3).position(|name| name == b"<f8").unwrap();
    [&header[..at], kind.as_bytes(), &header[at + 3..], numbers].concat()
}

/// A file of an array, with another shape in its header (NumPy's format 1.0: a length of two bytes,
/// and a text).
fn with_shape(content: &[u8], shape: &str) -> Vec<u8> {
    let end = numbers(content).0.len();
    let header = std::str::from_utf8(&content[10..end]).unwrap();
    let (before, rest) = header.split_once("'shape': ").unwrap();
    let (_, after) = rest.split_once(')').unwrap();
    let header = format!("{before}'shape': {shape}{after}");
    let length = u16::try_from(header.len()).unwrap().to_le_bytes();
    [&content[..8], &length, header.as_bytes(), &content[end..]].concat()
}

/// Archives with numbers of runs that cannot be, and with a table in place of another, are refused.
#[test]
fn damaged_archives_are_refused() {
    let folder = folder();
    let at = folder.path();
    succeeds(at, &["sweep", "up.ron"]);
    let fewer = |about: &str| about.replace("total:6", "total:3");
    forged(at, "out/up.npz", "total.npz", &fewer);
    refused(at, &["merge", "total.npz", "--out", "m"], &["total.npz: ", "must be 0 to 2"]);
    let text = |about: &str| about.replace("tangency-sweeps/", "tangency-swepps/");
    forged(at, "out/up.npz", "format.npz", &text);
    refused(at, &["plot", "format.npz"], &["the format of the file is `tangency-swepps/2`"]);
    assert!(Sweeps::load(at.join("out/up.npz")).unwrap().sweeps[0].is_complete());
}

/// Merging and going on need the scene from the archive: what is written there is read as the same
/// scene.
#[test]
fn scenes_in_archives_are_read_back() {
    use tangency::scene::{BUILT_IN, Catalogue, Scene};
    let catalogue = Catalogue::built_in();
    for named in BUILT_IN {
        let scene = Scene::parse(named.text).unwrap();
        assert_eq!(catalogue.parse_alone(&scene.in_words()).unwrap(), scene, "{}", named.name);
    }
}

/// An archive like another one, but for what is changed in its text `about`: written past all
/// checks.
fn forged(folder: &Path, from: &str, to: &str, change: &dyn Fn(&str) -> String) {
    rewritten(folder, from, to, &|name, content| match name {
        "about.npy" => {
            let about = change(std::str::from_utf8(numbers(&content).1).unwrap());
            let content = with_shape(&content, &format!("({},)", about.len()));
            [numbers(&content).0, about.as_bytes()].concat()
        }
        _ => content,
    });
}

/// An archive like another one, but for the bytes of its entries.
fn rewritten(folder: &Path, from: &str, to: &str, change: &dyn Fn(&str, Vec<u8>) -> Vec<u8>) {
    let mut old = zip::ZipArchive::new(Cursor::new(bytes(folder, from))).unwrap();
    let mut new = zip::ZipWriter::new(Cursor::new(Vec::new()));
    for index in 0..old.len() {
        let mut entry = old.by_index(index).unwrap();
        let (name, mut content) = (entry.name().unwrap().into_owned(), Vec::new());
        entry.read_to_end(&mut content).unwrap();
        let content = change(&name, content);
        new.start_file(name, zip::write::SimpleFileOptions::default()).unwrap();
        new.write_all(&content).unwrap();
    }
    std::fs::write(folder.join(to), new.finish().unwrap().into_inner()).unwrap();
}

/// The built-in scene draws a column that only its branches have: the sweep is drawn with its first
/// state instead. A column that the command line requests is not replaced.
#[test]
fn archives_are_drawn_without_the_columns_of_branches() {
    let folder = tempfile::tempdir().unwrap();
    let at = folder.path();
    let quick = ["--set", "transient=20", "--set", "recorded_periods=5"];
    let sweep = ["sweep", "duffing", "--over", "omega=1..1.2:3"];
    succeeds(at, &[&sweep[..], &quick].concat());
    std::fs::remove_file(at.join("out/duffing-sweep.svg")).unwrap();
    let archive = "out/duffing-sweep.npz";
    assert_eq!(succeeds(at, &["plot", archive]), "out/duffing-sweep.svg\n");
    let svg = String::from_utf8(bytes(at, "out/duffing-sweep.svg")).unwrap();
    assert!(["frequency ω", "\nx\n"].iter().all(|label| svg.contains(label)), "{svg}");
    // The scene's enlargement is a part of the diagram of that column.
    assert!(!svg.contains("(b)"), "{svg}");
    refused(at, &["plot", archive, "--y", "max_x"], &["unknown column `max_x`"]);
    // Branches are drawn in the scene's columns, and the sweep cannot join them.
    succeeds(at, &["trace", "duffing"]);
    let both = tangency(at, &["plot", "out/duffing.ron", archive, "--out", "both.svg"]);
    let warning = String::from_utf8(both.stderr).unwrap();
    assert!(both.status.success() && warning.contains("has no column `max_x` and is not drawn"));
}

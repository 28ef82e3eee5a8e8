//! Promise: the gallery shows every scene and model of the project, each on an interactive page that works from a folder
//! without a network; a scene that cannot be traced is reported.

use crate::browser::Browser;
use serde_json::json;
use std::collections::BTreeSet;
use std::path::Path;
use std::process::{Command, Output};
use tangency_reports::gallery::{Entry, PERIODS, Section, entries, gallery};

const ROOT: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/..");

/// The share of the panel that tiles cover, and the numbers of columns and rows of the finest tiles. Neighbouring tiles of
/// one colour are one shape.
const GRID: &str = "(() => {
    const shapes = document.querySelector('#panels .plot').layout.shapes;
    const sides = [['x0', 'x1'], ['y0', 'y1']].map(([low, high]) => shapes.map(it => Math.abs(it[high] - it[low])));
    const whole = [['x0', 'x1'], ['y0', 'y1']].map(names => {
        const ends = shapes.flatMap(it => names.map(name => it[name]));
        return Math.max(...ends) - Math.min(...ends);
    });
    const area = sides[0].map((width, k) => width * sides[1][k]).reduce((sum, area) => sum + area);
    const counts = whole.map((length, axis) => Math.round(length / Math.min(...sides[axis])));
    return [Math.round(1e9 * area / (whole[0] * whole[1])) / 1e9, ...counts];
})()";

fn made(arguments: &[&str], folder: &Path) -> Output {
    let mut command = Command::new(env!("CARGO_BIN_EXE_tangency-reports"));
    command.arg("gallery").args(arguments).arg("--out").arg(folder).output().unwrap()
}

/// No scene and no model is missing, and no two entries write the same file.
#[test]
fn all_scenes_and_models_have_an_entry() {
    let all = entries();
    let names: BTreeSet<&str> = all.iter().map(|entry| entry.name.as_str()).collect();
    assert_eq!(names.len(), all.len());
    let mut files = 0;
    for folder in ["scenes", "scenes/library", "examples"] {
        for file in std::fs::read_dir(Path::new(ROOT).join(folder)).unwrap() {
            let path = file.unwrap().path();
            let ending = path.extension().and_then(|it| it.to_str()).unwrap_or_default();
            if !["ron", "ode"].contains(&ending) {
                continue;
            }
            let text = std::fs::read_to_string(&path).unwrap();
            assert!(all.iter().any(|entry| entry.text == text), "{}", path.display());
            files += 1;
        }
    }
    assert_eq!(files, all.len());
}

/// The index and the pages of two scenes, one traced and one swept, in a browser: no error, curves and tiles, values under
/// the pointer, and no request that leaves the folder.
#[test]
fn a_gallery_of_two_scenes_opens_from_its_folder() {
    let folder = tempfile::tempdir().unwrap();
    let target = folder.path().join("gallery");
    let output = made(&["brusselator", "mita-basins"], &target);
    let printed = String::from_utf8_lossy(&output.stdout);
    assert!(output.status.success(), "{printed}{}", String::from_utf8_lossy(&output.stderr));
    for name in ["brusselator", "mita-basins"] {
        assert!(printed.lines().any(|line| line.starts_with(name) && line.ends_with(" s")));
    }
    let files = std::fs::read_dir(&target).unwrap().map(|file| file.unwrap().file_name());
    let files: BTreeSet<String> = files.map(|name| name.into_string().unwrap()).collect();
    let expected = ["brusselator.html", "brusselator.svg", "index.html", "mita-basins.html"];
    let expected = expected.into_iter().chain(["mita-basins.svg", "plotly.min.js"]);
    assert_eq!(files, expected.map(String::from).collect());

    let Some(mut browser) = Browser::start(folder.path()) else {
        eprintln!("gallery: chromium is not installed, so that this test cannot run");
        return;
    };
    browser.open(&target.join("index.html"));
    let (columns, lines) = looks(&mut browser);
    browser.evaluate("document.querySelector('#brusselator h3 a').click()");
    browser.wait("document.body?.dataset.ready === 'true'");
    assert_eq!(browser.evaluate("document.title"), json!("Brusselator"));
    let curves = "document.querySelector('#panels .plot').data.length > 1";
    assert_eq!(browser.evaluate(curves), json!(true));
    // Cycles begin at b = 1 + a², where the equilibrium is x = a, y = b/a, and a = 1.
    let rows = browser.hovered(0, [2.0, 1.0]);
    assert!(rows[0].1.contains("HB"), "{rows:?}");
    for (name, value) in [("b", 2.0), ("x", 1.0), ("y", 2.0)] {
        let shown = &rows.iter().find(|row| row.0 == name).unwrap().1;
        let shown: f64 = shown.split(" ± ").next().unwrap().parse().unwrap();
        assert!((shown - value).abs() < 1e-9, "{name}: {shown}");
    }
    // The tiles cover the panel, in the grid that the index states.
    browser.open(&target.join("mita-basins.html"));
    browser.wait("document.title.startsWith('Basins') && document.body?.dataset.ready === 'true'");
    let grid = browser.numbers(GRID);
    assert_eq!(grid, [1.0, columns as f64, lines as f64]);

    let requests = browser.requests();
    let inside = |address: &&String| {
        address.starts_with("data:") || address.starts_with(&format!("file://{}", target.display()))
    };
    assert_eq!(requests.iter().find(|address| !inside(address)), None);
    assert!(requests.iter().any(|address| address.ends_with("/plotly.min.js")), "{requests:?}");
}

/// The index has a thumbnail, a command and a scene for each entry, and says that a sweep is coarser. Nothing is wider
/// than a narrow window. Returns the numbers of columns and rows of the sweep.
fn looks(browser: &mut Browser) -> (usize, usize) {
    browser.wait("document.querySelectorAll('article').length === 2");
    browser.evaluate(
        "document.querySelectorAll('img').forEach(image => { image.loading = 'eager'; })",
    );
    browser.wait("[...document.images].every(image => image.complete && image.naturalWidth > 100)");
    let text = |browser: &mut Browser, selector: &str| {
        let value = browser.evaluate(&format!("document.querySelector('{selector}').textContent"));
        value.as_str().unwrap().to_string()
    };
    let commands = text(browser, "#brusselator .command");
    let expected =
        "tangency trace brusselator\ntangency plot out/brusselator.ron --out brusselator.html";
    assert_eq!(commands, expected);
    let commands = text(browser, "#mita-basins .command");
    let expected =
        "tangency sweep mita-basins\ntangency plot out/mita-basins.npz --out mita-basins.html";
    assert_eq!(commands, expected);
    assert!(text(browser, "#brusselator details pre").contains("b*x - x^2*y"));
    let note = text(browser, "#mita-basins .note");
    let numbers: Vec<usize> = note.split(' ').filter_map(|word| word.parse().ok()).collect();
    let [coarse, other, 99, 101] = numbers[..] else { panic!("{note}") };
    // Each run has at most 400 periods.
    assert!(coarse * other >= PERIODS / 400 && coarse * other < 99 * 101, "{note}");
    for width in [400, 1200] {
        browser.resize(width, 900);
        browser.wait("document.documentElement.scrollWidth <= innerWidth");
    }
    (coarse, other)
}

/// A scene that cannot be traced is named, by the library, in the index and by the command.
#[test]
fn failures_are_reported() {
    let folder = tempfile::tempdir().unwrap();
    let text = "Scene(title: \"No start\", problem: Equations(states: [(\"x\", \"a + x^2 + 1\")],
        solution: equilibrium), parameters: [(\"a\", 1)],
        runs: [(name: \"r\", along: [(name: \"a\", low: 0, high: 2)])])";
    let entry = |name: &str, text| Entry {
        name: name.into(),
        section: Section::Devices,
        arguments: "a.ron",
        text,
        request: None,
    };
    let bratu = entries().into_iter().find(|entry| entry.name == "bratu").unwrap();
    let all = [entry("unsolvable", text), bratu, entry("unreadable", "Scene(")];
    let made_of = gallery(&all, folder.path(), &|_, _, _| ()).unwrap();
    let names: Vec<&str> = made_of.failures.iter().map(|(name, _)| name.as_str()).collect();
    assert_eq!(names, ["unsolvable", "unreadable"]);
    let index = std::fs::read_to_string(made_of.index).unwrap();
    assert!(index.contains("<li>unsolvable: ") && index.contains("<article id=\"bratu\">"));

    let output = made(&["brusselatr"], folder.path());
    let message = String::from_utf8_lossy(&output.stderr);
    assert!(!output.status.success() && message.contains("brusselator"), "{message}");
}

//! The README says what is so: its code is the files' code, its output is the program's. So do the
//! scripts for clusters.

use std::path::Path;
use std::process::Command;

const README: &str = include_str!("../../README.md");

/// A fenced block: its language and its text.
struct Block {
    language: String,
    text: String,
}

fn blocks(page: &str) -> Vec<Block> {
    let mut parts = page.split("```");
    parts.next();
    let mut blocks = Vec::new();
    while let (Some(block), Some(_)) = (parts.next(), parts.next()) {
        let (language, text) = block.split_once('\n').expect("a block has lines");
        blocks.push(Block { language: language.into(), text: text.into() });
    }
    blocks
}

fn shows(page: &str, language: &str, text: &str) -> bool {
    blocks(page).iter().any(|block| block.language == language && block.text == text)
}

#[test]
fn the_example_is_the_file_and_short() {
    let example = include_str!("../../examples/parallel_plate.rs");
    assert!(shows(README, "rust", example), "the README shows another examples/parallel_plate.rs");
    let lines = example.lines().filter(|line| !line.is_empty()).count();
    assert!(lines <= 15, "{lines} lines");
}

#[test]
fn the_scene_is_the_file() {
    assert!(shows(README, "ron", include_str!("../../examples/narrow-plate.ron")));
    assert!(shows(README, "ron", include_str!("../../examples/lorenz.ron")));
}

#[test]
fn the_regression_test_is_the_file() {
    let (_, test) = include_str!("../regression.rs").split_once('\n').unwrap();
    assert!(shows(README, "rust", test), "the README shows another tests/regression.rs");
}

#[test]
fn scripts_for_clusters_are_the_files() {
    let page = include_str!("../../docs/concepts/sweeps.md");
    for (language, script) in [
        ("sh", include_str!("../../docs/how-to/clusters/slurm.sh")),
        ("sh", include_str!("../../docs/how-to/clusters/parallel.sh")),
        ("yaml", include_str!("../../docs/how-to/clusters/kubernetes.yaml")),
    ] {
        assert!(shows(page, language, script), "docs/concepts/sweeps.md shows another\n{script}");
    }
}

/// Every command that runs the program, in order, in a folder of its own, against the output shown
/// behind it. Numbers may differ by rounding.
#[test]
fn commands_give_the_output_shown() {
    let folder = tempfile::tempdir().unwrap();
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    std::fs::create_dir(folder.path().join("examples")).unwrap();
    for file in ["examples/narrow-plate.ron", "examples/lorenz.ron"] {
        std::fs::copy(root.join(file), folder.path().join(file)).unwrap();
    }
    let blocks = blocks(README);
    let mut compared = 0;
    for (index, block) in blocks.iter().enumerate() {
        let run = "cargo run --release -- ";
        if block.language != "sh" || !block.text.starts_with(run) {
            continue;
        }
        let program = format!("'{}' ", env!("CARGO_BIN_EXE_tangency"));
        let script = format!("exec 2>&1\n{}", block.text.replace(run, &program));
        let output = Command::new("sh")
            .args(["-ec", &script])
            .current_dir(folder.path())
            .output()
            .expect("a shell");
        let text = String::from_utf8(output.stdout).unwrap();
        assert!(output.status.success(), "{}\n{text}", block.text);
        if let Some(shown) = blocks.get(index + 1).filter(|next| next.language == "text") {
            assert!(
                agree(&shown.text, &text),
                "{}\nshown:\n{}\nfound:\n{text}",
                block.text,
                shown.text
            );
            compared += 1;
        }
    }
    assert!(compared >= 4, "only {compared} outputs are shown");
}

/// Whether two texts agree word for word; numbers to a relative 1e-6, with rounding below 1e-5
/// taken for zero.
fn agree(shown: &str, found: &str) -> bool {
    let words = |text: &str| -> Vec<String> {
        text.split([' ', '\n', ',']).filter(|word| !word.is_empty()).map(String::from).collect()
    };
    let (shown, found) = (words(shown), words(found));
    shown.len() == found.len()
        && shown.iter().zip(&found).all(|(a, b)| match (a.parse::<f64>(), b.parse::<f64>()) {
            (Ok(a), Ok(b)) => (a - b).abs() <= 1e-6 * a.abs().max(b.abs()).max(10.0),
            _ => a == b,
        })
}

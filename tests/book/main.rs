//! Promise: the README and every page of the book say what the program does. Links lead somewhere, the book is built without
//! a warning, and commands give the output shown after the commands.
//!
//! `cargo test --release --test book` checks all pages; arguments after `--` choose pages by parts of their names. A page's
//! commands run in order, in a folder of its own, with the program on `PATH`:
//!
//! * a block whose first line is a comment with a file's name (`// lorenz.ron`, `# plot.py`) is written to that file;
//! * a block `sh` is run, and a following block `text` is compared with what was printed: words
//!   exactly, numbers to 1e-6;
//! * commands of a clone (`cargo`, `python3 benches/…`) are left to `.ci/run`, scripts (`#!`) to those who run them, and a block
//!   `console` shows a session that depends on the machine.

use std::error::Error;
use std::path::{Path, PathBuf};
use std::process::{Command, ExitCode};
use std::sync::Mutex;
use std::time::Instant;

mod links;
mod page;

use page::Page;

const ROOT: &str = env!("CARGO_MANIFEST_DIR");

/// The counts of a page, for the table.
#[derive(Default)]
struct Counts {
    files: usize,
    commands: usize,
    compared: usize,
}

fn main() -> ExitCode {
    let wanted: Vec<String> = std::env::args().skip(1).filter(|a| !a.starts_with('-')).collect();
    let pages = match page::all(Path::new(ROOT)) {
        Ok(pages) => pages,
        Err(error) => {
            eprintln!("error: {error}");
            return ExitCode::FAILURE;
        }
    };
    let mut failures = links::broken(&pages);
    failures.extend(unlisted(&pages));
    failures.extend(undoctested(&pages));
    failures.extend(outdated(&pages));
    failures.extend(built());
    let chosen =
        |page: &&Page| wanted.is_empty() || wanted.iter().any(|part| page.name.contains(part));
    failures.extend(run(&pages.iter().filter(chosen).collect::<Vec<_>>()));
    for failure in &failures {
        eprintln!("error: {failure}\n");
    }
    println!("{} pages, {} failures", pages.len(), failures.len());
    if failures.is_empty() { ExitCode::SUCCESS } else { ExitCode::FAILURE }
}

/// Pages that the summary does not list: readers of the book would not find them.
fn unlisted(pages: &[Page]) -> Vec<String> {
    let summary = pages.iter().find(|page| page.name == "docs/SUMMARY.md");
    let listed = |page: &&Page| {
        let name = page.name.strip_prefix("docs/");
        name.is_none_or(|name| {
            name == "SUMMARY.md" || summary.is_some_and(|s| s.text.contains(&format!("]({name})")))
        })
    };
    let missing = pages.iter().filter(|page| !listed(page));
    missing.map(|page| format!("{} is not in docs/SUMMARY.md", page.name)).collect()
}

/// Pages with Rust code that `src/lib.rs` does not include among the documentation tests.
fn undoctested(pages: &[Page]) -> Vec<String> {
    let library = include_str!("../../src/lib.rs");
    let untested = pages.iter().filter(|page| {
        page.blocks.iter().any(|block| block.language.starts_with("rust"))
            && !library.contains(&format!("include_str!(\"../{}\")", page.name))
    });
    untested
        .map(|page| {
            format!("{} has Rust code, and src/lib.rs does not include the page", page.name)
        })
        .collect()
}

/// Files of the project that a page shows, with the page.
const SHOWN: [(&str, &str); 6] = [
    ("README.md", "examples/lorenz.ron"),
    ("README.md", "examples/parallel_plate.rs"),
    ("docs/how-to/regression.md", "tests/regression.rs"),
    ("docs/how-to/clusters.md", "docs/how-to/clusters/slurm.sh"),
    ("docs/how-to/clusters.md", "docs/how-to/clusters/parallel.sh"),
    ("docs/how-to/clusters.md", "docs/how-to/clusters/kubernetes.yaml"),
];

/// Pages that show another text than the file has.
fn outdated(pages: &[Page]) -> Vec<String> {
    let differs = |(name, file): &(&str, &str)| {
        let text = std::fs::read_to_string(Path::new(ROOT).join(file)).unwrap_or_default();
        // The first line of a test says what the test promises.
        let text = if file.starts_with("tests/") {
            text.split_once('\n').map_or("", |(_, rest)| rest)
        } else {
            &text
        };
        let page = pages.iter().find(|page| page.name == *name);
        !page.is_some_and(|page| page.blocks.iter().any(|block| block.text == text))
    };
    let outdated = SHOWN.iter().filter(|pair| differs(pair));
    outdated.map(|(page, file)| format!("{page} does not show {file} as it is")).collect()
}

/// Builds the book where mdBook is installed; its warnings count as failures.
fn built() -> Vec<String> {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let build =
        Command::new("mdbook").args(["build", ROOT, "--dest-dir"]).arg(folder.path()).output();
    match build {
        Err(_) => {
            println!("mdbook is not installed (`cargo install mdbook`): the book was not built");
            Vec::new()
        }
        Ok(output) => {
            let log = String::from_utf8_lossy(&output.stderr).into_owned();
            let sound = output.status.success() && !log.contains("WARN");
            if sound { Vec::new() } else { vec![format!("mdbook build:\n{log}")] }
        }
    }
}

/// Runs the commands of pages, two pages at a time, and prints a row for each.
fn run(pages: &[&Page]) -> Vec<String> {
    let queue = Mutex::new(pages.iter());
    let failures = Mutex::new(Vec::new());
    println!("{:45} {:>5} {:>8} {:>8} {:>6}", "page", "files", "commands", "compared", "s");
    let work = || {
        while let Some(page) = { queue.lock().expect("no panic").next() } {
            let start = Instant::now();
            match follow(page) {
                Ok(counts) if counts.commands > 0 => println!(
                    "{:45} {:5} {:8} {:8} {:6.1}",
                    page.name,
                    counts.files,
                    counts.commands,
                    counts.compared,
                    start.elapsed().as_secs_f64()
                ),
                Ok(_) => {}
                Err(error) => {
                    failures.lock().expect("no panic").push(format!("{}: {error}", page.name));
                }
            }
        }
    };
    std::thread::scope(|scope| {
        scope.spawn(work);
        scope.spawn(work);
    });
    failures.into_inner().expect("no panic")
}

/// Writes the files of a page, runs its commands, and compares what they print.
fn follow(page: &Page) -> Result<Counts, Box<dyn Error>> {
    let folder = tempfile::tempdir()?;
    // The README speaks of a clone's `examples`.
    if page.name == "README.md" {
        std::fs::create_dir(folder.path().join("examples"))?;
        let example = "examples/lorenz.ron";
        std::fs::copy(Path::new(ROOT).join(example), folder.path().join(example))?;
    }
    let program = PathBuf::from(env!("CARGO_BIN_EXE_tangency"));
    let bin = program.parent().ok_or("the program has no folder")?;
    let path = format!("{}:{}", bin.display(), std::env::var("PATH")?);
    let mut counts = Counts::default();
    for block in &page.blocks {
        if let Some(name) = block.file() {
            std::fs::write(folder.path().join(name), block.text)?;
            counts.files += 1;
        }
    }
    for (index, block) in page.blocks.iter().enumerate().filter(|(_, block)| block.is_run()) {
        let output = Command::new("sh")
            .args(["-ec", &format!("exec 2>&1\n{}", block.text)])
            .env("PATH", &path)
            .env("COLUMNS", "400")
            .current_dir(folder.path())
            .output()?;
        let found = String::from_utf8(output.stdout)?;
        if !output.status.success() {
            return Err(format!("failed:\n{}\n{found}", block.text).into());
        }
        counts.commands += 1;
        let next = page.blocks.get(index + 1);
        if let Some(shown) = next.filter(|next| next.language == "text") {
            if let Some(difference) = page::difference(shown.text, &found) {
                let (command, shown) = (block.text, shown.text);
                let message =
                    format!("{difference}\ncommand:\n{command}\nshown:\n{shown}\nfound:\n{found}");
                return Err(message.into());
            }
            counts.compared += 1;
        }
    }
    Ok(counts)
}

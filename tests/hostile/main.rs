//! Bad input of all kinds, given to the command line: it answers, and says what is wrong.
//!
//! `cargo test --test hostile` runs a few cases. Of many,
//!
//! ```text
//! cargo test --release --test hostile -- --cases 20000 --seed 1
//! ```
//!
//! prints how they ended, and what is wrong with it. `--kind scene` takes cases of one kind alone,
//! `--case 17` runs one again, and keeps its files; `--binary PATH` takes another program;
//! `--messages 100` prints as many messages, for a reader to judge whether they name place, value
//! and remedy.
//!
//! What must hold of every case (`verdict.rs`):
//!
//! - The exit code is 0, 1 with a message, or 2 for arguments that cannot be understood: no panic,
//!   no signal.
//! - After two seconds it is interrupted as by Ctrl-C, and then it ends within three.
//! - A message begins with `error: ` (after warnings), names the file or the option, has no more
//!   than 20 lines, none of them of more than 720 characters, and no control characters.
//! - Inputs are as they were, special files are still what they were, pictures are whole; there are
//!   no temporary files, and nothing is written elsewhere.

mod bases;
mod cases;
mod dice;
mod mutate;
#[path = "../common/random.rs"]
mod random;
mod report;
mod runner;
mod verdict;
mod words;

use bases::Bases;
use cases::{Case, Kind};
use report::{Report, escaped};
use runner::Program;
use std::path::{Path, PathBuf};
use std::process::ExitCode;
use std::sync::Mutex;
use std::sync::atomic::{AtomicU64, Ordering};
use std::time::Instant;

/// How many cases run at a time.
const WORKERS: usize = 2;

/// What is asked for.
struct Asked {
    cases: u64,
    seed: u64,
    kind: Option<Kind>,
    case: Option<u64>,
    messages: usize,
    program: Program,
}

impl Asked {
    /// The arguments of the test; others than these are of the test runner.
    fn read() -> Result<Self, String> {
        let path = PathBuf::from(env!("CARGO_BIN_EXE_tangency"));
        let mut asked = Asked {
            cases: 300,
            seed: 1,
            kind: None,
            case: None,
            messages: 0,
            program: Program { path },
        };
        let mut arguments = std::env::args().skip(1);
        while let Some(name) = arguments.next() {
            let mut value = || arguments.next().ok_or(format!("{name} needs a value"));
            let number =
                |text: String| text.parse().map_err(|_| format!("{name} {text}: no number"));
            match name.as_str() {
                "--cases" => asked.cases = number(value()?)?,
                "--seed" => asked.seed = number(value()?)?,
                "--case" => asked.case = Some(number(value()?)?),
                "--messages" => asked.messages = number(value()?)? as usize,
                "--binary" => {
                    let path = std::fs::canonicalize(value()?);
                    asked.program.path = path.map_err(|error| format!("--binary: {error}"))?;
                }
                "--kind" => {
                    let wanted = value()?;
                    let kind = Kind::ALL.into_iter().find(|kind| kind.name() == wanted);
                    asked.kind = Some(kind.ok_or(format!("--kind {wanted}: there is none"))?);
                }
                _ => {}
            }
        }
        Ok(asked)
    }

    /// Runs all cases, and reports.
    fn run(&self, bases: &Bases, folder: &Path) -> std::io::Result<Report> {
        let (next, report) = (AtomicU64::new(0), Mutex::new(Report::default()));
        let work = || -> std::io::Result<()> {
            loop {
                let number = next.fetch_add(1, Ordering::Relaxed);
                if number >= self.cases {
                    return Ok(());
                }
                if self.kind.is_some_and(|kind| kind != Kind::of(number)) {
                    continue;
                }
                let root = folder.join(format!("case-{number}"));
                let case = Case::new(bases, self.seed, number, &root)?;
                let ended = self.program.run(&case)?;
                let faults = verdict::faults(&case, &ended);
                report.lock().expect("no worker panics").add(&case, &ended, faults);
                std::fs::remove_dir_all(&root)?;
            }
        };
        std::thread::scope(|scope| {
            let workers: Vec<_> = (0..WORKERS).map(|_| scope.spawn(work)).collect();
            workers.into_iter().try_for_each(|worker| worker.join().expect("no worker panics"))
        })?;
        Ok(report.into_inner().expect("no worker panics"))
    }

    /// Runs one case, and keeps its files.
    fn once(&self, number: u64, bases: &Bases, folder: &Path) -> std::io::Result<bool> {
        let case = Case::new(bases, self.seed, number, &folder.join(format!("case-{number}")))?;
        println!("cd {}\n{}", case.folder.display(), case.in_words());
        let began = Instant::now();
        let ended = self.program.run(&case)?;
        let faults = verdict::faults(&case, &ended);
        println!("{:.2?}, exit {:?}, signal {:?}", began.elapsed(), ended.code, ended.signal);
        ended.message.lines().for_each(|line| println!("{}", escaped(line)));
        println!("{faults:?}");
        Ok(faults.is_empty())
    }
}

/// Whether all went well.
fn all_well() -> Result<bool, Box<dyn std::error::Error>> {
    let asked = Asked::read()?;
    let folder = tempfile::tempdir()?;
    let bases = Bases::new(&asked.program, folder.path())?;
    if let Some(number) = asked.case {
        return Ok(asked.once(number, &bases, &folder.keep())?);
    }
    let began = Instant::now();
    let mut report = asked.run(&bases, folder.path())?;
    let well = report.print(asked.seed);
    println!("\nseed {}, {:.1} s", asked.seed, began.elapsed().as_secs_f64());
    if asked.messages > 0 {
        report.print_messages(asked.seed, asked.messages);
    }
    Ok(well)
}

fn main() -> ExitCode {
    match all_well() {
        Ok(true) => ExitCode::SUCCESS,
        Ok(false) => ExitCode::FAILURE,
        Err(error) => {
            eprintln!("{error}");
            ExitCode::FAILURE
        }
    }
}

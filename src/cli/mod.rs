//! The command-line program: it parses arguments, calls the library, and returns exit codes and
//! messages; it contains no numerics.
//!
//! [`run`] is the `main` function of the program `tangency`, and of other programs that add their
//! own problems:
//!
//! ```
//! use tangency::{Catalogue, problems::classic::ParallelPlate, scene::execute};
//! const SCENE: &str = "Scene(title: \"pull-in\", problem: MyPlate(), parameters: [(\"load\", 0)],
//!     runs: [Run(name: \"plate\", along: [(name: \"load\", low: 0)])])";
//! fn catalogue() -> Catalogue {
//!     Catalogue::built_in().zero("MyPlate", ParallelPlate).scene("plate", SCENE)
//! }
//! /// The program: `my-program trace plate` prints the branch.
//! fn program() -> std::process::ExitCode {
//!     tangency::cli::run(catalogue())
//! }
//! // The same branch without the command line: the fold of the plate is at the load 4/27.
//! let document = execute(&catalogue().parse(SCENE)?, None, &mut ()).document;
//! assert!((document.branches[0].special[1].parameters[0] - 4.0 / 27.0).abs() < 1e-14);
//! # Ok::<(), tangency::scene::SceneError>(())
//! ```

mod cells;
mod compare;
mod error;
mod find;
mod grid;
mod import;
mod list;
#[cfg(feature = "live")]
mod live;
mod manifolds;
mod plot;
mod request;
mod results;
mod scene_at;
mod shell;
mod signals;
mod simulate;
mod sources;
mod stdout;
mod sweep;
mod table;
mod trace;
mod warning;
mod watch;

use crate::core::spelling::shown;
use crate::output::{SizeLimit, printable};
use crate::scene::Catalogue;
use clap::{Parser, Subcommand};
use sources::Sources;
use std::ffi::OsString;
use std::io::Write;
use std::process::ExitCode;
use stdout::Leavable;

/// Follow curves of solutions, and find the folds and other special points on them.
#[derive(Debug, Parser)]
#[command(version, about, disable_help_subcommand = true)]
struct Arguments {
    #[command(subcommand)]
    command: Command,
    /// The maximum size of an input file in MB; an archive may unpack to four times this size
    #[arg(long, global = true, value_name = "MB", default_value_t = 256,
        value_parser = clap::value_parser!(u64).range(1..=1_000_000))]
    max_size: u64,
}

#[derive(Debug, Subcommand)]
enum Command {
    Trace(trace::Trace),
    Simulate(simulate::Simulate),
    Find(find::Find),
    Manifolds(manifolds::Manifolds),
    Plot(plot::Plot),
    Sweep(sweep::Sweep),
    Merge(sweep::Merge),
    Table(table::Table),
    #[cfg(feature = "live")]
    Live(live::Live),
    Compare(compare::Compare),
    Scenes(list::Scenes),
    Show(trace::Show),
    Import(import::Import),
    Completions(shell::Completions),
    #[command(name = "man")]
    Manual(shell::Manual),
}

/// Returns the parsed arguments of the program, or the exit code if the arguments are invalid or
/// request help.
fn arguments() -> Result<Arguments, ExitCode> {
    let given: Vec<OsString> = std::env::args_os().collect();
    let lossy = given.iter().map(|argument| argument.to_string_lossy());
    if let Some(odd) = lossy.into_iter().find(|argument| argument.contains(char::is_control)) {
        let odd = shown(&odd);
        let rule = "file names and values must not contain control characters";
        let _ = writeln!(
            std::io::stderr(),
            "error: the argument `{odd}` contains control characters: {rule}"
        );
        return Err(ExitCode::from(2));
    }
    Arguments::try_parse_from(given).map_err(|error| {
        if error.use_stderr() {
            let _ = write!(std::io::stderr(), "{}", printable(&error.render().to_string()));
        } else {
            let _ = error.print();
        }
        ExitCode::from(error.exit_code() as u8)
    })
}

/// Runs the command line with the program's arguments and with the problems and scenes of a
/// catalogue; a program can use it as `main`. The exit code is 0 on success, 1 after an error, 2
/// for invalid arguments, and 3 if `trace --strict` finds unreliable results.
///
/// ```no_run
/// use tangency::Catalogue;
/// use tangency::problems::classic::ParallelPlate;
/// fn main() -> std::process::ExitCode {
///     let scene = "Scene(title: \"pull-in\", problem: MyPlate(), parameters: [(\"load\", 0)],
///         runs: [Run(name: \"plate\", along: [(name: \"load\", low: 0)])])";
///     tangency::cli::run(Catalogue::built_in().zero("MyPlate", ParallelPlate).scene("plate", scene))
/// }
/// ```
pub fn run(catalogue: Catalogue) -> ExitCode {
    let arguments = match arguments() {
        Ok(arguments) => arguments,
        Err(code) => return code,
    };
    let limit = SizeLimit::megabytes(arguments.max_size);
    let from = Sources { catalogue: &catalogue, limit };
    let mut out = Leavable::new(std::io::stdout().lock());
    let result = match &arguments.command {
        Command::Trace(trace) => trace.run(from, &mut out),
        Command::Simulate(simulate) => simulate.run(from, &mut out),
        Command::Find(find) => find.run(from, &mut out),
        Command::Manifolds(manifolds) => manifolds.run(from, &mut out),
        Command::Plot(plot) => plot.run(from, &mut out),
        Command::Sweep(sweep) => sweep.run(from, &mut out),
        Command::Merge(merge) => merge.run(from, &mut out),
        Command::Table(table) => table.run(limit, &mut out),
        #[cfg(feature = "live")]
        Command::Live(live) => live.run(from, &mut out),
        Command::Compare(compare) => compare.run(limit, &mut out),
        Command::Scenes(scenes) => scenes.run(&catalogue, &mut out),
        Command::Show(show) => show.run(from, &mut out),
        Command::Import(import) => import.run(limit, &mut out),
        Command::Completions(completions) => completions.run::<Arguments>(&mut out),
        Command::Manual(manual) => manual.run::<Arguments>(&mut out),
    };
    match result.and_then(|()| Ok(out.flush()?)) {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            warning::complain(&error);
            ExitCode::from(error.code())
        }
    }
}

//! The command line: `tangency points FILE`, `tangency plot FILE…`.

mod cli;

use std::process::ExitCode;

fn main() -> ExitCode {
    cli::main()
}

//! The program, killed in the middle: files are whole, belong together, and the same command goes
//! on to the same bytes.
//!
//! `cargo test --test kill` kills a few runs; `cargo test --test kill -- 300` kills 300, two thirds
//! of them by SIGKILL, the others by SIGTERM; runs that had ended before are not counted. A second
//! number is the seed. Each case works in a folder of its own: an old result is there or not, one
//! to three runs of one command are killed in turn, at a random time or when their first temporary
//! file appears, and the command is then left to end. What must hold:
//!
//! - After every kill each file is whole, and the picture is the one that the data beside it make:
//!   both old or both new. Only a kill between the renames of two files separates them; the temporary
//!   files that it leaves are the missing new files.
//! - After the last run the files have the bytes of a run that nobody killed, and nothing else is
//!   in the folder.

mod case;
#[path = "../common/random.rs"]
mod random;
mod table;

use case::{Case, Command, Signal};
use random::Random;
use std::process::ExitCode;
use table::Table;

fn main() -> ExitCode {
    let mut numbers = std::env::args().skip(1).filter_map(|argument| argument.parse().ok());
    let (kills, seed) = (numbers.next().unwrap_or(12u64), numbers.next().unwrap_or(1));
    if cfg!(not(unix)) {
        return ExitCode::SUCCESS;
    }
    let mut random = Random::new(seed);
    let mut table = Table::default();
    let commands = [Command::trace(), Command::sweep()];
    // By signal: those that are still to be done.
    let mut left = [(Signal::Kill, kills - kills / 3), (Signal::Term, kills / 3)];
    for turn in 0.. {
        let wanted = if turn % 3 == 2 { 1 } else { 0 };
        let wanted = if left[wanted].1 > 0 { wanted } else { 1 - wanted };
        let (signal, more) = &mut left[wanted];
        if *more == 0 {
            break;
        }
        let count = (1 + random.number() % 3).min(*more);
        let mut case = Case::new(&commands[turn / 3 % 2], *signal, &mut random);
        *more -= (0..count).take_while(|_| case.kill(&mut random)).count() as u64;
        table.add(case.end());
    }
    table.print()
}

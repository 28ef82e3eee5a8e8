//! What was killed, and what was left.

use super::case::Signal;
use std::collections::BTreeMap;
use std::process::ExitCode;

/// What the kills of one kind left.
pub struct Counted {
    pub command: &'static str,
    pub signal: Signal,
    pub kills: usize,
    /// Runs that had ended before they were killed: these are no kills.
    pub too_late: usize,
    /// Kills after which there were no files, the old ones, a part of the new ones, all of these.
    pub nothing: usize,
    pub old: usize,
    pub partly: usize,
    pub whole: usize,
    /// Kills after which there were temporary files.
    pub leftovers: usize,
    /// Kills between the renames of two files of one result.
    pub between: usize,
    pub wrong: Vec<String>,
}

impl Counted {
    pub fn new(command: &'static str, signal: Signal) -> Self {
        Counted {
            command,
            signal,
            kills: 0,
            too_late: 0,
            nothing: 0,
            old: 0,
            partly: 0,
            whole: 0,
            leftovers: 0,
            between: 0,
            wrong: Vec::new(),
        }
    }
}

/// Sums by command and signal.
#[derive(Default)]
pub struct Table(BTreeMap<(&'static str, Signal), Counted>);

impl Table {
    pub fn add(&mut self, more: Counted) {
        let row = self.0.entry((more.command, more.signal));
        let row = row.or_insert_with(|| Counted::new(more.command, more.signal));
        row.kills += more.kills;
        row.too_late += more.too_late;
        row.nothing += more.nothing;
        row.old += more.old;
        row.partly += more.partly;
        row.whole += more.whole;
        row.leftovers += more.leftovers;
        row.between += more.between;
        row.wrong.extend(more.wrong);
    }

    /// Prints all rows; a failure if anything is wrong.
    pub fn print(&self) -> ExitCode {
        println!(
            "| command | signal | kills | too late | no files | old | in part | whole | temporary files | between renames | wrong |"
        );
        println!("|---|---|---|---|---|---|---|---|---|---|---|");
        for row in self.0.values() {
            let Counted { command, signal, kills, too_late, nothing, old, .. } = row;
            let Counted { partly, whole, leftovers, between, wrong, .. } = row;
            let wrong = wrong.len();
            println!(
                "| {command} | {signal:?} | {kills} | {too_late} | {nothing} | {old} | {partly} | {whole} | {leftovers} | {between} | {wrong} |"
            );
        }
        let wrong: Vec<&String> = self.0.values().flat_map(|row| &row.wrong).collect();
        wrong.iter().for_each(|line| println!("wrong: {line}"));
        if wrong.is_empty() { ExitCode::SUCCESS } else { ExitCode::FAILURE }
    }
}

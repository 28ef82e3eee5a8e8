//! What the cases have come to: a table, the faults, and messages to be read.

use super::cases::{Case, Kind};
use super::dice::Dice;
use super::runner::Ended;
use super::verdict::Fault;
use std::collections::{BTreeMap, BTreeSet};

/// How many cases of a kind ended how.
#[derive(Clone, Copy, Debug, Default)]
struct Counts {
    cases: usize,
    /// Exit codes 0, 1, 2.
    codes: [usize; 3],
    interrupted: usize,
    panics: usize,
    signals: usize,
    hangs: usize,
    others: usize,
}

/// All that is known of the cases.
#[derive(Default)]
pub struct Report {
    counts: BTreeMap<Kind, Counts>,
    faults: BTreeMap<Fault, Vec<(u64, String, String)>>,
    /// Messages by their form, without numbers and names: the case, the command and the message.
    messages: BTreeMap<String, (u64, String, String)>,
}

impl Report {
    /// Takes in how a case ended.
    pub fn add(&mut self, case: &Case, ended: &Ended, faults: Vec<Fault>) {
        let counts = self.counts.entry(case.kind).or_default();
        counts.cases += 1;
        counts.interrupted += usize::from(ended.interrupted);
        if let Some(count) = ended.code.and_then(|code| counts.codes.get_mut(code as usize)) {
            *count += 1;
        }
        for fault in &faults {
            *match fault {
                Fault::Panic => &mut counts.panics,
                Fault::Signal(_) => &mut counts.signals,
                Fault::Hang => &mut counts.hangs,
                _ => &mut counts.others,
            } += 1;
        }
        let this = || (case.number, case.in_words(), ended.message.clone());
        if matches!(ended.code, Some(1 | 2)) && !ended.interrupted {
            // The first case of a form, whichever thread was faster.
            let known = self.messages.entry(form(&ended.message)).or_insert_with(this);
            if known.0 > case.number {
                *known = this();
            }
        }
        for fault in faults {
            self.faults.entry(fault).or_default().push(this());
        }
    }

    /// Prints the table and the faults; whether there are none.
    pub fn print(&mut self, seed: u64) -> bool {
        println!(
            "| kind | cases | exit 0 | 1 | 2 | interrupted | panic | signal | hang | other faults |"
        );
        println!("|---|---|---|---|---|---|---|---|---|---|");
        let mut total = Counts::default();
        for (kind, counts) in &self.counts {
            row(kind.name(), counts);
            total.add(counts);
        }
        row("total", &total);
        for (fault, cases) in &mut self.faults {
            cases.sort();
            println!("\n{}× {fault:?}", cases.len());
            let mut forms = BTreeSet::new();
            let different = cases.iter().filter(|(_, _, message)| forms.insert(form(message)));
            for (number, command, message) in different.take(8) {
                println!("  --seed {seed} --case {number}: {}", cut(command));
                message.lines().take(3).for_each(|line| println!("      {}", cut(line)));
            }
        }
        self.faults.is_empty()
    }

    /// Prints some messages, no two of one form, for a reader to judge.
    pub fn print_messages(&self, seed: u64, count: usize) {
        let mut all: Vec<_> = self.messages.values().collect();
        println!("\n{} of {} forms of messages", count.min(all.len()), all.len());
        let mut dice = Dice::new(seed, u64::MAX);
        for k in 1..=count.min(all.len()) {
            let (number, command, message) = all.swap_remove(dice.below(all.len()));
            println!("\n{k}. case {number}: {}", cut(command));
            message.lines().for_each(|line| println!("    {}", escaped(line)));
        }
    }
}

impl Counts {
    fn add(&mut self, more: &Counts) {
        self.cases += more.cases;
        self.codes.iter_mut().zip(more.codes).for_each(|(count, more)| *count += more);
        self.interrupted += more.interrupted;
        self.panics += more.panics;
        self.signals += more.signals;
        self.hangs += more.hangs;
        self.others += more.others;
    }
}

fn row(name: &str, counts: &Counts) {
    let Counts { cases, codes: [zero, one, two], interrupted, panics, signals, hangs, others } =
        counts;
    println!(
        "| {name} | {cases} | {zero} | {one} | {two} | {interrupted} | {panics} | {signals} | {hangs} | {others} |"
    );
}

/// The beginning of a long line, with control characters escaped.
fn cut(line: &str) -> String {
    let begin: String = line.chars().take(300).collect();
    if begin.len() < line.len() { escaped(&begin) + " …" } else { escaped(&begin) }
}

/// A text with its control characters as messages write them.
pub fn escaped(text: &str) -> String {
    let one = |c: char| if c.is_control() { c.escape_debug().collect() } else { String::from(c) };
    text.chars().map(one).collect()
}

/// How a message begins, after its place, without numbers and without what stands in quotes.
fn form(message: &str) -> String {
    let line = message.lines().find(|line| line.starts_with("error: ")).unwrap_or(message);
    let end = line.find("Known: ").unwrap_or(line.len());
    let outside = line[..end].split(['`', '\'', '"']).step_by(2).collect::<String>();
    let places = [".ron: ", ".ode: ", ".npz: "];
    let begin = places.iter().filter_map(|place| outside.rfind(place)).max().map_or(0, |at| at + 6);
    outside[begin..].chars().filter(|c| c.is_alphabetic() || *c == ' ').take(60).collect()
}

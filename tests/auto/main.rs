//! AUTO's demos: every known point is there, once, and nothing else, whatever the step and the
//! discretisation.
//!
//! `cargo test --release --test auto` prints the table of `docs/evidence/auto.md`. Arguments after `--`
//! choose demos by parts of their names; `all` runs them with steps of other sizes, too. With
//! `TANGENCY_SHOW` set branches are printed.

mod boundary;
mod boundary_values;
mod cycles;
mod equilibria;
mod fields;
mod report;

use report::{Report, Variant};
use std::process::ExitCode;
use std::time::Instant;

type Outcome = Result<(), Box<dyn std::error::Error>>;

/// A demo.
#[derive(Clone, Copy)]
struct Case {
    name: &'static str,
    /// Whether its solutions are discretised.
    discretised: bool,
    /// The CPU seconds that AUTO takes for the whole demo, where they are known.
    auto: &'static str,
    run: fn(Variant, &mut Report) -> Outcome,
}

const fn case(
    name: &'static str,
    discretised: bool,
    auto: &'static str,
    run: fn(Variant, &mut Report) -> Outcome,
) -> Case {
    Case { name, discretised, auto, run }
}

/// What `max_step` is multiplied by.
const STEPS: [f64; 5] = [1.0, 0.2, 0.5, 2.0, 5.0];

fn main() -> ExitCode {
    let arguments: Vec<String> = std::env::args().skip(1).filter(|a| !a.starts_with('-')).collect();
    let all = arguments.iter().any(|a| a == "all");
    let names: Vec<&String> = arguments.iter().filter(|a| *a != "all").collect();
    let chosen = |case: &Case| names.is_empty() || names.iter().any(|n| case.name.contains(*n));
    println!(
        "| demo | steps | method | compared | worst error | s | AUTO, s |\n|---|---|---|---|---|---|---|"
    );
    let mut failed = false;
    for case in [equilibria::CASES, boundary_values::CASES, cycles::CASES].concat() {
        if !chosen(&case) {
            continue;
        }
        let methods: &[bool] = if case.discretised { &[false, true] } else { &[false] };
        for &shooting in methods {
            for &step in if all { &STEPS[..] } else { &STEPS[..1] } {
                failed |= !run(case, Variant { step, shooting });
            }
        }
    }
    if failed { ExitCode::FAILURE } else { ExitCode::SUCCESS }
}

/// Runs a demo and prints its row, and what is wrong.
fn run(case: Case, variant: Variant) -> bool {
    let (mut report, began) = (Report::default(), Instant::now());
    if let Err(cause) = (case.run)(variant, &mut report) {
        report.failures.push(cause.to_string());
    }
    let Case { name, auto, .. } = case;
    let method = match (case.discretised, variant.shooting) {
        (false, _) => "",
        (_, false) => "collocation",
        (_, true) => "shooting",
    };
    let (step, seconds) = (variant.step, began.elapsed().as_secs_f64());
    let Report { compared, worst, .. } = report;
    println!("| {name} | × {step} | {method} | {compared} | {worst:.0e} | {seconds:.3} | {auto} |");
    for failure in &report.failures {
        println!("    **wrong**: {failure}");
    }
    report.failures.is_empty()
}

//! What is printed.

use super::compare::Comparison;
use std::process::ExitCode;
use std::time::Duration;

/// Of what is wrong in a row so much is printed.
const MOST_SHOWN: usize = 8;

/// The rows of a table.
pub struct Table {
    rows: usize,
    seconds: f64,
    total: Comparison,
    failures: usize,
    show: bool,
}

impl Table {
    pub fn new() -> Self {
        println!(
            "| scene | variants | points | missing | extra | beyond | unstable | other | refused | worst / error | s |\n\
             |---|---|---|---|---|---|---|---|---|---|---|"
        );
        let show = std::env::var_os("TANGENCY_SHOW").is_some();
        Table { rows: 0, seconds: 0.0, total: Comparison::default(), failures: 0, show }
    }

    fn print(scene: &str, what: &str, seconds: f64, sum: &Comparison) {
        let Comparison { points, missing, extra, beyond, unstable, wrong, worst, refused } = sum;
        let other = wrong.len() - missing - extra - beyond - unstable;
        println!(
            "| {scene} | {what} | {points} | {missing} | {extra} | {beyond} | {unstable} | {other} | {refused} | {worst:.1e} | {seconds:.2} |"
        );
    }

    /// A scene under a variant: what is wrong is printed at once.
    pub fn row(&mut self, scene: &str, variant: &str, took: Duration, found: Comparison) {
        let seconds = took.as_secs_f64();
        if self.show {
            Self::print(scene, variant, seconds, &found);
        }
        for wrong in found.wrong.iter().take(MOST_SHOWN) {
            println!("    **wrong** ({scene}, {variant}): {wrong}");
        }
        if let Some(more) = found.wrong.len().checked_sub(MOST_SHOWN + 1) {
            println!("    **wrong** ({scene}, {variant}): and {} more", more + 1);
        }
        self.rows += 1;
        self.seconds += seconds;
        self.failures += found.wrong.len();
        self.total.add(found);
    }

    /// The sum of the rows since the last one.
    pub fn sum(&mut self, scene: &str) {
        if self.rows > 0 {
            let total = std::mem::take(&mut self.total);
            Self::print(scene, &self.rows.to_string(), self.seconds, &total);
        }
        (self.rows, self.seconds) = (0, 0.0);
    }

    pub fn end(&self) -> ExitCode {
        match self.failures {
            0 => ExitCode::SUCCESS,
            count => {
                println!("\n{count} answers differ");
                ExitCode::FAILURE
            }
        }
    }
}

//! What a case has found, compared with what is known.

use tangency::core::continuation::{Branch, SpecialPoint};
use tangency::core::system::Kind;

/// The settings under which a case is run.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Variant {
    /// What `max_step` is multiplied by.
    pub step: f64,
    /// Whether solutions are discretised by shooting.
    pub shooting: bool,
}

/// The comparisons of one case under one variant.
#[derive(Default)]
pub struct Report {
    /// How many values were compared.
    pub compared: usize,
    /// The largest relative error of a value that was found.
    pub worst: f64,
    /// What is missing, extra or wrong.
    pub failures: Vec<String>,
}

/// Whether two values agree, relative to the expected one where that exceeds 1.
fn error_of(found: f64, expected: f64) -> f64 {
    (found - expected).abs() / expected.abs().max(1.0)
}

/// Prints a branch, where `TANGENCY_SHOW` is set.
pub fn show(branch: &Branch) {
    if std::env::var_os("TANGENCY_SHOW").is_none() {
        return;
    }
    let [first, last] = &branch.ends;
    println!("== {}: {} points: {first} | {last}", branch.name, branch.points.len());
    for s in &branch.special {
        println!(
            "   {:>3} {} {:?} {:?} unstable {:?} error {:.1e} {} {}",
            s.label, s.kind, s.parameters, s.monitors, s.unstable, s.error, s.converged, s.event
        );
    }
}

impl Report {
    /// Records a comparison of two values.
    pub fn value(&mut self, what: &str, found: f64, expected: f64, tolerance: f64) {
        let error = error_of(found, expected);
        self.compared += 1;
        if error <= tolerance {
            self.worst = self.worst.max(error);
        } else {
            self.failures.push(format!("{what}: found {found:.13}, expected {expected:.13}"));
        }
    }

    /// Records a claim.
    pub fn claim(&mut self, what: impl Into<String>, holds: bool) {
        self.compared += 1;
        if !holds {
            self.failures.push(what.into());
        }
    }

    /// A branch has exactly these points of a kind, by the values of a column, each of them
    /// converged.
    pub fn points(
        &mut self,
        branch: &Branch,
        kind: Kind,
        column: &str,
        expected: &[f64],
        tolerance: f64,
    ) {
        let Some(c) = branch.column(column) else {
            return self.claim(format!("{}: no column {column}", branch.name), false);
        };
        let mut found: Vec<&SpecialPoint> = branch.of_kind(kind).collect();
        for &value in expected {
            let distance = |s: &SpecialPoint| error_of(s.value(c).unwrap_or(f64::NAN), value);
            let nearest =
                (0..found.len()).min_by(|&a, &b| distance(found[a]).total_cmp(&distance(found[b])));
            self.compared += 1;
            match nearest.map(|k| (k, distance(found[k]))) {
                Some((k, error)) if error <= tolerance => {
                    let converged = found.remove(k).converged;
                    self.worst = self.worst.max(error);
                    if !converged {
                        self.failures.push(format!(
                            "{}: {kind} at {column} = {value} has not converged",
                            branch.name
                        ));
                    }
                }
                near => {
                    let near =
                        near.map_or(f64::NAN, |(k, _)| found[k].value(c).unwrap_or(f64::NAN));
                    let text = format!(
                        "{}: no {kind} at {column} = {value}; the nearest is {near:.13}",
                        branch.name
                    );
                    self.failures.push(text);
                }
            }
        }
        for extra in found {
            let (value, converged) = (extra.value(c).unwrap_or(f64::NAN), extra.converged);
            let text = format!(
                "{}: {kind} at {column} = {value:.13} (converged: {converged})",
                branch.name
            );
            self.failures.push(format!("extra: {text}"));
        }
    }

    /// A branch has no points of these kinds.
    pub fn none(&mut self, branch: &Branch, kinds: &[Kind]) {
        for &kind in kinds {
            self.points(branch, kind, &branch.released[0], &[], 0.0);
        }
    }

    /// A branch ends for these reasons, in either order, each given by a part of its words.
    pub fn ends(&mut self, branch: &Branch, expected: [&str; 2]) {
        let found = branch.ends.each_ref().map(|end| end.to_string());
        let [a, b] = expected;
        let is = |k: usize, part: &str| found[k].contains(part);
        let holds = is(0, a) && is(1, b) || is(0, b) && is(1, a);
        self.claim(format!("{}: ends {found:?}, expected {expected:?}", branch.name), holds);
    }
}

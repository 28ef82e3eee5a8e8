//! The values of parameters for which a discretisation must be suitable.

use super::problem::Problem;
use super::statement::Run;
use std::collections::BTreeMap;

/// The finite ends of the ranges over which the runs of a scene continue each parameter, in increasing
/// order.
pub(super) struct Ends(BTreeMap<String, Vec<f64>>);

impl Ends {
    pub fn of(runs: &[Run]) -> Ends {
        let mut ends = BTreeMap::<String, Vec<f64>>::new();
        for range in runs.iter().flat_map(|run| &run.along) {
            let own = [range.low, range.high].into_iter().flatten().filter(|end| end.is_finite());
            ends.entry(range.name.clone()).or_default().extend(own);
        }
        ends.values_mut().for_each(|own| own.sort_by(f64::total_cmp));
        Ends(ends)
    }

    /// Returns, for each parameter, how far the parameter varies from its start in any run of the
    /// scene; with this information, a discretisation can be chosen that is suitable for all these
    /// values. All runs of a scene use the same range of parameters to choose the discretisation, so
    /// that a run can start where another run ended.
    pub fn reach(&self, problem: &Problem, values: &[f64]) -> Vec<f64> {
        let mut reach = values.to_vec();
        for ((reach, value), name) in reach.iter_mut().zip(values).zip(problem.parameter_names()) {
            let Some(ends) = self.0.get(&name) else { continue };
            // Ratios suit parameters such as aspect ratios; a parameter that starts at zero is
            // measured by its size.
            let far = |end: f64| if *value == 0.0 { end.abs() } else { (end / value).ln().abs() };
            for end in extremes(ends) {
                if far(end).is_finite() && far(end) > far(*reach) {
                    *reach = end;
                }
            }
        }
        reach
    }
}

/// Returns the negative numbers nearest to zero and farthest from zero, and the same positive numbers,
/// of numbers in increasing order.
fn extremes(ends: &[f64]) -> impl Iterator<Item = f64> {
    let negative = &ends[..ends.partition_point(|end| *end < 0.0)];
    let positive = &ends[ends.partition_point(|end| *end <= 0.0)..];
    [negative, positive]
        .map(|part| [part.first().copied(), part.last().copied()])
        .into_iter()
        .flatten()
        .flatten()
}

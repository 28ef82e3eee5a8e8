//! Turns of the continued parameter at which no special point was located.

use super::branch::Branch;
use crate::core::system::Kind;

/// Heuristic: a turn of the parameter counts if the parameter changes on both sides by more than this
/// fraction of its largest value.
const LEAST: f64 = 1e-6;

/// The maximum number of turns that a warning names.
const NAMED: usize = 3;

/// Returns a warning if the continued parameter of a branch of solutions turns between points
/// and no special point was located there. The turn is a fold that was missed, for example because a
/// period doubling is so close that the fold cannot be distinguished from errors of the mesh.
pub(super) fn unexplained(branch: &Branch) -> Option<String> {
    let [name] = &branch.released[..] else { return None };
    let column = branch.column(name)?;
    let values: Vec<f64> =
        branch.points.iter().map(|point| point.value(column)).collect::<Option<_>>()?;
    let least = LEAST * values.iter().fold(0.0, |most: f64, value| most.max(value.abs()));
    let explains = |kind: Kind| !matches!(kind, Kind::RG | Kind::UZ);
    let is_explained = |k: usize| {
        let is_start = branch.points[k].slopes.as_ref().is_some_and(|it| it.position == 0.0);
        let near = |after: usize| after + 1 == k || after == k;
        is_start || branch.special.iter().any(|it| explains(it.kind) && near(it.after))
    };
    // The two ends of a branch are refined, and may therefore lie beside the curve through its points.
    let turns = (2..values.len().saturating_sub(2)).filter(|&k| {
        let changes = [values[k] - values[k - 1], values[k + 1] - values[k]];
        let turns = changes[0] * changes[1] < 0.0;
        turns && changes.iter().all(|change| change.abs() > least) && !is_explained(k)
    });
    let turns: Vec<String> = turns.map(|k| format!("{:.7}", values[k])).collect();
    let more = turns.len().saturating_sub(NAMED);
    let named = turns[..turns.len() - more].join(", ");
    let more = if more > 0 { format!(" and at {more} more values") } else { String::new() };
    (!turns.is_empty()).then(|| {
        format!(
            "`{name}` turns near {named}{more}, but no fold was located there: a fold and another \
             special point may be very close together; take more `intervals`, or smaller steps \
             (`max_step`)"
        )
    })
}

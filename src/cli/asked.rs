//! The options of a request, as they are written on the command line.

use super::request::{RequestArgs, Switch, Within};
use crate::output::significant;
use crate::scene::Range;

/// Returns the options that state a request, one after another: `--set nu=0.3`, `--along load=0..2`.
pub(super) fn options(
    set: &[(String, String)],
    start: Option<String>,
    within: &Within,
    request: &RequestArgs,
) -> Vec<String> {
    let RequestArgs { along, bound, mark, settle, hold, switch, depth } = request;
    let mut all: Vec<String> =
        set.iter().map(|(name, value)| format!("--set {name}={value}")).collect();
    all.extend(along.iter().map(|range| format!("--along {}", written(range))));
    all.extend(bound.iter().map(|range| format!("--bound {}", written(range))));
    all.extend(mark.iter().map(|mark| format!("--mark {}", equal(mark))));
    all.extend(start.map(|start| format!("--start {start}")));
    if let Some(search) = within.search() {
        let ranges = search.ranges.iter().map(written).collect::<Vec<_>>().join(",");
        all.push(format!("--box {ranges} --starts {}", search.starts));
    }
    all.extend(settle.iter().map(|time| format!("--settle {}", significant(*time, 17))));
    all.extend(hold.iter().map(|kind| format!("--hold {kind}")));
    if let Some(switch) = switch {
        let kinds = match switch {
            Switch::All => "all".into(),
            Switch::Kinds(kinds) => {
                kinds.iter().map(ToString::to_string).collect::<Vec<_>>().join(",")
            }
        };
        all.push(format!("--switch {kinds} --depth {depth}"));
    }
    all
}

/// Returns a range as `NAME=LOW..HIGH`.
fn written(Range { name, low, high }: &Range) -> String {
    let end = |end: &Option<f64>| end.map_or(String::new(), |end| significant(end, 17));
    format!("{name}={}..{}", end(low), end(high))
}

/// Returns a state or mark as `NAME=VALUE`.
pub(super) fn equal((name, value): &(String, f64)) -> String {
    format!("{name}={}", significant(*value, 17))
}

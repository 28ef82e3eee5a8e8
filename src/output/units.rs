//! Prefixes of units.

use super::number::significant;

/// The units that can have prefixes.
const UNITS: [&str; 12] = ["m", "s", "V", "A", "N", "Pa", "Hz", "J", "W", "F", "C", "g"];
/// The prefixes of units, each with the exponent of its power of ten.
const PREFIXES: [(i32, &str); 8] =
    [(-12, "p"), (-9, "n"), (-6, "µ"), (-3, "m"), (3, "k"), (6, "M"), (9, "G"), (12, "T")];
/// The units that can have only prefixes with negative exponents.
const ONLY_SMALLER: [&str; 2] = ["m", "s"];

/// Returns the exponent, a multiple of 3, of the power of ten by which an axis divides its numbers,
/// given the largest of the numbers; 0 if the numbers are readable without a factor.
pub(super) fn exponent(largest: f64) -> i32 {
    match largest {
        ..1e-2 | 1e5.. => 3 * (largest.log10() / 3.0).floor() as i32,
        _ => 0,
    }
}

/// Returns the text and the unit of an axis label: `gap` and `m` for `gap (m)`. Returns `None` for
/// an axis label of several columns, because such a label has no single unit.
pub(super) fn parts(label: &str) -> Option<(&str, &str)> {
    let parts = label.strip_suffix(')').and_then(|label| label.rsplit_once('('));
    let (words, unit) = parts.filter(|(words, _)| !words.contains(['(', ',']))?;
    Some((words.strip_suffix(' ')?, unit))
}

/// Returns a unit with the prefix for a power of ten, for example `µm` for `m` and the exponent −6;
/// `None` if the unit does not take this prefix.
pub(super) fn prefixed(unit: &str, exponent: i32) -> Option<String> {
    let takes = UNITS.contains(&unit) && (exponent < 0 || !ONLY_SMALLER.contains(&unit));
    let (_, prefix) = PREFIXES.iter().find(|(known, _)| takes && *known == exponent)?;
    Some(format!("{prefix}{unit}"))
}

/// Writes a number with a prefixed unit, as on an axis whose largest number is this number: `2 µm`
/// for `2e-6` with the label `gap (m)`. Returns `None` for a number that is readable without a
/// prefix, and for a label without a unit that takes prefixes.
pub(super) fn with_prefix(value: f64, label: &str) -> Option<String> {
    let (_, unit) = parts(label)?;
    let exponent = exponent(value.abs());
    let unit = prefixed(unit, exponent)?;
    Some(format!("{} {unit}", significant(value / 10f64.powi(exponent), 12)))
}

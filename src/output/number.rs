//! Numbers as text.

/// A number rounded to so many significant digits, in the shortest form that keeps them: plain
/// between 1e-5 and 10^`digits`, scientific otherwise. Trailing zeros are left out. `digits` counts
/// from 1 to 17 and is moved into that range.
///
/// ```
/// use tangency::output::significant;
/// assert_eq!(significant(4.0 / 27.0, 15), "0.148148148148148");
/// assert_eq!(significant(0.1 + 0.2, 15), "0.3");
/// assert_eq!(significant(-1.5e-9, 15), "-1.5e-9");
/// assert_eq!(significant(172.9636, 3), "173");
/// ```
pub fn significant(value: f64, digits: usize) -> String {
    if value == 0.0 {
        return "0".into();
    }
    let digits = digits.clamp(1, 17);
    let rounded: f64 = format!("{value:.*e}", digits - 1).parse().unwrap_or(value);
    match rounded.abs() {
        size if (1e-5..10f64.powi(digits as i32)).contains(&size) => rounded.to_string(),
        _ => format!("{rounded:e}"),
    }
}

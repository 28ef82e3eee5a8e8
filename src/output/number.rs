//! Numbers as text.

/// Formats a number rounded to the given number of significant digits, in the shortest form that
/// keeps these digits: as a decimal number between 1e-5 and 10^`digits`, in scientific notation
/// otherwise. Trailing zeros are omitted. The number `digits` is restricted to the range
/// from 1 to 17.
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
    let scientific = format!("{value:.*e}", digits - 1);
    let Some((mantissa, exponent)) = scientific.split_once('e') else {
        return scientific;
    };
    let exponent: i32 = exponent.parse().unwrap_or(0);
    let mantissa = match mantissa.contains('.') {
        true => mantissa.trim_end_matches('0').trim_end_matches('.'),
        false => mantissa,
    };
    if exponent < -5 || exponent >= digits as i32 {
        return format!("{mantissa}e{exponent}");
    }
    let kept = mantissa.bytes().filter(u8::is_ascii_digit).count() as i32;
    let decimals = usize::try_from(kept - 1 - exponent).unwrap_or(0);
    format!("{value:.decimals$}")
}

/// Returns how many significant digits of a value are certain if the error of the value is at most
/// the given error.
pub(super) fn certain_digits(value: f64, error: f64) -> usize {
    if error == 0.0 {
        return 17;
    }
    (value / error).abs().log10().floor().clamp(0.0, 17.0) as usize
}

//! Orders of convergence.

/// Asserts that errors fall with the power `order` of a step: `measured` are steps and errors, and
/// in each of at least three refinements the exponent is within 10 % of the order.
#[track_caller]
pub fn falls_with_order(what: &str, measured: &[(f64, f64)], order: f64) {
    let exponent =
        |pair: &[(f64, f64)]| (pair[0].1 / pair[1].1).ln() / (pair[0].0 / pair[1].0).ln();
    let exponents: Vec<f64> = measured.windows(2).map(exponent).collect();
    let hold = exponents.iter().all(|found| (found / order - 1.0).abs() < 0.1);
    assert!(
        exponents.len() >= 3 && hold,
        "{what}: order {order} is expected, and found are {exponents:.2?}, of {measured:?}"
    );
}

//! What Newton's method allocates once it has been warmed up.

use tangency::core::bifurcation::DefiningSystem;
use tangency::core::continuation::{Extended, Newton, Tolerances};
use tangency::core::system::System;

const TOLERANCES: Tolerances = Tolerances::new(1e-12, 12);

/// Solves four times from the same start, in which everything beyond the held condition is square,
/// and counts what the last solve allocates.
pub fn allocations(
    system: &mut dyn System,
    x: &[f64],
    released: Vec<usize>,
    condition: Option<Box<dyn DefiningSystem>>,
) -> u64 {
    let mut equations = Extended::new(system, x, released);
    let mut start = equations.unload(x);
    if let Some(condition) = condition {
        start = equations.hold(condition, &start).unwrap();
    }
    let weights = vec![1.0; start.len()];
    let mut newton = Newton::default();
    let mut unknowns = start.clone();
    // What was learned about the equations' curvature may change the way, and with it the buffers
    // in use.
    for _ in 0..3 {
        newton.solve(&mut equations, &mut unknowns, None, &weights, TOLERANCES).unwrap();
        unknowns.copy_from_slice(&start);
    }
    let mut iterations = 0;
    let counted = allocation_counter::measure(|| {
        let report = newton.solve(&mut equations, &mut unknowns, None, &weights, TOLERANCES);
        iterations = report.map_or(0, |report| report.iterations);
    });
    assert!(iterations >= 1, "the last solve converges as the others did");
    counted.count_total
}

//! Computation of an equilibrium near a given state by Newton's method.

use super::rest::left_sides;
use crate::core::hybrid::{Guard, HybridEquations, Mode};
use nalgebra::{DMatrix, DVector};
use num_dual::Dual64;

/// Heuristic: the maximal number of Newton iterations that start from a state nearly at rest.
const ITERATIONS: usize = 10;

/// Rounding: Newton's iteration has converged if the correction is no larger than this threshold,
/// in units of the sizes of the states.
const CONVERGED: f64 = 1e-10;

/// Computes the equilibrium of a mode near a state by Newton's method; `None` if the iteration does
/// not converge, or if the equilibrium is not admissible.
///
/// ```
/// use tangency::core::equilibrium::equilibrium_near;
/// use tangency::core::orbit::Smooth;
/// use tangency::problems::classic::Lure;
/// let x = equilibrium_near(&Smooth(Lure), 0, &[0.1, 0.0, 0.0], &[1.2, 1.0]).unwrap();
/// assert!(x.iter().all(|x| x.abs() < 1e-15));
/// ```
pub fn equilibrium_near(
    system: &dyn HybridEquations,
    mode: usize,
    x: &[f64],
    p: &[f64],
) -> Option<Vec<f64>> {
    let (n, sizes) = (x.len(), system.sizes_of(mode, p));
    let dual: Vec<Dual64> = p.iter().map(|p| Dual64::from(*p)).collect();
    let mut x = x.to_vec();
    for _ in 0..ITERATIONS {
        system.domain_of(mode, &x, p).ok()?;
        let (mut matrix, mut values) = (DMatrix::zeros(n, n), DVector::zeros(n));
        let mut r = vec![Dual64::from(0.0); n];
        for j in 0..n {
            let seed = |(i, x): (usize, &f64)| Dual64::new(*x, if i == j { 1.0 } else { 0.0 });
            let z: Vec<Dual64> = x.iter().enumerate().map(seed).collect();
            left_sides((system, mode), &z, &dual, &mut r);
            for (i, r) in r.iter().enumerate() {
                (matrix[(i, j)], values[i]) = (r.eps, r.re);
            }
        }
        let way = matrix.lu().solve(&values)?;
        x.iter_mut().zip(way.iter()).for_each(|(x, way)| *x -= way);
        let parts = way.iter().zip(&x).zip(&sizes);
        if parts.clone().all(|((way, x), size)| way.abs() <= CONVERGED * x.abs().max(*size)) {
            let lasts = |(guard, of): (usize, Guard)| {
                !of.modes.contains(&mode) || system.guard(guard, mode, 0.0, &x, p) > 0.0
            };
            return system.guards().into_iter().enumerate().all(lasts).then_some(x);
        }
    }
    None
}

/// Describes an equilibrium as text: its states, and its mode if the system has several modes.
pub(crate) fn place_in_words(system: &dyn HybridEquations, mode: usize, states: &[f64]) -> String {
    let modes = system.modes();
    let Mode { name, states: names, .. } = &modes[mode];
    let within = if modes.len() > 1 { format!("in mode `{name}`, ") } else { String::new() };
    let values = names.iter().zip(states).map(|(name, x)| format!("{name} = {x:.6}"));
    format!("{within}at {}", values.collect::<Vec<_>>().join(", "))
}

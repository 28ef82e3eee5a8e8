//! Boundary equilibria, at which a guard of the mode vanishes, and the coinciding equilibria of the
//! modes that follow this guard.

use super::rest::RestInMode;
use crate::core::failure::Failure;
use crate::core::linalg::{Border, Factors, Form, dot};
use crate::core::system::{Functional, System, ZeroSystem};
use std::sync::Arc;

/// The name of a point at which a guard vanishes at an equilibrium of its mode.
const BOUNDARY: &str = "boundary equilibrium";
/// The name of a boundary equilibrium if the equilibria of the two modes are admissible on opposite
/// sides of the point.
const PERSISTENCE: &str = "boundary equilibrium: persistence";
/// The name of a boundary equilibrium if the equilibria of the two modes are admissible on the same
/// side of the point, and no equilibrium is admissible on the other side.
const NONSMOOTH_FOLD: &str = "boundary equilibrium: nonsmooth fold";

/// Discretisation: a guard counts as zero if it is smaller than this threshold, in units of its
/// scale. A vector field counts as zero if it is smaller than this threshold, in units of its
/// changes over the sizes of the states. Located points are accurate to 1e-10.
const VANISHES: f64 = 1e-6;

/// Returns the equilibria of other modes that coincide with a boundary equilibrium, as pairs of
/// mode and states. Only the modes that may follow the vanishing guards are considered.
pub(super) fn neighbours(rest: &RestInMode, z: &[f64], p: &[f64]) -> Vec<(usize, Vec<f64>)> {
    let (system, mode, modes) = (rest.system(), rest.mode, rest.system().modes());
    let mut found: Vec<(usize, Vec<f64>)> = Vec::new();
    for guard in vanishing(rest, z, p) {
        let decided = system.may_follow(guard, mode);
        let next = || vec![system.next_mode(guard, mode, 0.0, z, p)];
        let following = if decided.is_empty() { next() } else { decided };
        let held = system.mode_after_accumulation(guard, mode, 0.0, z, p);
        for next in following.into_iter().chain(held) {
            let mut after = vec![0.0; modes[next].states.len()];
            system.reset(guard, (mode, next), 0.0, z, p, &mut after);
            let known = next == mode || found.iter().any(|(mode, _)| *mode == next);
            if !known && rests(rest, next, &after, p) {
                found.push((next, after));
            }
        }
    }
    found
}

/// Returns the guards of a mode that vanish at a state.
fn vanishing(rest: &RestInMode, z: &[f64], p: &[f64]) -> Vec<usize> {
    let scaled = scaled_guards(rest, z, p);
    scaled.filter(|(_, value)| value.abs() < VANISHES).map(|(guard, _)| guard).collect()
}

/// Returns the values of the guards of a mode at a state, in units of their scales.
fn scaled_guards<'a>(
    rest: &'a RestInMode,
    z: &'a [f64],
    p: &'a [f64],
) -> impl Iterator<Item = (usize, f64)> + 'a {
    let scales = rest.scales_of_guards(p);
    rest.guards.iter().zip(scales).map(move |(guard, scale)| {
        (*guard, rest.system().guard(*guard, rest.mode, 0.0, z, p) / scale)
    })
}

/// Whether a state is an equilibrium of another mode, and is admissible in that mode up to
/// rounding.
fn rests(rest: &RestInMode, mode: usize, z: &[f64], p: &[f64]) -> bool {
    let Ok(other) = RestInMode::new(rest.system.clone(), mode) else { return false };
    if !scaled_guards(&other, z, p).all(|(_, value)| value > -VANISHES) {
        return false;
    }
    let sizes = other.system().sizes_of(mode, p);
    let (n, x) = (z.len(), [z, p].concat());
    let mut matrix = ZeroSystem::new(Arc::new(other));
    let mut residual = vec![0.0; n];
    if matrix.residual(&x, &mut residual).is_err() || matrix.assemble(&x).is_err() {
        return false;
    }
    let mut jacobian = vec![0.0; n * n];
    matrix.jacobian(&mut jacobian);
    residual.iter().enumerate().all(|(i, value)| {
        let change = |j: usize| jacobian[j * n + i].abs() * z[j].abs().max(sizes[j]);
        value.abs() <= VANISHES * (0..n).map(change).sum::<f64>()
    })
}

/// Whether an equilibrium lies on the boundary of its mode for all values of the parameters, which
/// is assumed if the monitor `distance` and its derivatives with respect to all parameters vanish.
pub(super) fn stays_at_boundary(system: &mut dyn System, x: &[f64], scale: f64) -> bool {
    let (mut distance, p) = ([0.0], x[system.names().dimension()..].to_vec());
    let known = system.monitors(x, 0, &mut distance).is_ok();
    if !known || distance[0].abs() >= VANISHES * scale {
        return false;
    }
    let still = |(rate, p): (&f64, &f64)| rate.abs() * p.abs().max(1.0) < VANISHES * scale;
    rates(system, x).is_some_and(|rates| rates.iter().zip(&p).all(still))
}

/// Returns the error for a boundary equilibrium from which no branch of equilibria of another mode
/// emanates.
pub(super) fn no_neighbour(rest: &RestInMode) -> Failure {
    Failure::Undetermined(format!(
        "no other mode has an equilibrium at the boundary point that the equilibrium of mode `{}` \
         reaches",
        rest.name()
    ))
}

/// Returns the name of a boundary equilibrium, which depends on the sides on which the equilibria
/// of the two modes are admissible.
///
/// The monitors `distance` of the two equilibria vanish together, so their gradients with respect
/// to the parameters are parallel. The signs of the largest components of the gradients determine
/// the name.
pub(super) fn subkind(
    (own, x): (&mut dyn System, &[f64]),
    other: Option<(impl System, Vec<f64>)>,
) -> &'static str {
    let Some((mut other, there)) = other else { return BOUNDARY };
    let (Some(own), Some(other)) = (rates(own, x), rates(&mut other, &there)) else {
        return BOUNDARY;
    };
    let products = own.iter().zip(&other).map(|(a, b)| a * b);
    match products.max_by(|a, b| a.abs().total_cmp(&b.abs())) {
        Some(product) if product < 0.0 => PERSISTENCE,
        Some(product) if product > 0.0 => NONSMOOTH_FOLD,
        _ => BOUNDARY,
    }
}

/// Returns the derivatives of the monitor `distance` of an equilibrium with respect to each
/// parameter; `None` if the equilibrium does not depend smoothly on the parameters.
fn rates(system: &mut dyn System, x: &[f64]) -> Option<Vec<f64>> {
    let n = system.names().dimension();
    let all: Vec<usize> = (0..x.len() - n).collect();
    let mut slope = vec![0.0; x.len()];
    system.gradient(x, Functional::Monitor(0), &all, &mut slope).ok()?;
    system.assemble(x).ok()?;
    let mut factors = Factors::default();
    system.factor(Form::Jacobian, Border::NONE, &mut factors).ok()?;
    let mut adjoint = slope[..n].to_vec();
    factors.solve_transposed(&mut adjoint);
    let (mut direction, mut column) = (vec![0.0; x.len()], vec![0.0; n]);
    let rate = |p: usize| {
        direction.fill(0.0);
        direction[n + p] = 1.0;
        system.derivative(x, &[&direction], &mut column).ok()?;
        Some(slope[n + p] - dot(&adjoint, &column))
    };
    all.into_iter().map(rate).collect()
}

//! Boundary equilibria, and the equilibria of the modes that follow the guard which an equilibrium
//! reaches.

use super::rest::RestInMode;
use crate::core::failure::Failure;
use crate::core::linalg::{Border, Factors, Form, dot};
use crate::core::system::{Functional, System, ZeroSystem};
use std::sync::Arc;

/// An equilibrium reaches a guard of its mode.
const BOUNDARY: &str = "boundary equilibrium";
/// The equilibrium of the mode that follows the guard is admissible on the other side.
const PERSISTENCE: &str = "boundary equilibrium: persistence";
/// Both equilibria are admissible on the same side, and neither on the other.
const NONSMOOTH_FOLD: &str = "boundary equilibrium: nonsmooth fold";

/// (D) A guard vanishes if it is smaller than this in units of its scale; a field vanishes
/// likewise, in units of its changes over the sizes of the states. Located points are accurate to
/// 1e-10.
const VANISHES: f64 = 1e-6;

/// Returns the equilibria of other modes that coincide with an equilibrium at the boundary of its
/// mode, as pairs of mode and states. The modes are those that may follow the vanishing guards.
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

/// The guards of a mode that vanish at a state.
fn vanishing(rest: &RestInMode, z: &[f64], p: &[f64]) -> Vec<usize> {
    let scaled = scaled_guards(rest, z, p);
    scaled.filter(|(_, value)| value.abs() < VANISHES).map(|(guard, _)| guard).collect()
}

/// The guards of a mode at a state, in units of their scales.
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

/// Whether a state is an equilibrium of another mode, and admissible there up to rounding.
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

/// Whether an equilibrium is at the boundary of its mode for all parameters: its distance vanishes,
/// as do the derivatives of the distance with respect to all parameters.
pub(super) fn stays_at_boundary(system: &mut dyn System, x: &[f64], scale: f64) -> bool {
    let (mut distance, p) = ([0.0], x[system.names().dimension()..].to_vec());
    let known = system.monitors(x, 0, &mut distance).is_ok();
    if !known || distance[0].abs() >= VANISHES * scale {
        return false;
    }
    let still = |(rate, p): (&f64, &f64)| rate.abs() * p.abs().max(1.0) < VANISHES * scale;
    rates(system, x).is_some_and(|rates| rates.iter().zip(&p).all(still))
}

/// The error for a boundary equilibrium at which no branch emanates.
pub(super) fn no_neighbour(rest: &RestInMode) -> Failure {
    Failure::Undetermined(format!(
        "no other mode has an equilibrium at the boundary point that the equilibrium of mode `{}` \
         reaches",
        rest.name()
    ))
}

/// Returns the name of a boundary equilibrium, from the sides on which the two equilibria are
/// admissible.
///
/// The distances of the two equilibria vanish together, so their gradients with respect to the
/// parameters are parallel: the component of the largest magnitude decides.
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

/// Returns the rates of the distance of an equilibrium by each parameter; `None` where the
/// equilibrium does not depend smoothly on the parameters.
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

//! The section of a grazing point, and the coordinates on it.

use super::error::GrazingError;
use super::point::{GrazingPoint, Surface};
use crate::core::hybrid::{EventNumber, HybridEquations, Moment};
use crate::core::problem::Forcing;
use num_dual::Dual64;

/// A coordinate on the section.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Coordinate {
    /// A state of the grazed mode, given by its index.
    State(usize),
    /// The phase of the forcing.
    Phase,
}

/// The section `Π` of a grazing point; the coordinates on the section are the phase of the forcing
/// and all states of the mode except one.
///
/// One state, `eliminated`, contributes most to the rate of the guard and is computed from the
/// section's equation; another state, `normal`, contributes most to the guard itself and is
/// replaced by `y`.
#[derive(Clone, Debug)]
pub(super) struct Section {
    pub eliminated: usize,
    pub normal: usize,
    /// The derivatives `∂(h, dh/dt)/∂(normal, eliminated)` at the grazing point.
    pub slopes: [[f64; 2]; 2],
    /// The second derivative `d²h/dt²` of the guard along the motion.
    pub curvature: f64,
    pub coordinates: Vec<Coordinate>,
    /// The scales of the coordinates.
    pub scales: Vec<f64>,
}

/// Rounding: two gradients count as linearly dependent if the part of one gradient that is
/// orthogonal to the other has a smaller relative length than this: the section's coordinates then
/// lose nine digits.
const DEPENDENT: f64 = 1e-9;

/// Returns the index of the number with the largest modulus, excluding one index.
fn largest(numbers: &[f64], except: Option<usize>) -> Option<usize> {
    let positions = (0..numbers.len()).filter(|i| Some(*i) != except);
    positions.max_by(|a, b| numbers[*a].abs().total_cmp(&numbers[*b].abs()))
}

/// Computes the gradient, with respect to the states, of the function that vanishes on a surface.
fn gradient(surface: Surface, system: &dyn HybridEquations, point: &GrazingPoint) -> Vec<f64> {
    let p: Vec<Dual64> = point.p.iter().map(|p| Dual64::from(*p)).collect();
    let slope = |i: usize| {
        let mut x: Vec<Dual64> = point.x.iter().map(|x| Dual64::from(*x)).collect();
        x[i] = x[i].derivative();
        surface.value(Moment { system, mode: point.mode, t: point.time.into(), x: &x, p: &p }).eps
    };
    (0..point.x.len()).map(slope).collect()
}

/// Returns the time in which the phase of the forcing grows by 1; 1 without forcing.
pub(super) fn unit_of_phase<T: EventNumber>(system: &dyn HybridEquations, p: &[T]) -> T {
    match system.forcing() {
        Forcing::None => T::one(),
        Forcing::Periodic { phase } => system.period(p) / phase,
    }
}

impl Section {
    /// Computes the section of a grazing point; the phase is a coordinate if the system has a
    /// forcing.
    pub fn of(system: &dyn HybridEquations, point: &GrazingPoint) -> Result<Self, GrazingError> {
        let (guard, turning) = (Surface::Guard(point.guard), Surface::Turning(point.guard));
        let mut sizes = system.scales_of(point.mode, &point.p);
        sizes.resize(point.x.len(), 1.0);
        // The changes of the functions when each state changes by its scale.
        let [h, r] = [guard, turning].map(|surface| {
            let slopes = gradient(surface, system, point);
            slopes.iter().zip(&sizes).map(|(slope, size)| slope * size).collect::<Vec<f64>>()
        });
        let dependent = |pivot: f64| GrazingError::NoSection {
            guard: system.guards()[point.guard].name.clone(),
            mode: system.modes()[point.mode].name.clone(),
            pivot,
        };
        let eliminated = largest(&r, None).filter(|k| r[*k] != 0.0).ok_or(dependent(0.0))?;
        let share = h[eliminated] / r[eliminated];
        let left: Vec<f64> = h.iter().zip(&r).map(|(h, r)| h - share * r).collect();
        let normal = largest(&left, Some(eliminated)).ok_or(dependent(0.0))?;
        let size = h.iter().fold(f64::MIN_POSITIVE, |most, h| h.abs().max(most));
        if left[normal].abs() / size < DEPENDENT {
            return Err(dependent(left[normal].abs() / size));
        }
        let curvature = turning.moving(point.moment(system)).eps;
        if curvature.is_nan() || curvature <= 0.0 {
            let (guard, time) = (system.guards()[point.guard].name.clone(), point.time);
            return Err(GrazingError::Curvature { guard, time, curvature });
        }
        let states = (0..point.x.len()).filter(|i| *i != eliminated).map(Coordinate::State);
        let phase = system.forcing().is_periodic().then_some(Coordinate::Phase);
        let slope = |k: usize| [h[k] / sizes[k], r[k] / sizes[k]];
        let ([a, c], [b, d]) = (slope(normal), slope(eliminated));
        let (slopes, coordinates) = ([[a, b], [c, d]], states.chain(phase).collect::<Vec<_>>());
        let scale = |coordinate: &Coordinate| match coordinate {
            Coordinate::State(i) => sizes[*i],
            Coordinate::Phase => 1.0,
        };
        let scales = coordinates.iter().map(scale).collect();
        Ok(Section { eliminated, normal, slopes, curvature, coordinates, scales })
    }

    /// Returns the index, among the coordinates, of the state that `y` replaces.
    pub fn normal_coordinate(&self) -> usize {
        self.coordinates.iter().position(|c| *c == Coordinate::State(self.normal)).unwrap_or(0)
    }
}

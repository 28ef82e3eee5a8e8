//! Location of grazing orbits by Newton's method on the linear local map.

use super::chart::{MapSettings, Source};
use super::error::GrazingError;
use super::point::GrazingPoint;
use super::section::{Coordinate, Section, unit_of_phase};
use crate::core::hybrid::{HybridEquations, guard_scale};
use crate::core::linalg::{solved, unit};
use crate::core::problem::position;
use crate::core::scalar::Polynomial;

/// Heuristic: the maximal number of Newton iterations for a grazing orbit.
const ITERATIONS: usize = 12;
/// Discretisation: the largest distance, in units of the scales, by which an orbit may miss its
/// starting point after one turn if Newton's method has converged: a hundred times the tolerance of
/// the flow.
const DONE: f64 = 1e-11;

impl GrazingPoint {
    /// Computes the nearest grazing point to which the orbit returns, by Newton's method on the
    /// linear local map; the named parameter is free. After one turn, the orbit that is found
    /// misses its starting point by at most 1e-11, in units of the scales.
    ///
    /// ```
    /// use tangency::core::local_map::GrazingPoint;
    /// use tangency::core::orbit::Leg;
    /// use tangency::problems::mita::Actuator;
    /// // From six digits at ω = 0.5; the orbit starts at the grazing point.
    /// let mut p = Actuator::DEFAULTS;
    /// p[0] = 0.227178;
    /// let rough = GrazingPoint {
    ///     guard: Actuator::FRONT,
    ///     mode: Actuator::STICK,
    ///     time: 5.98551 / 0.5,
    ///     x: vec![0.5, 0.0],
    ///     p: p.to_vec(),
    ///     following: Vec::new(),
    ///     legs: vec![(Leg::new(Actuator::STICK, None), std::f64::consts::PI / 0.5)],
    ///     periods: 1,
    /// };
    /// let point = rough.located(&Actuator, "voltage")?;
    /// assert!((point.p[0] - 0.2271775831).abs() < 1e-10);
    /// assert!((0.5 * point.time - 5.985512558).abs() < 1e-9);
    /// # Ok::<(), tangency::core::local_map::GrazingError>(())
    /// ```
    ///
    /// # Errors
    /// [`GrazingError`] if the linear map cannot be computed;
    /// [`NotLocated`](GrazingError::NotLocated) if Newton's method does not converge.
    pub fn located(
        &self,
        system: &dyn HybridEquations,
        parameter: &str,
    ) -> Result<Self, GrazingError> {
        self.check(system)?;
        let free = position("parameter", parameter, &system.parameters())?;
        let mut point = self.clone();
        let mut residual = f64::INFINITY;
        for _ in 0..ITERATIONS {
            residual = point.correct(system, free)?;
            if residual < DONE {
                return Ok(point);
            }
        }
        let parameter = parameter.to_string();
        Err(GrazingError::NotLocated { parameter, iterations: ITERATIONS, residual })
    }

    /// Makes one Newton iteration for `P_smooth(ξ, p) = ξ` and `h(ξ, p) = 0`, and returns the
    /// residuals of the two equations.
    fn correct(&mut self, system: &dyn HybridEquations, free: usize) -> Result<f64, GrazingError> {
        let settings = MapSettings { order: 1, ..MapSettings::default() };
        let section = &Section::of(system, self)?;
        let source =
            Source { system, point: self, section, parameters: &[free], settings: &settings };
        let smooth = source.smooth()?;
        let n = section.coordinates.len();
        let rows: Vec<&Polynomial> = smooth.images.iter().chain([&smooth.penetration]).collect();
        let missed: Vec<f64> = rows.iter().map(|row| -row.coefficients()[0]).collect();
        let depth = guard_scale(system, (self.guard, self.mode), (self.time, &self.x), &self.p);
        let sizes = section.scales.iter().chain([&depth]);
        let parts = missed.iter().zip(sizes).map(|(missed, size)| missed.abs() / size);
        let residual = parts.fold(0.0, f64::max);
        let entry = |i: usize, j: usize| {
            rows[i].coefficients()[1 + j] - if i < n { unit(i, j) } else { 0.0 }
        };
        let change = solved(n + 1, entry, |i| missed[i])?;
        let before = unit_of_phase(system, &self.p);
        self.p[free] += change[n];
        let after = unit_of_phase(system, &self.p);
        self.time *= after / before;
        for (coordinate, change) in section.coordinates.iter().zip(change) {
            match coordinate {
                Coordinate::State(i) => self.x[*i] += change,
                Coordinate::Phase => self.time += change * after,
            }
        }
        let k = section.eliminated;
        for _ in 0..ITERATIONS {
            let rate = self.moment(system).rate(self.guard);
            self.x[k] -= rate / section.slopes[1][1];
        }
        Ok(residual)
    }
}

//! The motion near a grazing point, computed with jets.

use super::error::GrazingError;
use super::point::{GrazingPoint, Surface};
use super::section::{Coordinate, Section, unit_of_phase};
use crate::core::cancel::CancelToken;
use crate::core::hybrid::{
    EventNumber, FieldNumber, GuardNumber, HybridEquations, Moment, time_scale,
};
use crate::core::ode::{Flow, Scheme, Settings};
use crate::core::problem::Forcing;
use crate::core::scalar::{Jet, Scalar, Space};
use num_dual::Dual;

/// The order and accuracy of a local map.
#[derive(Clone, Debug, PartialEq)]
pub struct MapSettings {
    /// The order of the polynomials, from 1 to 7.
    pub order: usize,
    /// The tolerance of the flow over one turn, for all Taylor coefficients, relative to the
    /// largest coefficient.
    pub tolerance: f64,
    /// A token that cancels the computation of a map.
    pub cancel: CancelToken,
}

impl Default for MapSettings {
    /// The default settings: order 2, and a tolerance of 1e-13.
    fn default() -> Self {
        MapSettings { order: 2, tolerance: 1e-13, cancel: CancelToken::default() }
    }
}

/// The input of a local map: the system, a grazing point with its section, and the indices of the
/// parameters that vary.
#[derive(Clone, Copy)]
pub(super) struct Source<'a> {
    pub system: &'a dyn HybridEquations,
    pub point: &'a GrazingPoint,
    pub section: &'a Section,
    pub parameters: &'a [usize],
    pub settings: &'a MapSettings,
}

impl Source<'_> {
    /// Returns the space of the polynomials of the local map; the variables of the polynomials are
    /// the coordinates followed by the parameters.
    pub fn space(&self, order: usize) -> Result<&'static Space, GrazingError> {
        Ok(Space::of(self.section.coordinates.len() + self.parameters.len(), order)?)
    }
}

/// A mode, a time and a state of a motion.
#[derive(Clone, Debug)]
pub(super) struct Place<T> {
    pub mode: usize,
    pub t: T,
    pub x: Vec<T>,
}

/// Heuristic: the maximal number of Newton iterations. Each iteration doubles both the number of
/// correct digits of the real part and the degree up to which the Taylor series is correct. Four
/// iterations give 16 correct digits, and three more iterations give correct coefficients up to the
/// highest degree; the remaining iterations allow for a poor initial guess.
const ROUNDS: usize = 12;
/// Rounding: a Newton step counts as a rounding error if its size, relative to the largest step, is
/// below this value, which is about 50 ε.
const ROUNDING: f64 = 1e-14;
/// Heuristic: a surface counts as reached if the size of the last Newton step, relative to the largest
/// step, is below this value: Newton's method converges quadratically, so that the next step would be a
/// rounding error.
pub(super) const REACHED: f64 = 1e-6;

/// Coordinates on the section of a grazing point, and the parameters as jets; the chart computes
/// points on the section and the motion from these points.
pub(super) struct Chart<'a, const C: usize> {
    pub source: Source<'a>,
    /// The deviations of the coordinates from the grazing point, as independent variables of the
    /// jets.
    pub deviations: Vec<Jet<C>>,
    p: Vec<Jet<C>>,
    /// The time in which the phase grows by 1: the forcing period `T(p)` divided by the phase of a
    /// period.
    unit: Jet<C>,
    /// The time scale.
    pub scale: f64,
    /// The phase of the grazing point.
    phase: f64,
    /// The phase of a whole period of the forcing.
    cycle: f64,
    states: Vec<usize>,
    /// The integrator for long times, with step control by all Taylor coefficients.
    long: Flow<Jet<C>>,
    /// The integrator for times whose real part is nearly zero, which takes one step.
    short: Flow<Jet<C>>,
}

impl<'a, const C: usize> Chart<'a, C>
where
    Jet<C>: EventNumber,
    Dual<Jet<C>>: FieldNumber + GuardNumber,
    Dual<Dual<Jet<C>>>: GuardNumber,
{
    pub fn of(source: Source<'a>, space: &'static Space) -> Result<Self, GrazingError> {
        let Source { system, point, section, parameters, settings } = source;
        let count = section.coordinates.len();
        let mut p: Vec<Jet<C>> = point.p.iter().map(|p| Jet::from(*p)).collect();
        for (k, parameter) in parameters.iter().enumerate() {
            p[*parameter] = Jet::variable(space, count + k, point.p[*parameter])?;
        }
        // The deviations are in units of their scales, so that terms of all orders have a similar
        // size.
        let deviation = |k: usize| Ok(Jet::variable(space, k, 0.0)? * section.scales[k]);
        let deviations: Vec<_> = (0..count).map(deviation).collect::<Result<_, GrazingError>>()?;
        let usual = Settings::new(Scheme::DormandPrince8, settings.tolerance);
        let long = Settings { cancel: settings.cancel.clone(), ..usual };
        let short = Settings { first_step: Some(1.0), ..long.clone() };
        let cycle = match system.forcing() {
            Forcing::None => 0.0,
            Forcing::Periodic { phase } => phase,
        };
        let unit = unit_of_phase(system, &p);
        let phase = point.time / unit.real();
        let states = system.modes().iter().map(|mode| mode.states.len()).collect();
        let (long, short) = (Flow::new(long)?.measured_by(Jet::size), Flow::new(short)?);
        let scale = time_scale(system, &point.p);
        Ok(Chart { source, deviations, p, unit, scale, phase, cycle, states, long, short })
    }

    /// Returns the point whose coordinates deviate by the given amounts from the grazing point; the
    /// point need not lie on the section.
    fn place(&self, deviations: &[Jet<C>]) -> Place<Jet<C>> {
        let Source { point, section, .. } = self.source;
        let x = point.x.iter().map(|x| Jet::from(*x)).collect();
        let mut place = Place { mode: point.mode, t: point.time.into(), x };
        for (coordinate, deviation) in section.coordinates.iter().zip(deviations) {
            match coordinate {
                Coordinate::State(i) => place.x[*i] += *deviation,
                Coordinate::Phase => place.t = (*deviation + self.phase) * self.unit,
            }
        }
        place
    }

    /// Returns a [`Moment`] with the mode, the time and the state in `place`, and with the system
    /// and the parameters of the chart.
    pub fn at<'m>(&'m self, Place { mode, t, x }: &'m Place<Jet<C>>) -> Moment<'m, Jet<C>> {
        Moment { system: self.source.system, mode: *mode, t: *t, x, p: &self.p }
    }

    /// Returns the point on the section whose coordinates deviate by the given amounts from the
    /// grazing point.
    pub fn on_section(&self, deviations: &[Jet<C>]) -> Place<Jet<C>> {
        let (mut place, section) = (self.place(deviations), self.source.section);
        let slope = section.slopes[1][1];
        for _ in 0..ROUNDS {
            let turning = Surface::Turning(self.source.point.guard).value(self.at(&place));
            place.x[section.eliminated] -= turning / slope;
            if turning.size() == 0.0 {
                break;
            }
        }
        place
    }

    /// Returns the point on the section with a given value of the guard and given deviations of the
    /// other coordinates.
    pub fn at_depth(&self, deviations: &[Jet<C>], guard: Jet<C>) -> Place<Jet<C>> {
        let mut place = self.place(deviations);
        let Source { point, section, .. } = self.source;
        let [[a, b], [c, d]] = section.slopes;
        let determinant = a * d - b * c;
        for _ in 0..ROUNDS {
            let h = Surface::Guard(point.guard).value(self.at(&place)) - guard;
            let r = Surface::Turning(point.guard).value(self.at(&place));
            place.x[section.normal] -= (h * d - r * b) / determinant;
            place.x[section.eliminated] -= (r * a - h * c) / determinant;
            if h.size() == 0.0 && r.size() == 0.0 {
                break;
            }
        }
        place
    }

    /// Returns the deviations of a point's coordinates from the coordinates that the grazing point
    /// has after `periods` forcing periods.
    pub fn deviations_of(&self, place: &Place<Jet<C>>, periods: usize) -> Vec<Jet<C>> {
        let deviation = |coordinate: &Coordinate| match coordinate {
            Coordinate::State(i) => place.x[*i] - self.source.point.x[*i],
            Coordinate::Phase => place.t / self.unit - (self.phase + self.cycle * periods as f64),
        };
        self.source.section.coordinates.iter().map(deviation).collect()
    }

    /// Advances a point along the motion by a time; `long` selects the integrator for times whose
    /// real part is not nearly zero.
    pub fn advance(
        &mut self,
        place: &mut Place<Jet<C>>,
        duration: Jet<C>,
        long: bool,
    ) -> Result<(), GrazingError> {
        let (system, mode) = (self.source.system, place.mode);
        let flow = if long { &mut self.long } else { &mut self.short };
        let field = Jet::in_mode(system, mode, Jet::from(0.0));
        flow.advance(&field, place.t, duration, &mut place.x, &self.p).map_err(|source| {
            GrazingError::Flow { mode: system.modes()[mode].name.clone(), source }
        })?;
        place.t += duration;
        Ok(())
    }

    /// Moves a point near a surface onto the surface along the motion; Newton's method determines
    /// the time.
    pub fn land(
        &mut self,
        place: &mut Place<Jet<C>>,
        surface: Surface,
    ) -> Result<(), GrazingError> {
        let (mut largest, mut last) = (f64::MIN_POSITIVE, 0.0);
        for _ in 0..ROUNDS {
            let moving = surface.moving(self.at(place));
            let step = -moving.re / moving.eps;
            self.advance(place, step, false)?;
            last = step.size();
            largest = last.max(largest);
            if last <= ROUNDING * largest {
                break;
            }
        }
        if last <= REACHED * largest.max(self.scale) {
            return Ok(());
        }
        Err(GrazingError::NotReached {
            mode: self.source.system.modes()[place.mode].name.clone(),
            surface: surface.name(self.source.system),
            time: place.t.real(),
            step: last,
        })
    }

    /// Applies the event of a guard to a point, which then lies in the mode `next`.
    pub fn pass(&self, place: &mut Place<Jet<C>>, guard: usize, next: usize) {
        let mut after = vec![Jet::from(0.0); self.states[next]];
        self.source.system.reset(guard, (place.mode, next), place.t, &place.x, &self.p, &mut after);
        (place.mode, place.x) = (next, after);
    }
}

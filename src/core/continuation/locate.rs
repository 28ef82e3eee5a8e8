//! Locating events in an interval: Newton's iteration on the defining system, in a bracket that is
//! halved on the branch until it converges.

use super::bracket::Bracket;
use super::defining_system::solve;
use super::describe::describe;
use super::event::Event;
use super::limit::limit;
use super::located::Located;
use super::locator::Locator;
use super::metric::ScaledNorm;
use super::newton::NewtonError;
use crate::core::failure::Failure;

/// (H) An event is not farther beside the branch, in units of its bracket's length: on steps within
/// `max_angle` the curve stays within a tenth.
const MOST_BESIDE: f64 = 0.5;

/// (R) The number of halvings after which a bracket is as short as rounding.
const MOST_HALVINGS: usize = 40;

impl Locator<'_, '_> {
    /// Locates the event at this position among those of the curve. `None` if the change of sign
    /// was not this event after all, but several others.
    ///
    /// # Errors
    /// [`Failure`] if the defining system does not apply there, or values cannot be recorded.
    pub fn locate(&mut self, index: usize) -> Result<Option<Located>, Failure> {
        let event = self.curve.detector.events[index].clone();
        let mut bracket = Bracket::new(&mut self.curve.corrector, self.interval, (index, &event));
        let located = if event.mirror {
            limit(self, &event).unwrap_or_else(|| self.middle((event.kind, &event.name)))
        } else if event.condition.is_none() {
            self.bisect(&event, &mut bracket)
        } else {
            match self.solve(&event, &mut bracket) {
                Ok(located) => located,
                Err(Failure::NoComplexPair) => return Ok(None),
                Err(cause) => return Err(cause),
            }
        };
        if bracket.is_empty {
            return Ok(None);
        }
        describe(self.curve, index, self.interval, located).map(Some)
    }

    /// The solution of an event's defining system in a bracket, which is halved until Newton's
    /// iteration converges to a point in it; the middle of the last bracket, as a point that has
    /// not converged, if it never does.
    ///
    /// # Errors
    /// [`Failure::NoComplexPair`] and [`Failure::Unsupported`] where the system does not apply.
    fn solve(&mut self, event: &Event, bracket: &mut Bracket) -> Result<Located, Failure> {
        // Signs of test functions come from a matrix that differs slightly from the point's own.
        let slack = 1e-4 * (bracket.high - bracket.low);
        let parameter = self.curve.corrector.equations.parameters_at();
        let mut inapplicable = None;
        for _ in 0..MOST_HALVINGS {
            let guess = bracket.guess(&*event.test, parameter);
            let at = (&self.row[..], &self.interval.from.unknowns[..]);
            match solve(&mut self.curve.corrector, event, guess, at) {
                Ok(located) => {
                    let Located { along, unknowns, .. } = &located;
                    let inside = (bracket.low - slack..=bracket.high + slack).contains(along);
                    let near = is_near(&self.curve.corrector.norm, bracket, *along, unknowns);
                    if inside && near && self.is_confirmed(event, bracket, &located) {
                        return Ok(located);
                    }
                }
                Err(NewtonError::Evaluation {
                    cause: cause @ (Failure::NoComplexPair | Failure::Unsupported(_)),
                    ..
                }) => inapplicable = Some(cause),
                Err(_) => {}
            }
            let middle = 0.5 * (bracket.low + bracket.high);
            if !self.narrow(event, bracket, middle) {
                break;
            }
        }
        if let Some(cause) = inapplicable {
            return Err(cause);
        }
        let unknowns = bracket.between(0.5);
        let reach = bracket.at_ends(parameter).map(|end| (end - unknowns[parameter]).abs());
        let error = reach.into_iter().fold(self.curve.corrector.parameter_error(), f64::max);
        // Where the mesh hides the event, it shifts the point as well.
        let error = error + self.curve.corrector.mesh_share(&unknowns);
        let along = 0.5 * (bracket.low + bracket.high);
        Ok(Located::new((event.kind, &event.name), along, unknowns, error).converged(false))
    }

    /// Whether a solution of an event's defining system is that event.
    fn is_confirmed(&mut self, event: &Event, bracket: &Bracket, located: &Located) -> bool {
        let dynamics = self.curve.corrector.equations.system().dynamics();
        let spectra = [0, 1].map(|end| bracket.ends[end].spectrum.as_deref().unwrap_or_default());
        let first = located.special.numbers.first();
        first.is_none_or(|(_, unknown)| event.test.confirms(*unknown, spectra, dynamics))
    }
}

/// Whether a solution of a defining system lies near the branch between the ends of a bracket, and
/// not only between the hyperplanes through them.
fn is_near(norm: &ScaledNorm, bracket: &Bracket, along: f64, unknowns: &[f64]) -> bool {
    let length = bracket.high - bracket.low;
    let fraction = ((along - bracket.low) / length).clamp(0.0, 1.0);
    norm.distance(unknowns, &bracket.between(fraction)) <= MOST_BESIDE * length
}

//! Location of events in an interval: Newton's method on the defining system, in a bracket that is
//! bisected on the branch until the method converges.

use super::bracket::Bracket;
use super::corrector::Corrector;
use super::defining_system::solve;
use super::describe::describe;
use super::event::Event;
use super::limit::limit;
use super::located::Located;
use super::locator::Locator;
use super::meaning::Meaning;
use super::metric::ScaledNorm;
use super::newton::NewtonError;
use crate::core::bifurcation::Critical;
use crate::core::failure::Failure;
use crate::core::system::{HOMOCLINIC_TESTS, Kind};

/// Heuristic: the largest distance of a located event from the interpolated branch, in units of the
/// length of its bracket. In steps that turn by less than `LARGEST_ANGLE`, the distance of the
/// curve from the interpolated branch is less than 0.1, in units of the length of the bracket.
const MOST_BESIDE: f64 = 0.5;

/// Heuristic: a solution of a defining system lies on the curve if a correction to the curve moves
/// the solution by less than this fraction of the length of its bracket.
const BESIDE_CURVE: f64 = 1e-3;

/// Heuristic: a solution of a defining system lies on the curve of special points if the solution is
/// closer to the point of the curve in the same hyperplane than this fraction of the length of its
/// bracket. The fraction is small, because symmetric systems have curves that nearly coincide.
const SAME_CURVE: f64 = 1e-6;

/// Heuristic: the distance on both sides of a branch point, as a fraction of the bracket, at which
/// the sign change of its test function is checked.
const BESIDE_POINT: f64 = 0.02;

/// Heuristic: the positions at which a bracket is divided, in units of its length: first the
/// middle, and two other positions if the curve cannot be corrected at the middle. For events with
/// critical eigenvalues, only the middle is tried, since the curve may be singular at the event.
const CUTS: [f64; 3] = [0.5, 0.37, 0.71];

/// Rounding: a solution that lies outside a bracket by less than this fraction of the length of the
/// bracket counts as inside.
const BEYOND: f64 = 1e-9;

/// Heuristic: a test function jumps, and has no zero, if its values at the ends of a bracket whose
/// length is of the size of rounding errors are larger than this fraction of its values at the ends
/// of the step. The share of the leading direction in a homoclinic orbit jumps where two leading
/// eigenvalues coincide.
const JUMP: f64 = 0.1;

/// Rounding: the number of bisections after which the length of a bracket is of the size of
/// rounding errors.
const MOST_HALVINGS: usize = 40;

impl Locator<'_, '_> {
    /// Locates the event with the index `index` among the events of the curve. Returns `None` if
    /// the sign change of the event's test function was caused by several other events.
    ///
    /// # Errors
    /// [`Failure`] if the defining system does not apply to the solutions in the interval, or if a
    /// point cannot be recorded.
    pub fn locate(&mut self, index: usize) -> Result<Option<Located>, Failure> {
        let event = self.curve.detector.events[index].clone();
        let mut bracket = Bracket::new(&mut self.curve.corrector, self.interval, (index, &event));
        let least = |tests: [f64; 2]| tests[0].abs().min(tests[1].abs());
        let before = least(bracket.tests);
        let located = if event.mirror {
            limit(self, &event).unwrap_or_else(|| self.middle((event.kind, &event.name)))
        } else if event.condition.is_none() {
            let mut located = self.bisect(&event, &mut bracket);
            if event.test.has_poles() && least(bracket.tests) > before {
                return Ok(None);
            }
            let Corrector { equations, tolerances, .. } = &mut self.curve.corrector;
            let reach = tolerances.tolerance.max(bracket.high - bracket.low);
            let beside = [&located.unknowns, &bracket.ends[0].tangent];
            let beside: Vec<f64> =
                beside[0].iter().zip(beside[1]).map(|(x, t)| x + reach * t).collect();
            Meaning::beside(equations, &event, [&located.unknowns, &beside])
                .give_to(&mut located.special);
            located
        } else {
            let may_jump = HOMOCLINIC_TESTS.iter().any(|(_, kind)| *kind == event.kind);
            match self.solve(&event, &mut bracket) {
                Ok(located)
                    if may_jump
                        && !located.special.converged
                        && least(bracket.tests) > JUMP * before =>
                {
                    return Ok(None);
                }
                Ok(located) => located,
                Err(Failure::NoComplexPair) => return Ok(None),
                Err(cause) => return Err(cause),
            }
        };
        if bracket.is_empty {
            return Ok(None);
        }
        // Two real eigenvalues that vanish together solve the equations of a pair.
        if event.condition.is_some() && self.is_still(&located) {
            return Ok(None);
        }
        describe(self.curve, index, self.interval, located).map(Some)
    }

    /// Solves the defining system of an event in a bracket, which is bisected until Newton's method
    /// converges to a point inside the bracket. If Newton's method does not converge in any
    /// bracket, returns the middle of the last bracket as an unconverged point.
    ///
    /// # Errors
    /// [`Failure::NoComplexPair`] and [`Failure::Unsupported`] if the defining system does not
    /// apply to the solutions in the bracket.
    fn solve(&mut self, event: &Event, bracket: &mut Bracket) -> Result<Located, Failure> {
        // Signs of test functions come from a matrix that differs slightly from the point's own.
        let slack = 1e-4 * (bracket.high - bracket.low);
        let parameter = self.curve.corrector.equations.parameters_at();
        let (mut inapplicable, mut outside) = (None, None);
        for _ in 0..MOST_HALVINGS {
            match self.solution_in(event, bracket, slack) {
                Ok(Some((beyond, located))) if beyond <= BEYOND * (bracket.high - bracket.low) => {
                    return Ok(located);
                }
                // The bracket may contain another event of the same kind: halve it first.
                Ok(Some(other)) => _ = outside.get_or_insert(other),
                Ok(None) => {}
                Err(cause) => inapplicable = Some(cause),
            }
            let (low, high) = (bracket.low, bracket.high);
            if outside.as_ref().is_some_and(|(beyond, _)| high - low < *beyond) {
                break;
            }
            let cuts = if event.critical == Critical::None { &CUTS[..] } else { &CUTS[..1] };
            let mut cuts = cuts.iter().map(|share| low + share * (high - low));
            if !cuts.any(|along| !bracket.is_empty && self.narrow(event, bracket, along)) {
                break;
            }
        }
        if let Some((_, located)) = outside {
            return Ok(located);
        }
        if let Some(cause) = inapplicable {
            return Err(cause);
        }
        let unknowns = bracket.between(0.5);
        let reach = bracket.at_ends(parameter).map(|end| (end - unknowns[parameter]).abs());
        let error = reach.into_iter().fold(self.curve.corrector.parameter_error(), f64::max);
        // If the mesh hides the event, it also shifts the point.
        let error = error + self.curve.corrector.mesh_share(&unknowns);
        let along = 0.5 * (bracket.low + bracket.high);
        Ok(Located::new((event.kind, &event.name), along, unknowns, error).converged(false))
    }

    /// Returns the solution to which Newton's method converges from the bracket, and the distance of
    /// the solution from the bracket; `None` if Newton's method fails, or if the solution is not the
    /// event. The distance is at most `slack`.
    ///
    /// # Errors
    /// [`Failure::NoComplexPair`] and [`Failure::Unsupported`], as [`solve`](Self::solve).
    fn solution_in(
        &mut self,
        event: &Event,
        bracket: &Bracket,
        slack: f64,
    ) -> Result<Option<(f64, Located)>, Failure> {
        let parameter = self.curve.corrector.equations.parameters_at();
        let guess = bracket.guess(&*event.test, parameter);
        let at = (&self.row[..], &self.interval.from.unknowns[..]);
        let located = match solve(&mut self.curve.corrector, event, guess, at) {
            Ok(located) => located,
            Err(NewtonError::Evaluation {
                cause: cause @ (Failure::NoComplexPair | Failure::Unsupported(_)),
                ..
            }) => return Err(cause),
            Err(_) => return Ok(None),
        };
        let Located { along, unknowns, .. } = &located;
        let beyond = (bracket.low - along).max(along - bracket.high);
        let near = is_near(&self.curve.corrector.norm, bracket, *along, unknowns);
        let is_event = beyond <= slack
            && near
            && self.is_on_curve(event, bracket, &located)
            && self.is_confirmed(event, bracket, &located);
        Ok(is_event.then_some((beyond, located)))
    }

    /// Whether a solution of the defining system of an event lies on the curve. At a point with
    /// several critical eigenvalues, the defining system of a single critical eigenvalue or pair is
    /// singular, and nearby points that are not on the curve also satisfy it. The defining systems
    /// of events without critical eigenvalues are regular, and their solutions on branches of
    /// solutions are accepted. A solution on a curve of special points is compared with the point of
    /// the curve in the same hyperplane, because the solution may lie on another curve of the same kind.
    fn is_on_curve(&mut self, event: &Event, bracket: &Bracket, located: &Located) -> bool {
        if event.instead.is_some() || event.test.level().is_some() {
            return true;
        }
        let Located { along, unknowns, .. } = located;
        if !self.curve.recorder.solutions {
            let guess = self.interval.cubic(&self.row, *along);
            let Ok((corrected, _)) = self.corrected(guess, *along) else { return true };
            return self.is_close(&corrected, unknowns, SAME_CURVE * (bracket.high - bracket.low));
        }
        if event.critical == Critical::None {
            return true;
        }
        // At a branch point the equations of the curve are singular themselves.
        if event.kind == Kind::BP {
            return self.turns_at(bracket, *along);
        }
        let Ok((corrected, _)) = self.corrected(unknowns.clone(), *along) else { return false };
        self.is_close(&corrected, unknowns, BESIDE_CURVE * (bracket.high - bracket.low))
    }

    /// Whether two points are closer than a distance, or than Newton's method can distinguish.
    fn is_close(&self, a: &[f64], b: &[f64], distance: f64) -> bool {
        let Corrector { norm, tolerances, .. } = &self.curve.corrector;
        norm.distance(a, b) <= distance.max(1e3 * tolerances.tolerance)
    }

    /// Whether the test function of an event changes sign near a position in a bracket. The sign is
    /// checked because between two close branch points the defining system is nearly singular, and
    /// Newton's method may appear to converge to a point that is not a branch point. On a mesh, the
    /// sign is not checked, because a mesh may separate branches that would cross.
    fn turns_at(&mut self, bracket: &Bracket, along: f64) -> bool {
        let system = self.curve.corrector.equations.system();
        if system.representation().is_on_mesh() {
            return true;
        }
        let reach = BESIDE_POINT * (bracket.high - bracket.low);
        let values = self.values_beside(bracket.index, along, reach);
        values.is_none_or(|[before, after]| before * after <= 0.0)
    }

    /// Whether a solution of an event's defining system is the event itself, and not an event of
    /// another kind that satisfies the same equations.
    fn is_confirmed(&mut self, event: &Event, bracket: &Bracket, located: &Located) -> bool {
        let dynamics = self.curve.corrector.equations.system().dynamics();
        let spectra = [0, 1].map(|end| bracket.ends[end].spectrum.as_deref().unwrap_or_default());
        let first = located.special.numbers.first();
        first.is_none_or(|number| event.test.confirms(number.value, spectra, dynamics))
            && !(event.critical == Critical::Pair && self.is_still(located))
    }

    /// Whether the frequency or angle of a critical pair is zero up to rounding: a double real
    /// eigenvalue, as symmetric systems have, solves the equations of a Hopf point, and rounding
    /// turns the eigenvalue into a pair with a tiny imaginary part.
    fn is_still(&self, located: &Located) -> bool {
        let special = &located.special;
        let frequency = special.number("hopf_frequency").or_else(|| special.number("torus_angle"));
        let Some(frequency) = frequency else { return false };
        let ends = [self.interval.from, self.interval.to];
        let spectra = ends.map(|place| place.spectrum.as_deref().unwrap_or_default());
        let sizes =
            spectra.into_iter().flatten().map(|l| l.0.hypot(l.1)).filter(|size| *size > 0.0);
        let least = sizes.reduce(f64::min).unwrap_or(0.0);
        frequency.value.abs() <= frequency.error.max(STILL * least)
    }
}

/// Rounding: a frequency is zero up to rounding if it is smaller than this fraction of the smallest
/// eigenvalue at the ends of the step.
const STILL: f64 = 1e-9;

/// Whether a solution of a defining system lies close to the branch between the ends of a bracket,
/// and not only between the hyperplanes through the two ends.
fn is_near(norm: &ScaledNorm, bracket: &Bracket, along: f64, unknowns: &[f64]) -> bool {
    let length = bracket.high - bracket.low;
    let fraction = ((along - bracket.low) / length).clamp(0.0, 1.0);
    norm.distance(unknowns, &bracket.between(fraction)) <= MOST_BESIDE * length
}

//! Steps along a curve: predict along the tangent, correct on the hyperplane across it, adapt.

use super::event::{Event, MakeCondition, Tested};
use super::metric::Metric;
use super::{Point, Settings};
use crate::core::condition::{At, Failure, Quantity};
use crate::core::extended::{Closing, Extended};
use crate::core::function::{Attached, TestPoint};
use crate::core::motion::{Stability, deciding};
use crate::core::newton::{Convergence, Newton, NewtonError, ROUGHLY, scaled_norm};
use crate::core::vector::{advanced, difference, dot};
use crate::core::zero::Spectrum;

/// A point of the curve with everything that the next step, and the events, need of it.
#[derive(Clone)]
pub(super) struct Place {
    pub unknowns: Vec<f64>,
    /// The tangent, of scaled length 1.
    pub tangent: Vec<f64>,
    /// Values of the events' test functions; `None` where nothing is known of one.
    pub tests: Vec<Option<f64>>,
    pub point: Point,
    /// All eigenvalues or multipliers, where they are known.
    pub spectrum: Option<Spectrum>,
    /// The arclength from here on in which no branch point lies, where eigenvalues are not known.
    pub quiet: f64,
}

/// The branch points in a step.
#[derive(Clone, Copy, Default)]
pub(super) struct Crossings {
    /// Their number, as far as a linear change of the matrix tells.
    pub count: usize,
    /// Whether the end of the step is a branch point itself, but for rounding.
    pub singular: bool,
    /// The arclength beyond the step in which there is none.
    pub quiet: f64,
}

/// A branch point that a curve leaves, along a tangent that is not that of the branch which leads
/// to it.
pub(super) struct Departure {
    pub unknowns: Vec<f64>,
    /// Of scaled length 1, both.
    pub tangent: Vec<f64>,
    pub parent: Vec<f64>,
}

/// The curve, the scales on it, and the events looked for.
pub(super) struct Stepper<'a> {
    pub equations: Extended<'a>,
    pub newton: Newton,
    pub settings: Settings,
    pub metric: Metric,
    pub weights: Vec<f64>,
    pub events: Vec<Event>,
    /// Makers of the conditions held along the curve.
    pub held: Vec<MakeCondition>,
    /// Conditions whose values are test functions, one for each event that needs it.
    pub tested: Vec<Option<Tested>>,
    /// Monitors that the user has attached.
    pub attached: Vec<Attached>,
    /// The columns of points that settle at special points, beside the released parameters.
    pub settled: Vec<usize>,
    /// The branch point that the curve leaves, if it starts at one.
    pub departure: Option<Departure>,
}

/// Shorter steps than this may be as long as the error with which a solution is carried over to a
/// new mesh.
const MESH: f64 = 1e-3;

/// A corrected point is not farther from the predicted one, in units of the step.
pub(super) const MOST_DISTANT: f64 = 0.25;

/// A monitor vanishes at a start if it is smaller: a saved grazing is exact to rounding.
pub(super) const VANISHES: f64 = 1e-6;

/// A solution passes a surface if it is farther beyond, in units of the surface's scale: less is
/// rounding.
const BEYOND: f64 = 1e-9;

/// Events nearer to the start than this, in scaled arclength, are those of the start itself.
pub(super) const AT_START: f64 = 1e-6;

/// A matrix that is known this well, relatively, is good enough for the tangent and for stability.
pub(super) const MATRIX_ERROR: f64 = 1e-4;

/// The sign of a tangent's component along the parameter that is smaller than this is not left to a
/// matrix that is only nearly known.
const UNCERTAIN: f64 = 0.05;

/// A place before a step's, for the predictor and for pairs of events.
pub(super) struct Before {
    pub place: Place,
    /// The length of the step from it.
    pub length: f64,
}

/// How a step went.
pub(super) struct Step {
    pub place: Place,
    /// The length of the step.
    pub length: f64,
    /// The length proposed for the next step.
    pub next: f64,
    /// The branch points passed, where eigenvalues do not tell.
    pub crossings: Crossings,
}

impl Stepper<'_> {
    /// The covector of a direction: `rowᵢ = wᵢ tᵢ`.
    pub fn covector(&self, direction: &[f64]) -> Vec<f64> {
        direction.iter().zip(&self.weights).map(|(t, w)| t * w).collect()
    }

    /// The same place, seen in the other direction.
    pub fn turn(&self, place: &mut Place) {
        place.tangent.iter_mut().for_each(|t| *t = -*t);
        for (test, event) in place.tests.iter_mut().zip(&self.events) {
            if event.test.is_odd() {
                *test = test.map(|test| -test);
            }
        }
    }

    /// Corrects `X` on a hyperplane.
    pub fn correct(
        &mut self,
        unknowns: &mut [f64],
        closing: Closing,
    ) -> Result<Convergence, NewtonError> {
        let Stepper { equations, weights, settings, .. } = self;
        let tolerances = settings.until(settings.tolerance);
        self.newton.solve(equations, unknowns, Some(closing), weights, tolerances)
    }

    /// Records a corrected point: tangent (along `row`), monitors, stability (which costs a
    /// spectrum) if it is wanted, test functions. The matrix factored last, with the same `row`, is
    /// that of this point but for `matrix_error`, relatively.
    pub fn arrive(
        &mut self,
        unknowns: Vec<f64>,
        row: &[f64],
        matrix_error: f64,
        stability: bool,
    ) -> Result<Place, Failure> {
        let tangent = self.tangent_there(&unknowns, row, matrix_error, stability)?;
        self.recorded(unknowns, tangent, stability)
    }

    /// The tangent at a corrected point, and what [`arrive`](Self::arrive) needs beside it.
    fn tangent_there(
        &mut self,
        unknowns: &[f64],
        row: &[f64],
        matrix_error: f64,
        stability: bool,
    ) -> Result<Vec<f64>, Failure> {
        let mut tangent = vec![0.0; unknowns.len()];
        // Eigenvalues that are only counted need not be known well, but monitors come with the
        // matrix.
        let mut tested = self.tested.iter().flatten();
        let exact = tested.any(|tested| tested.stated && tested.condition.assembles())
            || (stability && self.settings.eigenvalues > 0);
        if matrix_error <= MATRIX_ERROR && !exact {
            self.equations.load(unknowns);
            self.tangent(&mut tangent);
            let p = self.equations.parameters_at();
            if tangent[p].abs() * self.weights[p].sqrt() > UNCERTAIN {
                return Ok(tangent);
            }
            tangent.fill(0.0);
        }
        self.equations.assemble(unknowns)?;
        self.equations.residual(unknowns, None, &mut tangent)?;
        self.equations.factor(Some(row))?;
        self.tangent(&mut tangent);
        Ok(tangent)
    }

    /// A place whose tangent was found last.
    fn recorded(
        &mut self,
        unknowns: Vec<f64>,
        tangent: Vec<f64>,
        stability: bool,
    ) -> Result<Place, Failure> {
        let determinant = self.equations.determinant_sign();
        // Monitors need not be known better than the point.
        self.equations.allow(ROUGHLY * self.settings.tolerance);
        let recorded = self.record(stability);
        self.equations.allow(0.0);
        let (point, spectrum) = recorded?;
        let tests = self.tests(&unknowns, &tangent, determinant, spectrum.as_ref(), &point)?;
        Ok(Place { unknowns, tangent, tests, point, spectrum, quiet: 0.0 })
    }

    /// The tangent, of scaled length 1, from the matrix factored last with the closing equation
    /// last.
    pub fn tangent(&mut self, tangent: &mut [f64]) {
        self.equations.tangent(tangent);
        self.rescale(tangent);
    }

    /// How fast a parameter or a monitor grows along the curve; `None` where it is not
    /// differentiable.
    pub fn slope_of(&mut self, quantity: Quantity, place: &Place) -> Option<f64> {
        let direction = self.equations.direction_of(&place.tangent);
        self.equations.load(&place.unknowns);
        let At { system, x, released } = self.equations.at();
        match quantity {
            Quantity::Parameter(p) => Some(direction[system.names().dimension() + p]),
            Quantity::Monitor(m) if m >= system.names().monitors.len() => None,
            Quantity::Monitor(m) => {
                let mut gradient = vec![0.0; x.len()];
                system.monitor_gradient(m, x, released, &mut gradient).ok()?;
                Some(dot(&gradient, &direction))
            }
        }
    }

    /// One step of at most this length; shorter ones are tried down to `min_step`.
    pub fn step(
        &mut self,
        before: &[Before],
        from: &Place,
        mut length: f64,
    ) -> Result<Step, (f64, NewtonError)> {
        let row = self.covector(&from.tangent);
        loop {
            let tried = self.try_step(before, from, &row, length);
            let failure = match tried.and_then(|step| self.stays(from, &step).map(|()| step)) {
                Ok(step) => return Ok(step),
                Err(failure) => failure,
            };
            if length * 0.5 < self.settings.min_step {
                return Err((length, failure));
            }
            length *= 0.5;
        }
    }

    pub fn try_step(
        &mut self,
        before: &[Before],
        from: &Place,
        row: &[f64],
        length: f64,
    ) -> Result<Step, NewtonError> {
        let curved = self.curved(before, from, row, length);
        let order = if curved.is_some() { 4 } else { 2 };
        let line = || advanced(&from.unknowns, length, &from.tangent);
        let predicted = curved.unwrap_or_else(line);
        let mut unknowns = predicted.clone();
        let closing = Closing { row, base: &from.unknowns, length };
        let report = self.correct(&mut unknowns, closing)?;
        let distance = scaled_norm(&difference(&unknowns, &predicted), &self.weights);
        if distance > MOST_DISTANT * length.max(MESH) {
            return Err(NewtonError::Far { distance, length });
        }
        if before.is_empty() {
            self.departs(&unknowns, length)?;
        }
        let stability = self.wants_stability();
        let tangent = self.tangent_there(&unknowns, row, report.matrix_error, stability)?;
        let angle = dot(row, &tangent).clamp(-1.0, 1.0).acos();
        if angle > self.settings.max_angle && length > 2.0 * self.settings.min_step {
            return Err(NewtonError::Turned { angle, largest: self.settings.max_angle });
        }
        let mut place = self.recorded(unknowns, tangent, stability)?;
        let crossings = self.crossings(from, row, length, &mut place);
        // The derivatives were taken elsewhere.
        self.equations.load(&place.unknowns);
        let next = self.next_length(length, report.contraction, angle, order);
        Ok(Step { place, length, next, crossings })
    }

    /// Aims at half the largest angle and at a contraction of 0.1; contraction grows like the
    /// predictor's error, a power of the step's length, the angle like its first power.
    fn next_length(&self, length: f64, contraction: f64, angle: f64, order: i32) -> f64 {
        let by_angle = 0.5 * self.settings.max_angle / angle.max(1e-9);
        let by_contraction = (0.1 / contraction.max(1e-9)).powf(f64::from(order).recip());
        let factor = by_angle.min(by_contraction).clamp(0.5, 2.0);
        (length * factor).clamp(self.settings.min_step, self.settings.max_step)
    }

    /// Lets the mesh, scales and borders follow the branch after a step was accepted. What else is
    /// to stay comparable is carried over to a new mesh.
    pub fn settle(&mut self, place: &mut Place, mut others: Vec<&mut [f64]>) {
        let n = self.equations.dimension();
        let mut directions: Vec<&mut [f64]> =
            others.iter_mut().map(|other| &mut **other).chain([&mut place.tangent[..]]).collect();
        self.equations.follow(&mut place.unknowns, &mut directions);
        let p = &place.unknowns[self.equations.parameters_at()..];
        self.metric.grow(self.equations.names(), &place.unknowns[..n], p);
        self.weights = self.metric.weights(self.equations.names());
        self.equations.adapt();
        // Where scales have grown, the same way is shorter.
        place.quiet *= self.rescale(&mut place.tangent);
    }

    /// Whether eigenvalues are computed at every point: on branches of solutions, unless that is
    /// switched off, and where they are asked for.
    pub fn wants_stability(&self) -> bool {
        self.settings.stability && (self.held.is_empty() || self.settings.eigenvalues > 0)
    }

    /// Parameters, monitors and stability at the point assembled last, and its eigenvalues.
    pub fn record(&mut self, stability: bool) -> Result<(Point, Option<Spectrum>), Failure> {
        let at = self.equations.at();
        let n = at.system.names().dimension();
        let spectrum = if stability { at.system.spectrum(at.x)? } else { None };
        let mut monitors = monitors_of(&self.attached, at, spectrum.as_ref())?;
        let at = self.equations.at();
        let count = self.settings.eigenvalues;
        let eigenvalues = deciding(spectrum.as_deref().unwrap_or_default(), count);
        let dynamics = at.system.dynamics();
        let solutions = self.held.is_empty();
        let counted = spectrum.as_ref().filter(|_| solutions);
        let unstable = counted.map(|all| Stability::of(dynamics, all).unstable);
        let (x, parameters) = (at.x.to_vec(), at.x[n..].to_vec());
        let admissible = self.is_admissible(&monitors, &parameters)
            && self.leads_on(&x, &monitors, &parameters).is_ok();
        monitors.extend(self.equations.recorded());
        let point = Point { parameters, monitors, unstable, eigenvalues, admissible };
        Ok((point, spectrum))
    }

    /// Whether no monitor says that the solution has passed through a surface.
    pub fn is_admissible(&mut self, monitors: &[f64], p: &[f64]) -> bool {
        self.equations.system().is_within(monitors, p, -BEYOND)
    }

    /// Whether every event leads to where the solution goes on; where it grazes that cannot be
    /// decided.
    ///
    /// # Errors
    /// [`Failure::Mismatch`] with the event that leads elsewhere.
    pub fn leads_on(&mut self, x: &[f64], monitors: &[f64], p: &[f64]) -> Result<(), Failure> {
        let system = self.equations.system();
        match system.is_within(monitors, p, VANISHES) {
            true => system.events().map_or(Ok(()), |events| events.check(x)),
            false => Ok(()),
        }
    }
}

/// The monitors of a system at the point assembled last, and those attached.
pub(super) fn monitors_of(
    attached: &[Attached],
    At { system, x, .. }: At,
    spectrum: Option<&Spectrum>,
) -> Result<Vec<f64>, Failure> {
    let (n, own) = (system.names().dimension(), system.names().monitors.len());
    let mut monitors = vec![0.0; own];
    system.monitors(x, &mut monitors)?;
    for Attached { function, .. } in attached {
        let value = function(&TestPoint {
            state: &x[..n],
            parameters: &x[n..],
            monitors: &monitors,
            eigenvalues: spectrum.map_or(&[], |all| all),
        });
        monitors.push(value);
    }
    Ok(monitors)
}

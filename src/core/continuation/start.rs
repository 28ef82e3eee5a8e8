//! The start of a curve: the first correction, the scales, and the first tangent.

use super::event::{MakeCondition, Test};
use super::metric::{Metric, in_units};
use super::run::{Bound, Tracer};
use super::stepper::{AT_START, Place, Stepper};
use super::trace::Origin;
use super::{Branch, Continuation, End, Kind, TraceError};
use crate::core::bifurcation::branches_at;
use crate::core::condition::{At, Failure};
use crate::core::extended::{Closing, Extended};
use crate::core::newton::{Newton, NewtonError, scaled_norm};
use crate::core::solution::Leaving;
use crate::core::vector::{difference, dot, generic, norm};

/// A monitor vanishes at a start if it is smaller: a saved grazing is exact to rounding.
pub(super) const VANISHES: f64 = 1e-6;

/// What a curve is made of, by the names that the system has.
pub(super) struct Resolved {
    /// The parameters released, as positions among all.
    pub released: Vec<usize>,
    pub held: Vec<MakeCondition>,
    /// The bounds, which are the first events.
    pub bounds: Vec<Bound>,
    /// Scales that the user gives, of groups and then of released parameters.
    pub scales: Vec<Option<f64>>,
    /// The columns of points that settle.
    pub settled: Vec<usize>,
}

impl<'a> Continuation<'a> {
    /// The trace that starts here.
    pub(super) fn start(self, resolved: Resolved, how: Leaving) -> Result<Tracer<'a>, TraceError> {
        let names = self.system.names();
        let values = &self.x[names.dimension()..];
        let place: Vec<String> = resolved
            .released
            .iter()
            .map(|&p| format!("{} = {}", names.parameters[p], values[p]))
            .collect();
        let (branch, place) = (self.name.clone(), place.join(", "));
        let tracer = self.begin(resolved, how).map_err(|cause| {
            let cause = Box::new(cause);
            TraceError::Start { branch, place, cause }
        })?;
        tracer.check_bounds()?;
        Ok(tracer)
    }

    /// Corrects the start, finds the tangent and the scales.
    fn begin(mut self, resolved: Resolved, how: Leaving) -> Result<Tracer<'a>, NewtonError> {
        let Resolved { released, held, bounds, scales, settled } = resolved;
        let branch = self.branch();
        let leaving = self.leaving(&released, how)?;
        let from_branch_point = leaving.is_some();
        let same_curve = self.origin.condition == self.held.first().map(|(kind, _)| *kind);
        let direction = leaving.or(self.origin.tangent.filter(|_| same_curve));
        let ranges: Vec<[f64; 2]> = self.released.iter().map(|r| r.1).collect();
        let mut equations = Extended::new(self.system, &self.x, released);
        let mut unknowns = equations.unload(&self.x);
        for make in &held {
            unknowns = equations.hold(make(), &unknowns)?;
        }
        let direction = direction.map(|t| equations.unload(&t));
        let scaling = |equations: &Extended, unknowns: &[f64], tangent: &[f64]| {
            metric(equations, unknowns, tangent, &ranges).with_scales(&scales)
        };
        let rough = scaling(&equations, &unknowns, &vec![0.0; unknowns.len()]);
        let tested =
            |event: &super::Event| (event.test == Test::Condition).then(|| (event.condition)());
        let mut stepper = Stepper {
            weights: rough.weights(equations.names()),
            equations,
            newton: Newton::default(),
            settings: self.settings,
            metric: rough,
            tested: self.events.iter().map(tested).collect(),
            events: self.events,
            held,
            settled,
        };
        let tangent = match direction {
            Some(direction) if from_branch_point => direction,
            direction => stepper.first_tangent(&mut unknowns, direction.as_deref())?,
        };
        stepper.metric = scaling(&stepper.equations, &unknowns, &tangent);
        let tangent = stepper.scaled(tangent);
        let mut start = stepper.arrive_first(unknowns, tangent, from_branch_point)?;
        if how != Leaving::Along {
            stepper.forget_stability_at(&mut start);
        }
        let slopes = stepper.forget_levels_at(&mut start, self.origin.is_birth);
        if !from_branch_point {
            stepper.equations.follow(&mut start.unknowns, &mut [&mut start.tangent]);
        }
        // Both sides are the same where a branch of periodic orbits is born.
        let directions = match how {
            Leaving::Along | Leaving::Switched => [self.backward, self.forward],
            Leaving::BranchPoint | Leaving::Direction => [false, true],
        };
        let labels = 0;
        Ok(Tracer { stepper, branch, start, bounds, slopes, directions, from_branch_point, labels })
    }

    /// The direction in which to leave a branch point: along the branch that one comes from, or along
    /// the other one. `None` if the start is no branch point.
    fn leaving(&mut self, released: &[usize], how: Leaving) -> Result<Option<Vec<f64>>, Failure> {
        let Origin { tangent, kind, switched, is_branch_point, .. } = &self.origin;
        if how == Leaving::Direction {
            return Ok(tangent.clone());
        }
        if *switched
            && how == Leaving::Along
            && let Some(kind) = kind.filter(|kind| *kind != Kind::BP)
        {
            return Err(Failure::NotApplicable(format!(
                "the point to switch at is a {}, but branches cross at branch points (BP) only",
                kind.meaning()
            )));
        }
        if !(*switched || *is_branch_point && self.held.is_empty()) {
            return Ok(None);
        }
        let at = At { system: &mut *self.system, x: &self.x, released };
        match branches_at(at, released[0]) {
            Ok(tangents) => Ok(Some(branch_along(tangents, tangent.as_deref(), *switched))),
            Err(cause) if *switched || tangent.is_none() => Err(cause),
            Err(_) => Ok(tangent.clone()),
        }
    }

    /// The branch without its points.
    fn branch(&self) -> Branch {
        let names = self.system.names();
        Branch {
            name: self.name.clone(),
            condition: self.held.first().map(|(kind, _)| *kind),
            itinerary: self.system.itinerary(),
            unknowns: names.unknowns.clone(),
            parameters: names.parameters.clone(),
            released: self.released.iter().map(|r| r.0.clone()).collect(),
            monitors: names.monitors.clone(),
            points: Vec::new(),
            special: Vec::new(),
            ends: [End::Start, End::Start],
            settings: self.settings.clone(),
        }
    }
}

/// Of the tangents at a branch point, the one most aligned with the branch that one comes from, or the
/// other one.
fn branch_along(tangents: [Vec<f64>; 2], along: Option<&[f64]>, other: bool) -> Vec<f64> {
    let [first, second] = tangents;
    let Some(along) = along else { return second };
    let aligned = |t: &[f64]| dot(t, along).abs() / norm(t);
    if (aligned(&first) > aligned(&second)) == other { second } else { first }
}

/// The scales at a place with a tangent.
fn metric(equations: &Extended, unknowns: &[f64], tangent: &[f64], ranges: &[[f64; 2]]) -> Metric {
    let (n, first) = (equations.dimension(), equations.parameters_at());
    let own = equations.own_sizes(unknowns);
    let (names, units) = (equations.names(), equations.unknown_scales());
    let [(z, p), (z_tangent, p_tangent)] =
        [unknowns, tangent].map(|x| (in_units(names, &units, &x[..n]), &x[first..]));
    Metric::new(names, &z, &z_tangent, ranges, p, p_tangent, &own).of_units(&units)
}

impl Stepper<'_> {
    /// Corrects the start on the hyperplane across `direction`, or with a parameter fixed, and returns the
    /// tangent there.
    fn first_tangent(
        &mut self,
        unknowns: &mut [f64],
        direction: Option<&[f64]>,
    ) -> Result<Vec<f64>, NewtonError> {
        let (length, base) = (unknowns.len(), unknowns.to_vec());
        let fixed = |parameter: usize| {
            let mut row = vec![0.0; length];
            row[parameter] = 1.0;
            row
        };
        let across = direction.map(|direction| self.covector(direction));
        let fixed = (self.equations.parameters_at()..length).rev().map(fixed);
        let mut failure = None;
        for row in across.into_iter().chain(fixed) {
            unknowns.copy_from_slice(&base);
            match self.correct_start(unknowns, &row) {
                Ok(tangent) => return Ok(tangent),
                // The first failure is the one that tells: later rows only try harder.
                Err(cause) => _ = failure.get_or_insert(cause),
            }
        }
        // A start that is a solution already may be a fold, which a hyperplane across some unknowns
        // passes through, or a branch point, where this fails as well.
        let mut row = generic(length, 1);
        row[self.equations.dimension()..].fill(0.0);
        row.iter_mut().zip(&self.weights).for_each(|(r, w)| *r *= w.sqrt());
        unknowns.copy_from_slice(&base);
        let tangent = self.correct_start(unknowns, &row);
        let moved = scaled_norm(&difference(unknowns, &base), &self.weights);
        match failure {
            Some(failure) if tangent.is_err() || moved > AT_START => Err(failure),
            _ => tangent,
        }
    }

    /// Corrects on the hyperplane of `row` through the start, and solves for the tangent.
    fn correct_start(
        &mut self,
        unknowns: &mut [f64],
        row: &[f64],
    ) -> Result<Vec<f64>, NewtonError> {
        let base = unknowns.to_vec();
        self.correct(unknowns, Closing { row, base: &base, length: 0.0 })?;
        let mut tangent = vec![0.0; unknowns.len()];
        self.equations.residual(unknowns, None, &mut tangent)?;
        self.equations.factor(Some(row))?;
        self.equations.tangent(&mut tangent);
        Ok(tangent)
    }

    /// Takes over the scales at the start, and the tangent there: of scaled length 1, the last released
    /// parameter growing.
    fn scaled(&mut self, mut tangent: Vec<f64>) -> Vec<f64> {
        self.weights = self.metric.weights(self.equations.names());
        // What the first correction has learned about the equations was in other scales.
        self.newton = Newton::default();
        let (n, last) = (self.equations.dimension(), tangent.len() - 1);
        let size = scaled_norm(&tangent, &self.weights);
        let sign = match tangent[last] {
            // A vertical start (a fold, a pitchfork) grows in its largest unknown.
            p if p.abs() * self.weights[last].sqrt() < 1e-9 * size => {
                let by_size = |a: &&f64, b: &&f64| a.abs().total_cmp(&b.abs());
                let units = self.equations.unknown_scales();
                let z = in_units(self.equations.names(), &units, &tangent[..n]);
                z.iter().max_by(by_size).map_or(1.0, |z| z.signum())
            }
            p => p.signum(),
        };
        tangent.iter_mut().for_each(|t| *t *= sign / size);
        tangent
    }

    /// Records the start. The system may refuse it, unless it grazes.
    fn arrive_first(
        &mut self,
        unknowns: Vec<f64>,
        tangent: Vec<f64>,
        from_branch_point: bool,
    ) -> Result<Place, Failure> {
        self.equations.load(&unknowns);
        for condition in self.tested.iter_mut().flatten() {
            condition.start(self.equations.at(), &mut [])?;
        }
        let stability = self.held.is_empty();
        let start = if from_branch_point {
            // The tangent of the matrix is not unique there.
            self.equations.assemble(&unknowns)?;
            let (point, stability) = self.record(stability)?;
            let tests = self.tests(&unknowns, &tangent, 0.0, stability, &point)?;
            Place { unknowns, tangent, tests, point }
        } else {
            let row = self.covector(&tangent);
            self.arrive(unknowns, &row, f64::INFINITY, stability)?
        };
        let (monitors, p) = (&start.point.monitors, &start.point.parameters);
        let system = self.equations.system();
        let clear = |&m: &usize| monitors[m] > VANISHES * system.grazing_scale(m, p);
        if system.grazings().iter().all(clear) {
            self.equations.load(&start.unknowns);
            let at = self.equations.at();
            at.system.check_start(at.x)?;
        }
        Ok(start)
    }
}

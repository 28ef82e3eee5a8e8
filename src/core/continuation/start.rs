//! The start of a curve: the first correction, the scales, and the first tangent.

use super::event::{Event, MakeCondition};
use super::metric::{Metric, in_units};
use super::run::{Bound, Tracer};
use super::stepper::{AT_START, Place, Stepper, VANISHES};
use super::trace::Origin;
use super::{Branch, Continuation, End, Kind, Settings, TraceError};
use crate::core::condition::{Failure, Quantity};
use crate::core::extended::{Closing, Extended};
use crate::core::newton::{Newton, NewtonError, scaled_norm};
use crate::core::solution::Start;
use crate::core::test_function::Test;
use crate::core::vector::{difference, dot, generic, largest};
use std::collections::VecDeque;

/// Unknowns whose sizes differ by less than this, relatively, are of one size.
const EQUAL: f64 = 1e-4;

/// A level nearer than this to where a curve is born, in scaled arclength, is where it is born.
const AT_BIRTH: f64 = 1e-2;

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
    pub(super) fn start(self, resolved: Resolved, start: Start) -> Result<Tracer<'a>, TraceError> {
        let names = self.system.names();
        let values = &self.x[names.dimension()..];
        let at = |&p: &usize| format!("{} = {}", names.parameters[p], values[p]);
        let place: Vec<String> = resolved.released.iter().map(at).collect();
        let (branch, place) = (self.name.clone(), place.join(", "));
        let tracer = self.begin(resolved, start).map_err(|cause| {
            let cause = Box::new(cause);
            TraceError::Start { branch, place, cause }
        })?;
        tracer.check_bounds()?;
        Ok(tracer)
    }

    /// Corrects the start, finds the tangent and the scales.
    fn begin(mut self, resolved: Resolved, start: Start) -> Result<Tracer<'a>, NewtonError> {
        let Resolved { released, held, bounds, scales, settled } = resolved;
        let branch = self.branch(&held);
        let same_curve = self.origin.condition == self.held.first().map(|(kind, _)| *kind);
        let known = start.direction(same_curve, self.held.is_empty());
        let ranges: Vec<[f64; 2]> = self.released.iter().map(|r| r.1).collect();
        let mut equations = Extended::of(self.system, &self.x, released);
        equations.cancel.clone_from(&self.settings.cancel);
        let mut unknowns = equations.unload(&self.x);
        for make in &held {
            unknowns = equations.hold(make(), &unknowns)?;
        }
        let known = known.map(|t| equations.unload(t));
        let scaling = |equations: &Extended, unknowns: &[f64], tangent: &[f64]| {
            metric(equations, unknowns, tangent, &ranges).with_scales(&scales)
        };
        let still = vec![0.0; unknowns.len()];
        let rough = scaling(&equations, &unknowns, known.as_deref().unwrap_or(&still));
        let mut stepper = Stepper::new(equations, rough, self.settings, self.events);
        stepper.attached = self.attached;
        (stepper.held, stepper.settled) = (held, settled);
        let [leaving, parent] =
            stepper.leaving(&start, &unknowns, known.as_deref(), &self.origin)?;
        let from_branch_point = leaving.is_some();
        let to_one_side = matches!(start, Start::Birth { .. }) && from_branch_point;
        // Both sides are the same where a branch of cycles emanates.
        let one_sided = to_one_side
            || matches!(start, Start::BranchPoint { one_sided: true, .. } | Start::Direction(_));
        let tangent = match leaving {
            Some(direction) => direction,
            None => stepper.first_tangent(&mut unknowns, known.as_deref())?,
        };
        stepper.metric = scaling(&stepper.equations, &unknowns, &tangent);
        let tangent = stepper.scaled(tangent, to_one_side);
        let mut place = stepper.arrive_first(unknowns, tangent, from_branch_point)?;
        // Where a branch is born its solutions graze: what its events lead to is decided by
        // rounding.
        if !matches!(start, Start::Birth { .. }) {
            stepper.check_first(&place)?;
        }
        if one_sided {
            stepper.forget_stability_at(&mut place);
        }
        stepper.departure = parent.map(|parent| stepper.departure(&place, parent));
        let slopes = stepper.forget_levels_at(&mut place, &start);
        if !from_branch_point {
            stepper.equations.follow(&mut place.unknowns, &mut [&mut place.tangent]);
        }
        Ok(Tracer {
            stepper,
            branch,
            start: place,
            bounds,
            slopes,
            directions: if one_sided { [false, true] } else { [self.backward, self.forward] },
            from_branch_point,
            error: self.origin.error,
            origin: self.origin.kind.into_iter().chain(self.origin.condition).collect(),
            labels: 0,
            shown: VecDeque::new(),
        })
    }

    /// The branch without its points.
    fn branch(&mut self, held: &[MakeCondition]) -> Branch {
        let (itinerary, method) = (self.system.words(), self.system.method());
        let names = self.system.names();
        let own = held.iter().flat_map(|make| make().names()).map(ToString::to_string);
        Branch {
            name: self.name.clone(),
            condition: self.held.first().map(|(kind, _)| *kind),
            itinerary,
            method,
            unknowns: names.unknowns.clone(),
            parameters: names.parameters.clone(),
            released: self.released.iter().map(|r| r.0.clone()).collect(),
            monitors: self.monitor_names().map(ToString::to_string).chain(own).collect(),
            points: Vec::new(),
            special: Vec::new(),
            ends: [End::Start, End::Start],
            warnings: Vec::new(),
            settings: self.settings.clone(),
        }
    }
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

impl<'a> Stepper<'a> {
    /// With nothing held.
    fn new(
        equations: Extended<'a>,
        metric: Metric,
        settings: Settings,
        events: Vec<Event>,
    ) -> Self {
        Stepper {
            weights: metric.weights(equations.names()),
            equations,
            newton: Newton::default(),
            settings,
            metric,
            tested: events.iter().map(Event::tested).collect(),
            events,
            held: Vec::new(),
            settled: Vec::new(),
            attached: Vec::new(),
            departure: None,
        }
    }
}

impl Stepper<'_> {
    /// The tangent along which a branch begins where that is known before its start is corrected,
    /// and that of the branch it leaves: at a branch point both are from the algebraic bifurcation
    /// equations.
    fn leaving(
        &mut self,
        start: &Start,
        unknowns: &[f64],
        along: Option<&[f64]>,
        origin: &Origin,
    ) -> Result<[Option<Vec<f64>>; 2], Failure> {
        let known = along.map(<[f64]>::to_vec);
        match start {
            Start::Direction(_) | Start::Birth { .. } => return Ok([known, None]),
            Start::Point { .. } => return Ok([None, None]),
            Start::BranchPoint { .. } => {}
        }
        let found = self.tangents_at_crossing(unknowns, origin.multiplicity.max(1));
        let mut tangents = match found {
            Err(_) if known.is_some() && origin.switch.is_none() => return Ok([known, None]),
            found => found?,
        };
        let Some(along) = along else { return Ok([tangents.pop(), None]) };
        let row = self.covector(along);
        let parent = (0..tangents.len())
            .max_by(|&a, &b| {
                let cosine = |k: usize| dot(&row, &tangents[k]).abs();
                cosine(a).total_cmp(&cosine(b))
            })
            .unwrap_or_default();
        let parent = Some(tangents.remove(parent));
        let Some(branch) = origin.switch else { return Ok([parent, None]) };
        let count = tangents.len();
        match tangents.into_iter().nth(branch) {
            None => Err(Failure::no_branch(branch, count)),
            tangent => Ok([tangent, parent]),
        }
    }

    /// Corrects the start on the hyperplane across `direction`, or with a parameter fixed, and
    /// returns the tangent there.
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

    /// Forgets what has been learned along the curve: scales, the curvature of the equations, the
    /// conditions' borders.
    pub fn restore(&mut self, unknowns: &[f64], metric: Metric) {
        self.weights = metric.weights(self.equations.names());
        self.metric = metric;
        self.newton = Newton::default();
        let conditions = self.equations.suspend();
        let (n, own) = (self.equations.dimension(), unknowns.len() - self.equations.length());
        let mut bare = unknowns.to_vec();
        bare.drain(n..n + own);
        let held = self.held.iter().try_fold(bare, |x, make| self.equations.hold(make(), &x));
        if held.is_err() {
            // They could be stated there once; the borders that they have now serve as well.
            self.equations.resume(conditions);
        }
    }

    /// Takes over the scales at the start, and the tangent there: of scaled length 1, the last
    /// released parameter growing, unless its sign is known.
    fn scaled(&mut self, mut tangent: Vec<f64>, known: bool) -> Vec<f64> {
        self.weights = self.metric.weights(self.equations.names());
        // What the first correction has learned about the equations was in other scales.
        self.newton = Newton::default();
        let (n, last) = (self.equations.dimension(), tangent.len() - 1);
        let size = scaled_norm(&tangent, &self.weights);
        let sign = match tangent[last] {
            _ if known => 1.0,
            // A vertical start (a fold, a pitchfork) grows in its largest unknown, the first of
            // those that are equal but for rounding, as the two halves of a doubled orbit are.
            p if p.abs() * self.weights[last].sqrt() < 1e-9 * size => {
                let units = self.equations.unknown_scales();
                let z = in_units(self.equations.names(), &units, &tangent[..n]);
                let largest = largest(&z);
                let first = z.iter().find(|z| z.abs() >= (1.0 - EQUAL) * largest);
                first.map_or(1.0, |z| z.signum())
            }
            p => p.signum(),
        };
        tangent.iter_mut().for_each(|t| *t *= sign / size);
        tangent
    }

    /// Records the start.
    fn arrive_first(
        &mut self,
        unknowns: Vec<f64>,
        tangent: Vec<f64>,
        from_branch_point: bool,
    ) -> Result<Place, Failure> {
        self.equations.load(&unknowns);
        for tested in self.tested.iter_mut().flatten() {
            tested.state(self.equations.at())?;
        }
        let stability = self.wants_stability();
        let start = if from_branch_point {
            // The tangent of the matrix is not unique there.
            self.equations.assemble(&unknowns)?;
            // Nor need multipliers be determined.
            let recorded = self.record(stability).or_else(|_| self.record(false));
            let (point, spectrum) = recorded?;
            let tests = self.tests(&unknowns, &tangent, 0.0, spectrum.as_ref(), &point)?;
            Place { unknowns, tangent, tests, point, spectrum, quiet: 0.0 }
        } else {
            let row = self.covector(&tangent);
            self.arrive(unknowns, &row, f64::INFINITY, stability)?
        };
        Ok(start)
    }

    /// Refuses a start at which an event leads elsewhere, unless it grazes.
    fn check_first(&mut self, start: &Place) -> Result<(), Failure> {
        let x = self.equations.load(&start.unknowns).to_vec();
        self.leads_on(&x, &start.point.monitors, &start.point.parameters)
    }

    /// Where a branch of periodic orbits is born a multiplier is 1 but for rounding: its stability
    /// there is not reported, nor is a change of it in the first step.
    fn forget_stability_at(&self, start: &mut Place) {
        start.point.unstable = None;
        for (test, event) in start.tests.iter_mut().zip(&self.events) {
            if event.test.needs_eigenvalues() {
                *test = Some(0.0);
            }
        }
    }

    /// A curve that starts on a level, but for rounding, does not pass it in its first step.
    /// Returns how fast each level's test function grows along the curve at the start.
    ///
    /// A curve that is born on a level misses it by as much as the discretisation errs.
    fn forget_levels_at(&mut self, start: &mut Place, from: &Start) -> Vec<f64> {
        let born = matches!(from, Start::Birth { .. });
        let vertical = matches!(from, Start::Birth { along: Some(_) });
        let near = if born { AT_BIRTH } else { AT_START };
        let mut slopes = vec![0.0; self.events.len()];
        for i in 0..self.events.len() {
            if born && self.events[i].test == Test::Itinerary {
                // What the events of legs of no length lead to is decided by rounding.
                start.tests[i] = None;
            }
            let Some((quantity, level)) = self.events[i].test.level() else { continue };
            slopes[i] = self.slope_of(quantity, start).unwrap_or_default();
            let mut rounding = near * f64::abs(slopes[i]) + 1e-12 * level.abs();
            if let (true, Kind::G, Quantity::Monitor(m)) = (vertical, self.events[i].kind, quantity)
            {
                // Where it vanishes to second order its sign and that of its slope are rounding:
                // the first step tells.
                let p = &start.point.parameters;
                let zero = VANISHES * self.equations.system().limit_scale(m, p);
                if start.tests[i].is_some_and(|test| test.abs() <= zero) {
                    (rounding, slopes[i]) = (zero, 0.0);
                }
            }
            if start.tests[i].is_some_and(|test| test.abs() <= rounding) {
                start.tests[i] = Some(0.0);
            }
        }
        slopes
    }
}

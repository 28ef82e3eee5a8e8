//! One step each of several flows of one field, abreast in the lanes of a vector register.
//!
//! Every flow has its own place, step and parameters. What the step of one of them means is decided for it alone:
//! here steps are tried, and watched functions are seen to keep clear of zero, which is nearly all of the work.

use super::control::Control;
use super::error::FlowError;
use super::integrate::{Flow, Statistics};
use super::lanes::{LANES, Lanes};
use super::motion::Motion;
use super::roots::{Sign, ZERO};
use super::settings::Settings;
use super::stages::Stages;
use super::step::{Known, Step};
use super::tableau::{Row, Tableau};
use crate::core::field::VectorField;
use crate::core::watch::Watch;
use num_dual::Dual;
use std::cell::Cell;

/// A flow under way, between two steps.
pub(in crate::core) struct Course {
    /// The time at its start.
    start: f64,
    /// Its duration.
    length: f64,
    /// How far it has come, from 0 to 1.
    sigma: f64,
    /// The step to try.
    h: f64,
    /// The state.
    x: Vec<f64>,
    /// The slope by time.
    slope: Vec<f64>,
    largest_step: f64,
    control: Control,
    /// What it has cost.
    pub statistics: Statistics,
}

impl Course {
    /// No flow as yet.
    pub fn new() -> Self {
        let settings = Settings::default();
        Course {
            start: 0.0,
            length: 0.0,
            sigma: 0.0,
            h: 0.0,
            x: Vec::new(),
            slope: Vec::new(),
            largest_step: 1.0,
            control: Control::new(&settings),
            statistics: Statistics::default(),
        }
    }

    /// The state.
    pub fn state(&self) -> &[f64] {
        &self.x
    }

    /// Whether the end is reached.
    pub fn is_over(&self) -> bool {
        self.sigma >= 1.0
    }

    /// The step to try, and whether it is the last one.
    fn step(&self) -> (f64, bool) {
        let h = self.h.min(self.largest_step);
        if self.sigma + 1.01 * h >= 1.0 { (1.0 - self.sigma, true) } else { (h, false) }
    }

    /// Makes the step shorter that was tried with an error; none if this flow wants another look.
    pub fn reject(&mut self, error: f64) -> Option<()> {
        self.statistics.rejected += 1;
        self.h = self.step().0 * self.control.rejected(error);
        (error.is_finite() && self.h > 1e-12).then_some(())
    }
}

impl Flow<f64> {
    /// Sets out on a course.
    ///
    /// # Errors
    /// [`FlowError`] if the state is outside the domain of the field.
    pub(in crate::core) fn set_out<F: VectorField>(
        &mut self,
        field: &F,
        [start, length]: [f64; 2],
        x: &[f64],
        p: &[f64],
        course: &mut Course,
    ) -> Result<(), FlowError> {
        let evaluations = Cell::new(0);
        let motion = Motion { field, start, length, p, evaluations: &evaluations };
        self.resize(x, p);
        self.inside(&motion, 0.0)?;
        let h = self.first_step(&motion)?;
        let slope = self.buffers.stages.slope(0);
        course.x.clear();
        course.x.extend_from_slice(x);
        course.slope.clear();
        course.slope.extend(slope.iter().map(|slope| slope / length));
        (course.start, course.length, course.sigma, course.h) = (start, length, 0.0, h);
        course.largest_step = self.settings.largest_step;
        course.control = Control::new(&self.settings);
        course.statistics = Statistics { evaluations: evaluations.get(), ..Default::default() };
        Ok(())
    }

    /// Shows the step of one lane as if it were of this flow.
    pub(in crate::core) fn show_lane<F: VectorField>(
        &mut self,
        field: &F,
        p: &[f64],
        (abreast, lane, course): (&Abreast, usize, &mut Course),
        observe: impl FnOnce(&mut Step<F, f64>),
    ) {
        let Course { start, length, sigma, .. } = *course;
        let (h, _) = course.step();
        let (n, evaluations) = (course.x.len(), Cell::new(0));
        let motion = &Motion { field, start, length, p, evaluations: &evaluations };
        let (scheme, tolerance) = (self.settings.scheme, self.settings.absolute);
        let buffers = &mut self.buffers;
        buffers.x.clear();
        buffers.x.extend_from_slice(&course.x);
        buffers.stages.resize(n);
        buffers.partial.resize(n);
        let known = abreast.slopes(n).iter().map(|slope| slope.each()[lane] / h);
        buffers.stages.slopes.iter_mut().zip(known).for_each(|(to, from)| *to = from);
        for (to, from) in buffers.stages.end.iter_mut().zip(&abreast.stages.end) {
            *to = from.each()[lane];
        }
        observe(&mut Step {
            motion,
            scheme,
            tolerance,
            sigma,
            h,
            buffers,
            known: Known::default(),
        });
        course.statistics.evaluations += evaluations.get();
    }
}

/// What ends and slopes of a step tell about a watched function, one bit for each lane.
#[derive(Clone, Copy, Debug)]
pub(in crate::core) struct Outlook {
    /// It is positive at the start.
    positive: u32,
    /// It is positive at both ends, and has no extremum between them that could be less.
    clear: u32,
    /// It rises all the way, and is positive at the end.
    rises: u32,
}

impl Outlook {
    /// Whether it is seen that the function does not fall through zero in the step of a lane; it is positive then.
    pub fn is_quiet(&self, lane: usize, sign: Sign) -> bool {
        let bit = |bits: u32| bits >> lane & 1 == 1;
        let positive = match sign {
            Sign::Positive => true,
            Sign::Unknown => bit(self.positive),
            Sign::Zero { .. } | Sign::Fallen => false,
        };
        bit(self.rises) || positive && bit(self.clear)
    }
}

/// Flows abreast, in one step.
pub(in crate::core) struct Abreast {
    tableau: &'static Tableau,
    /// States, slopes, parameters, times and durations of the step as they are given, lane by lane.
    given: [Vec<[f64; LANES]>; 3],
    time: [f64; LANES],
    length: [f64; LANES],
    x: Vec<Lanes>,
    p: Vec<Lanes>,
    stages: Stages<Lanes>,
    /// What watched functions see.
    dual_x: [Vec<Dual<Lanes>>; 2],
    dual_p: Vec<Dual<Lanes>>,
}

impl Abreast {
    /// Flows abreast, by an explicit method.
    pub fn new(settings: &Settings) -> Option<Self> {
        Some(Abreast {
            tableau: settings.scheme.tableau()?,
            given: Default::default(),
            time: [0.0; LANES],
            length: [0.0; LANES],
            x: Vec::new(),
            p: Vec::new(),
            stages: Stages::default(),
            dual_x: Default::default(),
            dual_p: Vec::new(),
        })
    }

    /// Puts a flow into a lane. Lanes that stay empty need one all the same.
    pub fn load(&mut self, lane: usize, course: &Course, p: &[f64]) {
        let [x, slope, parameters] = &mut self.given;
        for (to, from) in [(x, &course.x[..]), (slope, &course.slope), (parameters, p)] {
            to.resize(from.len(), [0.0; LANES]);
            to.iter_mut().zip(from).for_each(|(to, from)| to[lane] = *from);
        }
        self.time[lane] = course.start + course.length * course.sigma;
        self.length[lane] = course.length * course.step().0;
    }

    /// All slopes, in units of the step, of `n` states.
    fn slopes(&self, n: usize) -> &[Lanes] {
        &self.stages.slopes[..(self.tableau.end() + 1) * n]
    }

    /// Tries a step in every lane and returns the errors, in units of the tolerance.
    pub fn attempt<F: VectorField>(&mut self, field: &F, settings: &Settings) -> [f64; LANES] {
        let Abreast { tableau, given, x, p, stages, .. } = self;
        let [start, length] = [self.time, self.length].map(Lanes::from);
        let evaluations = &Cell::new(0);
        x.clear();
        x.extend(given[0].iter().map(|x| Lanes::from(*x)));
        p.clear();
        p.extend(given[2].iter().map(|p| Lanes::from(*p)));
        stages.resize(x.len());
        for (to, slope) in stages.slopes.iter_mut().zip(&given[1]) {
            *to = Lanes::from(*slope) * length;
        }
        let motion = Motion { field, start, length, p, evaluations };
        stages.advance(tableau, &motion, (0.0, 1.0), x);
        stages.end_slope(tableau.end(), &motion, 1.0);
        self.errors(settings)
    }

    /// The errors, as [`Measure::explicit_error`](super::control::Measure::explicit_error) has them.
    fn errors(&self, settings: &Settings) -> [f64; LANES] {
        let (n, slopes, mut squares) = (self.x.len(), &self.stages.slopes, [Lanes::splat(0.0); 2]);
        for (i, (x, end)) in self.x.iter().zip(&self.stages.end).enumerate() {
            let tolerated = x.size().most(end.size()) * settings.relative + settings.absolute;
            let sum = |row: Row| {
                let terms = row.iter().map(|(j, e)| slopes[j * n + i] * *e);
                terms.fold(Lanes::splat(0.0), |sum, term| sum + term) / tolerated
            };
            for (square, row) in
                squares.iter_mut().zip([self.tableau.error, self.tableau.rough_error])
            {
                let error = sum(row);
                *square += error * error;
            }
        }
        let ([fine, rough], n) = (squares, n as f64);
        if self.tableau.rough_error.is_empty() {
            return (fine / n).root().each();
        }
        // Where both vanish, so does the error.
        let together = (fine + rough * 0.01).most(Lanes::splat(f64::MIN_POSITIVE));
        (fine / (together * n).root()).each()
    }

    /// Prepares what watched functions see.
    pub fn look(&mut self) {
        let (n, end) = (self.x.len(), self.tableau.end());
        let ends = [(&self.x, 0), (&self.stages.end, end)];
        for (dual, (x, stage)) in self.dual_x.iter_mut().zip(ends) {
            let slopes = &self.stages.slopes[stage * n..(stage + 1) * n];
            dual.clear();
            dual.extend(x.iter().zip(slopes).map(|(x, slope)| Dual::new(*x, *slope)));
        }
        self.dual_p.clear();
        self.dual_p.extend(self.p.iter().map(|p| Dual::from_re(*p)));
    }

    /// What can be said about a watched function from its values and slopes at both ends.
    pub fn outlook<W: Watch>(&self, watch: &W) -> Outlook {
        let [time, length] = [self.time, self.length].map(Lanes::from);
        let [start, end] = [0, 1].map(|end| {
            let time = Dual::new(time + length * end as f64, length);
            watch.value(time, &self.dual_x[end], &self.dual_p)
        });
        let middle = (end.re - start.re) * 1.5 - (start.eps + end.eps) * 0.25;
        let slopes = [start.eps, middle, end.eps];
        let [first, second, third] = slopes.map(Lanes::size);
        let (least, most) = (first.least(second).least(third), first.most(second).most(third));
        let (zero, none) = (Lanes::splat(0.0), Lanes::splat(ZERO));
        let same = slopes.iter().fold(!0, |bits, slope| bits & (*slope * slopes[2]).exceeds(zero));
        let monotone = same & (least * 5.0).exceeds(most);
        let lower = start.re.least(end.re);
        Outlook {
            positive: start.re.exceeds(none),
            clear: lower.exceeds(none) & (monotone | lower.exceeds(most)),
            rises: monotone & end.eps.exceeds(zero) & end.re.exceeds(none),
        }
    }

    /// Accepts the step of a lane with this error.
    pub fn accept(&self, lane: usize, error: f64, course: &mut Course) {
        let (n, (h, last)) = (course.x.len(), course.step());
        let slopes = &self.stages.slopes[self.tableau.end() * n..];
        let length = self.length[lane];
        course.x.iter_mut().zip(&self.stages.end).for_each(|(x, end)| *x = end.each()[lane]);
        for (to, slope) in course.slope.iter_mut().zip(slopes) {
            *to = slope.each()[lane] / length;
        }
        course.sigma = if last { 1.0 } else { course.sigma + h };
        course.h = h * course.control.accepted(error);
        course.statistics.accepted += 1;
    }

    /// How many evaluations of the field a step takes.
    pub fn cost(&self) -> usize {
        self.tableau.end()
    }
}

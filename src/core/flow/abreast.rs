//! One step each of several flows of one field, abreast in the lanes of a vector register.
//!
//! Every flow has its own place, step and parameters. What the step of one of them means is decided for it alone:
//! here steps are tried, and watched functions are seen to keep clear of zero, which is nearly all of the work.

use super::course::Course;
use super::error::FlowError;
use super::integrate::Flow;
use super::lanes::{LANES, Lanes};
use super::motion::Motion;
use super::outlook::Outlook;
use super::settings::Settings;
use super::stages::Stages;
use super::step::{Known, Step};
use super::tableau::{Row, Tableau};
use crate::core::scalar_field::FieldIn;
use crate::core::watch::WatchIn;
use num_dual::Dual;
use std::cell::Cell;

impl Flow<f64> {
    /// Sets out on a course.
    ///
    /// # Errors
    /// [`FlowError`] if the state is outside the domain of the field.
    pub(in crate::core) fn set_out<F: FieldIn<f64>>(
        &mut self,
        field: &F,
        [start, length]: [f64; 2],
        x: &[f64],
        p: &[f64],
        course: &mut Course,
    ) -> Result<(), FlowError> {
        let evaluations = Cell::new(0);
        let motion = Motion { field, start, length, p, evaluations: &evaluations };
        self.resize(field, x, p);
        self.inside(&motion, 0.0)?;
        let h = self.first_step(&motion)?;
        let slope = self.buffers.stages.slope(0);
        let slope = slope.iter().map(|slope| slope / length);
        course.begin([start, length], h, x, slope, &self.settings);
        course.statistics.evaluations = evaluations.get();
        Ok(())
    }

    /// Shows the step of one lane as if it were of this flow. What is known exactly then is the state at its end.
    pub(in crate::core) fn show_lane<F: FieldIn<f64>>(
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
        buffers.scales.clear();
        buffers.scales.resize(n, 1.0);
        buffers.stages.resize(n);
        buffers.partial.resize(n);
        let known = abreast.slopes(n).iter().map(|slope| slope.each()[lane] / h);
        buffers.stages.slopes.iter_mut().zip(known).for_each(|(to, from)| *to = from);
        for (to, from) in buffers.stages.end.iter_mut().zip(&abreast.stages.end) {
            *to = from.each()[lane];
        }
        // The end of the step, as if it had been asked for.
        let first = scheme.tableau().map_or(0, |tableau| tableau.end() * n);
        buffers.partial.end.clone_from(&buffers.stages.end);
        buffers.slopes.clear();
        buffers.slopes.extend_from_slice(&buffers.stages.slopes[first..first + n]);
        let known = Known::at(1.0);
        observe(&mut Step { motion, scheme, tolerance, sigma, h, buffers, known });
        course.statistics.evaluations += evaluations.get();
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
    pub fn attempt<F: FieldIn<Lanes>>(&mut self, field: &F, settings: &Settings) -> [f64; LANES] {
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
    pub fn outlook<W: WatchIn<Dual<Lanes>>>(&self, watch: &W) -> Outlook {
        let [time, length] = [self.time, self.length].map(Lanes::from);
        let [start, end] = [0, 1].map(|end| {
            let time = Dual::new(time + length * end as f64, length);
            watch.value_in(time, &self.dual_x[end], &self.dual_p)
        });
        Outlook::of([start, end])
    }

    /// Accepts the step of a lane with this error.
    pub fn accept(&self, lane: usize, error: f64, course: &mut Course) {
        let (n, (h, last)) = (course.x.len(), course.step());
        let slopes = &self.stages.slopes[self.tableau.end() * n..];
        let length = self.length[lane];
        let end = self.stages.end.iter().map(|end| end.each()[lane]);
        course.x.iter_mut().zip(end).for_each(|(x, end)| *x = end);
        for (to, slope) in course.slope.iter_mut().zip(slopes) {
            *to = slope.each()[lane] / length;
        }
        course.sigma = if last { 1.0 } else { course.sigma + h };
        course.accept(h, error);
    }

    /// How many evaluations of the field a step takes.
    pub fn cost(&self) -> usize {
        self.tableau.end()
    }
}

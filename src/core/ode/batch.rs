//! One step each of several flows of one field, abreast in the lanes of a vector register.
//!
//! Every flow has its own place, step and parameters. What the step of one of them means is decided
//! for it alone: here steps are tried, and watched functions are seen to keep clear of zero, which
//! is nearly all of the work.

use super::forecast::EventForecast;
use super::integrate::Flow;
use super::lane_state::LaneState;
use super::lanes::{InLanes, LANES, Lanes};
use super::motion::Motion;
use super::settings::Settings;
use super::stages::Stages;
use super::step::{Known, Step};
use super::tableau::{Row, Tableau};
use crate::core::failure::FlowError;
use crate::core::linalg::refill;
use crate::core::problem::{FieldIn, WatchIn};
use num_dual::{Dual, DualNum};
use num_traits::Signed;
use std::cell::Cell;

impl<T: InLanes> Flow<T> {
    /// Sets out on a lane_state.
    ///
    /// # Errors
    /// [`FlowError`] if the state is outside the domain of the field.
    pub(in crate::core) fn set_out<F: FieldIn<T>>(
        &mut self,
        field: &F,
        [start, length]: [T; 2],
        x: &[T],
        p: &[T],
        lane_state: &mut LaneState<T>,
    ) -> Result<(), FlowError> {
        let evaluations = Cell::new(0);
        let motion = Motion { field, start, length, p, evaluations: &evaluations };
        self.resize(field, x, p);
        self.inside(&motion, 0.0)?;
        let h = self.first_step(&motion)?;
        let slope = self.buffers.stages.slope(0);
        let slope = slope.iter().map(|slope| *slope / length);
        lane_state.begin([start, length], h, x, slope, &self.settings);
        lane_state.statistics.evaluations = evaluations.get();
        Ok(())
    }

    /// Shows the step of one lane as if it were of this flow. What is known exactly then is the
    /// state at its end.
    pub(in crate::core) fn show_lane<F: FieldIn<T>>(
        &mut self,
        field: &F,
        p: &[T],
        (abreast, lane, lane_state): (&BatchStepper<T>, usize, &mut LaneState<T>),
        observe: impl FnOnce(&mut Step<F, T>),
    ) {
        let LaneState { start, length, sigma, .. } = *lane_state;
        let (h, _) = lane_state.step();
        let (n, evaluations) = (lane_state.x.len(), Cell::new(0));
        let motion = &Motion { field, start, length, p, evaluations: &evaluations };
        let (scheme, tolerance) = (self.settings.scheme, self.settings.absolute);
        let buffers = &mut self.buffers;
        lane_state.x.clone_into(&mut buffers.x);
        buffers.scales.clear();
        buffers.scales.resize(n, 1.0);
        buffers.stages.resize(n);
        buffers.partial.resize(n);
        let known = abreast.slopes(n).iter().map(|slope| T::lane(slope, lane) / h);
        buffers.stages.slopes.iter_mut().zip(known).for_each(|(to, from)| *to = from);
        for (to, from) in buffers.stages.end.iter_mut().zip(&abreast.stages.end) {
            *to = T::lane(from, lane);
        }
        // The end of the step, as if it had been asked for.
        let first = scheme.tableau().map_or(0, |tableau| tableau.end() * n);
        buffers.partial.end.clone_from(&buffers.stages.end);
        buffers.stages.slopes[first..first + n].clone_into(&mut buffers.slopes);
        let known = Known::at(1.0);
        observe(&mut Step { motion, scheme, tolerance, sigma, h, buffers, known });
        lane_state.statistics.evaluations += evaluations.get();
    }
}

/// Flows abreast, in one step.
pub(in crate::core) struct BatchStepper<T: InLanes> {
    tableau: &'static Tableau,
    /// Whose parameters stand in the lanes, and whether any have come since the last step.
    occupants: [usize; LANES],
    renewed: bool,
    /// States, slopes, parameters, times and durations of the step as they are given, lane by lane.
    given: [Vec<[T; LANES]>; 3],
    time: [T; LANES],
    length: [T; LANES],
    x: Vec<T::Wide>,
    p: Vec<T::Wide>,
    stages: Stages<T::Wide>,
    /// What watched functions see.
    dual_x: [Vec<Dual<Lanes>>; 2],
    dual_p: Vec<Dual<Lanes>>,
    dual_time: [Dual<Lanes>; 2],
}

impl<T: InLanes> BatchStepper<T> {
    /// Flows abreast, by an explicit method.
    pub fn new(settings: &Settings) -> Option<Self> {
        Some(BatchStepper {
            tableau: settings.scheme.tableau()?,
            occupants: [usize::MAX; LANES],
            renewed: true,
            given: Default::default(),
            time: [T::zero(); LANES],
            length: [T::zero(); LANES],
            x: Vec::new(),
            p: Vec::new(),
            stages: Stages::default(),
            dual_x: Default::default(),
            dual_p: Vec::new(),
            dual_time: [Dual::from_re(Lanes::splat(0.0)); 2],
        })
    }

    /// Forgets whose parameters stand in the lanes: numbers of occupants are given anew.
    pub fn vacate(&mut self) {
        self.occupants = [usize::MAX; LANES];
    }

    /// Puts a flow into a lane, with the number of its occupant, whose parameters stay the same.
    /// Lanes that stay empty need one all the same.
    pub fn load(&mut self, lane: usize, lane_state: &LaneState<T>, (occupant, p): (usize, &[T])) {
        let put = |to: &mut Vec<[T; LANES]>, from: &[T]| {
            to.resize(from.len(), [T::zero(); LANES]);
            to.iter_mut().zip(from).for_each(|(to, from)| to[lane] = *from);
        };
        let [x, slope, parameters] = &mut self.given;
        put(x, &lane_state.x);
        put(slope, &lane_state.slope);
        if self.occupants[lane] != occupant {
            put(parameters, p);
            (self.occupants[lane], self.renewed) = (occupant, true);
        }
        self.time[lane] = lane_state.start + lane_state.length * lane_state.sigma;
        self.length[lane] = lane_state.length * lane_state.step().0;
    }

    /// All slopes, in units of the step, of `n` states.
    fn slopes(&self, n: usize) -> &[T::Wide] {
        &self.stages.slopes[..(self.tableau.end() + 1) * n]
    }

    /// Tries a step in every lane and returns the errors, in units of the tolerance.
    pub fn attempt<F: FieldIn<T::Wide>>(&mut self, field: &F, settings: &Settings) -> [f64; LANES] {
        let BatchStepper { tableau, renewed, given, time, length, x, p, stages, dual_p, .. } = self;
        let (start, length) = (T::gather(*time), T::gather(*length));
        let evaluations = &Cell::new(0);
        refill(x, given[0].iter().map(|x| T::gather(*x)));
        if std::mem::take(renewed) {
            refill(p, given[2].iter().map(|p| T::gather(*p)));
            refill(dual_p, p.iter().map(|p| Dual::from_re(T::reals(p))));
        }
        stages.resize(x.len());
        for (to, slope) in stages.slopes.iter_mut().zip(&given[1]) {
            *to = T::gather(*slope) * length;
        }
        let motion = Motion { field, start, length, p, evaluations };
        stages.advance(tableau, &motion, (0.0, 1.0), x);
        stages.end_slope(tableau.end(), &motion, 1.0);
        self.errors(settings)
    }

    /// The errors, as [`Measure::explicit_error`](super::control::Measure::explicit_error) has
    /// them.
    fn errors(&self, settings: &Settings) -> [f64; LANES] {
        let (n, slopes, mut squares) = (self.x.len(), &self.stages.slopes, [Lanes::splat(0.0); 2]);
        for (i, (x, end)) in self.x.iter().zip(&self.stages.end).enumerate() {
            let [x, end] = [x, end].map(|x| T::reals(x).abs());
            let tolerated = x.most(end) * settings.relative + settings.absolute;
            let scale = Lanes::splat(1.0) / tolerated;
            let sum = |row: Row| {
                let terms = row.iter().map(|(j, e)| T::reals(&slopes[j * n + i]) * *e);
                terms.fold(Lanes::splat(0.0), |sum, term| sum + term) * scale
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
            return (fine / n).sqrt().each();
        }
        // Where both vanish, so does the error.
        let together = (fine + rough * 0.01).most(Lanes::splat(f64::MIN_POSITIVE));
        (fine / (together * n).sqrt()).each()
    }

    /// Prepares what watched functions see.
    pub fn look(&mut self) {
        let (n, end) = (self.x.len(), self.tableau.end());
        let ends = [(&self.x, 0), (&self.stages.end, end)];
        for (dual, (x, stage)) in self.dual_x.iter_mut().zip(ends) {
            let slopes = &self.stages.slopes[stage * n..(stage + 1) * n];
            dual.clear();
            let moving = x.iter().zip(slopes);
            dual.extend(moving.map(|(x, slope)| Dual::new(T::reals(x), T::reals(slope))));
        }
        let time: [f64; LANES] = std::array::from_fn(|lane| self.time[lane].real());
        let length: [f64; LANES] = std::array::from_fn(|lane| self.length[lane].real());
        let (time, length) = (Lanes::from(time), Lanes::from(length));
        self.dual_time = [Dual::new(time, length), Dual::new(time + length, length)];
    }

    /// What can be said about a watched function from its values and slopes at both ends.
    pub fn forecast<W: WatchIn<Dual<Lanes>>>(&self, watch: &W) -> EventForecast {
        let [start, end] = &self.dual_time;
        let start = watch.value_in(*start, &self.dual_x[0], &self.dual_p);
        let end = watch.value_in(*end, &self.dual_x[1], &self.dual_p);
        EventForecast::of(start, end)
    }

    /// Accepts the step of a lane with this error.
    pub fn accept(&self, lane: usize, error: f64, lane_state: &mut LaneState<T>) {
        let (n, (h, last)) = (lane_state.x.len(), lane_state.step());
        let slopes = &self.stages.slopes[self.tableau.end() * n..];
        let rate = T::one() / self.length[lane];
        let end = self.stages.end.iter().map(|end| T::lane(end, lane));
        lane_state.x.iter_mut().zip(end).for_each(|(x, end)| *x = end);
        for (to, slope) in lane_state.slope.iter_mut().zip(slopes) {
            *to = T::lane(slope, lane) * rate;
        }
        lane_state.sigma = if last { 1.0 } else { lane_state.sigma + h };
        lane_state.accept(h, error);
    }

    /// How many evaluations of the field a step takes.
    pub fn cost(&self) -> usize {
        self.tableau.end()
    }
}

//! Batched steps: several flows of one vector field are advanced together, each by one step, in the
//! lanes of a vector register.
//!
//! Every flow in the batch has its own state, step length and parameters. This module computes the
//! steps, their errors, and bounds which show that watched functions do not vanish in a step; these
//! computations are nearly all of the work. Each flow of the batch decides separately whether to
//! accept its step.

use super::forecast::EventForecast;
use super::integrate::Flow;
use super::lane_state::LaneState;
use super::motion::Motion;
use super::settings::Settings;
use super::stages::Stages;
use super::step::{Known, Step};
use super::tableau::Tableau;
use crate::core::failure::FlowError;
use crate::core::linalg::refill;
use crate::core::problem::{FieldIn, WatchIn};
use crate::core::scalar::{DualLanes, InLanes, Lanes, MOST_LANES, Register, Scalar};
use fearless_simd::{Level, Simd};
use num_dual::DualNum;
use num_traits::Signed;
use std::cell::Cell;

impl<T: Scalar> Flow<T> {
    /// Starts a flow whose state between steps is stored in `lane_state`.
    ///
    /// # Errors
    /// [`FlowError`] if the state is outside the domain of the vector field.
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

    /// Passes the step that was computed in one lane to `observe`, as if it were a step of this
    /// flow. The state at the end of the passed step is marked as known exactly.
    pub(in crate::core) fn show_lane<F: FieldIn<T>>(
        &mut self,
        field: &F,
        p: &[T],
        (abreast, lane, lane_state): (&(impl LaneSteps<T> + ?Sized), usize, &mut LaneState<T>),
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
        let Stages { slopes, end, .. } = &mut buffers.stages;
        abreast.show(lane, h, slopes, end);
        // The state at the end of the passed step is marked as known exactly.
        let first = scheme.tableau().map_or(0, |tableau| tableau.end() * n);
        buffers.partial.end.clone_from(&buffers.stages.end);
        buffers.stages.slopes[first..first + n].clone_into(&mut buffers.slopes);
        let known = Known::at(1.0);
        observe(&mut Step { motion, scheme, tolerance, sigma, h, buffers, known });
        lane_state.statistics.evaluations += evaluations.get();
    }
}

/// A batched step for registers of any width, with access to the flow in each lane.
pub trait LaneSteps<T> {
    /// Returns the number of flows in the batch.
    fn lanes(&self) -> usize;

    /// Returns the number of evaluations of the vector field in a step.
    fn cost(&self) -> usize;

    /// Marks the parameters in all lanes as unknown; called when the flows are renumbered.
    fn vacate(&mut self);

    /// Loads a flow into a lane. The occupant number identifies the flow's parameters: flows with
    /// the same number must have the same parameters. Unused lanes must also be loaded with a flow.
    fn load(&mut self, lane: usize, lane_state: &LaneState<T>, occupant: (usize, &[T]));

    /// Writes the derivatives `k_j` at all stages of a lane's step, divided by `h`, and the state
    /// at the end of the step.
    fn show(&self, lane: usize, h: f64, slopes: &mut [T], end: &mut [T]);

    /// Accepts the step of a lane, whose error is given.
    fn accept(&self, lane: usize, error: f64, lane_state: &mut LaneState<T>);
}

/// A batch of flows in the lanes of registers of type `R`, which takes one step.
pub(in crate::core) struct BatchStepper<T: InLanes<R>, R: Register> {
    tableau: &'static Tableau,
    /// The occupant number in each lane, which identifies the flow whose parameters are in the
    /// lane, and whether any of these numbers is new.
    occupants: [usize; MOST_LANES],
    renewed: bool,
    /// The inputs of the step, lane by lane: states, time derivatives, parameters, times and
    /// durations.
    given: [Vec<[T; MOST_LANES]>; 3],
    time: [T; MOST_LANES],
    length: [T; MOST_LANES],
    x: Vec<T::Wide>,
    p: Vec<T::Wide>,
    stages: Stages<T::Wide>,
    /// The arguments at which watched functions are evaluated.
    dual_x: [Vec<DualLanes<R>>; 2],
    dual_p: Vec<DualLanes<R>>,
    dual_time: [DualLanes<R>; 2],
}

impl<T: InLanes<R>, R: Register> BatchStepper<T, R> {
    /// Creates a batch for an explicit method; `None` if the processor does not have registers of
    /// this width.
    pub fn new(settings: &Settings) -> Option<Self> {
        R::of(Level::new())?;
        Some(BatchStepper {
            tableau: settings.scheme.tableau()?,
            occupants: [usize::MAX; MOST_LANES],
            renewed: true,
            given: Default::default(),
            time: [T::zero(); MOST_LANES],
            length: [T::zero(); MOST_LANES],
            x: Vec::new(),
            p: Vec::new(),
            stages: Stages::default(),
            dual_x: Default::default(),
            dual_p: Vec::new(),
            dual_time: [DualLanes::of(Lanes::splat(0.0)); 2],
        })
    }

    /// Tries a step in every lane and returns the errors of all lanes, in units of the tolerance.
    /// After the step, watched functions can be evaluated.
    pub fn attempt<F: FieldIn<T::Wide>>(
        &mut self,
        field: &F,
        settings: &Settings,
    ) -> [f64; MOST_LANES] {
        R::instructions().vectorize(
            #[inline(always)]
            || {
                self.advance(field);
                self.look();
                self.errors(settings)
            },
        )
    }

    /// Computes the step.
    #[inline(always)]
    fn advance<F: FieldIn<T::Wide>>(&mut self, field: &F) {
        let BatchStepper { tableau, renewed, given, time, length, x, p, stages, dual_p, .. } = self;
        let (start, length) = (T::gather(time), T::gather(length));
        let evaluations = &Cell::new(0);
        refill(x, given[0].iter().map(T::gather));
        if std::mem::take(renewed) {
            refill(p, given[2].iter().map(T::gather));
            refill(dual_p, p.iter().map(|p| DualLanes::of(T::reals(p))));
        }
        stages.resize(x.len());
        for (to, slope) in stages.slopes.iter_mut().zip(&given[1]) {
            *to = T::gather(slope) * length;
        }
        let motion = Motion { field, start, length, p, evaluations };
        stages.advance_inline(tableau, &motion, (0.0, 1.0), x);
        stages.end_slope(tableau.end(), &motion, 1.0);
    }

    /// Computes the errors of all lanes by the formula of
    /// [`Measure::explicit_error`](super::control::Measure::explicit_error).
    #[inline(always)]
    fn errors(&self, settings: &Settings) -> [f64; MOST_LANES] {
        let (n, slopes, mut squares) = (self.x.len(), &self.stages.slopes, [Lanes::splat(0.0); 2]);
        for (i, (x, end)) in self.x.iter().zip(&self.stages.end).enumerate() {
            let largest = T::reals(x).abs().most(T::reals(end).abs());
            let scale = Lanes::splat(1.0) / (largest * settings.relative + settings.absolute);
            let rows = [self.tableau.error, self.tableau.rough_error];
            for (square, row) in squares.iter_mut().zip(rows) {
                // Loops replace closures, which are not inlined everywhere.
                let mut error = Lanes::splat(0.0);
                for (j, e) in row {
                    error += T::reals(&slopes[j * n + i]) * *e;
                }
                error *= scale;
                *square += error * error;
            }
        }
        let ([fine, rough], n) = (squares, n as f64);
        if self.tableau.rough_error.is_empty() {
            return (fine / n).sqrt().each();
        }
        // If both estimates vanish, so does the error.
        let together = (fine + rough * 0.01).most(Lanes::splat(f64::MIN_POSITIVE));
        (fine / (together * n).sqrt()).each()
    }

    /// Prepares the arguments at which watched functions are evaluated.
    #[inline(always)]
    fn look(&mut self) {
        let (n, end) = (self.x.len(), self.tableau.end());
        let ends = [(&self.x, 0), (&self.stages.end, end)];
        for (dual, (x, stage)) in self.dual_x.iter_mut().zip(ends) {
            let slopes = &self.stages.slopes[stage * n..(stage + 1) * n];
            dual.clear();
            let moving = x.iter().zip(slopes);
            dual.extend(
                moving.map(|(x, slope)| DualLanes { re: T::reals(x), eps: [T::reals(slope)] }),
            );
        }
        let [time, length] =
            [&self.time, &self.length].map(|lanes| Lanes::from(&lanes.map(|lane| lane.real())));
        self.dual_time = [time, time + length].map(|re| DualLanes { re, eps: [length] });
    }

    /// Computes the forecast for a watched function from its values and derivatives at both ends of
    /// the step.
    pub fn forecast<W: WatchIn<DualLanes<R>>>(&self, watch: &W) -> EventForecast {
        R::instructions().vectorize(
            #[inline(always)]
            || {
                let [start, end] = &self.dual_time;
                let start = watch.value_in(*start, &self.dual_x[0], &self.dual_p);
                let end = watch.value_in(*end, &self.dual_x[1], &self.dual_p);
                EventForecast::of(start, end)
            },
        )
    }
}

impl<T: InLanes<R>, R: Register> LaneSteps<T> for BatchStepper<T, R> {
    fn lanes(&self) -> usize {
        R::LANES
    }

    fn cost(&self) -> usize {
        self.tableau.end()
    }

    fn vacate(&mut self) {
        self.occupants = [usize::MAX; MOST_LANES];
    }

    fn load(&mut self, lane: usize, lane_state: &LaneState<T>, (occupant, p): (usize, &[T])) {
        let put = |to: &mut Vec<[T; MOST_LANES]>, from: &[T]| {
            to.resize(from.len(), [T::zero(); MOST_LANES]);
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

    fn show(&self, lane: usize, h: f64, slopes: &mut [T], end: &mut [T]) {
        let known = &self.stages.slopes[..(self.tableau.end() + 1) * end.len()];
        for (to, slope) in slopes.iter_mut().zip(known) {
            *to = T::lane(slope, lane) / h;
        }
        for (to, end) in end.iter_mut().zip(&self.stages.end) {
            *to = T::lane(end, lane);
        }
    }

    fn accept(&self, lane: usize, error: f64, lane_state: &mut LaneState<T>) {
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
}

//! The actions for the simulated motions between batched integration steps.

use super::slot::{Next, Outcome, Slot};
use super::{Fleet, FleetNumber, FleetObserver};
use crate::core::hybrid::chatter::Series;
use crate::core::hybrid::crowding::Crowd;
use crate::core::hybrid::erased::HybridEquations;
use crate::core::hybrid::error::HybridError;
use crate::core::hybrid::event::{Event, HybridObserver};
use crate::core::hybrid::event_locator::{EventLocator, LocatedEvent};
use crate::core::hybrid::leg::GuardOf;
use crate::core::hybrid::scales::{time_scale, without_scales};
use crate::core::hybrid::simulation::{HybridFlow, HybridState, HybridStatistics, Run, sum};
use crate::core::linalg::refill;
use crate::core::ode::{Reached, Sign, Step};
use crate::core::problem::{FieldIn, FieldRef, Watchable};
use crate::core::scalar::{MOST_LANES, Scalar};
use std::ops::ControlFlow;

/// An adapter that passes the integration steps and events of one motion to the observer.
struct Shown<'a, O>(usize, &'a mut O);

impl<T: Scalar, O: FleetObserver<T>> HybridObserver<T> for Shown<'_, O> {
    fn step<F: FieldIn<T>>(&mut self, mode: usize, step: &mut Step<F, T>, end: T) {
        self.1.step(self.0, mode, step, end);
    }

    fn event(&mut self, event: &Event<T>) -> ControlFlow<()> {
        self.1.event(self.0, event);
        ControlFlow::Continue(())
    }
}

impl<'a, T: FleetNumber> Fleet<'a, T>
where
    GuardOf<'a>: Watchable<T>,
{
    /// Performs the actions for a motion that are not batched, until its next batched step.
    pub(super) fn go(
        &mut self,
        number: usize,
        next: Next,
        observer: &mut impl FleetObserver<T>,
    ) -> Outcome {
        let mut next = next;
        loop {
            let slot = &mut self.slots[number];
            next = match next {
                Next::Start => {
                    let (time, duration) = (slot.state.time, slot.duration);
                    (slot.end, slot.crowd) = (time + duration, Crowd::from(time.real()));
                    slot.statistics = HybridStatistics::default();
                    self.work(number, observer, |worker, state, run| {
                        worker.begin(state, duration, run.p)
                    })?;
                    Next::Leg
                }
                Next::Leg if self.is_over(number, observer)? => Next::Finish,
                Next::Leg if !self.sets_out(number) => Next::Alone,
                Next::Leg => return Ok(ControlFlow::Continue(())),
                Next::Alone => self.work(number, observer, |worker, state, run| {
                    let Some(landing) = worker.leg(state, run)? else { return Ok(Next::Finish) };
                    worker.land(landing, state, run).map(|_| Next::Leg)
                })?,
                Next::Finish => {
                    let Slot { member, state, p, statistics, .. } = &mut self.slots[number];
                    self.worker.constrain(state, p);
                    if observer.arrived(*member, state, statistics).is_break() {
                        return Ok(ControlFlow::Break(()));
                    }
                    Next::Start
                }
            };
        }
    }

    /// Runs an action for a motion with the solver that simulates single motions.
    fn work<O: FleetObserver<T>, R>(
        &mut self,
        number: usize,
        observer: &mut O,
        act: impl FnOnce(
            &mut HybridFlow<'a, T>,
            &mut HybridState<T>,
            &mut Run<T, Shown<O>>,
        ) -> Result<R, HybridError>,
    ) -> Result<R, HybridError> {
        let (Fleet { worker, slots, .. }, shown) = (self, &mut Shown(0, observer));
        let Slot { member, state, p, real_p, end, statistics, crowd, series, pace, fired, .. } =
            &mut slots[number];
        if series.is_empty() {
            fired.clone_from(&worker.timed.fired);
            series.extend(worker.series.iter().map(|_| Series::new()));
        }
        std::mem::swap(&mut worker.series, series);
        std::mem::swap(&mut worker.timed.fired, fired);
        (worker.pace, worker.unit) = (*pace, time_scale(worker.system, real_p));
        worker.p.clone_from(real_p);
        shown.0 = *member;
        let mut run = Run { end: *end, p, observer: shown, statistics: *statistics, crowd: *crowd };
        let result = act(worker, state, &mut run);
        (*statistics, *crowd, *pace) = (run.statistics, run.crowd, worker.pace);
        std::mem::swap(&mut worker.series, series);
        std::mem::swap(&mut worker.timed.fired, fired);
        result
    }

    /// Whether the duration of a motion has passed.
    fn is_over(
        &mut self,
        number: usize,
        observer: &mut impl FleetObserver<T>,
    ) -> Result<bool, HybridError> {
        let Slot { state, end, .. } = &self.slots[number];
        if !self.worker.timed.end(state.mode) {
            return Ok(state.time.real() >= end.real());
        }
        self.work(number, observer, |worker, state, run| {
            Ok(worker.timed.is_over(worker.system, state.place(), run.end, run.p))
        })
    }

    /// Starts a leg of a motion (the part between two events) that is simulated in a batch; returns
    /// `false` if the leg cannot be batched.
    fn sets_out(&mut self, number: usize) -> bool {
        let Fleet { worker, stepper, slots, .. } = self;
        let Slot { state, p, real_p, end, pace, lane_state, signs, .. } = &mut slots[number];
        let (left, mode, system) = (*end - state.time, state.mode, worker.system);
        worker.pace = *pace;
        worker.p.clone_from(real_p);
        worker.prepare_leg(mode, left.real());
        signs.clear();
        signs.resize(worker.watched[mode].len(), Sign::Unknown);
        let (field, span) = (T::in_mode(system, mode, T::zero()), [state.time, left]);
        // In batches all scales are 1, and there are no events at given times.
        let usual = without_scales(system, real_p) && !worker.timed.end(mode);
        stepper.is_some()
            && usual
            && worker.flow.set_out(&field, span, &state.x, p, lane_state).is_ok()
    }

    /// Tries an integration step of several motions in one mode.
    pub(super) fn attempt(&mut self, mode: usize, abreast: &[usize]) -> [f64; MOST_LANES] {
        let Fleet { worker, stepper, forecasts, slots, .. } = self;
        let Some(stepper) = stepper else { return [f64::NAN; MOST_LANES] };
        for lane in 0..stepper.lanes() {
            let slot = &slots[abreast[lane.min(abreast.len() - 1)]];
            stepper.load(lane, &slot.lane_state, (slot.member, &slot.p));
        }
        let (guards, settings) = (&worker.watched[mode], &worker.settings.flow);
        stepper.attempt((worker.system, mode), guards, settings, forecasts)
    }

    /// Evaluates the integration step of a lane: accepts or rejects the step, and detects the end
    /// of the leg (the part of the motion between two events).
    pub(super) fn classify(
        &mut self,
        mode: usize,
        (lane, number): (usize, usize),
        error: f64,
        observer: &mut impl FleetObserver<T>,
    ) -> Outcome {
        let Some(stepper) = &self.stepper else { return self.go(number, Next::Alone, observer) };
        let Slot { lane_state, .. } = &mut self.slots[number];
        lane_state.statistics.evaluations += stepper.cost();
        if error.is_nan() || error > 1.0 {
            let most = self.worker.settings.flow.max_steps;
            // A separate simulation of the leg reports why it cannot continue.
            return match lane_state.reject(error).is_some() && lane_state.steps() <= most {
                true => Ok(ControlFlow::Continue(())),
                false => self.go(number, Next::Alone, observer),
            };
        }
        let ControlFlow::Continue(landing) = self.landing(mode, (lane, number)) else {
            return Ok(ControlFlow::Continue(()));
        };
        if observer.sees_steps() {
            let end = landing.as_ref().map_or(T::one(), |landing| landing.root.fraction);
            self.show(mode, (lane, number), end, observer);
        }
        let Slot { lane_state, statistics, .. } = &mut self.slots[number];
        self.stepper.iter().for_each(|stepper| stepper.accept(lane, error, lane_state));
        let Some(landing) = landing else { return self.go_on(mode, number, observer) };
        statistics.flow = sum(statistics.flow, lane_state.statistics);
        self.work(number, observer, |worker, state, run| {
            worker.land(landing, state, run).map(|_| ())
        })?;
        self.go(number, Next::Leg, observer)
    }

    /// Returns the end of a lane's leg if it lies in the lane's integration step, and `None`
    /// otherwise; returns `Break` if a shorter step is needed.
    fn landing(
        &mut self,
        mode: usize,
        of: (usize, usize),
    ) -> ControlFlow<(), Option<LocatedEvent<T>>> {
        let (lane, number) = of;
        let Slot { lane_state, .. } = &mut self.slots[number];
        if lane_state.aims() {
            return match lane_state.reached(&self.forecasts, lane) {
                Some(reached) => ControlFlow::Continue(self.reach(mode, of, reached)),
                None => ControlFlow::Break(()),
            };
        }
        self.screen(lane, number);
        match (self.candidates.len(), self.candidates.first().copied()) {
            (1, Some(watched)) if self.aim(watched, lane, number) => ControlFlow::Break(()),
            (0, _) => ControlFlow::Continue(None),
            _ => ControlFlow::Continue(self.look_at(mode, of)),
        }
    }

    /// Continues the motion of a lane after an accepted step in which its leg does not end.
    fn go_on(
        &mut self,
        mode: usize,
        number: usize,
        observer: &mut impl FleetObserver<T>,
    ) -> Outcome {
        let HybridFlow { system, settings, x, .. } = &mut self.worker;
        let Slot { lane_state, real_p, state, statistics, end, .. } = &mut self.slots[number];
        refill(x, lane_state.state().iter().map(T::real));
        let leaves =
            || x.iter().any(|x| !x.is_finite()) || system.domain_of(mode, x, real_p).is_err();
        if lane_state.steps() > settings.flow.max_steps || leaves() {
            return self.go(number, Next::Alone, observer);
        }
        if !lane_state.is_over() {
            return Ok(ControlFlow::Continue(()));
        }
        statistics.flow = sum(statistics.flow, lane_state.statistics);
        state.time = *end;
        lane_state.state().clone_into(&mut state.x);
        self.go(number, Next::Finish, observer)
    }

    /// Passes the integration step of a lane, up to the given fraction, to the observer.
    fn show(
        &mut self,
        mode: usize,
        (lane, number): (usize, usize),
        end: T,
        observer: &mut impl FleetObserver<T>,
    ) {
        let Fleet { worker: HybridFlow { system, flow, .. }, stepper, slots, .. } = self;
        let Slot { member, p, lane_state, .. } = &mut slots[number];
        if let Some(stepper) = stepper {
            let field = T::in_mode(*system, mode, T::zero());
            flow.show_lane(&field, p, (&**stepper, lane, lane_state), |step| {
                observer.step(*member, mode, step, end);
            });
        }
    }

    /// Selects the guards that can vanish in the step of a lane, by their indices in their mode.
    fn screen(&mut self, lane: usize, number: usize) {
        let Fleet { forecasts, candidates, slots, .. } = self;
        candidates.clear();
        let signs = &mut slots[number].signs;
        for (watched, (sign, forecast)) in signs.iter_mut().zip(forecasts).enumerate() {
            if forecast.is_quiet(lane, *sign) {
                *sign = Sign::Positive;
            } else {
                candidates.push(watched);
            }
        }
    }

    /// Shortens the next step of a lane so that it ends at the zero of a guard, if that zero is
    /// unique.
    fn aim(&mut self, watched: usize, lane: usize, number: usize) -> bool {
        let Slot { lane_state, .. } = &mut self.slots[number];
        lane_state.aim(watched, &self.forecasts[watched], lane).is_some()
    }

    /// Searches for the end of a leg (the part of a motion between two events) in the step of one
    /// lane, with the solver that simulates single motions.
    fn look<R>(
        &mut self,
        mode: usize,
        (lane, number): (usize, usize),
        find: impl FnOnce(&mut EventLocator<'_, 'a, T>, &mut Step<FieldRef<T>, T>) -> Option<R>,
    ) -> Option<R> {
        let Fleet { worker, stepper, candidates, slots, .. } = self;
        let Slot { state, p, real_p, end, lane_state, signs, pace, .. } = &mut slots[number];
        let HybridFlow { system, flow, roots, scales, event, watched, .. } = worker;
        let system: &dyn HybridEquations = *system;
        scales.fill(1.0);
        watched[mode].iter().zip(&*signs).for_each(|(guard, sign)| roots[*guard].resume(*sign));
        event.before.clone_from(&state.x);
        let leg = (state.time, *end - state.time);
        let mut locator = EventLocator {
            system,
            mode,
            watched: candidates,
            roots,
            scales,
            event,
            pace,
            p: real_p,
            unit: time_scale(system, real_p),
            leg,
        };
        let (mut found, stepper) = (None, stepper.as_ref()?);
        let field = T::in_mode(system, mode, T::zero());
        flow.show_lane(&field, p, (&**stepper, lane, lane_state), |step| {
            found = find(&mut locator, step);
        });
        watched[mode].iter().zip(signs).for_each(|(guard, sign)| *sign = roots[*guard].sign());
        found
    }

    /// Locates the end of a leg (the part of a motion between two events) in the step of one lane.
    fn look_at(&mut self, mode: usize, of: (usize, usize)) -> Option<LocatedEvent<T>> {
        let guards = &self.worker.watched[mode];
        self.candidates.iter_mut().for_each(|watched| *watched = guards[*watched]);
        self.look(mode, of, |locator, step| locator.locate(step))
    }

    /// Ends the leg of one lane whose integration step was chosen to end at the zero of a guard.
    fn reach(
        &mut self,
        mode: usize,
        of: (usize, usize),
        Reached { watched, fraction, whole }: Reached,
    ) -> Option<LocatedEvent<T>> {
        let guard = self.worker.watched[mode][watched];
        self.look(mode, of, |locator, step| locator.reach(step, (guard, fraction), whole))
    }
}

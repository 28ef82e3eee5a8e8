//! What is done with members between steps abreast.

use super::berth::{Berth, Next, Outcome};
use super::{Fleet, FleetObserver};
use crate::core::flow::{LANES, Lanes, Reached, Sign, Step};
use crate::core::hybrid::chatter::Series;
use crate::core::hybrid::erased::{FieldNumber, HybridEquations};
use crate::core::hybrid::error::HybridError;
use crate::core::hybrid::event::{Event, HybridObserver};
use crate::core::hybrid::landing::{Landing, Lookout};
use crate::core::hybrid::leg::GuardOf;
use crate::core::hybrid::scales::time_scale;
use crate::core::hybrid::simulation::{HybridFlow, HybridState, HybridStatistics, Run, sum};
use crate::core::scalar_field::FieldRef;
use std::ops::ControlFlow;

/// Shows the events of one member.
struct Shown<'a, O>(usize, &'a mut O);

impl<O: FleetObserver> HybridObserver<f64> for Shown<'_, O> {
    fn event(&mut self, event: &Event<f64>) -> ControlFlow<()> {
        self.1.event(self.0, event);
        ControlFlow::Continue(())
    }
}

impl Fleet<'_> {
    /// Does with a member what is not done abreast.
    pub(super) fn go(
        &mut self,
        number: usize,
        next: Next,
        observer: &mut impl FleetObserver,
    ) -> Outcome {
        let mut next = next;
        loop {
            let berth = &mut self.berths[number];
            next = match next {
                Next::Depart => {
                    let (time, duration) = (berth.state.time, berth.duration);
                    (berth.end, berth.still) = (time + duration, (time, 0));
                    berth.statistics = HybridStatistics::default();
                    self.work(number, observer, |worker, state, run| {
                        worker.begin(state, duration, run.p)
                    })?;
                    Next::Leg
                }
                Next::Leg if berth.state.time >= berth.end => Next::Arrive,
                Next::Leg if !self.sets_out(number) => Next::Alone,
                Next::Leg => return Ok(ControlFlow::Continue(())),
                Next::Alone => self.work(number, observer, |worker, state, run| {
                    let Some(landing) = worker.leg(state, run)? else { return Ok(Next::Arrive) };
                    worker.land(landing, state, run).map(|_| Next::Leg)
                })?,
                Next::Arrive => {
                    let Berth { member, state, statistics, .. } = &mut self.berths[number];
                    if observer.arrived(*member, state, statistics).is_break() {
                        return Ok(ControlFlow::Break(()));
                    }
                    Next::Depart
                }
            };
        }
    }

    /// Lets the worker work for a member.
    fn work<O: FleetObserver, R>(
        &mut self,
        number: usize,
        observer: &mut O,
        act: impl FnOnce(
            &mut HybridFlow<f64>,
            &mut HybridState<f64>,
            &mut Run<f64, Shown<O>>,
        ) -> Result<R, HybridError>,
    ) -> Result<R, HybridError> {
        let (Fleet { worker, berths, .. }, shown) = (self, &mut Shown(0, observer));
        let Berth { member, state, p, end, statistics, still, series, pace, .. } =
            &mut berths[number];
        if series.is_empty() {
            series.extend(worker.series.iter().map(|_| Series::new()));
        }
        std::mem::swap(&mut worker.series, series);
        (worker.pace, worker.unit) = (*pace, time_scale(worker.system, p));
        worker.p.clone_from(p);
        shown.0 = *member;
        let mut run = Run { end: *end, p, observer: shown, statistics: *statistics, still: *still };
        let result = act(worker, state, &mut run);
        (*statistics, *still, *pace) = (run.statistics, run.still, worker.pace);
        std::mem::swap(&mut worker.series, series);
        result
    }

    /// Sets out on a leg abreast, if this member can.
    fn sets_out(&mut self, number: usize) -> bool {
        let Fleet { worker, abreast, berths, .. } = self;
        let Berth { state, p, end, pace, course, signs, .. } = &mut berths[number];
        let (left, mode, system) = (*end - state.time, state.mode, worker.system);
        worker.pace = *pace;
        worker.p.clone_from(p);
        worker.prepare_leg(left);
        signs.clear();
        signs.resize(worker.watched[mode].len(), Sign::Unknown);
        let (field, span) = (f64::in_mode(system, mode, 0.0, p), [state.time, left]);
        // Abreast, all scales are 1.
        let usual = time_scale(system, p) == 1.0 && system.scales_of(mode, p).is_empty();
        abreast.is_some() && usual && worker.flow.set_out(&field, span, &state.x, p, course).is_ok()
    }

    /// Tries a step of members in one mode.
    pub(super) fn attempt(&mut self, mode: usize, abreast: &[usize]) -> [f64; LANES] {
        let Fleet { worker, abreast: lanes, outlooks, berths, .. } = self;
        let Some(lanes) = lanes else { return [f64::NAN; LANES] };
        for lane in 0..LANES {
            let berth = &berths[abreast[lane.min(abreast.len() - 1)]];
            lanes.load(lane, &berth.course, &berth.p);
        }
        let system = worker.system;
        let field = Lanes::in_mode(system, mode, Lanes::splat(0.0), &[]);
        let errors = lanes.attempt(&field, &worker.settings.flow);
        lanes.look();
        outlooks.clear();
        let guards = worker.watched[mode].iter();
        outlooks.extend(
            guards.map(|guard| lanes.outlook(&GuardOf { system, guard: *guard, mode, scale: 1.0 })),
        );
        errors
    }

    /// Decides what the step of a lane means.
    pub(super) fn judge(
        &mut self,
        mode: usize,
        (lane, number): (usize, usize),
        error: f64,
        observer: &mut impl FleetObserver,
    ) -> Outcome {
        let (system, most) = (self.worker.system, self.worker.settings.flow.max_steps);
        let Some(abreast) = &self.abreast else { return self.go(number, Next::Alone, observer) };
        let Berth { course, .. } = &mut self.berths[number];
        course.statistics.evaluations += abreast.cost();
        let steps = course.statistics.accepted + course.statistics.rejected;
        if error.is_nan() || error > 1.0 {
            // What cannot go on is told by the flow of the leg alone.
            let again = course.reject(error).is_some() && steps < most;
            return if again {
                Ok(ControlFlow::Continue(()))
            } else {
                self.go(number, Next::Alone, observer)
            };
        }
        let landing = if course.aims() {
            let reached = course.reached(&self.outlooks, lane);
            let Some(reached) = reached else { return Ok(ControlFlow::Continue(())) };
            self.reach(mode, (lane, number), reached)
        } else {
            self.listen(lane, number);
            let only = if let [watched] = self.loud[..] { Some(watched) } else { None };
            if only.is_some_and(|watched| self.aim(watched, lane, number)) {
                return Ok(ControlFlow::Continue(()));
            }
            if self.loud.is_empty() { None } else { self.look_at(mode, (lane, number)) }
        };
        let Some(abreast) = &self.abreast else { return self.go(number, Next::Alone, observer) };
        let Berth { course, p, state, statistics, end, .. } = &mut self.berths[number];
        abreast.accept(lane, error, course);
        if let Some(landing) = landing {
            statistics.flow = sum(statistics.flow, course.statistics);
            self.work(number, observer, |worker, state, run| {
                worker.land(landing, state, run).map(|_| ())
            })?;
            return self.go(number, Next::Leg, observer);
        }
        let x = course.state();
        if steps >= most
            || x.iter().any(|x| !x.is_finite())
            || system.domain_of(mode, x, p).is_err()
        {
            return self.go(number, Next::Alone, observer);
        }
        if course.is_over() {
            statistics.flow = sum(statistics.flow, course.statistics);
            state.time = *end;
            state.x.clear();
            state.x.extend_from_slice(x);
            return self.go(number, Next::Arrive, observer);
        }
        Ok(ControlFlow::Continue(()))
    }

    /// Finds the guards, by their positions in their mode, that may vanish in the step of a lane.
    fn listen(&mut self, lane: usize, number: usize) {
        let Fleet { outlooks, loud, berths, .. } = self;
        loud.clear();
        let signs = &mut berths[number].signs;
        for (watched, (sign, outlook)) in signs.iter_mut().zip(outlooks).enumerate() {
            if outlook.is_quiet(lane, *sign) {
                *sign = Sign::Positive;
            } else {
                loud.push(watched);
            }
        }
    }

    /// Lets the next step of a lane go to where a guard vanishes, if it does so once.
    fn aim(&mut self, watched: usize, lane: usize, number: usize) -> bool {
        let Berth { course, .. } = &mut self.berths[number];
        course.aim(watched, &self.outlooks[watched], lane).is_some()
    }

    /// Lets a worker look for the end of a leg in the step of one lane.
    fn look<R>(
        &mut self,
        mode: usize,
        (lane, number): (usize, usize),
        find: impl FnOnce(&mut Lookout<f64>, &mut Step<FieldRef<f64>, f64>) -> Option<R>,
    ) -> Option<R> {
        let Fleet { worker, abreast, loud, berths, .. } = self;
        let Berth { state, p, end, course, signs, pace, .. } = &mut berths[number];
        let HybridFlow { system, flow, roots, event, watched, .. } = worker;
        let system: &dyn HybridEquations = *system;
        watched[mode].iter().zip(&*signs).for_each(|(guard, sign)| {
            roots[*guard].resume(GuardOf { system, guard: *guard, mode, scale: 1.0 }, *sign)
        });
        event.before.clone_from(&state.x);
        let leg = (state.time, *end - state.time);
        let mut lookout =
            Lookout { system, mode, watched: loud, roots, event, pace, p, unit: 1.0, leg };
        let (mut found, abreast) = (None, abreast.as_ref()?);
        let field = f64::in_mode(system, mode, 0.0, p);
        flow.show_lane(&field, p, (abreast, lane, course), |step| {
            found = find(&mut lookout, step);
        });
        watched[mode].iter().zip(signs).for_each(|(guard, sign)| *sign = roots[*guard].sign());
        found
    }

    /// Looks at the step of one lane for where its leg ends.
    fn look_at(&mut self, mode: usize, of: (usize, usize)) -> Option<Landing<f64>> {
        let guards = &self.worker.watched[mode];
        self.loud.iter_mut().for_each(|watched| *watched = guards[*watched]);
        self.look(mode, of, |lookout, step| lookout.landing(step))
    }

    /// Ends the leg of one lane at the root that its step went to.
    fn reach(
        &mut self,
        mode: usize,
        of: (usize, usize),
        Reached { watched, fraction, whole }: Reached,
    ) -> Option<Landing<f64>> {
        let guard = self.worker.watched[mode][watched];
        self.look(mode, of, |lookout, step| lookout.reach(step, (guard, fraction), whole))
    }
}

//! Records of one period of a motion: events and measures.

use super::error::StroboscopicError;
use crate::core::hybrid::{
    Event, GuardOf, HybridEquations, HybridObserver, HybridState, Mode, Passage, ScalarOf,
    virtual_point,
};
use crate::core::ode::{Extrema, Roots, Step};
use crate::core::problem::{
    Extremes, FieldIn, Integral, Measure, Observable, Opposite, Overall, WatchIn, larger, position,
};
use std::ops::ControlFlow;

/// An event in a recorded period of a motion.
#[derive(Clone, Debug, PartialEq)]
pub struct EventRecord {
    /// The number that identifies the event in [`Layout::events`].
    pub event: usize,
    /// The time of the event since the beginning of the period.
    pub time: f64,
    /// The state of the motion just before the event.
    pub before: HybridState<f64>,
    /// Whether the record represents infinitely many events that accumulate, instead of one event.
    pub accumulation: bool,
}

/// The record of one period of a motion.
#[derive(Clone, Debug, PartialEq)]
pub struct Period {
    /// The state at the beginning of the period.
    pub start: HybridState<f64>,
    /// The events in the period.
    pub events: Vec<EventRecord>,
    /// The values of the measures in the period.
    pub measures: Vec<f64>,
}

/// A leg (the part of a motion between two events): its mode, the guard of the event at its end,
/// and the states at its start and end.
struct Leg {
    mode: usize,
    exit: Option<usize>,
    start: Vec<f64>,
    end: Vec<f64>,
}

impl Leg {
    fn passage(&self) -> Passage<'_, f64> {
        let Leg { mode, exit, start, end } = self;
        Passage { mode: *mode, exit: *exit, start, end }
    }
}

/// The observable that represents a scalar in each mode of the system; `None` in modes that do not
/// define the scalar.
type InModes = Vec<Option<Observable>>;

/// A measure that is evaluated in every period.
#[derive(Clone)]
pub(super) enum Measured {
    /// A measure that the system defines.
    Of(Measure),
    /// [`Measure::PENETRATION`].
    Penetration,
}

/// The data from which one measure is computed, accumulated during a period.
enum Accumulator {
    /// The extremes of a scalar in the period.
    Extremes { scalar: InModes, extremes: Extremes<()>, extrema: Extrema<f64> },
    /// For a measure of two scalars, the largest value of the second scalar at the times when the
    /// first scalar rises through zero.
    Rising { scalars: [InModes; 2], most: Option<f64>, rises: Roots<f64> },
    /// The integral of a scalar over time, and the duration over which the integral is taken.
    Integral { integral: Integral, scalars: Vec<InModes>, sum: f64, time: f64 },
    /// The smallest local extremum of the guard functions, and the event that the motion approaches
    /// most slowly.
    Depth { guards: Vec<(Vec<usize>, Extrema<f64>)>, least: f64, slowest: Option<Slow> },
    /// No data: the measure is computed at the end of the period.
    Nothing,
}

impl Accumulator {
    /// Creates the empty accumulator of a measure.
    fn of(measure: Measure<InModes>) -> Self {
        match measure {
            Measure::Duration | Measure::Ends(_) => Accumulator::Nothing,
            Measure::Maximum(scalar) | Measure::Minimum(scalar) | Measure::Range(scalar) => {
                let extremes = Extremes::new(1.0, 0.0);
                Accumulator::Extremes { scalar, extremes, extrema: Extrema::default() }
            }
            Measure::Distance(none) | Measure::Penetration(none) => match none {},
            Measure::Rising { through, value } => {
                let scalars = [through, value];
                Accumulator::Rising { scalars, most: None, rises: Roots::default() }
            }
            Measure::Integral(integral, scalars) => {
                Accumulator::Integral { integral, scalars, sum: 0.0, time: 0.0 }
            }
        }
    }
}

/// The event that the motion approaches most slowly among all events of a period.
struct Slow {
    approach: f64,
    guard: usize,
    /// The state of the motion at the event.
    at: HybridState<f64>,
}

/// The names of the modes, events and measures of a motion.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Layout {
    /// The modes, each with the names of its states.
    pub modes: Vec<Mode>,
    /// The names of all events, in the order of their numbers.
    pub events: Vec<String>,
    /// The names of the measures that are recorded in every period.
    pub measures: Vec<String>,
}

/// A hybrid system, and the events and measures that are recorded in each period of its motions.
pub(super) struct Seen<'a> {
    pub system: &'a dyn HybridEquations,
    pub layout: Layout,
    /// The event number of each guard: guards with the same name share one event.
    pub numbers: Vec<usize>,
    pub measures: Vec<Measured>,
}

impl<'a> Seen<'a> {
    /// Selects all modes and events of a system, and the measures with the given names.
    pub fn of(
        system: &'a dyn HybridEquations,
        measures: &[String],
    ) -> Result<Self, StroboscopicError> {
        system.check_measures()?;
        let of = |(name, measure)| (name, Measured::Of(measure));
        let mut known: Vec<(String, Measured)> = system.measures().into_iter().map(of).collect();
        known.push((Measure::PENETRATION.into(), Measured::Penetration));
        let measure = |name: &String| {
            let names = known.iter().map(|(known, _)| known);
            position("measure", name, names).map(|k| known[k].1.clone())
        };
        let (mut events, mut numbers) = (Vec::<String>::new(), Vec::new());
        for guard in system.guards() {
            let number = events.iter().position(|event| *event == guard.name);
            numbers.push(number.unwrap_or(events.len()));
            if number.is_none() {
                events.push(guard.name);
            }
        }
        let layout = Layout { modes: system.modes(), events, measures: measures.to_vec() };
        let measures = measures.iter().map(measure).collect::<Result<_, _>>()?;
        Ok(Seen { system, layout, numbers, measures })
    }
}

/// The recorder of one period of a hybrid motion.
pub(super) struct Recorder<'a> {
    of: &'a Seen<'a>,
    accumulators: Vec<Accumulator>,
    start: HybridState<f64>,
    legs: Vec<Leg>,
    events: Vec<EventRecord>,
}

impl<'a> Recorder<'a> {
    /// Creates the recorder of a period that begins in a given state.
    pub fn new(of: &'a Seen<'a>, state: &HybridState<f64>) -> Self {
        let Seen { system, layout: Layout { modes, .. }, measures, .. } = of;
        let in_modes = |name: &String| system.scalars(modes, name);
        let accumulator = |measured: &Measured| match measured {
            Measured::Of(measure) => Accumulator::of(measure.map(in_modes)),
            Measured::Penetration => {
                let guards = system.guards().into_iter();
                let guards = guards.map(|guard| (guard.modes, Extrema::default())).collect();
                Accumulator::Depth { guards, least: f64::INFINITY, slowest: None }
            }
        };
        let accumulators = measures.iter().map(accumulator).collect();
        let (start, legs, events) = (state.clone(), Vec::new(), Vec::new());
        let mut recorder = Recorder { of, accumulators, start, legs, events };
        recorder.begin(state.mode, &state.x);
        recorder
    }

    fn begin(&mut self, mode: usize, x: &[f64]) {
        self.legs.push(Leg { mode, exit: None, start: x.to_vec(), end: x.to_vec() });
        for accumulator in &mut self.accumulators {
            match accumulator {
                Accumulator::Extremes { extrema, .. } => extrema.restart(),
                Accumulator::Rising { rises, .. } => rises.restart(),
                Accumulator::Depth { guards, .. } => {
                    guards.iter_mut().for_each(|(_, extrema)| extrema.restart());
                }
                _ => {}
            }
        }
        self.take(mode, x);
    }

    /// Updates the extremes of the measured scalars with the state at an end of a leg (the part of
    /// a motion between two events), where a scalar may be extreme.
    fn take(&mut self, mode: usize, x: &[f64]) {
        for accumulator in &mut self.accumulators {
            if let Accumulator::Extremes { scalar, extremes, .. } = accumulator
                && let Some(place) = scalar[mode].and_then(Observable::state)
            {
                extremes.visit((), x[place]);
            }
        }
    }

    /// Returns the record of the period that ended in the given state.
    pub fn finish(mut self, end: &HybridState<f64>, p: &[f64]) -> Period {
        self.take(end.mode, &end.x);
        if let Some(leg) = self.legs.last_mut() {
            leg.end.clone_from(&end.x);
        }
        let legs: Vec<Passage<f64>> = self.legs.iter().map(Leg::passage).collect();
        let duration = end.time - self.start.time;
        let of_measure = |measure: &Measure, accumulator: &Accumulator| match (measure, accumulator)
        {
            (Measure::Duration, _) => duration,
            (Measure::Ends(position), _) => self.of.system.measure(*position, &legs, 1, p),
            (_, Accumulator::Extremes { extremes, .. }) => {
                let mut overall = Overall::default();
                overall.take(extremes, extremes.dips([false; 2], [false; 2]), |()| ());
                overall.value(measure)
            }
            (_, Accumulator::Rising { most, .. }) => most.unwrap_or(0.0),
            (_, Accumulator::Integral { integral, sum, time, .. }) => integral.of(*sum, *time),
            _ => f64::NAN,
        };
        let value = |(measured, accumulator): (&Measured, &Accumulator)| match measured {
            Measured::Of(measure) => of_measure(measure, accumulator),
            Measured::Penetration => self.penetration(accumulator, duration, p),
        };
        let measures = self.of.measures.iter().zip(&self.accumulators).map(value).collect();
        Period { start: self.start, events: self.events, measures }
    }

    /// Returns, for the event with the smallest approach speed, the depth that the motion would
    /// reach beyond the surface of the event if this surface were absent.
    fn penetration(&self, accumulator: &Accumulator, within: f64, p: &[f64]) -> f64 {
        match accumulator {
            Accumulator::Depth { slowest: Some(event), .. } => self.beyond(event, within, p),
            Accumulator::Depth { least, .. } => -least,
            _ => f64::NAN,
        }
    }

    /// Returns the depth that the motion would reach beyond the surface of an event if the surface
    /// were absent; NaN if the motion does not turn back within the time `within`.
    fn beyond(&self, Slow { guard, at, .. }: &Slow, within: f64, p: &[f64]) -> f64 {
        let turn =
            virtual_point(self.of.system, (*guard, at.mode), (at.time, &at.x[..]), p, within);
        turn.map_or(f64::NAN, |(time, x)| -self.of.system.guard(*guard, at.mode, time, &x, p))
    }
}

/// Returns the value of a scalar at a fraction of a time step.
fn value_at<F: FieldIn<f64>>(watch: &ScalarOf, step: &mut Step<F, f64>, fraction: f64) -> f64 {
    let (time, p) = (step.time(fraction), step.flow().2);
    match fraction {
        0.0 => watch.value_in(time, step.start(), p),
        1.0 => watch.value_in(time, step.end(), p),
        _ => {
            let mut x = step.start().to_vec();
            step.state(fraction, &mut x);
            watch.value_in(time, &x, p)
        }
    }
}

impl HybridObserver<f64> for Recorder<'_> {
    fn step<F: FieldIn<f64>>(&mut self, mode: usize, step: &mut Step<F, f64>, end: f64) {
        let (last, system) = (step.place(end), self.of.system);
        for accumulator in &mut self.accumulators {
            match accumulator {
                Accumulator::Extremes { scalar, extremes, extrema } => {
                    let Some(observable) = scalar[mode] else { continue };
                    let watch = ScalarOf::new(system, observable, mode, step.flow().2);
                    extremes.visit((), value_at(&watch, step, 0.0));
                    // States at the end of a leg are recorded from its event.
                    if observable.state().is_none() {
                        extremes.visit((), value_at(&watch, step, end));
                    }
                    extrema.search(&watch, step, |found| {
                        if found.place <= last {
                            extremes.visit((), found.value);
                        }
                    });
                }
                Accumulator::Rising { scalars: [through, value], most, rises } => {
                    let (Some(observable), Some(value)) = (through[mode], value[mode]) else {
                        continue;
                    };
                    let watch = ScalarOf::new(system, observable, mode, step.flow().2);
                    let value = ScalarOf { observable: value, ..watch };
                    let _ = rises.search(&Opposite(&watch), step, |step, root| {
                        if root.fraction <= end {
                            let value = value_at(&value, step, root.fraction);
                            *most = larger(*most, value, |value| *value);
                        }
                        ControlFlow::Continue(())
                    });
                }
                Accumulator::Integral { integral, scalars, sum, time } => {
                    let (length, p) = (step.length() * step.flow().1, step.flow().2);
                    let of_mode: Vec<_> = scalars.iter().filter_map(|of| of[mode]).collect();
                    if of_mode.is_empty() {
                        continue;
                    }
                    *time += length * end;
                    step.quadrature(end, |weight, t, x| {
                        for scalar in &of_mode {
                            let value = system.observe(*scalar, mode, t, x, p);
                            *sum += weight * integral.integrand(value);
                        }
                    });
                }
                Accumulator::Depth { guards, least, .. } => {
                    let watched =
                        guards.iter_mut().enumerate().filter(|(_, at)| at.0.contains(&mode));
                    for (guard, (_, extrema)) in watched {
                        let watch = GuardOf::typical(system, guard, mode, step.flow().2);
                        extrema.search(&watch, step, |found| {
                            if found.place <= last {
                                *least = least.min(found.value);
                            }
                        });
                    }
                }
                Accumulator::Nothing => {}
            }
        }
    }

    fn event(&mut self, event: &Event<f64>) -> ControlFlow<()> {
        let &Event { guard, time, mode, next, accumulation, approach, .. } = event;
        self.take(mode, &event.before);
        if let Some(leg) = self.legs.last_mut() {
            leg.exit = (!accumulation).then_some(guard);
            leg.end.clone_from(&event.before);
        }
        let before = HybridState { mode, time, x: event.before.clone() };
        for accumulator in &mut self.accumulators {
            if let Accumulator::Depth { slowest, .. } = accumulator
                && !accumulation
                && slowest.as_ref().is_none_or(|slow| approach < slow.approach)
            {
                *slowest = Some(Slow { approach, guard, at: before.clone() });
            }
        }
        let (event_number, time) = (self.of.numbers[guard], time - self.start.time);
        self.events.push(EventRecord { event: event_number, time, before, accumulation });
        self.begin(next, &event.after);
        ControlFlow::Continue(())
    }
}

//! Promise: where a hybrid motion cannot go on, or does not repeat, the error names mode, guard and
//! time, and a motion that only just touches a surface is not lost.

use crate::common::close;
use crate::hybrid::systems::bouncing_ball::{self};
use crate::hybrid::systems::impact_oscillator::ClosedForm;
use std::f64::consts::PI;
use tangency::core::attractor::{CycleSearch, CycleSearchError};
use tangency::core::failure::{FlowError, OutOfDomain, one_line};
use tangency::core::hybrid::{
    Event, Guard, HybridError, HybridFlow, HybridSettings, HybridState, HybridSystem, Mode,
};
use tangency::core::scalar::Scalar;
use tangency::hybrid_system;
use tangency::problems::classic::ImpactOscillator;
use tangency::problems::mita::Actuator;

fn at(mode: usize, time: f64, x: &[f64]) -> HybridState<f64> {
    HybridState { mode, time, x: x.to_vec() }
}

fn followed<S: HybridSystem>(
    system: &S,
    state: HybridState<f64>,
    duration: f64,
    p: &[f64],
) -> Result<(Vec<Event<f64>>, HybridState<f64>), HybridError> {
    let mut state = state;
    let mut flow = HybridFlow::new(system, HybridSettings::default())?;
    let events = flow.events(&mut state, duration, p)?;
    Ok((events, state))
}

fn refused<S: HybridSystem>(system: &S, state: HybridState<f64>, p: &[f64]) -> HybridError {
    followed(system, state, 10.0, p).expect_err("this cannot be followed")
}

/// `x' = −1` from `x` to 0, after which motion goes on in mode `after` from the state `to`.
struct Sinking {
    after: usize,
    to: f64,
}
impl HybridSystem for Sinking {
    fn modes(&self) -> Vec<Mode> {
        vec![Mode::new("water", ["depth"]), Mode::new("bottom", ["depth"])]
    }
    fn guards(&self) -> Vec<Guard> {
        vec![Guard::new("ground", [0]), Guard::new("rock", [1])]
    }
    fn parameters(&self) -> Vec<String> {
        vec![]
    }
    fn field<T: Scalar>(&self, _mode: usize, _t: T, _x: &[T], _p: &[T], f: &mut [T]) {
        f[0] = -T::one();
    }
    fn guard<T: Scalar>(&self, guard: usize, _mode: usize, _t: T, x: &[T], _p: &[T]) -> T {
        if guard == 0 { x[0] } else { x[0] - 1.0 }
    }
    fn reset<T: Scalar>(
        &self,
        _g: usize,
        _modes: (usize, usize),
        _t: T,
        _x: &[T],
        _p: &[T],
        after: &mut [T],
    ) {
        after[0] = T::constant(self.to);
    }
    fn next_mode(&self, _guard: usize, _mode: usize, _t: f64, _x: &[f64], _p: &[f64]) -> usize {
        self.after
    }
    fn domain(&self, _mode: usize, x: &[f64], _p: &[f64]) -> Result<(), OutOfDomain> {
        if x[0] > 2.0 { Err(OutOfDomain::new("depth", x[0], "the lake is 2 deep")) } else { Ok(()) }
    }
}

/// Over a table at rest and without a mode that follows, the accumulation itself is reported.
#[test]
fn zeno_without_contact() {
    hybrid_system! {
        struct Restless [acceleration, restitution; t] {
            mode flight [height, velocity] {
                let table = acceleration * t.cos();
                d/dt height = velocity;
                d/dt velocity = -T::one();
                event impact: height - acceleration * t.sin()
                    => flight { height, velocity: table - restitution * (velocity - table) };
            }
            mode contact [height] {
                d/dt height = acceleration * t.cos();
            }
        }
    }
    match refused(&Restless, at(0, 0.0, &[0.5, 0.0]), &[0.0, 0.7]) {
        error @ HybridError::Accumulation { time, ratio, .. } => {
            close(time, bouncing_ball::rest(0.5, 0.7), 1e-10);
            close(ratio, 0.7, 1e-6);
            let text = one_line(&error);
            assert!(
                text.contains("guard impact accumulate at t = 5.66")
                    && text.contains("mode flight")
            );
        }
        other => panic!("{other}"),
    }
    // Without restitution the ball falls at once where it has landed.
    match refused(&Restless, at(0, 0.0, &[0.5, 0.0]), &[0.0, 0.0]) {
        HybridError::Standstill { time, mode, guard, events, span } => {
            close(time, 1.0, 1e-9);
            assert_eq!((mode.as_str(), guard.as_str(), events), ("flight", "impact", 1001));
            assert!(span < 1e-9);
        }
        other => panic!("{other}"),
    }
}

#[test]
fn events_without_progress_are_capped() {
    let error = refused(&Sinking { after: 0, to: 0.0 }, at(0, 0.0, &[0.5]), &[]);
    assert!(matches!(error, HybridError::Standstill { time: 0.4..0.6, .. }), "{error}");
    assert!(one_line(&error).contains("at the guard ground in mode water"), "{error}");
}

/// A guard that is zero at the start counts at once if it falls, and does not if it rises.
#[test]
fn an_event_may_come_at_the_start() {
    let p = ImpactOscillator::DEFAULTS;
    let (falling, _) = followed(&ImpactOscillator, at(0, 0.7, &[1.0, 0.3]), 1.0, &p).unwrap();
    assert_eq!((falling[0].time, falling[0].before[1]), (0.7, 0.3));
    assert_eq!(falling.len(), 1);
    let (rising, _) = followed(&ImpactOscillator, at(0, 0.7, &[1.0, -0.3]), 1.0, &p).unwrap();
    assert!(rising.is_empty(), "{rising:?}");
}

#[test]
fn a_violated_guard_is_refused() {
    let error = refused(&ImpactOscillator, at(0, 0.7, &[1.001, 0.0]), &ImpactOscillator::DEFAULTS);
    assert!(matches!(error, HybridError::Outside { time: 0.7, .. }), "{error}");
    let text = one_line(&error);
    assert!(text.contains("mode flight begins with the guard impact = -1.000e-3"), "{text}");
    let error = refused(&Sinking { after: 1, to: 0.9 }, at(0, 0.0, &[0.5]), &[]);
    assert!(one_line(&error).contains("after event ground, mode bottom begins"), "{error}");
}

#[test]
fn modes_and_lengths_are_checked() {
    let error = refused(&Sinking { after: 2, to: 1.0 }, at(0, 0.0, &[0.5]), &[]);
    assert!(
        one_line(&error).contains("after event ground, the next mode has the number 2"),
        "{error}"
    );
    let lake = Sinking { after: 0, to: 1.0 };
    assert!(matches!(refused(&lake, at(7, 0.0, &[0.5]), &[]), HybridError::NoMode { mode: 7, .. }));
    assert!(matches!(refused(&lake, at(0, 0.0, &[]), &[]), HybridError::Length { found: 0, .. }));
    assert!(matches!(
        refused(&lake, at(0, 0.0, &[0.5]), &[1.0]),
        HybridError::Length { found: 1, .. }
    ));
    let error = followed(&lake, at(0, 0.0, &[0.5]), -1.0, &[]).unwrap_err();
    assert!(matches!(error, HybridError::Backward(_)), "{error}");
}

#[test]
fn the_mode_of_a_flow_that_ends_is_named() {
    let error = refused(&Sinking { after: 0, to: 3.0 }, at(0, 0.0, &[0.5]), &[]);
    match &error {
        HybridError::Flow { mode, source: FlowError::OutOfDomain { time, .. } } => {
            assert_eq!(mode, "water");
            close(*time, 0.5, 1e-12);
        }
        other => panic!("{other}"),
    }
    assert!(one_line(&error).contains("the lake is 2 deep"), "{error}");
    let mut p = Actuator::DEFAULTS;
    p[2] = 1.5;
    let error = refused(&Actuator, at(Actuator::STICK, 0.0, &[0.0, 0.0]), &p);
    assert!(one_line(&error).contains("clearance"), "{error}");
}

/// The motion that touches the stop exactly goes on as if nothing had happened, whether the last
/// digits make an event of it or not.
#[test]
fn exact_grazing_changes_nothing() {
    for frequency in [0.7_f64, 1.0, 1.3, 2.2] {
        let form = ClosedForm::new(frequency, 0.8, 0.1, 1.0);
        let p = [form.grazing(), frequency, 0.8, 0.1, 1.0];
        let lag = (0.1 * frequency).atan2(1.0 - frequency * frequency);
        let start = at(0, (lag - 0.5 * PI) / frequency, &[0.0, frequency]);
        let (events, end) = followed(&ImpactOscillator, start, PI / frequency, &p).unwrap();
        assert!(events.iter().all(|event| event.approach < 1e-5), "{frequency}: {events:?}");
        close(end.x[0], 0.0, 1e-5);
        close(end.x[1], -frequency, 1e-5);
    }
}

#[test]
fn motions_that_do_not_repeat_say_so() {
    // Without forcing nor impacts.
    let p = [0.0, 1.0, 0.8, 0.0, 1.0];
    let mut flow = HybridFlow::new(&ImpactOscillator, HybridSettings::default()).unwrap();
    let brief =
        CycleSearch { transient: 0.0, returns: 40, max_period: 4, longest: 5.0, tolerance: 1e-9 };
    let beating = [0.0, 1.234, 0.8, 0.0, 1.0];
    let error = brief.find(&mut flow, at(0, 0.0, &[0.5, 0.0]), &beating).unwrap_err();
    assert!(matches!(error, CycleSearchError::Unsettled { returns: 40, .. }), "{error}");
    let cycle = brief.find(&mut flow, at(0, 0.0, &[0.5, 0.0]), &p).unwrap();
    assert!(cycle.legs.len() == 1 && cycle.legs[0].exit.is_none(), "{cycle:?}");
    let sinking = Sinking { after: 0, to: 1.0 };
    let mut lake = HybridFlow::new(&sinking, HybridSettings::default()).unwrap();
    let waits = CycleSearch { longest: 0.5, ..brief };
    let error = waits.find(&mut lake, at(0, 0.0, &[1.5]), &[]).unwrap_err();
    assert!(matches!(error, CycleSearchError::NoReturn(0.5)), "{error}");
    let cycle = brief.find(&mut lake, at(0, 0.0, &[1.5]), &[]).unwrap();
    close(cycle.duration(), 1.0, 1e-12);
}

hybrid_system! {
    /// `x'' + x'/2 + x = 0`, with a mode on each side of `x = 0`.
    struct Spiral [] {
        mode right [x, v] {
            d/dt x = v;
            d/dt v = -x - v * 0.5;
            event to_left: x => left;
        }
        mode left [x, v] {
            d/dt x = v;
            d/dt v = -x - v * 0.5;
            event to_right: -x => right;
        }
    }
}

/// Motion becomes small compared with its past, but not with its last turns: it comes to rest.
#[test]
fn a_spiral_into_an_equilibrium_is_no_cycle() {
    let mut flow = HybridFlow::new(&Spiral, HybridSettings::default()).unwrap();
    let search = CycleSearch { transient: 0.0, returns: 12, ..CycleSearch::default() };
    let error = search.find(&mut flow, at(0, 0.0, &[1.0, 0.0]), &[]).unwrap_err();
    assert!(matches!(error, CycleSearchError::Rest { last, .. } if last < 1e-6), "{error}");
}

hybrid_system! {
    /// `x' = 1` up to 1, in one state; from there on in two, which no reset gives.
    struct Widening [] {
        mode narrow [x] {
            d/dt x = T::one();
            event door: -x + 1.0 => wide;
        }
        mode wide [x, y] {
            d/dt x = -T::one();
            d/dt y = -T::one();
            event turn: y => wide;
        }
    }
}

/// States stay what they are where no reset is stated; between modes of different states there is
/// none.
#[test]
fn a_reset_is_the_identity_unless_it_is_stated() {
    let mut after = [0.0; 2];
    Widening.reset(1, (1, 1), 0.0, &[0.3, 0.4], &[], &mut after);
    assert_eq!(after, [0.3, 0.4]);
    let error = refused(&Widening, at(0, 0.0, &[0.25]), &[]);
    match &error {
        HybridError::NoReset { time, before: 1, after: 2, .. } => close(*time, 0.75, 1e-12),
        other => panic!("{other}"),
    }
    let said = "the event door leads from mode narrow with 1 states to mode wide with 2";
    assert!(one_line(&error).contains(said), "{error}");
}

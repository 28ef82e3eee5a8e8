//! Promise: simulated hybrid motions are the exact ones, events in their order, tangencies and
//! accumulations included, and so are their derivatives.

use crate::common::close;
use crate::hybrid::systems::belt::{self, Belt};
use crate::hybrid::systems::bouncing_ball::{self, BouncingBall};
use crate::hybrid::systems::coulomb::{self, Coulomb};
use crate::hybrid::systems::dry_impact::{self, DryImpact};
use crate::hybrid::systems::impact_oscillator::{self, ClosedForm};
use crate::hybrid::systems::piecewise::{self, Piecewise};
use crate::hybrid::systems::settings;
use num_dual::Dual64;
use proptest::prelude::*;
use std::f64::consts::{PI, TAU};
use std::ops::ControlFlow;
use tangency::core::attractor::{AttractorSearch, CycleSearch, PeriodMap};
use tangency::core::hybrid::filippov::Filippov;
use tangency::core::hybrid::{
    Cycle, Event, EventNumber, GuardOf, History, HybridEquations, HybridFlow, HybridState,
    HybridSystem,
};
use tangency::core::problem::Watchable;
use tangency::core::scalar::{DualChunk, Scalar};
use tangency::hybrid_system;
use tangency::problems::classic::ImpactOscillator;

fn at<T: Scalar>(mode: usize, time: f64, x: &[f64]) -> HybridState<T> {
    let x = x.iter().map(|x| T::constant(*x)).collect();
    HybridState { mode, time: T::constant(time), x }
}

/// The events of a motion with the flow's tolerance 1e-13, and its last state.
fn followed<'a, T: EventNumber>(
    system: &'a dyn HybridEquations,
    mut state: HybridState<T>,
    duration: T,
    p: &[T],
) -> (Vec<Event<T>>, HybridState<T>)
where
    GuardOf<'a>: Watchable<T>,
{
    let mut flow = HybridFlow::new(system, settings(1e-13)).unwrap();
    let events = flow.events(&mut state, duration, p).unwrap();
    (events, state)
}

fn found(system: &dyn HybridEquations, start: HybridState<f64>, p: &[f64]) -> Cycle {
    let mut flow = HybridFlow::new(system, settings(1e-13)).unwrap();
    let search = CycleSearch { tolerance: 1e-11, transient: 300.0, ..CycleSearch::default() };
    search.find(&mut flow, start, p).unwrap()
}

type Matrix = [[f64; 2]; 2];

fn product(a: Matrix, b: Matrix) -> Matrix {
    [0, 1].map(|i| [0, 1].map(|j| a[i][0] * b[0][j] + a[i][1] * b[1][j]))
}

/// The derivative of a motion through an impact is `Φ₂ S Φ₁` with the saltation matrix
/// `S = R + (f⁺ − R f⁻) hᵀ/(hᵀ f⁻)`, and that of differences.
#[test]
fn derivatives_through_an_event_are_those_of_the_saltation_matrix() {
    type Four = DualChunk<f64, 4>;
    let p = [0.3, 1.0, 0.8, 0.1, 1.0];
    let (start, duration) = ([0.9, 0.5], 2.0);
    let state = HybridState {
        mode: ImpactOscillator::FLIGHT,
        time: Four::from(0.3),
        x: vec![Four::seeded(start[0], 0), Four::seeded(start[1], 1)],
    };
    let (events, end) = followed(&ImpactOscillator, state, duration.into(), &p.map(Four::from));
    assert_eq!(events.len(), 1);
    let part = |x: &Four| [x.eps[0], x.eps[1]];
    let derivative: Matrix = [part(&end.x[0]), part(&end.x[1])];

    let Event { time, before, after, .. } = &events[0];
    let field = |x: &[Four]| {
        let (mut f, x) = ([0.0; 2], [x[0].re, x[1].re]);
        ImpactOscillator.field(0, time.re, &x, &p, &mut f);
        f
    };
    let (minus, plus, reset) = (field(before), field(after), [[1.0, 0.0], [0.0, -p[2]]]);
    // The guard is d − x: only the first column of the correction does not vanish.
    let correction = [0, 1].map(|i: usize| {
        let carried: f64 = reset[i][0] * minus[0] + reset[i][1] * minus[1];
        [(plus[i] - carried) / minus[0], 0.0]
    });
    let saltation = [0, 1].map(|i: usize| [0, 1].map(|j: usize| reset[i][j] + correction[i][j]));
    let free = |t: f64| impact_oscillator::flow(t, p[3]);
    let exact = product(free(2.3 - time.re), product(saltation, free(time.re - 0.3)));
    let mut differences = [[0.0; 2]; 2];
    let h = 1e-5;
    for j in 0..2 {
        let end = [-h, h].map(|h| {
            let mut x = start;
            x[j] += h;
            followed(&ImpactOscillator, at::<f64>(0, 0.3, &x), duration, &p).1.x
        });
        for i in 0..2 {
            differences[i][j] = (end[1][i] - end[0][i]) / (2.0 * h);
        }
    }
    for (i, j) in [(0, 0), (0, 1), (1, 0), (1, 1)] {
        close(derivative[i][j], exact[i][j], 1e-9);
        close(derivative[i][j], differences[i][j], 1e-6);
    }
}

/// The forced motion of amplitude `(1 + ε) d` passes the stop by `ε d`, or stays as much away.
#[test]
fn tangencies_are_told_apart_down_to_the_last_digits() {
    for frequency in [0.7, 1.0, 2.2] {
        let form = ClosedForm::new(frequency, 0.8, 0.1, 1.0);
        for beyond in [1e-2, 1e-4, 1e-6, 1e-8, 1e-10, 1e-12, -1e-12, -1e-10, -1e-8, -1e-4] {
            let p = [form.grazing() * (1.0 + beyond), frequency, 0.8, 0.1, 1.0];
            // The forced motion `Re A e^{iωt}/(1 − ω² + icω)` at t = −π/2ω after its maximum.
            let lag = (0.1 * frequency).atan2(1.0 - frequency * frequency);
            let time = (lag - 0.5 * PI) / frequency;
            let start = at::<f64>(0, time, &[0.0, (1.0 + beyond) * frequency]);
            let mut flow = HybridFlow::new(&ImpactOscillator, settings(1e-15)).unwrap();
            let mut state = start;
            // Up to the maximum and a quarter beyond.
            let events = flow.events(&mut state, PI / frequency, &p).unwrap();
            let expected = if beyond > 0.0 { 1 } else { 0 };
            assert_eq!(events.len(), expected, "{frequency} {beyond}");
            for event in events {
                let speed = frequency * (2.0 * beyond + beyond * beyond).sqrt();
                // An error η of the height is one of ω² η/speed in the speed.
                close(event.approach, speed, 1e-12 + 5e-15 * frequency.powi(2) / speed);
            }
        }
    }
}

hybrid_system! {
    /// `x' = 1`, with guards that vanish together.
    struct Clockwork [end] {
        mode one [x] {
            d/dt x = T::one();
            event late: -x + end + 1e-6 => three;
            event first: -x + end => two;
            event second: -x.powi(2) + end * end => three;
        }
        mode two [x] {
            d/dt x = T::one();
            event second: -x.powi(2) + end * end => three;
        }
        mode three [x] {
            d/dt x = T::one();
            event last: -x + end + 1.0 => one;
        }
    }
}

/// The guard stated first counts; the other, zero and falling, comes at once in the mode that
/// follows. Both times have the derivatives of what they are the root of.
#[test]
fn events_that_come_together_come_in_order() {
    let mut flow = HybridFlow::new(&Clockwork, settings(1e-13)).unwrap();
    let statistics = flow.advance(&mut at(0, 0.0, &[0.0]), 1.0, &[1.0 / 3.0], &mut ()).unwrap();
    assert_eq!((statistics.events, statistics.together), (2, 1));
    let p = [Dual64::from(1.0 / 3.0).derivative()];
    let (events, end) = followed(&Clockwork, at(0, 0.0, &[0.0]), 1.0.into(), &p);
    assert_eq!(
        events.iter().map(|event| (event.guard, event.mode)).collect::<Vec<_>>(),
        [(1, 0), (2, 1)]
    );
    for event in events {
        close(event.time.re, 1.0 / 3.0, 1e-15);
        close(event.time.eps, 1.0, 1e-14);
    }
    assert!(end.mode == 2 && (end.x[0].re - 1.0).abs() < 1e-15, "{end:?}");
}

/// A ball dropped on a resting table is at rest after the geometric series of its times of flight.
#[test]
fn chatter_ends_where_its_series_does() {
    // With the first of them the ball rests at once, but no mode says so.
    for e in [1e-300, 1e-4, 0.01, 0.1, 0.5, 0.8, 0.9] {
        let height = Dual64::from(0.7).derivative();
        let (zero, p) = (Dual64::from(0.0), [0.0, e].map(Dual64::from));
        let state = HybridState { mode: BouncingBall::FLIGHT, time: zero, x: vec![height, zero] };
        let (events, end) = followed(&BouncingBall, state, 100.0.into(), &p);
        let last = events.last().unwrap();
        assert!(last.accumulation && end.mode == BouncingBall::CONTACT, "e = {e}: {last:?}");
        assert_eq!(events.iter().filter(|event| event.accumulation).count(), 1);
        let rest = bouncing_ball::rest(0.7, e);
        close(last.time.re, rest, 1e-10);
        // Flights that rise by less than 1e-13 last 1e-6 at most, and their times have no
        // derivatives.
        close(last.time.eps, rest / 1.4, 1e-7);
        close(last.before[0].re, 0.0, 1e-12);
        close(last.before[1].re, 0.0, 1e-10);
    }
}

/// Over a moving table of `Γ > 1` the ball that has come to rest is thrown off where `Γ sin t = 1`.
#[test]
fn motion_goes_on_from_contact() {
    let (gamma, e) = (1.1, 0.3);
    let (events, _) = followed(&BouncingBall, at::<f64>(0, 0.0, &[0.3, 0.0]), 60.0, &[gamma, e]);
    let leaves = events.iter().filter(|event| event.guard == BouncingBall::LEAVE);
    for event in leaves.clone() {
        close(event.time.rem_euclid(TAU), bouncing_ball::leave(gamma), 1e-10);
        assert!(event.next == BouncingBall::FLIGHT && !event.accumulation);
    }
    assert!(leaves.count() > 3, "{}", events.len());
}

#[test]
fn belts_have_their_period() {
    let p = [1.0, 0.6, 0.3];
    let cycle = found(&Filippov(Belt), at(Belt::STICK, 0.0, &[0.0, 0.3]), &p);
    close(cycle.duration(), 7.095261537843029, 1e-11);
    close(cycle.duration(), belt::period(1.0, 0.6, 0.3), 1e-11);
    assert_eq!(cycle.legs.len(), 2);
    let stick = cycle.legs.iter().find(|leg| leg.mode == Belt::STICK).unwrap();
    close(stick.start[0], belt::stick(1.0, 0.6), 1e-11);
    let mut flow = HybridFlow::new(&Filippov(Belt), settings(1e-13)).unwrap();
    let (mut history, mut state) = (History::new(400), at(Belt::STICK, 0.0, &[0.0, 0.3]));
    flow.advance(&mut state, 20.0, &p, &mut history).unwrap();
    let displacements = history.pieces.iter().flat_map(|piece| piece.states.iter().map(|x| x[0]));
    close(displacements.fold(0.0, f64::max), belt::largest(1.0, 0.6, 0.3), 1e-5);
}

/// Motion that spirals towards a cycle, here with multipliers `0.8 e^{±iφ}`, is near it first after
/// several returns: the least of them is its period.
#[test]
fn cycles_have_their_least_period() {
    let p = [0.95, 0.8];
    for transient in [0.0, 100.0, 130.0, 200.0, 400.0] {
        for (height, velocity) in [(1.0, 3.0), (1.5, 3.3), (1.2, 2.5)] {
            let start = at(BouncingBall::FLIGHT, 0.0, &[height, velocity]);
            let mut flow = HybridFlow::new(&BouncingBall, settings(1e-13)).unwrap();
            let search = CycleSearch { transient, ..CycleSearch::default() };
            let cycle = search.find(&mut flow, start.clone(), &p).unwrap();
            let found = (cycle.count(&BouncingBall, "impact"), cycle.periods);
            assert_eq!(found, (1, 1), "from {start:?} after {transient}");
            let mut map = PeriodMap::of(&BouncingBall, settings(1e-13), &[]).unwrap();
            let search = AttractorSearch { transient: 5, ..AttractorSearch::default() };
            let found = search.follow(&mut map, start, &p).unwrap();
            assert_eq!((found.periods, found.count("impact")), (Some(1), 1.0));
        }
    }
}

#[test]
fn den_hartogs_amplitude_is_simulated() {
    // Free motion turns by a third in a period of the forcing, and friction slows it down little.
    let search = CycleSearch { tolerance: 1e-12, transient: 2000.0, ..CycleSearch::default() };
    let mut flow = HybridFlow::new(&Coulomb, settings(1e-13)).unwrap();
    let start = at(Coulomb::FORWARD, 0.0, &[0.0, 0.1]);
    let cycle = search.find(&mut flow, start, &[1.5, 0.2]).unwrap();
    assert_eq!(cycle.legs.len(), 2, "{cycle:?}");
    let ends = cycle.legs.iter().map(|leg| leg.end[0].abs());
    ends.for_each(|end| close(end, 0.765941686205071, 1e-10));
    close(coulomb::amplitude(1.5, 0.2), 0.765941686205071, 1e-14);
}

#[test]
fn piecewise_smooth_orbits_have_their_multipliers() {
    let p = [1.0, 2.0, 1.5];
    let exact = piecewise::cycle(p[0], p[1], p[2]);
    let cycle = found(&Piecewise, at(Piecewise::LEFT, 0.0, &[-0.5, 0.5]), &p);
    close(cycle.duration(), 4.810271605994165, 1e-10);
    // The derivative of the time and place of return by the place of departure, across the section.
    let top = Dual64::from(exact.top).derivative();
    let start = HybridState { mode: Piecewise::LEFT, time: 0.0.into(), x: vec![0.0.into(), top] };
    let (events, _) = followed(&Piecewise, start, 6.0.into(), &p.map(Dual64::from));
    close(events[1].after[1].re, exact.top, 1e-11);
    close(events[1].after[1].eps, exact.multiplier, 1e-10);
    close(exact.multiplier, 0.002430511420186203, 1e-14);
}

#[test]
fn dry_impacts_settle_where_they_should() {
    let p = DryImpact::DEFAULTS;
    let cycle = found(&DryImpact, at(DryImpact::STICK, -1.0, &[0.0]), &p);
    assert_eq!(cycle.legs.len(), 3, "{cycle:?}");
    let stick = cycle.legs.iter().find(|leg| leg.mode == DryImpact::STICK).unwrap();
    close(stick.start[0], -0.1331776845606505, 1e-10);
    let form = dry_impact::ClosedForm::new(p);
    let x = stick.start[0];
    let hit = cycle.legs.iter().find(|leg| leg.mode == DryImpact::UP).unwrap();
    close(hit.start[1], form.velocity(x), 1e-10);
}

/// The orbit with one impact in a period, beyond its period doubling, against its closed form.
#[test]
fn impact_oscillators_settle_on_their_orbit() {
    let form = ClosedForm::new(2.2, 0.8, 0.1, 1.0);
    let speed = 1.2;
    let p = [form.amplitude(speed), 2.2, 0.8, 0.1, 1.0];
    let cycle = found(&ImpactOscillator, at(0, 0.0, &[0.0, 0.0]), &p);
    assert_eq!((cycle.legs.len(), cycle.periods), (1, 1), "{cycle:?}");
    close(cycle.legs[0].end[1], speed, 1e-9);
    close(cycle.start.rem_euclid(TAU / 2.2), form.time(speed), 1e-9);
}

/// Where a steady force presses the mass against the stop it chatters to rest there and stays:
/// contact is cheap.
#[test]
fn contact_lasts_and_costs_little() {
    let p = [1.5, 1e-9, 0.7, 0.1, 1.0];
    let mut flow = HybridFlow::new(&ImpactOscillator, settings(1e-12)).unwrap();
    let mut state = at(0, 0.0, &[0.9, 0.0]);
    let statistics = flow.advance(&mut state, 100.0, &p, &mut ()).unwrap();
    assert!(statistics.accumulations == 1 && state.mode == ImpactOscillator::CONTACT);
    let rest = flow.advance(&mut state, 1e4, &p, &mut ()).unwrap();
    assert!(rest.flow.evaluations < 300 && rest.events == 0, "{rest:?}");
    close(state.x[0], 1.0, 1e-11);
}

#[test]
fn nothing_is_allocated_once_the_buffers_are_there() {
    let p = [0.3, 1.0, 0.8, 0.1, 1.0].map(Dual64::from);
    let mut flow = HybridFlow::new(&ImpactOscillator, settings(1e-12)).unwrap();
    let mut state = at::<Dual64>(0, 0.0, &[0.0, 0.0]);
    let mut impacts = 0;
    let mut run = |state: &mut HybridState<Dual64>| {
        let mut watch = |_: &Event<Dual64>| {
            impacts += 1;
            ControlFlow::Continue(())
        };
        flow.advance(state, 100.0.into(), &p, &mut watch).unwrap();
    };
    run(&mut state);
    let counted = allocation_counter::measure(|| run(&mut state));
    assert!(counted.count_total == 0 && impacts > 20, "{counted:?} {impacts}");
}

proptest! {
    #![proptest_config(ProptestConfig { failure_persistence: None, ..ProptestConfig::with_cases(48) })]

    /// Two parts of a motion are the whole, wherever it is divided; and energy is lost at impacts
    /// only by restitution.
    #[test]
    fn parts_make_the_whole(x in -1.0..0.95f64, v in -1.0..1.0f64, part in 0.0..1.0f64) {
        let p = [0.4, 1.3, 0.8, 0.1, 1.0];
        let (events, end) = followed(&ImpactOscillator, at::<f64>(0, 0.2, &[x, v]), 20.0, &p);
        let (one, middle) = followed(&ImpactOscillator, at::<f64>(0, 0.2, &[x, v]), 20.0 * part, &p);
        let (other, last) = followed(&ImpactOscillator, middle, 20.0 * (1.0 - part), &p);
        prop_assert_eq!(events.len(), one.len() + other.len());
        prop_assert_eq!(end.mode, last.mode);
        // Near grazing, errors grow.
        let softest = events.iter().map(|event| event.approach).fold(1.0, f64::min);
        for (a, b) in end.x.iter().zip(&last.x) {
            prop_assert!((a - b).abs() < 1e-8 / softest.powi(2), "{} {} {:e}", a, b, softest);
        }
        for event in &events {
            prop_assert!((event.before[0] - 1.0).abs() < 1e-12 && event.approach >= 0.0);
            prop_assert!((event.approach - event.before[1]).abs() < 1e-12);
        }
    }
}

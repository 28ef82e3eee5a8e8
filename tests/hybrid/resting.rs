//! Promise: a motion that comes to rest on a surface, and is released, is never behind it, however often it is sampled;
//! rest is periodic and stable, and the state that a support carries does not count against it.

use crate::common::close;
use crate::hybrid::systems::bouncing_ball::{self, BouncingBall};
use std::f64::consts::TAU;
use tangency::core::attractor::{Attractor, AttractorSearch, PeriodMap};
use tangency::core::hybrid::{
    CycleSearch, CycleSearchError, Guard, HybridError, HybridFlow, HybridSettings, HybridState,
    HybridSystem, Mode,
};
use tangency::core::scalar::Scalar;

fn thrown(velocity: f64) -> HybridState<f64> {
    HybridState { mode: BouncingBall::FLIGHT, time: 0.0, x: vec![0.0, velocity] }
}

/// 291 values from 0.2 to 3.
fn accelerations() -> impl Iterator<Item = f64> {
    (0..=290).map(|k| 0.2 + 2.8 * f64::from(k) / 290.0)
}

fn settled<S: HybridSystem>(system: &S, p: &[f64]) -> Attractor {
    let search = AttractorSearch {
        transient: 100,
        recorded_periods: 40,
        lyapunov_periods: 0,
        ..AttractorSearch::default()
    };
    let mut map = PeriodMap::of(system, HybridSettings::default(), &[]).unwrap();
    search.follow(&mut map, thrown(1.0), p).unwrap_or_else(|error| panic!("{p:?}: {error}"))
}

/// The diagram of the ball has no holes, with and without restitution.
#[test]
fn a_ball_that_is_released_is_not_below_the_table() {
    for gamma in accelerations() {
        for e in [0.0, 0.5] {
            settled(&BouncingBall, &[gamma, e]);
        }
        settled(&BouncingBall, &[gamma, 0.0]);
    }
}

/// The same for the search for cycles, which samples as well.
#[test]
fn cycles_of_the_ball_are_searched_without_errors() {
    let mut flow = HybridFlow::new(&BouncingBall, HybridSettings::default()).unwrap();
    let search = CycleSearch { transient: 40.0 * TAU, returns: 40, ..CycleSearch::default() };
    for gamma in accelerations() {
        for e in [0.0, 0.5] {
            match search.find(&mut flow, thrown(1.0), &[gamma, e]) {
                Ok(_) | Err(CycleSearchError::Unsettled { .. }) => {}
                Err(error) => panic!("{gamma}, {e}: {error}"),
            }
        }
    }
}

/// Below Γ = 1 the ball rests; above, without restitution, it is thrown off and lands once a period: all is forgotten.
#[test]
fn rest_is_periodic_and_stable() {
    for (gamma, e) in [(0.3, 0.0), (0.9, 0.0), (0.3, 0.5), (0.9, 0.5)] {
        let found = settled(&BouncingBall, &[gamma, e]);
        assert_eq!((found.periods, found.end.mode), (Some(1), BouncingBall::CONTACT));
        assert!(found.exponent.unwrap().value < 0.0, "Γ = {gamma}: {found:?}");
    }
    for gamma in accelerations().filter(|gamma| *gamma > 1.0) {
        let found = settled(&BouncingBall, &[gamma, 0.0]);
        assert_eq!((found.periods, found.count("leave")), (Some(1), 1.0), "Γ = {gamma}");
        // But for rounding, which the release at the top of the table's force magnifies just above Γ = 1.
        assert!(found.exponent.unwrap().value < -20.0, "Γ = {gamma}: {found:?}");
    }
}

/// Chatter ends at rest on the table: the motion after it does not depend on that before, to the last digit.
#[test]
fn chatter_forgets_everything() {
    for gamma in [1.1, 1.2, 1.3, 1.4] {
        let found = settled(&BouncingBall, &[gamma, 0.5]);
        assert_eq!((found.periods, found.accumulations), (Some(1), 1.0), "Γ = {gamma}");
        assert_eq!(found.exponent.unwrap().value, f64::NEG_INFINITY, "Γ = {gamma}");
        let mut flow = HybridFlow::new(&BouncingBall, HybridSettings::default()).unwrap();
        let (mut state, p) = (found.end.clone(), [gamma, 0.5]);
        let events = flow.events(&mut state, TAU, &p).unwrap();
        let ended = events.iter().find(|event| event.accumulation).unwrap();
        close(ended.before[0], gamma * ended.time.sin(), 1e-15);
        close(ended.before[1], gamma * ended.time.cos(), 1e-15);
    }
}

/// The stable orbit with one impact a period attracts in a spiral, and comes near after two periods first.
#[test]
fn spirals_are_found_in_their_least_period() {
    let (gamma, e) = (0.95, 0.8);
    let [t, v] = bouncing_ball::orbit(1, gamma, e);
    let mut flow = HybridFlow::new(&BouncingBall, HybridSettings::default()).unwrap();
    for aside in [1e-3, 3e-3, 1e-2] {
        // In flight at the time 0, after the impact before.
        let since = TAU - t;
        let height = gamma * t.sin() + v * since - 0.5 * since * since;
        let x = vec![height * (1.0 + aside), v - since];
        let start = HybridState { mode: BouncingBall::FLIGHT, time: 0.0, x };
        let search = CycleSearch { transient: 0.0, ..CycleSearch::default() };
        let cycle = search.find(&mut flow, start, &[gamma, e]).unwrap();
        assert_eq!((cycle.periods, cycle.count(&BouncingBall, "impact")), (1, 1));
    }
}

/// Where motion begins just at an impact, rounding would tell whether one comes in a period, or two, or none.
#[test]
fn cycles_that_are_sampled_at_an_impact_are_found_in_their_least_period() {
    for (gamma, e) in [(0.6, 0.8), (0.8, 0.8), (1.2, 0.5)] {
        let [t, v] = bouncing_ball::orbit(1, gamma, e);
        let mut flow = HybridFlow::new(&BouncingBall, HybridSettings::default()).unwrap();
        for aside in [0.0, 1e-12, -1e-12, 1e-9, -1e-9] {
            // Just behind the impact, with the velocity over the ground.
            let x = vec![gamma * t.sin(), v + aside];
            let start = HybridState { mode: BouncingBall::FLIGHT, time: t, x };
            let search = CycleSearch { transient: 0.0, ..CycleSearch::default() };
            let cycle = search.find(&mut flow, start, &[gamma, e]).unwrap();
            let found = (cycle.periods, cycle.count(&BouncingBall, "impact"));
            assert_eq!(found, (1, 1), "Γ = {gamma}, e = {e}, {aside:e} aside");
        }
    }
}

/// Where time stands still, the state is that after the last event, on the surface.
#[test]
fn a_standstill_leaves_the_state_at_its_last_event() {
    /// A ball without a mode of contact.
    struct Falling;
    impl HybridSystem for Falling {
        fn modes(&self) -> Vec<Mode> {
            vec![Mode::new("flight", ["height", "velocity"])]
        }
        fn guards(&self) -> Vec<Guard> {
            vec![Guard::new("impact", [0])]
        }
        fn parameters(&self) -> Vec<String> {
            vec![]
        }
        fn field<T: Scalar>(&self, _mode: usize, _t: T, x: &[T], _p: &[T], f: &mut [T]) {
            (f[0], f[1]) = (x[1], -T::one());
        }
        fn guard<T: Scalar>(&self, _g: usize, _mode: usize, _t: T, x: &[T], _p: &[T]) -> T {
            x[0]
        }
        fn reset<T: Scalar>(
            &self,
            _g: usize,
            _modes: (usize, usize),
            _t: T,
            x: &[T],
            _p: &[T],
            after: &mut [T],
        ) {
            (after[0], after[1]) = (x[0], T::zero());
        }
        fn next_mode(&self, _g: usize, _m: usize, _t: f64, _x: &[f64], _p: &[f64]) -> usize {
            0
        }
    }
    let mut flow = HybridFlow::new(&Falling, HybridSettings::default()).unwrap();
    for (height, time) in [(0.0, 0.0), (0.5, 1.0)] {
        let mut state = HybridState { mode: 0, time: 0.0, x: vec![height, 0.0] };
        let error = flow.advance(&mut state, 3.0, &[], &mut ()).unwrap_err();
        assert!(matches!(error, HybridError::Standstill { .. }), "{error}");
        close(state.time, time, 1e-9);
        close(state.x[0], 0.0, 1e-12);
        assert_eq!(state.x[1], 0.0);
    }
}

//! Promise: a motion that comes to rest on a surface, and is released, is never beyond the surface,
//! however often it is sampled; rest is periodic and stable, and the state that a support carries
//! does not count against it.

use crate::common::close;
use crate::hybrid::systems::bouncing_ball::{self, BouncingBall};
use std::f64::consts::TAU;
use tangency::core::attractor::{
    Attractor, AttractorSearch, CycleSearch, CycleSearchError, PeriodMap,
};
use tangency::core::bvp::Shooting;
use tangency::core::continuation::{Continuation, TraceError};
use tangency::core::hybrid::{HybridError, HybridFlow, HybridSettings, HybridState, HybridSystem};
use tangency::core::orbit::from_cycle;
use tangency::core::system::Kind;
use tangency::hybrid_system;
use tangency::scene::{Scene, execute};

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

/// Below Γ = 1 the ball rests; above, without restitution, it is thrown off and lands once a
/// period: all is forgotten.
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
        // But for rounding, which the release at the top of the table's force magnifies just above
        // Γ = 1.
        assert!(found.exponent.unwrap().value < -20.0, "Γ = {gamma}: {found:?}");
    }
}

/// Chatter ends at rest on the table: the motion after it does not depend on that before, to the
/// last digit.
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

/// The ball by its height over the table, in text.
const OVER_THE_TABLE: &str = r#"Scene(
    title: "Ball",
    problem: HybridEquations(
        modes: [
            (name: "flight", states: [("height", "velocity"), ("velocity", "-1 + amplitude*sin(t)")]),
            (name: "rest", states: [("height", 0)]),
        ],
        guards: [
            (
                name: "impact", modes: ["flight"], function: "height", next: "flight",
                reset: [("velocity", "-restitution*velocity")], accumulates_to: "rest",
            ),
            (name: "leave", modes: ["rest"], function: "1 - amplitude*sin(t)", next: "flight", reset: [("velocity", 0)]),
        ],
        parameters: [("restitution", 0.5)],
        period: "2*pi",
        initial: [("velocity", 0.5)],
    ),
    parameters: [("amplitude", 1.15)],
    settings: (max_step: 0.3),
    runs: [(name: "rest", start: Simulated(transient: 200), along: [(name: "amplitude", low: 1.05, high: 1.25)])],
)"#;

/// How long the ball rests in a period, and its velocity over the table before the first impact, by
/// bisection of its flights, which are parabolas: `h'' = −1 + Γ sin t`.
fn rests(gamma: f64, e: f64) -> [f64; 2] {
    let leaves = bouncing_ball::leave(gamma);
    let (mut t, mut v, mut first) = (leaves, 0.0, None);
    loop {
        // The velocity over the ground is that over the table, and the table's.
        let (begin, ground) = (t, v + gamma * t.cos());
        let height = |s: f64| ground * s - 0.5 * s * s - gamma * ((begin + s).sin() - begin.sin());
        let pull = 1.0 - gamma * begin.sin();
        let mut high = if v == 0.0 { 4.0 } else { 3.0 * v / pull.max(0.3) };
        let mut low = if v == 0.0 { 1.0 } else { 0.5 * v };
        assert!(height(low) > 0.0 && height(high) < 0.0, "{low} {high}");
        for _ in 0..80 {
            let middle = 0.5 * (low + high);
            if height(middle) > 0.0 { low = middle } else { high = middle }
        }
        t = begin + low;
        let velocity = ground - low - gamma * t.cos();
        first.get_or_insert(velocity);
        v = -e * velocity;
        if v < 1e-6 {
            // From here on the pull is that of now: a geometric series.
            let rest = t + 2.0 * v / (1.0 - gamma * t.sin()) / (1.0 - e);
            return [leaves + TAU - rest, first.unwrap()];
        }
    }
}

/// Orbits with complete chatter are a branch: the ball rests, is thrown off, and chatters.
#[test]
fn branches_begin_at_orbits_with_an_accumulation() {
    for e in [0.05, 0.3, 0.5, 0.7] {
        let mut scene = Scene::parse(OVER_THE_TABLE).unwrap();
        scene.set("restitution", &e.to_string()).unwrap();
        scene.runs[0].marks =
            (0..20).map(|k| ("amplitude".into(), 1.055 + 0.01 * f64::from(k))).collect();
        let outcome = execute(&scene, None, &mut ());
        assert_eq!(outcome.error, None);
        let branch = &outcome.document.branches[0];
        let words: Vec<&str> = branch.itinerary.split(' ').collect();
        assert_eq!((words[0], words[words.len() - 1]), ("rest:leave", "flight:impact+"));
        assert!(branch.points.iter().all(|point| point.admissible && point.unstable == Some(0)));
        assert_eq!((branch.of_kind(Kind::UZ).count(), branch.special.len()), (20, 22));
        for mark in branch.of_kind(Kind::UZ) {
            let gamma = mark.value(branch.column("amplitude").unwrap()).unwrap();
            let [duration, fastest] = rests(gamma, e);
            // The unknowns end with the durations of the legs.
            close(mark.state[mark.state.len() - words.len()], duration, 1e-9);
            close(mark.value(branch.column("min_velocity").unwrap()).unwrap(), fastest, 1e-10);
        }
    }
}

/// The same by the height over the ground: just after its release the ball is on the table to
/// rounding, with its rate and that of the rate, and does not graze it. The times of the last
/// impacts are known to fewer digits.
#[test]
fn a_release_over_the_ground_is_no_grazing() {
    for e in [0.05, 0.3, 0.5] {
        for gamma in [1.1, 1.15, 1.2] {
            let mut flow = HybridFlow::new(&BouncingBall, HybridSettings::default()).unwrap();
            let search = CycleSearch::default();
            let cycle = search.find(&mut flow, thrown(1.0), &[gamma, e]).unwrap();
            let (mut orbits, z) =
                from_cycle(BouncingBall, &cycle, &[gamma, e], Shooting::default(), 1).unwrap();
            let run = Continuation::new(&mut orbits).from(&z).at("acceleration", gamma);
            let run =
                (0..20).fold(run, |run, k| run.mark("acceleration", 1.055 + 0.01 * f64::from(k)));
            let run = run.at("restitution", e).along("acceleration", 1.05..=1.25);
            let branch = run.trace().unwrap();
            assert!(branch.points.iter().all(|point| point.admissible));
            let kinds = branch.special.iter().map(|point| point.kind);
            assert!(kinds.clone().all(|kind| [Kind::EP, Kind::UZ].contains(&kind)), "{e} {gamma}");
            assert_eq!(kinds.count(), 22, "e = {e}, Γ = {gamma}");
            let legs = branch.itinerary.split(' ').count();
            for mark in branch.of_kind(Kind::UZ) {
                let [duration, _] = rests(mark.parameters[0], e);
                close(mark.state[mark.state.len() - legs], duration, 1e-7);
            }
        }
    }
}

/// Where the height is that over the ground, rounding tells the times of the last impacts to few
/// digits: a branch that does not begin says so.
#[test]
fn chatter_that_rounding_hides_is_an_error() {
    let (gamma, e) = (1.15, 0.7);
    let mut flow = HybridFlow::new(&BouncingBall, HybridSettings::default()).unwrap();
    let cycle = CycleSearch::default().find(&mut flow, thrown(1.0), &[gamma, e]).unwrap();
    assert!(cycle.legs.iter().any(|leg| leg.accumulation));
    let (mut orbits, z) =
        from_cycle(BouncingBall, &cycle, &[gamma, e], Shooting::default(), 1).unwrap();
    let run = Continuation::new(&mut orbits).from(&z).at("acceleration", gamma);
    let traced = run.at("restitution", e).along("acceleration", 1.1..=1.2).trace();
    assert!(matches!(traced, Err(TraceError::Start { .. })), "{traced:?}");
}

/// The stable orbit with one impact a period attracts in a spiral, and comes near after two periods
/// first.
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

/// Where motion begins just at an impact, rounding would tell whether one comes in a period, or
/// two, or none.
#[test]
fn cycles_that_are_sampled_at_an_impact_are_found_in_their_least_period() {
    for (gamma, e) in [(0.6, 0.8), (0.8, 0.8), (1.2, 0.5)] {
        let [t, v] = bouncing_ball::orbit(1, gamma, e);
        let mut flow = HybridFlow::new(&BouncingBall, HybridSettings::default()).unwrap();
        for aside in [0.0, 1e-12, -1e-12, 1e-9, -1e-9] {
            // Just after the impact, with the velocity over the ground.
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
    hybrid_system! {
        /// A ball without a mode of contact.
        struct Falling [] {
            mode flight [height, velocity] {
                d/dt height = velocity;
                d/dt velocity = -T::one();
                event impact: height => flight { height, velocity: T::zero() };
            }
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

//! Promise: the impact microactuator keeps the laws of mechanics, whatever its parameters and
//! however it starts, and moves as the literature says.

use crate::common::close;
use crate::hybrid::systems::settings;
use proptest::prelude::*;
use tangency::core::attractor::CycleSearch;
use tangency::core::hybrid::{
    Cycle, Guard, History, HybridError, HybridFlow, HybridState, HybridSystem, Mode,
};
use tangency::core::problem::Forcing;
use tangency::core::scalar::Scalar;
use tangency::problems::mita::Actuator;

/// The actuator with one more state in every mode: the work done by the electric force, the damper
/// and friction, `W' = E u₂ − c u₂² − μ_d N |u₁|`.
struct Ledger;

/// The actuator's part of a state.
fn inner<T>(x: &[T]) -> &[T] {
    &x[..x.len() - 1]
}

/// Displacement and velocity of the block and velocity of the frame, from the states' names.
fn motion<T: Scalar>(mode: usize, x: &[T]) -> [T; 3] {
    let names = Actuator.modes().swap_remove(mode).states;
    ["displacement", "velocity", "frame_velocity"]
        .map(|name| names.iter().position(|n| n == name).map_or(T::zero(), |i| x[i]))
}

/// The motion from its positions, for the ledger's field.
fn block_and_frame<T: Scalar>(mode: usize, x: &[T]) -> [T; 2] {
    match mode {
        Actuator::STICK => [x[1], T::zero()],
        Actuator::FORWARD | Actuator::BACKWARD => [x[1], x[2]],
        Actuator::CONTACT => [T::zero(), T::zero()],
        _ => [T::zero(), x[1]],
    }
}

impl HybridSystem for Ledger {
    fn modes(&self) -> Vec<Mode> {
        let mut modes = Actuator.modes();
        modes.iter_mut().for_each(|mode| mode.states.push("work".into()));
        modes
    }
    fn guards(&self) -> Vec<Guard> {
        Actuator.guards()
    }
    fn parameters(&self) -> Vec<String> {
        Actuator.parameters()
    }
    fn field<T: Scalar>(&self, mode: usize, t: T, x: &[T], p: &[T], f: &mut [T]) {
        let n = x.len() - 1;
        Actuator.field(mode, t, &x[..n], p, &mut f[..n]);
        let [u, v] = block_and_frame(mode, x);
        let force = (p[0] * (p[1] * t).sin() / (-x[0] + 1.0)).powi(2);
        let friction = p[6] * (p[7] + 1.0) * p[8];
        let speed = if v.real() < 0.0 { -v } else { v };
        f[n] = force * u - p[4] * u * u - friction * speed;
    }
    fn guard<T: Scalar>(&self, guard: usize, mode: usize, t: T, x: &[T], p: &[T]) -> T {
        Actuator.guard(guard, mode, t, inner(x), p)
    }
    fn reset<T: Scalar>(
        &self,
        guard: usize,
        modes: (usize, usize),
        t: T,
        x: &[T],
        p: &[T],
        after: &mut [T],
    ) {
        let n = after.len() - 1;
        Actuator.reset(guard, modes, t, inner(x), p, &mut after[..n]);
        after[n] = x[x.len() - 1];
    }
    fn next_mode(&self, guard: usize, mode: usize, t: f64, x: &[f64], p: &[f64]) -> usize {
        Actuator.next_mode(guard, mode, t, inner(x), p)
    }
    fn mode_after_accumulation(
        &self,
        guard: usize,
        mode: usize,
        t: f64,
        x: &[f64],
        p: &[f64],
    ) -> Option<usize> {
        Actuator.mode_after_accumulation(guard, mode, t, inner(x), p)
    }
    fn forcing(&self) -> Forcing {
        Actuator.forcing()
    }
    fn period<T: Scalar>(&self, p: &[T]) -> T {
        Actuator.period(p)
    }
}

/// Kinetic energy of both masses and energy of the spring.
fn energy([q, u, v]: [f64; 3], frame_mass: f64) -> f64 {
    0.5 * (frame_mass * v * v + (u + v) * (u + v) + q * q)
}

/// `R`, written once more.
fn force(t: f64, [q, u, _]: [f64; 3], p: &[f64]) -> f64 {
    (p[0] * (p[1] * t).sin() / (1.0 - q)).powi(2) - q - p[4] * u
}

/// Whether a motion ends with the typed error that time stands still: once in thousands of random
/// ones, where the block rests on the stopper just when the force on it vanishes.
fn stalls<T>(outcome: &Result<T, HybridError>) -> bool {
    matches!(outcome, Err(HybridError::Standstill { .. }))
}

/// Parameters about the device's: weak friction lets the frame slide without impacts.
fn parameters() -> impl Strategy<Value = [f64; 9]> {
    let strength = (0.05..0.95f64, 0.3..1.2f64, 0.2..0.6f64, 0.0..0.95f64, 0.0..0.2f64);
    let friction = (0.002..0.4f64, 0.2..1.0f64, 0.5..10.0f64);
    (strength, friction).prop_map(
        |((voltage, frequency, clearance, e, damping), (mu, ratio, m))| {
            [voltage, frequency, clearance, e, damping, mu, mu * ratio, m, 9.81]
        },
    )
}

proptest! {
    #![proptest_config(ProptestConfig { failure_persistence: None, ..ProptestConfig::with_cases(150) })]

    /// An impact conserves momentum and leaves the part `e` of the relative velocity; the energy
    /// lost is that of the reduced mass.
    #[test]
    fn impacts_conserve_momentum(p in parameters(), u in 0.001..2.0f64, v in 0.0..1.0f64, front: bool) {
        let (mode, sign) = (Actuator::FORWARD, if front { 1.0 } else { -1.0 });
        let guard = if front { Actuator::FRONT } else { Actuator::BACK };
        let x = [sign * p[2], sign * u, v, 0.3];
        let next = Actuator.next_mode(guard, mode, 0.4, &x, &p);
        let mut after = vec![0.0; Actuator.modes()[next].states.len()];
        Actuator.reset(guard, (mode, next), 0.4, &x, &p, &mut after);
        let ([q, u, v], [new_q, new_u, new_v]) = (motion(mode, &x), motion(next, &after));
        let momentum = |u: f64, v: f64| p[7] * v + (u + v);
        prop_assert!((momentum(u, v) - momentum(new_u, new_v)).abs() < 1e-14 * (1.0 + p[7]));
        prop_assert!((new_u + p[3] * u).abs() < 1e-15 && new_q == q);
        let lost = 0.5 * p[7] / (p[7] + 1.0) * (1.0 - p[3] * p[3]) * u * u;
        let change = energy([q, u, v], p[7]) - energy([new_q, new_u, new_v], p[7]);
        prop_assert!((change - lost).abs() < 1e-13, "{} {}", change, lost);
        prop_assert!(next == Actuator::STICK || (next == Actuator::FORWARD) == (new_v > 0.0));
    }

    /// Between events the energy changes by the work of the electric force, the damper and
    /// friction.
    #[test]
    fn energy_is_balanced(p in parameters(), q in -0.19..0.19f64, u in -0.5..0.5f64, t in 0.0..6.0f64) {
        let mut flow = HybridFlow::new(&Ledger, settings(1e-12)).unwrap();
        let mut state = HybridState { mode: Actuator::STICK, time: t, x: vec![q, u, 0.0] };
        prop_assume!(force(t, [q, u, 0.0], &p).abs() < p[5] * (p[7] + 1.0) * p[8]);
        let start = state.clone();
        let events = flow.events(&mut state, 40.0, &p);
        prop_assume!(!stalls(&events));
        let events = events.unwrap();
        let (mut mode, mut x) = (start.mode, start.x);
        for event in &events {
            // An accumulation follows the last event of its series from another mode, at once or
            // nearly so.
            if !event.accumulation {
                prop_assert_eq!(mode, event.mode);
                let gain = energy(motion(mode, &event.before), p[7]) - energy(motion(mode, &x), p[7]);
                let work = event.before[event.before.len() - 1] - x[x.len() - 1];
                prop_assert!((gain - work).abs() < 1e-10, "mode {}: {:e} {:e}", mode, gain, work);
            }
            (mode, x) = (event.next, event.after.clone());
        }
    }

    /// The frame sticks only while friction can hold it, slips against friction, and the block in
    /// contact is pressed against its stopper; nothing leaves its frame.
    #[test]
    fn coulombs_inequality_holds(p in parameters(), q in -0.19..0.19f64, u in -0.5..0.5f64, t in 0.0..6.0f64) {
        let holding = p[5] * (p[7] + 1.0) * p[8];
        prop_assume!(force(t, [q, u, 0.0], &p).abs() < holding);
        let mut flow = HybridFlow::new(&Actuator, settings(1e-11)).unwrap();
        let mut state = HybridState { mode: Actuator::STICK, time: t, x: vec![q, u] };
        let mut history = History::new(8);
        let outcome = flow.advance(&mut state, 40.0, &p, &mut history);
        prop_assume!(!stalls(&outcome));
        outcome.unwrap();
        for piece in &history.pieces {
            for (t, x) in piece.times.iter().zip(&piece.states) {
                let motion @ [q, _, v] = motion(piece.mode, x);
                let r = force(*t, motion, &p);
                let slides = p[6] * p[8];
                // Dense output has fewer digits than the flow.
                let holds = match piece.mode {
                    Actuator::STICK => r.abs() < holding + 1e-6,
                    Actuator::FORWARD => v > -1e-7,
                    Actuator::BACKWARD => v < 1e-7,
                    Actuator::CONTACT => r > -1e-7,
                    Actuator::RIDING_FORWARD => v > -1e-7 && r + slides > -1e-7,
                    Actuator::RIDING_BACKWARD => v < 1e-7 && r - slides > -1e-7,
                    _ => v < 1e-7 && r - slides < 1e-7,
                };
                prop_assert!(holds && q.abs() < p[2] + 1e-7, "mode {} at {}: {:?}", piece.mode, t, x);
            }
        }
    }
}

fn found(voltage: f64, tolerance: f64) -> Cycle {
    let mut p = Actuator::DEFAULTS;
    p[0] = voltage;
    let mut flow = HybridFlow::new(&Actuator, settings(tolerance)).unwrap();
    let start = HybridState { mode: Actuator::STICK, time: 0.0, x: vec![0.4, 0.0] };
    let search =
        CycleSearch { transient: 2000.0, tolerance: 1e-9, returns: 2000, ..CycleSearch::default() };
    search.find(&mut flow, start, &p).unwrap()
}

/// P(1,1) of type I at ω = 0.5, V = 0.24: the same to nine digits with a hundredth of the
/// tolerance.
#[test]
fn one_impact_in_a_period() {
    let (cycle, finer) = (found(0.24, 1e-12), found(0.24, 1e-14));
    assert_eq!((cycle.count(&Actuator, "front"), cycle.periods, cycle.legs.len()), (1, 1, 2));
    for (a, b) in cycle.legs.iter().zip(&finer.legs) {
        close(a.duration, b.duration, 1e-9);
        a.end.iter().zip(&b.end).for_each(|(a, b)| close(*a, *b, 1e-9));
    }
}

/// The ladder of chatter: P(n,1) is stable from cₙ on (section 6.2).
#[test]
fn chatter_has_as_many_impacts_as_its_table_says() {
    for (voltage, impacts) in [(0.85, 4), (0.86, 5), (0.865, 6)] {
        let cycle = found(voltage, 1e-12);
        assert_eq!((cycle.count(&Actuator, "front"), cycle.periods), (impacts, 1), "V = {voltage}");
    }
}

/// Beyond V ≈ 0.872 impacts accumulate in every period: the block rests on the stopper and leaves
/// it where the force changes sign.
#[test]
fn beyond_the_ladder_the_block_sticks_to_the_stopper() {
    for voltage in [0.874, 0.88, 0.9] {
        let cycle = found(voltage, 1e-12);
        let contact = cycle.legs.iter().filter(|leg| leg.mode == Actuator::CONTACT);
        assert!(contact.clone().count() == 1 && cycle.periods == 1, "V = {voltage}");
        assert_eq!(cycle.legs.iter().filter(|leg| leg.accumulation).count(), 1);
        for leg in contact {
            let leaves = (0.5 * 0.25_f64).sqrt() / voltage;
            assert_eq!(leg.exit, Some(Actuator::LEAVE));
            let k = cycle.legs.iter().position(|other| other == leg).unwrap();
            let time: f64 =
                cycle.start + cycle.legs[..=k].iter().map(|leg| leg.duration).sum::<f64>();
            close((0.5 * time).sin().abs(), leaves, 1e-10);
        }
    }
}

//! Robustness map of chatter: a bouncing ball comes to rest after infinitely many impacts in a
//! finite time.

use super::grid::{Found, Panel, from_to, map};
use crate::RobustnessMap;
use tangency::core::hybrid::{
    Guard, HybridError, HybridFlow, HybridSettings, HybridState, HybridSystem, Mode,
};
use tangency::core::scalar::Scalar;

/// A ball above the ground, `y'' = −1`, with coefficient of restitution `e`; the field `rests`
/// tells whether the system declares that the ball rests after infinitely many impacts.
struct Ball {
    rests: bool,
}

const FLIGHT: usize = 0;
const REST: usize = 1;

impl HybridSystem for Ball {
    fn modes(&self) -> Vec<Mode> {
        vec![Mode::new("flight", ["height", "velocity"]), Mode::new("rest", ["height"])]
    }
    fn guards(&self) -> Vec<Guard> {
        let impact = Guard::new("impact", [FLIGHT]);
        vec![if self.rests { impact.accumulating_to(REST) } else { impact }]
    }
    fn parameters(&self) -> Vec<String> {
        vec!["restitution".into()]
    }
    fn field<T: Scalar>(&self, mode: usize, _t: T, x: &[T], _p: &[T], f: &mut [T]) {
        f[0] = T::zero();
        if mode == FLIGHT {
            (f[0], f[1]) = (x[1], -T::one());
        }
    }
    fn guard<T: Scalar>(&self, _guard: usize, _mode: usize, _t: T, x: &[T], _p: &[T]) -> T {
        x[0]
    }
    fn reset<T: Scalar>(
        &self,
        _g: usize,
        (_, next): (usize, usize),
        _t: T,
        x: &[T],
        p: &[T],
        after: &mut [T],
    ) {
        after[0] = x[0];
        if next == FLIGHT {
            after[1] = -p[0] * x[1];
        }
    }
    fn next_mode(&self, _guard: usize, _mode: usize, _t: f64, _x: &[f64], _p: &[f64]) -> usize {
        FLIGHT
    }
}

/// The initial height of the ball, from which it falls to the ground in a time of 1.
const HEIGHT: f64 = 0.5;

/// Returns the time at which the ball comes to rest: the sum of the geometric series of the times
/// of flight.
fn rest(restitution: f64) -> f64 {
    (1.0 + restitution) / (1.0 - restitution)
}

/// Returns the exact height of the ball at a time.
fn height(restitution: f64, time: f64) -> f64 {
    if time >= rest(restitution) {
        return 0.0;
    }
    let (mut start, mut speed) = (-1.0, 1.0);
    while start + 2.0 * speed < time && speed > 1e-12 {
        start += 2.0 * speed;
        speed *= restitution;
    }
    let flown = time - start;
    flown * (speed - 0.5 * flown)
}

/// Simulates the ball with the library's hybrid flow, up to a given fraction of the time at which
/// the ball comes to rest.
fn followed(rests: bool, settings: HybridSettings, restitution: f64, part: f64) -> Found {
    let end = part * rest(restitution);
    let ball = Ball { rests };
    let mut state = HybridState { mode: FLIGHT, time: 0.0, x: vec![HEIGHT, 0.0] };
    let motion = HybridFlow::new(&ball, settings)
        .and_then(|mut flow| flow.advance(&mut state, end, &[restitution], &mut ()));
    let near = (state.x[0] - height(restitution, end)).abs() < 1e-8;
    match motion {
        Ok(_) if !near => Found::silent("at another height"),
        Ok(statistics) if statistics.accumulations > 0 => {
            Found::handed_over("impacts completed in closed form, then rest")
        }
        Ok(_) => Found::right("impacts one by one"),
        Err(cause) => {
            let name = match cause {
                HybridError::Accumulation { .. } => "accumulation without a mode for rest",
                HybridError::Standstill { .. } => "time stands still",
                HybridError::Outside { .. } => "below the ground",
                _ => "another failure",
            };
            Found::reported(name, cause)
        }
    }
}

/// Simulates the ball with time steps of equal length; the velocity is reversed after a step that
/// ends below the ground.
fn stepped(restitution: f64, part: f64) -> Found {
    let (end, step) = (part * rest(restitution), 0.01_f64);
    let (mut y, mut v, mut t) = (HEIGHT, 0.0_f64, 0.0_f64);
    while t < end {
        let h = step.min(end - t);
        y += h * (v - 0.5 * h);
        v -= h;
        t += h;
        if y < 0.0 && v < 0.0 {
            v *= -restitution;
        }
    }
    match y - height(restitution, end) {
        _ if y < -step => Found::silent("below the ground"),
        error if error.abs() > 2.0 * step => Found::silent("at another height"),
        _ => Found::right("the height, to the fall in two steps"),
    }
}

/// Computes four panels.
pub(super) fn draw() -> RobustnessMap {
    let (losses, ends) = (from_to(-2.0, 0.0, 17), from_to(0.275, 1.325, 15));
    let panel = |name: &str, naive, method: &dyn Fn(f64, f64) -> Found| {
        let labels = ["log₁₀ of 1 − restitution", "end of the motion / time to rest"];
        let method = |x: f64, y| method(1.0 - 10_f64.powf(x), y);
        Panel::of((name, naive), labels, [&losses, &ends], method)
    };
    let usual = HybridSettings::default();
    let one_by_one = HybridSettings { accumulation: 0.0, ..usual.clone() };
    map(
        "chatter",
        vec![
            panel("A mode is named for rest", false, &|e, end| {
                followed(true, usual.clone(), e, end)
            }),
            panel("No mode is named", false, &|e, end| followed(false, usual.clone(), e, end)),
            panel("All impacts are computed", false, &|e, end| {
                followed(false, one_by_one.clone(), e, end)
            }),
            panel("Steps of fixed length", true, &stepped),
        ],
    )
}

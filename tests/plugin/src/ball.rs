//! A ball on a table that moves as `Γ sin t`, in units of time `1/ω` and of length `g/ω²`.

use std::f64::consts::TAU;
use tangency::prelude::*;

/// Modes `flight` and `contact`, in which the ball moves with the table.
pub struct Ball;

const FLIGHT: usize = 0;
const CONTACT: usize = 1;
const IMPACT: usize = 0;

impl HybridSystem for Ball {
    fn modes(&self) -> Vec<Mode> {
        vec![Mode::new("flight", ["height", "velocity"]), Mode::new("contact", ["height"])]
    }
    fn guards(&self) -> Vec<Guard> {
        let impact = Guard::new("impact", [FLIGHT]).accumulating_to(CONTACT);
        vec![impact, Guard::new("leave", [CONTACT])]
    }
    fn parameters(&self) -> Vec<String> {
        vec!["acceleration".into(), "restitution".into()]
    }
    fn defaults(&self) -> Vec<f64> {
        vec![1.2, 0.5]
    }
    fn field<T: Scalar>(&self, mode: usize, t: T, x: &[T], p: &[T], f: &mut [T]) {
        if mode == FLIGHT {
            f[0] = x[1];
            f[1] = -T::one();
        } else {
            f[0] = p[0] * t.cos();
        }
    }
    fn guard<T: Scalar>(&self, guard: usize, _mode: usize, t: T, x: &[T], p: &[T]) -> T {
        let table = p[0] * t.sin();
        // The table pushes by its acceleration −Γ sin t and the weight.
        if guard == IMPACT { x[0] - table } else { T::one() - table }
    }
    fn reset<T: Scalar>(
        &self,
        guard: usize,
        (_, next): (usize, usize),
        t: T,
        x: &[T],
        p: &[T],
        after: &mut [T],
    ) {
        let table = p[0] * t.cos();
        after[0] = x[0];
        if next == FLIGHT {
            after[1] = if guard == IMPACT { table - p[1] * (x[1] - table) } else { table };
        }
    }
    fn next_mode(&self, _guard: usize, _mode: usize, _t: f64, _x: &[f64], _p: &[f64]) -> usize {
        FLIGHT
    }
    fn forcing(&self) -> Forcing {
        Forcing::Periodic { phase: TAU }
    }
    fn period<T: Scalar>(&self, _p: &[T]) -> T {
        T::constant(TAU)
    }
}

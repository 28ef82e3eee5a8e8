//! Time for a step of a branch of periodic orbits of coupled oscillators: a ring of oscillators with
//! 20, 40 and 80 states, by collocation on 100 intervals with 4 points each, with dense and with sparse
//! matrices. Neither stability nor special points are computed, apart from folds, whose detection costs
//! nothing.
//!
//! `benches/peers/coupled.py` runs this program beside AUTO-07p and puts both into one table.

use std::error::Error;
use std::f64::consts::TAU;
use std::time::Instant;
use tangency::core::bvp::Collocation;
use tangency::core::continuation::{Continuation, Settings};
use tangency::core::orbit::periodic_orbits;
use tangency::core::problem::{Group, Names, VectorField};
use tangency::core::scalar::Scalar;
use tangency::core::system::{Kind, Matrices};

/// A ring of oscillators, with diffusion between neighbours. The oscillators move together on the unit
/// circle, with the period `2π/w`.
struct Ring {
    oscillators: usize,
}

impl VectorField for Ring {
    fn names(&self) -> Names {
        let group =
            |name: &'static str| (1..=self.oscillators).map(move |i| format!("{name}[{i}]"));
        let all: Vec<String> = group("x").chain(group("y")).collect();
        Names::new(Group::of_states(&all), ["w", "k"])
    }

    fn field<T: Scalar>(&self, _t: T, u: &[T], p: &[T], f: &mut [T]) {
        let m = self.oscillators;
        for i in 0..m {
            let (before, after) = ((i + m - 1) % m, (i + 1) % m);
            let (x, y) = (u[i], u[m + i]);
            let square = x * x + y * y;
            f[i] = x - p[0] * y - x * square + p[1] * (u[before] - x * 2.0 + u[after]);
            f[m + i] = p[0] * x + y - y * square + p[1] * (u[m + before] - y * 2.0 + u[m + after]);
        }
    }
}

/// Elapsed time in ms for the first `points` points of the branch.
fn time(states: usize, matrices: Matrices, points: usize) -> Result<f64, Box<dyn Error>> {
    let collocation = Collocation::new(4)?.with_matrices(matrices);
    let mut orbits = periodic_orbits(Ring { oscillators: states / 2 }, 100, collocation)?;
    let start = orbits.sampled(&[TAU], |_, tau, u| {
        let (sine, cosine) = (TAU * tau).sin_cos();
        let (x, y) = u.split_at_mut(states / 2);
        x.fill(cosine);
        y.fill(sine);
    });
    let settings = Settings {
        initial_step: 0.02,
        max_step: 0.02,
        max_points: points,
        tolerance: 1e-5,
        stability: false,
        detect: vec![Kind::LP],
        ..Settings::default()
    };
    let begin = Instant::now();
    let branch = Continuation::new(&mut orbits)
        .settings(settings)
        .from(&start)
        .at("w", 1.0)
        .at("k", 0.3)
        .along("w", 1.0..=100.0)
        .forward()
        .trace()?;
    let elapsed = begin.elapsed().as_secs_f64() * 1e3;
    let period = branch.points.last().and_then(|point| point.value(branch.column("period")?));
    let frequency = branch.points.last().map(|point| point.parameters[0]).unwrap_or_default();
    assert!(period.is_some_and(|period| (period * frequency / TAU - 1.0).abs() < 1e-8));
    Ok(elapsed)
}

fn main() -> Result<(), Box<dyn Error>> {
    println!("| ms for a step | 20 states | 40 states | 80 states |");
    println!("|---|---|---|---|");
    for (name, matrices) in [("dense", Matrices::Dense), ("sparse", Matrices::Sparse)] {
        let mut row = format!("| tangency, {name} matrices |");
        for states in [20, 40, 80] {
            let (start, steps) = (3, 6);
            let times = [start, start + steps].map(|points| time(states, matrices, points));
            let [few, more] = times;
            let step = (more? - few?) / steps as f64;
            row += &format!(" {step:.2} |");
        }
        println!("{row}");
    }
    Ok(())
}

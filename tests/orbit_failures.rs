//! Promise: where a method of periodic orbits breaks, the error says so, names the quantity, and keeps what there
//! is.

mod common;
mod cycles;

use common::{close, first};
use cycles::{Saddle, collocated, equilibria, label, shot, solved};
use std::f64::consts::TAU;
use tangency::core::bvp::{BoundaryError, Collocation, Shooting};
use tangency::core::continuation::{Branch, Continuation, End, Kind, Settings, TraceError};
use tangency::core::field::VectorField;
use tangency::core::flow::Scheme;
use tangency::core::orbit::{Simulation, by_collocation, by_shooting};
use tangency::core::scalar::Scalar;
use tangency::core::zero::{Names, System};
use tangency::problems::classic::Lure;
use tangency::problems::mita::Block;

/// The saddle's solution from a perturbed one, its largest error on the way, and its multipliers.
macro_rules! saddle {
    ($system:expr, $rate:expr) => {{
        let mut system = $system;
        let p = [1.0, $rate];
        let z = system.sampled(&[], |_, tau, x| {
            let (sine, cosine) = (TAU * tau).sin_cos();
            (x[0], x[1]) = (1.1 * cosine + 0.05, 0.9 * sine - 0.02);
        });
        solved(&mut system, &z, &p).map(|x| {
            let mut worst = 0.0_f64;
            for k in 0..=40 {
                let tau = k as f64 / 40.0;
                let mut found = [0.0; 2];
                system.states(&x, 0, tau, &mut found).unwrap();
                let (sine, cosine) = (TAU * tau).sin_cos();
                worst = worst.max((found[0] - cosine).abs()).max((found[1] - sine).abs());
            }
            system.assemble(&x).unwrap();
            (worst, system.multipliers().unwrap())
        })
    }};
}

/// The multipliers of the saddle are `exp(±2πλ)`.
#[test]
fn strongly_unstable_orbits() {
    for (rate, tolerance) in [(2.2, 1e-9), (3.5, 1e-9), (6.0, 1e-9)] {
        let exact = (TAU * rate).exp();
        for (name, outcome) in [
            ("collocation", saddle!(collocated(Saddle, 60), rate)),
            ("multiple shooting", saddle!(shot(Saddle, 12), rate)),
        ] {
            let (error, mu) = outcome.unwrap();
            println!("{name} {rate}: error {error:.1e}, multipliers {mu:?}");
            assert!(error < tolerance, "{name}, rate {rate}: {error:.1e}");
            close(mu[0].0 / exact, 1.0, 1e-6);
            close(mu[1].0 * exact, 1.0, 1e-6);
        }
    }
    // One segment multiplies rounding by the multiplier.
    for (rate, least) in [(3.5, 1e-9), (6.0, 1e-3)] {
        match saddle!(shot(Saddle, 1), rate) {
            Ok((error, _)) => {
                println!("single shooting {rate}: error {error:.1e}");
                assert!(error > least && error < 1e-15 * (TAU * rate).exp() * 1e3)
            }
            Err(cause) => println!("{cause}"),
        }
    }
}

/// Where one segment loses digits, special points say so by their error.
#[test]
fn lost_digits_are_in_the_error() {
    for rate in [3.5, 4.5, 6.0] {
        let mut system = shot(Saddle, 1);
        let z = system.sampled(&[], |_, tau, x| {
            let (sine, cosine) = (TAU * tau).sin_cos();
            (x[0], x[1]) = (cosine, sine);
        });
        let outcome = Continuation::of(&mut system)
            .from(&z)
            .at("amplitude", 1.0)
            .at("rate", rate)
            .along("amplitude", 0.5..=2.0)
            .mark("max_x", 1.5)
            .trace();
        match outcome {
            Err(cause) => println!("{rate}: {cause}"),
            Ok(branch) => {
                println!("{rate}: {:?}", branch.ends);
                for point in branch.of_kind(Kind::UZ) {
                    let error = (point.parameters[0] - 1.5).abs();
                    println!("{rate}: {error:.1e} {:.1e} {}", point.error, point.converged);
                    assert!(error <= point.error);
                }
            }
        }
    }
}

/// Van der Pol's relaxation oscillation: `x' = y`, `y' = μ(1 − x²)y − x`.
#[derive(Clone, Copy)]
struct VanDerPol;

impl VectorField for VanDerPol {
    fn names(&self) -> Names {
        Names::new(["x", "y"], ["mu"])
    }
    fn field<T: Scalar>(&self, _t: T, x: &[T], p: &[T], f: &mut [T]) {
        f[0] = x[1];
        f[1] = p[0] * (T::one() - x[0] * x[0]) * x[1] - x[0];
    }
}

fn relaxation(intervals: usize) -> Branch {
    let mut system = collocated(VanDerPol, intervals);
    let z = system.simulated(&Simulation::default(), &[1.0, 0.0], &[1.0]).unwrap();
    Continuation::of(&mut system)
        .from(&z)
        .at("mu", 1.0)
        .along("mu", 1.0..=5.0)
        .settings(Settings { max_step: 0.2, max_points: 200, ..Settings::default() })
        .trace()
        .unwrap()
}

/// A mesh too coarse for the orbit: the monitor `mesh_error` and the error of special points say so.
#[test]
fn a_coarse_mesh_is_not_trusted() {
    let branch = relaxation(5);
    println!("{:?} {:?}", branch.ends[1], branch.points.last());
    let fine = relaxation(60);
    println!("{:?} {:?}", fine.ends[1], fine.points.last());
    let column = branch.monitors.iter().position(|name| name == "mesh_error").unwrap();
    let (coarse, fine) = (branch.points.last().unwrap(), fine.points.last().unwrap());
    assert_eq!(fine.parameters[0], 5.0);
    assert!(fine.monitors[column] < 1e-4);
    // The period at μ = 5: 11.6122…
    let period = fine.monitors[0];
    close(period, 11.6122, 2e-4);
    if coarse.parameters[0] == 5.0 {
        let error = (coarse.monitors[0] / period - 1.0).abs();
        println!("{error:.1e} {:.1e}", coarse.monitors[column]);
        assert!(coarse.monitors[column] > 0.01 && coarse.monitors[column] > error);
    }
}

/// `ε x' = −(x − cos t) − ε sin t`, `y' = −y`, with the periodic solution `x = cos t`.
#[derive(Clone, Copy)]
struct Stiff;

impl VectorField for Stiff {
    fn names(&self) -> Names {
        Names::new(["x", "y"], ["amplitude", "rate"])
    }
    fn field<T: Scalar>(&self, t: T, x: &[T], p: &[T], f: &mut [T]) {
        let (sine, cosine) = t.sin_cos();
        f[0] = -p[1] * (x[0] - p[0] * cosine) - p[0] * sine;
        f[1] = -x[1];
    }
    fn period<T: Scalar>(&self, _p: &[T]) -> Option<T> {
        Some(T::constant(TAU))
    }
}

#[test]
fn stiff_fields() {
    fn wave(_: usize, tau: f64, x: &mut [f64]) {
        (x[0], x[1]) = ((TAU * tau).cos(), 0.0);
    }
    let trace = |system: &mut dyn System, z: &[f64]| {
        Continuation::of(system)
            .from(z)
            .at("amplitude", 1.0)
            .at("rate", 1e5)
            .along("amplitude", 0.5..=2.0)
            .mark("max_x", 1.5)
            .settings(Settings { accuracy: 0.0, ..Settings::default() })
            .trace()
    };
    // The explicit pair refuses by name.
    let mut explicit = shot(Stiff, 1);
    let z = explicit.sampled(&[], wave);
    let refused = trace(&mut explicit, &z).unwrap_err().to_string();
    assert!(refused.contains("stiff") && refused.contains("implicit"), "{refused}");
    let rodas = Shooting::new(Scheme::Rodas5P, 1e-8).unwrap();
    let (mut collocation, mut implicit) =
        (collocated(Stiff, 30), by_shooting(Stiff, 1, rodas).unwrap());
    let starts = [collocation.sampled(&[], wave), implicit.sampled(&[], wave)];
    let systems = [&mut collocation as &mut dyn System, &mut implicit];
    for ((system, z), tolerance) in systems.into_iter().zip(starts).zip([1e-7, 1e-6]) {
        let branch = trace(system, &z).unwrap();
        println!("{:e}", first(&branch, Kind::UZ).parameters[0] - 1.5);
        close(first(&branch, Kind::UZ).parameters[0], 1.5, tolerance);
        assert!(branch.points.iter().all(|point| point.unstable == Some(0)));
    }
}

/// The block reaches the electrode at a displacement of 1.
#[test]
fn a_field_that_leaves_its_domain() {
    for system in [&mut collocated(Block, 20) as &mut dyn System, &mut shot(Block, 1)] {
        let branch = Continuation::of(system)
            .at("voltage", 0.01)
            .at("frequency", 0.45)
            .at("damping", 0.04)
            .along("voltage", 0.01..=0.5)
            .settings(Settings { accuracy: 0.0, ..Settings::default() })
            .trace()
            .unwrap();
        println!("{:?} {} {:?}", branch.ends[1], branch.points.len(), branch.points.last());
        assert!(branch.points.len() > 20 && !branch.special.is_empty());
        assert!(branch.points.iter().all(|point| point.monitors[1] < 1.0));
        if let End::StepTooSmall { cause, .. } = &branch.ends[1] {
            assert!(!cause.is_empty());
        }
    }
}

#[test]
fn bad_input_is_refused() {
    let method = Collocation::new(4).unwrap();
    let none = by_collocation(Lure, 0, method).err().unwrap();
    assert_eq!(none, BoundaryError::NoIntervals { segment: 0 });
    assert!(by_shooting(Lure, 0, Shooting::default()).is_err());
    let mut system = collocated(Lure, 10);
    let outcome = Continuation::of(&mut system).from(&[0.0; 3]).along("alpha", 0.0..=1.0).trace();
    assert!(matches!(outcome, Err(TraceError::StateLength { found: 3, .. })));
    let outcome = Continuation::of(&mut system).along("alhpa", 0.0..=1.0).trace();
    assert!(outcome.unwrap_err().to_string().contains("did you mean `alpha`"));

    // A start on another problem's orbit, on an equilibrium that is no Hopf point, at a Hopf point of a forced one.
    let rest = equilibria(Lure, &[0.0; 3], &[1.2, 1.0], [0.5, 1.5]);
    let restart = |system: &mut dyn System, branch: &Branch, kind: Kind| {
        let outcome = Continuation::of(system)
            .restart(branch, label(branch, kind))
            .along("alpha", 0.4..=1.6)
            .settings(Settings { max_points: 3, ..Settings::default() })
            .trace();
        outcome.map(|_| ()).unwrap_err().to_string()
    };
    let text = restart(&mut collocated(Lure, 10), &rest, Kind::EP);
    assert!(text.contains("is not on the imaginary axis") && text.contains("HB"), "{text}");
    let orbits = Continuation::of(&mut system)
        .restart(&rest, label(&rest, Kind::HB))
        .along("alpha", 0.4..=1.6)
        .settings(Settings { max_points: 100, ..Settings::default() })
        .trace()
        .unwrap();
    let start = |system: &mut dyn System, parameter: &str| {
        let branch = Branch { parameters: Vec::new(), ..orbits.clone() };
        let outcome =
            Continuation::of(system).restart(&branch, 1).along(parameter, -1.0..=1.0).trace();
        outcome.map(|_| ()).unwrap_err().to_string()
    };
    let text = start(&mut collocated(VanDerPol, 10), "mu");
    assert!(text.contains("another problem"), "{text}");
    let text = start(&mut collocated(Block, 10), "voltage");
    assert!(text.contains("another problem"), "{text}");
    // A period doubling found by collocation is not switched at by shooting.
    let text = Continuation::of(&mut shot(Lure, 2))
        .restart(&orbits, label(&orbits, Kind::PD))
        .switch()
        .along("alpha", 0.4..=1.6)
        .trace()
        .map(|_| ())
        .unwrap_err()
        .to_string();
    assert!(text.contains("another method"), "{text}");
}

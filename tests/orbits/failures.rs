//! Promise: where a method of periodic orbits breaks, the error says so, names the quantity, and
//! keeps what there is.

use crate::common::{VanDerPol, close, ellipse, first, solved};
use crate::orbits::cycles::{Saddle, collocated, collocation, cycle_of, equilibria, label, shot};
use std::f64::consts::TAU;
use tangency::core::attractor::CycleSearch;
use tangency::core::bvp::{BoundaryError, Collocation, Shooting};
use tangency::core::continuation::{Branch, Continuation, End, Settings, TraceError};
use tangency::core::failure::{OutOfDomain, one_line};
use tangency::core::ode::Scheme;
use tangency::core::orbit::{Smooth, from_cycle, periodic_orbits};
use tangency::core::system::{Kind, System};
use tangency::problems::classic::Lure;
use tangency::problems::mita::Block;
use tangency::vector_field;

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
                let found = system.states(&x, 0, tau).unwrap();
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
            assert!(error < tolerance, "{name}, rate {rate}: {error:.1e}");
            close(mu[0].0 / exact, 1.0, 1e-6);
            close(mu[1].0 * exact, 1.0, 1e-6);
        }
    }
    // One segment multiplies rounding by the multiplier.
    for (rate, least) in [(3.5, 1e-9), (6.0, 1e-3)] {
        match saddle!(shot(Saddle, 1), rate) {
            Ok((error, _)) => {
                assert!(error > least && error < 1e-15 * (TAU * rate).exp() * 1e3)
            }
            Err(cause) => assert!(!cause.to_string().is_empty()),
        }
    }
}

/// Where one segment loses digits, special points say so by their error.
#[test]
fn lost_digits_are_in_the_error() {
    for rate in [3.5, 4.5, 6.0] {
        let mut system = shot(Saddle, 1);
        let z = system.sampled(&[], ellipse(1.0, 1.0));
        let outcome = Continuation::new(&mut system)
            .from(&z)
            .at("amplitude", 1.0)
            .at("rate", rate)
            .along("amplitude", 0.5..=2.0)
            .mark("max_x", 1.5)
            .trace();
        match outcome {
            Err(cause) => {
                assert!(
                    rate == 6.0 && one_line(&cause).contains("more shooting segments"),
                    "{cause}"
                )
            }
            Ok(branch) => {
                for point in branch.of_kind(Kind::UZ) {
                    let error = (point.parameters[0] - 1.5).abs();
                    assert!(error <= point.error);
                }
            }
        }
    }
}

fn relaxation(intervals: usize) -> Branch {
    let cycle = cycle_of(VanDerPol, CycleSearch::default(), &[1.0, 0.0], &[1.0]).unwrap();
    let (mut system, z) =
        from_cycle(Smooth(VanDerPol), &cycle, &[1.0], collocation(4), intervals).unwrap();
    Continuation::new(&mut system)
        .from(&z)
        .at("mu", 1.0)
        .along("mu", 1.0..=5.0)
        .settings(Settings {
            max_step: 0.2,
            max_points: 200,
            // Nothing adds intervals.
            target_mesh_error: f64::MAX,
            ..Settings::default()
        })
        .trace()
        .unwrap()
}

/// A mesh too coarse for the orbit: the monitor `mesh_error` and the error of special points say
/// so.
#[test]
fn a_coarse_mesh_is_not_trusted() {
    let branch = relaxation(5);
    let fine = relaxation(60);
    let column = branch.monitors.iter().position(|name| name == "mesh_error").unwrap();
    let (coarse, fine) = (branch.points.last().unwrap(), fine.points.last().unwrap());
    assert_eq!(fine.parameters[0], 5.0);
    close(fine.monitors[0], 11.612230667, 1e-6);
    assert!(fine.monitors[column] < 1e-9, "{fine:?}");
    let said = matches!(branch.ends[1], End::StepTooSmall { .. } | End::MeshTooCoarse { .. });
    assert!(said || coarse.monitors[column] > 0.1, "{:?} {coarse:?}", branch.ends);
}

vector_field! {
    /// `ε x' = −(x − cos t) − ε sin t`, `y' = −y`, with the periodic solution `x = cos t`.
    struct Stiff [x, y; amplitude, rate; t] {
        let (sine, cosine) = t.sin_cos();
        d/dt x = -rate * (x - amplitude * cosine) - amplitude * sine;
        d/dt y = -y;
        period = T::constant(TAU);
    }
}

#[test]
fn stiff_fields() {
    let trace = |system: &mut dyn System, z: &[f64]| {
        Continuation::new(system)
            .from(z)
            .at("amplitude", 1.0)
            .at("rate", 1e5)
            .along("amplitude", 0.5..=2.0)
            .mark("max_x", 1.5)
            .settings(Settings { refinement: 0.0, ..Settings::default() })
            .trace()
    };
    // The explicit pair refuses by name.
    let mut explicit = shot(Stiff, 1);
    let z = explicit.sampled(&[], ellipse(1.0, 0.0));
    let refused = one_line(&trace(&mut explicit, &z).unwrap_err());
    assert!(refused.contains("stiff") && refused.contains("implicit"), "{refused}");
    let rodas = Shooting::new(Scheme::Rodas5P, 1e-10).unwrap();
    let (mut collocation, mut implicit) =
        (collocated(Stiff, 30), periodic_orbits(Stiff, 1, rodas).unwrap());
    let starts =
        [collocation.sampled(&[], ellipse(1.0, 0.0)), implicit.sampled(&[], ellipse(1.0, 0.0))];
    let systems = [&mut collocation as &mut dyn System, &mut implicit];
    for (system, z) in systems.into_iter().zip(starts) {
        let branch = trace(system, &z).unwrap();
        close(first(&branch, Kind::UZ).parameters[0], 1.5, 1e-6);
        assert!(branch.points.iter().all(|point| point.unstable == Some(0)));
    }
}

vector_field! {
    /// `x' = −x + A (cos t − sin t)`, whose periodic solution is `A cos t`, in a box that ends at 1.2.
    struct Walled [x; amplitude; t] {
        let (sine, cosine) = t.sin_cos();
        d/dt x = amplitude * (cosine - sine) - x;
        period = T::constant(TAU);
        fn domain(&self, x: &[f64], _p: &[f64]) -> Result<(), OutOfDomain> {
            if x[0] <= 1.2 {
                return Ok(());
            }
            Err(OutOfDomain::new("x", x[0], "the box ends at 1.2"))
        }
    }
}

#[test]
fn a_field_that_leaves_its_domain() {
    for system in [&mut collocated(Walled, 20) as &mut dyn System, &mut shot(Walled, 2)] {
        let branch = Continuation::new(system)
            .along("amplitude", 0.0..=2.0)
            .mark("max_x", 1.0)
            .trace()
            .unwrap();
        let End::StepTooSmall { cause, .. } = &branch.ends[1] else { panic!("{:?}", branch.ends) };
        assert!(cause.contains("at t =") && cause.contains("the box ends at 1.2"), "{cause}");
        close(first(&branch, Kind::UZ).parameters[0], 1.0, 1e-10);
        let last = branch.points.last().unwrap();
        // The nodes of a mesh need not see the very top of the orbit.
        assert!((1.19..1.21).contains(&last.parameters[0]), "{last:?}");
        assert_eq!(branch.special.last().unwrap().kind, Kind::MX);
    }
}

#[test]
fn bad_input_is_refused() {
    let method = Collocation::new(4).unwrap();
    let none = periodic_orbits(Lure, 0, method).err().unwrap();
    assert_eq!(none, BoundaryError::NoIntervals(0));
    assert!(periodic_orbits(Lure, 0, Shooting::default()).is_err());
    let mut system = collocated(Lure, 10);
    let outcome = Continuation::new(&mut system).from(&[0.0; 3]).along("alpha", 0.0..=1.0).trace();
    assert!(matches!(outcome, Err(TraceError::StateLength { found: 3, .. })));
    let outcome = Continuation::new(&mut system).along("alhpa", 0.0..=1.0).trace();
    assert!(one_line(&outcome.unwrap_err()).contains("`alhpa`; did you mean `alpha`?"));

    // A start on another problem's orbit, on an equilibrium that is no Hopf point, at a Hopf point
    // of a forced one.
    let rest = equilibria(Lure, &[0.0; 3], &[1.2, 1.0], [0.5, 1.5]);
    let restart = |system: &mut dyn System, branch: &Branch, kind: Kind| {
        let outcome = Continuation::new(system)
            .restart(branch, label(branch, kind))
            .along("alpha", 0.4..=1.6)
            .settings(Settings { max_points: 3, ..Settings::default() })
            .trace();
        one_line(&outcome.map(|_| ()).unwrap_err())
    };
    let text = restart(&mut collocated(Lure, 10), &rest, Kind::EP);
    assert!(text.contains("is not on the imaginary axis") && text.contains("HB"), "{text}");
    let orbits = Continuation::new(&mut system)
        .restart(&rest, label(&rest, Kind::HB))
        .along("alpha", 0.4..=1.6)
        .settings(Settings { max_points: 100, ..Settings::default() })
        .trace()
        .unwrap();
    let start = |system: &mut dyn System, parameter: &str| {
        let branch = Branch { parameters: Vec::new(), ..orbits.clone() };
        let outcome =
            Continuation::new(system).restart(&branch, 1).along(parameter, -1.0..=1.0).trace();
        one_line(&outcome.map(|_| ()).unwrap_err())
    };
    let text = start(&mut collocated(VanDerPol, 10), "mu");
    assert!(text.contains("another problem"), "{text}");
    let text = start(&mut collocated(Block, 10), "voltage");
    assert!(text.contains("another problem"), "{text}");
    // A period doubling found by collocation is not switched at by shooting.
    let text = Continuation::new(&mut shot(Lure, 2))
        .restart(&orbits, label(&orbits, Kind::PD))
        .switch()
        .along("alpha", 0.4..=1.6)
        .trace()
        .map(|_| ())
        .unwrap_err()
        .to_string();
    assert!(text.contains("another discretisation method"), "{text}");
    // A period doubling that is no solution of the problem, in its length or by its method.
    assert_eq!(orbits.method, "collocation(4)");
    let doubling = label(&orbits, Kind::PD);
    let changed = |method: &str, state: &[f64], mesh: &[f64]| {
        let mut branch = Branch { method: method.into(), ..orbits.clone() };
        let special = branch.special.iter_mut().find(|special| special.label == doubling).unwrap();
        (special.state, special.mesh) = (state.to_vec(), mesh.to_vec());
        let mut system = collocated(Lure, 10);
        let start = Continuation::new(&mut system).restart(&branch, doubling).switch();
        one_line(&start.along("alpha", 0.4..=1.6).trace().map(|_| ()).unwrap_err())
    };
    let saved = orbits.labelled(doubling).unwrap();
    for (state, mesh) in [(&[][..], &[][..]), (&[0.5], &[]), (&[0.5], &saved.mesh)] {
        let text = changed("collocation(4)", state, mesh);
        assert!(text.contains("another problem"), "{text}");
    }
    let text = changed("shooting", &saved.state, &saved.mesh);
    assert!(text.contains("another problem"), "{text}");
    let text = changed("trapezium(1)", &saved.state, &saved.mesh);
    assert!(text.contains("unknown method `trapezium(1)`"), "{text}");
}

//! The modal model of the plate against independently computed values and against the full model.

use tangency::core::continuation::{Continuation, Kind};
use tangency::core::dense::Dense;
use tangency::core::zero::System;
use tangency::problems::plate::InPlane;
use tangency::problems::plate::modal::{Modal, ModalSettings, ModalSystem};
use tangency::problems::plate::sine::Projection;

fn settings(supports: &str, modes: usize, projection: Projection) -> ModalSettings {
    let supports = supports.parse().expect("four edges");
    ModalSettings { modes, projection, ..ModalSettings::new(supports) }
}

/// `(λ, w)` at pull-in.
fn pull_in(settings: ModalSettings, gap_ratio: f64) -> (f64, f64) {
    let start = std::time::Instant::now();
    let modal = Modal::new(settings).expect("valid settings");
    println!("{:?} {:?} built {:?}", modal.orders(), modal.frequencies(), start.elapsed());
    let defaults = modal.defaults();
    let mut system = ModalSystem::new(modal);
    let names = system.names().clone();
    let start = std::time::Instant::now();
    let mut run = Continuation::of(&mut system);
    for (name, value) in names.parameters.iter().zip(&defaults) {
        run = run.at(name, *value);
    }
    let branch = run
        .at("gap_ratio", gap_ratio)
        .along("load", 0.0..=400.0)
        .bound("max_deflection", 0.0..=0.9)
        .trace()
        .expect("a start");
    let fold = branch.of_kind(Kind::LP).next().expect("a fold");
    let deflection = fold.value(branch.column("deflection").expect("a monitor")).expect("a value");
    println!("traced {:?} {} points", start.elapsed(), branch.points.len());
    println!(
        "{} {:?} N={} α₁={gap_ratio}: {:.7} {deflection:.7} err {:.1e} {:?}",
        settings.plate.supports, settings.projection, settings.modes, fold.parameters[0], fold.error, branch.ends
    );
    (fold.parameters[0], deflection)
}

#[test]
fn explore() {
    for n in [1, 3, 7, 8] {
        for projection in [Projection::Direct, Projection::Multiplied] {
            pull_in(settings("CCCC", n, projection), 1.0);
        }
    }
    for n in [1, 2, 6, 15] {
        for projection in [Projection::Direct, Projection::Multiplied] {
            pull_in(settings("SSSS", n, projection), 2.0);
        }
    }
}

#[test]
fn more() {
    for (edges, in_plane) in [
        ("SSSS", InPlane::Slide), ("CCCC", InPlane::Immovable), ("CCCC", InPlane::Free), ("SSSS", InPlane::Straight),
        ("SCSF", InPlane::Immovable), ("SCSC", InPlane::Slide), ("CFFF", InPlane::Immovable), ("CSCF", InPlane::Immovable), ("CCSS", InPlane::Immovable),
    ] {
        for n in [4, 15] {
            for projection in [Projection::Direct, Projection::Multiplied] {
                let mut s = settings(edges, n, projection);
                s.plate.in_plane = in_plane;
                for accuracy in [1e-10, 1e-8, 1e-6, 1e-5, 1e-4, 1e-3] {
                    s.mode_accuracy = accuracy;
                    let start = std::time::Instant::now();
                    match Modal::new(s) {
                        Err(e) => println!("{:?} {e}", start.elapsed()),
                        Ok(_) => break,
                    }
                }
                println!("{in_plane:?} {:e}", s.mode_accuracy);
                if projection == Projection::Direct || (edges != "CSCF" && n == 4) {
                    let r = std::panic::catch_unwind(|| pull_in(s, 2.0));
                    if r.is_err() { println!("failed"); }
                }
            }
        }
    }
}

#[test]
fn timing() {
    for projection in [Projection::Direct, Projection::Multiplied] {
        for n in [1, 3, 6, 10, 15] {
            let modal = Modal::new(settings("SSSS", n, projection)).unwrap();
            let mut x = vec![0.0; n];
            x[0] = 0.3;
            x.extend(modal.defaults());
            x[n] = 50.0;
            let mut system = ModalSystem::new(modal);
            let mut r = vec![0.0; n];
            let mut out = vec![0.0; x.len()];
            let mut monitors = vec![0.0; 4];
            let w = vec![0.1; n];
            let v = x.clone();
            let mut times = vec![];
            let mut time = |name: &str, f: &mut dyn FnMut()| {
                f();
                let start = std::time::Instant::now();
                for _ in 0..20 { f(); }
                times.push(format!("{name} {:?}", start.elapsed() / 20));
            };
            time("residual", &mut || system.residual(&x, &mut r).unwrap());
            time("assemble", &mut || system.assemble(&x).unwrap());
            time("monitors", &mut || System::monitors(&mut system, &x, &mut monitors).unwrap());
            time("gradient", &mut || system.gradient(&x, &w, &v, &[0], &mut out));
            time("second_gradient", &mut || system.second_gradient(&x, &w, &v, &[0], &mut out));
            time("monitor_gradient", &mut || system.monitor_gradient(2, &x, &mut out));
            println!("{projection:?} {n} {}", times.join(" "));
        }
    }
}

#[test]
fn assembled_derivatives_are_those_of_dual_numbers() {
    for (supports, symmetric) in [("SSSS", true), ("CCSS", false)] {
        for projection in [Projection::Direct, Projection::Multiplied] {
            let mut settings = settings(supports, 5, projection);
            (settings.plate.symmetric, settings.mode_accuracy) = (symmetric, 1e-4);
            let modal = Modal::new(settings).expect("valid settings");
            let mut p = modal.defaults();
            (p[0], p[1], p[5], p[6], p[8]) = (40.0, 1.4, 3.0, -2.0, 5.0);
            p[7] = if symmetric { 0.0 } else { 1.5 };
            let x = [vec![0.2, 0.03, -0.02, 0.015, 0.01], p].concat();
            let mut assembled = ModalSystem::new(Modal::new(settings).expect("valid settings"));
            let mut dual = Dense::new(modal);
            let w = [0.3, -0.4, 0.5, 0.1, 0.7];
            let v: Vec<f64> = (0..x.len()).map(|i| if i < 6 { 0.2 - 0.1 * i as f64 } else { 0.0 }).collect();
            let all: Vec<usize> = (0..x.len() - 5).collect();
            let evaluate = |system: &mut dyn System| -> [Vec<f64>; 6] {
                let zeros = || vec![0.0; x.len()];
                let mut out = [vec![0.0; 25], zeros(), zeros(), zeros(), zeros(), zeros()];
                system.assemble(&x).expect("inside the domain");
                system.jacobian(&mut out[0]);
                system.gradient(&x, &w, &v, &all, &mut out[1]);
                system.second_gradient(&x, &w, &v, &all, &mut out[2]);
                for monitor in 0..3 {
                    system.monitor_gradient(monitor, &x, &mut out[3 + monitor]);
                }
                out
            };
            for (a, b) in evaluate(&mut assembled).iter().zip(&evaluate(&mut dual)) {
                let scale = b.iter().fold(0.0_f64, |m, b| m.max(b.abs()));
                for (a, b) in a.iter().zip(b) {
                    assert!((a - b).abs() < 1e-11 * scale, "{projection:?} {a} {b} of {scale}");
                }
            }
        }
    }
}

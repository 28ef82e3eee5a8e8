//! The modal model of the plate against independently computed values and against the full model.

use tangency::core::continuation::{Continuation, Kind};
use tangency::core::dense::Dense;
use tangency::core::zero::{System, ZeroProblem};
use tangency::problems::plate::InPlane;
use tangency::problems::plate::modal::{Modal, ModalSettings};
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
    let mut system = Dense::new(modal);
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

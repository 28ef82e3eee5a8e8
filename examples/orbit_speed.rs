//! What a branch of periodic orbits costs: Mita's block from V = 0.01 through its fold to a maximum
//! of 0.9, by shooting and by collocation, in CPU time on one thread, with the error of the fold.
//!
//! `benches/peers/auto.py` runs this program beside AUTO-07p and puts both into one table.

use cpu_time::ProcessTime;
use std::error::Error;
use tangency::core::bvp::{Collocation, Shooting};
use tangency::core::continuation::{Branch, Continuation, Settings};
use tangency::core::ode::{self, Scheme};
use tangency::core::orbit::periodic_orbits;
use tangency::core::system::{Kind, System};
use tangency::problems::mita::Block;

/// The fold, from shooting at a tolerance of 1e-14 (`benches/peers/fold.py` agrees).
const FOLD: f64 = 0.2355654335833884;

/// A branch in steps of at most `step`, with states measured by a given `size`: by default the
/// measure would follow the growing orbit, and take more points at its small beginning than
/// AUTO-07p's, which has none. Both are chosen for the 47 points that AUTO-07p takes.
///
/// Of a point no correction above a hundredth of `tolerance` is left, AUTO-07p's `EPSL` and `EPSU`
/// of 1e-7. Special points are converged to the default `event_tolerance`. With a `refinement` of 0
/// they are not recomputed with a smaller error of the flow or mesh, and in a `draft` they have no
/// sensitivities: AUTO-07p computes neither.
fn branch(system: &mut dyn System, step: f64, size: f64) -> Result<Branch, Box<dyn Error>> {
    let settings = Settings {
        initial_step: step,
        max_step: step,
        tolerance: 1e-5,
        refinement: 0.0,
        draft: true,
        ..Settings::default()
    };
    let branch = Continuation::new(system)
        .settings(settings)
        .at("voltage", 0.01)
        .at("frequency", 0.45)
        .at("damping", 0.04)
        .along("voltage", 0.01..=0.5)
        .bound("max_displacement", 0.0..=0.9)
        .scale("displacement", size)
        .scale("velocity", size)
        .forward()
        .trace()?;
    Ok(branch)
}

fn report(
    name: &str,
    mesh: &str,
    [step, size]: [f64; 2],
    make: &dyn Fn() -> Result<Box<dyn System>, Box<dyn Error>>,
) -> Result<(), Box<dyn Error>> {
    let mut times = Vec::new();
    let mut found = None;
    for _ in 0..runs() {
        let start = ProcessTime::now();
        let traced = branch(&mut *make()?, step, size)?;
        times.push(start.elapsed().as_secs_f64() * 1e3);
        found = Some(traced);
    }
    let Some(branch) = found else { return Ok(()) };
    let fold = branch.of_kind(Kind::LP).next().ok_or("no fold")?;
    times.sort_by(f64::total_cmp);
    println!(
        "| tangency {name} | {} | {mesh} | {:.16} | {:.1e} | {:.3} (least {:.3}) |",
        branch.points.len(),
        fold.parameters[0],
        (fold.parameters[0] - FOLD).abs(),
        times[times.len() / 2],
        times[0]
    );
    Ok(())
}

fn runs() -> usize {
    std::env::args().nth(1).and_then(|n| n.parse().ok()).unwrap_or(200)
}

fn main() -> Result<(), Box<dyn Error>> {
    println!("| method | points | mesh | fold V | fold error | CPU ms (median) |");
    println!("|---|---|---|---|---|---|");
    report("shooting", "1", [0.0243, 4.0], &|| {
        // The tolerance makes the fold's error that of AUTO-07p's mesh. The first step is known to
        // be about a twentieth of the period; without it, each flow would spend an evaluation, and
        // a step that is shorter than need be, on finding out.
        let flow = ode::Settings {
            first_step: Some(0.05),
            ..ode::Settings::new(Scheme::DormandPrince8, 1.3e-10)
        };
        let shooting = Shooting::with(flow)?;
        Ok(Box::new(periodic_orbits(Block, 1, shooting)?))
    })?;
    report("collocation", "20 × 4", [0.04, 9.0], &|| {
        Ok(Box::new(periodic_orbits(Block, 20, Collocation::new(4)?)?))
    })?;
    Ok(())
}

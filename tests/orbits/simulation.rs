//! Promise: a stable orbit found by simulation lands on the branch of orbits, and a simulation that
//! finds none says why.

use crate::common::{close, first, solved};
use crate::orbits::cycles::{Saddle, collocation, cycle_of, equilibria, label, precisely_shot};
use tangency::core::attractor::{CycleSearch, CycleSearchError};
use tangency::core::bvp::Shooting;
use tangency::core::continuation::{Continuation, Settings};
use tangency::core::failure::one_line;
use tangency::core::hybrid::HybridError;
use tangency::core::orbit::{Smooth, from_cycle};
use tangency::core::system::Kind;
use tangency::problems::classic::Lure;
use tangency::problems::mita::Block;
use tangency::vector_field;

#[test]
fn lure_lands_on_its_branch() {
    let rest = equilibria(Lure, &[0.0; 3], &[1.2, 1.0], [0.5, 1.5]);
    let branch = Continuation::new(&mut precisely_shot(Lure, 1))
        .restart(&rest, label(&rest, Kind::HB))
        .along("alpha", 0.7..=1.5)
        .mark("alpha", 0.8)
        .settings(Settings { max_step: 0.05, ..Settings::default() })
        .trace()
        .unwrap();
    let period = first(&branch, Kind::UZ).monitors[0];
    let (p, start) = ([0.8, 1.0], [0.1, 0.0, 0.0]);
    let cycle = cycle_of(Lure, CycleSearch::default(), &start, &p).unwrap();
    close(cycle.duration(), period, 1e-5);
    let (mut orbits, z) = from_cycle(Smooth(Lure), &cycle, &p, collocation(4), 30).unwrap();
    let x = solved(&mut orbits, &z, &p).unwrap();
    close(x[z.len() - 1], period, 1e-9);
    let (mut orbits, z) = from_cycle(Smooth(Lure), &cycle, &p, Shooting::default(), 3).unwrap();
    let x = solved(&mut orbits, &z, &p).unwrap();
    close(x[z.len() - 1], period, 1e-9);
}

/// Beyond its period doubling the orbit of period two is found, which repeats after two turns.
#[test]
fn two_turns_are_one_period() {
    let patient = CycleSearch { transient: 500.0, ..CycleSearch::default() };
    let cycle = cycle_of(Lure, patient, &[0.1, 0.0, 0.0], &[0.6, 1.0]).unwrap();
    assert!((12.5..13.0).contains(&cycle.duration()), "{cycle:?}");
}

#[test]
fn mita_lands_on_its_branch() {
    let p = [0.2, 0.45, 0.04];
    let rest = [0.0, 0.0];
    let branch = Continuation::new(&mut precisely_shot(Block, 1))
        .at("voltage", 0.01)
        .at("frequency", 0.45)
        .at("damping", 0.04)
        .along("voltage", 0.01..=0.21)
        .mark("voltage", 0.2)
        .trace()
        .unwrap();
    let expected = first(&branch, Kind::UZ).monitors[1];
    let cycle = cycle_of(Block, CycleSearch::default(), &rest, &p).unwrap();
    let (mut orbits, z) = from_cycle(Smooth(Block), &cycle, &p, collocation(4), 40).unwrap();
    let branch = Continuation::new(&mut orbits)
        .from(&z)
        .at("voltage", 0.2)
        .at("frequency", 0.45)
        .at("damping", 0.04)
        .along("voltage", 0.19..=0.21)
        .mark("voltage", 0.205)
        .trace()
        .unwrap();
    let start = Continuation::new(&mut precisely_shot(Block, 1))
        .restart(&branch, label(&branch, Kind::UZ))
        .along("voltage", 0.19..=0.21)
        .mark("voltage", 0.2)
        .trace()
        .unwrap();
    close(first(&start, Kind::UZ).monitors[1], expected, 1e-10);
}

vector_field! {
    /// `x' = −x`: nothing repeats.
    struct Decay [x, y; p] {
        d/dt x = -x;
        d/dt y = -y * 2.0;
    }
}

vector_field! {
    /// Two frequencies without a common period.
    struct Quasiperiodic [x, y, u, v; p] {
        d/dt x = y;
        d/dt y = -x;
        d/dt u = p * v;
        d/dt v = -p * u;
    }
}

#[test]
fn simulations_that_find_nothing_say_why() {
    let brief =
        CycleSearch { transient: 1.0, returns: 50, longest: 320.0, ..CycleSearch::default() };
    let outcome = cycle_of(Decay, brief, &[1.0, 1.0], &[0.0]);
    assert!(matches!(outcome, Err(CycleSearchError::Equilibrium { mode: 0, .. })), "{outcome:?}");
    let golden = 0.5 * (1.0 + 5.0_f64.sqrt());
    match cycle_of(Quasiperiodic, brief, &[1.0, 0.0, 1.0, 0.0], &[golden]) {
        Err(error @ CycleSearchError::Unsettled { returns: 50, distance, .. }) => {
            assert!(distance > 1e-3 && one_line(&error).contains("found in 50 returns"));
        }
        other => panic!("{other:?}"),
    }
    // The forced saddle repels every trajectory.
    let outcome = cycle_of(Saddle, brief, &[0.9, 0.0], &[1.0, 1.0]);
    assert!(outcome.is_err(), "{outcome:?}");
    let outcome = cycle_of(Lure, brief, &[0.1, 0.0], &[0.8, 1.0]);
    let length = |error| matches!(error, HybridError::Length { found: 2, expected: 3, .. });
    assert!(matches!(outcome, Err(CycleSearchError::Motion(error)) if length(error.clone())));
    // Pulled in: the block touches the electrode at infinite speed.
    match cycle_of(Block, brief, &[0.0, 0.0], &[1.0, 0.45, 0.04]) {
        Err(error @ CycleSearchError::Motion(HybridError::Flow { .. })) => {
            assert!(one_line(&error).contains("at t = 2.64"), "{error}");
        }
        other => panic!("{other:?}"),
    }
}

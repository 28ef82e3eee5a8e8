//! Promise: after a warm-up, no Newton iteration allocates.

use crate::allocation::allocations::allocations;
use crate::common::{Bratu, Columns, Oxidation};
use tangency::core::bifurcation::{BranchPoint, DefiningSystem, Fold, Hopf};
use tangency::core::continuation::{Continuation, Settings};
use tangency::core::system::{Dense, Kind, System};
use tangency::problems::plate::{Ritz, RitzSettings};

#[test]
fn the_counter_counts() {
    assert_eq!(
        allocation_counter::measure(|| drop(std::hint::black_box(vec![1.0; 100]))).count_total,
        1
    );
}

/// Five unknowns (plain factorisation) and sixty (faer's), with λ fixed.
#[test]
fn plain_newton_allocates_nothing() {
    for n in [5, 60] {
        let mut x = vec![0.0; n + 1];
        x[n] = 2.0;
        assert_eq!(allocations(&mut Dense::new(Bratu(n)), &x, vec![], None), 0, "n = {n}");
    }
}

/// The same with a fold held and λ released.
#[test]
fn newton_on_a_fold_allocates_nothing() {
    for n in [5, 60] {
        let parabola = |i: usize| {
            let t = (i + 1) as f64 / (n + 1) as f64;
            4.8 * t * (1.0 - t)
        };
        let mut x: Vec<f64> = (0..n).map(parabola).collect();
        x.push(3.5);
        let fold: Box<dyn DefiningSystem> = Box::<Fold>::default();
        assert_eq!(allocations(&mut Dense::new(Bratu(n)), &x, vec![0], Some(fold)), 0, "n = {n}");
    }
}

/// Conditions with an unknown of their own: a Hopf point and a branch point.
#[test]
fn newton_on_other_conditions_allocates_nothing() {
    let hopf: Box<dyn DefiningSystem> = Box::new(Hopf::of_equilibria());
    let x = [0.11, 0.27, 0.44, 1.05, 0.4];
    let mut system = Dense::new(Oxidation);
    // A point of the branch near the Hopf point, as a trace would give it.
    assert_eq!(allocations(&mut system, &x, vec![0], Some(hopf)), 0);
    let point: Box<dyn DefiningSystem> = Box::new(BranchPoint::new(0));
    let x = [0.01, -0.01, 0.76, 0.25];
    assert_eq!(allocations(&mut Dense::new(Columns), &x, vec![0], Some(point)), 0);
}

/// The plate, whose structure is its own, with the load fixed and at its fold.
#[test]
fn newton_on_the_plate_allocates_nothing() {
    let mut plate = Ritz::new(RitzSettings::new("CCCC".parse().unwrap())).unwrap();
    let n = plate.names().dimension();
    let mut x = plate.at_rest();
    x[n] = 150.0;
    assert_eq!(allocations(&mut plate, &x, vec![], None), 0);
    let branch = Continuation::new(&mut plate)
        .settings(Settings { refinement: 0.0, ..Settings::default() })
        .at("gap_ratio", 1.0)
        .at("aspect", 1.0)
        .at("nu", 0.3)
        .along("load", 0.0..=300.0)
        .bound("max_deflection", 0.0..=0.9)
        .trace()
        .unwrap();
    let fold = branch.of_kind(Kind::LP).next().unwrap();
    let mut x: Vec<f64> = fold.state.iter().chain(&fold.parameters).copied().collect();
    x[n] *= 0.999;
    assert_eq!(allocations(&mut plate, &x, vec![0], Some(Box::new(Fold::default()))), 0);
}

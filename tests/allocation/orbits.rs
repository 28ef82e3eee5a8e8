//! Promise: after a warm-up, no Newton iteration on periodic orbits allocates.

use crate::allocation::allocations::allocations;
use crate::common::ellipse;
use crate::orbits::cycles::{Bautin, ForcedSpiral, collocated, equilibria, label, shot};
use std::f64::consts::TAU;
use tangency::core::bifurcation::{Fold, Hopf};
use tangency::core::continuation::Continuation;
use tangency::core::system::{Kind, System};
use tangency::problems::classic::Lure;

#[test]
fn newton_on_orbits_allocates_nothing() {
    let (mut collocation, mut shooting) = (collocated(Bautin, 10), shot(Bautin, 2));
    let starts = [
        collocation.sampled(&[6.2], ellipse(1.4, 1.4)),
        shooting.sampled(&[6.2], ellipse(1.4, 1.4)),
    ];
    for (system, z) in [&mut collocation as &mut dyn System, &mut shooting].into_iter().zip(starts)
    {
        let x = [&z[..], &[0.1, 1.0]].concat();
        assert_eq!(allocations(system, &x, vec![], None), 0);
    }
}

#[test]
fn newton_on_folds_and_torus_points_allocates_nothing() {
    let (mut collocation, mut shooting) = (collocated(Bautin, 10), shot(Bautin, 2));
    let starts = [
        collocation.sampled(&[TAU], ellipse(1.01, 1.01)),
        shooting.sampled(&[TAU], ellipse(1.01, 1.01)),
    ];
    for (system, z) in [&mut collocation as &mut dyn System, &mut shooting].into_iter().zip(starts)
    {
        let x = [&z[..], &[-0.99, 1.0]].concat();
        assert_eq!(allocations(system, &x, vec![0], Some(Box::new(Fold::default()))), 0);
    }
    let (mut collocation, mut shooting) = (collocated(ForcedSpiral, 10), shot(ForcedSpiral, 2));
    let starts =
        [collocation.sampled(&[], ellipse(1.0, 1.0)), shooting.sampled(&[], ellipse(1.0, 1.0))];
    for (system, z) in [&mut collocation as &mut dyn System, &mut shooting].into_iter().zip(starts)
    {
        let x = [&z[..], &[0.01, 0.0]].concat();
        assert_eq!(allocations(system, &x, vec![0], Some(Box::new(Hopf::neimark_sacker()))), 0);
    }
}

#[test]
fn newton_on_period_doublings_allocates_nothing() {
    let rest = equilibria(Lure, &[0.0; 3], &[1.2, 1.0], [0.5, 1.5]);
    for system in [&mut collocated(Lure, 20) as &mut dyn System, &mut shot(Lure, 2)] {
        let branch = Continuation::new(system)
            .restart(&rest, label(&rest, Kind::HB))
            .along("alpha", 0.6..=1.5)
            .trace()
            .unwrap();
        let doubling = branch.of_kind(Kind::PD).next().unwrap();
        let mut x = [&doubling.state[..], &doubling.parameters[..]].concat();
        x[doubling.state.len()] *= 1.0001;
        assert_eq!(allocations(system, &x, vec![0], Some(Box::new(Fold::period_doubling()))), 0);
    }
}

//! Promise: periodic orbits, their bifurcations and multipliers, by collocation and by shooting, agree with
//! published values and with each other.

mod common;

use common::{close, first};
use tangency::core::bvp::{Collocation, Shooting};
use tangency::core::continuation::{Branch, Continuation, Kind, Settings};
use tangency::core::dense::Dense;
use tangency::core::field::Equilibria;
use tangency::core::orbit::{by_collocation, by_shooting};
use tangency::core::zero::System;
use tangency::problems::classic::Lure;

fn rest() -> Branch {
    let mut rest = Dense::new(Equilibria(Lure));
    let branch = Continuation::of(&mut rest)
        .at("alpha", 1.2)
        .at("beta", 1.0)
        .along("alpha", 0.5..=1.5)
        .backward()
        .trace()
        .unwrap();
    close(first(&branch, Kind::HB).parameters[0], 1.0, 1e-13);
    branch
}

fn orbits(system: &mut dyn System) -> Branch {
    let rest = rest();
    Continuation::of(system)
        .restart(&rest, first(&rest, Kind::HB).label)
        .along("alpha", 0.5..=1.5)
        .settings(Settings { max_step: 0.05, ..Settings::default() })
        .trace()
        .unwrap()
}

#[test]
fn lure_by_both_methods() {
    let mut collocation = by_collocation(Lure, 20, Collocation::new(4).unwrap()).unwrap();
    let mut shooting = by_shooting(Lure, 1, Shooting::default()).unwrap();
    for system in [&mut collocation as &mut dyn System, &mut shooting] {
        let branch = orbits(system);
        let doubling = first(&branch, Kind::PD);
        close(doubling.parameters[0], 0.630302006160, 1e-10);
        close(doubling.monitors[0], 6.3640713394, 1e-10);
    }
}

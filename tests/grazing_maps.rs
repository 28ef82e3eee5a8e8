//! Promise: local maps near grazing have the coefficients of closed forms and of the literature, signs included, to any
//! order, and say where they cannot be trusted.

mod common;

use common::close;
use std::f64::consts::PI;
use tangency::core::grazing::{GrazingPoint, LocalMap, MapSettings};
use tangency::core::jet::Polynomial;
use tangency::core::orbit::Leg;
use tangency::problems::mita::Actuator;

/// Mita's actuator: the front stopper in the mode in which the frame sticks.
const FRONT: usize = Actuator::FRONT[Actuator::STICK];

/// The touch of the front stopper at a phase; after an impact the frame slips forward until it rests.
fn touch(voltage: f64, frequency: f64, phase: f64) -> GrazingPoint {
    let mut p = Actuator::DEFAULTS;
    (p[0], p[1]) = (voltage, frequency);
    GrazingPoint {
        guard: FRONT,
        mode: Actuator::STICK,
        time: phase / frequency,
        x: vec![p[2], 0.0],
        p: p.to_vec(),
        following: vec![Leg { mode: Actuator::FORWARD, exit: Some(Actuator::REST[0]) }],
        legs: vec![(Leg { mode: Actuator::STICK, exit: Some(FRONT) }, PI / frequency)],
        periods: 1,
    }
}

fn settings(order: usize) -> MapSettings {
    MapSettings { order, phase: PI, ..MapSettings::default() }
}

#[test]
fn prints() {
    let point = touch(0.171066688958, 0.487808700440, 5.496543861);
    let start = std::time::Instant::now();
    let map = LocalMap::of(&Actuator, &point, &["voltage", "frequency"], settings(2)).unwrap();
    println!("{:?}\n{map}", start.elapsed());
    for order in 1..=6 {
        let start = std::time::Instant::now();
        let map =
            LocalMap::of(&Actuator, &point, &["voltage", "frequency"], settings(order)).unwrap();
        println!("order {order} {:?} {}", start.elapsed(), map.space().len());
    }
}

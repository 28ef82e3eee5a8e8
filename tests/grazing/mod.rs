//! Grazing orbits, shared by tests of local maps.
#![allow(dead_code, missing_docs)]

use std::f64::consts::PI;
use tangency::core::grazing::{GrazingPoint, MapSettings};
use tangency::core::orbit::Leg;
use tangency::problems::mita::Actuator;

/// The touch of the actuator's front stopper at a voltage, a frequency and a phase: after an impact the frame slips
/// forward until it rests.
pub fn actuator(voltage: f64, frequency: f64, phase: f64) -> GrazingPoint {
    let front = Actuator::FRONT[Actuator::STICK];
    let mut p = Actuator::DEFAULTS;
    (p[0], p[1]) = (voltage, frequency);
    GrazingPoint {
        guard: front,
        mode: Actuator::STICK,
        time: phase / frequency,
        x: vec![p[2], 0.0],
        p: p.to_vec(),
        following: vec![Leg { mode: Actuator::FORWARD, exit: Some(Actuator::REST[0]) }],
        legs: vec![(Leg { mode: Actuator::STICK, exit: Some(front) }, PI / frequency)],
        periods: 1,
    }
}

/// Phase `ωt`, of which a period of the actuator's forcing takes π.
pub fn settings(order: usize) -> MapSettings {
    MapSettings { order, phase: PI, ..MapSettings::default() }
}

//! Promise: a local map says when it is used too far from grazing, and why where there is none.

use crate::common::close;
use crate::grazing::points::{actuator, oscillator, settings};
use crate::hybrid::systems::impact_oscillator::ClosedForm;
use std::f64::consts::{PI, TAU};
use tangency::core::failure::one_line;
use tangency::core::local_map::{GrazingError, GrazingPoint, LocalMap, MapSettings};
use tangency::core::orbit::{HybridOrbit, Itinerary};
use tangency::hybrid_system;
use tangency::problems::mita::Actuator;

/// Far from grazing the highest order says that it cannot be trusted, and near it can.
#[test]
fn far_from_grazing_is_refused() {
    let map = oscillator(&ClosedForm::usual(1.2), &["amplitude"], 3);
    assert!(map.image(&[1e-4, 0.0], &[0.0], 1e-5).is_ok());
    let refused = map.image(&[0.3], &[0.1], 1e-5).unwrap_err();
    assert!(matches!(refused, GrazingError::Length { found: 1, expected: 2, .. }), "{refused}");
    let refused = map.image(&[0.3, 0.4], &[0.1], 1e-5).unwrap_err();
    let GrazingError::TooFar { order: 3, estimate, penetration, .. } = refused else {
        panic!("{refused}")
    };
    assert!(estimate > 1e-2 && (penetration - 0.3).abs() < 1e-12, "{refused}");
    assert!(one_line(&refused).contains("too far from grazing"));
}

/// What cannot be computed says why.
#[test]
fn impossible_maps_are_refused() {
    let point = actuator(0.171066688958, 0.487808700440, 5.496543861);
    let of = |point: &GrazingPoint, names: &[&str], order| {
        LocalMap::of(&Actuator, point, names, settings(order)).unwrap_err()
    };
    let error = of(&point, &["volt"], 2);
    assert!(matches!(&error, GrazingError::Unknown(unknown) if unknown.name == "volt"), "{error}");
    assert!(matches!(of(&point, &[], 0), GrazingError::Order(0)));
    assert!(matches!(of(&point, &[], 8), GrazingError::Jet(_)));
    assert!(matches!(of(&point, &["voltage"; 9], 5), GrazingError::Jet(_)));
    let away = GrazingPoint { x: vec![0.4, 0.0], ..point.clone() };
    assert!(matches!(of(&away, &[], 2), GrazingError::NoTouch { .. }));
    // Where the voltage is highest, the block is pulled towards the stopper.
    let mut pulled = GrazingPoint { time: 0.5 * PI / 0.4878087, ..point.clone() };
    pulled.p[0] = 1.0;
    assert!(matches!(of(&pulled, &[], 2), GrazingError::Curvature { .. }));
    // After a fifth of a period the motion is nowhere near the section.
    let mut early = point.clone();
    early.legs[0].1 *= 0.2;
    let error = of(&early, &[], 2);
    assert!(matches!(error, GrazingError::NoReturn { .. }), "{error}");
    let careless = MapSettings { tolerance: -1.0, ..settings(2) };
    let error = LocalMap::of(&Actuator, &point, &[], careless).unwrap_err();
    assert!(matches!(error, GrazingError::Settings(_)), "{error}");
    for mismatched in [
        GrazingPoint { guard: 99, ..point.clone() },
        GrazingPoint { mode: 99, ..point.clone() },
        GrazingPoint { mode: Actuator::CONTACT, ..point.clone() },
        GrazingPoint { x: vec![0.5], ..point.clone() },
        GrazingPoint { p: vec![0.5], ..point.clone() },
        GrazingPoint { legs: Vec::new(), ..point.clone() },
    ] {
        let error = of(&mismatched, &[], 2);
        let refused = matches!(error, GrazingError::Foreign(_));
        assert!(refused, "{error}");
        assert_eq!(mismatched.located(&Actuator, "voltage").unwrap_err(), error);
    }
    let stuck = point.located(&Actuator, "gravity").unwrap_err();
    assert!(matches!(stuck, GrazingError::Failure(_)), "{stuck}");
    let orbit = HybridOrbit::of(Actuator, Itinerary::smooth(Actuator::STICK, 1)).unwrap();
    let mut resting = Actuator::DEFAULTS;
    resting[0] = 0.0;
    assert!(GrazingPoint::of(&orbit, &[0.0, 0.0], &resting).is_err());
}

hybrid_system! {
    /// `x' = cos t − x` below a level: a guard without a rate of its own.
    struct Level {
        /// By how much the phase of the forcing grows in a period.
        phase: f64,
    } [level; t] {
        period = T::constant(TAU), phase = phase;
        mode below [x] {
            d/dt x = t.cos() - x;
            event reached: level - x => below;
        }
    }
}

/// The phase of a forcing grows.
#[test]
fn phases_that_do_not_grow_are_refused() {
    let orbit = HybridOrbit::of(Level { phase: TAU }, Itinerary::smooth(0, 1)).unwrap();
    let point = GrazingPoint::of(&orbit, &[0.5], &[0.5_f64.sqrt()]).unwrap();
    let standing = Level { phase: 0.0 };
    let error = LocalMap::of(&standing, &point, &["level"], MapSettings::default()).unwrap_err();
    assert!(matches!(error, GrazingError::Phase(0.0)), "{error}");
}

/// A guard must leave its rate a state of its own: of a single state it determines all.
#[test]
fn single_states_have_no_section() {
    // x = (cos t + sin t)/2 is largest at π/4.
    let (height, time) = (0.5_f64.sqrt(), 0.25 * PI);
    let level = Level { phase: TAU };
    let orbit = HybridOrbit::of(level, Itinerary::smooth(0, 1)).unwrap();
    let point = GrazingPoint::of(&orbit, &[0.5], &[height]).unwrap();
    close(point.time, time, 1e-9);
    let refused = LocalMap::of(&level, &point, &["level"], MapSettings::default()).unwrap_err();
    assert!(matches!(refused, GrazingError::NoSection { .. }), "{refused}");
}

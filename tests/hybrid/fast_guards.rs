//! Promise: a guard that says in what time it changes is seen, however slowly the state does.

use crate::common::close;
use std::f64::consts::TAU;
use std::ops::ControlFlow;
use tangency::core::bvp::{BoundarySystem, Mesh, Shooting};
use tangency::core::continuation::Continuation;
use tangency::core::failure::one_line;
use tangency::core::hybrid::{Event, HybridError, HybridFlow, HybridSettings, HybridState};
use tangency::core::orbit::{HybridOrbit, Itinerary};
use tangency::core::system::Kind;
use tangency::hybrid_system;
use tangency::scene::{Scene, execute};

hybrid_system! {
    /// Once in `2π`, within about `width`, a guard dips to `−depth`: `1 − (1 + d) exp(−(sin(t/2)/w)²)`.
    /// The state follows `x' = cos t − x`.
    struct Slot { width: f64 } [depth; t] {
        period = T::constant(TAU);
        mode motion [x] {
            let s = (t * 0.5).sin() / width;
            d/dt x = t.cos() - x;
            event slot.changing_in(width): T::one() - (depth + T::one()) * (-(s * s)).exp() => motion;
        }
    }
}

/// Where the guard falls through zero: `sin(t/2) = −w √(ln(1 + d))`.
fn falls(width: f64, depth: f64) -> f64 {
    TAU - 2.0 * (width * depth.ln_1p().sqrt()).asin()
}

#[test]
fn slots_are_seen_in_simulation() {
    for width in [0.3, 0.03, 1e-2, 1e-3, 1e-4] {
        for depth in [0.1, 1e-3, 1e-6] {
            let slot = Slot { width };
            let mut flow = HybridFlow::new(&slot, HybridSettings::default()).unwrap();
            let mut state = HybridState { mode: 0, time: 1.0, x: vec![0.0] };
            let mut time = None;
            let found = flow.advance(&mut state, TAU, &[depth], &mut |event: &Event<f64>| {
                time = Some(event.time);
                ControlFlow::Break(())
            });
            found.unwrap();
            let time = time.unwrap_or_else(|| panic!("width {width}, depth {depth}: missed"));
            close(time, falls(width, depth), 1e-9 * width);
        }
    }
}

#[test]
fn no_time_is_refused() {
    for width in [0.0, -1.0, f64::NAN] {
        let refused = HybridFlow::<f64>::new(&Slot { width }, HybridSettings::default()).err();
        assert!(matches!(refused, Some(HybridError::ChangesIn { .. })), "{refused:?}");
    }
}

/// The smooth orbit touches the slot at the depth 0 exactly.
#[test]
fn slots_are_seen_from_orbits() {
    for width in [0.1, 1e-2, 1e-3] {
        let orbit = HybridOrbit::of(Slot { width }, Itinerary::smooth(0, 1)).unwrap();
        let meshes = vec![Mesh::uniform(1)];
        let mut orbits = BoundarySystem::new(orbit, Shooting::default(), meshes).unwrap();
        // x = (cos t + sin t)/2.
        let run = Continuation::new(&mut orbits).from(&[0.5, 0.5]).at("depth", -0.3);
        let branch = run.along("depth", -0.4..=0.2).trace().unwrap();
        let touch = branch.of_kind(Kind::G).next().unwrap();
        close(touch.parameters[0], 0.0, 1e-12);
        let column = branch.column("distance").unwrap();
        for point in &branch.points {
            close(point.value(column).unwrap(), -point.parameters[0], 1e-12);
        }
    }
}

/// In text, the same guard says so in a word.
#[test]
fn slots_are_stated_in_text() {
    let text = r#"Scene(
        title: "Slot",
        problem: HybridEquations(
            modes: [(name: "outside", states: [("x", "cos(t) - x")]), (name: "inside", states: [("x", "2 - x")])],
            definitions: [("h", "1 - (1 + depth)*exp(-(sin((t - 1)/2)/1e-3)^2)")],
            guards: [
                (name: "enter", modes: ["outside"], function: "h", next: "inside", changes_in: "1e-3"),
                (name: "leave", modes: ["inside"], function: "-h", next: "outside"),
            ],
            period: "2*pi",
        ),
        parameters: [("depth", 0.1)],
        runs: [(name: "orbits", start: Simulated(transient: 50), along: [(name: "depth", low: 0.05, high: 0.2)])],
    )"#;
    let outcome = execute(&Scene::parse(text).unwrap(), None, &mut ());
    assert_eq!(outcome.error, None);
    assert_eq!(outcome.document.branches[0].itinerary, "inside:leave outside:enter");
    let refused = one_line(&Scene::parse(&text.replace("\"1e-3\"", "0")).unwrap_err());
    assert!(
        refused.contains("the time scale on which a guard changes must be above 0"),
        "{refused}"
    );
}

//! Promise: an itinerary without a meaning, one that does not close, and a motion that has none are
//! refused with what is wrong.

use crate::common::close;
use crate::program::scenarios::with;
use std::f64::consts::TAU;
use tangency::core::attractor::CycleSearch;
use tangency::core::bvp::{Guess, Shooting};
use tangency::core::continuation::Continuation;
use tangency::core::failure::one_line;
use tangency::core::hybrid::{HybridFlow, HybridSettings, HybridState};
use tangency::core::orbit::{HybridOrbit, Itinerary, ItineraryError};
use tangency::core::system::Kind;
use tangency::hybrid_system;
use tangency::problems::classic::ImpactOscillator;
use tangency::problems::mita::Actuator;
use tangency::scene::{Scene, execute};

/// Each word is a mode and one of its events; a cycle has a leg, and takes a period.
#[test]
fn itineraries_are_read() {
    let text = "2* forward:rest stick:front forward:rest stick:front";
    let itinerary = Itinerary::read(text, &Actuator).unwrap();
    assert_eq!((itinerary.legs.len(), itinerary.periods), (4, 2));
    assert_eq!(itinerary.written(&Actuator), text);
    let text = "contact:leave stick:front forward:front+";
    let itinerary = Itinerary::read(text, &Actuator).unwrap();
    assert_eq!(
        itinerary.legs.iter().map(|leg| leg.accumulates).collect::<Vec<_>>(),
        [false, false, true]
    );
    assert_eq!(itinerary.written(&Actuator), text);
    let refused = |text| Itinerary::read(text, &Actuator).unwrap_err();
    assert!(matches!(refused(""), ItineraryError::Empty(_)));
    assert!(matches!(refused("0* stick"), ItineraryError::Periods(_)));
    assert!(matches!(refused("stick forward:rest"), ItineraryError::Endless(_)));
    let unknown = one_line(&refused("flight:front"));
    assert!(unknown.contains("unknown mode `flight`; known: stick, forward"), "{unknown}");
    let unknown = one_line(&refused("stick:rest"));
    assert!(unknown.contains("mode `stick` `rest`; known: front, back"), "{unknown}");
}

hybrid_system! {
    /// A mass that is thrown back, and caught at every other impact: an itinerary in which it is always
    /// thrown back does not close. The equations have a solution all the same, so that nothing but the
    /// decision says so.
    struct Catching [amplitude; t] {
        period = T::constant(TAU / 2.2);
        mode flight [x, v] {
            d/dt x = v;
            d/dt v = amplitude * (t * 2.2).cos() - x - v * 0.1;
            event impact: T::one() - x => caught { x, v: v * -0.8 };
        }
        mode caught [x, v] {
            d/dt x = v;
            d/dt v = amplitude * (t * 2.2).cos() - x - v * 0.1;
            event release: T::one() - x => flight { x, v: v * -0.8 };
        }
    }
}

#[test]
fn an_itinerary_that_does_not_close_is_refused() {
    // One impact a period at the amplitude 5, as a simulation of the oscillator finds it.
    let mut flow = HybridFlow::new(&ImpactOscillator, HybridSettings::default()).unwrap();
    let start = HybridState { mode: ImpactOscillator::FLIGHT, time: 0.0, x: vec![0.0, 0.0] };
    let p = [5.0, 2.2, 0.8, 0.1, 1.0];
    let cycle = CycleSearch::default().find(&mut flow, start, &p).unwrap();
    let orbit = HybridOrbit::of_cycle(ImpactOscillator, &cycle, &p).unwrap();
    let itinerary = Itinerary::read("flight:impact", &Catching).unwrap();
    let problem = HybridOrbit::of(Catching, itinerary).unwrap();
    let (mut system, z) =
        Guess { problem, ..orbit }.discretised(&[5.0], Shooting::default(), 1).unwrap();
    let branch =
        Continuation::new(&mut system).from(&z).at("amplitude", 5.0).along("amplitude", 4.5..=6.0);
    let error = one_line(&branch.trace().unwrap_err());
    assert!(error.contains("`impact` of mode `flight`"), "{error}");
    assert!(error.contains("leads to `caught`, not to `flight`"), "{error}");
}

/// Complete chatter has infinitely many events, the last of which are one leg of an itinerary.
#[test]
fn complete_chatter_is_an_itinerary() {
    let text = r#"Scene(
        title: "t",
        problem: Mita(method: shooting()),
        parameters: [("voltage", 0.88)],
        runs: [(
            name: "chatter", start: Simulated(transient: 300), marks: [("voltage", 0.885)],
            along: [(name: "voltage", low: 0.88, high: 0.885)],
        )],
    )"#;
    let outcome = execute(&Scene::parse(text).unwrap(), None, &mut ());
    assert_eq!(outcome.error, None);
    let branch = &outcome.document.branches[0];
    assert!(branch.itinerary.starts_with("contact:leave"), "{}", branch.itinerary);
    assert!(branch.itinerary.ends_with("forward:front+"), "{}", branch.itinerary);
    assert!(branch.points.iter().all(|point| point.admissible && point.unstable == Some(0)));
    // The fastest impact of a simulation at its end is that of the branch.
    let mut p = Actuator::DEFAULTS;
    p[0] = 0.885;
    let mut flow = HybridFlow::new(&Actuator, HybridSettings::default()).unwrap();
    let start = HybridState { mode: Actuator::STICK, time: 0.0, x: vec![0.0, 0.0] };
    let search = CycleSearch { transient: 2000.0, ..CycleSearch::default() };
    let cycle = search.find(&mut flow, start, &p).unwrap();
    let fastest = cycle.legs.iter().filter(|leg| leg.mode == Actuator::STICK);
    let fastest = fastest.map(|leg| leg.end[1]).fold(0.0, f64::max);
    let (last, column) =
        (branch.special.last().unwrap(), branch.column("impact_velocity").unwrap());
    close(last.parameters[0], 0.885, 1e-12);
    close(last.value(column).unwrap(), fastest, 1e-8);
}

/// A branch starts from the motion on which a simulation settles: an impact a period, with its fold
/// and its period doubling.
#[test]
fn simulations_discover_itineraries() {
    let text = r#"Scene(
        title: "t",
        problem: Mita(method: shooting()),
        parameters: [("voltage", 0.3)],
        runs: [(name: "found", start: Simulated(), along: [(name: "voltage", low: 0.1, high: 0.6)])],
    )"#;
    let outcome = execute(&Scene::parse(text).unwrap(), None, &mut ());
    assert_eq!(outcome.error, None);
    let branch = outcome.document.branch("found").unwrap();
    assert_eq!(branch.itinerary.matches("stick:front").count(), 1, "{}", branch.itinerary);
    let found = |kind| branch.of_kind(kind).map(|point| point.parameters[0]).collect::<Vec<_>>();
    assert!((found(Kind::LP)[0] - 0.176515441).abs() < 1e-9);
    assert!((found(Kind::PD)[0] - 0.555993297).abs() < 1e-9);
    // An orbit of a vector field, as far as its period doubling.
    let text = r#"Scene(
        title: "t",
        problem: Lure(),
        parameters: [("alpha", 0.8), ("beta", 1.0)],
        runs: [(
            name: "found",
            start: Simulated(state: [("x", 0.1)]),
            along: [(name: "alpha", low: 0.6, high: 0.85)],
        )],
    )"#;
    let outcome = execute(&Scene::parse(text).unwrap(), None, &mut ());
    assert_eq!(outcome.error, None);
    let doubling = outcome.document.branch("found").unwrap().of_kind(Kind::PD).next().unwrap();
    assert!((doubling.parameters[0] - 0.630302006160).abs() < 1e-9);
    let mut equilibria = Scene::parse(text).unwrap();
    equilibria.set("solution", "equilibrium").unwrap();
    let error = one_line(&execute(&equilibria, None, &mut ()).error.unwrap());
    assert!(error.contains("converges to a cycle, not to an equilibrium"), "{error}");
    // An itinerary is a setting, too.
    let given = with("mita-type-1", &[("itinerary", "stick")]);
    assert_eq!(execute(&given, None, &mut ()).error, None);
}

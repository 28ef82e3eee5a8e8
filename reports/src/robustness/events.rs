//! Robustness maps of events: two crossings of a surface that merge where a motion grazes the
//! surface, and the grazing point.

use super::grid::{Found, Panel, from_to, map};
use crate::RobustnessMap;
use std::ops::ControlFlow;
use tangency::core::continuation::End;
use tangency::core::failure::FlowError;
use tangency::core::hybrid::{HybridError, HybridFlow, HybridSettings, HybridState, InMode};
use tangency::core::ode::{Extrema, Flow};
use tangency::core::problem::State;
use tangency::core::system::Kind;
use tangency::hybrid_system;
use tangency::scene::{Scene, execute};

hybrid_system! {
    /// The oscillator `x'' = −x`, with one mode below and one mode above the level 1; crossing the
    /// level changes only the mode.
    struct Level [] {
        mode below [x, v] {
            d/dt x = v;
            d/dt v = -x;
            event up: T::one() - x => above;
        }
        mode above [x, v] {
            d/dt x = v;
            d/dt v = -x;
            event down: x - 1.0 => below;
        }
    }
}

const BELOW: usize = 0;

/// The end time of the motion `(1 + δ) cos(t − TOP)`, which starts at time 0.
const END: f64 = 4.0;
const TOP: f64 = 1.9;

fn start(beyond: f64) -> [f64; 2] {
    [(1.0 + beyond) * TOP.cos(), (1.0 + beyond) * TOP.sin()]
}

/// Returns half the time `τ` between the two crossings, from `cos τ = 1/(1 + δ)`.
fn half(beyond: f64) -> f64 {
    2.0 * (0.5 * beyond / (1.0 + beyond)).sqrt().asin()
}

/// Passes each integration step of the motion to a callback.
fn flowed<'a>(
    beyond: f64,
    observe: impl FnMut(&mut tangency::core::ode::Step<InMode<'a, Level>, f64>) -> ControlFlow<()>,
) -> Result<(), FlowError> {
    let field = InMode { system: &Level, mode: BELOW };
    Flow::<f64>::default().observe(&field, 0.0, END, &mut start(beyond), &[], observe).map(|_| ())
}

/// Divides each integration step, or the whole motion, into a given number of equal parts, and
/// detects sign changes between the ends of each part.
fn signs(beyond: f64, parts: Option<usize>) -> Found {
    let (mut changes, mut above) = (0, false);
    let mut at = [0.0; 2];
    let mut seen = |x: f64| {
        changes += usize::from((x > 1.0) != above);
        above = x > 1.0;
    };
    let flowed = flowed(beyond, |step| {
        match parts {
            None => seen(step.end()[0]),
            Some(parts) => {
                let ((start, end), n) = (step.span(), parts as f64);
                for k in (start * n).ceil() as usize..=(end * n).floor() as usize {
                    step.interpolate((k as f64 / n - start) / (end - start), &mut at);
                    seen(at[0]);
                }
            }
        }
        ControlFlow::Continue(())
    });
    match flowed {
        Ok(()) if changes == 2 => Found::right("both crossings"),
        Ok(()) => Found::silent("crossings missed"),
        Err(cause) => Found::reported("no motion", cause),
    }
}

/// The error that the integration tolerance of the flow causes in the level at which the motion
/// grazes.
const ERROR: f64 = 1e-11;

/// Detects the crossings by the event location of the hybrid flow.
fn hybrid(beyond: f64) -> Found {
    let mut state = HybridState { mode: BELOW, time: 0.0, x: start(beyond).into() };
    let events = HybridFlow::new(&Level, HybridSettings::default())
        .and_then(|mut flow| flow.events(&mut state, END, &[]));
    let events = match events {
        Ok(events) => events,
        Err(cause @ HybridError::Outside { .. }) => {
            return Found::reported("begins beyond its guard", cause);
        }
        Err(cause) => return Found::reported("another failure", cause),
    };
    // The shift of a crossing due to the error of the level.
    let moved = half(beyond + ERROR) - half((beyond - ERROR).max(0.0));
    let right = |time: f64, exact: f64| (time - exact).abs() <= moved;
    match &events[..] {
        [up, down]
            if right(up.time, TOP - half(beyond)) && right(down.time, TOP + half(beyond)) =>
        {
            Found::right("both crossings")
        }
        _ if beyond < ERROR => Found::right("no crossing, to the tolerance of the flow"),
        _ => Found::silent("crossings missed"),
    }
}

/// Finds the maximum of the motion, including maxima inside integration steps.
fn largest(beyond: f64) -> Found {
    let (mut extrema, mut top) = (Extrema::default(), f64::NEG_INFINITY);
    let flowed = flowed(beyond, |step| {
        extrema.search(&State(0), step, |found| top = top.max(found.value));
        ControlFlow::Continue(())
    });
    match flowed {
        Ok(()) if (top - 1.0 - beyond).abs() > ERROR => Found::silent("another height"),
        Ok(()) if beyond > ERROR => Found::right("the height beyond the level"),
        Ok(()) => Found::right("no crossing, to the tolerance of the flow"),
        Err(cause) => Found::reported("no motion", cause),
    }
}

/// A scene of orbits of the impact oscillator without impacts, with clearance 1; the branch starts
/// at a forcing that is a given fraction below or above the grazing value.
const ORBITS: &str = r#"Scene(
    title: "Orbits without impacts",
    problem: ImpactOscillator(method: shooting()),
    parameters: [("frequency", 1.2)],
    settings: (refinement: 0.0),
    runs: [(name: "orbits", along: [(name: "amplitude", low: 0.0, high: 1.0)])],
)"#;

/// Returns the amplitude of the forcing at which the orbits graze: `√((1 − ω²)² + (cω)²)`.
fn grazing_force() -> f64 {
    let (frequency, damping) = (1.2_f64, 0.1);
    (1.0 - frequency * frequency).hypot(damping * frequency)
}

/// Locates the grazing point on the branch of orbits.
fn touching(part: f64) -> Found {
    let amplitude = grazing_force() * (1.0 - part);
    let scene = Scene::parse(ORBITS).and_then(|mut scene| {
        scene.set("amplitude", &format!("{amplitude:e}"))?;
        Ok(scene)
    });
    let outcome = match scene {
        Ok(scene) => execute(&scene, None, &mut ()),
        Err(cause) => return Found::reported("no scene", cause),
    };
    if let Some(cause) = outcome.error {
        return Found::reported("refused: the orbit passes through the stop", cause);
    }
    let Some(branch) = outcome.document.branches.first() else { return Found::silent("no branch") };
    let near = |value: f64| (value / grazing_force() - 1.0).abs() < ERROR;
    let column = branch.column("amplitude");
    let grazings = branch.of_kind(Kind::G).filter_map(|point| point.value(column?));
    let grazings: Vec<f64> = grazings.collect();
    let end = branch.ends.iter().find(|end| matches!(end, End::Grazing { .. }));
    match (&grazings[..], end) {
        ([value], Some(_)) if near(*value) => Found::right("the grazing"),
        // A start this close to a level counts as being on the level.
        ([], Some(end)) if part.abs() < 1e-6 => {
            let distance = part.abs();
            Found::reported(
                "the start is taken for the grazing",
                format!("{end}, {distance:.0e} away"),
            )
        }
        _ if part < 0.0 => Found::silent("an orbit through the stop"),
        _ => Found::silent("no grazing"),
    }
}

/// Computes two panels.
pub(super) fn draw() -> RobustnessMap {
    let heights = from_to(-14.0, -1.0, 40);
    let mut panel = Panel::new(
        "Two crossings near a grazing",
        "log₁₀ of the height beyond the level",
        "search",
    );
    panel = panel.row(("ends of steps", true), &heights, |x| signs(10_f64.powf(x), None));
    for parts in [16, 128, 1024, 8192] {
        let name = format!("{parts} parts");
        panel = panel.row((&name, true), &heights, |x| signs(10_f64.powf(x), Some(parts)));
    }
    panel = panel.row(("largest value", false), &heights, |x| largest(10_f64.powf(x))).row(
        ("hybrid motion", false),
        &heights,
        |x| hybrid(10_f64.powf(x)),
    );
    let distances = from_to(-14.0, -1.0, 27);
    let from = Panel::new(
        "Location of the grazing on a branch of orbits",
        "log₁₀ of the distance of the start from the grazing",
        "start",
    )
    .row(("clear of the stop", false), &distances, |x| touching(10_f64.powf(x)))
    .row(("through the stop", false), &distances, |x| touching(-(10_f64.powf(x))));
    map("events", vec![panel, from])
}

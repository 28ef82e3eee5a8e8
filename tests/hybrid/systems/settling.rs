//! Branches against simulations: what is called admissible and stable is what a simulation settles on.

use crate::common::close;
use tangency::core::continuation::{Branch, Continuation, Kind, SpecialPoint};
use tangency::core::hybrid::{
    Cycle, CycleSearch, HybridEquations, HybridFlow, HybridSettings, HybridState,
};
use tangency::core::orbit::{Itinerary, Leg};

/// Simulated cycles have the numbers of orbits to this.
const DIGITS: f64 = 1e-8;
/// Simulations begin beside the orbits by this.
const BESIDE: f64 = 1e-5;

/// Marks twenty values of a parameter within a range.
pub fn marked<'a>(run: Continuation<'a>, name: &str, [low, high]: [f64; 2]) -> Continuation<'a> {
    let values = (0..20).map(|k| low + (high - low) * (k as f64 + 0.5) / 20.0);
    values.fold(run, |run, value| run.mark(name, value))
}

/// Simulates at the points of a branch that are [`marked`], and compares itineraries, durations and states where the branch calls
/// them admissible and stable. How many these are.
#[track_caller]
pub fn settles_at_twenty_points(system: &dyn HybridEquations, branch: &Branch) -> usize {
    let marks: Vec<&SpecialPoint> = branch.of_kind(Kind::UZ).collect();
    assert!(marks.len() >= 20, "{} points are marked", marks.len());
    let counts = |mark: &&&SpecialPoint| {
        let around = &branch.points[mark.after.saturating_sub(1)..];
        mark.unstable == Some(0) && around.iter().take(2).all(|point| point.admissible)
    };
    marks.iter().filter(counts).map(|mark| settles(system, branch, mark)).count()
}

/// An unknown of a point by name, its value where its segment begins.
fn unknown(branch: &Branch, point: &SpecialPoint, name: &str) -> Option<f64> {
    let position = branch.unknowns.iter().position(|group| group.name == name)?;
    Some(point.state[branch.unknowns[..position].iter().map(|group| group.length).sum::<usize>()])
}

#[track_caller]
fn settles(system: &dyn HybridEquations, branch: &Branch, point: &SpecialPoint) {
    let Itinerary { legs, periods } = Itinerary::read(&branch.itinerary, system).unwrap();
    let modes = system.modes();
    let states = &modes[legs[0].mode].states;
    let begins = |k: usize| branch.unknowns[..k].iter().map(|group| group.length).sum::<usize>();
    let x: Vec<f64> = (0..states.len()).map(|k| point.state[begins(k)]).collect();
    let time = unknown(branch, point, "start").unwrap_or(0.0);
    let period = point.value(branch.column("period").unwrap()).unwrap();
    let mut start = HybridState {
        mode: legs[0].mode,
        time,
        x: beside(system, legs[0].mode, time, &x, &point.parameters),
    };
    let mut flow = HybridFlow::new(system, HybridSettings::default()).unwrap();
    let search =
        CycleSearch { transient: 60.0 * period, tolerance: 1e-10, ..CycleSearch::default() };
    // Not from an event on: it would come at the moments at which motion is compared.
    flow.advance(&mut start, 0.37 * period, &point.parameters, &mut ()).unwrap();
    let cycle = search.find(&mut flow, start, &point.parameters);
    let cycle = cycle.unwrap_or_else(|error| panic!("{:?}: {error}", point.parameters));
    assert_eq!(cycle.periods, periods);
    close(cycle.duration(), period, DIGITS * period);
    if legs[0].exit.is_none() {
        assert!(cycle.legs.len() == 1 && cycle.legs[0].exit.is_none(), "{:?}", cycle.legs);
        return;
    }
    let duration = |k: usize| unknown(branch, point, &format!("duration[{k}]")).unwrap();
    let durations: Vec<f64> = (0..legs.len()).map(duration).collect();
    let turned = (0..legs.len()).any(|by| agrees(&cycle, by, &legs, &durations, &x));
    assert!(turned, "{}: {durations:?}, not {:?}", branch.itinerary, cycle.legs);
}

/// Whether the legs of a cycle are those of an orbit, the first of which is the one at a position.
fn agrees(cycle: &Cycle, by: usize, legs: &[Leg], durations: &[f64], x: &[f64]) -> bool {
    let mut found = cycle.legs.clone();
    let by = by.min(found.len());
    found.rotate_left(by);
    let same = found.len() == legs.len()
        && found.iter().zip(legs).all(|(a, b)| (a.mode, a.exit) == (b.mode, b.exit));
    let near = |a: f64, b: f64| (a - b).abs() < DIGITS * (1.0 + b.abs());
    same && found.iter().zip(durations).all(|(a, b)| near(a.duration, *b))
        && found[0].start.iter().zip(x).all(|(a, b)| near(*a, *b))
}

/// A state beside one, where no guard of the mode is negative.
fn beside(system: &dyn HybridEquations, mode: usize, t: f64, x: &[f64], p: &[f64]) -> Vec<f64> {
    let guards = system.guards();
    let inside = |x: &Vec<f64>| {
        let own = (0..guards.len()).filter(|guard| guards[*guard].modes.contains(&mode));
        own.into_iter().all(|guard| system.guard(guard, mode, t, x, p) >= 0.0)
    };
    let moved = [BESIDE, -BESIDE].map(|by| x.iter().map(|x| x + by).collect::<Vec<f64>>());
    moved.into_iter().find(inside).unwrap_or(x.to_vec())
}

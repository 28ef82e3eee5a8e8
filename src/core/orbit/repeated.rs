//! Orbits that consist of two equal halves.

use super::known_orbit::KnownOrbit;
use super::legs::OrbitLegs;
use crate::core::bvp::Guess;
use crate::core::failure::Failure;

/// Discretisation: two halves of an orbit are equal if all states and durations agree up to this
/// fraction of their largest values: well above the error of an orbit, and well below the distance of
/// the halves of an orbit beside a period doubling.
const EQUAL: f64 = 1e-7;

/// Rounding: states that are smaller than this fraction of their sizes are zero up to rounding.
const ZERO: f64 = 1e-12;

/// Returns the first half of the guess of an orbit if the orbit consists of two equal halves, and
/// otherwise the guess itself. If an event of an orbit of twice the period vanishes, the two halves
/// of the remaining orbit can be equal.
///
/// # Errors
/// [`Failure`] if the motion ends early.
pub(super) fn traversed_once(
    guess: Guess<OrbitLegs>,
    p: &[f64],
) -> Result<Guess<OrbitLegs>, Failure> {
    let Guess { problem: legs, trajectories, extras, .. } = &guess;
    let (layout, count) = (&legs.layout, legs.all().len());
    let itinerary = legs.itinerary.halved(layout.forced);
    let even = layout.smooth || count.is_multiple_of(2);
    let Some(itinerary) = itinerary.filter(|_| even && guess.beside.is_none()) else {
        return Ok(guess);
    };
    let q = [p, extras].concat();
    let orbit = KnownOrbit { legs, known: trajectories, q: &q };
    let starts_equally = |leg: usize, [first, second]: [&[f64]; 2]| {
        let mut sizes = orbit.system().sizes_of(legs.mode(leg), p);
        sizes.iter_mut().for_each(|size| *size *= ZERO / EQUAL);
        for (_, states) in trajectories[leg].nodes() {
            sizes.iter_mut().zip(states).for_each(|(size, x)| *size = size.max(x.abs()));
        }
        let mut states = first.iter().zip(second).zip(sizes);
        states.all(|((a, b), size)| (a - b).abs() <= EQUAL * size)
    };
    if layout.smooth {
        let half = 0.5 * orbit.length(0);
        let start = trajectories[0].start();
        if !starts_equally(0, [start, &orbit.state_on(0, half)?]) {
            return Ok(guess);
        }
        let trajectories = vec![trajectories[0].part(start.to_vec(), 0.0..half)];
        return Ok(Guess { problem: legs.like(itinerary), trajectories, ..guess });
    }
    let half = count / 2;
    let whole: f64 = layout.durations(&q).iter().sum();
    let equal = (0..half).all(|leg| {
        (orbit.length(leg) - orbit.length(leg + half)).abs() <= EQUAL * whole
            && starts_equally(leg, [leg, leg + half].map(|leg| trajectories[leg].start()))
    });
    if !equal {
        return Ok(guess);
    }
    Ok(Guess {
        problem: legs.like(itinerary),
        trajectories: trajectories[..half].to_vec(),
        extras: extras[..extras.len() - half].to_vec(),
        beside: None,
    })
}

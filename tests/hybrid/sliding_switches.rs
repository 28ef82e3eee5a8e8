//! Promise: `switch()` leads over every sliding bifurcation in both directions, to orbits on which
//! simulations settle.

use super::sliding::{at, ends, simulated, switched};
use crate::common::close;
use crate::common::settling::settling;
use crate::hybrid::systems::sliding::Sliding;
use tangency::core::continuation::{Branch, Continuation, End, Settings};
use tangency::core::hybrid::filippov::Filippov;
use tangency::core::system::Kind;

/// The number of legs of sliding.
fn slides(branch: &Branch) -> usize {
    let sliding = |word: &&str| word.starts_with("sliding:") || word.starts_with("stick:");
    branch.itinerary.split(' ').filter(sliding).count()
}

/// The relay's sliding is interrupted in both directions at a time, where it touches its ends; and
/// again from there.
#[test]
fn a_relay_adds_slides_and_takes_them_away() {
    let (system, range) = (Filippov(Sliding::Relay), [14.0, 17.0]);
    let (mut orbits, plain) = simulated(Sliding::Relay, ("omega", 15.2), range, [14.8, 15.66]);
    let adding = at(&plain, "omega", 15.6734748169).label;
    let added = switched(&mut orbits, (&plain, adding), "omega", range, [15.68, 16.06]);
    assert_eq!((slides(&plain), slides(&added)), (2, 4));
    ends(&added, "grazing-sliding", ("omega", 16.073687913232));
    assert_eq!(settling(&system, &added), [20, 0, 0, 0]);
    // The free legs between slides become grazings, and the slides after them vanish.
    let grazing = at(&added, "omega", 16.073687913232).label;
    let beyond = switched(&mut orbits, (&added, grazing), "omega", range, [16.1, 16.9]);
    assert_eq!(slides(&beyond), 2);
    // And back from motion that is interrupted to the same motion that is not.
    let periods = |branch: &Branch| -> Vec<f64> {
        let column = branch.column("period").unwrap();
        branch.of_kind(Kind::UZ).map(|point| point.value(column).unwrap()).collect()
    };
    let expected = periods(&plain);
    let (mut orbits, added) = simulated(Sliding::Relay, ("omega", 15.9), range, [15.68, 16.06]);
    assert_eq!(slides(&added), 4);
    ends(&added, "adding-sliding", ("omega", 15.6734748169));
    let adding = at(&added, "omega", 15.6734748169).label;
    let plain = switched(&mut orbits, (&added, adding), "omega", range, [14.8, 15.66]);
    assert_eq!((slides(&plain), expected.len()), (2, 20));
    periods(&plain).iter().zip(expected).for_each(|(period, other)| close(*period, other, 1e-9));
}

/// Both halves of the relay's symmetric orbit graze at the same point, where Newton's method is
/// singular: the points at both ends are found with all their digits, whichever steps lead there.
#[test]
fn symmetric_grazings_converge_from_all_steps() {
    let range = [14.0, 17.0];
    let (mut orbits, plain) = simulated(Sliding::Relay, ("omega", 15.2), range, [14.8, 15.66]);
    let adding = at(&plain, "omega", 15.6734748169).label;
    for share in (0..16).step_by(2) {
        let max_step = 0.15 * (1.0 - f64::from(share) / 40.0);
        let settings = Settings { max_step, ..Settings::default() };
        let run = Continuation::new(&mut orbits).restart(&plain, adding).switch();
        let run = run.settings(settings.clone()).mark("omega", 15.9);
        let added = run.along("omega", range[0]..=range[1]).trace().unwrap();
        ends(&added, "grazing-sliding", ("omega", 16.073687913233));
        let middle = added.of_kind(Kind::UZ).next().unwrap().label;
        let run = Continuation::new(&mut orbits).restart(&added, middle).settings(settings);
        let both = run.along("omega", range[0]..=range[1]).trace().unwrap();
        // Near double roots, rounding errors may be estimated as large as 1e-6.
        let end = at(&both, "omega", 15.673474816905);
        let column = both.column("omega").unwrap();
        close(end.value(column).unwrap(), 15.673474816905, 1e-11);
        assert_eq!(end.subkind.as_deref(), Some("adding-sliding"));
        assert!(end.converged && end.error < 1e-5, "{}", end.error);
    }
}

/// A single slide of the mass on a belt.
#[test]
fn a_belt_adds_a_slide() {
    let (system, range) = (Filippov(Sliding::Friction), [0.3, 0.6]);
    let (mut orbits, plain) = simulated(Sliding::Friction, ("nu", 0.35), range, [0.31, 0.42]);
    let adding = at(&plain, "nu", 0.426633559729).label;
    let added = switched(&mut orbits, (&plain, adding), "nu", range, [0.43, 0.49]);
    assert_eq!((slides(&plain), slides(&added)), (1, 2));
    ends(&added, "crossing-sliding", ("nu", 0.4930125723476));
    assert_eq!(settling(&system, &added), [20, 0, 0, 0]);
}

/// From sliding back to orbits that only touch the surface.
#[test]
fn slides_vanish_at_touches() {
    for (system, (name, value), range, marks, grazing) in [
        (Sliding::Friction, ("nu", 3.0), [2.0, 4.0], [3.22, 3.9], 3.20856896212),
        (Sliding::Chua, ("alpha", 7.5), [6.8, 8.0], [6.81, 6.93], 6.93362519782),
    ] {
        let (mut orbits, slides_there) =
            simulated(system, (name, value), range, [value - 0.05, value]);
        ends(&slides_there, "grazing-sliding", (name, grazing));
        let label = at(&slides_there, name, grazing).label;
        let free = switched(&mut orbits, (&slides_there, label), name, range, marks);
        assert_eq!((slides(&slides_there), slides(&free)), (1, 0));
        assert_eq!(settling(&Filippov(system), &free), [20, 0, 0, 0]);
        let same = |end: &End| matches!(end, End::Grazing { subkind: Some(known), .. } if known == "grazing-sliding");
        let touch = free.ends.iter().position(same).expect("a touch");
        let place = [free.points.first(), free.points.last()][touch].unwrap();
        close(place.value(free.column(name).unwrap()).unwrap(), grazing, 1e-9);
    }
}

//! Promise: only motions whose events follow each other ever faster are given up.

#[allow(dead_code)]
#[path = "../../src/core/hybrid/crowding.rs"]
mod detector;

use detector::Crowd;

/// Returns the number of events after which the simulation ends, given the interval before each
/// event.
fn given_up(interval: impl Fn(usize) -> f64) -> Option<usize> {
    let (mut time, mut crowd) = (0.0, Crowd::from(0.0));
    (0..200_000).find(|n| {
        time += interval(*n);
        crowd.push(time, 1.0).is_some()
    })
}

/// A decay that lasts for fewer than five windows of 4000 events is followed; a longer one is given
/// up, even if the intervals then stay constant.
#[test]
fn intervals_that_stop_shrinking_are_followed_after_a_short_decay() {
    assert_eq!(given_up(|n| 1e-6 + (-5e-3 * n as f64).exp()), None);
    assert!(given_up(|n| 1e-6 + (-1e-3 * n as f64).exp()).is_some());
    // The same holds for a slow modulation of frequent events.
    assert!(given_up(|n| 1e-5 * (1.5 + (n as f64 * 1e-4).sin())).is_some());
}

#[test]
fn only_ever_shorter_intervals_are_given_up() {
    assert!(given_up(|n| 1.0 / (1.0 + n as f64)).is_some_and(|n| n < 40_000));
    assert_eq!(given_up(|_| 1e-6), None);
    assert_eq!(given_up(|n| 1e-5 * (1.5 + (n as f64 * 1e-3).sin())), None);
}

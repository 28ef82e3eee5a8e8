//! Time histories and phase portraits of a solution.

use super::discretisation::DiscretisedProblem;
use super::work::Work;
use crate::core::failure::Failure;
use crate::core::problem::Profile;

/// The smallest number of points in the drawing of a segment.
const FEWEST_POINTS: usize = 100;

/// Returns the time history of each state and, for a segment with two or more states, the phase
/// portrait of the first two states. Segments whose states have the same name share a curve: the
/// segments are drawn one after another if the solution is periodic; otherwise, they start at the
/// same time.
pub(super) fn profiles(
    equations: &DiscretisedProblem,
    work: &mut Work<f64>,
) -> Result<Vec<Profile>, Failure> {
    let mut profiles: Vec<Profile> = Vec::new();
    along_segments(equations, |segment, names, begin| {
        let history = history(equations, segment, begin, work)?;
        let columns = |i: usize, j: usize| history.iter().map(|x| [x[i], x[j]]).collect();
        for (i, name) in names.iter().enumerate() {
            draw(&mut profiles, name, "time", columns(0, i + 1));
        }
        if let [first, second, ..] = names {
            draw(&mut profiles, second, first, columns(1, 2));
        }
        Ok(history.last().map(|last| last[0]))
    })?;
    Ok(profiles)
}

/// Visits the segments along which solutions move (all except the segments of a map), with the
/// names of their states and their start times. The function `visit` returns the end time of a
/// segment if the segment is drawn.
pub(super) fn along_segments(
    equations: &DiscretisedProblem,
    mut visit: impl FnMut(usize, &[String], f64) -> Result<Option<f64>, Failure>,
) -> Result<(), Failure> {
    let moves = equations.layout.shape.moves();
    let segments = if moves { equations.problem.segments() } else { Vec::new() };
    let mut begin = 0.0;
    for (segment, names) in segments.iter().enumerate() {
        let end = visit(segment, names, begin)?;
        if !equations.layout.returns.is_empty() {
            begin = end.unwrap_or(begin);
        }
    }
    Ok(())
}

/// Adds a curve to the profile with a given name; the profile can already contain curves of other
/// segments.
pub(super) fn draw(profiles: &mut Vec<Profile>, name: &str, along: &str, curve: Vec<[f64; 2]>) {
    let same = |p: &&mut Profile| p.name == name && p.along == along;
    match profiles.iter_mut().find(same) {
        Some(profile) => profile.points.extend(curve),
        None => {
            let (name, along) = (name.into(), along.into());
            profiles.push(Profile { name, along, points: curve });
        }
    }
}

/// Returns the number of points per interval of a segment; the last point of each interval is not
/// counted.
pub(super) fn points_each(equations: &DiscretisedProblem, segment: usize) -> usize {
    let intervals = equations.layout.segments[segment].intervals;
    FEWEST_POINTS.div_ceil(intervals).max(equations.layout.degree)
}

/// Computes time (counted from `begin`) and states along a segment, at evenly spaced points in each
/// interval.
pub(super) fn history(
    equations: &DiscretisedProblem,
    segment: usize,
    begin: f64,
    work: &mut Work<f64>,
) -> Result<Vec<Vec<f64>>, Failure> {
    let (s, q) =
        (&equations.layout.segments[segment], &work.numbers[equations.layout.local(segment)]);
    let duration = equations.duration_of(segment, q);
    let each = points_each(equations, segment);
    let mut history = Vec::with_capacity(s.intervals * each + 1);
    for interval in 0..s.intervals {
        let at = equations.interval((segment, interval), &work.nodes, &work.numbers);
        let passed = |place: f64| equations.problem.passed(segment, at.span.at(place), q);
        let time = |place: f64| begin + duration * passed(place);
        // A trajectory that does not exist, as at the failed end of a branch, is not drawn.
        let mut visit = |place: f64, x: &[f64]| {
            if x.iter().all(|x| x.is_finite()) {
                history.push([&[time(place)], x].concat());
            }
        };
        equations.method.trajectory(at, each, &mut work.local.method, &mut visit)?;
        if interval + 1 == s.intervals {
            visit(1.0, &at.nodes[at.nodes.len() - s.states..]);
        }
    }
    Ok(history)
}

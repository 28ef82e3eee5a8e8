//! Time histories and phase portraits of a solution.

use super::discretisation::DiscretisedProblem;
use super::work::Work;
use crate::core::failure::Failure;
use crate::core::problem::Profile;

/// A segment is drawn with at least as many points.
const FEWEST_POINTS: usize = 100;

/// The time history of each state and, of two or more on a segment, the portrait of the first
/// two. Where several segments have states of the same name, their curves are one: segments
/// follow each other if the solution is periodic, and begin together otherwise.
pub(super) fn profiles(
    equations: &DiscretisedProblem,
    work: &mut Work<f64>,
) -> Result<Vec<Profile>, Failure> {
    let mut profiles: Vec<Profile> = Vec::new();
    let mut draw = |name: &str, along: &str, curve: Vec<[f64; 2]>| {
        let same = |p: &&mut Profile| p.name == name && p.along == along;
        match profiles.iter_mut().find(same) {
            Some(profile) => profile.points.extend(curve),
            None => {
                let (name, along) = (name.into(), along.into());
                profiles.push(Profile { name, along, points: curve });
            }
        }
    };
    let mut begin = 0.0;
    let segments =
        if equations.layout.shape.moves() { equations.problem.segments() } else { Vec::new() };
    for (segment, names) in segments.iter().enumerate() {
        let history = history(equations, segment, begin, work)?;
        let columns = |i: usize, j: usize| history.iter().map(|x| [x[i], x[j]]).collect();
        for (i, name) in names.iter().enumerate() {
            draw(name, "time", columns(0, i + 1));
        }
        if let [first, second, ..] = &names[..] {
            draw(second, first, columns(1, 2));
        }
        if !equations.layout.returns.is_empty() {
            begin = history.last().map_or(begin, |last| last[0]);
        }
    }
    Ok(profiles)
}

/// Time (from `begin` on) and states along a segment, at places spread evenly over each
/// interval.
fn history(
    equations: &DiscretisedProblem,
    segment: usize,
    begin: f64,
    work: &mut Work<f64>,
) -> Result<Vec<Vec<f64>>, Failure> {
    let (s, q) =
        (&equations.layout.segments[segment], &work.numbers[equations.layout.local(segment)]);
    let duration = equations.duration_of(segment, q);
    let each = FEWEST_POINTS.div_ceil(s.intervals).max(equations.layout.degree);
    let mut history = Vec::with_capacity(s.intervals * each + 1);
    for interval in 0..s.intervals {
        let at = equations.interval((segment, interval), &work.nodes, &work.numbers);
        let time = |place: f64| begin + duration * at.span.at(place);
        // A trajectory that does not exist, as where a branch fails, is not drawn.
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

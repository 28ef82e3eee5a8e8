//! Time histories and phase portraits of a solution.

use super::equations::{Equations, Work};
use crate::core::bvp::{BoundaryProblem, Method};
use crate::core::zero::{Group, LeftDomain, Profile};

/// A segment is drawn with at least as many points.
const FEWEST_POINTS: usize = 100;

impl<P: BoundaryProblem, M: Method> Equations<P, M> {
    /// For each segment the time history of each state and, of two or more, the portrait of the first two.
    pub fn profiles(
        &self,
        unknowns: &[Group],
        work: &mut Work<f64, M>,
    ) -> Result<Vec<Profile>, LeftDomain> {
        let mut profiles = Vec::new();
        for segment in 0..self.layout.segments.len() {
            let s = &self.layout.segments[segment];
            let names = &unknowns[s.ends..s.ends + s.states];
            let history = self.history(segment, work)?;
            let columns = |i: usize, j: usize| history.iter().map(|x| [x[i], x[j]]).collect();
            for (i, group) in names.iter().enumerate() {
                let points = columns(0, i + 1);
                profiles.push(Profile { name: group.name.clone(), along: "time".into(), points });
            }
            if let [first, second, ..] = names {
                let (name, along) = (second.name.clone(), first.name.clone());
                profiles.push(Profile { name, along, points: columns(1, 2) });
            }
        }
        Ok(profiles)
    }

    /// Time and states along a segment, at places spread evenly over each interval.
    fn history(
        &self,
        segment: usize,
        work: &mut Work<f64, M>,
    ) -> Result<Vec<Vec<f64>>, LeftDomain> {
        let s = &self.layout.segments[segment];
        let duration = self.problem.duration(segment, &work.q);
        let each = FEWEST_POINTS.div_ceil(s.intervals).max(self.layout.degree);
        let mut history = Vec::with_capacity(s.intervals * each + 1);
        for interval in 0..s.intervals {
            let span = self.span(segment, interval);
            let nodes = &work.nodes[self.layout.interval(segment, interval)];
            let time = |place: f64| duration * (span.start + (span.end - span.start) * place);
            let mut visit = |place: f64, x: &[f64]| history.push([&[time(place)], x].concat());
            let place = self.interval((segment, interval), nodes, &work.q);
            self.method.trajectory(place, each, &mut work.local.method, &mut visit)?;
            if interval + 1 == s.intervals {
                visit(1.0, &nodes[nodes.len() - s.states..]);
            }
        }
        Ok(history)
    }
}

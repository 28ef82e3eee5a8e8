//! Where branches end though each step succeeds: they go to infinity, or nowhere.

use super::branch::End;
use super::corrector::Corrector;
use super::curve_point::CurvePoint;
use crate::core::linalg::{difference, norm};

/// (D) A branch has gone to infinity where a group of unknowns is this many times larger than it
/// was when the parameters last changed: no diagram shows both ends of such a piece.
const INFINITE: f64 = 1e6;

/// (D) Parameters that stay within this part of their scales stand still. On the way to infinity
/// they come to rest like a power of the unknowns.
const STILL: f64 = 1e-4;

/// (H) So many points in a row show whether a branch advances: fewer are spent on a sharp turn.
const MANY: usize = 200;

/// (H) A branch that stays within this part of the way which its steps have gone does not advance:
/// steps to and fro by chance get a fourteenth of their way ahead in so many points, steps around a
/// closed curve a third.
const NOWHERE: f64 = 0.03;

/// (H) Steps that are shorter than this part of the largest step in the mean do not advance: as
/// many as the largest number of points would be a hundredth of one step.
const CREEPING: f64 = 1e-5;

/// (H) Ways are compared while no group's scale grows by more than this factor.
const SAME_SCALE: f64 = 2.0;

/// What is compared at a point of a half of a branch.
struct View {
    /// The released parameters, in units of their scales.
    parameters: Vec<f64>,
    /// The norms of all groups of unknowns, and the scales of these.
    norms: Vec<f64>,
    scales: Vec<f64>,
    /// The sums of their unknowns, which have a sign.
    sums: Vec<f64>,
}

impl View {
    fn of(corrector: &Corrector, unknowns: &[f64]) -> Self {
        let Corrector { equations, norm: of, .. } = corrector;
        let (mut norms, mut scales, mut sums, mut start) = (vec![], vec![], vec![], 0);
        for group in &equations.names().unknowns {
            let values = &unknowns[start..start + group.length];
            norms.push(norm(values));
            sums.push(values.iter().sum::<f64>() / (group.length as f64).sqrt());
            scales.push(1.0 / of.scaled(start, 1.0));
            start += group.length;
        }
        let first = equations.parameters_at();
        let parameters = unknowns.iter().enumerate().skip(first).map(|(k, p)| of.scaled(k, *p));
        View { parameters: parameters.collect(), norms, scales, sums }
    }

    /// The distance from an earlier point, as far as it is seen.
    fn distance(&self, earlier: &View) -> f64 {
        let parameters = difference(&self.parameters, &earlier.parameters);
        let groups = [(&self.norms, &earlier.norms), (&self.sums, &earlier.sums)];
        let groups = groups.into_iter().flat_map(|(a, b)| {
            difference(a, b).into_iter().zip(&self.scales).map(|(d, scale)| d / scale)
        });
        norm(&parameters.into_iter().chain(groups).collect::<Vec<f64>>())
    }
}

/// How a half of a branch has advanced.
#[derive(Default)]
pub(super) struct Progress {
    /// The point at which parameters last changed.
    moved: Option<View>,
    watch: Option<Watch>,
}

/// A point since which a branch is watched, and then the points, their way, and the farthest
/// distance from it.
struct Watch {
    since: View,
    points: usize,
    way: f64,
    farthest: f64,
}

impl Progress {
    /// The end of the branch at a place that was accepted after a step of this length.
    pub fn end(
        &mut self,
        corrector: &Corrector,
        place: &CurvePoint,
        (length, max_step): (f64, f64),
    ) -> Option<End> {
        self.infinite(corrector, View::of(corrector, &place.unknowns))
            .or_else(|| self.nowhere(View::of(corrector, &place.unknowns), length, max_step))
    }

    /// The end of a branch that goes to infinity.
    fn infinite(&mut self, corrector: &Corrector, view: View) -> Option<End> {
        let still = |moved: &&View| {
            moved.parameters.iter().zip(&view.parameters).all(|(a, b)| (a - b).abs() <= STILL)
        };
        let Some(moved) = self.moved.as_ref().filter(still) else {
            self.moved = Some(view);
            return None;
        };
        let grown = |(scale, now): (&f64, &f64)| *now > INFINITE * scale;
        let group = moved.scales.iter().zip(&view.norms).position(grown)?;
        let name = corrector.equations.names().unknowns[group].name.clone();
        Some(End::Infinite { name, from: moved.norms[group], to: view.norms[group] })
    }

    /// The end of a branch whose points are many and cover nothing.
    fn nowhere(&mut self, view: View, length: f64, max_step: f64) -> Option<End> {
        let same = |watch: &&mut Watch| {
            let mut scales = watch.since.scales.iter().zip(&view.scales);
            scales.all(|(before, now)| *now <= SAME_SCALE * before)
        };
        let Some(watch) = self.watch.as_mut().filter(same) else {
            self.watch = Some(Watch { since: view, points: 0, way: 0.0, farthest: 0.0 });
            return None;
        };
        watch.points += 1;
        watch.way += length;
        watch.farthest = watch.farthest.max(view.distance(&watch.since));
        let Watch { points, way, farthest: distance, .. } = *watch;
        if points < MANY {
            return None;
        }
        self.watch = Some(Watch { since: view, points: 0, way: 0.0, farthest: 0.0 });
        let stuck = distance < NOWHERE * way || way < CREEPING * max_step * points as f64;
        stuck.then_some(End::NoProgress { points, way, distance })
    }
}

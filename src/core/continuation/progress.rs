//! Branch ends where every step succeeds: branches that go to infinity, or do not advance.

use super::corrector::Corrector;
use super::curve_point::CurvePoint;
use super::end::End;
use crate::core::linalg::norm;

/// (D) A branch has gone to infinity if a group of unknowns has grown by this factor since the
/// parameters last changed: no diagram shows both ends of such a piece. The parameters must also
/// converge, unlike after a fold: in the second half (in the logarithm of the size) they change by
/// no more than in the first, up to rounding.
const INFINITE: f64 = 1e6;
const AT_REST: f64 = 1e-13;

/// (D) Parameters are constant if they change by less than this fraction of their scales. On the
/// way to infinity they converge like a power of the unknowns.
const STILL: f64 = 1e-4;

/// (H) The number of consecutive points after which the progress of a branch is checked; a sharp
/// turn takes fewer.
const MANY: usize = 200;

/// (H) A quantity does not advance if its largest change is less than this fraction of the sum of
/// all its changes. For a random walk of [`MANY`] steps the fraction is 1/14, on a closed curve
/// 1/3. Arclength is not used: where a jump moves along an orbit, the length of a step is the
/// square root of the jump's displacement, so that the sum grows with the number of steps.
const NOWHERE: f64 = 0.03;

/// (R) A quantity does not advance if it changes by less than this fraction of its scale.
const LITTLE: f64 = 1e-6;

/// (H) A branch does not advance if its mean step is shorter than this fraction of the largest
/// allowed step: the maximal number of points would then cover a hundredth of one step.
const CREEPING: f64 = 1e-5;

/// (H) A branch crawls if over [`MANY`] points each quantity changes by less than this fraction of its
/// scale, and by less than this fraction of the arclength: the unknowns turn, as where a front moves along
/// a mesh, but nothing that a diagram shows changes.
const CRAWLING: f64 = 0.01;

/// (H) Path lengths are compared while no group's scale grows by more than this factor.
const SAME_SCALE: f64 = 2.0;

/// The quantities compared between points of a half of a branch.
#[derive(Clone)]
struct View {
    /// The released parameters, in units of their scales.
    parameters: Vec<f64>,
    /// The norms and scales of all groups of unknowns.
    norms: Vec<f64>,
    scales: Vec<f64>,
    /// The sums of the groups' unknowns, which have a sign.
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

    /// The changes of all quantities since an earlier point, in units of their current scales.
    fn changes<'a>(&'a self, earlier: &'a View) -> impl Iterator<Item = f64> + 'a {
        let parameters = self.parameters.iter().zip(&earlier.parameters).map(|(a, b)| a - b);
        let groups = [(&self.norms, &earlier.norms), (&self.sums, &earlier.sums)];
        let groups = groups.into_iter().flat_map(|(a, b)| {
            a.iter().zip(b).zip(&self.scales).map(|((a, b), scale)| (a - b) / scale)
        });
        parameters.chain(groups).map(f64::abs)
    }
}

/// The progress of a half of a branch.
#[derive(Default)]
pub(super) struct Progress {
    /// The point at which parameters last changed.
    moved: Option<View>,
    /// The parameters at the point where a group of unknowns was halfway from `moved` to infinity.
    halfway: Option<Vec<f64>>,
    watch: Option<Watch>,
    /// Whether the branch was found to crawl.
    crawls: bool,
}

/// A branch that crawls: the number of points, and the largest change of a quantity, in units of its scale.
pub(super) struct Crawl {
    pub points: usize,
    pub change: f64,
}

/// A reference point, and the progress of the branch since then.
struct Watch {
    since: View,
    last: View,
    points: usize,
    /// The sum of the lengths of all steps.
    way: f64,
    /// The path length of each quantity, and its largest distance from the reference point.
    ways: Vec<[f64; 2]>,
}

impl Watch {
    fn new(since: View) -> Self {
        let ways = since.changes(&since).map(|_| [0.0; 2]).collect();
        Watch { last: since.clone(), since, points: 0, way: 0.0, ways }
    }

    /// Adds the next point.
    fn advance(&mut self, view: View, length: f64) {
        self.points += 1;
        self.way += length;
        let changes = view.changes(&self.last).zip(view.changes(&self.since));
        for ([way, farthest], (step, distance)) in self.ways.iter_mut().zip(changes) {
            *way += step;
            *farthest = farthest.max(distance);
        }
        self.last = view;
    }

    /// The largest distance of a quantity from the reference point, if the branch crawls.
    fn crawl(&self) -> Option<Crawl> {
        let change = self.ways.iter().map(|[_, farthest]| *farthest).fold(0.0, f64::max);
        let crawls = change < CRAWLING * self.way.min(1.0);
        crawls.then_some(Crawl { points: self.points, change })
    }

    /// The largest ratio of a quantity's distance to its path length.
    fn ahead(&self) -> f64 {
        let advanced = self.ways.iter().filter(|[_, farthest]| *farthest > LITTLE);
        advanced.map(|[way, farthest]| farthest / way).fold(0.0, f64::max)
    }
}

impl Progress {
    /// Returns the end of the branch, if reached, at a point accepted after a step of this length, and
    /// otherwise whether the branch crawls, once.
    pub fn end(
        &mut self,
        corrector: &Corrector,
        place: &CurvePoint,
        (length, max_step): (f64, f64),
    ) -> (Option<End>, Option<Crawl>) {
        let end = self.infinite(corrector, View::of(corrector, &place.unknowns));
        if end.is_some() {
            return (end, None);
        }
        let (end, crawl) = self.nowhere(View::of(corrector, &place.unknowns), length, max_step);
        let crawl = crawl.filter(|_| end.is_none() && !self.crawls);
        self.crawls |= crawl.is_some();
        (end, crawl)
    }

    /// Returns the end of a branch that goes to infinity.
    fn infinite(&mut self, corrector: &Corrector, view: View) -> Option<End> {
        let still = |moved: &&View| {
            moved.parameters.iter().zip(&view.parameters).all(|(a, b)| (a - b).abs() <= STILL)
        };
        let Some(moved) = self.moved.as_ref().filter(still) else {
            (self.moved, self.halfway) = (Some(view), None);
            return None;
        };
        let grown = |factor: f64| {
            let mut groups = moved.scales.iter().zip(&view.norms);
            groups.position(|(scale, now)| *now > factor * scale)
        };
        grown(INFINITE.sqrt())?;
        let halfway = self.halfway.get_or_insert_with(|| view.parameters.clone());
        let group = grown(INFINITE)?;
        let change =
            |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| (a - b).abs()).sum::<f64>();
        let [before, since] =
            [change(&moved.parameters, halfway), change(halfway, &view.parameters)];
        if since > before + AT_REST {
            (self.moved, self.halfway) = (Some(view), None);
            return None;
        }
        let name = corrector.equations.names().unknowns[group].name.clone();
        Some(End::Infinite { name, from: moved.norms[group], to: view.norms[group] })
    }

    /// Returns the end of a branch that does not advance over many points, and whether it crawls.
    fn nowhere(&mut self, view: View, length: f64, max_step: f64) -> (Option<End>, Option<Crawl>) {
        let same = |watch: &&mut Watch| {
            let mut scales = watch.since.scales.iter().zip(&view.scales);
            scales.all(|(before, now)| *now <= SAME_SCALE * before)
        };
        let Some(watch) = self.watch.as_mut().filter(same) else {
            self.watch = Some(Watch::new(view));
            return (None, None);
        };
        watch.advance(view, length);
        if watch.points < MANY {
            return (None, None);
        }
        let (points, way, ahead, crawl) = (watch.points, watch.way, watch.ahead(), watch.crawl());
        self.watch = None;
        let stuck = ahead < NOWHERE || way < CREEPING * max_step * points as f64;
        (stuck.then_some(End::NoProgress { points, way, ahead }), crawl)
    }
}

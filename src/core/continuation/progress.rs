//! Detection of branches that go to infinity, or make no net progress, although every step
//! succeeds.

use super::corrector::Corrector;
use super::curve_point::CurvePoint;
use super::end::End;
use crate::core::linalg::norm;

/// Discretisation: a branch has gone to infinity if a group of unknowns has grown by this factor
/// since the parameters last changed: no diagram shows both ends of such a part of a branch. The
/// parameters must also converge, which they do not after a fold: while the group grows twice in
/// succession by the square root of this factor, the parameters must change no more during the
/// second growth than during the first, up to rounding.
const INFINITE: f64 = 1e6;
const AT_REST: f64 = 1e-13;

/// Discretisation: the parameters count as constant if they change by less than this fraction of
/// their scales. Along a branch that goes to infinity, the parameters converge like a power of the
/// unknowns.
const STILL: f64 = 1e-4;

/// Heuristic: the number of consecutive points after which the progress of a branch is checked. A
/// branch passes a sharp turn within fewer points.
const MANY: usize = 200;

/// Heuristic: a quantity makes no net progress if its largest distance from its value at the
/// reference point is less than this fraction of the sum of all its changes. For a random walk of
/// [`MANY`] steps, the largest distance is 1/14 of the sum; on a closed curve, it is 1/3 of the
/// sum. Arclength is not used as a measure of progress: if a discontinuity moves along an orbit,
/// the length of a step is the square root of the displacement of the discontinuity, so the sum of
/// lengths grows with the number of steps.
const NOWHERE: f64 = 0.03;

/// Rounding: a quantity makes no net progress if it changes by less than this fraction of its
/// scale.
const LITTLE: f64 = 1e-6;

/// Heuristic: a branch makes no net progress if its mean step is shorter than this fraction of the
/// largest allowed step. With a mean step of this length, the maximal number of points on the
/// branch would cover one hundredth of the largest allowed step.
const CREEPING: f64 = 1e-5;

/// Heuristic: a branch is reported as slow (`Crawl`) if over [`MANY`] points each quantity changes
/// by less than this fraction of its scale, and by less than this fraction of the arclength. On a
/// slow branch, the unknowns may change, for example because a front moves along a mesh, but all
/// quantities in a bifurcation diagram are almost constant.
const CRAWLING: f64 = 0.01;

/// Heuristic: Path lengths are compared only along a part of the branch on which the scale of each
/// group grows by less than this factor.
const SAME_SCALE: f64 = 2.0;

/// The quantities that are compared between points of one half of a branch.
#[derive(Clone)]
struct View {
    /// The released parameters, in units of their scales.
    parameters: Vec<f64>,
    /// The norms and scales of all groups of unknowns.
    norms: Vec<f64>,
    scales: Vec<f64>,
    /// The sum of the unknowns of each group, which, unlike the norm, has a sign.
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

    /// Returns the changes of all quantities since an earlier point, in units of their current
    /// scales.
    fn changes<'a>(&'a self, earlier: &'a View) -> impl Iterator<Item = f64> + 'a {
        let parameters = self.parameters.iter().zip(&earlier.parameters).map(|(a, b)| a - b);
        let groups = [(&self.norms, &earlier.norms), (&self.sums, &earlier.sums)];
        let groups = groups.into_iter().flat_map(|(a, b)| {
            a.iter().zip(b).zip(&self.scales).map(|((a, b), scale)| (a - b) / scale)
        });
        parameters.chain(groups).map(f64::abs)
    }
}

/// The progress of the continuation along one half of a branch.
#[derive(Default)]
pub(super) struct Progress {
    /// The quantities at the last point at which the parameters changed.
    moved: Option<View>,
    /// The parameters at the point where a group of unknowns had grown since `moved` by the square
    /// root of the factor that counts as infinite growth.
    halfway: Option<Vec<f64>>,
    watch: Option<Watch>,
    /// Whether the branch has already been reported as slow (`Crawl`).
    crawls: bool,
}

/// A slow part of a branch, on which the quantities in a bifurcation diagram are almost constant: the
/// number of points, and the largest change of a quantity, in units of its scale.
pub(super) struct Crawl {
    pub points: usize,
    pub change: f64,
}

/// A reference point of a branch, and the progress of the branch since this point.
struct Watch {
    since: View,
    last: View,
    points: usize,
    /// The sum of the lengths of all steps since the reference point.
    way: f64,
    /// The path length of each recorded quantity since the reference point, and the largest
    /// distance of the quantity from its value at the reference point.
    ways: Vec<[f64; 2]>,
}

impl Watch {
    fn new(since: View) -> Self {
        let ways = since.changes(&since).map(|_| [0.0; 2]).collect();
        Watch { last: since.clone(), since, points: 0, way: 0.0, ways }
    }

    /// Adds the next point of the branch.
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

    /// Returns the number of points and the largest change of a quantity since the reference point,
    /// if the branch is slow.
    fn crawl(&self) -> Option<Crawl> {
        let change = self.ways.iter().map(|[_, farthest]| *farthest).fold(0.0, f64::max);
        let crawls = change < CRAWLING * self.way.min(1.0);
        crawls.then_some(Crawl { points: self.points, change })
    }

    /// Returns the largest ratio, over all quantities, of the distance from the reference point to
    /// the path length.
    fn ahead(&self) -> f64 {
        let advanced = self.ways.iter().filter(|[_, farthest]| *farthest > LITTLE);
        advanced.map(|[way, farthest]| farthest / way).fold(0.0, f64::max)
    }
}

impl Progress {
    /// Checks the progress at a point accepted after a step of the given length. Returns the reason
    /// why the branch ends, if it ends, and the data of a slow branch, which are returned only once
    /// per branch.
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

    /// Returns the end of a branch that makes no net progress over many points, and the data of a
    /// branch that is slow.
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

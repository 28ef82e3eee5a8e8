//! What is seen of watched scalars along the segments, in one pass over the intervals.

use super::layout::UnknownLayout;
use crate::core::bvp::erased::Equations;
use crate::core::bvp::interval::MonitoredFunctions;
use crate::core::bvp::terms::{Monitor, Watched};
use crate::core::problem::{Observable, larger};

/// A place on a segment, and the value of a watched scalar there.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Sighting {
    pub interval: usize,
    pub place: f64,
    pub value: f64,
}

/// What is seen of one scalar on one segment. Between the places that are visited it is monotone.
#[derive(Clone, Copy, Debug)]
pub(super) struct Seen {
    pub largest: Sighting,
    pub smallest: Sighting,
    /// The value at the beginning of the segment.
    first: Option<f64>,
    /// The place visited last: at the end of all, the end of the segment.
    pub last: Option<Sighting>,
    /// Local minima inside: the one to which it falls from the beginning, the least one between two
    /// maxima, and the one from which it rises to the end.
    leading: Option<Sighting>,
    between: Option<Sighting>,
    trailing: Option<Sighting>,
    falling: bool,
    /// Its typical size.
    scale: f64,
    /// It falls or rises if it changes by more than this.
    depth: f64,
    /// Whether it has risen before the minimum visited last, or at all.
    risen: [bool; 2],
}

/// A scalar falls or rises if it changes by more than this, in units of its scale,
const DEPTH: f64 = 1e-12;

/// and by more than this share of the mesh's error: where a segment begins or ends tangent to a
/// surface, rounding and polynomials make minima of their own, shallower than the error elsewhere.
const FALSE_DIPS: f64 = 1e-3;

/// A segment begins on a surface where a guard is no larger than this, in units of its scale.
const ON: f64 = 1e-6;

impl Seen {
    const NOTHING: Seen = {
        let nowhere = Sighting { interval: 0, place: 0.0, value: f64::NEG_INFINITY };
        Seen {
            largest: nowhere,
            smallest: Sighting { value: f64::INFINITY, ..nowhere },
            first: None,
            last: None,
            leading: None,
            between: None,
            trailing: None,
            falling: false,
            scale: 1.0,
            depth: DEPTH,
            risen: [false; 2],
        }
    };

    fn visit(&mut self, here: Sighting) {
        self.first.get_or_insert(here.value);
        if here.value > self.largest.value {
            self.largest = here;
        }
        if here.value < self.smallest.value {
            self.smallest = here;
        }
        let Some(last) = self.last.replace(here) else { return };
        self.visit_minimum(last, here);
        if (here.value - last.value).abs() > self.depth {
            self.falling = here.value < last.value;
        }
    }

    /// What became the trailing minimum is between two maxima as soon as the scalar falls again.
    fn visit_minimum(&mut self, last: Sighting, here: Sighting) {
        let ([before, now], depth) = (&mut self.risen, self.depth);
        if here.value < last.value - depth
            && let Some(dip) = self.trailing.take()
        {
            let place = if *before { &mut self.between } else { &mut self.leading };
            if place.is_none_or(|least| dip.value < least.value) {
                *place = Some(dip);
            }
        }
        if here.value > last.value + depth {
            if self.falling {
                (self.trailing, *before) = (Some(last), *now);
            }
            *now = true;
        }
    }

    /// Local minima inside that count where the scalar vanishes in the events that begin or end the
    /// segment. A reset that leads away from the surface, as that of a neuron that fires, begins a
    /// segment elsewhere.
    pub fn dips(self, [begins, ends]: [bool; 2]) -> impl Iterator<Item = Sighting> {
        let begins = begins && self.first.is_none_or(|first| first.abs() <= ON * self.scale);
        let leading = self.leading.filter(|_| !begins);
        let trailing = self.trailing.filter(|_| !ends && (self.risen[0] || !begins));
        leading.into_iter().chain(self.between).chain(trailing)
    }
}

/// What monitors ask for on one segment.
#[derive(Clone, Default)]
struct OnSegment {
    /// The scalars asked for.
    watched: Vec<Observable>,
    /// Their typical sizes.
    scales: Vec<f64>,
    /// What is seen of them.
    seen: Vec<Seen>,
    /// The pairs asked for where the first of them rises through zero.
    rises: Vec<[Observable; 2]>,
    /// For each pair the place with the largest value of the second, with this value.
    risen: Vec<Option<Sighting>>,
}

/// All that monitors ask for.
#[derive(Default)]
pub(super) struct Extremes {
    segments: Vec<OnSegment>,
    /// The values at the nodes and the numbers for which they were found.
    at: Vec<f64>,
    /// Whether they were found with a larger error than the method's own.
    rough: bool,
}

impl Extremes {
    /// What these monitors ask for.
    pub fn of(monitors: &[Monitor], layout: &UnknownLayout) -> Self {
        let mut segments = vec![OnSegment::default(); layout.segments.len()];
        for monitor in monitors {
            if let Monitor::Rising(pairs) = monitor {
                for (w, value) in pairs {
                    segments[w.segment].rises.push([w.observable, *value]);
                    segments[w.segment].risen.push(None);
                }
            } else if !matches!(monitor, Monitor::Integral(..)) {
                for Watched { segment, observable } in monitor.watched() {
                    let OnSegment { watched, scales, seen, .. } = &mut segments[segment];
                    if !watched.contains(&observable) {
                        watched.push(observable);
                        scales.push(1.0);
                        seen.push(Seen::NOTHING);
                    }
                }
            }
        }
        Extremes { segments, ..Extremes::default() }
    }

    /// Where a scalar rises through zero on its segment, with the value of another one: the largest
    /// of these.
    pub fn risen(&self, through: Watched, value: Observable) -> Option<Sighting> {
        let OnSegment { rises, risen, .. } = &self.segments[through.segment];
        let position = rises.iter().position(|rise| *rise == [through.observable, value])?;
        risen[position]
    }

    /// What is seen of a scalar that was asked for.
    pub fn seen(&self, of: Watched) -> Seen {
        let OnSegment { watched, seen, .. } = &self.segments[of.segment];
        let position = watched.iter().position(|observable| *observable == of.observable);
        position.map_or(Seen::NOTHING, |k| seen[k])
    }

    /// Whether all is known at these values and numbers, perhaps only roughly.
    pub fn known(&self, nodes: &[f64], q: &[f64], rough: bool) -> bool {
        (rough || !self.rough) && self.at.iter().eq(nodes.iter().chain(q))
    }

    /// Begins to look at a solution with the numbers `q`, whose mesh causes this error.
    pub fn begin(&mut self, problem: &dyn Equations, q: &[f64], mesh_error: f64) {
        let depth = DEPTH.max(FALSE_DIPS * mesh_error);
        for (segment, on) in self.segments.iter_mut().enumerate() {
            for (k, &observable) in on.watched.iter().enumerate() {
                let scale = match observable {
                    Observable::Function(k) => problem.function_scale(segment, k, q),
                    Observable::State(i) => {
                        problem.scales(segment, q).get(i).copied().unwrap_or(1.0)
                    }
                };
                on.scales[k] = scale;
                on.seen[k] = Seen { scale, depth: depth * scale, ..Seen::NOTHING };
            }
            on.risen.fill(None);
        }
        self.at.clear();
    }

    pub fn end(&mut self, nodes: &[f64], q: &[f64], rough: bool) {
        self.at.extend(nodes.iter().chain(q));
        self.rough = rough;
    }

    /// What is asked for on a segment, and what takes in the extrema and rises of an interval, by
    /// number.
    pub fn visitor(
        &mut self,
        segment: usize,
        interval: usize,
    ) -> (MonitoredFunctions<'_>, impl FnMut(usize, f64, f64)) {
        let OnSegment { watched, scales, seen, rises, risen } = &mut self.segments[segment];
        let visit = move |k: usize, place: f64, value: f64| {
            let (here, extrema) = (Sighting { interval, place, value }, seen.len());
            match seen.get_mut(k) {
                Some(seen) => seen.visit(here),
                None => {
                    let risen = &mut risen[k - extrema];
                    *risen = larger(risen.take(), here, |sighting| sighting.value);
                }
            }
        };
        (MonitoredFunctions { extrema: watched, scales, rises }, visit)
    }
}

//! The extrema of all monitored scalars along the segments, computed in one pass over the
//! intervals.

use super::layout::UnknownLayout;
use crate::core::bvp::erased::Equations;
use crate::core::bvp::interval::MonitoredFunctions;
use crate::core::bvp::terms::{Monitor, Watched};
use crate::core::linalg::are_joined;
use crate::core::problem::{Extremes, Measure, Observable, Sighting, larger};

/// A position on a segment.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Place {
    /// The index of the interval in the mesh.
    pub interval: usize,
    /// The position in the interval, from 0 to 1.
    pub place: f64,
}

/// Discretisation: if a scalar changes by less than this fraction of the mesh error, the change is
/// ignored. Where a segment starts or ends tangentially to a surface, rounding errors and
/// interpolation cause spurious minima whose depth is smaller than the mesh error elsewhere.
const FALSE_DIPS: f64 = 1e-3;

/// The monitored scalars of one segment.
#[derive(Clone, Default)]
struct OnSegment {
    /// The scalars whose extrema are monitored.
    watched: Vec<Observable>,
    /// The typical sizes of the scalars whose extrema are monitored.
    scales: Vec<f64>,
    /// The extrema of the monitored scalars.
    extremes: Vec<Extremes<Place>>,
    /// The pairs of scalars: the second scalar is evaluated at the upward zero crossings of the
    /// first.
    rises: Vec<[Observable; 2]>,
    /// For each pair, the position of the upward crossing with the largest value of the second
    /// scalar, and this value.
    risen: Vec<Option<Sighting<Place>>>,
}

impl OnSegment {
    /// Adds a scalar whose extrema are monitored.
    fn watch(&mut self, observable: Observable) {
        if !self.watched.contains(&observable) {
            self.watched.push(observable);
            self.scales.push(1.0);
            self.extremes.push(Extremes::new(1.0, 0.0));
        }
    }
}

/// The extrema and upward zero crossings of scalars that the monitors need.
#[derive(Default)]
pub(super) struct MonitoredExtremes {
    segments: Vec<OnSegment>,
    /// The values at the nodes, and the parameters and extra unknowns `q`, for which the extrema
    /// were computed.
    at: Vec<f64>,
    /// Whether the extrema were computed with a larger error than the method's own error.
    rough: bool,
}

impl MonitoredExtremes {
    /// Creates empty extrema for a list of monitors.
    pub fn of(monitors: &[Monitor], layout: &UnknownLayout) -> Self {
        let mut segments = vec![OnSegment::default(); layout.segments.len()];
        for monitor in monitors {
            if let Measure::Rising { through, value } = monitor {
                for (w, value) in pairs(through, value) {
                    segments[w.segment].rises.push([w.observable, value]);
                    segments[w.segment].risen.push(None);
                }
            }
            for w in monitor.of_extremes() {
                segments[w.segment].watch(w.observable);
            }
        }
        MonitoredExtremes { segments, ..MonitoredExtremes::default() }
    }

    /// Among the upward zero crossings of a scalar on its segment, returns the crossing at which
    /// another scalar is largest.
    pub fn risen(&self, through: Watched, value: Observable) -> Option<Sighting<Place>> {
        let OnSegment { rises, risen, .. } = &self.segments[through.segment];
        let position = rises.iter().position(|rise| *rise == [through.observable, value])?;
        risen[position]
    }

    /// Returns the extrema of a monitored scalar.
    pub fn of_scalar(&self, of: Watched) -> Option<&Extremes<Place>> {
        let OnSegment { watched, extremes, .. } = &self.segments[of.segment];
        watched.iter().position(|observable| *observable == of.observable).map(|k| &extremes[k])
    }

    /// Whether the extrema are known for the given values at nodes and the given vector `q`;
    /// `rough` also accepts extrema with a larger error.
    pub fn known(&self, nodes: &[f64], q: &[f64], rough: bool) -> bool {
        (rough || !self.rough) && are_joined(&self.at, nodes, q)
    }

    /// Starts the evaluation of a solution with the given vector `q` of parameters and extra
    /// unknowns, and the given mesh error.
    pub fn begin(&mut self, problem: &dyn Equations, q: &[f64], mesh_error: f64) {
        for (segment, on) in self.segments.iter_mut().enumerate() {
            for (k, &observable) in on.watched.iter().enumerate() {
                let scale = match observable {
                    Observable::Function(k) => problem.function_scale(segment, k, q),
                    Observable::State(i) => {
                        problem.scales(segment, q).get(i).copied().unwrap_or(1.0)
                    }
                };
                on.scales[k] = scale;
                on.extremes[k] = Extremes::new(scale, FALSE_DIPS * mesh_error).known_to(mesh_error);
            }
            on.risen.fill(None);
        }
        self.at.clear();
    }

    pub fn end(&mut self, nodes: &[f64], q: &[f64], rough: bool) {
        self.at.extend(nodes.iter().chain(q));
        self.rough = rough;
    }

    /// Returns the monitored functions of a segment, and a callback that records an extremum or a
    /// crossing in an interval under the number of the monitored function.
    pub fn visitor(
        &mut self,
        segment: usize,
        interval: usize,
    ) -> (MonitoredFunctions<'_>, impl FnMut(usize, f64, f64)) {
        let OnSegment { watched, scales, extremes, rises, risen } = &mut self.segments[segment];
        let visit = move |k: usize, place: f64, value: f64| {
            let (place, scalars) = (Place { interval, place }, extremes.len());
            match extremes.get_mut(k) {
                Some(extremes) => extremes.visit(place, value),
                None => {
                    let risen = &mut risen[k - scalars];
                    *risen = larger(risen.take(), Sighting { place, value }, |s| s.value);
                }
            }
        };
        (MonitoredFunctions { extrema: watched, scales, rises }, visit)
    }
}

/// Returns the pairs of a scalar that crosses zero upwards and a scalar that is evaluated there, on
/// the segments that define both scalars.
pub(super) fn pairs(
    through: &[Watched],
    value: &[Watched],
) -> impl Iterator<Item = (Watched, Observable)> {
    through.iter().filter_map(move |w| {
        let value = value.iter().find(|value| value.segment == w.segment)?;
        Some((*w, value.observable))
    })
}

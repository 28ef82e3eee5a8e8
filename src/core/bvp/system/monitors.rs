//! Monitors of a discretised boundary-value problem, and their gradients.

use super::equations::{Equations, Work};
use super::layout::{Layout, span};
use super::local::{Dependence, Passes};
use crate::core::bvp::{BoundaryProblem, Interval, Method, Monitor};
use crate::core::chunk::{CHUNK, Chunk, parts};
use crate::core::zero::LeftDomain;

/// The name of the monitor that estimates the error of the mesh.
pub(super) const MESH_ERROR: &str = "mesh_error";

/// Where a state on a segment is extremal.
#[derive(Clone, Copy, Default)]
struct Extremum {
    interval: usize,
    place: f64,
    value: f64,
}

/// The extremes of the states that monitors ask for.
#[derive(Default)]
pub(super) struct Extremes {
    /// The states asked for, for each segment.
    states: Vec<Vec<usize>>,
    /// The largest and the smallest value of each state of all segments.
    found: Vec<[Extremum; 2]>,
    /// The values at the nodes and the numbers for which they were found.
    at: Vec<f64>,
}

impl Extremes {
    /// What these monitors ask for.
    pub fn of(monitors: &[Monitor], layout: &Layout) -> Self {
        let mut states = vec![Vec::new(); layout.segments.len()];
        for monitor in monitors {
            if let Monitor::Maximum { segment, state } | Monitor::Minimum { segment, state } =
                *monitor
                && !states[segment].contains(&state)
            {
                states[segment].push(state);
            }
        }
        Extremes { states, found: vec![Default::default(); layout.states], at: Vec::new() }
    }

    /// Whether they are known at these values and numbers.
    fn known(&self, nodes: &[f64], q: &[f64]) -> bool {
        self.at.iter().eq(nodes.iter().chain(q))
    }

    fn begin(&mut self) {
        let none = Extremum { value: f64::NAN, ..Extremum::default() };
        self.found.fill([none; 2]);
        self.at.clear();
    }

    fn end(&mut self, nodes: &[f64], q: &[f64]) {
        self.at.extend(nodes.iter().chain(q));
    }

    /// The states asked for on a segment, and what takes in the extrema of an interval.
    fn visitor(
        &mut self,
        layout: &Layout,
        segment: usize,
        interval: usize,
    ) -> (&[usize], impl FnMut(usize, f64, f64)) {
        let (ends, found) = (layout.segments[segment].ends, &mut self.found);
        let visit = move |state: usize, place: f64, value: f64| {
            let here = Extremum { interval, place, value };
            let [largest, smallest] = &mut found[ends + state];
            if value > largest.value || largest.value.is_nan() {
                *largest = here;
            }
            if value < smallest.value || smallest.value.is_nan() {
                *smallest = here;
            }
        };
        (&self.states[segment], visit)
    }
}

impl<P: BoundaryProblem, M: Method> Equations<P, M> {
    /// The values of all monitors at the arguments of `work`.
    pub fn evaluate_monitors(
        &mut self,
        work: &mut Work<f64, M>,
        values: &mut [f64],
    ) -> Result<(), LeftDomain> {
        let count = self.monitors.len();
        self.find_extremes(&work.nodes, &work.q, None)?;
        for k in 0..count {
            values[k] = match self.monitors[k] {
                Monitor::Duration => self.duration(&work.q),
                Monitor::Maximum { segment, state } => self.extremum(segment, state, 0).value,
                Monitor::Minimum { segment, state } => self.extremum(segment, state, 1).value,
            };
        }
        if let Some(error) = values.get_mut(count) {
            *error = self.largest_error(&work.nodes).map_or(0.0, |largest| largest.error);
        }
        Ok(())
    }

    /// Adds the gradient of a monitor at `x`, which `work` has loaded, to `out`.
    pub fn add_monitor_gradient(
        &mut self,
        monitor: usize,
        x: &[f64],
        work: &Work<f64, M>,
        passes: &mut Passes<Chunk, M>,
        out: &mut [f64],
    ) -> Result<(), LeftDomain> {
        match self.monitors.get(monitor) {
            Some(Monitor::Duration) => {
                let dependence = Dependence { unknowns: &[], numbers: &self.layout.all_numbers };
                self.add_slopes(dependence, x, passes, out, |passes| Ok(self.duration(&passes.q)))
            }
            Some(&Monitor::Maximum { segment, state }) => {
                self.find_extremes(&work.nodes, &work.q, None)?;
                let extremum = self.extremum(segment, state, 0);
                self.add_extremum(segment, state, &extremum, x, passes, out)
            }
            Some(&Monitor::Minimum { segment, state }) => {
                self.find_extremes(&work.nodes, &work.q, None)?;
                let extremum = self.extremum(segment, state, 1);
                self.add_extremum(segment, state, &extremum, x, passes, out)
            }
            None => self.add_error_gradient(x, work, passes, out),
        }
    }

    /// The duration of all segments together.
    fn duration<T: crate::core::scalar::Scalar>(&self, q: &[T]) -> T {
        let each = self.meshes.iter().enumerate();
        each.fold(T::zero(), |sum, (s, mesh)| sum + self.problem.duration(s, q) * mesh.end())
    }

    /// The largest (0) or smallest (1) value of a state, found last.
    fn extremum(&self, segment: usize, state: usize, which: usize) -> Extremum {
        self.extremes.found[self.layout.segments[segment].ends + state][which]
    }

    /// Finds the extremes of all states that monitors ask for, in one pass over the intervals, and writes the
    /// intervals' residuals where these are asked for.
    pub(super) fn find_extremes(
        &mut self,
        nodes: &[f64],
        q: &[f64],
        mut residual: Option<&mut [f64]>,
    ) -> Result<(), LeftDomain> {
        let Equations { problem, method, meshes, layout, extremes, .. } = self;
        if residual.is_none() && extremes.known(nodes, q) {
            return Ok(());
        }
        extremes.begin();
        for (s, j) in layout.intervals() {
            let r = residual.as_deref_mut().map(|r| &mut r[layout.equations(s, j)]);
            let (span, nodes) = (span(meshes, s, j), &nodes[layout.interval(s, j)]);
            let (states, mut visit) = extremes.visitor(layout, s, j);
            method.extrema(Interval { problem, span, nodes, q }, states, r, &mut visit)?;
        }
        extremes.end(nodes, q);
        Ok(())
    }

    /// At an extremum inside, the derivative by the place vanishes, and at an end the place is fixed: the
    /// gradient is that of the value at a fixed place.
    fn add_extremum(
        &self,
        segment: usize,
        state: usize,
        extremum: &Extremum,
        x: &[f64],
        passes: &mut Passes<Chunk, M>,
        out: &mut [f64],
    ) -> Result<(), LeftDomain> {
        let layout = &self.layout;
        let (place, n) = ((segment, extremum.interval), layout.segments[segment].states);
        let unknowns = &layout.order[layout.interval(segment, extremum.interval)];
        let dependence = Dependence { unknowns, numbers: &layout.all_numbers };
        self.add_slopes(dependence, x, passes, out, |passes| {
            let Passes { unknowns, q, local, .. } = passes;
            let (interval, x) = (self.interval(place, unknowns, q), &mut local.x[..n]);
            self.method.value(interval, extremum.place, &mut local.method, x)?;
            Ok(x[state])
        })
    }

    /// Adds the gradient of a function of some unknowns and numbers.
    pub fn add_slopes(
        &self,
        dependence: Dependence,
        x: &[f64],
        passes: &mut Passes<Chunk, M>,
        out: &mut [f64],
        mut function: impl FnMut(&mut Passes<Chunk, M>) -> Result<Chunk, LeftDomain>,
    ) -> Result<(), LeftDomain> {
        for start in (0..dependence.len()).step_by(CHUNK) {
            passes.load(&self.layout, dependence, start, x, |_, seeded| seeded);
            let slopes = parts(&function(passes)?);
            for (k, slope) in (start..dependence.len()).zip(slopes) {
                out[dependence.position(&self.layout, k)] += slope;
            }
        }
        Ok(())
    }
}

//! The mesh error, estimated by comparing the polynomials of neighbouring intervals, whose `m`-th
//! derivatives are constant (C. de Boor, *Good approximation by splines with variable knots II*,
//! 1974; U. Ascher, R. Mattheij and R. Russell, *Numerical Solution of Boundary Value Problems for
//! Ordinary Differential Equations*, 1988, section 9.1):
//!
//! ```text
//!     |x^{(m+1)}| ≈ max |x^{(m)}_{j±1} − x^{(m)}_j| / ½(h_{j±1} + h_j)    in interval j
//! ```
//!
//! The reported error is a sum of two terms. The first term is `2 C h^{m+1}` times the estimate of
//! `|x^{(m+1)}|`; the factor 2 allows for the variation of the derivative within an interval. The second
//! term is the square of the last term of the polynomial's Legendre series, `m!/(2m)!·h^m·|x^{(m)}|`; it
//! is added because neighbouring polynomials in an unresolved layer can be alike and equally wrong. If
//! the mesh resolves the solution, the square of the last term is negligible.

use super::discretisation::DiscretisedProblem;
use super::local::{Arguments, Dependence, Gradient};
use super::work::Work;
use crate::core::bvp::method::Method;
use crate::core::failure::Failure;
use crate::core::linalg::{are_joined, largest, refill};
use crate::core::numerics::highest_derivative;
use crate::core::scalar::{Chunk, Scalar};

/// Rounding: values of a state can be rounding errors if they are smaller than this fraction of the
/// largest value of any state.
const SMALL: f64 = 1e-9;

/// Rounding: values of a state are treated as zeros that Newton's iteration did not reach exactly
/// if they are smaller than this fraction of the largest value of any state (or of 1, if the
/// largest value exceeds 1).
const NOTHING: f64 = 1e-25;

/// Rounding: the smallest size of a state, as a fraction of its scale; it is less than one half,
/// because a state whose range equals its scale has values of at least half the scale.
const LEAST: f64 = 0.4;

/// Heuristic: a polynomial is treated as noise if the ratio of its highest term to its values is
/// larger than this bound.
const ROUGH: f64 = 0.5;

/// Rounding: On a segment shorter than this fraction of the total length of all segments, solutions
/// are constant on any mesh; states that are zero at the start of the segment are rounding errors
/// on the whole segment.
const SHORT: f64 = 1e-9;

/// The largest estimated error of a state, in units of the state's largest value, and the position
/// of this error.
#[derive(Clone, Copy)]
pub(super) struct LargestError {
    pub segment: usize,
    pub state: usize,
    pub interval: usize,
    pub error: f64,
}

/// Error estimates of solutions on the current meshes.
pub(super) struct MeshError {
    /// The weights of the values at the nodes in the `m`-th derivative of the polynomial.
    highest: Vec<f64>,
    /// The factor `m!/(2m)!` of the last term of a Legendre series.
    legendre: f64,
    /// The last estimated error, with the values at nodes and the vectors `q` for which it was
    /// estimated; empty before the first estimate.
    largest: Option<LargestError>,
    at: Vec<f64>,
    /// Scratch space for positions in `z`, kept to avoid repeated allocations.
    positions: Vec<usize>,
}

impl MeshError {
    pub fn new(method: &Method) -> Self {
        let highest = highest_derivative(method.places());
        let m = highest.len() - 1;
        let legendre = (m + 1..=2 * m).map(|k| 1.0 / k as f64).product();
        MeshError { highest, legendre, largest: None, at: Vec::new(), positions: Vec::new() }
    }

    /// Discards the last estimate when the mesh changes.
    pub fn forget(&mut self) {
        self.at.clear();
    }

    /// Returns the largest value of a state on a segment, or its `floor` if this is larger; `None`
    /// if the state vanishes up to rounding errors, because its polynomials are then noise in most
    /// intervals. The argument `most` is the largest value of all states.
    fn size_of(
        &self,
        equations: &DiscretisedProblem,
        (segment, state): (usize, usize),
        nodes: &[f64],
        (most, floor): (f64, f64),
    ) -> Option<f64> {
        let s = &equations.layout.segments[segment];
        let value = |k: usize| nodes[s.values + k * s.states + state];
        let size = (0..s.nodes).map(|k| value(k).abs()).fold(0.0, f64::max);
        if size < floor {
            return Some(floor);
        }
        let is_rough = |&j: &usize| self.highest_sum(j, value).abs() > ROUGH * size;
        let noise = || 2 * (0..s.intervals).filter(is_rough).count() > s.intervals;
        (size > SMALL * most || size > NOTHING * most.min(1.0) && !noise()).then_some(size)
    }

    /// Computes the largest estimated error of a solution from its values at nodes and from the
    /// vectors `q` of all segments; `None` if the method has no mesh error, or if all states
    /// vanish.
    pub fn largest(
        &mut self,
        equations: &DiscretisedProblem,
        nodes: &[f64],
        numbers: &[f64],
    ) -> Option<LargestError> {
        equations.method.error_constant()?;
        if !are_joined(&self.at, nodes, numbers) {
            self.largest = self.estimate(equations, nodes, numbers);
            refill(&mut self.at, nodes.iter().chain(numbers).copied());
        }
        self.largest
    }

    /// Computes the largest estimated error of the solution loaded in `work`, in units of the state's
    /// largest value; 0 if the method has no mesh error.
    pub fn of(&mut self, equations: &DiscretisedProblem, work: &Work<f64>) -> f64 {
        let largest = self.largest(equations, &work.nodes, &work.numbers);
        largest.map_or(0.0, |largest| largest.error)
    }

    fn estimate(
        &self,
        equations: &DiscretisedProblem,
        nodes: &[f64],
        numbers: &[f64],
    ) -> Option<LargestError> {
        let (most, whole) = (largest(nodes), equations.duration(numbers, |_| true));
        let mut largest: Option<LargestError> = None;
        for (segment, s) in equations.layout.segments.iter().enumerate() {
            if equations.duration(numbers, |other| other == segment).abs() <= SHORT * whole.abs() {
                continue;
            }
            let floors = Floors::new(equations, segment, (nodes, numbers));
            for state in 0..s.states {
                let value = |k: usize| nodes[s.values + k * s.states + state];
                let least = (most, floors.of(state));
                let Some(size) = self.size_of(equations, (segment, state), nodes, least) else {
                    continue;
                };
                self.for_intervals(equations, segment, value, |interval, near| {
                    let error = self
                        .error(equations, (segment, interval), size, |j| near[j + 1 - interval]);
                    if largest.as_ref().is_none_or(|largest| error > largest.error) {
                        largest = Some(LargestError { segment, state, interval, error });
                    }
                });
            }
        }
        largest
    }

    /// Returns the estimated error of a state in an interval, in units of the state's size, given
    /// `x^{(m)}` in the segment's intervals.
    fn error<T: Scalar>(
        &self,
        equations: &DiscretisedProblem,
        (segment, interval): (usize, usize),
        size: T,
        highest: impl Fn(usize) -> T,
    ) -> T {
        let (span, m) = (equations.span(segment, interval), equations.layout.degree);
        let h = span.end - span.start;
        let power = h.powi(m as i32);
        let constant = 2.0 * equations.method.error_constant().unwrap_or(0.0) * power * h;
        let last_term = highest(interval) * (power * self.legendre) / size;
        next_derivative(equations, (segment, interval), highest) * constant / size
            + last_term * last_term
    }

    /// Computes `h^m x^{(m)}` in an interval, for the polynomial of degree `m` of one state.
    fn highest_sum<T: Scalar>(&self, interval: usize, value: impl Fn(usize) -> T) -> T {
        let first = interval * (self.highest.len() - 1);
        let weights = self.highest.iter().enumerate();
        weights.fold(T::zero(), |sum, (a, weight)| sum + value(first + a) * *weight)
    }

    /// Computes the derivative `x^{(m)}` in an interval of a segment.
    fn highest_in<T: Scalar>(
        &self,
        equations: &DiscretisedProblem,
        segment: usize,
        interval: usize,
        value: impl Fn(usize) -> T,
    ) -> T {
        let span = equations.span(segment, interval);
        self.highest_sum(interval, value)
            / (span.end - span.start).powi(equations.layout.degree as i32)
    }

    /// Collects, for each interval of a segment, the derivatives `x^{(m)}` in the previous interval, in
    /// the interval, and in the next interval.
    fn for_intervals(
        &self,
        equations: &DiscretisedProblem,
        segment: usize,
        value: impl Fn(usize) -> f64,
        mut each: impl FnMut(usize, [f64; 3]),
    ) {
        let intervals = equations.layout.segments[segment].intervals;
        let highest = |interval: usize| match interval < intervals {
            true => self.highest_in(equations, segment, interval, &value),
            false => 0.0,
        };
        let mut near = [0.0, 0.0, highest(0)];
        for interval in 0..intervals {
            near = [near[1], near[2], highest(interval + 1)];
            each(interval, near);
        }
    }

    /// Adds the gradient of the largest estimated error, which depends on the state in the interval and
    /// in its neighbours, and on the state's largest value.
    pub fn add_gradient(
        &mut self,
        equations: &DiscretisedProblem,
        work: &Work<f64>,
        Gradient { x, passes, out, .. }: &mut Gradient,
    ) -> Result<(), Failure> {
        let Some(LargestError { segment, state, interval, .. }) =
            self.largest(equations, &work.nodes, &work.numbers)
        else {
            return Ok(());
        };
        let (s, m) = (&equations.layout.segments[segment], equations.layout.degree);
        let first = interval.saturating_sub(1) * m;
        let last = ((interval + 2) * m).min(s.nodes - 1);
        let start = s.values + state * s.nodes;
        let mut positions = std::mem::take(&mut self.positions);
        refill(&mut positions, start + first..=start + last);
        positions
            .extend((start..start + s.nodes).max_by(|a, b| x[*a].abs().total_cmp(&x[*b].abs())));
        let dependence = Dependence { unknowns: &positions, segment: None, numbers: &[] };
        let floors = Floors::new(equations, segment, (&work.nodes, &work.numbers));
        let floor = floors.of(state);
        let at = Arguments::plain(x);
        let outcome = passes.add_gradient(&equations.layout, dependence, at, out, |passes| {
            let largest = passes.unknowns[last + 1 - first];
            let own = largest * largest.re.signum();
            let size = if own.re < floor { Chunk::constant(floor) } else { own };
            let value = |k: usize| passes.unknowns[k - first];
            let highest = |j| self.highest_in(equations, segment, j, value);
            Ok(self.error(equations, (segment, interval), size, highest))
        });
        self.positions = positions;
        outcome
    }

    /// Returns, for each interval of a segment, the largest `(|x_i^{(m+1)}| / size_i)^{1/(m+1)}`: on a
    /// mesh with equidistributed error, the product of this density and the interval's length is
    /// constant. The size of a state is the state's largest value, or a smaller size defined by the
    /// problem. The density is at least a tenth of its mean, which limits the length of an interval in
    /// which the derivative happens to vanish.
    pub fn density(
        &self,
        equations: &DiscretisedProblem,
        segment: usize,
        Work { nodes, numbers, .. }: &Work<f64>,
    ) -> Vec<f64> {
        let s = &equations.layout.segments[segment];
        let exponent = 1.0 / (equations.layout.degree as f64 + 1.0);
        let mut density = vec![0.0; s.intervals];
        let most = largest(nodes);
        let sizes = sizes_near(equations, segment, (nodes, numbers));
        let floors = Floors::new(equations, segment, (nodes, numbers));
        for state in 0..s.states {
            let value = |k: usize| nodes[s.values + k * s.states + state];
            let least = (most, floors.of(state));
            let Some(size) = self.size_of(equations, (segment, state), nodes, least) else {
                continue;
            };
            let moves = size > floors.of(state);
            self.for_intervals(equations, segment, value, |interval, near| {
                let next =
                    next_derivative(equations, (segment, interval), |j| near[j + 1 - interval]);
                let near = sizes.get(interval).filter(|_| moves).map_or(size, |sizes| sizes[state]);
                density[interval] = (next / size.min(near)).powf(exponent).max(density[interval]);
            });
        }
        let mesh = &equations.meshes[segment];
        let mean = mesh.integral(&density) / mesh.end();
        density.iter_mut().for_each(|density| *density = density.max(0.1 * mean));
        density
    }
}

/// Lower bounds for the sizes of a segment's states; empty unless the problem defines the size of
/// the motion near a state. The values of a constant state do not determine the size of this state,
/// so the size of the motion gives a lower bound.
struct Floors(Vec<f64>);

impl Floors {
    fn new(
        equations: &DiscretisedProblem,
        segment: usize,
        (nodes, numbers): (&[f64], &[f64]),
    ) -> Self {
        let DiscretisedProblem { layout, problem, .. } = equations;
        let (s, q) = (&layout.segments[segment], &numbers[layout.local(segment)]);
        if problem.size_near(segment, &nodes[s.values..][..s.states], q).is_none() {
            return Floors(Vec::new());
        }
        Floors(problem.scales(segment, q).iter().map(|scale| LEAST * scale).collect())
    }

    /// Returns the lower bound for the size of a state; zero if the problem does not define a
    /// bound.
    fn of(&self, state: usize) -> f64 {
        self.0.get(state).copied().unwrap_or(0.0)
    }
}

/// Returns the sizes of the motion that the problem defines for each interval of a segment; empty if it
/// does not define them.
fn sizes_near(
    equations: &DiscretisedProblem,
    segment: usize,
    (nodes, numbers): (&[f64], &[f64]),
) -> Vec<Vec<f64>> {
    let DiscretisedProblem { layout, problem, .. } = equations;
    let (s, q) = (&layout.segments[segment], &numbers[layout.local(segment)]);
    let at = |node: usize| {
        problem.size_near(segment, &nodes[s.values + node * s.states..][..s.states], q)
    };
    let all: Option<Vec<f64>> = (0..s.nodes).step_by(layout.degree).map(at).collect();
    let scales = problem.scales(segment, q);
    let of = |pair: &[f64]| scales.iter().map(|scale| scale * pair[0].min(pair[1])).collect();
    all.map_or(Vec::new(), |all| all.windows(2).map(of).collect())
}

/// Estimates `|x^{(m+1)}|` of a state in an interval, given `x^{(m)}` in the segment's intervals. On a
/// mesh with a single interval, the estimate is computed from the highest derivative of the only
/// polynomial, and overestimates `|x^{(m+1)}|` if the series converges.
fn next_derivative<T: Scalar>(
    equations: &DiscretisedProblem,
    (segment, interval): (usize, usize),
    highest: impl Fn(usize) -> T,
) -> T {
    let points = equations.meshes[segment].points();
    let length = |j: usize| points[j + 1] - points[j];
    let here = highest(interval);
    if points.len() == 2 {
        return here.abs() / length(0);
    }
    let before = interval.checked_sub(1);
    let after = Some(interval + 1).filter(|j| j + 1 < points.len());
    let mut largest = T::zero();
    for j in before.into_iter().chain(after) {
        let slope = ((highest(j) - here) * (2.0 / (length(j) + length(interval)))).abs();
        if slope.real() > largest.real() {
            largest = slope;
        }
    }
    largest
}

/// Returns a number of intervals that is larger by a tenth than the number with which an
/// equidistributed error equals a tolerance; the number is not rounded, and is not finite if no
/// number of intervals suffices.
pub(super) fn intervals_for(
    equations: &DiscretisedProblem,
    segment: usize,
    density: &[f64],
    tolerance: f64,
) -> f64 {
    let constant = equations.method.error_constant().unwrap_or(0.0);
    let exponent = 1.0 / (equations.layout.degree as f64 + 1.0);
    1.1 * equations.meshes[segment].integral(density) * (2.0 * constant / tolerance).powf(exponent)
}

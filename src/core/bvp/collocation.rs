//! Collocation at Gauss points for boundary-value problems.
//!
//! On an interval of length `h` the trajectory is a polynomial of degree `m`, given by its values
//! `x_j` at the `m + 1` Lobatto nodes, and satisfies the differential equation at the `m` Gauss
//! points `ρ_c`:
//!
//! ```text
//!     Σ_j ℓ_j'(ρ_c) x_j − h L f(t_c, Σ_j ℓ_j(ρ_c) x_j, q) = 0,    c = 1 … m
//! ```
//!
//! The error of the polynomial is `h^{m+1} x^{(m+1)} P(s) + O(h^{m+2})` with `P(s) = ∫₀ˢ Π_c (t −
//! ρ_c) dt / m!`, and `O(h^{2m})` at the ends of intervals (C. de Boor and B. Swartz, *Collocation
//! at Gaussian points*, 1973; U. Ascher, R. Mattheij and R. Russell, *Numerical Solution of
//! Boundary Value Problems for Ordinary Differential Equations*, 1988, section 5.4). The error
//! polynomial `P` vanishes at the Lobatto nodes, so the solution is one order more accurate at the
//! nodes than between them.

mod basis;
mod linearise;

use super::colored::ColoredField;
use super::erased::{Number, WatchNumber};
use super::interval::{Block, Interval, MonitoredFunctions, placed, weighted};
use crate::core::cancel::CancelToken;
use crate::core::failure::Failure;
use crate::core::linalg::refill;
use crate::core::numerics::{Limits, bracketed_zero, lagrange};
use crate::core::problem::{FieldIn, Observable, WatchIn};
use crate::core::scalar::{CHUNK, Scalar};
use crate::core::system::Matrices;
use crate::core::vectors::in_fours;
use basis::{Basis, combine};
use linearise::{Passes, linearise_colored, linearise_in, mark_dependences};
use num_dual::{Dual2_64, Dual64};
use std::iter::repeat_n;

/// The collocation method with `m` Gauss points in each interval, `m` from 2 to 7.
///
/// ```
/// use tangency::core::bvp::{Collocation, Method};
/// let collocation = Collocation::new(4)?;
/// assert_eq!(collocation.places()[2], 0.5);
/// assert!(Collocation::new(9).is_err());
/// # Ok::<(), tangency::core::bvp::PointsError>(())
/// ```
#[derive(Clone, Debug)]
pub struct Collocation {
    pub(super) cancel: CancelToken,
    /// The kind of matrices with which periodic orbits are computed.
    pub(super) matrices: Matrices,
    basis: Basis,
    narrow: Passes<4>,
    wide: Passes<8>,
}

/// The error that reports a number of Gauss points outside the range from 2 to 7.
#[derive(Clone, Copy, Debug, PartialEq, Eq, miette::Diagnostic, thiserror::Error)]
#[error(
    "the number of Gauss points per mesh interval is {0}, but collocation needs a number between 2 \
     and 7"
)]
pub struct PointsError(pub usize);

/// The largest number of Gauss points in an interval: for more accuracy, smaller intervals are
/// better than a higher degree.
const MOST_POINTS: usize = 7;

impl Collocation {
    /// Creates the collocation method with `points` Gauss points in each interval.
    ///
    /// # Errors
    /// [`PointsError`] unless the number of Gauss points is between 2 and 7.
    pub fn new(points: usize) -> Result<Self, PointsError> {
        if !(2..=MOST_POINTS).contains(&points) {
            return Err(PointsError(points));
        }
        Ok(Collocation {
            cancel: CancelToken::default(),
            matrices: Matrices::Cheaper,
            basis: Basis::new(points),
            narrow: Passes::default(),
            wide: Passes::default(),
        })
    }

    /// Chooses the kind of matrices with which periodic orbits of vector fields are computed; by
    /// default, the cheaper kind is used. Other boundary-value problems use dense matrices, and
    /// refuse sparse ones when they are assembled.
    ///
    /// ```
    /// use tangency::core::bvp::Collocation;
    /// use tangency::core::orbit::periodic_orbits;
    /// use tangency::core::system::{Matrices, System};
    /// use tangency::problems::classic::Lure;
    /// let collocation = Collocation::new(4)?.with_matrices(Matrices::Sparse);
    /// let orbits = periodic_orbits(Lure, 20, collocation)?;
    /// assert_eq!(orbits.representation().method, "collocation(4)");
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn with_matrices(self, matrices: Matrices) -> Self {
        Collocation { matrices, ..self }
    }

    /// The number `m` of Gauss points in each interval.
    pub fn points(&self) -> usize {
        self.basis.gauss.len()
    }
}

/// Buffers of [`Collocation`] for evaluations in one scalar type.
#[derive(Clone, Debug)]
pub struct CollocationWork<T> {
    x: Vec<T>,
    f: Vec<T>,
    real: Vec<f64>,
}

impl<T> Default for CollocationWork<T> {
    fn default() -> Self {
        CollocationWork { x: Vec::new(), f: Vec::new(), real: Vec::new() }
    }
}

/// The largest number of iterations in the search for a position.
const ROUNDS: usize = 60;

/// Rounding: the last change of the position of an upward crossing, as a fraction of the interval.
const EXACT: f64 = 1e-14;

/// Rounding: the last change of the position of an extremum, as a fraction of the interval. Newton's
/// method converges quadratically, and an error of the position changes the value of the function only
/// by its square. On a fine mesh, rounding errors of the derivative leave no further digits.
const SETTLED: f64 = 1e-9;

/// Rounding: if a function changes between two samples by less than this, in units of its scale, the
/// vertex of a parabola is the extremum up to rounding errors. During sliding, some functions consist
/// of rounding errors only, and have an extremum between almost any two samples.
const FLAT: f64 = 1e-14;

impl Collocation {
    /// Visits the ends of a mesh interval, and the times in the interval at which a function of the
    /// state has a local extremum; the extrema are located by sign changes of the derivative
    /// between samples. A function that appears [monotone](Self::is_monotone) is not sampled further.
    fn extrema_of(
        &self,
        interval: &Interval<f64>,
        (k, observable, scale): (usize, Observable, f64),
        visit: &mut dyn FnMut(usize, f64, f64),
    ) {
        let (basis, last) = (&self.basis, self.basis.sampled_places().count() - 1);
        let mut samples = Sight::<Dual64>::new(interval, observable);
        let mut sampled =
            |c: usize, place: f64| samples.at(Dual64::new(place, 1.0), basis.sampled_weights(c));
        let [start, middle, end] =
            [(0, 0.0), (last / 2, 0.5), (last, 1.0)].map(|(c, place)| sampled(c, place));
        visit(k, 0.0, start.re);
        if !self.is_monotone(interval, observable, [start, middle, end]) {
            let mut left = (0.0, start);
            for (c, place) in basis.sampled_places().enumerate().skip(1) {
                let right = (place, sampled(c, place));
                if left.1.eps * right.1.eps < 0.0 {
                    let flat = FLAT * scale;
                    let found = vertex([left, right], flat)
                        .unwrap_or_else(|| stationary(interval, observable, basis, [left, right]));
                    visit(k, found.0, found.1);
                }
                left = right;
            }
        }
        visit(k, 1.0, end.re);
    }

    /// Whether a function appears monotone on an interval: its derivatives at the ends and in the
    /// middle have the sign of its change, and the polynomial through its values at the nodes has no
    /// extremum.
    fn is_monotone(
        &self,
        interval: &Interval<f64>,
        observable: Observable,
        samples: [Dual64; 3],
    ) -> bool {
        let (basis, nodes) = (&self.basis, interval.nodes);
        let rise = samples[2].re - samples[0].re;
        if !samples.iter().all(|sample| sample.eps * rise > 0.0) {
            return false;
        }
        let (function, n) = (interval.watching(observable), nodes.len() / basis.nodes.len());
        let mut values = [0.0; MOST_POINTS + 1];
        for ((value, place), x) in values.iter_mut().zip(&basis.nodes).zip(nodes.chunks_exact(n)) {
            *value = function.value_in(interval.time(*place), x, interval.q);
        }
        let mut monotone = true;
        basis.stationary(|j| values[j], |_| monotone = false);
        monotone
    }
}

/// Returns the vertex of the parabola with the derivatives of two samples, and the value there; `None`
/// if the function may change between the samples by more than `flat`.
fn vertex([left, right]: [(f64, Dual64); 2], flat: f64) -> Option<(f64, f64)> {
    let (width, slopes) = (right.0 - left.0, [left.1.eps, right.1.eps]);
    let along = width * slopes[0] / (slopes[0] - slopes[1]);
    let is_flat = width * slopes[0].abs().max(slopes[1].abs()) <= flat;
    is_flat.then(|| (left.0 + along, left.1.re + 0.5 * slopes[0] * along))
}

/// Returns the place between two samples at which the derivative of a function vanishes, and the value
/// of the function there.
fn stationary(
    interval: &Interval<f64>,
    observable: Observable,
    basis: &Basis,
    [left, right]: [(f64, Dual64); 2],
) -> (f64, f64) {
    let mut sight = Sight::<Dual2_64>::new(interval, observable);
    let mut at = |place: f64| {
        let place = Dual2_64::new(place, 1.0, 0.0);
        sight.at(place, basis.weights_at(place))
    };
    let place = zero([left.0, right.0], left.1.eps, SETTLED, |place| {
        let slope = at(place);
        [slope.v1, slope.v2]
    });
    (place, at(place).re)
}

/// A scalar function of the interpolating polynomials of an interval.
struct Sight<'i, T> {
    interval: &'i Interval<'i, f64>,
    observable: Observable,
    q: Vec<T>,
    x: Vec<T>,
}

impl<'i, T: WatchNumber> Sight<'i, T> {
    fn new(interval: &'i Interval<'i, f64>, observable: Observable) -> Self {
        let q = interval.q.iter().map(|q| T::from(*q)).collect();
        Sight { interval, observable, q, x: Vec::new() }
    }

    /// Evaluates the function at a place, given the weights of the nodes at this place. Derivatives
    /// of the place give derivatives of the function.
    fn at(&mut self, place: T, weights: impl ExactSizeIterator<Item = T>) -> T {
        let interval = self.interval;
        let n = interval.nodes.len() / weights.len();
        refill(&mut self.x, repeat_n(T::zero(), n));
        for (weight, values) in weights.zip(interval.nodes.chunks_exact(n)) {
            self.x.iter_mut().zip(values).for_each(|(x, value)| *x += weight * *value);
        }
        let t = (place * interval.length() + interval.span.start) * interval.duration();
        interval.watching(self.observable).value_in(t, &self.x, &self.q)
    }
}

/// Finds the zero of a function between two points of an interval, given the sign of the function
/// at the first point. The search ends with a step shorter than `moved`.
fn zero(places: [f64; 2], sign: f64, moved: f64, of: impl FnMut(f64) -> [f64; 2]) -> f64 {
    let limits = Limits { rounds: ROUNDS, moved };
    bracketed_zero(places, sign, 0.5 * (places[0] + places[1]), limits, of)
}

/// Implements the methods of [`Method`](super::method::Method) for collocation;
/// [`Method`](super::method::Method) documents them.
impl Collocation {
    /// Returns the positions of the nodes in an interval, from 0 to 1.
    pub fn places(&self) -> &[f64] {
        &self.basis.nodes
    }

    /// Computes the residual of the collocation equations on an interval.
    ///
    /// # Errors
    /// [`Failure::OutOfDomain`] if the trajectory leaves the domain of the field.
    pub fn residual<T: Number>(
        &self,
        interval: Interval<T>,
        work: &mut CollocationWork<T>,
        r: &mut [T],
    ) -> Result<(), Failure> {
        let Interval { span, nodes, q, .. } = interval;
        let field = interval.field();
        let n = nodes.len() / self.basis.nodes.len();
        let (duration, h) = (interval.duration(), interval.length());
        work.x.resize(n, T::zero());
        work.f.resize(n, T::zero());
        refill(&mut work.real, q.iter().map(Scalar::real));
        work.real.resize(q.len() + n, 0.0);
        let (real_q, real_x) = work.real.split_at_mut(q.len());
        for (c, r) in r.chunks_exact_mut(n).enumerate() {
            combine(self.basis.row(&self.basis.values, c), nodes, &mut work.x);
            real_x.iter_mut().zip(&work.x).for_each(|(real, x)| *real = x.real());
            let t = duration * (span.start + h * self.basis.gauss[c]);
            field.domain(real_x, real_q).map_err(|cause| placed(cause, span.segment, t.real()))?;
            field.slope(t, &work.x, q, &mut work.f);
            combine(self.basis.row(&self.basis.slopes, c), nodes, r);
            let step = duration * h;
            r.iter_mut().zip(&work.f).for_each(|(r, f)| *r -= step * *f);
        }
        Ok(())
    }

    /// Returns the weights of the nodes in the arguments of the vector field, which are the states
    /// at the Gauss points.
    pub(super) fn arguments(&self) -> &[f64] {
        &self.basis.values
    }

    /// Returns the weights of the nodes in the derivatives of the interpolating polynomials at the
    /// Gauss points.
    pub(super) fn slopes(&self) -> &[f64] {
        &self.basis.slopes
    }

    /// Computes `−h L wᵀf` at a Gauss point, plus the contribution of this Gauss point to the
    /// integral conditions.
    pub(super) fn nonlinear<T: Number>(
        &self,
        interval: Interval<T>,
        c: usize,
        [weights, closing]: [&[f64]; 2],
        r: &mut [T],
    ) -> Result<T, Failure> {
        let Interval { problem, span, nodes, q } = interval;
        let (x, f) = (&nodes[..weights.len()], &mut r[..weights.len()]);
        let (duration, h) = (interval.duration(), interval.length());
        let t = duration * (span.start + h * self.basis.gauss[c]);
        interval.field().slope(t, x, q, f);
        let mut sum = -weighted(f, weights);
        if !closing.is_empty() {
            let g = &mut r[..closing.len()];
            g.fill(T::zero());
            T::residual(problem).integrand_in(span.segment, t, x, q, g);
            sum += weighted(g, closing) * self.basis.weights[c];
        }
        Ok(sum * duration * h)
    }

    /// Computes the states at a point of an interval, given by its position from 0 to 1.
    pub fn value<T: Number>(&self, interval: Interval<T>, place: f64, x: &mut [T]) {
        let count = self.basis.nodes.len();
        let mut coefficients = [0.0; MOST_POINTS + 1];
        for (j, coefficient) in coefficients[..count].iter_mut().enumerate() {
            *coefficient = lagrange(&self.basis.nodes, j, place);
        }
        combine(&coefficients[..count], interval.nodes, x);
    }

    pub(super) fn linearise(
        &mut self,
        interval: Interval<f64>,
        active: &[usize],
        block: Block,
    ) -> Result<(), Failure> {
        let n = interval.nodes.len() / self.basis.nodes.len();
        let Collocation { basis, narrow, wide, .. } = self;
        in_fours(
            #[inline(always)]
            || match n + active.len() {
                ..=4 => linearise_in(basis, narrow, interval, active, block),
                _ => linearise_in(basis, wide, interval, active, block),
            },
        )
    }

    /// Marks, for each component of the vector field, the states of a chunk on which the component
    /// depends at a Gauss point of an interval; the chunk begins at state `start`.
    pub(super) fn mark_dependences(
        &mut self,
        interval: Interval<f64>,
        start: usize,
        seen: &mut [[bool; CHUNK]],
    ) -> Result<(), Failure> {
        mark_dependences(&self.basis, &mut self.wide, interval, start, seen)
    }

    /// Computes the residual and the derivatives of an interval whose vector field has a sparse
    /// Jacobian; `block.nodes` receives, for each Gauss point, the entries of `h L f_x`. Returns
    /// whether the Jacobian agrees with its pattern.
    pub(super) fn linearise_colored(
        &mut self,
        interval: Interval<f64>,
        of: (&[usize], &ColoredField),
        block: Block,
    ) -> Result<bool, Failure> {
        linearise_colored(&self.basis, &mut self.wide, interval, of, block)
    }

    /// Visits the monitored functions in an interval: calls `visit` with the function's number, a
    /// position from 0 to 1, and the function's value.
    pub fn extrema(
        &self,
        interval: Interval<f64>,
        watched: MonitoredFunctions,
        visit: &mut dyn FnMut(usize, f64, f64),
    ) {
        let (basis, nodes) = (&self.basis, interval.nodes);
        let (m, n) = (basis.gauss.len(), nodes.len() / basis.nodes.len());
        for (k, &observable) in watched.extrema.iter().enumerate() {
            let Observable::State(state) = observable else {
                let scale = watched.scales.get(k).copied().unwrap_or(1.0);
                self.extrema_of(&interval, (k, observable, scale), visit);
                continue;
            };
            let at = |j: usize| nodes[j * n + state];
            visit(k, 0.0, at(0));
            basis.stationary(at, |s| {
                visit(k, s, (0..=m).map(|j| lagrange(&basis.nodes, j, s) * at(j)).sum());
            });
            visit(k, 1.0, at(m));
        }
        for (k, &[through, value]) in (watched.extrema.len()..).zip(watched.rises) {
            let value_of = |observable, place: f64| {
                Sight::<f64>::new(&interval, observable).at(place, basis.weights_at(place))
            };
            if value_of(through, 0.0) <= 0.0 && value_of(through, 1.0) > 0.0 {
                let mut sight = Sight::<Dual64>::new(&interval, through);
                let place = zero([0.0, 1.0], -1.0, EXACT, |place| {
                    let place = Dual64::new(place, 1.0);
                    let height = sight.at(place, basis.weights_at(place));
                    [height.re, height.eps]
                });
                visit(k, place, value_of(value, place));
            }
        }
    }

    /// Visits the Gauss points for a quadrature that is as accurate as the states at the ends of
    /// intervals.
    pub(super) fn quadrature<T: Number>(
        &self,
        interval: Interval<T>,
        work: &mut CollocationWork<T>,
        visit: &mut dyn FnMut(T, T, &[T]),
    ) {
        let (duration, h) = (interval.duration(), interval.length());
        work.x.resize(interval.nodes.len() / self.basis.nodes.len(), T::zero());
        for (c, (place, weight)) in self.basis.gauss.iter().zip(&self.basis.weights).enumerate() {
            combine(self.basis.row(&self.basis.values, c), interval.nodes, &mut work.x);
            visit(duration * (h * weight), duration * (interval.span.start + h * place), &work.x);
        }
    }

    /// Returns the integrals over time, on one interval, of the trace of the vector field's
    /// Jacobian and of the trace's absolute value, computed from the assembled equations. At each
    /// Gauss point, the trace is computed from the derivatives with respect to the states at one
    /// node; the most accurate choice is the node with the largest coefficient.
    pub(super) fn trace_integrals(&self, block: &[f64], n: usize) -> [f64; 2] {
        let places = self.basis.nodes.len();
        let mut integrals = [0.0; 2];
        for (c, weight) in self.basis.weights.iter().enumerate() {
            let values = self.basis.row(&self.basis.values, c);
            let slopes = self.basis.row(&self.basis.slopes, c);
            let best = (0..places).max_by(|a, b| values[*a].abs().total_cmp(&values[*b].abs()));
            let node = best.unwrap_or(0);
            let entry = |i: usize| block[(c * n + i) * n * places + node * n + i];
            let sum: f64 = (0..n).map(|i| slopes[node] - entry(i)).sum();
            let trace = weight * sum / values[node];
            integrals[0] += trace;
            integrals[1] += trace.abs();
        }
        integrals
    }

    /// Returns the error constant of collocation: the largest value of `|P|`.
    pub fn error_constant(&self) -> f64 {
        self.basis.error_constant
    }

    /// Returns collocation with the largest number of Gauss points, and the factor 2: the number of
    /// parts into which each interval is divided.
    pub(crate) fn finer(&self) -> (Self, usize) {
        (Collocation { basis: Basis::new(MOST_POINTS), ..self.clone() }, 2)
    }
}

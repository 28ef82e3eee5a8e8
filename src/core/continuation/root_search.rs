//! Search for all solutions in a box at given parameters, by Newton's method with deflation.
//!
//! Known solutions `z_k` of `F(z) = 0` are removed by deflation: Newton's method is applied to
//! `m(z) F(z)` with `m = Π (1 + 1/‖z − z_k‖²)`, whose zeros are only the solutions that are not yet
//! known (P. E. Farrell, Á. Birkisson & S. W. Funke, SIAM J. Sci. Comput. 37 (2015) A2026). With `d
//! = F_z⁻¹ F` and `g = ∇ ln m`, the deflated Newton step is `−d / (1 + gᵀd)`: deflation changes
//! only the length and the sign of the Newton step. The starting points are the points of a
//! sequence that fills the box evenly.

use super::admissible;
use crate::core::bifurcation::Stability;
use crate::core::cancel::CancelToken;
use crate::core::failure::Failure;
use crate::core::linalg::{Border, Factors, Form, Spectrum, SpectrumRequest};
use crate::core::problem::Dynamics;
use crate::core::system::System;

/// A search for all solutions with components in a box. The search may miss solutions: a search
/// with 100 starts for the 27 zeros of three coupled cubics occasionally misses one zero, and a
/// search with 900 starts missed no zero in 600 runs (`tests/continuation/root_search.rs`).
///
/// ```
/// use tangency::core::continuation::RootSearch;
/// use tangency::prelude::*;
/// vector_field! {
///     /// `x' = p x − x³`: at p = 4 the equilibria −2, 0 and 2.
///     struct Pitchfork [x; p] { d/dt x = p * x - x * x * x; }
/// }
/// let mut system = Dense::new(Equilibria::new(Pitchfork));
/// let found = RootSearch::default().find(&mut system, &[4.0], &[[-3.0, 3.0]])?;
/// let values: Vec<f64> = found.roots.iter().map(|root| root.unknowns[0]).collect();
/// assert!(values.iter().zip([-2.0, 0.0, 2.0]).all(|(x, exact)| (x - exact).abs() < 1e-12));
/// assert_eq!(found.roots.iter().map(|root| root.unstable).collect::<Vec<_>>(), [Some(0), Some(1), Some(0)]);
/// # Ok::<(), tangency::core::failure::Failure>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct RootSearch {
    /// The number of starting points of Newton's method.
    pub starts: usize,
    /// The correction, relative to the size of the box, below which Newton's method has converged.
    pub tolerance: f64,
    /// The maximal number of Newton corrections from one starting point.
    pub max_iterations: usize,
    /// The token that cancels the search; a cancelled search returns the solutions found so far.
    pub cancel: CancelToken,
}

impl Default for RootSearch {
    fn default() -> Self {
        let cancel = CancelToken::default();
        RootSearch { starts: 100, tolerance: 1e-12, max_iterations: 60, cancel }
    }
}

/// The result of a search for solutions in a box.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Roots {
    /// The solutions in the box, sorted by their first component, then by the second, and so on.
    pub roots: Vec<Root>,
    /// The number of starting points of Newton's method.
    pub starts: usize,
    /// The number of attempts that ended without a new solution, because Newton's method did not
    /// converge, went far out of the box, or reached a point where the equations cannot be
    /// evaluated.
    pub lost: usize,
    /// The number of solutions found outside the box.
    pub outside: usize,
    /// The number of solutions in the box that are not admissible, such as equilibria of a mode at
    /// states outside the region of the mode.
    pub inadmissible: usize,
}

/// A solution with its stability.
#[derive(Clone, Debug, PartialEq)]
pub struct Root {
    /// The components `z` of the solution.
    pub unknowns: Vec<f64>,
    /// The leading eigenvalues or multipliers; empty if the equations describe no motion.
    pub eigenvalues: Spectrum,
    /// The number of unstable eigenvalues or multipliers.
    pub unstable: Option<usize>,
}

/// Heuristic: two solutions count as equal if their distance is smaller than this fraction of the
/// size of the box.
const SAME: f64 = 1e-7;

/// Heuristic: the largest Newton step, as a fraction of the size of the box.
const LONGEST_STEP: f64 = 0.5;

/// Heuristic: the distance from the middle of the box, in units of its size, beyond which Newton's
/// method is stopped.
const FAR: f64 = 3.0;

/// Heuristic: the number of final Newton corrections without deflation.
const POLISHED: usize = 3;

impl RootSearch {
    /// Finds solutions at the parameters `p` with components in a box, which is given by an
    /// interval for each unknown. From each starting point, Newton's method is repeated until it
    /// finds no further solution.
    ///
    /// # Errors
    /// [`Failure::Mismatch`] if the number of intervals differs from the number of unknowns, or if
    /// an interval is empty or not finite; [`Failure`] if the eigenvalues of a solution cannot be
    /// computed.
    pub fn find(
        &self,
        system: &mut dyn System,
        p: &[f64],
        within: &[[f64; 2]],
    ) -> Result<Roots, Failure> {
        let n = system.names().dimension();
        let sound = |[low, high]: &[f64; 2]| low < high && (high - low).is_finite();
        if within.len() != n || !within.iter().all(sound) {
            let what = format!("a box of {} intervals for {n} unknowns", within.len());
            return Err(Failure::Mismatch(
                what + "; the box must have one interval for each unknown, with finite ends and \
                        the lower end first",
            ));
        }
        let mut newton = Deflated::new(system, p, within);
        let mut found = Roots { starts: self.starts, ..Roots::default() };
        for start in 0..self.starts {
            let mut first = true;
            loop {
                if self.cancel.is_cancelled() {
                    found.starts = start;
                    break;
                }
                let Some(root) = newton.solve(&point_of(start, within), self) else {
                    found.lost += usize::from(first);
                    break;
                };
                first = false;
                newton.known.push(root);
            }
        }
        let inside = |root: &Vec<f64>| {
            let near = |(z, [low, high]): (&f64, &[f64; 2])| {
                let margin = SAME * (high - low);
                (low - margin..=high + margin).contains(z)
            };
            root.iter().zip(within).all(near)
        };
        let (mut roots, outside): (Vec<_>, Vec<_>) =
            std::mem::take(&mut newton.known).into_iter().partition(inside);
        found.outside = outside.len();
        roots.sort_by(|a, b| in_order(a, b, within));
        for unknowns in roots {
            if newton.is_admissible(&unknowns) {
                found.roots.push(newton.root(unknowns)?);
            } else {
                found.inadmissible += 1;
            }
        }
        Ok(found)
    }

    /// Computes the solution at the parameters `p` to which Newton's method converges from a
    /// starting point; `None` if Newton's method does not converge. `sizes` contains typical sizes
    /// of the unknowns.
    ///
    /// ```
    /// use tangency::prelude::*;
    /// use tangency::core::continuation::RootSearch;
    /// zero_problem! {
    ///     struct Square [x; p] { 0 = x * x - p; }
    /// }
    /// let near = RootSearch::default().near(&mut Dense::new(Square), &[4.0], &[1.7], &[1.0]);
    /// assert!((near.expect("a solution")[0] - 2.0).abs() < 1e-12);
    /// ```
    pub fn near(
        &self,
        system: &mut dyn System,
        p: &[f64],
        start: &[f64],
        sizes: &[f64],
    ) -> Option<Vec<f64>> {
        let around = start.iter().zip(sizes).map(|(z, size)| [z - 0.5 * size, z + 0.5 * size]);
        let around: Vec<[f64; 2]> = around.collect();
        Deflated::new(system, p, &around).solve(start, self)
    }
}

/// Compares two solutions by the first component in which they differ.
fn in_order(a: &[f64], b: &[f64], within: &[[f64; 2]]) -> std::cmp::Ordering {
    let mut pairs = a.iter().zip(b).zip(within);
    let differ =
        |((a, b), [low, high]): &((&f64, &f64), &[f64; 2])| (*a - *b).abs() > SAME * (high - low);
    pairs.find(differ).map_or(std::cmp::Ordering::Equal, |((a, b), _)| a.total_cmp(b))
}

/// Returns the starting point with a given number in the sequence of starting points. The first
/// starting point is the middle of the box. The following starting points belong to the additive
/// sequence `k α` modulo 1 with `α_j = φ^{−j}` and `φ^{n+1} = φ + 1`, which fills a box of any
/// dimension evenly.
fn point_of(number: usize, within: &[[f64; 2]]) -> Vec<f64> {
    let n = within.len();
    let mut phi = 2.0_f64;
    for _ in 0..60 {
        phi = (1.0 + phi).powf(1.0 / (n as f64 + 1.0));
    }
    let place = |(j, [low, high]): (usize, &[f64; 2])| {
        let part = (0.5 + number as f64 * phi.powi(-(j as i32 + 1))).fract();
        low + part * (high - low)
    };
    within.iter().enumerate().map(place).collect()
}

/// Newton's method with deflation of known solutions.
struct Deflated<'a> {
    system: &'a mut dyn System,
    /// The lengths of the sides of the box.
    sizes: Vec<f64>,
    /// The middle of the box.
    middle: Vec<f64>,
    /// The current point `(z, p)`.
    x: Vec<f64>,
    /// A buffer for the residual `F`, which is overwritten by `F_z⁻¹ F`.
    correction: Vec<f64>,
    factors: Factors,
    known: Vec<Vec<f64>>,
}

impl<'a> Deflated<'a> {
    fn new(system: &'a mut dyn System, p: &[f64], within: &[[f64; 2]]) -> Self {
        let sizes = within.iter().map(|[low, high]| high - low).collect();
        let middle: Vec<f64> = within.iter().map(|[low, high]| low + 0.5 * (high - low)).collect();
        let (x, correction) = ([&middle[..], p].concat(), vec![0.0; within.len()]);
        let (factors, known) = (Factors::default(), Vec::new());
        Deflated { system, sizes, middle, x, correction, factors, known }
    }

    /// Returns the solution to which the deflated Newton's method converges from a starting point,
    /// if the solution is new.
    fn solve(&mut self, start: &[f64], search: &RootSearch) -> Option<Vec<f64>> {
        let n = start.len();
        self.x[..n].copy_from_slice(start);
        for _ in 0..search.max_iterations {
            let length = self.correct().ok()?;
            // Near a known solution the deflated step leads away from it.
            let factor = 1.0 + self.repulsion();
            let longest = LONGEST_STEP / (length / factor.abs()).max(LONGEST_STEP);
            let way = longest / factor;
            if !way.is_finite() {
                return None;
            }
            self.x[..n].iter_mut().zip(&self.correction).for_each(|(z, d)| *z -= way * d);
            let out = self.x[..n].iter().zip(&self.middle).zip(&self.sizes);
            if out.into_iter().any(|((z, middle), size)| (z - middle).abs() > FAR * size) {
                return None;
            }
            if length < search.tolerance.sqrt() && self.nearest() > SAME {
                let before = self.x.clone();
                if let Some(root) = self.polished(search) {
                    return Some(root);
                }
                self.x = before;
            }
        }
        None
    }

    /// Returns the solution to which Newton's method converges without deflation, if the solution
    /// is new.
    fn polished(&mut self, search: &RootSearch) -> Option<Vec<f64>> {
        let n = self.correction.len();
        for _ in 0..POLISHED {
            let length = self.correct().ok()?;
            self.x[..n].iter_mut().zip(&self.correction).for_each(|(z, d)| *z -= d);
            if length < search.tolerance && self.nearest() > SAME {
                return Some(self.x[..n].to_vec());
            }
        }
        None
    }

    /// Computes `F_z⁻¹ F`, and returns its length in units of the size of the box.
    fn correct(&mut self) -> Result<f64, Failure> {
        let Deflated { system, x, correction, factors, sizes, .. } = self;
        system.residual(x, correction)?;
        system.assemble(x)?;
        system.factor(Form::Jacobian, Border::NONE, factors)?;
        factors.solve(correction);
        Ok(correction.iter().zip(sizes).map(|(d, size)| (d / *size).abs()).fold(0.0, f64::max))
    }

    /// Returns the squared distance of the current point from a known solution, in units of the
    /// size of the box.
    fn distance(&self, known: &[f64]) -> f64 {
        let parts = self.x.iter().zip(known).zip(&self.sizes);
        parts.map(|((z, known), size)| ((z - known) / size).powi(2)).sum()
    }

    /// Returns the distance of the current point from the nearest known solution, in units of the
    /// size of the box.
    fn nearest(&self) -> f64 {
        let all = self.known.iter().map(|known| self.distance(known));
        all.fold(f64::INFINITY, f64::min).sqrt()
    }

    /// Returns the product `gᵀ d` with `g = ∇ ln Π (1 + 1/‖z − z_k‖²)`.
    fn repulsion(&self) -> f64 {
        let of = |known: &Vec<f64>| {
            let squared = self.distance(known);
            let parts = self.x.iter().zip(known).zip(&self.sizes).zip(&self.correction);
            let along: f64 =
                parts.map(|(((z, known), size), d)| (z - known) / (size * size) * d).sum();
            -2.0 * along / (squared * (1.0 + squared))
        };
        self.known.iter().map(of).sum()
    }

    /// Whether a solution is admissible, as far as the monitors can be evaluated.
    fn is_admissible(&mut self, unknowns: &[f64]) -> bool {
        self.x[..unknowns.len()].copy_from_slice(unknowns);
        let mut monitors = vec![0.0; self.system.names().monitors.len()];
        if self.system.monitors(&self.x, 0, &mut monitors).is_err() {
            return true;
        }
        admissible::is_within(self.system, &self.x[unknowns.len()..], &monitors)
            && admissible::check(self.system, &self.x, &monitors).is_ok()
    }

    /// Computes the eigenvalues or multipliers of a solution.
    fn root(&mut self, unknowns: Vec<f64>) -> Result<Root, Failure> {
        self.x[..unknowns.len()].copy_from_slice(&unknowns);
        let dynamics = self.system.dynamics();
        self.system.assemble(&self.x)?;
        let spectrum = self.system.spectrum(&self.x, SpectrumRequest::new(unknowns.len()))?;
        let unstable = (dynamics != Dynamics::None)
            .then(|| spectrum.as_ref().map(|it| Stability::of(dynamics, it).unstable))
            .flatten();
        Ok(Root { unknowns, eigenvalues: spectrum.unwrap_or_default(), unstable })
    }
}

//! Sum factorisation of tensor products: evaluates fields `Σ_ij c_ij f_i(ξ) g_j(ζ)` at the nodes of
//! a tensor-product rule, and integrals of fields times products `f_i g_j`, by summing over one
//! variable after another. For `n` functions and `m` nodes per direction, such an evaluation takes
//! `n²m + nm²` multiplications instead of `n²m²`.
//!
//! The coefficient `(i, j)` is at position `i·n_y + j`, the value of a field at node `(p, q)` at
//! position `p·m_y + q`; tables have the order of [`Table`](super::basis::Table).

use crate::core::numerics::gauss_legendre;
use crate::core::scalar::{Scalar, with_avx2};

/// The nodes and weights of a quadrature rule along one direction. The weights give the mean over
/// the whole plate (`Σ w f = ½∫₋₁¹ f dξ`), even if symmetry restricts the nodes to `ξ ≥ 0`.
#[derive(Clone, Debug)]
pub struct Rule {
    /// Nodes.
    pub nodes: Vec<f64>,
    /// The weights; their sum is 1.
    pub weights: Vec<f64>,
}

impl Rule {
    /// Creates a quadrature rule that is exact for all polynomials up to degree `degree`, or, if
    /// `symmetric`, only for the even ones.
    pub fn exact(degree: usize, symmetric: bool) -> Rule {
        let count = degree / 2 + 1;
        let (nodes, weights) =
            gauss_legendre(if symmetric { 2 * count.div_ceil(2) } else { count });
        let skipped = if symmetric { nodes.len() / 2 } else { 0 };
        let share = if symmetric { 1.0 } else { 0.5 };
        Rule {
            nodes: nodes[skipped..].to_vec(),
            weights: weights[skipped..].iter().map(|w| share * w).collect(),
        }
    }

    /// Creates a quadrature rule for functions that vary most in the middle of the interval, with
    /// `count` nodes on each half of the interval; if `symmetric`, the rule covers only the half
    /// `[0, 1]`.
    pub fn halves(count: usize, symmetric: bool) -> Rule {
        let (nodes, weights) = gauss_legendre(count);
        let right: Vec<f64> = nodes.iter().map(|t| 0.5 + 0.5 * t).collect();
        if symmetric {
            return Rule { nodes: right, weights: weights.iter().map(|w| 0.5 * w).collect() };
        }
        let left = right.iter().rev().map(|x| -x);
        Rule {
            nodes: left.chain(right.iter().copied()).collect(),
            weights: weights.iter().chain(&weights).map(|w| 0.25 * w).collect(),
        }
    }

    /// Returns the number of nodes of the rule.
    pub fn len(&self) -> usize {
        self.nodes.len()
    }

    /// Returns whether the rule contains no nodes.
    pub fn is_empty(&self) -> bool {
        self.nodes.is_empty()
    }
}

/// Returns the quadrature weights of the mean over the plate at the nodes of the tensor product of
/// two rules, node by node.
pub fn weights([x, y]: &[Rule; 2]) -> impl Iterator<Item = f64> {
    x.weights.iter().flat_map(|wx| y.weights.iter().map(move |wy| wx * wy))
}

/// Functions of two variables at the nodes of a tensor-product quadrature rule: a table for `ξ` and
/// a table for `ζ`.
#[derive(Clone, Copy, Debug)]
pub struct Product<'a> {
    /// The functions of `ξ` (values or slopes) at the nodes.
    pub x: &'a [f64],
    /// The functions of `ζ` (values or slopes) at the nodes.
    pub y: &'a [f64],
    /// The numbers of nodes along ξ and ζ.
    pub points: [usize; 2],
}

impl Product<'_> {
    fn counts(&self) -> [usize; 2] {
        [self.x.len() / self.points[0].max(1), self.y.len() / self.points[1].max(1)]
    }

    /// Evaluates the field with the coefficients `c` at the nodes, and writes the values into
    /// `field`; `half` is a workspace.
    pub fn expand<T: Scalar>(&self, c: &[T], half: &mut Vec<T>, field: &mut [T]) {
        with_avx2(
            #[inline(always)]
            || self.expand_rows(c, half, field),
        );
    }

    #[inline(always)]
    fn expand_rows<T: Scalar>(&self, c: &[T], half: &mut Vec<T>, field: &mut [T]) {
        let ([nx, ny], [px, py]) = (self.counts(), self.points);
        half.clear();
        half.resize(nx * py, T::zero());
        for (row, c) in half.chunks_exact_mut(py).zip(c.chunks_exact(ny.max(1))) {
            for (c, y) in c.iter().zip(self.y.chunks_exact(py)) {
                add_multiple(row, *c, y);
            }
        }
        field.fill(T::zero());
        for (row, x) in half.chunks_exact(py).zip(self.x.chunks_exact(px)) {
            for (out, x) in field.chunks_exact_mut(py).zip(x) {
                add_scaled(out, row, *x);
            }
        }
    }

    /// Adds to each coefficient in `c` the sum over the nodes of `field` times the corresponding
    /// product of functions; the values in `field` include the quadrature weights.
    pub fn project<T: Scalar>(&self, field: &[T], half: &mut Vec<T>, c: &mut [T]) {
        with_avx2(
            #[inline(always)]
            || self.project_rows(field, half, c),
        );
    }

    #[inline(always)]
    fn project_rows<T: Scalar>(&self, field: &[T], half: &mut Vec<T>, c: &mut [T]) {
        let ([nx, ny], [px, py]) = (self.counts(), self.points);
        half.clear();
        half.resize(nx * py, T::zero());
        for (row, x) in half.chunks_exact_mut(py).zip(self.x.chunks_exact(px)) {
            for (field, x) in field.chunks_exact(py).zip(x) {
                add_scaled(row, field, *x);
            }
        }
        for (row, c) in half.chunks_exact(py).zip(c.chunks_exact_mut(ny.max(1))) {
            for (c, y) in c.iter_mut().zip(self.y.chunks_exact(py)) {
                *c += dot(row, y);
            }
        }
    }
}

#[inline(always)]
fn add_multiple<T: Scalar>(out: &mut [T], factor: T, values: &[f64]) {
    for (out, value) in out.iter_mut().zip(values) {
        *out += factor * *value;
    }
}

#[inline(always)]
fn add_scaled<T: Scalar>(out: &mut [T], values: &[T], factor: f64) {
    for (out, value) in out.iter_mut().zip(values) {
        *out += *value * factor;
    }
}

/// Computes the scalar product `Σ aᵢ bᵢ` in four independent partial sums, so that an addition need
/// not wait for the result of the previous addition.
#[inline(always)]
pub fn dot<T: Scalar>(a: &[T], b: &[f64]) -> T {
    let mut sums = [T::zero(); 4];
    let (whole, whole_b) = (a.chunks_exact(4), b.chunks_exact(4));
    let rest = whole.remainder().iter().zip(whole_b.remainder());
    let mut tail = T::zero();
    for (a, b) in rest {
        tail += *a * *b;
    }
    for (a, b) in whole.zip(whole_b) {
        for k in 0..4 {
            sums[k] += a[k] * b[k];
        }
    }
    (sums[0] + sums[1]) + (sums[2] + sums[3]) + tail
}

/// Returns the means `⟨a_i b_k⟩` for all functions of two tables at the nodes of `rule`: the pair
/// `(i, k)` is at position `i·n_b + k`.
pub fn moments(rule: &Rule, a: &[f64], b: &[f64]) -> Vec<f64> {
    let points = rule.len();
    let mut matrix = Vec::with_capacity(a.len() / points * (b.len() / points));
    for a in a.chunks_exact(points) {
        for b in b.chunks_exact(points) {
            matrix.push(a.iter().zip(b).zip(&rule.weights).map(|((a, b), w)| a * b * w).sum());
        }
    }
    matrix
}

/// Returns the means `⟨a_i⟩` of all functions of a table at the nodes of a quadrature rule.
pub fn means(rule: &Rule, a: &[f64]) -> Vec<f64> {
    a.chunks_exact(rule.len())
        .map(|a| a.iter().zip(&rule.weights).map(|(a, w)| a * w).sum())
        .collect()
}

/// Returns the products `a_i b_k` at every node for all pairs of functions, one pair after another:
/// pair `(i, k)` has the number `i·n_b + k`.
pub fn pairs(points: usize, a: &[f64], b: &[f64]) -> Vec<f64> {
    let mut products = Vec::with_capacity(a.len() * (b.len() / points));
    for a in a.chunks_exact(points) {
        for b in b.chunks_exact(points) {
            products.extend(a.iter().zip(b).map(|(a, b)| a * b));
        }
    }
    products
}

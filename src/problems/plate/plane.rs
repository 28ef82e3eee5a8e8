//! The in-plane problem for a given deflection `w`: `K_uv s = −r(w)`.
//!
//! The in-plane displacement along x is `u = Σ U_k(ξ) U_l(ζ)`, and the displacement `v` along y has
//! the same form. The stiffness matrix of plane stress is a sum of constant matrices whose
//! coefficients depend on `α` and `ν`. In the following formulas, `⟨·⟩` is the mean over the plate,
//! `x = (1 + ξ)/2`, and `y = α(1 + ζ)/2`:
//!
//! ```text
//! K_uu = 4⟨u_ξ u_ξ⟩ + 2(1−ν)/α² ⟨u_ζ u_ζ⟩      K_vv = 4/α² ⟨v_ζ v_ζ⟩ + 2(1−ν)⟨v_ξ v_ξ⟩
//! K_uv = 4ν/α ⟨u_ξ v_ζ⟩ + 2(1−ν)/α ⟨u_ζ v_ξ⟩
//! ```
//!
//! If the edges permit rigid motions in the plane, a penalty on the means of these motions makes
//! the solution unique. The right-hand side is orthogonal to rigid motions, so the penalty does not
//! change the stresses.

use super::basis::{Basis, Direction};
use super::edges::{InPlane, Supports};
use super::tensor::{Rule, means, moments};
use crate::core::scalar::{Scalar, with_avx2};
use faer::dyn_stack::{MemBuffer, MemStack};
use faer::linalg::cholesky::llt::factor::{cholesky_in_place, cholesky_in_place_scratch};
use faer::{MatMut, Par};

/// The space of in-plane displacements, spanned by products of functions.
pub(super) struct PlaneSpace {
    /// The basis functions of ξ and of ζ whose products span the displacement `u`.
    pub u: [Basis; 2],
    /// The basis functions of ξ and of ζ whose products span the displacement `v`.
    pub v: [Basis; 2],
    /// The positions of the unknowns of `u` in the full grid of products of basis functions.
    pub u_active: Vec<usize>,
    /// The positions of the unknowns of `v` in the full grid of products of basis functions.
    pub v_active: Vec<usize>,
    /// The linear functionals that are penalised, one for each rigid motion that the edges permit.
    pub rigid: Vec<Vec<f64>>,
    moments: Moments,
}

/// The means of products of a function from one basis and a function from another basis in the same
/// direction; the indices are the orders of the derivatives of the two functions.
type Products = [[Vec<f64>; 2]; 2];

/// The means, along ξ and along ζ, of three kinds of products of basis functions: of two functions
/// of `u`, of two functions of `v`, and of a function of `u` and a function of `v`.
struct Moments {
    uu: [Products; 2],
    vv: [Products; 2],
    uv: [Products; 2],
}

impl PlaneSpace {
    /// Creates the space for the given in-plane supports; in directions that are `symmetric`,
    /// displacements along the direction are odd functions and displacements across it are even
    /// functions of the coordinate.
    pub fn new(
        supports: Supports,
        model: InPlane,
        symmetric: [bool; 2],
        counts: [usize; 2],
    ) -> PlaneSpace {
        let ends = [supports.x(), supports.y()].map(|ends| ends.map(|end| model.at(end)));
        let line = |axis: usize, direction: Direction| {
            let parity = symmetric[axis].then_some(direction == Direction::Tangential);
            Basis::in_plane(ends[axis], direction, parity, counts[axis])
        };
        let u = [line(0, Direction::Normal), line(1, Direction::Tangential)];
        let v = [line(0, Direction::Tangential), line(1, Direction::Normal)];
        let (x, y) = (ends[0], ends[1]);
        let u_active = active(&u[0], &u[1], straight_functions(&u[0], x, symmetric[0]), false);
        let v_active = active(&v[0], &v[1], straight_functions(&v[1], y, symmetric[1]), true);
        let moments = Moments::new(&u, &v, symmetric);
        let mut space = PlaneSpace { u, v, u_active, v_active, rigid: Vec::new(), moments };
        space.rigid = space.rigid_motions(ends, symmetric);
        space
    }

    /// Returns the number of in-plane unknowns.
    pub fn len(&self) -> usize {
        self.u_active.len() + self.v_active.len()
    }

    /// Distributes the values of the unknowns to the grids of `u` and `v`.
    pub fn unpack<T: Scalar>(&self, s: &[T], u: &mut [T], v: &mut [T]) {
        u.fill(T::zero());
        v.fill(T::zero());
        for (position, s) in self.u_active.iter().zip(s) {
            u[*position] = *s;
        }
        for (position, s) in self.v_active.iter().zip(&s[self.u_active.len()..]) {
            v[*position] = *s;
        }
    }

    /// Collects the values of the unknowns from the grids of `u` and `v`.
    pub fn pack<T: Scalar>(&self, u: &[T], v: &[T], s: &mut [T]) {
        let (of_u, of_v) = s.split_at_mut(self.u_active.len());
        for (position, s) in self.u_active.iter().zip(of_u) {
            *s = u[*position];
        }
        for (position, s) in self.v_active.iter().zip(of_v) {
            *s = v[*position];
        }
    }

    /// Adds the contribution of the penalty on rigid motions to `r = K_uv s`.
    pub fn add_penalty<T: Scalar>(&self, s: &[T], r: &mut [T]) {
        for functional in &self.rigid {
            let amount = super::tensor::dot(s, functional);
            for (r, f) in r.iter_mut().zip(functional) {
                *r += amount * *f;
            }
        }
    }

    fn rigid_motions(&self, ends: [[InPlane; 2]; 2], symmetric: [bool; 2]) -> Vec<Vec<f64>> {
        let turned = |axis: usize| ends[axis].contains(&InPlane::Straight);
        let mut motions = Vec::new();
        if self.u[0].contains(0) && self.u[1].contains(0) {
            motions.push(self.functional(symmetric, [Some([0, 0]), None]));
        }
        if self.v[0].contains(0) && self.v[1].contains(0) {
            motions.push(self.functional(symmetric, [None, Some([0, 0])]));
        }
        let u_turns = self.u[0].contains(0) && self.u[1].contains(1) && !turned(0);
        let v_turns = self.v[1].contains(0) && self.v[0].contains(1) && !turned(1);
        if u_turns && v_turns {
            let turn_v = self.functional(symmetric, [None, Some([1, 0])]);
            let turn_u = self.functional(symmetric, [Some([0, 1]), None]);
            motions.push(turn_v.iter().zip(&turn_u).map(|(v, u)| v - u).collect());
        }
        motions
    }

    /// Returns the means `⟨ξ^i ζ^j u⟩` and `⟨ξ^i ζ^j v⟩` for the basis functions of all unknowns; a
    /// mean that is not requested is omitted.
    fn functional(&self, symmetric: [bool; 2], powers: [Option<[i32; 2]>; 2]) -> Vec<f64> {
        let mut grids = [&self.u, &self.v].map(|bases| vec![0.0; bases[0].len() * bases[1].len()]);
        for ((grid, bases), power) in grids.iter_mut().zip([&self.u, &self.v]).zip(powers) {
            let Some(power) = power else { continue };
            let lines = [0, 1].map(|axis| {
                let rule = Rule::exact(bases[axis].degree() + 1, symmetric[axis]);
                let table = bases[axis].table(&rule.nodes);
                let factor: Vec<f64> = rule.nodes.iter().map(|x| x.powi(power[axis])).collect();
                means(&rule, &super::tensor::pairs(rule.len(), &table.values, &factor))
            });
            for (entry, out) in grid.iter_mut().enumerate() {
                *out = lines[0][entry / bases[1].len()] * lines[1][entry % bases[1].len()];
            }
        }
        let mut packed = vec![0.0; self.len()];
        self.pack(&grids[0], &grids[1], &mut packed);
        packed
    }

    /// Computes the stiffness matrix `K_uv`, including the penalty on rigid motions, stored column
    /// by column.
    fn stiffness(&self, alpha: f64, nu: f64, k: &mut [f64]) {
        let (n, nu_count) = (self.len(), self.u_active.len());
        let m = &self.moments;
        let (ux, uy, vx, vy) = (self.u[0].len(), self.u[1].len(), self.v[0].len(), self.v[1].len());
        let shear = 2.0 * (1.0 - nu);
        for (row, i) in self.u_active.iter().enumerate() {
            let [a, b] = [i / uy, i % uy];
            for (column, j) in self.u_active.iter().enumerate() {
                let [c, d] = [j / uy, j % uy];
                k[column * n + row] = 4.0 * m.uu[0][1][1][a * ux + c] * m.uu[1][0][0][b * uy + d]
                    + shear / (alpha * alpha)
                        * m.uu[0][0][0][a * ux + c]
                        * m.uu[1][1][1][b * uy + d];
            }
            for (column, j) in self.v_active.iter().enumerate() {
                let [c, d] = [j / vy, j % vy];
                let entry =
                    4.0 * nu / alpha * m.uv[0][1][0][a * vx + c] * m.uv[1][0][1][b * vy + d]
                        + shear / alpha * m.uv[0][0][1][a * vx + c] * m.uv[1][1][0][b * vy + d];
                k[(nu_count + column) * n + row] = entry;
                k[row * n + nu_count + column] = entry;
            }
        }
        for (row, i) in self.v_active.iter().enumerate() {
            let [a, b] = [i / vy, i % vy];
            for (column, j) in self.v_active.iter().enumerate() {
                let [c, d] = [j / vy, j % vy];
                k[(nu_count + column) * n + nu_count + row] =
                    4.0 / (alpha * alpha) * m.vv[0][0][0][a * vx + c] * m.vv[1][1][1][b * vy + d]
                        + shear * m.vv[0][1][1][a * vx + c] * m.vv[1][0][0][b * vy + d];
            }
        }
        for functional in &self.rigid {
            for (column, f) in k.chunks_exact_mut(n).zip(functional) {
                column.iter_mut().zip(functional).for_each(|(k, g)| *k += f * g);
            }
        }
    }
}

/// Returns a flag for each basis function in the direction normal to the edges: whether the
/// function describes the displacement of a straight edge, so that its coefficient must be constant
/// along the edge.
fn straight_functions(normal: &Basis, ends: [InPlane; 2], symmetric: bool) -> Vec<bool> {
    let straight = ends.map(|end| end == InPlane::Straight);
    match (normal.boundary, symmetric) {
        (2, false) => straight.to_vec(),
        // A single function at the ends belongs to the end that is not held, or by symmetry to both
        // ends.
        (1, _) => vec![straight[0] || straight[1]],
        _ => vec![false; normal.boundary],
    }
}

/// Returns the positions of the unknowns in the grid of products of functions of `x` and `y`: all
/// products are unknowns, except that a function that describes the displacement of a straight edge
/// is multiplied only by the constant function. The argument `normal_is_y` is true if the
/// displacement is along y, normal to the edges y = 0 and y = 1.
fn active(x: &Basis, y: &Basis, straight: Vec<bool>, normal_is_y: bool) -> Vec<usize> {
    let mut positions = Vec::with_capacity(x.len() * y.len());
    for i in 0..x.len() {
        for j in 0..y.len() {
            let (normal, along) = if normal_is_y { (j, i) } else { (i, j) };
            if along == 0 || !straight.get(normal).copied().unwrap_or(false) {
                positions.push(i * y.len() + j);
            }
        }
    }
    positions
}

impl Moments {
    fn new(u: &[Basis; 2], v: &[Basis; 2], symmetric: [bool; 2]) -> Moments {
        let products = |a: &[Basis; 2], b: &[Basis; 2]| {
            [0, 1].map(|axis| {
                let rule = Rule::exact(2 * u[axis].degree().max(v[axis].degree()), symmetric[axis]);
                let [a, b] = [a, b].map(|bases| bases[axis].table(&rule.nodes));
                [&a.values, &a.slopes]
                    .map(|a| [moments(&rule, a, &b.values), moments(&rule, a, &b.slopes)])
            })
        };
        Moments { uu: products(u, u), vv: products(v, v), uv: products(u, v) }
    }
}

/// The Cholesky factor of the in-plane stiffness matrix `K_uv` for one pair of parameters `(α, ν)`.
pub(super) struct PlaneFactor {
    /// The pair `(α, ν)` for which the factor was computed.
    pub at: Option<(f64, f64)>,
    /// The factor `L`, on and below the diagonal, stored column by column.
    pub factor: Vec<f64>,
    size: usize,
    scratch: MemBuffer,
}

impl PlaneFactor {
    /// Allocates a factor.
    pub fn new(size: usize) -> PlaneFactor {
        let need = cholesky_in_place_scratch::<f64>(size, Par::Seq, Default::default());
        PlaneFactor {
            at: None,
            factor: vec![0.0; size * size],
            size,
            scratch: MemBuffer::new(need),
        }
    }

    /// Factors the in-plane stiffness matrix `K_uv(α, ν)` unless the factor for this pair of
    /// parameters is known; returns `false` if the matrix is not positive definite.
    #[must_use]
    pub fn update(&mut self, space: &PlaneSpace, alpha: f64, nu: f64) -> bool {
        if self.at == Some((alpha, nu)) {
            return true;
        }
        space.stiffness(alpha, nu, &mut self.factor);
        let matrix = MatMut::from_column_major_slice_mut(&mut self.factor, self.size, self.size);
        let stack = MemStack::new(&mut self.scratch);
        let done =
            cholesky_in_place(matrix, Default::default(), Par::Seq, stack, Default::default());
        self.at = done.is_ok().then_some((alpha, nu));
        done.is_ok()
    }

    /// Computes `K_uv⁻¹ r` in place; all components of a dual number are solved for by the same
    /// substitution.
    pub fn solve<T: Scalar>(&self, r: &mut [T]) {
        with_avx2(
            #[inline(always)]
            || self.substitute(r),
        );
    }

    #[inline(always)]
    fn substitute<T: Scalar>(&self, r: &mut [T]) {
        let n = self.size;
        for (j, column) in self.factor.chunks_exact(n).enumerate() {
            let (head, tail) = r.split_at_mut(j + 1);
            head[j] *= 1.0 / column[j];
            for (r, l) in tail.iter_mut().zip(&column[j + 1..]) {
                *r -= head[j] * *l;
            }
        }
        for (j, column) in self.factor.chunks_exact(n).enumerate().rev() {
            let (head, tail) = r.split_at_mut(j + 1);
            head[j] = (head[j] - super::tensor::dot(tail, &column[j + 1..])) * (1.0 / column[j]);
        }
    }
}

//! The residual `F = ∂Π/∂q` of the plate, which is written once for all scalar types.
//!
//! The potential per unit of the plate's area is given below, where `⟨·⟩` is the mean over the
//! plate, `w = Σ q_ij f_i(ξ) g_j(ζ)`, `x = (1 + ξ)/2`, `y = α(1 + ζ)/2`:
//!
//! ```text
//! Π = ½⟨w_xx² + w_yy² + 2ν w_xx w_yy + 2(1−ν) w_xy²⟩              bending
//!   + 6α₁²⟨e₁² + e₂² + 2ν e₁e₂ + ½(1−ν)γ²⟩                        stretching (eq. 2.6)
//!   − ½⟨N_x w_x² + N_y w_y² + 2N_xy w_x w_y⟩                      applied edge forces
//!   − λ⟨1/(1−w)⟩ − P⟨w⟩                                           electrostatic load, pressure
//! ```
//!
//! The in-plane displacements `s` are eliminated by solving `K_uv s = −r(w)`. Since `Π` is
//! stationary with respect to `s`, `F` is the partial derivative of `Π` with respect to `q` at the
//! solution `s`. The mass matrix does not depend on `α`, because `Π` is a mean over the plate
//! instead of an integral.

use super::discretisation::{Discretisation, Membrane};
use super::edges::Support;
use super::parameters::Parameters;
use super::plane::PlaneFactor;
use super::tensor::{Product, weights};
use crate::core::scalar::Scalar;

/// The buffers for one scalar type; after an evaluation of the residual, they contain the fields of
/// this evaluation.
pub(super) struct Workspace<T> {
    pub q: Vec<T>,
    pub p: Vec<T>,
    pub r: Vec<T>,
    /// In-plane unknowns.
    pub s: Vec<T>,
    right: Vec<T>,
    grids: [Vec<T>; 2],
    half: Vec<T>,
    product: Vec<T>,
    /// The slopes `w_ξ`, `w_ζ` at the nodes of the quadrature rule for stretching.
    pub slopes: [Vec<T>; 2],
    /// The stresses `N₁`, `N₂`, `N₆` (in units of `Eh/(1−ν²)·d²/a²`) at the nodes of the quadrature
    /// rule for stretching, without quadrature weights.
    pub stress: [Vec<T>; 3],
    fields: [Vec<T>; 2],
}

impl<T: Scalar> Workspace<T> {
    pub fn new(model: &Discretisation) -> Workspace<T> {
        let zeros = |length: usize| vec![T::zero(); length];
        let plane = &model.plane;
        let nodes = model.membrane.as_ref().map_or(0, |m| m.points()[0] * m.points()[1]);
        let load = model.loads.iter().map(|l| l.rules[0].len() * l.rules[1].len()).max();
        Workspace {
            q: zeros(model.unknowns()),
            p: zeros(model.settings.units.names().len()),
            r: zeros(model.unknowns()),
            s: zeros(plane.len()),
            right: zeros(plane.len()),
            grids: [&plane.u, &plane.v].map(|bases| zeros(bases[0].len() * bases[1].len())),
            half: Vec::new(),
            product: zeros(model.unknowns()),
            slopes: [zeros(nodes), zeros(nodes)],
            stress: [zeros(nodes), zeros(nodes), zeros(nodes)],
            fields: [zeros(nodes.max(load.unwrap_or(0))), zeros(nodes)],
        }
    }

    /// Computes the residual `F` into `self.r`, for the unknowns in `self.q` and the parameters in
    /// `self.p`. After the evaluation, `self.q` contains the coefficients of the products of
    /// functions. The argument `largest` is the largest deflection. The flag `plane_fixed` states
    /// that `α` and `ν` have no derivatives, so that one solution of the in-plane problem is exact
    /// for derivatives of every order. Returns the largest deflection at the quadrature nodes of
    /// the electrostatic load.
    pub fn evaluate(
        &mut self,
        model: &Discretisation,
        factor: &PlaneFactor,
        largest: f64,
        plane_fixed: bool,
    ) -> f64 {
        let parameters = model.settings.units.parameters(&self.p);
        self.q.iter_mut().zip(&model.scale).for_each(|(q, scale)| *q *= *scale);
        self.r.fill(T::zero());
        self.bend(model, &parameters);
        if let Some(membrane) = &model.membrane {
            let solutions = if plane_fixed { 1 } else { T::NDERIV + 1 };
            self.solve_plane(model, membrane, factor, &parameters, solutions);
            self.stretch(membrane, &parameters);
        }
        let nearest = self.attract(model, &parameters, largest);
        self.r.iter_mut().zip(&model.scale).for_each(|(r, scale)| *r *= *scale);
        nearest
    }

    /// Evaluates the field with the coefficients `self.q` at the nodes, and writes the values into
    /// `field`.
    pub fn expand(&mut self, product: &Product, field: &mut [T]) {
        product.expand(&self.q, &mut self.half, field);
    }

    /// Adds the terms of bending, applied edge forces and pressure to the residual; these terms
    /// have the form `Σ c L q R` with constant matrices.
    fn bend(&mut self, model: &Discretisation, parameters: &Parameters<T>) {
        let [nx, ny] = [model.transverse[0].len(), model.transverse[1].len()];
        for (coefficient, left, right) in quadratic_terms(model, parameters) {
            if left.is_empty() {
                continue;
            }
            self.product.fill(T::zero());
            for (row, q) in self.product.chunks_exact_mut(ny).zip(self.q.chunks_exact(ny)) {
                for (q, right) in q.iter().zip(right.chunks_exact(ny)) {
                    for (out, right) in row.iter_mut().zip(right) {
                        *out += *q * *right;
                    }
                }
            }
            self.product.iter_mut().for_each(|entry| *entry *= coefficient);
            for (out, left) in self.r.chunks_exact_mut(ny).zip(left.chunks_exact(nx)) {
                for (row, left) in self.product.chunks_exact(ny).zip(left) {
                    for (out, entry) in out.iter_mut().zip(row) {
                        *out += *entry * *left;
                    }
                }
            }
        }
        let [mx, my] = [&model.lines[0].means, &model.lines[1].means];
        for (row, mx) in self.r.chunks_exact_mut(ny).zip(mx) {
            for (out, my) in row.iter_mut().zip(my) {
                *out -= parameters.pressure * (mx * my);
            }
        }
    }

    /// Computes `s = −K_uv⁻¹ r(w)` by iterative refinement with the Cholesky factor in `f64`; each
    /// iteration makes the derivatives of one more order exact.
    pub fn solve_plane(
        &mut self,
        model: &Discretisation,
        membrane: &Membrane,
        factor: &PlaneFactor,
        parameters: &Parameters<T>,
        solutions: usize,
    ) {
        for (product, slope) in membrane.slopes(&membrane.w).into_iter().zip(&mut self.slopes) {
            product.expand(&self.q, &mut self.half, slope);
        }
        self.s.fill(T::zero());
        for turn in 0..solutions {
            self.find_stress(model, membrane, parameters, turn == 0);
            self.project_on_plane(model, membrane, parameters);
            factor.solve(&mut self.right);
            self.s.iter_mut().zip(&self.right).for_each(|(s, step)| *s -= *step);
        }
        self.find_stress(model, membrane, parameters, false);
    }

    /// Computes the stresses for the current deflection `w` and in-plane displacements `s`; if
    /// `at_rest` is true, the contributions that vanish for `s = 0` are skipped.
    fn find_stress(
        &mut self,
        model: &Discretisation,
        membrane: &Membrane,
        parameters: &Parameters<T>,
        at_rest: bool,
    ) {
        let alpha = parameters.aspect;
        let along = alpha.recip() * 2.0;
        let [e1, e2, shear] = &mut self.stress;
        for (k, (x, y)) in self.slopes[0].iter().zip(&self.slopes[1]).enumerate() {
            let slope = *y * along;
            e1[k] = *x * *x * 2.0;
            e2[k] = slope * slope * 0.5;
            shear[k] = *x * slope * 2.0;
        }
        if !at_rest {
            self.add_plane_strain(model, membrane, along);
        }
        let [e1, e2, shear] = &mut self.stress;
        let nu = parameters.nu;
        let rigidity = (T::one() - nu) * 0.5;
        for ((e1, e2), shear) in e1.iter_mut().zip(e2).zip(shear) {
            (*e1, *e2) = (*e1 + nu * *e2, *e2 + nu * *e1);
            *shear *= rigidity;
        }
    }

    /// Adds the strains of the in-plane displacements, `u_x`, `v_y` and `u_y + v_x`.
    fn add_plane_strain(&mut self, model: &Discretisation, membrane: &Membrane, along: T) {
        let [u, v] = &mut self.grids;
        model.plane.unpack(&self.s, u, v);
        let field = &mut self.fields[0][..self.stress[0].len()];
        for (product, grid, strain, scale) in plane_strains(membrane, along) {
            product.expand(&self.grids[grid], &mut self.half, field);
            for (strain, slope) in self.stress[strain].iter_mut().zip(field.iter()) {
                *strain += *slope * scale;
            }
        }
    }

    /// Computes the residual `K_uv s + r(w)` of the in-plane problem from the current stresses,
    /// into `right`.
    fn project_on_plane(
        &mut self,
        model: &Discretisation,
        membrane: &Membrane,
        parameters: &Parameters<T>,
    ) {
        let along = parameters.aspect.recip() * 2.0;
        self.grids.iter_mut().for_each(|grid| grid.fill(T::zero()));
        let field = &mut self.fields[0][..self.stress[0].len()];
        for (product, grid, stress, scale) in plane_strains(membrane, along) {
            let stresses = self.stress[stress].iter().zip(weights(&membrane.rules));
            for (field, (n, weight)) in field.iter_mut().zip(stresses) {
                *field = *n * scale * weight;
            }
            product.project(field, &mut self.half, &mut self.grids[grid]);
        }
        let [u, v] = &self.grids;
        model.plane.pack(u, v, &mut self.right);
        model.plane.add_penalty(&self.s, &mut self.right);
    }

    /// Adds the force that the stresses exert on the deflection.
    fn stretch(&mut self, membrane: &Membrane, parameters: &Parameters<T>) {
        let along = parameters.aspect.recip() * 2.0;
        let stiffness = parameters.gap_ratio * parameters.gap_ratio * 12.0;
        let [n1, n2, n6] = &self.stress;
        let [w_x, w_y] = &self.slopes;
        let [force_x, force_y] = &mut self.fields;
        for (k, weight) in weights(&membrane.rules).enumerate() {
            let slope = w_y[k] * along;
            force_x[k] = (n1[k] * w_x[k] * 2.0 + n6[k] * slope) * stiffness * (2.0 * weight);
            force_y[k] = (n2[k] * slope + n6[k] * w_x[k] * 2.0) * stiffness * along * weight;
        }
        let nodes = n1.len();
        let products: [Product; 2] = membrane.slopes(&membrane.w);
        products[0].project(&force_x[..nodes], &mut self.half, &mut self.r);
        products[1].project(force_y, &mut self.half, &mut self.r);
    }

    /// Adds the electrostatic load `−λ⟨φ/(1−w)²⟩`, and returns the largest deflection at its
    /// quadrature nodes.
    fn attract(&mut self, model: &Discretisation, parameters: &Parameters<T>, largest: f64) -> f64 {
        let load = model.load_rule(largest);
        let product = load.values();
        let field = &mut self.fields[0][..product.points[0] * product.points[1]];
        product.expand(&self.q, &mut self.half, field);
        let [x, y] = &load.rules;
        let mut smallest_gap = f64::INFINITY;
        for (row, wx) in field.chunks_exact_mut(y.len()).zip(&x.weights) {
            for (w, wy) in row.iter_mut().zip(&y.weights) {
                let gap = T::one() - *w;
                smallest_gap = if gap.real() < smallest_gap { gap.real() } else { smallest_gap };
                let closeness = gap.recip();
                *w = -(parameters.load * closeness * closeness) * (wx * wy);
            }
        }
        product.project(field, &mut self.half, &mut self.r);
        1.0 - smallest_gap
    }
}

/// Returns the contributions of the derivatives `u_ξ`, `u_ζ`, `v_ξ`, `v_ζ` to the strains; each
/// contribution consists of the tables of the derivative, the index of the grid of unknowns, the
/// index of the strain, and a factor.
fn plane_strains<T: Scalar>(membrane: &Membrane, along: T) -> [(Product<'_>, usize, usize, T); 4] {
    let [u_x, u_y] = membrane.slopes(&membrane.u);
    let [v_x, v_y] = membrane.slopes(&membrane.v);
    let two = T::from(2.0);
    [(u_x, 0, 0, two), (u_y, 0, 2, along), (v_x, 1, 2, two), (v_y, 1, 1, along)]
}

/// Returns the terms of the potential `Π` that are quadratic in `q`, in the form `½ qᵀ(c L ⊗ R)q`:
/// the coefficient `c`, the matrix `L` of the functions of ξ, and the matrix `R` of the functions
/// of ζ (transposed). A pair of opposite edges carries no normal force if one of the two edges is
/// free; a plate with any free edge carries no shear force.
pub(super) fn quadratic_terms<'a, T: Scalar>(
    model: &'a Discretisation,
    parameters: &Parameters<T>,
) -> [(T, &'a [f64], &'a [f64]); 9] {
    let [x, y] = &model.lines;
    let along = parameters.aspect.recip();
    let along2 = along * along;
    let poisson = parameters.nu * along2 * 16.0;
    let supports = model.settings.supports;
    let carried = |ends: [Support; 2]| !ends.contains(&Support::Free);
    let left = |matrix: &'a [f64], carried: bool| if carried { matrix } else { &[] };
    let shear = parameters.shear * along * -4.0;
    let sheared = !supports.any_free() && model.symmetric == [false, false];
    [
        (T::from(16.0), &x.curvatures, &y.values),
        (along2 * along2 * 16.0, &x.values, &y.curvatures),
        (poisson, &x.mixed[0], &y.mixed[0]),
        (poisson, &x.mixed[1], &y.mixed[1]),
        ((T::one() - parameters.nu) * along2 * 32.0, &x.slopes, &y.slopes),
        (parameters.compression_x * -4.0, left(&x.slopes, carried(supports.x())), &y.values),
        (
            parameters.compression_y * along2 * -4.0,
            left(&x.values, carried(supports.y())),
            &y.slopes,
        ),
        (shear, left(&x.skew[0], sheared), &y.skew[0]),
        (shear, left(&x.skew[1], sheared), &y.skew[1]),
    ]
}

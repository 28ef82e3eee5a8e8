//! The plate's response in its plane, condensed once and for all.
//!
//! With `w = Σ q_i φ_i` the strains of eq. 2.6 are `Σ q_i q_j ε_ij` plus those of the in-plane
//! displacements, and these depend on the products `q_i q_j` linearly: for each pair one solution with
//! `K_uv` gives the whole stress `N_ij` that the pair develops, in equilibrium in the plane. Then
//!
//! ```text
//! U_m = 6α₁² Σ s_P A_PQ s_Q,    A_PQ = ⟨N_P : ε_Q⟩,    s_P = q_i² or 2q_i q_j for the pairs P = (i ≤ j)
//! ```
//!
//! (the strain of a stress in equilibrium does no work on admissible in-plane displacements, so that the
//! bare `ε_Q` is enough). Its derivative by `q_i` is `24α₁² Σ_j (A s)_ij q_j`.

use super::ModalSettings;
use super::error::ModalError;
use super::spectrum::FlatModes;
use super::tables::{fields, product, weights};
use crate::core::scalar::Scalar;
use crate::problems::plate::basis::Table;
use crate::problems::plate::model::Model;
use crate::problems::plate::plane::{PlaneFactor, PlaneSpace};
use crate::problems::plate::tensor::Rule;
use faer::linalg::matmul::matmul;
use faer::{Accum, MatMut, MatRef, Par};

/// Stress resultants and bare strains of all pairs of modes at the nodes of a rule.
pub(super) struct Pairs {
    /// `N₁`, `N₂`, `N₆` of pair `P` (in units of `Eh/(1−ν²)·d²/a²`), one pair after the other, each `3·nodes` long.
    pub stress: Vec<f64>,
    /// `e₁`, `e₂`, `γ` alike.
    pub strain: Vec<f64>,
    pub weights: Vec<f64>,
}

/// A rule on which the membrane energy of these modes is exact.
pub(super) fn exact_rules(flat: &FlatModes, plane: &PlaneSpace) -> [Rule; 2] {
    [0, 1].map(|axis| {
        let w = flat.model.transverse[axis].degree();
        let s = plane.u[axis].degree().max(plane.v[axis].degree());
        Rule::exact((4 * w).max(2 * w + s), flat.model.symmetric[axis])
    })
}

/// The space of in-plane displacements.
pub(super) fn plane_space(settings: &ModalSettings, flat: &FlatModes) -> PlaneSpace {
    let plate = &settings.plate;
    PlaneSpace::new(plate.supports, plate.in_plane, flat.model.symmetric, flat.orders.in_plane)
}

impl Pairs {
    /// One solution for each pair `i ≤ j`, in the order `(0,0), (0,1) … (1,1) …`.
    pub fn new(
        settings: &ModalSettings,
        flat: &FlatModes,
        plane: &PlaneSpace,
        rules: &[Rule; 2],
    ) -> Result<Pairs, ModalError> {
        let mut factor = PlaneFactor::new(plane.len());
        if !factor.update(plane, settings.plate.aspect, settings.nu) {
            return Err(ModalError::Plane { functions: flat.orders.in_plane });
        }
        let [w_x, w_y] = slopes(&flat.model, &flat.shapes, rules, settings.plate.aspect);
        let mut response = Response::new(settings, plane, factor, rules);
        let count = w_x.len() * (w_x.len() + 1) / 2;
        let length = 3 * response.weights.len();
        let mut stress = Vec::with_capacity(count * length);
        let mut strain = Vec::with_capacity(count * length);
        for i in 0..w_x.len() {
            for j in i..w_x.len() {
                let first = strain.len();
                strain.extend(w_x[i].iter().zip(&w_x[j]).map(|(a, b)| 0.5 * a * b));
                strain.extend(w_y[i].iter().zip(&w_y[j]).map(|(a, b)| 0.5 * a * b));
                let shear = w_x[i].iter().zip(&w_y[j]).zip(w_x[j].iter().zip(&w_y[i]));
                strain.extend(shear.map(|((a, b), (c, d))| 0.5 * (a * b + c * d)));
                stress.extend_from_slice(response.stress(&strain[first..]));
            }
        }
        Ok(Pairs { stress, strain, weights: response.weights })
    }

    /// `A_PQ`, symmetric, row by row.
    pub fn quartic_form(&self) -> Vec<f64> {
        let length = 3 * self.weights.len();
        let count = self.stress.len() / length;
        let mut weighted = self.strain.clone();
        for field in weighted.chunks_exact_mut(self.weights.len()) {
            field.iter_mut().zip(&self.weights).for_each(|(e, weight)| *e *= weight);
        }
        let mut form = vec![0.0; count * count];
        let stress = MatRef::from_column_major_slice(&self.stress, length, count);
        let strain = MatRef::from_column_major_slice(&weighted, length, count);
        let out = MatMut::from_column_major_slice_mut(&mut form, count, count);
        matmul(out, Accum::Replace, stress.transpose(), strain, 1.0, Par::Seq);
        for row in 0..count {
            for column in 0..row {
                let mean = 0.5 * (form[row * count + column] + form[column * count + row]);
                (form[row * count + column], form[column * count + row]) = (mean, mean);
            }
        }
        form
    }
}

/// `φ_x`, `φ_y` of all modes (lengths by the side `a`) at the nodes.
pub(super) fn slopes(
    model: &Model,
    shapes: &[Vec<f64>],
    rules: &[Rule; 2],
    aspect: f64,
) -> [Vec<Vec<f64>>; 2] {
    let mut both = [[1, 0], [0, 1]].map(|orders| fields(model, shapes, rules, orders));
    for (fields, scale) in both.iter_mut().zip([2.0, 2.0 / aspect]) {
        fields.iter_mut().flatten().for_each(|slope| *slope *= scale);
    }
    both
}

/// The in-plane problem at the nodes of a rule.
struct Response<'a> {
    plane: &'a PlaneSpace,
    factor: PlaneFactor,
    u: [Table; 2],
    v: [Table; 2],
    weights: Vec<f64>,
    /// `2/α`.
    along: f64,
    nu: f64,
    stress: Vec<f64>,
    field: Vec<f64>,
    half: Vec<f64>,
    grids: [Vec<f64>; 2],
    unknowns: Vec<f64>,
}

impl<'a> Response<'a> {
    fn new(
        settings: &ModalSettings,
        plane: &'a PlaneSpace,
        factor: PlaneFactor,
        rules: &[Rule; 2],
    ) -> Response<'a> {
        let [u, v] = [&plane.u, &plane.v]
            .map(|bases| [0, 1].map(|axis| bases[axis].table(&rules[axis].nodes)));
        let weights = weights(rules);
        let most = u[0].functions.max(v[0].functions);
        Response {
            plane,
            factor,
            along: 2.0 / settings.plate.aspect,
            nu: settings.nu,
            stress: vec![0.0; 3 * weights.len()],
            field: vec![0.0; weights.len()],
            half: vec![0.0; most * rules[1].len()],
            grids: [&u, &v].map(|tables| vec![0.0; tables[0].functions * tables[1].functions]),
            unknowns: vec![0.0; plane.len()],
            u,
            v,
            weights,
        }
    }

    /// The stress in equilibrium that a strain of the deflection develops.
    fn stress(&mut self, strain: &[f64]) -> &[f64] {
        self.stress.copy_from_slice(strain);
        self.strain_to_stress();
        self.solve();
        // Strains of the displacements are added to the bare ones, and turned into stress again.
        self.stress.copy_from_slice(strain);
        self.add_plane_strain();
        self.strain_to_stress();
        &self.stress
    }

    fn strain_to_stress(&mut self) {
        let nodes = self.weights.len();
        let (normal, shear) = self.stress.split_at_mut(2 * nodes);
        let (first, second) = normal.split_at_mut(nodes);
        for (e1, e2) in first.iter_mut().zip(second) {
            (*e1, *e2) = (*e1 + self.nu * *e2, *e2 + self.nu * *e1);
        }
        shear.iter_mut().for_each(|g| *g *= 0.5 * (1.0 - self.nu));
    }

    /// Which displacement's derivative, by which variable, in which strain, with which factor.
    fn terms(&self) -> [(usize, [usize; 2], usize, f64); 4] {
        [
            (0, [1, 0], 0, 2.0),
            (0, [0, 1], 2, self.along),
            (1, [1, 0], 2, 2.0),
            (1, [0, 1], 1, self.along),
        ]
    }

    /// `K_uv s = −⟨N : ε(·)⟩`.
    fn solve(&mut self) {
        let nodes = self.weights.len();
        self.grids.iter_mut().for_each(|grid| grid.fill(0.0));
        for (grid, orders, component, scale) in self.terms() {
            let stress = &self.stress[component * nodes..(component + 1) * nodes];
            for ((out, n), weight) in self.field.iter_mut().zip(stress).zip(&self.weights) {
                *out = -scale * n * weight;
            }
            let product = product(if grid == 0 { &self.u } else { &self.v }, orders);
            product.project(&self.field, &mut self.half, &mut self.grids[grid]);
        }
        let [u, v] = &self.grids;
        self.plane.pack(u, v, &mut self.unknowns);
        self.factor.solve(&mut self.unknowns);
    }

    fn add_plane_strain(&mut self) {
        let nodes = self.weights.len();
        let [u, v] = &mut self.grids;
        self.plane.unpack(&self.unknowns, u, v);
        for (grid, orders, component, scale) in self.terms() {
            let product = product(if grid == 0 { &self.u } else { &self.v }, orders);
            product.expand(&self.grids[grid], &mut self.half, &mut self.field);
            let strain = &mut self.stress[component * nodes..(component + 1) * nodes];
            strain.iter_mut().zip(&self.field).for_each(|(e, slope)| *e += scale * slope);
        }
    }
}

/// `s_P = q_i²` or `2q_i q_j` for the pairs `i ≤ j`, into `products`.
pub(super) fn products<T: Scalar>(q: &[T], products: &mut Vec<T>) {
    products.clear();
    for (i, first) in q.iter().enumerate() {
        products.push(*first * *first);
        let twice = *first * 2.0;
        products.extend(q[i + 1..].iter().map(|second| twice * *second));
    }
}

/// Adds `∂U_m/∂q_i = stiffness · Σ_j (A s)_ij q_j`, `stiffness = 24α₁²`, to `r`.
pub(super) fn add_force<T: Scalar>(form: &[f64], q: &[T], stiffness: T, r: &mut [T]) {
    let mut pairs = Vec::with_capacity(q.len() * (q.len() + 1) / 2);
    products(q, &mut pairs);
    let mut rows = form.chunks_exact(pairs.len());
    for i in 0..q.len() {
        for (j, row) in (i..q.len()).zip(&mut rows) {
            let tension = super::tables::sum(&pairs, row) * stiffness;
            r[i] += tension * q[j];
            if j > i {
                r[j] += tension * q[i];
            }
        }
    }
}

/// Adds `Σ_P row_P ∂s_P/∂q_k` to `out`.
pub(super) fn add_product_slopes(row: &[f64], q: &[f64], out: &mut [f64]) {
    let mut row = row.iter();
    for i in 0..q.len() {
        for (j, entry) in (i..q.len()).zip(&mut row) {
            out[i] += 2.0 * entry * q[j];
            if j > i {
                out[j] += 2.0 * entry * q[i];
            }
        }
    }
}

/// Adds the derivative of [`add_force`] by `q` to `out` (`N × N`, symmetric).
pub(super) fn add_stiffness(form: &[f64], q: &[f64], stiffness: f64, out: &mut [f64]) {
    let n = q.len();
    let mut pairs = Vec::with_capacity(n * (n + 1) / 2);
    products(q, &mut pairs);
    let mut slopes = vec![0.0; n];
    let mut rows = form.chunks_exact(pairs.len());
    for i in 0..n {
        for (j, row) in (i..n).zip(&mut rows) {
            let tension = stiffness * super::tables::sum(&pairs, row);
            slopes.fill(0.0);
            add_product_slopes(row, q, &mut slopes);
            out[i * n + j] += tension;
            let [qi, qj] = [i, j].map(|k| stiffness * q[k]);
            out[i * n..(i + 1) * n].iter_mut().zip(&slopes).for_each(|(o, s)| *o += qj * s);
            if j > i {
                out[j * n + i] += tension;
                out[j * n..(j + 1) * n].iter_mut().zip(&slopes).for_each(|(o, s)| *o += qi * s);
            }
        }
    }
}

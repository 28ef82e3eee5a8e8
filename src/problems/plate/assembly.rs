//! The Hessian of the plate's potential after elimination of the in-plane displacements; it is
//! assembled from matrix products.
//!
//! ```text
//! F_q = K_b + (geometric and strain terms) − 2λ⟨φφᵀ/(1−w)³⟩ − 12α₁² BᵀK_uv⁻¹B,    B = ∂r/∂q
//! ```
//!
//! Each term of the Hessian is a sum of `⟨a(ξ,ζ) · f_i f_k(ξ) · g_j g_l(ζ)⟩`. The products of two
//! functions of one variable are tabulated, so each term requires two matrix products, `X A Y`, for
//! any number of functions. Tests compare the Hessian with the derivative of the residual, computed
//! with dual numbers.

use super::discretisation::{Discretisation, Membrane, PairTables};
use super::parameters::Parameters;
use super::plane::PlaneFactor;
use super::residual::{Workspace, quadratic_terms};
use super::tensor::weights;
use faer::linalg::matmul::{matmul, triangular};
use faer::linalg::triangular_solve::solve_lower_triangular_in_place;
use faer::{Accum, MatMut, MatRef, Par};

/// The assembled Hessian and the workspace of its assembly.
pub(super) struct Assembly {
    /// The Hessian `F_q`, stored column by column.
    pub matrix: Vec<f64>,
    field: Vec<f64>,
    half: Vec<f64>,
    pairs: Vec<f64>,
    coupling: Vec<f64>,
}

/// The workspace for computing integrals of a field times products of two functions of ξ and two
/// functions of ζ.
struct Integral<'a> {
    points: [usize; 2],
    half: &'a mut Vec<f64>,
    out: &'a mut Vec<f64>,
}

impl Integral<'_> {
    /// Computes `out (+)= scale · Σ field(p, q) x(p, ·) y(q, ·)`, where the pair of ξ-functions
    /// varies fastest.
    fn add(&mut self, scale: f64, field: &[f64], x: &[f64], y: &[f64], accumulate: Accum) {
        let [px, py] = self.points;
        let (nx, ny) = (x.len() / px, y.len() / py);
        self.half.resize(py * nx, 0.0);
        self.out.resize(nx * ny, 0.0);
        let mut half = MatMut::from_column_major_slice_mut(self.half, py, nx);
        let field = MatRef::from_column_major_slice(&field[..px * py], py, px);
        let x = MatRef::from_column_major_slice(x, px, nx);
        matmul(half.as_mut(), Accum::Replace, field, x, scale, Par::Seq);
        let y = MatRef::from_column_major_slice(y, py, ny);
        let out = MatMut::from_column_major_slice_mut(self.out, nx, ny);
        matmul(out, accumulate, half.transpose(), y, 1.0, Par::Seq);
    }
}

impl Assembly {
    pub fn new(model: &Discretisation) -> Assembly {
        let n = model.unknowns();
        Assembly {
            matrix: vec![0.0; n * n],
            field: Vec::new(),
            half: Vec::new(),
            pairs: Vec::new(),
            coupling: vec![0.0; n * model.plane.len()],
        }
    }

    /// Assembles the Hessian at the state that `work` evaluated last, with the Cholesky factor
    /// `factor` of the in-plane stiffness matrix `K_uv`.
    pub fn assemble(
        &mut self,
        model: &Discretisation,
        factor: &PlaneFactor,
        work: &mut Workspace<f64>,
        largest: f64,
    ) {
        let parameters = model.settings.units.parameters(&work.p);
        self.matrix.fill(0.0);
        self.bend(model, &parameters);
        if let Some(membrane) = &model.membrane {
            self.stretch(model, membrane, work, &parameters);
            self.condense(model, membrane, factor, work, &parameters);
        }
        self.attract(model, work, &parameters, largest);
        self.scale(&model.scale);
    }

    fn scale(&mut self, scale: &[f64]) {
        for (column, by) in self.matrix.chunks_exact_mut(scale.len()).zip(scale) {
            column.iter_mut().zip(scale).for_each(|(entry, scale)| *entry *= scale * by);
        }
    }

    /// Assembles the Hessian at zero deflection without any load, where it contains only bending
    /// terms.
    pub fn assemble_flat(&mut self, model: &Discretisation, parameters: &Parameters<f64>) {
        self.matrix.fill(0.0);
        self.bend(model, parameters);
        self.scale(&model.scale);
    }

    fn bend(&mut self, model: &Discretisation, parameters: &Parameters<f64>) {
        let [nx, ny] = [0, 1].map(|axis| model.transverse[axis].len());
        let n = nx * ny;
        for (coefficient, left, right) in quadratic_terms(model, parameters) {
            if left.is_empty() || coefficient == 0.0 {
                continue;
            }
            for (column, entries) in self.matrix.chunks_exact_mut(n).enumerate() {
                let (k, l) = (column / ny, column % ny);
                for (i, rows) in entries.chunks_exact_mut(ny).enumerate() {
                    let factor = coefficient * left[i * nx + k];
                    for (entry, right) in rows.iter_mut().zip(&right[l * ny..(l + 1) * ny]) {
                        *entry += factor * right;
                    }
                }
            }
        }
    }

    /// Adds the stretching terms `12α₁²⟨δe:C:δe' + N:δ²e⟩` of the Hessian for fixed in-plane
    /// displacements.
    fn stretch(
        &mut self,
        model: &Discretisation,
        membrane: &Membrane,
        work: &Workspace<f64>,
        parameters: &Parameters<f64>,
    ) {
        let stiffness = 12.0 * parameters.gap_ratio * parameters.gap_ratio;
        let (along, nu) = (2.0 / parameters.aspect, parameters.nu);
        let rigidity = 0.5 * (1.0 - nu);
        let [w_x, w_y] = &work.slopes;
        let [n1, n2, n6] = &work.stress;
        let [x, y] = &membrane.ww;
        let [dd_x, dd_y] = [x, y].map(|pairs| &pairs[1][1]);
        let [vv_x, vv_y] = [x, y].map(|pairs| &pairs[0][0]);
        let (out, half) = (&mut self.pairs, &mut self.half);
        let mut integral = Integral { points: membrane.points(), half, out };
        let field = &mut self.field;
        field.resize(w_x.len(), 0.0);
        let fill = |value: &dyn Fn(usize, f64, f64) -> f64, field: &mut Vec<f64>| {
            for (k, weight) in weights(&membrane.rules).enumerate() {
                field[k] = stiffness * weight * value(k, 2.0 * w_x[k], along * w_y[k]);
            }
        };
        fill(&|k, x, y| 4.0 * (x * x + rigidity * y * y + n1[k]), field);
        integral.add(1.0, field, dd_x, vv_y, Accum::Replace);
        fill(&|k, x, y| along * along * (y * y + rigidity * x * x + n2[k]), field);
        integral.add(1.0, field, vv_x, dd_y, Accum::Add);
        fill(&|k, x, y| 2.0 * along * ((nu + rigidity) * x * y + n6[k]), field);
        integral.add(1.0, field, &x[1][0], &y[0][1], Accum::Add);
        integral.add(1.0, field, &x[0][1], &y[1][0], Accum::Add);
        let [nx, ny] = [0, 1].map(|axis| model.transverse[axis].len());
        self.scatter(model, |[i, k], [j, l]| (j * ny + l) * nx * nx + i * nx + k);
    }

    /// Adds integrals of products of four functions to the Hessian: entry `(i j, k l)` receives the
    /// integral at the position `pair([i, k], [j, l])`.
    fn scatter(&mut self, model: &Discretisation, pair: impl Fn([usize; 2], [usize; 2]) -> usize) {
        let [nx, ny] = [0, 1].map(|axis| model.transverse[axis].len());
        for (column, entries) in self.matrix.chunks_exact_mut(nx * ny).enumerate() {
            let (k, l) = (column / ny, column % ny);
            for (i, rows) in entries.chunks_exact_mut(ny).enumerate() {
                for (j, entry) in rows.iter_mut().enumerate() {
                    *entry += self.pairs[pair([i, k], [j, l])];
                }
            }
        }
    }

    /// Subtracts `12α₁² BᵀK_uv⁻¹B`.
    fn condense(
        &mut self,
        model: &Discretisation,
        membrane: &Membrane,
        factor: &PlaneFactor,
        work: &mut Workspace<f64>,
        parameters: &Parameters<f64>,
    ) {
        let (n, m) = (model.unknowns(), model.plane.len());
        for slope in &mut work.slopes {
            let weighted = slope.iter_mut().zip(weights(&membrane.rules));
            weighted.for_each(|(slope, weight)| *slope *= weight);
        }
        self.couple(model, membrane, &work.slopes, parameters);
        let mut coupling = MatMut::from_column_major_slice_mut(&mut self.coupling, m, n);
        let lower = MatRef::from_column_major_slice(&factor.factor, m, m);
        solve_lower_triangular_in_place(lower, coupling.as_mut(), Par::Seq);
        let mut matrix = MatMut::from_column_major_slice_mut(&mut self.matrix, n, n);
        triangular::matmul(
            matrix.as_mut(),
            triangular::BlockStructure::TriangularLower,
            Accum::Add,
            coupling.as_ref().transpose(),
            triangular::BlockStructure::Rectangular,
            coupling.as_ref(),
            triangular::BlockStructure::Rectangular,
            -12.0 * parameters.gap_ratio * parameters.gap_ratio,
            Par::Seq,
        );
        for column in 1..n {
            for row in 0..column {
                self.matrix[column * n + row] = self.matrix[row * n + column];
            }
        }
    }

    /// Assembles the derivative `B = ∂r/∂q` of the in-plane residual from the weighted slopes of
    /// the deflection `w`.
    fn couple(
        &mut self,
        model: &Discretisation,
        membrane: &Membrane,
        slopes: &[Vec<f64>; 2],
        parameters: &Parameters<f64>,
    ) {
        let (alpha, nu) = (parameters.aspect, parameters.nu);
        let [w_x, w_y] = slopes;
        let shear = 4.0 * (1.0 - nu) / alpha;
        let plane = &model.plane;
        // Coefficient, slope of w, then the derivatives along ξ and ζ: [of u or v, of w].
        let of_u = [
            (8.0, w_x, [1, 1], [0, 0]),
            (8.0 * nu / (alpha * alpha), w_y, [1, 0], [0, 1]),
            (shear / alpha, w_x, [0, 0], [1, 1]),
            (shear / alpha, w_y, [0, 1], [1, 0]),
        ];
        let of_v = [
            (8.0 / alpha.powi(3), w_y, [0, 0], [1, 1]),
            (8.0 * nu / alpha, w_x, [0, 1], [1, 0]),
            (shear, w_x, [1, 0], [0, 1]),
            (shear, w_y, [1, 1], [0, 0]),
        ];
        let u = (&membrane.uw, of_u, &plane.u_active, plane.u[1].len(), 0);
        let v = (&membrane.vw, of_v, &plane.v_active, plane.v[1].len(), plane.u_active.len());
        let points = membrane.points();
        let [nx, ny] = [0, 1].map(|axis| model.transverse[axis].len());
        for (tables, terms, active, along_y, first_row) in [u, v] {
            let [x, y]: &[PairTables; 2] = tables;
            let (out, half) = (&mut self.pairs, &mut self.half);
            let mut integral = Integral { points, half, out };
            for (term, (scale, slope, of_x, of_y)) in terms.into_iter().enumerate() {
                let accumulate = if term == 0 { Accum::Replace } else { Accum::Add };
                let (x, y) = (&x[of_x[0]][of_x[1]], &y[of_y[0]][of_y[1]]);
                integral.add(scale, slope, x, y, accumulate);
            }
            let pairs_x = x[0][0].len() / points[0];
            for (column, entries) in self.coupling.chunks_exact_mut(plane.len()).enumerate() {
                let (i, j) = (column / ny, column % ny);
                for (entry, position) in entries[first_row..].iter_mut().zip(active) {
                    let (k, l) = (position / along_y, position % along_y);
                    *entry = self.pairs[(l * ny + j) * pairs_x + k * nx + i];
                }
            }
        }
    }

    /// Subtracts `2λ⟨φφᵀ/(1−w)³⟩`.
    fn attract(
        &mut self,
        model: &Discretisation,
        work: &mut Workspace<f64>,
        parameters: &Parameters<f64>,
        largest: f64,
    ) {
        if parameters.load == 0.0 {
            return;
        }
        let load = model.load_rule(largest);
        let [rule_x, rule_y] = &load.rules;
        let product = load.values();
        let field = &mut self.field;
        field.resize(rule_x.len() * rule_y.len(), 0.0);
        work.expand(&product, field);
        for (row, wx) in field.chunks_exact_mut(rule_y.len()).zip(&rule_x.weights) {
            for (w, wy) in row.iter_mut().zip(&rule_y.weights) {
                let closeness = 1.0 / (1.0 - *w);
                *w = -2.0 * parameters.load * closeness.powi(3) * wx * wy;
            }
        }
        let (out, half) = (&mut self.pairs, &mut self.half);
        let mut integral = Integral { points: product.points, half, out };
        integral.add(1.0, field, &load.squares[0], &load.squares[1], Accum::Replace);
        let [nx, ny] = [0, 1].map(|axis| model.transverse[axis].len());
        let square = |count: usize, a: usize, b: usize| {
            let (a, b) = (a.min(b), a.max(b));
            a * count - a * (a + 1) / 2 + b
        };
        let pairs_x = nx * (nx + 1) / 2;
        self.scatter(model, |[i, k], [j, l]| square(ny, j, l) * pairs_x + square(nx, i, k));
    }
}

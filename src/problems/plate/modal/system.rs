//! The modal model as a [`System`] with assembled derivatives.

use super::Modal;
use crate::core::dense::Dense;
use crate::core::linear::BorderedLu;
use crate::core::zero::{
    Border, Dynamics, LeftDomain, Names, Profile, Singular, Slot, Spectrum, System, ZeroProblem,
};
use crate::problems::plate::{domain, tensor::dot};
use faer::{MatRef, Side};

/// A [`Modal`] as a [`System`]: what [`Dense`] does, faster. The Jacobian is assembled from tables, and gradients of
/// the direct projection's derivatives, as `F` is a gradient itself, are directional derivatives.
///
/// ```
/// use tangency::core::zero::System;
/// use tangency::problems::plate::modal::{Modal, ModalSettings, ModalSystem};
/// let plate = Modal::new(ModalSettings { modes: 1, ..ModalSettings::new("SSSS".parse()?) })?;
/// let at_rest = [vec![0.0], plate.defaults()].concat();
/// let mut plate = ModalSystem::new(plate);
/// plate.assemble(&at_rest)?;
/// let mut stiffness = [0.0];
/// plate.jacobian(&mut stiffness);
/// assert!((stiffness[0] / (4.0 * std::f64::consts::PI.powi(4)) - 1.0).abs() < 1e-8); // ω² = 4π⁴
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub struct ModalSystem {
    dense: Dense<Modal>,
    jacobian: Vec<f64>,
    factors: [BorderedLu; 2],
    directions: [Vec<f64>; 2],
    derivative: Vec<f64>,
}

impl ModalSystem {
    /// The system of a modal model.
    pub fn new(modal: Modal) -> Self {
        let dense = Dense::new(modal);
        let (n, length) = (dense.names().dimension(), dense.names().length());
        ModalSystem {
            dense,
            jacobian: vec![0.0; n * n],
            factors: Default::default(),
            directions: [vec![0.0; length], vec![0.0; length]],
            derivative: vec![0.0; n],
        }
    }

    /// The model itself.
    pub fn problem(&self) -> &Modal {
        self.dense.problem()
    }

    fn is_potential(&self) -> bool {
        self.dense.dynamics() == Dynamics::Potential
    }

    /// `∇(wᵀF_x v)` or `∇(wᵀF_xx[v, v])` of a gradient `F`: the unknowns' components are the mixed derivative
    /// along `w` and `v`.
    fn potential_gradient(
        &mut self,
        [x, w, v]: [&[f64]; 3],
        twice: bool,
        released: &[usize],
        out: &mut [f64],
    ) {
        let n = w.len();
        let [along, unit] = &mut self.directions;
        along.fill(0.0);
        along[..n].copy_from_slice(w);
        let dense = &mut self.dense;
        let mut mixed = |direction: &[f64], out: &mut [f64]| {
            if twice {
                dense.third_derivative(x, direction, v, v, out);
            } else {
                dense.second_derivative(x, direction, v, out);
            }
        };
        mixed(along, &mut out[..n]);
        for parameter in released {
            unit.fill(0.0);
            unit[n + parameter] = 1.0;
            mixed(unit, &mut self.derivative);
            out[n + parameter] = self.derivative.iter().zip(w).map(|(d, w)| d * w).sum();
        }
    }
}

impl System for ModalSystem {
    fn names(&self) -> &Names {
        self.dense.names()
    }

    fn residual(&mut self, x: &[f64], r: &mut [f64]) -> Result<(), LeftDomain> {
        self.dense.residual(x, r)
    }

    fn assemble(&mut self, x: &[f64]) -> Result<(), LeftDomain> {
        let (z, p) = x.split_at(self.names().dimension());
        let problem = self.dense.problem();
        problem.domain(z, p)?;
        problem.assemble(z, p, &mut self.jacobian);
        domain::finite(&self.jacobian, |_| "an entry of the stiffness".into())
    }

    fn factor(&mut self, slot: Slot, border: Border) -> Result<(), Singular> {
        self.factors[slot as usize].factor(&self.jacobian, border)
    }

    fn solve(&mut self, slot: Slot, right: &mut [f64]) {
        self.factors[slot as usize].solve(right);
    }

    fn solve_transposed(&mut self, slot: Slot, right: &mut [f64]) {
        self.factors[slot as usize].solve_transposed(right);
    }

    fn jacobian(&mut self, out: &mut [f64]) {
        out.copy_from_slice(&self.jacobian);
    }

    fn determinant_sign(&self, slot: Slot) -> f64 {
        self.factors[slot as usize].determinant_sign()
    }

    fn derivative(&mut self, x: &[f64], d: &[f64], out: &mut [f64]) {
        self.dense.derivative(x, d, out);
    }

    fn second_derivative(&mut self, x: &[f64], d: &[f64], e: &[f64], out: &mut [f64]) {
        self.dense.second_derivative(x, d, e, out);
    }

    fn third_derivative(&mut self, x: &[f64], d: &[f64], e: &[f64], f: &[f64], out: &mut [f64]) {
        self.dense.third_derivative(x, d, e, f, out);
    }

    fn gradient(&mut self, x: &[f64], w: &[f64], v: &[f64], released: &[usize], out: &mut [f64]) {
        if self.is_potential() {
            self.potential_gradient([x, w, v], false, released, out);
        } else {
            self.dense.gradient(x, w, v, released, out);
        }
    }

    fn second_gradient(
        &mut self,
        x: &[f64],
        w: &[f64],
        v: &[f64],
        released: &[usize],
        out: &mut [f64],
    ) {
        if self.is_potential() {
            self.potential_gradient([x, w, v], true, released, out);
        } else {
            self.dense.second_gradient(x, w, v, released, out);
        }
    }

    fn dynamics(&self) -> Dynamics {
        self.dense.dynamics()
    }

    fn spectrum(&mut self, _x: &[f64]) -> Option<Spectrum> {
        if !self.is_potential() {
            return None;
        }
        let n = self.names().dimension();
        let matrix = MatRef::from_column_major_slice(&self.jacobian, n, n);
        let hessian = matrix.self_adjoint_eigenvalues(Side::Lower).ok()?;
        Some(hessian.into_iter().map(|eigenvalue| (-eigenvalue, 0.0)).collect())
    }

    fn monitors(&mut self, x: &[f64], values: &mut [f64]) -> Result<(), LeftDomain> {
        self.dense.monitors(x, values)
    }

    fn monitor_gradient(&mut self, monitor: usize, x: &[f64], released: &[usize], out: &mut [f64]) {
        // Deflections are linear in the unknowns; only frequencies take dual numbers.
        let (z, p) = x.split_at(self.names().dimension());
        let problem = self.dense.problem();
        let at = match monitor {
            0 | 4 => [0.5, 0.5],
            1 => {
                let [_, x, y] = problem.largest(z);
                [x, y]
            }
            _ => return self.dense.monitor_gradient(monitor, x, released, out),
        };
        out.fill(0.0);
        let (of_z, of_p) = out.split_at_mut(z.len());
        problem.modes_at(at, of_z);
        if let (4, Some(gap)) = (monitor, self.names().parameter("gap")) {
            of_p[gap] = dot(z, of_z);
            of_z.iter_mut().for_each(|slope| *slope *= p[gap]);
        }
    }

    fn profiles(&mut self, x: &[f64]) -> Vec<Profile> {
        self.dense.profiles(x)
    }
}

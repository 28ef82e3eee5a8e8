//! Center manifolds of equilibria and orbits to any order, in complex coordinates.
//!
//! Let `σ_j` be the critical exponents, `q_j` the right and `p_j` the left eigenvectors. The center
//! manifold `z = z₀ + W(ξ)` and the motion `R` on the manifold satisfy
//!
//! ```text
//!     equilibria:  F(z₀ + W(ξ)) = M DW(ξ) R(ξ),                ξ' = R(ξ)
//!     orbits:      F(z₀ + W(ξ)) + K (W(R(ξ)) − W(ξ)) = 0,      ξ → R(ξ) in a period
//! ```
//!
//! where `K` selects the initial states in the closing condition: the next period begins at
//! `W(R(ξ))`. The equations for equilibria and for orbits have the common form `F + K Δ W = 0`,
//! with `K = −M` for equilibria, where `M` is the mass matrix. Deviations of equilibria change like
//! `e^{σt}`, and `L(σ) = F_z + σ K`; deviations of orbits change by the factor `e^σ` in a period, and `L(σ) = F_z + (e^σ − 1) K`.
//! The coefficients of each monomial `ξ^α` are computed order by order from
//!
//! ```text
//!     L(σ·α) W_α = −N_α − K D_α − Σ_j R_jα K q_j,
//! ```
//!
//! where `N_α` and `D_α` follow from terms already computed. The coefficient `R_jα` is zero unless
//! `σ·α = σ_j` (for orbits, modulo `2πi`). If `σ·α = σ_j`, `R_jα` is chosen such that the equation
//! is solvable, and `p_j* L' W_α = 0` (X. Cabré, E. Fontich and R. de la Llave, *J. Differential
//! Equations* 218:444, 2005; Yu. A. Kuznetsov and H. G. E. Meijer, *SIAM J. Sci. Comput.* 26:1932,
//! 2005). Only monomials with `e^{σ·α} = 1` change the period of an orbit: for all other monomials,
//! the period and the phase condition are omitted from `L`.
//!
//! The map `R` of orbits commutes with its linear part `R₁`; `R = R₁ exp(T V)` defines the rates `V`.

use super::eigenvalue::Eigenvalue;
use super::forms::{Forms, inner};
use super::polynomials::{
    Changes, Coefficients, ONE, Variable, ZERO, derivation, linear, logarithm, substitution,
};
use crate::core::failure::{Failure, one_line};
use crate::core::linalg::Form;
use crate::core::problem::Dynamics;
use crate::core::scalar::Space;
use faer::c64;
use std::f64::consts::{PI, TAU};

/// Rounding: critical exponents count as equal if their difference is less than this number, which
/// is a fraction of the largest exponent for equilibria, and an angle for orbits.
const SAME: f64 = 1e-9;

/// The motion on a center manifold.
pub(super) struct Motion {
    space: &'static Space,
    /// The rate per time of each variable, as a polynomial in all variables.
    rates: Vec<Coefficients>,
}

impl Motion {
    /// Returns the coefficient of a monomial in the rate of a variable. A real eigenvalue has one
    /// real variable, a complex pair has a complex variable and its conjugate, and a double
    /// eigenvalue has the two variables of a Jordan block.
    pub fn of(&self, variable: usize, exponents: &[u8]) -> c64 {
        self.space.position(exponents).map_or(ZERO, |k| self.rates[variable][k])
    }
}

/// The critical variables of an equilibrium or orbit.
struct Critical<'e> {
    eigenvalues: &'e mut [Eigenvalue],
    /// The index of the first variable of each eigenvalue.
    first: Vec<usize>,
    variables: Vec<Variable>,
    /// The frequency or angle `ω` of each variable.
    omegas: Vec<f64>,
    orbit: bool,
}

impl<'e> Critical<'e> {
    fn new(eigenvalues: &'e mut [Eigenvalue], orbit: bool) -> Self {
        let (mut first, mut variables, mut omegas) = (Vec::new(), Vec::new(), Vec::new());
        for eigenvalue in &*eigenvalues {
            first.push(variables.len());
            for variable in eigenvalue.variables() {
                let sign = if variable == Variable::Conjugate { -1.0 } else { 1.0 };
                omegas.push(sign * eigenvalue.omega());
                variables.push(variable);
            }
        }
        Critical { eigenvalues, first, variables, omegas, orbit }
    }

    /// The factor `c` in `L' = c K`; the linear part of the motion also multiplies each variable by
    /// this factor.
    fn multiplier(&self, omega: f64) -> c64 {
        if self.orbit { c64::new(omega.cos(), omega.sin()) } else { ONE }
    }

    /// Returns the linear terms of the motion and of the center manifold.
    fn linear(&self, space: &Space, n: usize) -> (Vec<Coefficients>, Vec<Vec<c64>>) {
        let mut manifold = vec![vec![ZERO; n]];
        let mut rates = Vec::new();
        for eigenvalue in &*self.eigenvalues {
            for vector in &eigenvalue.right {
                manifold.push(vector.clone());
            }
            if eigenvalue.variables().contains(&Variable::Conjugate) {
                manifold.push(conjugate(&eigenvalue.right[0]));
            }
            let first = rates.len();
            for k in first..first + eigenvalue.variables().len() {
                let multiplier = self.multiplier(self.omegas[k]);
                let own = if self.orbit { multiplier } else { c64::new(0.0, self.omegas[k]) };
                let mut terms = vec![(k, own)];
                // A Jordan block.
                if k + 1 < first + eigenvalue.right.len() {
                    terms.push((k + 1, multiplier));
                }
                rates.push(linear(space, &terms));
            }
        }
        (rates, manifold)
    }

    /// Computes the result of applying the operator `Δ`, without its diagonal part, to each
    /// monomial.
    fn advanced(&self, space: &Space, rates: &[Coefficients]) -> Vec<Coefficients> {
        let mut all = match self.orbit {
            true => substitution(space, rates),
            false => derivation(space, rates),
        };
        all.iter_mut().enumerate().for_each(|(k, image)| image[k] = ZERO);
        all
    }

    /// Returns the difference of two critical exponents; for multipliers, modulo `2π`.
    fn difference(&self, one: f64, other: f64) -> f64 {
        let difference = one - other;
        if self.orbit { difference - TAU * (difference / TAU).round() } else { difference }
    }

    /// The largest difference between two exponents that count as equal.
    fn rounding(&self) -> f64 {
        let largest = self.omegas.iter().fold(0.0, |most: f64, omega| most.max(omega.abs()));
        SAME * if self.orbit { 1.0 } else { largest }
    }

    /// The form of the linearisation for deviations with a given exponent.
    fn form_of(&self, omega: f64) -> Form {
        let (omega, near) = (self.difference(omega, 0.0), self.rounding());
        if omega.abs() <= near {
            Form::Jacobian
        } else if self.orbit && self.difference(omega, PI).abs() <= near {
            Form::Antiperiodic
        } else {
            Form::Oscillation(omega)
        }
    }

    /// Returns the eigenvalue and the variable with which a monomial of a given exponent resonates;
    /// for a Jordan block, its last variable.
    fn resonant(&self, omega: f64) -> Option<(usize, usize)> {
        let near = self.rounding();
        let ends = self.eigenvalues.iter().zip(&self.first).enumerate().flat_map(|(j, it)| {
            let (eigenvalue, first) = it;
            let last = first + eigenvalue.variables().len() - 1;
            let complex = self.variables[*first] == Variable::Complex;
            let start = if complex { *first } else { last };
            (start..=last).map(move |k| (j, k))
        });
        ends.into_iter().find(|(_, k)| self.difference(omega, self.omegas[*k]).abs() <= near)
    }

    /// Computes `W_α` and `R_jα` of a monomial that resonates with a variable of an eigenvalue.
    fn solve_resonant(
        &mut self,
        forms: &mut Forms,
        (j, k): (usize, usize),
        right: &[c64],
    ) -> Result<(Vec<c64>, c64), Failure> {
        let turned = self.variables[k] == Variable::Conjugate;
        let right = if turned { conjugate(right) } else { right.to_vec() };
        let eigenvalue = &mut self.eigenvalues[j];
        let last = eigenvalue.last().to_vec();
        let growth = eigenvalue.growth(forms, &last)?;
        // L' = μ K, p* L' q = −1.
        let rate = -inner(&eigenvalue.left, &right);
        let rest: Vec<c64> = right.iter().zip(&growth).map(|(r, g)| r - rate * g).collect();
        let mut w = eigenvalue.solve_within_border(forms, &rest)?;
        if eigenvalue.right.len() == 1 {
            let growth = eigenvalue.growth(forms, &w)?;
            let along = inner(&eigenvalue.left, &growth);
            w.iter_mut().zip(&last).for_each(|(w, q)| *w += along * q);
        }
        let omega = self.eigenvalues[j].omega();
        let rate = rate * self.multiplier(omega);
        Ok(if turned { (conjugate(&w), rate.conj()) } else { (w, rate) })
    }

    /// `K v`.
    fn returned(&mut self, forms: &mut Forms, v: &[c64]) -> Result<Vec<c64>, Failure> {
        let multiplier = self.multiplier(self.eigenvalues[0].omega());
        let growth = self.eigenvalues[0].growth(forms, v)?;
        Ok(growth.iter().map(|c| c / multiplier).collect())
    }
}

fn conjugate(v: &[c64]) -> Vec<c64> {
    v.iter().map(c64::conj).collect()
}

/// Computes the motion on the center manifold of the given eigenvalues, up to a given order.
///
/// # Errors
/// [`Failure`] if derivatives of the equations are not available to this order, or if a further
/// multiplier is critical.
pub(super) fn motion(
    forms: &mut Forms,
    eigenvalues: &mut [Eigenvalue],
    order: usize,
) -> Result<Motion, Failure> {
    let orbit = forms.at.system.dynamics() == Dynamics::Periodic;
    let mut critical = Critical::new(eigenvalues, orbit);
    let count = critical.variables.len();
    let of_order = |order: usize| {
        Space::of(count, order).map_err(|cause| Failure::Unsupported(one_line(&cause)))
    };
    let space = of_order(order)?;
    let (mut rates, mut manifold) = critical.linear(space, forms.n);
    for degree in 2..=order {
        let below = of_order(degree)?;
        manifold.resize(below.len(), vec![ZERO; forms.n]);
        add_degree(forms, &mut critical, (below, degree), &mut rates, &mut manifold)?;
    }
    if orbit {
        for (rate, omega) in rates.iter_mut().zip(&critical.omegas) {
            let multiplier = critical.multiplier(*omega);
            rate.iter_mut().for_each(|c| *c /= multiplier);
        }
        let period = forms.period()?;
        rates = logarithm(space, &rates);
        rates.iter_mut().flatten().for_each(|c| *c /= period);
    }
    Ok(Motion { space, rates })
}

/// Appends to the coefficients of the center manifold `W` the coefficients of the rates `DW(ξ) R(ξ)`
/// below the given degree. For a flow with a mass matrix that depends on `z`, the terms of the
/// degree itself are multiplied by the mass matrix of the equilibrium, and are treated separately.
fn with_rates(
    manifold: &[Vec<c64>],
    rates: &[Coefficients],
    (space, degree): (&Space, usize),
) -> Vec<Vec<c64>> {
    let images = derivation(space, rates);
    let highest = space.of_degree(degree);
    let rate = |monomial: usize| {
        let mut sum = vec![ZERO; manifold[monomial].len()];
        if !highest.contains(&monomial) {
            for (w, image) in manifold.iter().zip(&images) {
                sum.iter_mut().zip(w).for_each(|(sum, w)| *sum += image[monomial] * w);
            }
        }
        sum
    };
    (0..manifold.len()).map(|k| [&manifold[k][..], &rate(k)].concat()).collect()
}

/// Adds to the center manifold, and to the motion on it, the terms of the highest degree of a space
/// of polynomials.
fn add_degree(
    forms: &mut Forms,
    critical: &mut Critical,
    (space, degree): (&'static Space, usize),
    rates: &mut [Coefficients],
    manifold: &mut [Vec<c64>],
) -> Result<(), Failure> {
    let n = forms.n;
    let changes = Changes::new(space, &critical.variables);
    let known: Vec<Coefficients> = rates.iter().map(|rate| rate[..space.len()].to_vec()).collect();
    let moving = forms.at.system.dynamics() == Dynamics::Implicit;
    let terms = match moving {
        true => changes.to_real(&with_rates(manifold, &known, (space, degree)), 2 * n),
        false => changes.to_real(manifold, n),
    };
    let images = forms.expand(space, &terms)?;
    let images = changes.to_complex(&images, n);
    let advanced = critical.advanced(space, &known);
    for monomial in space.of_degree(degree) {
        // Terms of the same degree that Jordan blocks mix in come first in the space.
        let mut carried = vec![ZERO; n];
        for (w, image) in manifold[..monomial].iter().zip(&advanced) {
            let factor = image[monomial];
            if factor != ZERO {
                carried.iter_mut().zip(w).for_each(|(sum, w)| *sum += factor * w);
            }
        }
        let carried = critical.returned(forms, &carried)?;
        let right: Vec<c64> =
            images[monomial].iter().zip(&carried).map(|(f, d)| -(f + d)).collect();
        let exponents = space.exponents(monomial).iter();
        let omega = exponents.zip(&critical.omegas).map(|(k, omega)| f64::from(*k) * omega).sum();
        match critical.resonant(omega) {
            Some((j, k)) => {
                let (w, rate) = critical.solve_resonant(forms, (j, k), &right)?;
                manifold[monomial] = w;
                rates[k][monomial] = rate;
            }
            None => manifold[monomial] = forms.solve_with(critical.form_of(omega), &right)?,
        }
    }
    Ok(())
}

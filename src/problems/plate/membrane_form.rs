//! Quantities of the full plate model that are needed to reduce the model to a few shapes of the
//! deflection: fields at nodes, and the stretching energy as a quartic form of the amplitudes of
//! the shapes.

use super::domain;
use super::error::PlateError;
use super::parameters::Units;
use super::ritz::Ritz;
use super::tensor::{Product, Rule, weights};
use crate::core::failure::Failure;

/// A deflection and its slopes with respect to `ξ = 2x − 1` and `ζ = 2y − 1` at the nodes of a
/// grid; node `(p, q)` has the position `p·m_y + q`.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Field {
    /// `w`.
    pub value: Vec<f64>,
    /// `w_ξ`, `w_ζ`.
    pub slopes: [Vec<f64>; 2],
}

/// The stretching energy of a deflection `w = Σ a_i φ_i` that is a sum of shapes, after elimination
/// of the in-plane displacements:
///
/// ```text
/// U = 6α₁² Σ_ij Σ_kl a_i a_j A_(ij)(kl) a_k a_l,    A_(ij)(kl) = ⟨ε_ij : C : ε_kl⟩ − B_ijᵀ K_uv⁻¹ B_kl
/// ```
///
/// Here `ε_ij = ½ sym(∇φ_i ⊗ ∇φ_j)`, and `⟨·⟩` is the mean over the plate. The sums run over all
/// ordered pairs of shapes, but only pairs with `i ≤ j` are stored, so a stored pair with `i < j`
/// counts twice.
#[derive(Clone, Debug)]
pub struct MembraneForm {
    /// The pairs of shapes `(i, j)`, `i ≤ j`.
    pub pairs: Vec<(usize, usize)>,
    /// The symmetric matrix `A`, stored row by row; its rows and columns belong to pairs of shapes.
    pub quartic: Vec<f64>,
    /// The quadrature rules along ξ and ζ whose nodes are the points at which the stresses are
    /// given.
    pub rules: [Rule; 2],
    /// The stresses `N₁`, `N₂`, `N₆` of each pair of shapes at the nodes (node `(p, q)` at `p·m_y +
    /// q`), in equilibrium in the plane, in units of `Eh/(1−ν²)·d²/a²`: the stresses of `w` are
    /// `Σ_ij a_i a_j N_ij`.
    pub stress: Vec<[Vec<f64>; 3]>,
}

impl Ritz {
    /// Evaluates the deflection with coefficients `q` (the unknowns of a solution, or the
    /// coefficients of a mode) and its slopes at a grid of `nodes` in ξ and in ζ, each in `[−1,
    /// 1]`.
    pub(super) fn field(&self, q: &[f64], nodes: [&[f64]; 2]) -> Field {
        let model = &self.model;
        let [x, y] = [0, 1].map(|axis| model.transverse[axis].table(nodes[axis]));
        let coefficients: Vec<f64> = q.iter().zip(&model.scale).map(|(q, d)| q * d).collect();
        let points = nodes.map(<[f64]>::len);
        let mut half = Vec::new();
        let mut expand = |x: &[f64], y: &[f64]| {
            let mut field = vec![0.0; points[0] * points[1]];
            Product { x, y, points }.expand(&coefficients, &mut half, &mut field);
            field
        };
        Field {
            value: expand(&x.values, &y.values),
            slopes: [expand(&x.slopes, &y.values), expand(&x.values, &y.slopes)],
        }
    }

    /// Computes the stretching energy of all deflections spanned by `shapes` (given by
    /// coefficients, for example the [`flat_modes`](Ritz::flat_modes)) for the given `α` and `ν`.
    ///
    /// # Errors
    /// [`PlateError`] if `α` or `ν` is out of range, or the plate model does not include
    /// stretching.
    pub fn membrane_form(
        &mut self,
        shapes: &[Vec<f64>],
        alpha: f64,
        nu: f64,
    ) -> Result<MembraneForm, PlateError> {
        let p = Units::Dimensionless.defaults_at(alpha, nu);
        let parameters = domain::parameters(Units::Dimensionless, &p).map_err(Failure::from)?;
        let Some(membrane) = &self.model.membrane else { return Err(PlateError::NoMembrane) };
        if !self.factor.update(&self.model.plane, alpha, nu) {
            return Err(PlateError::NoMembrane);
        }
        let rules = membrane.rules.clone();
        let pairs: Vec<(usize, usize)> =
            (0..shapes.len()).flat_map(|i| (i..shapes.len()).map(move |j| (i, j))).collect();
        // N is quadratic in w: N(φ_i, φ_j) = ¼[N(φ_i + φ_j) − N(φ_i − φ_j)].
        let mut stress_of = |i: usize, j: usize, sign: f64| {
            let sum = shapes[i].iter().zip(&shapes[j]).zip(&self.model.scale);
            for (q, ((first, second), scale)) in self.plain.q.iter_mut().zip(sum) {
                *q = (first + sign * second) * scale;
            }
            self.plain.solve_plane(&self.model, membrane, &self.factor, &parameters, 1);
            self.plain.stress.clone()
        };
        let stress: Vec<[Vec<f64>; 3]> = pairs
            .iter()
            .map(|(i, j)| {
                let (mut sum, difference) = (stress_of(*i, *j, 1.0), stress_of(*i, *j, -1.0));
                for (sum, difference) in sum.iter_mut().zip(&difference) {
                    sum.iter_mut().zip(difference).for_each(|(a, b)| *a = 0.25 * (*a - b));
                }
                sum
            })
            .collect();
        let weights: Vec<f64> = weights(&membrane.rules).collect();
        let nodes = [&rules[0].nodes[..], &rules[1].nodes];
        let slopes: Vec<[Vec<f64>; 2]> =
            shapes.iter().map(|shape| self.field(shape, nodes).slopes).collect();
        let mut quartic = vec![0.0; pairs.len() * pairs.len()];
        for (row, (i, j)) in pairs.iter().enumerate() {
            let strain = pair_strain(&slopes[*i], &slopes[*j], 2.0 / alpha);
            for (column, stress) in stress.iter().enumerate() {
                let products = (0..weights.len())
                    .map(|k| weights[k] * (0..3).map(|c| strain[c][k] * stress[c][k]).sum::<f64>());
                quartic[row * pairs.len() + column] = products.sum();
            }
        }
        Ok(MembraneForm { pairs, quartic, rules, stress })
    }
}

/// Computes the strains `½ sym(∇φ_i ⊗ ∇φ_j)` with the components `e₁`, `e₂`, `γ`.
fn pair_strain(first: &[Vec<f64>; 2], second: &[Vec<f64>; 2], along: f64) -> [Vec<f64>; 3] {
    let field = |value: &dyn Fn(usize) -> f64| (0..first[0].len()).map(value).collect();
    [
        field(&|k| 2.0 * first[0][k] * second[0][k]),
        field(&|k| 0.5 * along * along * first[1][k] * second[1][k]),
        field(&|k| along * (first[0][k] * second[1][k] + first[1][k] * second[0][k])),
    ]
}

//! The two projections of the equation of motion on the modes.

use super::membrane;
use super::settings::ModalSettings;
use super::spectrum::FlatModes;
use super::tables::{Nodes, at};
use crate::core::scalar::Scalar;
use crate::problems::plate::discretisation::LARGEST_DEFLECTION;
use crate::problems::plate::edges::Support;
use crate::problems::plate::error::PlateError;
use crate::problems::plate::membrane_form::MembraneForm;
use crate::problems::plate::parameters::Parameters;
use crate::problems::plate::tensor::{Rule, dot};
use crate::problems::plate::terms::Theory;

/// Pairs of numbers: a largest deflection, and the number of quadrature nodes in each half
/// direction with which the load is accurate up to this deflection. For each half wave of the
/// highest mode, further nodes are added, because the highest mode is a factor of the integrand;
/// the deflection itself consists mostly of the lowest mode. The numbers of nodes are sufficient:
/// twenty more nodes change loads at pull-in only beyond the ninth digit.
const LOAD_NODES: [(f64, usize); 4] = [(0.5, 16), (0.75, 24), (0.88, 32), (LARGEST_DEFLECTION, 48)];
const LOAD_NODES_PER_WAVE: f64 = 0.8;

/// The tables that both projections of the equations use.
pub(super) struct Linear {
    /// `ω_i²`.
    pub squares: Vec<f64>,
    /// `⟨φ_i⟩`.
    pub means: Vec<f64>,
    /// The means `⟨φ_ix φ_kx⟩`, `⟨φ_iy φ_ky⟩` and `⟨φ_ix φ_ky + φ_iy φ_kx⟩` of products of slopes
    /// of the modes.
    pub slopes: [Vec<f64>; 3],
    /// For each of the three edge forces (along x, along y, in shear): 1 if the plate carries the
    /// force, 0 if a free edge excludes it.
    carried: [f64; 3],
}

/// `r_i = ∂Π/∂q_i`.
pub(super) struct Direct {
    /// The matrix `A_PQ` of the stretching energy; `None` in the linear theory of plates.
    pub(super) form: Option<Vec<f64>>,
    /// The quadrature rules for the load, each with the largest deflection at which it is accurate.
    pub(super) loads: [(f64, Nodes); LOAD_NODES.len()],
}

/// The multiplied projection `r_i = ⟨φ_i (1−w)² · equation⟩`.
pub(super) struct Multiplied {
    pub(super) nodes: Nodes,
    /// The stresses `N₁`, `N₂`, `N₆` of all pairs of modes, node by node; `None` in the linear
    /// theory of plates.
    pub(super) stress: Option<[Vec<f64>; 3]>,
}

/// Returns the stretching energy of the modes; `None` in the linear theory of plates.
fn membrane_form(
    settings: &ModalSettings,
    flat: &mut FlatModes,
) -> Result<Option<MembraneForm>, PlateError> {
    if settings.plate.theory == Theory::Linear {
        return Ok(None);
    }
    Ok(Some(flat.plate.membrane_form(&flat.shapes, settings.plate.aspect, settings.nu)?))
}

impl Linear {
    pub fn new(settings: &ModalSettings, flat: &FlatModes) -> Linear {
        let FlatModes { plate, shapes, .. } = flat;
        let nodes = Nodes::new(plate, shapes, &plate.model.product_rules(), settings.plate.aspect);
        let count = shapes.len();
        let [x, y] = &nodes.slopes;
        let mixed = nodes.gram(x, y);
        let both = (0..count * count).map(|e| mixed[e] + mixed[e % count * count + e / count]);
        let supports = settings.plate.supports;
        // With symmetry, a sheared plate is rejected; see `domain`.
        let sheared = !supports.any_free() && plate.model.symmetric == [false; 2];
        let carried = [
            !supports.x().contains(&Support::Free),
            !supports.y().contains(&Support::Free),
            sheared,
        ]
        .map(|carried| f64::from(u8::from(carried)));
        let means = (0..count).map(|i| {
            let values = nodes.values.chunks_exact(count).zip(&nodes.weights);
            values.map(|(values, weight)| values[i] * weight).sum()
        });
        let slopes = [nodes.gram(x, x), nodes.gram(y, y), both.collect()];
        Linear { squares: flat.squares.clone(), means: means.collect(), slopes, carried }
    }

    /// Returns the applied edge forces that the plate carries: along x, along y, and in shear.
    pub(super) fn forces<T: Scalar>(&self, plate: &Parameters<T>) -> [T; 3] {
        let [x, y, shear] = self.carried;
        [plate.compression_x * x, plate.compression_y * y, plate.shear * shear]
    }
}

impl Direct {
    pub fn new(settings: &ModalSettings, flat: &mut FlatModes) -> Result<Direct, PlateError> {
        let form = membrane_form(settings, flat)?.map(|form| form.quartic);
        let loads = LOAD_NODES.map(|(largest, base)| {
            let rules = halves(settings, flat, base, LOAD_NODES_PER_WAVE);
            (largest, Nodes::new(&flat.plate, &flat.shapes, &rules, settings.plate.aspect))
        });
        Ok(Direct { form, loads })
    }

    /// Computes the residual
    ///
    /// ```text
    /// r_i = ω_i² q_i + ∂U_m/∂q_i − Σ_k (P_x⟨φ_ix φ_kx⟩ + …) q_k − λ⟨φ_i/(1−w)²⟩ − P⟨φ_i⟩
    /// ```
    pub fn residual<T: Scalar>(
        &self,
        linear: &Linear,
        q: &[T],
        plate: &Parameters<T>,
        largest: f64,
        r: &mut [T],
    ) {
        let n = q.len();
        let forces = linear.forces(plate);
        for i in 0..n {
            r[i] = q[i] * linear.squares[i] - plate.pressure * linear.means[i];
            for (force, matrix) in forces.iter().zip(&linear.slopes) {
                if force.real() != 0.0 || T::NDERIV > 0 {
                    r[i] -= *force * dot(q, &matrix[i * n..(i + 1) * n]);
                }
            }
        }
        if let Some(form) = &self.form {
            membrane::add_force(form, q, plate.gap_ratio * plate.gap_ratio * 24.0, r);
        }
        let nodes = self.load_nodes(largest);
        for (values, weight) in nodes.values.chunks_exact(n).zip(&nodes.weights) {
            let closeness = (T::one() - dot(q, values)).recip();
            let load = plate.load * closeness * closeness * *weight;
            for (r, value) in r.iter_mut().zip(values) {
                *r -= load * *value;
            }
        }
    }

    /// Returns the quadrature nodes with which the load is accurate if the largest deflection is at
    /// most `largest`.
    pub(super) fn load_nodes(&self, largest: f64) -> &Nodes {
        let good = self.loads.iter().find(|(good, _)| largest <= *good);
        &good.unwrap_or(&self.loads[self.loads.len() - 1]).1
    }
}

impl Multiplied {
    pub fn new(settings: &ModalSettings, flat: &mut FlatModes) -> Result<Multiplied, PlateError> {
        // Integrands are products of six modes or slopes. The rule for products of four suffices,
        // because it is designed for the polynomials' degrees, twice those that the modes need.
        let (rules, stress) = match membrane_form(settings, flat)? {
            Some(form) => {
                let nodes = form.rules[0].len() * form.rules[1].len();
                let by_node = |component: usize| -> Vec<f64> {
                    let row = |node| form.stress.iter().map(move |fields| fields[component][node]);
                    (0..nodes).flat_map(row).collect()
                };
                let stress = [by_node(0), by_node(1), by_node(2)];
                (form.rules, Some(stress))
            }
            None => (flat.plate.model.load_rule(0.5).rules.clone(), None),
        };
        let nodes = Nodes::new(&flat.plate, &flat.shapes, &rules, settings.plate.aspect);
        Ok(Multiplied { nodes, stress })
    }

    /// Computes the residual from `L(w) = Σ ω_k² q_k φ_k` (exact for flat modes at every point) and
    /// the total resultant `S = 12α₁² N ∇w − P∇w`, whose divergence is the lateral force:
    ///
    /// ```text
    /// r_i = ⟨φ_i {(1−w)² [L(w) − pressure] − λ} + S·∇[φ_i (1−w)²]⟩
    /// ```
    ///
    /// The last term of the residual is integrated by parts; boundary terms vanish because `φ_i`
    /// vanishes at edges that carry a force. This form of the residual contains no second
    /// derivatives, and requires the stresses to be in equilibrium in the plane only in the mean.
    pub fn residual<T: Scalar>(
        &self,
        linear: &Linear,
        q: &[T],
        plate: &Parameters<T>,
        r: &mut [T],
    ) {
        let n = q.len();
        let forces = linear.forces(plate);
        let stiffness = plate.gap_ratio * plate.gap_ratio * 12.0;
        let mut pairs = membrane::products(q);
        pairs.iter_mut().for_each(|pair| *pair *= stiffness);
        let bending: Vec<T> =
            q.iter().zip(&linear.squares).map(|(q, square)| *q * *square).collect();
        for (r, mean) in r.iter_mut().zip(&linear.means) {
            *r = -plate.load * *mean;
        }
        for (node, weight) in self.nodes.weights.iter().enumerate() {
            let [values, slopes_x, slopes_y] = self.modes_at(node, n);
            let [n1, n2, n6] = match &self.stress {
                Some(stress) => {
                    stress.each_ref().map(|rows| dot(&pairs, at(rows, node, pairs.len())))
                }
                None => [T::zero(); 3],
            };
            let [w, w_x, w_y] = [values, slopes_x, slopes_y].map(|table| dot(q, table));
            let local = [w, w_x, w_y, dot(&bending, values), n1, n2, n6];
            let parts = integrand(local, forces, plate.pressure).map(|part| part * *weight);
            for (i, r) in r.iter_mut().enumerate() {
                *r += parts[0] * values[i] + parts[1] * slopes_x[i] + parts[2] * slopes_y[i];
            }
        }
    }

    /// Returns the values `φ_i` and the slopes `φ_ix`, `φ_iy` of all modes at a node.
    pub(super) fn modes_at(&self, node: usize, modes: usize) -> [&[f64]; 3] {
        [&self.nodes.values, &self.nodes.slopes[0], &self.nodes.slopes[1]]
            .map(|rows| at(rows, node, modes))
    }

    /// Returns `⟨(1−w)² φ_l φ_r⟩`, the inertia of the multiplied equations, for two linear
    /// combinations `φ_l`, `φ_r` of modes.
    pub fn inertia<T: Scalar>(&self, q: &[T], left: &[f64], right: &[f64]) -> T {
        let mut total = T::zero();
        for (values, weight) in self.nodes.values.chunks_exact(q.len()).zip(&self.nodes.weights) {
            let gap = T::one() - dot(q, values);
            let [left, right] = [left, right].map(|field| dot(field, values));
            total += gap * gap * (left * right * weight);
        }
        total
    }

    /// Returns the matrix of the bilinear form that [`inertia`](Self::inertia) evaluates.
    pub fn mass(&self, q: &[f64]) -> nalgebra::DMatrix<f64> {
        let n = q.len();
        let mut matrix = nalgebra::DMatrix::zeros(n, n);
        for (values, weight) in self.nodes.values.chunks_exact(n).zip(&self.nodes.weights) {
            let factor = weight * (1.0 - dot(q, values)).powi(2);
            for i in 0..n {
                for k in 0..n {
                    matrix[(i, k)] += factor * values[i] * values[k];
                }
            }
        }
        matrix
    }
}

/// Returns the factors of `φ_i`, `φ_ix`, `φ_iy` in the integrand of the multiplied projection
/// (without the constant load), given `[w, w_x, w_y, L(w), 12α₁²N₁, 12α₁²N₂, 12α₁²N₆]` at a point,
/// the applied forces and the pressure.
pub(super) fn integrand<T: Scalar>(local: [T; 7], forces: [T; 3], pressure: T) -> [T; 3] {
    let [w, w_x, w_y, bending, n1, n2, n6] = local;
    let [compression_x, compression_y, shear] = forces;
    let force_x = (n1 - compression_x) * w_x + (n6 - shear) * w_y;
    let force_y = (n2 - compression_y) * w_y + (n6 - shear) * w_x;
    let gap = T::one() - w;
    let gap_squared = gap * gap;
    let along = (force_x * w_x + force_y * w_y) * gap * 2.0;
    [gap_squared * (bending - pressure) - along, gap_squared * force_x, gap_squared * force_y]
}

/// Returns quadrature rules with `base` nodes in each half direction and `per_wave` additional
/// nodes for each half wave of the highest mode along a whole side; the number of half waves is
/// estimated from `ω = k²` for a mode of wave number `k`.
fn halves(settings: &ModalSettings, flat: &FlatModes, base: usize, per_wave: f64) -> [Rule; 2] {
    let symmetric = flat.plate.model.symmetric;
    let highest = flat.squares.last().map_or(0.0, |square| square.max(0.0).sqrt().sqrt());
    let sides = [1.0, settings.plate.aspect];
    [0, 1].map(|axis| {
        let more = (per_wave * highest * sides[axis] / std::f64::consts::PI).ceil() as usize;
        Rule::halves(base + more, symmetric[axis])
    })
}

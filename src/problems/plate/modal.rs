//! The modal reduced-order model of section 3.3: a plate in its own flat modes.
//!
//! With `w = Σ q_i φ_i`, where `φ_i` are the lowest modes of the flat plate without loads, of mean square
//! 1 over the plate, the potential energy per area is
//!
//! ```text
//! Π = ½ Σ ω_i² q_i² + 6α₁² Σ A_(ij)(kl) q_i q_j q_k q_l − ½⟨P : ∇w∇w⟩ − λ⟨1/(1−w)⟩ − P⟨w⟩
//! ```
//!
//! The in-plane displacements are condensed once into the form `A`, for any supports and any edges in
//! the plane: no stress function is needed, and a state costs some microseconds. What is lost are the higher modes:
//! `N` modes give the load at pull-in of a clamped plate within 0.3 % (`N = 1`), 0.01 % (7).
//!
//! The modes and `A` belong to one aspect ratio and one Poisson's ratio. To vary these, use the full
//! model, [`Ritz`].

mod assembly;
mod error;
mod membrane;
mod projection;
mod spectrum;
mod system;
mod tables;
mod vibration;

pub use error::ModalError;
pub use system::ModalSystem;

use super::discretisation::LARGEST_DEFLECTION;
use super::shape::{self, Search};
use super::tensor::{Rule, dot};
use super::vibration::{Vibrates, reals, signed_root};
use super::{
    Orders, Parameters, Projection, Ritz, RitzSettings, Supports, domain, monitors, profile,
};
use crate::core::scalar::Scalar;
use crate::core::zero::{Dynamics, LeftDomain, Names, Profile, ZeroProblem};
use projection::{Direct, Linear, Multiplied};
use spectrum::FlatModes;

/// The largest number of modes: `A` has some N⁴/4 entries.
pub const MOST_MODES: usize = 40;

/// How far `α` and `ν` may be from those of the modes, relatively: rounding of `b/a`.
const SAME: f64 = 1e-12;

/// What a [`Modal`] is made from.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ModalSettings {
    /// Supports, edges in the plane, theory, units, symmetry, and the aspect ratio of the plate, which is
    /// fixed. Without `orders` as many functions are taken as the modes need.
    pub plate: RitzSettings,
    /// Poisson's ratio of the plate, fixed as well.
    pub nu: f64,
    /// The number of modes, 1 to [`MOST_MODES`]: the lowest ones, of those that share the symmetry.
    pub modes: usize,
    /// Which projection.
    pub projection: Projection,
    /// The relative error allowed in each mode's `ω²`, 1e-12 to 0.1.
    pub mode_accuracy: f64,
}

impl ModalSettings {
    /// Eight modes of a square plate with `ν = 0.3`, in the direct projection, accurate to 1e-8, or to 1e-4
    /// if some edge is free: where it meets a clamped one, or another free one, the modes have
    /// singularities that polynomials approach slowly.
    pub fn new(supports: Supports) -> ModalSettings {
        ModalSettings {
            plate: RitzSettings::new(supports),
            nu: 0.3,
            modes: 8,
            projection: Projection::Direct,
            mode_accuracy: if supports.any_free() { 1e-4 } else { 1e-8 },
        }
    }
}

/// A plate in `N` of its flat modes.
///
/// A [`ZeroProblem`] with the unknowns `w` (the `N` coefficients `q_i`, deflection over gap), the
/// parameters of [`Units`](super::Units) and the monitors of [all plates](super#monitors). With [`Projection::Direct`] the residual is the
/// gradient of `Π`, and the mass matrix is the identity. With [`Projection::Multiplied`], the source's
/// method, the equation is multiplied by `(1−w)²` before it is projected.
///
/// [`ModalSystem`] is the faster of its two faces for the stepper; [`Dense`](crate::core::dense::Dense) is the other.
///
/// The monitors' first derivatives are exact; second derivatives of the two frequencies leave out
/// that the mode of vibration changes.
///
/// ```
/// use tangency::core::continuation::{Continuation, Kind};
/// use tangency::problems::plate::modal::{Modal, ModalSettings, ModalSystem};
/// let one_mode = ModalSettings { modes: 1, ..ModalSettings::new("CCCC".parse()?) };
/// let plate = Modal::new(one_mode)?;
/// assert!((plate.frequencies()[0] - 35.985191115).abs() < 1e-6);
/// let branch = Continuation::of(&mut ModalSystem::new(plate))
///     .at("aspect", 1.0)
///     .at("nu", 0.3)
///     .at("gap_ratio", 1.0)
///     .along("load", 0.0..=400.0)
///     .bound("max_deflection", 0.0..=0.9)
///     .trace()?;
/// let pull_in = branch.of_kind(Kind::LP).next().map(|fold| fold.parameters[0]);
/// assert!((pull_in.unwrap_or_default() - 191.3655).abs() < 1e-4); // 191.9151 with all modes
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub struct Modal {
    settings: ModalSettings,
    plate: Ritz,
    /// Coefficients of the modes in the unknowns of `plate`.
    shapes: Vec<Vec<f64>>,
    linear: Linear,
    projected: Projected,
    grid: Grid,
}

enum Projected {
    Direct(Box<Direct>),
    Multiplied(Multiplied),
}

/// Modes on a grid of points, on which the largest deflection is looked for.
struct Grid {
    points: Vec<[f64; 2]>,
    /// All modes of one point after the other.
    values: Vec<f64>,
}

impl Modal {
    /// Finds the flat plate's modes and condenses its response in the plane.
    ///
    /// # Errors
    /// [`ModalError`] for a number of modes or an accuracy out of range, for modes that do not
    /// meet the accuracy, and for a plate that cannot be set up.
    pub fn new(settings: ModalSettings) -> Result<Modal, ModalError> {
        let (modes, accuracy) = (settings.modes, settings.mode_accuracy);
        if !(1..=MOST_MODES).contains(&modes) {
            return Err(ModalError::Modes { modes, most: MOST_MODES });
        }
        if !(1e-12..=0.1).contains(&accuracy) {
            return Err(ModalError::AccuracyRange { accuracy });
        }
        let mut flat = FlatModes::new(&settings)?;
        let linear = Linear::new(&settings, &flat);
        let projected = match settings.projection {
            Projection::Direct => Projected::Direct(Box::new(Direct::new(&settings, &mut flat)?)),
            Projection::Multiplied => Projected::Multiplied(Multiplied::new(&settings, &mut flat)?),
        };
        let grid = Grid::new(&flat, settings.plate.aspect);
        let FlatModes { plate, shapes, .. } = flat;
        Ok(Modal { settings, plate, shapes, linear, projected, grid })
    }

    /// What the model was made from.
    pub fn settings(&self) -> &ModalSettings {
        &self.settings
    }

    /// The numbers of functions that the modes are combinations of, and of in-plane functions.
    pub fn orders(&self) -> Orders {
        self.plate.orders()
    }

    /// `ω_i a²√(ρh/D)` of the modes of the flat plate, ascending.
    pub fn frequencies(&self) -> Vec<f64> {
        self.linear.squares.iter().map(|square| signed_root(*square)).collect()
    }

    /// Default values of the parameters, at the aspect ratio and Poisson's ratio of the modes (of a
    /// device, the width is adapted).
    pub fn defaults(&self) -> Vec<f64> {
        let ModalSettings { plate, nu, .. } = self.settings;
        plate.units.defaults_at(plate.aspect, nu)
    }

    /// `Σ z_i φ_i`, the deflection over the gap that coefficients `z` (a solution's unknowns, or a
    /// mode's) describe, at a point of the plate: `x` and `y` from 0 to 1 along the sides.
    ///
    /// ```
    /// use tangency::problems::plate::modal::{Modal, ModalSettings};
    /// let plate = Modal::new(ModalSettings { modes: 1, ..ModalSettings::new("SSSS".parse()?) })?;
    /// // φ = 2 sin πx sin πy has mean square 1.
    /// assert!((plate.deflection(&[0.1], 0.5, 1.0 / 6.0) - 0.1_f64).abs() < 1e-6);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn deflection<T: Scalar>(&self, z: &[T], x: f64, y: f64) -> T {
        let mut values = vec![0.0; self.shapes.len()];
        self.modes_at([x, y], &mut values);
        dot(z, &values)
    }

    /// `φ_i` of all modes at a point.
    fn modes_at(&self, [x, y]: [f64; 2], out: &mut [f64]) {
        let mut products = vec![0.0; self.plate.model.unknowns()];
        let at = [2.0 * x - 1.0, 2.0 * y - 1.0];
        shape::products(&self.plate.model, at, &mut Default::default(), &mut products);
        for (out, shape) in out.iter_mut().zip(&self.shapes) {
            *out = dot(shape, &products);
        }
    }

    /// The deflection along the centre line `y = ½` at `points ≥ 2` equidistant points: pairs `(x, w)`.
    pub fn centre_line(&self, z: &[f64], points: usize) -> Vec<(f64, f64)> {
        self.plate.centre_line(&self.coefficients(z), points)
    }

    /// `Σ z_i φ_i` in the unknowns of the plate that the modes are taken from.
    fn coefficients(&self, z: &[f64]) -> Vec<f64> {
        let mut sum = vec![0.0; self.plate.model.unknowns()];
        for (shape, z) in self.shapes.iter().zip(z) {
            sum.iter_mut().zip(shape).for_each(|(sum, c)| *sum += z * c);
        }
        sum
    }

    fn parameters<T: Scalar>(&self, p: &[T]) -> Parameters<T> {
        self.settings.plate.units.parameters(p)
    }

    /// The largest deflection and where it is, along the sides from 0 to 1.
    fn largest(&self, z: &[f64]) -> [f64; 3] {
        let (best, [xi, zeta]) = self.grid.largest(z);
        let model = &self.plate.model;
        let held = model.symmetric;
        let (w, xi, zeta) = if best.is_nan() || (held == [true; 2] && xi == 0.0 && zeta == 0.0) {
            (best, xi, zeta)
        } else {
            Search::new(model).largest(model, &self.coefficients(z))
        };
        [w, 0.5 + 0.5 * xi, 0.5 + 0.5 * zeta]
    }

    /// Refuses parameters without meaning, or other than those of the modes.
    fn check_parameters(&self, p: &[f64]) -> Result<(), LeftDomain> {
        let settings = &self.settings;
        let plate = domain::parameters(settings.plate.units, p)?;
        let fixed =
            [("aspect", plate.aspect, settings.plate.aspect), ("nu", plate.nu, settings.nu)];
        for (name, value, of_modes) in fixed {
            if (value - of_modes).abs() > SAME * of_modes.abs() {
                let remedy = format!(
                    "the modes belong to {of_modes}; hold it there, make the modal model anew, or use \
                     the full model to vary it"
                );
                return Err(LeftDomain::new(name, value, remedy));
            }
        }
        self.plate.model.check_shear(plate.shear)
    }
}

impl Grid {
    fn new(flat: &FlatModes, aspect: f64) -> Grid {
        let nodes = flat.plate.model.symmetric.map(shape::search_nodes);
        let rules = nodes.clone().map(|nodes| {
            let weights = vec![0.0; nodes.len()];
            Rule { nodes, weights }
        });
        let values = tables::Nodes::new(&flat.plate, &flat.shapes, &rules, aspect).values;
        let points = nodes[0].iter().flat_map(|x| nodes[1].iter().map(|y| [*x, *y])).collect();
        Grid { points, values }
    }

    /// The largest deflection on the grid and its `ξ`, `ζ`; not a number if any is not.
    fn largest(&self, z: &[f64]) -> (f64, [f64; 2]) {
        let mut best = (f64::NEG_INFINITY, [0.0; 2]);
        for (point, values) in self.points.iter().zip(self.values.chunks_exact(z.len())) {
            let w = dot(z, values);
            if w.is_nan() {
                return (w, *point);
            }
            if w > best.0 {
                best = (w, *point);
            }
        }
        best
    }
}

impl ZeroProblem for Modal {
    fn names(&self) -> Names {
        monitors::names(self.settings.plate.units, self.shapes.len())
    }

    fn residual<T: Scalar>(&self, z: &[T], p: &[T], r: &mut [T]) {
        let plate = self.parameters(p);
        match &self.projected {
            Projected::Direct(direct) => {
                let largest = self.grid.largest(&reals(z)).0;
                direct.residual(&self.linear, z, &plate, largest, r);
            }
            Projected::Multiplied(multiplied) => multiplied.residual(&self.linear, z, &plate, r),
        }
    }

    fn monitors<T: Scalar>(&self, z: &[T], p: &[T], values: &mut [T]) {
        let [_, x, y] = self.largest(&reals(z));
        let deflections = [self.deflection(z, 0.5, 0.5), self.deflection(z, x, y)];
        let flat = T::constant(signed_root(self.linear.squares[0]));
        let frequencies = [self.frequency(z, p), flat];
        monitors::fill(self.settings.plate.units, p, deflections, frequencies, values);
    }

    fn domain(&self, z: &[f64], p: &[f64]) -> Result<(), LeftDomain> {
        self.check_parameters(p)?;
        // Polynomials need no limit but contact; the load is integrated to ten digits up to the other.
        let limit = match self.settings.projection {
            Projection::Direct => LARGEST_DEFLECTION,
            Projection::Multiplied => 1.0,
        };
        domain::clear(self.grid.largest(z).0, limit)
    }

    fn dynamics(&self) -> Dynamics {
        self.settings.projection.dynamics()
    }

    /// The deflection and the first mode shape along the centre line.
    fn profiles(&self, z: &[f64], p: &[f64]) -> Vec<Profile> {
        profile::with_lowest_mode(self, z, p, |z, x| self.deflection(z, x, 0.5))
    }
}

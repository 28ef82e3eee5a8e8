//! The full Ritz model of an electrostatically actuated von Kármán plate.

use super::assembly::Assembly;
use super::discretisation::{Discretisation, LARGEST_DEFLECTION, RitzSettings};
use super::error::PlateError;
use super::modes::{Eigenproblem, Modes};
use super::orders::Orders;
use super::parameters::Units;
use super::plane::PlaneFactor;
use super::residual::Workspace;
use super::shape::{self, Search};
use super::{domain, monitors, profile};
use crate::core::failure::{Failure, OutOfDomain};
use crate::core::problem::{Names, PotentialGradient};
use crate::core::scalar::Scalar;
use num_dual::{Dual64, HyperDual64, HyperHyperDual64};
use std::mem::swap;

/// A plate expanded in polynomials of high degree: `F = ∂Π/∂q = 0` for the coefficients `q` of the
/// deflection, where the in-plane displacements are eliminated (see
/// [`System`](crate::core::system::System) for the use of the model).
///
/// The deflection relative to the gap is `w = Σ q_ij d_ij f_i(ξ) g_j(ζ)` with `ξ = 2x − 1`, `ζ = 2y
/// − 1`, where x and y run from 0 to 1 along the sides. The functions `f`, `g` are beam modes,
/// expanded in polynomials; the factors `d` scale the unknowns such that equal values of unknowns
/// have equal energy. The unknowns are the coefficients `q_ij`, in the group `w`; the parameters
/// are listed at [`Units`].
///
/// Edge forces act on pairs of opposite edges: the normal force of a pair is zero if one of its
/// edges is free, and the shear force is zero if any edge is free. The symmetry of the plate is
/// used unless [`RitzSettings::symmetric`] is false; a shear force would break the symmetry.
///
/// The monitors are the same as for [all plates](super#monitors).
///
/// ```
/// use tangency::core::system::System;
/// use tangency::problems::plate::{Ritz, RitzSettings};
/// let mut plate = Ritz::new(RitzSettings::new("SSSS".parse()?))?;
/// let modes = plate.flat_modes(1.0, 0.3, 1)?;
/// assert!((modes.frequencies()[0] - 2.0 * std::f64::consts::PI.powi(2)).abs() < 1e-9);
/// # Ok::<(), tangency::problems::plate::PlateError>(())
/// ```
pub struct Ritz {
    pub(super) model: Discretisation,
    pub(super) names: Names,
    pub(super) factor: PlaneFactor,
    pub(super) assembly: Assembly,
    pub(super) eigenproblem: Eigenproblem,
    pub(super) search: Search,
    pub(super) plain: Workspace<f64>,
    pub(super) first: Workspace<Dual64>,
    pub(super) second: Workspace<HyperDual64>,
    pub(super) third: Workspace<HyperHyperDual64>,
    /// The point `x = (z, p)` at which the matrix was assembled; empty if no matrix has been
    /// assembled.
    pub(super) assembled_at: Vec<f64>,
    /// The memory for a second matrix, which monitors use because they must not change the
    /// assembled matrix.
    pub(super) spare: Vec<f64>,
    /// The point `x = (z, p)` at which the modes of vibration were computed; empty if no modes have
    /// been computed.
    pub(super) modes_at: Vec<f64>,
    pub(super) flat: Option<FlatPlate>,
    /// The values of the basis functions at the centre of the plate.
    pub(super) centre: Vec<f64>,
    /// The lowest mode of vibration, as a direction in the space of points `x = (z, p)`.
    pub(super) mode: Vec<f64>,
    pub(super) potential: PotentialGradient,
}

/// The unloaded plate, whose frequency is the reference for the frequencies of other states.
pub(super) struct FlatPlate {
    pub at: (f64, f64),
    pub square: f64,
    pub shape: Vec<f64>,
}

impl Ritz {
    /// Sets up the model of a plate: tabulates its basis functions and quadrature rules.
    ///
    /// # Errors
    /// [`PlateError`] if the numbers of basis functions are out of range, or the supports permit
    /// rigid motions.
    pub fn new(settings: RitzSettings) -> Result<Ritz, PlateError> {
        let model = Discretisation::new(settings)?;
        let n = model.unknowns();
        let names =
            monitors::names(settings.units, n).with_defaults(settings.units.defaults().to_vec());
        let length = names.length();
        let mut centre = vec![0.0; n];
        let mut search = Search::new(&model);
        shape::products(&model, [0.0; 2], &mut search.point, &mut centre);
        Ok(Ritz {
            factor: PlaneFactor::new(model.plane.len()),
            assembly: Assembly::new(&model),
            eigenproblem: Eigenproblem::new(model.mass()),
            search,
            plain: Workspace::new(&model),
            first: Workspace::new(&model),
            second: Workspace::new(&model),
            third: Workspace::new(&model),
            assembled_at: Vec::with_capacity(length),
            spare: vec![0.0; n * n],
            modes_at: Vec::with_capacity(length),
            flat: None,
            centre,
            mode: vec![0.0; length],
            potential: PotentialGradient::new(&names),
            names,
            model,
        })
    }

    /// Returns the numbers of basis functions of the plate.
    pub fn orders(&self) -> Orders {
        self.model.orders
    }

    /// Returns the point `x = (z, p)` that describes the flat plate with all parameters at their
    /// default values.
    pub fn at_rest(&self) -> Vec<f64> {
        let mut x = vec![0.0; self.model.unknowns()];
        x.extend_from_slice(self.model.settings.units.defaults());
        x
    }

    /// Returns the deflection relative to the gap for coefficients `q` (the unknowns of a solution,
    /// or the coefficients of a mode), at a point of the plate: `x` and `y` run from 0 to 1 along
    /// the sides.
    pub fn deflection(&self, q: &[f64], x: f64, y: f64) -> f64 {
        let at = [2.0 * x - 1.0, 2.0 * y - 1.0];
        shape::local(&self.model, q, at, &mut Default::default())[0]
    }

    /// Returns the deflection along the centre line `y = ½` at `points ≥ 2` equidistant points, as
    /// pairs `(x, w)`.
    pub fn centre_line(&self, q: &[f64], points: usize) -> Vec<(f64, f64)> {
        profile::line(points, |x| self.deflection(q, x, 0.5))
    }

    /// Returns the `count` lowest modes of the flat plate without loads, for the given `α` and `ν`;
    /// only symmetric modes if the symmetry of the plate is used.
    ///
    /// # Errors
    /// [`Failure`] if `α` or `ν` is out of range.
    pub fn flat_modes(&mut self, alpha: f64, nu: f64, count: usize) -> Result<Modes, Failure> {
        let p = Units::Dimensionless.defaults_at(alpha, nu);
        let parameters = domain::parameters(Units::Dimensionless, &p)?;
        self.modes_at.clear();
        swap(&mut self.assembly.matrix, &mut self.spare);
        self.assembly.assemble_flat(&self.model, &parameters);
        swap(&mut self.assembly.matrix, &mut self.spare);
        if self.eigenproblem.solve(&self.spare) {
            Ok(self.eigenproblem.lowest(count))
        } else {
            Err(Failure::Eigenvalues("frequencies of the flat plate"))
        }
    }

    /// Returns the `count` lowest modes of vibration about an equilibrium `x = (z, p)`.
    ///
    /// # Errors
    /// [`Failure`] if `x` is outside the domain of the equations.
    pub fn modes(&mut self, x: &[f64], count: usize) -> Result<Modes, Failure> {
        self.ensure_modes(x)?;
        Ok(self.eigenproblem.lowest(count))
    }

    /// Checks the point `x`, updates the Cholesky factor of `K_uv` if necessary, and returns the
    /// largest deflection.
    pub(super) fn prepare(&mut self, x: &[f64]) -> Result<f64, Failure> {
        let (q, p) = x.split_at(self.model.unknowns());
        domain::finite(q, |i| format!("component {i} of w"))?;
        let parameters = domain::parameters(self.model.settings.units, p)?;
        self.model.check_shear(parameters.shear)?;
        let largest = self.search.on_grid(&self.model, q).0;
        domain::clear(largest, LARGEST_DEFLECTION)?;
        if self.model.membrane.is_some()
            && !self.factor.update(&self.model.plane, parameters.aspect, parameters.nu)
        {
            let remedy = "the in-plane stiffness matrix is singular to working precision; use fewer \
                 in-plane functions";
            return Err(OutOfDomain::new("aspect", parameters.aspect, remedy).into());
        }
        Ok(largest)
    }

    /// Assembles the matrix `F_z` at the point `x`.
    pub(super) fn assemble_at(&mut self, x: &[f64]) -> Result<(), Failure> {
        let largest = self.evaluate(x)?;
        self.assembly.assemble(&self.model, &self.factor, &mut self.plain, largest);
        domain::finite(&self.assembly.matrix, |_| "an entry of the stiffness".into())
    }

    /// Evaluates the residual at the point `x` into `self.plain`, and returns the largest
    /// deflection.
    pub(super) fn evaluate(&mut self, x: &[f64]) -> Result<f64, Failure> {
        let largest = self.prepare(x)?;
        let (q, p) = x.split_at(self.model.unknowns());
        self.plain.q.copy_from_slice(q);
        self.plain.p.copy_from_slice(p);
        let nearest = self.plain.evaluate(&self.model, &self.factor, largest, true);
        // Between the search nodes, the plate may still touch the electrode.
        domain::clear(nearest, 1.0)?;
        Ok(largest)
    }

    /// Updates the modes of vibration about the point `x`, without changing the assembled matrix
    /// `F_z`.
    pub(super) fn ensure_modes(&mut self, x: &[f64]) -> Result<(), Failure> {
        if self.modes_at == x {
            return Ok(());
        }
        self.modes_at.clear();
        let known = if self.assembled_at == x {
            self.eigenproblem.solve(&self.assembly.matrix)
        } else {
            swap(&mut self.assembly.matrix, &mut self.spare);
            let done = self.assemble_at(x);
            swap(&mut self.assembly.matrix, &mut self.spare);
            done?;
            self.eigenproblem.solve(&self.spare)
        };
        if known {
            self.modes_at.extend_from_slice(x);
            return Ok(());
        }
        let reason = "the vibration frequencies are not determined: no shift makes the stiffness \
                      matrix positive definite, because the point is far from an equilibrium";
        Err(Failure::Undetermined(reason.into()))
    }
}

/// A scalar type for derivatives along up to three directions. Its functions construct a dual
/// number from the first-order parts of the number, and extract the mixed derivative from a dual
/// number.
pub(super) trait Directional: Scalar {
    fn seed(value: f64, parts: [f64; 3]) -> Self;
    fn mixed(&self) -> f64;
}

impl Directional for Dual64 {
    fn seed(value: f64, [d, ..]: [f64; 3]) -> Self {
        Dual64::new(value, d)
    }
    fn mixed(&self) -> f64 {
        self.eps
    }
}

impl Directional for HyperDual64 {
    fn seed(value: f64, [d, e, _]: [f64; 3]) -> Self {
        HyperDual64::new(value, d, e, 0.0)
    }
    fn mixed(&self) -> f64 {
        self.eps1eps2
    }
}

impl Directional for HyperHyperDual64 {
    fn seed(value: f64, [d, e, f]: [f64; 3]) -> Self {
        HyperHyperDual64::new(value, d, e, f, 0.0, 0.0, 0.0, 0.0)
    }
    fn mixed(&self) -> f64 {
        self.eps1eps2eps3
    }
}

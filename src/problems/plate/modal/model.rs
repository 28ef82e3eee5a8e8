//! A plate expanded in the modes of the flat plate, as a [`ZeroProblem`].

use super::projection::{Direct, Linear, Multiplied};
use super::settings::{MOST_MODES, ModalSettings};
use super::spectrum::FlatModes;
use super::tables::Nodes;
use crate::core::failure::OutOfDomain;
use crate::core::problem::{Dynamics, Names, Profile, ZeroProblem};
use crate::core::scalar::Scalar;
use crate::problems::plate::discretisation::LARGEST_DEFLECTION;
use crate::problems::plate::error::PlateError;
use crate::problems::plate::modes::signed_root;
use crate::problems::plate::parameters::Parameters;
use crate::problems::plate::ritz::Ritz;
use crate::problems::plate::shape::{self, Search};
use crate::problems::plate::tensor::{Rule, dot};
use crate::problems::plate::terms::Projection;
use crate::problems::plate::vibration::{Vibrates, reals};
use crate::problems::plate::{domain, monitors, profile};

/// The largest relative deviation of `α` and `ν` from the values for which the modes were computed;
/// deviations up to this limit can be caused by rounding of `b/a`.
const SAME: f64 = 1e-12;

/// The model of a plate whose deflection is expanded in `N` modes of the flat plate.
///
/// This [`ZeroProblem`] has the unknowns `w` (the `N` coefficients `q_i`, deflection over gap), the
/// parameters of [`Units`](crate::problems::plate::Units) and the monitors of [all
/// plates](crate::problems::plate#monitors). For [`Projection::Direct`] the residual is the
/// gradient of the potential `Π`, and the mass matrix is the identity. For
/// [`Projection::Multiplied`], the method of Zhao's dissertation, the equation is multiplied by
/// `(1−w)²` before the projection.
///
/// ```
/// use tangency::core::continuation::Continuation;
/// use tangency::core::system::Kind;
/// use tangency::problems::plate::modal::{Modal, ModalSettings};
/// let one_mode = ModalSettings { modes: 1, ..ModalSettings::new("CCCC".parse()?) };
/// let plate = Modal::new(one_mode)?;
/// assert!((plate.frequencies()[0] - 35.985191115).abs() < 1e-6);
/// let branch = Continuation::new(&mut plate.into_system())
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
    /// The modes, given by their coefficients in the unknowns of the full model `plate`.
    shapes: Vec<Vec<f64>>,
    pub(super) linear: Linear,
    pub(super) projected: Projected,
    /// The values of the modes at the nodes at which the largest deflection is searched.
    search: Nodes,
    places: [Rule; 2],
}

pub(super) enum Projected {
    Direct(Box<Direct>),
    Multiplied(Multiplied),
}

impl Modal {
    /// Computes the modes of the flat plate, and eliminates the in-plane displacements from the
    /// equations.
    ///
    /// # Errors
    /// [`PlateError`] if the number of modes or the accuracy is out of range, the modes do not
    /// reach the accuracy, or the plate cannot be set up.
    pub fn new(settings: ModalSettings) -> Result<Modal, PlateError> {
        let (modes, accuracy) = (settings.modes, settings.mode_accuracy);
        PlateError::check("modes", modes, [1, MOST_MODES])?;
        if !(1e-12..=0.1).contains(&accuracy) {
            return Err(PlateError::AccuracyRange { accuracy });
        }
        let mut flat = FlatModes::new(&settings)?;
        let linear = Linear::new(&settings, &flat);
        let projected = match settings.projection {
            Projection::Direct => Projected::Direct(Box::new(Direct::new(&settings, &mut flat)?)),
            Projection::Multiplied => Projected::Multiplied(Multiplied::new(&settings, &mut flat)?),
        };
        let FlatModes { plate, shapes, .. } = flat;
        let places = plate.model.symmetric.map(|symmetric| {
            let nodes = shape::search_nodes(symmetric);
            Rule { weights: vec![0.0; nodes.len()], nodes }
        });
        let search = Nodes::new(&plate, &shapes, &places, settings.plate.aspect);
        Ok(Modal { settings, plate, shapes, linear, projected, search, places })
    }

    /// Returns the frequencies `ω_i a²√(ρh/D)` of the modes of the flat plate, in ascending order.
    pub fn frequencies(&self) -> Vec<f64> {
        self.linear.squares.iter().map(|square| signed_root(*square)).collect()
    }

    /// Evaluates `Σ z_i φ_i`, the deflection over the gap for the coefficients `z` (the unknowns of
    /// a solution, or the coefficients of a mode), at a point of the plate: `x` and `y` run from 0
    /// to 1 along the sides.
    ///
    /// ```
    /// use tangency::problems::plate::modal::{Modal, ModalSettings};
    /// let plate = Modal::new(ModalSettings { modes: 1, ..ModalSettings::new("SSSS".parse()?) })?;
    /// // φ = 2 sin πx sin πy has mean square 1.
    /// assert!((plate.deflection(&[0.1], 0.5, 1.0 / 6.0) - 0.1_f64).abs() < 1e-6);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn deflection<T: Scalar>(&self, z: &[T], x: f64, y: f64) -> T {
        let mut products = vec![0.0; self.plate.model.unknowns()];
        let at = [2.0 * x - 1.0, 2.0 * y - 1.0];
        shape::products(&self.plate.model, at, &mut Default::default(), &mut products);
        let modes: Vec<f64> = self.shapes.iter().map(|shape| dot(shape, &products)).collect();
        dot(z, &modes)
    }

    /// Returns the deflection along the centre line `y = ½` at `points ≥ 2` equidistant points, as
    /// pairs `(x, w)`.
    pub fn centre_line(&self, z: &[f64], points: usize) -> Vec<(f64, f64)> {
        self.plate.centre_line(&self.coefficients(z), points)
    }

    /// Expresses the deflection `Σ z_i φ_i` in the unknowns of the full plate model whose modes are
    /// used.
    fn coefficients(&self, z: &[f64]) -> Vec<f64> {
        let mut sum = vec![0.0; self.plate.model.unknowns()];
        for (shape, z) in self.shapes.iter().zip(z) {
            sum.iter_mut().zip(shape).for_each(|(sum, c)| *sum += z * c);
        }
        sum
    }

    pub(super) fn parameters<T: Scalar>(&self, p: &[T]) -> Parameters<T> {
        self.settings.plate.units.parameters(p)
    }

    /// Returns the largest deflection at the nodes of the search grid, and the position `ξ`, `ζ` of
    /// the node with this deflection; NaN if any deflection is NaN.
    pub(super) fn on_grid(&self, z: &[f64]) -> (f64, [f64; 2]) {
        let deflections = self.search.values.chunks_exact(z.len()).map(|values| dot(z, values));
        let (k, largest) = shape::highest(deflections);
        let [x, y] = &self.places;
        (largest, [x.nodes[k / y.len()], y.nodes[k % y.len()]])
    }

    /// Returns the largest deflection and the position at which it occurs, as fractions of the
    /// sides from 0 to 1.
    fn largest(&self, z: &[f64]) -> [f64; 3] {
        let (best, [xi, zeta]) = self.on_grid(z);
        let model = &self.plate.model;
        let held = model.symmetric;
        let (w, xi, zeta) = if best.is_nan() || (held == [true; 2] && xi == 0.0 && zeta == 0.0) {
            (best, xi, zeta)
        } else {
            Search::new(model).largest(model, &self.coefficients(z))
        };
        [w, 0.5 + 0.5 * xi, 0.5 + 0.5 * zeta]
    }

    /// Returns an error for parameters outside the domain of the equations, and for values of `α`
    /// and `ν` that differ from the values for which the modes were computed.
    fn check_parameters(&self, p: &[f64]) -> Result<(), OutOfDomain> {
        let settings = &self.settings;
        let plate = domain::parameters(settings.plate.units, p)?;
        let fixed =
            [("aspect", plate.aspect, settings.plate.aspect), ("nu", plate.nu, settings.nu)];
        for (name, value, of_modes) in fixed {
            if (value - of_modes).abs() > SAME * of_modes.abs() {
                let remedy = format!(
                    "the modes were computed for the value {of_modes}; keep this value, build a new \
                     modal model, or vary the parameter in the full model"
                );
                return Err(OutOfDomain::new(name, value, remedy));
            }
        }
        self.plate.model.check_shear(plate.shear)
    }
}

impl ZeroProblem for Modal {
    fn names(&self) -> Names {
        monitors::names(self.settings.plate.units, self.shapes.len())
    }

    /// Returns the default parameters, with the aspect ratio and Poisson's ratio for which the
    /// modes were computed.
    fn defaults(&self) -> Vec<f64> {
        let ModalSettings { plate, nu, .. } = self.settings;
        plate.units.defaults_at(plate.aspect, nu)
    }

    fn residual<T: Scalar>(&self, z: &[T], p: &[T], r: &mut [T]) {
        let plate = self.parameters(p);
        match &self.projected {
            Projected::Direct(direct) => {
                let largest = self.on_grid(&reals(z)).0;
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

    fn domain(&self, z: &[f64], p: &[f64]) -> Result<(), OutOfDomain> {
        self.check_parameters(p)?;
        // Polynomials are limited only by contact; otherwise the load is integrated to ten digits
        // up to the limit.
        let limit = match self.settings.projection {
            Projection::Direct => LARGEST_DEFLECTION,
            Projection::Multiplied => 1.0,
        };
        domain::clear(self.on_grid(z).0, limit)
    }

    fn dynamics(&self) -> Dynamics {
        self.settings.projection.dynamics()
    }

    /// Returns profiles of the deflection and of the first mode shape along the centre line.
    fn profiles(&self, z: &[f64], p: &[f64]) -> Vec<Profile> {
        profile::with_lowest_mode(self, z, p, |z, x| self.deflection(z, x, 0.5))
    }
}

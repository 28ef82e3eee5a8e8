//! The stress-function model of a simply supported plate, in sines (section 3.2 of Zhao's
//! dissertation).
//!
//! The equations 3.12–3.13 of the plate, where `w` is in units of the gap and the coordinates are
//! in units of the sides (`ξ = x/a`, `η = y/b`), are
//!
//! ```text
//!     L(w) + ẅ = κ Φ(w, F) + λ/(1−w)² + pressure,      κ = 12(1−ν²)α₁²/α²
//!     L(F)     = −Φ(w, w)/(2α²),                        Φ(f, g) = f_ξξ g_ηη + f_ηη g_ξξ − 2 f_ξη g_ξη
//!     L        = ∂ξ⁴ + (2/α²) ∂ξ²∂η² + (1/α⁴) ∂η⁴
//! ```
//!
//! The sum `w = Σ w_mn sin mπξ sin nπη` over odd `m`, `n` (the first instability of the plate is
//! symmetric) satisfies the support conditions 3.14 term by term. The stress function `F = ½(p_y ξ²
//! + p_x η²) + Σ f_mn cos mπξ cos nπη` solves the second equation exactly for any such `w`: shear
//! traction vanishes at the edges, which stay straight. The residual consists of projections of the
//! first equation onto the products of sines, one projection for each coefficient `w_mn`.
//!
//! The series of sines converges algebraically, because `L(w) = λ ≠ 0` on the edges, where every
//! sine vanishes. The load at pull-in of a square plate with `α₁ = 2` is within 2e-6 of its limit
//! for 15 modes, and within 1e-10 for 160 modes.

mod airy;
mod basis;
mod projection;

use super::edges::InPlane;
use super::error::PlateError;
use super::modes::signed_root;
use super::parameters::Units;
use super::tensor::dot;
use super::terms::{Projection, Theory};
use super::vibration::{Lowest, Vibrates, reals};
use super::{domain, monitors, profile};
use crate::core::failure::OutOfDomain;
use crate::core::problem::{Dynamics, Names, Profile, ZeroProblem};
use crate::core::scalar::Scalar;
use airy::Airy;
use basis::{Grid, LARGEST, ordered_modes};
use nalgebra::DMatrix;
use projection::Sines;

/// The mean square of a product of sines over the plate, which is ¼.
const MEAN_SQUARE: f64 = 0.25;

/// The settings of a [`SinePlate`]. The default settings are 15 modes, in-plane supports `slide`,
/// von Kármán's theory, the direct projection and dimensionless parameters.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct SineSettings {
    /// The number of modes, `N ≥ 1`; each mode is a pair of odd wave numbers `(m, n)`, and the
    /// pairs are sorted by `m² + n²`, then by `m`.
    pub modes: usize,
    /// The in-plane supports of the edges; all edges stay straight and are free of shear traction.
    /// [`InPlane::Slide`]: the normal displacement of the edges is zero ("immovable" in section
    /// 3.2), and `p_x` and `p_y` are given by eqs. 3.22–3.23.
    /// [`InPlane::Straight`]: the mean normal force on the edges is zero ("movable" in section
    /// 3.2), so that `p_x = p_y = 0`.
    /// All other in-plane supports are rejected.
    pub in_plane: InPlane,
    /// The theory of the plate: linear theory, or von Kármán's theory.
    pub theory: Theory,
    /// The projection.
    pub projection: Projection,
    /// The units and the meaning of the parameters.
    pub units: Units,
    /// The number of Gauss points in each half direction; with the default number, loads at
    /// deflections up to 0.9 of the gap are integrated with an error of 1e-9, and the products of
    /// sines in the multiplied projection are integrated exactly up to rounding.
    pub quadrature_points: Option<usize>,
}

impl Default for SineSettings {
    fn default() -> Self {
        SineSettings {
            modes: 15,
            in_plane: InPlane::Slide,
            theory: Theory::default(),
            projection: Projection::default(),
            units: Units::default(),
            quadrature_points: None,
        }
    }
}

/// A term of the stress function: `coefficient · cos mπξ cos nπη`, in units of `Ed²`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct StressTerm<T> {
    /// The even wave number along x of the term.
    pub m: usize,
    /// The even wave number along y of the term.
    pub n: usize,
    /// `f_mn`, eq. 3.24.
    pub coefficient: T,
}

/// The lowest mode of vibration about an equilibrium, among the modes that are symmetric about both
/// centre lines.
#[derive(Clone, Debug, PartialEq)]
pub struct Vibration {
    /// The frequency `ω a²√(ρh/D)`, or the frequency in Hz for a device; for an unstable
    /// equilibrium, `ω` is replaced by `−√(−ω²)`.
    pub frequency: f64,
    /// The coefficients of the products of sines in the mode, in the order of [`SinePlate::modes`],
    /// scaled to a deflection of 1 at the centre.
    pub shape: Vec<f64>,
}

/// A simply supported, electrically actuated plate expanded in `N` products of sines.
///
/// This [`ZeroProblem`] has the unknowns `w` (the `N` coefficients `w_mn`, deflection over gap),
/// the parameters of [`Units`] and the monitors of [all plates](super#monitors). Component `i` of
/// the residual is the projection of eq. 3.12 on `φ_i` over the unit square; for
/// [`Projection::Direct`] it is the derivative of the potential energy with respect to `w_i`, in
/// units of `αDd²/a²`, and the mass matrix is one quarter of the identity.
///
/// ```
/// use tangency::core::problem::ZeroProblem;
/// use tangency::problems::plate::sine::{SinePlate, SineSettings};
/// let plate = SinePlate::new(SineSettings { modes: 6, ..Default::default() })?;
/// let parameters = plate.defaults();
/// let mut monitors = [0.0; 4];
/// plate.monitors(&[0.0; 6], &parameters, &mut monitors);
/// let exact = 2.0 * std::f64::consts::PI.powi(2); // ωa²√(ρh/D) = π²(1² + 1²)
/// assert!((monitors[2] - exact).abs() < 1e-12 && (monitors[3] - 1.0).abs() < 1e-14);
/// # Ok::<(), tangency::problems::plate::PlateError>(())
/// ```
#[derive(Clone, Debug)]
pub struct SinePlate {
    settings: SineSettings,
    sines: Sines,
}

impl SinePlate {
    /// Sets up the model of a plate: sorts the modes and tabulates their couplings and values.
    ///
    /// # Errors
    /// [`PlateError`] if the number of modes is zero, a mode has a wave number above 127, the
    /// quadrature has fewer points in a half direction than the largest wave number, or the edges
    /// are immovable or free in their plane.
    pub fn new(settings: SineSettings) -> Result<Self, PlateError> {
        let in_plane = settings.in_plane;
        if !matches!(in_plane, InPlane::Slide | InPlane::Straight) {
            return Err(PlateError::SineInPlane { in_plane: in_plane.name() });
        }
        let count = settings.modes;
        // Larger numbers of modes exceed the full square of wave numbers; the limit also keeps the
        // list short.
        let modes = ordered_modes(count.min(LARGEST * LARGEST + 1));
        let width = modes.iter().map(|&(k, l)| k.max(l) + 1).max().unwrap_or(0);
        if !(1..=LARGEST).contains(&width) {
            let all = ordered_modes(LARGEST * LARGEST);
            let most = all.iter().take_while(|(k, l)| *k.max(l) < LARGEST).count();
            PlateError::check("modes", count, [1, most])?;
        }
        let wave_number = 2 * width - 1;
        let points = settings.quadrature_points.unwrap_or(match settings.projection {
            Projection::Direct => 32 + wave_number,
            // Products have wave numbers up to 6 times the largest: 5π/4 per wave number and half
            // interval. Gauss's rule needs half of that, and some more points for the last digits.
            Projection::Multiplied => 16 + 5 * wave_number / 2,
        });
        if points < wave_number {
            return Err(PlateError::TooFewPoints { points, needed: wave_number });
        }
        let stretched = settings.theory == Theory::VonKarman;
        let sines = Sines {
            airy: stretched.then(|| Airy::new(&modes)),
            grid: Grid::new(width, points),
            held: stretched && in_plane == InPlane::Slide,
            modes,
        };
        Ok(SinePlate { settings, sines })
    }

    /// Returns the wave numbers `(m, n)` of all unknowns, in the order of the unknowns.
    pub fn modes(&self) -> Vec<(usize, usize)> {
        self.sines.modes.iter().map(|&(k, l)| (2 * k + 1, 2 * l + 1)).collect()
    }

    /// Evaluates `Σ z_i sin m_iπξ sin n_iπη` at a point of the unit square: the deflection relative
    /// to the gap, or a mode of vibration.
    ///
    /// ```
    /// use tangency::problems::plate::sine::{SinePlate, SineSettings};
    /// let plate = SinePlate::new(SineSettings { modes: 3, ..Default::default() })?;
    /// assert_eq!(plate.modes(), [(1, 1), (1, 3), (3, 1)]);
    /// assert!((plate.deflection(&[0.5, 0.02, 0.01], 0.5, 0.5) - 0.47_f64).abs() < 1e-15);
    /// # Ok::<(), tangency::problems::plate::PlateError>(())
    /// ```
    pub fn deflection<T: Scalar>(&self, z: &[T], x: f64, y: f64) -> T {
        self.sines.deflection(z, x, y)
    }

    /// Returns the terms of the stress function of the deflection `z`, eqs. 3.24–3.25, without the
    /// uniform forces of [`SinePlate::edge_tension`]; the list is empty in linear theory.
    pub fn stress_function<T: Scalar>(&self, z: &[T], p: &[T]) -> Vec<StressTerm<T>> {
        let aspect = self.settings.units.parameters(p).aspect;
        let terms = self.sines.airy.iter().flat_map(|airy| airy.coefficients(z, aspect));
        terms.map(|(m, n, coefficient)| StressTerm { m, n, coefficient }).collect()
    }

    /// Returns the mean in-plane tensions `[N_x, N_y]` that the deflection `z` causes between the
    /// edges: `κp_x` and `α²κp_y` of eqs. 3.22–3.23, in units of `D/a²`. These forces are positive
    /// in tension, and zero for [`InPlane::Straight`] and in linear theory. The applied edge forces
    /// are not included in these mean tensions.
    pub fn edge_tension<T: Scalar>(&self, z: &[T], p: &[T]) -> [T; 2] {
        let plate = self.settings.units.parameters(p);
        let [x, y] = self.sines.held_tension(z, &plate);
        [x, y * plate.aspect * plate.aspect]
    }

    /// Returns the lowest mode of vibration about the equilibrium `z`; `None` if values are not
    /// finite, or, for [`Projection::Multiplied`], if the lowest eigenvalue is not real.
    pub fn vibration(&self, z: &[f64], p: &[f64]) -> Option<Vibration> {
        let vectors = self.lowest(z, p)?;
        let square = self.frequency_squared(z, p, &vectors);
        let unit = self.settings.units.frequency_unit(p);
        let centre = self.deflection(&vectors.right, 0.5, 0.5);
        Some(Vibration {
            frequency: signed_root(square) * unit,
            shape: vectors.right.iter().map(|value| value / centre).collect(),
        })
    }
}

impl Vibrates for SinePlate {
    fn mass(&self, z: &[f64]) -> Vec<f64> {
        match self.settings.projection {
            Projection::Direct => DMatrix::identity(z.len(), z.len()) * MEAN_SQUARE,
            Projection::Multiplied => self.sines.mass(z),
        }
        .as_slice()
        .into()
    }

    fn inertia<T: Scalar>(&self, z: &[T], Lowest { left, right }: &Lowest) -> T {
        match self.settings.projection {
            Projection::Direct => T::constant(MEAN_SQUARE * dot(left, right)),
            Projection::Multiplied => self.sines.inertia(z, left, right),
        }
    }
}

impl ZeroProblem for SinePlate {
    fn names(&self) -> Names {
        monitors::names(self.settings.units, self.sines.modes.len())
    }

    fn defaults(&self) -> Vec<f64> {
        self.settings.units.defaults().to_vec()
    }

    fn residual<T: Scalar>(&self, z: &[T], p: &[T], r: &mut [T]) {
        let plate = self.settings.units.parameters(p);
        match self.settings.projection {
            Projection::Direct => self.sines.direct(z, &plate, r),
            Projection::Multiplied => self.sines.multiplied(z, &plate, r),
        }
    }

    fn monitors<T: Scalar>(&self, z: &[T], p: &[T], values: &mut [T]) {
        let units = self.settings.units;
        let (_, x, y) = self.sines.largest(&reals(z));
        let deflections = [self.deflection(z, 0.5, 0.5), self.deflection(z, x, y)];
        // The wave numbers 1 and 1 are always among the modes.
        let flat = Sines::flat_frequency((0, 0), units.parameters(p).aspect);
        monitors::fill(units, p, deflections, [self.frequency(z, p), flat], values);
    }

    fn domain(&self, z: &[f64], p: &[f64]) -> Result<(), OutOfDomain> {
        let plate = domain::parameters(self.settings.units, p)?;
        if plate.shear != 0.0 {
            let remedy = "products of odd sines cannot represent sheared edges; use a plate model \
                          without quarter symmetry, or set the parameter `edge_shear` to 0";
            return Err(OutOfDomain::new("edge_shear", plate.shear, remedy));
        }
        domain::clear(self.sines.largest(z).0, 1.0)
    }

    fn dynamics(&self) -> Dynamics {
        self.settings.projection.dynamics()
    }

    /// Returns profiles of the deflection and of the first mode shape along the centre line.
    fn profiles(&self, z: &[f64], p: &[f64]) -> Vec<Profile> {
        profile::with_lowest_mode(self, z, p, |z, x| self.deflection(z, x, 0.5))
    }
}

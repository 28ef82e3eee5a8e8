//! The parameters of a plate, dimensionless or in SI units, and their conversion to the parameters
//! of the equations.

use crate::core::scalar::Scalar;

/// The parameters of the dimensionless equations. In-plane lengths are in units of the side `a`,
/// deflections in units of the gap `d`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Parameters<T> {
    /// The electrostatic load `λ = α₂V²`, eq. 3.17: `6εa⁴(1−ν²)V²/(Eh³d³)`.
    pub load: T,
    /// The gap ratio `α₁ = d/h`, gap over thickness, eq. 3.17.
    pub gap_ratio: T,
    /// The aspect ratio `α = b/a`, eq. 3.17.
    pub aspect: T,
    /// Poisson's ratio `ν`.
    pub nu: T,
    /// The applied compressive force along x, in units of `D/a²`.
    pub compression_x: T,
    /// The applied compressive force along y, in units of `D/a²`.
    pub compression_y: T,
    /// The applied shear force, in units of `D/a²`.
    pub shear: T,
    /// The uniform transverse pressure, in units of `Dd/a⁴`.
    pub pressure: T,
}

/// The choice of the named parameters of a plate problem: dimensionless or in SI units.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
#[serde(rename_all = "snake_case")]
#[non_exhaustive]
pub enum Units {
    /// The dimensionless parameters `load`, `gap_ratio`, `aspect`, `nu`, `edge_force` (which acts
    /// on both pairs of edges), `edge_force_x`, `edge_force_y`, `edge_shear`, `pressure`, as in
    /// [`Parameters`].
    #[default]
    Dimensionless,
    /// The parameters of a device in SI units: `voltage` (V), `length` and `width` (the sides a and
    /// b), `thickness`, `gap` (m), `young` (Pa), `nu`, `density` (kg/m³), `permittivity` (F/m),
    /// `edge_force_x`, `edge_force_y`, `edge_shear` (N/m), `pressure` (Pa), `residual_stress` (Pa;
    /// positive if the plate is under tension). A residual stress σ is equivalent to the edge forces
    /// −σh along x and y.
    Device,
}

const DIMENSIONLESS: [&str; 9] = [
    "load",
    "gap_ratio",
    "aspect",
    "nu",
    "edge_force",
    "edge_force_x",
    "edge_force_y",
    "edge_shear",
    "pressure",
];
const DEVICE: [&str; 14] = [
    "voltage",
    "length",
    "width",
    "thickness",
    "gap",
    "young",
    "nu",
    "density",
    "permittivity",
    "edge_force_x",
    "edge_force_y",
    "edge_shear",
    "pressure",
    "residual_stress",
];

impl Units {
    /// Returns the names of the parameters, in the order in which [`parameters`](Units::parameters)
    /// reads them.
    pub fn names(self) -> &'static [&'static str] {
        match self {
            Units::Dimensionless => &DIMENSIONLESS,
            Units::Device => &DEVICE,
        }
    }

    /// Returns the default values of the parameters: dimensionless parameters describe a square
    /// plate with `α₁ = 1`, `ν = 0.3`; parameters of a device describe a silicon plate, 300 µm
    /// square and 2 µm thick, over a gap of 2 µm.
    pub fn defaults(self) -> &'static [f64] {
        match self {
            Units::Dimensionless => &[0.0, 1.0, 1.0, 0.3, 0.0, 0.0, 0.0, 0.0, 0.0],
            Units::Device => &[
                0.0,
                300e-6,
                300e-6,
                2e-6,
                2e-6,
                160e9,
                0.22,
                2330.0,
                8.854_187_812_8e-12,
                0.0,
                0.0,
                0.0,
                0.0,
                0.0,
            ],
        }
    }

    /// Returns the default values of the parameters, but for a plate with the given aspect ratio
    /// and Poisson's ratio; for a device, the width follows from the aspect ratio.
    ///
    /// ```
    /// use tangency::problems::plate::Units;
    /// let p = Units::Device.defaults_at(1.5, 0.3);
    /// assert_eq!((p[2], p[6]), (1.5 * p[1], 0.3));
    /// ```
    pub fn defaults_at(self, aspect: f64, nu: f64) -> Vec<f64> {
        let mut p = self.defaults().to_vec();
        match self {
            Units::Dimensionless => (p[2], p[3]) = (aspect, nu),
            Units::Device => (p[2], p[6]) = (aspect * p[1], nu),
        }
        p
    }

    /// Returns the position of the gap among the parameters of a device; `None` for dimensionless
    /// parameters.
    pub(super) fn gap(self) -> Option<usize> {
        (self == Units::Device).then_some(4)
    }

    /// Returns the positions of the parameters that determine the aspect ratio `α` and Poisson's
    /// ratio `ν`.
    pub(super) fn of_the_plane(self) -> &'static [usize] {
        match self {
            Units::Dimensionless => &[2, 3],
            Units::Device => &[1, 2, 6],
        }
    }

    /// Converts the named parameters to the parameters of the dimensionless equations.
    ///
    /// ```
    /// use tangency::problems::plate::Units;
    /// let mut p = Units::Device.defaults().to_vec();
    /// p[0] = 100.0; // volts
    /// let plate = Units::Device.parameters(&p);
    /// let alpha_2 = 6.0 * 8.854_187_812_8e-12 * 300e-6f64.powi(4) * (1.0 - 0.22 * 0.22)
    ///     / (160e9 * 2e-6f64.powi(6));
    /// assert!((plate.load / (alpha_2 * 100.0 * 100.0) - 1.0).abs() < 1e-14);
    /// assert_eq!((plate.gap_ratio, plate.aspect), (1.0, 1.0));
    /// ```
    pub fn parameters<T: Scalar>(self, p: &[T]) -> Parameters<T> {
        match self {
            Units::Dimensionless => Parameters {
                load: p[0],
                gap_ratio: p[1],
                aspect: p[2],
                nu: p[3],
                compression_x: p[4] + p[5],
                compression_y: p[4] + p[6],
                shear: p[7],
                pressure: p[8],
            },
            Units::Device => {
                let [voltage, a, b, h, d, young, nu, _, permittivity] =
                    [0, 1, 2, 3, 4, 5, 6, 7, 8].map(|i| p[i]);
                let stiffness = rigidity(young, h, nu);
                let force = a * a / stiffness;
                Parameters {
                    load: permittivity * a.powi(4) * voltage * voltage
                        / (stiffness * d.powi(3) * 2.0),
                    gap_ratio: d / h,
                    aspect: b / a,
                    nu,
                    compression_x: (p[9] - p[13] * h) * force,
                    compression_y: (p[10] - p[13] * h) * force,
                    shear: p[11] * force,
                    pressure: p[12] * a.powi(4) / (stiffness * d),
                }
            }
        }
    }

    /// Returns the factor that converts the dimensionless angular frequency `ωa²√(ρh/D)` to the
    /// unit of the problem: to hertz for parameters in SI units; 1 for dimensionless parameters.
    pub fn frequency_unit<T: Scalar>(self, p: &[T]) -> T {
        match self {
            Units::Dimensionless => T::one(),
            Units::Device => {
                let [a, h, young, nu, density] = [1, 3, 5, 6, 7].map(|i| p[i]);
                (rigidity(young, h, nu) / (density * h)).sqrt() / (a * a * std::f64::consts::TAU)
            }
        }
    }
}

/// Returns the bending stiffness `D = Eh³/[12(1 − ν²)]`.
fn rigidity<T: Scalar>(young: T, h: T, nu: T) -> T {
    young * h.powi(3) / ((T::one() - nu * nu) * 12.0)
}

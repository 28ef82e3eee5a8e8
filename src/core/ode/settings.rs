//! Settings of the numerical integration of a flow.

use super::error::SettingsError;
use super::tableau::{ORDER_EIGHT, ORDER_FIVE, Tableau};
use crate::core::cancel::CancelToken;

/// A method of integration.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
#[non_exhaustive]
pub enum Scheme {
    /// The explicit method of order 8 of Dormand and Prince (DOP853): for smooth vector fields and
    /// accuracies of about six digits or more, it has the lowest cost.
    #[default]
    DormandPrince8,
    /// The explicit pair of order 5(4) of Dormand and Prince, suitable for low accuracy.
    DormandPrince5,
    /// The stiffly accurate, L-stable Rosenbrock method Rodas5P of order 5 (Steinebach 2023),
    /// suitable for stiff vector fields.
    Rodas5P,
}

impl Scheme {
    /// Returns the tableau of an explicit scheme; `None` for a Rosenbrock method.
    pub(super) fn tableau(self) -> Option<&'static Tableau> {
        match self {
            Scheme::DormandPrince8 => Some(&ORDER_EIGHT),
            Scheme::DormandPrince5 => Some(&ORDER_FIVE),
            Scheme::Rodas5P => None,
        }
    }

    /// Whether the method is explicit, so that its steps do not solve linear systems.
    pub(in crate::core) fn is_explicit(self) -> bool {
        self.tableau().is_some()
    }

    /// Returns the order of the method: with the order `p`, halving all steps divides the error by
    /// `2^p`.
    pub fn order(self) -> usize {
        self.tableau().map_or(5, |tableau| tableau.order)
    }
}

/// Tolerances and limits of a flow.
///
/// The estimated error of a step is kept below `absolute + relative·|x_i|`, in the root mean square
/// over the states. Step sizes are fractions of the flow's duration: with the step size 1, the flow
/// is a single step.
///
/// ```
/// use tangency::core::ode::{Scheme, Settings};
/// let settings = Settings { largest_step: 0.1, ..Settings::new(Scheme::DormandPrince8, 1e-10) };
/// assert!(settings.check().is_ok());
/// assert!(Settings::new(Scheme::DormandPrince8, -1.0).check().is_err());
/// ```
#[derive(Clone, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Settings {
    /// The method.
    pub scheme: Scheme,
    /// The relative tolerance of a step.
    pub relative: f64,
    /// The absolute tolerance of a step.
    pub absolute: f64,
    /// The first step to try; `None` if the first step is chosen from the vector field (Hairer,
    /// Nørsett, Wanner 1993, section II.4).
    pub first_step: Option<f64>,
    /// The largest step.
    pub largest_step: f64,
    /// The largest number of steps, including rejected steps.
    pub max_steps: usize,
    /// Cancels the flow.
    #[serde(skip)]
    pub cancel: CancelToken,
}

impl Settings {
    /// Creates settings of the implicit method for stiff vector fields, with the tolerance 1e-9, for
    /// initial guesses of orbits that are corrected later.
    pub fn implicit() -> Self {
        Settings::new(Scheme::Rodas5P, 1e-9)
    }

    /// Creates settings of a method with one tolerance, used as relative and absolute tolerance.
    pub fn new(scheme: Scheme, tolerance: f64) -> Self {
        Settings {
            scheme,
            relative: tolerance,
            absolute: tolerance,
            first_step: None,
            largest_step: 1.0,
            max_steps: 100_000,
            cancel: CancelToken::default(),
        }
    }

    /// Checks the settings.
    ///
    /// # Errors
    /// [`SettingsError`] for the first invalid setting.
    pub fn check(&self) -> Result<(), SettingsError> {
        let &Settings { relative, absolute, .. } = self;
        let fine =
            relative >= 1e-15 && absolute > 0.0 && relative.is_finite() && absolute.is_finite();
        if !fine {
            return Err(SettingsError::Tolerance { relative, absolute });
        }
        for step in self.first_step.iter().chain([&self.largest_step]) {
            if !(*step > 0.0 && *step <= 1.0) {
                return Err(SettingsError::Step(*step));
            }
        }
        if self.max_steps == 0 { Err(SettingsError::Steps) } else { Ok(()) }
    }
}

impl Default for Settings {
    fn default() -> Self {
        Settings::new(Scheme::DormandPrince8, 1e-12)
    }
}

//! Integration of ordinary differential equations: flows of vector fields.
//!
//! The flow `φ` of a vector field `f` maps a state `x₀` at the time `t₀` to the state `x(t₀ + L)`
//! on the solution of the following initial-value problem:
//!
//! ```text
//!     x' = f(t, x, p),    x(t₀) = x₀.
//! ```
//!
//! The flow is computed in scaled time, `dx/dσ = L f(t₀ + σ L, x, p)` with `0 ≤ σ ≤ 1`, so that
//! step lengths are real numbers although the duration `L` can depend on parameters. All code is
//! generic over
//! [`Scalar`]: dual numbers of any depth carry the derivatives of the flow with respect to the
//! initial state, the duration, the initial time and parameters (the *variational flow*). Step
//! sizes are controlled by real parts, so that all scalar types take the same steps, and
//! derivatives are exact for the computed flow.
//!
//! The methods are the pairs of Dormand and Prince of orders 8 and 5 (E. Hairer, S. P. Nørsett and G.
//! Wanner, *Solving Ordinary Differential Equations I*, 2nd ed. 1993), and the Rosenbrock method
//! Rodas5P for stiff fields (E. Hairer and G. Wanner, *Solving Ordinary Differential Equations II*,
//! 2nd ed. 1996; G. Steinebach, BIT Numer. Math. 63:27, 2023), which solves only linear systems and
//! is therefore as generic as the explicit methods.
//!
//! [`Scalar`]: crate::core::scalar::Scalar

mod batch;
mod control;
mod error;
mod extrema;
mod forecast;
mod integrate;
mod lane_state;
mod motion;
mod rodas;
mod roots;
mod rosenbrock;
mod settings;
mod stages;
mod step;
mod tableau;
mod watch_sampler;
mod work;

pub(in crate::core) use batch::{BatchStepper, LaneSteps};
pub use control::Size;
pub use error::SettingsError;
pub use extrema::{Extrema, Extremum};
pub(in crate::core) use forecast::EventForecast;
pub use integrate::{Flow, Statistics};
pub(in crate::core) use lane_state::{LaneState, Reached};
pub(crate) use roots::NEGATIVE;
pub(in crate::core) use roots::Sign;
pub use roots::{Root, Roots};
pub use settings::{Scheme, Settings};
pub(in crate::core) use step::RealStep;
pub use step::Step;
pub use work::{Work, work};

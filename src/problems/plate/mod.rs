//! Models electrically actuated rectangular microplates by von Kármán's theory (1910).
//!
//! Numbers of equations and sections in this module refer to the dissertation of X. Zhao, *Modeling
//! and Simulation of MEMS Devices*, 2004.
//!
//! ```
//! use tangency::core::continuation::Continuation;
//! use tangency::core::system::{Dense, Kind};
//! use tangency::problems::plate::sine::{SinePlate, SineSettings};
//! // The static pull-in of a square plate with supported edges, in three modes.
//! let plate = SinePlate::new(SineSettings { modes: 3, ..Default::default() })?;
//! let branch = Continuation::new(&mut Dense::new(plate))
//!     .at("gap_ratio", 2.0)
//!     .at("aspect", 1.0).at("nu", 0.3)
//!     .along("load", 0.0..=400.0)
//!     .bound("max_deflection", 0.0..=0.9)
//!     .trace()?;
//! let pull_in = branch.of_kind(Kind::LP).next().expect("pull-in");
//! let deflection = branch.column("deflection").and_then(|column| pull_in.value(column));
//! assert!((pull_in.parameters[0] - 144.863462).abs() < 1e-5);
//! assert!((deflection.expect("a deflection") - 0.668334).abs() < 1e-5);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! # Models
//!
//! | model | description |
//! | --- | --- |
//! | [`Ritz`] | the full model: polynomials of high degree for any supports and any in-plane supports |
//! | [`modal`] | a reduced-order model in the lowest modes of the full model's flat plate (section 3.3) |
//! | [`sine`] | a model in sines with a stress function, for four simply supported edges (section 3.2) |
//! | [`strip`] | a plate that is infinitely long in one direction |
//!
//! [`PlateSettings`] chooses among the models `Ritz`, `modal` and `sine`. These three models share
//! their parameters ([`Units`]), domain, monitors and the profiles of special points: the
//! deflection and the first mode shape along the centre line `y = b/2`.
//!
//! # Monitors
//!
//! | monitor | meaning |
//! | --- | --- |
//! | `deflection` | the deflection of the plate's centre, relative to the gap |
//! | `max_deflection` | the largest deflection towards the electrode, relative to the gap |
//! | `frequency` | the lowest natural frequency: `ωa²√(ρh/D)`, or in Hz for a device; `−√(−ω²)` if the equilibrium is unstable |
//! | `frequency_ratio` | the ratio of `frequency` to the frequency of the flat plate without voltage, pressure and edge forces |
//! | `displacement` | the deflection of the plate's centre, in metres; only for a device |
//!
//! If the symmetry of the plate is used, `frequency` is the lowest frequency of the symmetric
//! modes. First derivatives of the monitors are exact; second derivatives of `frequency` and
//! `frequency_ratio` neglect the change of the mode.

mod assembly;
pub mod basis;
mod discretisation;
mod domain;
mod edges;
mod error;
mod membrane_form;
pub mod modal;
mod modes;
mod monitors;
mod orders;
mod parameters;
mod plane;
mod profile;
mod residual;
mod ritz;
mod settings;
mod shape;
pub mod sine;
pub mod strip;
mod system;
mod tensor;
mod terms;
mod vibration;

pub use discretisation::RitzSettings;
pub use edges::{InPlane, Support, Supports};
pub use error::PlateError;
pub use membrane_form::MembraneForm;
pub use modes::Modes;
pub use orders::Orders;
pub use parameters::{Parameters, Units};
pub use ritz::Ritz;
pub use settings::{Model, PlateSettings};
pub use tensor::Rule;
pub use terms::{Projection, Theory};

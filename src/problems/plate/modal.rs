//! The modal reduced-order model of section 3.3 of Zhao's dissertation: a plate expanded in the
//! modes of the flat plate.
//!
//! The deflection is `w = Σ q_i φ_i`, where `φ_i` are the lowest modes of the flat plate without
//! loads, with the mean square 1 over the plate. The potential energy per area is
//!
//! ```text
//! Π = ½ Σ ω_i² q_i² + 6α₁² Σ A_(ij)(kl) q_i q_j q_k q_l − ½⟨P : ∇w∇w⟩ − λ⟨1/(1−w)⟩ − P⟨w⟩
//! ```
//!
//! The in-plane displacements are eliminated once, which yields the matrix `A` of the stretching
//! energy; this works for all supports and all in-plane supports, and needs no stress function.
//! Evaluating the residual takes some microseconds. `N` modes give the load at pull-in of a clamped
//! plate within 0.3 % (`N = 1`) or 0.01 % (`N = 7`). The modes and `A` are computed for one aspect
//! ratio and one Poisson's ratio: to vary these parameters, use the full model,
//! [`Ritz`](super::Ritz).

mod assembly;
mod membrane;
mod model;
mod projection;
mod settings;
mod spectrum;
mod tables;
mod vibration;

pub use model::Modal;
pub use settings::{MOST_MODES, ModalSettings};

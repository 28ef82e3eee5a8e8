//! The models that users define: zero problems, vector fields, maps, potentials, measures, and their
//! names, and their object-safe forms.

mod discrete_map;
mod erasure;
mod extremes;
mod field;
mod forward;
mod measure;
pub(crate) mod names;
mod potential;
mod scalar_field;
mod stated;
mod watch;
mod zero;
mod zero_equations;

pub use discrete_map::DiscreteMap;
pub(in crate::core) use erasure::erased;
pub(in crate::core) use extremes::{Extremes, Overall, Sighting};
pub use field::{Equilibria, Forcing, VectorField};
pub(in crate::core) use forward::forward;
pub(crate) use measure::columns_showing;
pub(in crate::core) use measure::larger;
pub use measure::{Integral, Measure};
pub(crate) use names::distinct;
pub use names::{Group, Names, UnknownName, position};
pub(crate) use potential::PotentialGradient;
pub(crate) use scalar_field::{Domains, FieldIn, FieldRef, Fields, WideFields};
pub(in crate::core) use scalar_field::{WIDTH, Wide};
pub use watch::{Observable, State, Watch, WatchIn, Watchable};
pub(in crate::core) use watch::{Opposite, change_by, gradient};
pub use zero::{Dynamics, PlaneField, Profile, ZeroProblem};
pub(in crate::core) use zero_equations::{
    ROOM, TracedEquations, ZeroEquations, ZeroFunctions, ZeroMonitors, ZeroNumber,
};

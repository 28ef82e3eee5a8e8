//! Scenes: small RON files that state a problem and the branches to trace, for example with
//! `tangency trace scene.ron`.
//!
//! A [`Scene`] names a problem and consists of the settings of the problem, the values of its
//! parameters, and a list of runs. A run traces one branch or one curve of special points, and
//! starts from rest or at a special point of an earlier run.
//!
//! ```ron
//! Scene(
//!     title: "Clamped microplate through pull-in",
//!     problem: Plate(supports: "CCCC"),
//!     parameters: [("gap_ratio", 1.0)],
//!     runs: [
//!         Run(name: "plate", along: [(name: "load", low: 0.0)], bounds: [(name: "max_deflection", high: 0.9)]),
//!     ],
//! )
//! ```

mod attracted;
mod builtin;
mod by_name;
mod catalogue;
mod check;
mod check_accuracy;
mod check_run;
mod check_sweep;
mod columns;
mod corrected;
mod designs;
mod discretisation;
mod division;
mod effects;
mod error;
mod execute;
mod expansion;
mod explore;
mod fidelity;
mod find;
mod first_start;
mod follow_up;
mod forecast;
mod foreign;
mod identity;
mod join;
mod kinds;
mod ladder;
mod local;
mod manifolds;
mod notation;
mod observer;
mod options;
mod phase;
mod plane;
mod problem;
mod profile;
mod reach;
mod request;
mod requested;
mod requirements;
mod resolve;
mod sampling;
mod set;
mod simulate;
mod source;
mod stated;
mod statement;
mod sweep;
mod text;
mod trace;
mod words;
mod written;

pub use attracted::{Attracted, AttractorKind, Patience};
pub use builtin::{BUILT_IN, BuiltIn, LIBRARY};
pub use catalogue::{Catalogue, NamedScene};
pub use corrected::Correctable;
pub use designs::{Choices, designs};
pub use discretisation::{
    BoundarySettings, CollocationSettings, Discretisation, FieldSettings, HybridOrbitSettings,
    MapSettings, ShootingSettings, Solution, ZeroSettings,
};
pub use division::Division;
pub use effects::Purpose;
pub use error::{ProblemError, RunError, SceneError};
pub use execute::execute;
pub use expansion::{Expansion, ExpansionCurve, ExpansionError, expanded};
pub use explore::{Following, explore};
pub use find::Found;
pub use follow_up::FollowUp;
pub use forecast::SweepForecast;
pub use local::Local;
pub use manifolds::{DEVIATION, Manifolds};
pub use observer::SceneObserver;
pub use phase::{PhaseSpace, Place};
pub use problem::Problem;
pub use profile::Profile;
pub use request::{Request, SearchBox, Swept};
pub use resolve::{Resolution, Resolved, StartPoint};
pub use sampling::Sampling;
pub use simulate::Simulated;
pub use source::Files;
pub use stated::Stated;
pub use statement::{Grid, Range, Run, Scene, SoughtCrisis, Start, Sweep, Way};
pub use sweep::{SweepWatch, sweep};
pub use trace::Outcome;

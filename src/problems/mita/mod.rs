//! Models Mita's impact microactuator: a block on a spring within a frame, driven by a voltage.
//!
//! The voltage `V(t) = V sin ωt` attracts the block; impacts of the block on stoppers move the
//! frame against dry friction (X. Zhao, *Modeling and Simulation of MEMS Devices*, 2004, chapters
//! 2.2 and 4). [`Actuator`] is the hybrid system, [`Block`] describes the block without impacts,
//! and [`SwitchOn`] classifies the onset of impacts.
//!
//! All quantities are nondimensional: the mass of the block, the stiffness of the spring and the
//! electrode gap are 1.
//!
//! ```
//! use tangency::core::hybrid::{History, HybridFlow, HybridSettings, HybridState};
//! use tangency::problems::mita::Actuator;
//! let mut flow = HybridFlow::new(&Actuator, HybridSettings::default())?;
//! let mut state = HybridState { mode: Actuator::STICK, time: 0.0, x: vec![0.0, 0.0] };
//! let mut history = History::new(1);
//! flow.advance(&mut state, 100.0, &Actuator::DEFAULTS, &mut history)?;
//! // Vibration grows up to impacts on the front stopper, finally about one in each period π/ω = 2π.
//! let impacts = history.events.iter().filter(|event| event.guard == Actuator::FRONT);
//! let times: Vec<f64> = impacts.map(|event| event.time).collect();
//! assert!(times.len() == 9 && (times[0] - 49.063355).abs() < 1e-6);
//! assert!((times[8] - times[7] - std::f64::consts::TAU).abs() < 0.01);
//! # Ok::<(), tangency::core::hybrid::HybridError>(())
//! ```

mod actuator;
mod block;
mod parameters;
mod switch_on;

pub use actuator::Actuator;
pub use block::Block;
pub use switch_on::{SwitchOn, SwitchOnError};

//! Equations that are given as text.

mod errors;
mod fuzz;
mod hybrid_ends;
mod hybrid_equilibria;
mod hybrid_findings;
mod hybrid_invariance;
mod language;
mod lasting_sliding;
mod library;
mod library_of_impacts;
mod ode;
mod product_modes;
mod restated;
mod settling;
mod sliding_curves;
mod small_states;
mod starts;
mod timed_events;
mod units;

//! Equations that are given as text.

mod errors;
mod fuzz;
mod hybrid_ends;
mod hybrid_findings;
mod language;
mod library;
mod library_of_impacts;
mod ode;
mod restated;
mod settling;
mod sliding_curves;
mod small_states;
mod starts;
mod units;

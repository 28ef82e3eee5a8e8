//! Errors of the computation of manifolds.

use super::planar::Vector;
use crate::core::cancel::Cancelled;

/// Reasons why the manifolds of a saddle cannot be computed.
#[derive(Clone, Debug, PartialEq, miette::Diagnostic, thiserror::Error)]
#[non_exhaustive]
pub enum ManifoldError {
    /// The map does not have two states.
    #[error(
        "the map has {states} states, but manifolds are computed only for maps with two states"
    )]
    NotPlanar {
        /// The number of states.
        states: usize,
    },
    /// The number of states does not fit a cycle.
    #[error(
        "{found} numbers are not a cycle of a map with two states: each iterate of a cycle needs \
         two numbers"
    )]
    States {
        /// The number of given states.
        found: usize,
    },
    /// A setting is invalid.
    #[error("`{name}` is {value}: {rule}")]
    Setting {
        /// The setting.
        name: &'static str,
        /// Its value.
        value: f64,
        /// The condition that the value violates.
        rule: &'static str,
    },
    /// Newton's method finds no cycle.
    #[error("Newton's method finds no cycle of {iterates} iterates near ({}, {})", near[0], near[1])]
    #[diagnostic(help("start closer to the cycle"))]
    NoCycle {
        /// The number of iterates.
        iterates: usize,
        /// The first state of the start.
        near: Vector,
    },
    /// The cycle is shorter than requested.
    #[error("Newton's method converges to a cycle of {found} iterates instead of {wanted}")]
    #[diagnostic(help(
        "set `iterates` to {found}, or start closer to the cycle of {wanted} iterates"
    ))]
    Shorter {
        /// The number of iterates after which the states repeat.
        found: usize,
        /// The requested number of iterates.
        wanted: usize,
    },
    /// The saddle is outside the bounds.
    #[error("the saddle is outside the bounds of `{name}`: at the saddle, `{name}` = {value}")]
    #[diagnostic(help("widen the bounds"))]
    OutOfBounds {
        /// The state.
        name: String,
        /// The value of the state.
        value: f64,
    },
    /// The multipliers are complex.
    #[error("the cycle is a focus, not a saddle: its multipliers are {re:.6} ± {im:.6}i")]
    #[diagnostic(help(
        "start at a saddle: only saddles have both a stable and an unstable manifold"
    ))]
    Focus {
        /// The real part of the multipliers.
        re: f64,
        /// The imaginary part, positive.
        im: f64,
    },
    /// Both multipliers are on the same side of the unit circle.
    #[error(
        "the cycle is {} node, not a saddle: its multipliers are {:.6} and {:.6}",
        if multipliers[0].abs() > 1.0 { "an unstable" } else { "a stable" },
        multipliers[0],
        multipliers[1]
    )]
    #[diagnostic(help(
        "start at a saddle: only saddles have both a stable and an unstable manifold"
    ))]
    Node {
        /// The multipliers, the larger one first.
        multipliers: Vector,
    },
    /// A multiplier is too close to the unit circle.
    #[error(
        "the multiplier {multiplier:.9} of the saddle is too close to the unit circle: points \
         would need thousands of iterates to leave the saddle"
    )]
    #[diagnostic(help("change a parameter until |ln |multiplier|| exceeds {least:e}"))]
    Weak {
        /// The multiplier.
        multiplier: f64,
        /// The smallest allowed modulus of its logarithm.
        least: f64,
    },
    /// The map has no inverse at the saddle.
    #[error(
        "the multiplier {multiplier:.1e} of the saddle vanishes: the map is not invertible at the \
         saddle, so the stable manifold cannot be computed from preimages"
    )]
    #[diagnostic(help("compute the unstable manifold only"))]
    NoInverse {
        /// The multiplier.
        multiplier: f64,
    },
    /// The series of the local manifold is not accurate.
    #[error(
        "the series of the local manifold has an error of {error:.1e} even at a distance of \
         {distance:.1e} from the saddle: the map is not smooth near the saddle, or its derivative \
         over the cycle is too large for 16 digits"
    )]
    NoSeries {
        /// The error of the series.
        error: f64,
        /// The distance from the saddle.
        distance: f64,
    },
    /// The computation was cancelled.
    #[error(transparent)]
    #[diagnostic(transparent)]
    Cancelled(#[from] Cancelled),
}

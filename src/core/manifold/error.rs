//! Errors of the computation of manifolds.

use super::planar::Vector;
use crate::core::cancel::Cancelled;

/// The reason why the manifolds of a saddle cannot be computed.
#[derive(Clone, Debug, PartialEq, miette::Diagnostic, thiserror::Error)]
#[non_exhaustive]
pub enum ManifoldError {
    /// The number of states of the map is not two.
    #[error(
        "the map has {states} states, but manifolds are computed only for maps with two states"
    )]
    NotPlanar {
        /// The number of states of the map.
        states: usize,
    },
    /// The number of given states is not a positive multiple of the number of states of the map.
    #[error(
        "a cycle of a map with two states is given by two values for each iterate, but {found} \
         values are given"
    )]
    States {
        /// The number of given states.
        found: usize,
    },
    /// A setting of the growth of manifolds is invalid.
    #[error("`{name}` is {value}: {rule}")]
    Setting {
        /// The setting.
        name: &'static str,
        /// Its value.
        value: f64,
        /// The condition that the value violates.
        rule: &'static str,
    },
    /// Newton's method does not converge to a cycle.
    #[error("Newton's method finds no cycle of {iterates} iterates near ({}, {})", near[0], near[1])]
    #[diagnostic(help("start closer to the cycle"))]
    NoCycle {
        /// The requested number of iterates of the cycle.
        iterates: usize,
        /// The first point of the cycle, as given for the start of Newton's method.
        near: Vector,
    },
    /// The cycle found has fewer iterates than requested.
    #[error("Newton's method converges to a cycle of {found} iterates instead of {wanted}")]
    #[diagnostic(help(
        "set `iterates` to {found}, or start closer to the cycle of {wanted} iterates"
    ))]
    Shorter {
        /// The number of iterates after which the states of the cycle repeat.
        found: usize,
        /// The requested number of iterates of the cycle.
        wanted: usize,
    },
    /// A state of the saddle is outside its bounds.
    #[error("the saddle is outside the bounds of `{name}`: at the saddle, `{name}` = {value}")]
    #[diagnostic(help("widen the bounds"))]
    OutOfBounds {
        /// The state.
        name: String,
        /// The value of the state at the saddle.
        value: f64,
    },
    /// The multipliers of the cycle are complex.
    #[error("the cycle is a focus, not a saddle: its multipliers are {re:.6} ± {im:.6}i")]
    #[diagnostic(help(
        "start at a saddle: only saddles have both a stable and an unstable manifold"
    ))]
    Focus {
        /// The real part of the multipliers.
        re: f64,
        /// The positive imaginary part of the multipliers.
        im: f64,
    },
    /// Both multipliers of the cycle are on the same side of the unit circle.
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
        /// The multipliers; the multiplier of larger modulus is the first.
        multipliers: Vector,
    },
    /// A multiplier of the cycle is too close to the unit circle.
    #[error(
        "the multiplier {multiplier:.9} of the saddle is too close to the unit circle: points \
         would need thousands of iterates to leave the saddle"
    )]
    #[diagnostic(help("change a parameter until |ln |multiplier|| exceeds {least:e}"))]
    Weak {
        /// The multiplier.
        multiplier: f64,
        /// The smallest allowed modulus of the multiplier's logarithm.
        least: f64,
    },
    /// The map is not invertible at the saddle.
    #[error(
        "the multiplier {multiplier:.1e} of the saddle vanishes: the map is not invertible at the \
         saddle, so the stable manifold cannot be computed from preimages"
    )]
    #[diagnostic(help("compute the unstable manifold only"))]
    NoInverse {
        /// The multiplier.
        multiplier: f64,
    },
    /// The Taylor polynomial of the local manifold is not accurate enough.
    #[error(
        "the series of the local manifold has an error of {error:.1e} even at a distance of \
         {distance:.1e} from the saddle: the map is not smooth near the saddle, or its derivative \
         over the cycle is too large for 16 digits"
    )]
    NoSeries {
        /// The error of the Taylor polynomial.
        error: f64,
        /// The distance from the saddle at which the Taylor polynomial was tested.
        distance: f64,
    },
    /// The computation of the manifold was cancelled.
    #[error(transparent)]
    #[diagnostic(transparent)]
    Cancelled(#[from] Cancelled),
}

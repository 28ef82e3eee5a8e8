//! Kinds of special points that cannot occur in a flow with few states, because a flow preserves
//! orientation.

use crate::core::system::Kind;

/// Whether a special point of a kind can occur on periodic orbits with the given number of
/// nontrivial multipliers. The product of these multipliers is positive, because the flow of a
/// vector field preserves orientation.
pub(in crate::core) fn is_possible(kind: Kind, multipliers: usize) -> bool {
    let (critical, negative) = match kind {
        Kind::PD | Kind::GPD => (1, true),
        Kind::TR | Kind::CH | Kind::R1 | Kind::R2 | Kind::R3 | Kind::R4 => (2, false),
        Kind::LPPD => (2, true),
        Kind::LPNS => (3, false),
        Kind::PDNS => (3, true),
        Kind::NSNS => (4, false),
        _ => return true,
    };
    multipliers > critical || multipliers == critical && !negative
}

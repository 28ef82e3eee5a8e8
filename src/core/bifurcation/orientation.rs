//! Kinds of special points that a flow with few states cannot have, because it preserves orientation.

use crate::core::system::Kind;

/// Whether orbits can be special points of a kind if they have this number of nontrivial
/// multipliers, whose product is positive: the flow of a field preserves orientation.
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

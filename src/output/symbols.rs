//! The symbols of special points: each kind has its own symbol in a picture.

use super::figure::{Figure, Symbol};
use crate::core::system::Kind;

/// Returns the default symbol of a kind of special points. Related kinds have the same default
/// symbol.
pub(super) fn symbol(kind: Kind) -> Symbol {
    match kind {
        Kind::LP => Symbol::Disc,
        Kind::EP | Kind::RG => Symbol::Ring,
        Kind::BP => Symbol::Square,
        Kind::HB => Symbol::Diamond,
        // A coefficient vanishes.
        Kind::CP | Kind::GH | Kind::GPD | Kind::CH | Kind::GD | Kind::GF => Symbol::Star,
        Kind::HOM | Kind::OFS | Kind::OFU => Symbol::Star,
        // Another eigenvalue is critical.
        Kind::BT | Kind::ZH | Kind::HH | Kind::GL | Kind::GP => Symbol::Triangle,
        Kind::R1 | Kind::R2 | Kind::R3 | Kind::R4 => Symbol::Triangle,
        Kind::LPPD | Kind::LPNS | Kind::PDNS | Kind::NSNS => Symbol::Triangle,
        Kind::NSS | Kind::DRS | Kind::DRU => Symbol::Triangle,
        Kind::PD => Symbol::Pentagon,
        Kind::TR => Symbol::Hexagon,
        Kind::G => Symbol::TriangleLeft,
        Kind::UZ => Symbol::TriangleDown,
        // MX, ND, and all kinds without their own symbol.
        _ => Symbol::Cross,
    }
}

/// The symbols for kinds of special points whose default symbol is already used by another kind.
const FURTHER: [Symbol; 10] = [
    Symbol::FourStar,
    Symbol::OpenTriangle,
    Symbol::Plus,
    Symbol::OpenStar,
    Symbol::TriangleRight,
    Symbol::OpenDiamond,
    Symbol::OpenSquare,
    Symbol::SixStar,
    Symbol::OpenPentagon,
    Symbol::OpenHexagon,
];

/// Returns the alternatives to a default symbol, similar symbols first.
fn others(symbol: Symbol) -> impl Iterator<Item = Symbol> {
    let similar: &[Symbol] = match symbol {
        Symbol::Star => &[Symbol::FourStar, Symbol::OpenStar, Symbol::SixStar],
        Symbol::Triangle => &[Symbol::OpenTriangle, Symbol::TriangleRight],
        Symbol::Ring => &[Symbol::OpenSquare, Symbol::OpenDiamond],
        _ => &[Symbol::Plus],
    };
    similar.iter().copied().chain(FURTHER)
}

/// Chooses symbols such that every kind of special point in the panels of a picture has its own
/// symbol: of several kinds with the same default symbol, the first kind keeps this symbol. Kinds
/// share a symbol only if all symbols are in use.
pub(super) fn distinguish(figures: &mut [Figure]) {
    let mut taken: Vec<(String, Symbol)> = Vec::new();
    for mark in figures.iter_mut().flat_map(|figure| &mut figure.marks) {
        if matches!(mark.symbol, Symbol::Doubtful | Symbol::Number) {
            continue;
        }
        if let Some((_, symbol)) = taken.iter().find(|(meaning, _)| *meaning == mark.meaning) {
            mark.symbol = *symbol;
            continue;
        }
        let is_free = |symbol: &Symbol| taken.iter().all(|(_, other)| other != symbol);
        let usual = mark.symbol;
        mark.symbol = std::iter::once(usual).chain(others(usual)).find(is_free).unwrap_or(usual);
        taken.push((mark.meaning.clone(), mark.symbol));
    }
}

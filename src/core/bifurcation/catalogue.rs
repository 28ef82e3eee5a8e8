//! The catalogue of bifurcations. Each row describes one kind of bifurcation: the types of curves
//! on which it occurs, its test function on each type of curve, and its defining system. To add a
//! kind of bifurcation, write a file with its defining system, and add a row to the catalogue.

use super::branch_point::{BorderedDeterminant, BranchPoint};
use super::defining_system::DefiningSystem;
use super::degenerate_fold::DegenerateFold;
use super::fold::{FlippedCount, Fold, ParameterSlope};
use super::grazing::GrazingBifurcation;
use super::hopf::{Hopf, UnstablePairs};
use super::normal_form::{self, ComputeDivision, ComputeNormalForm};
use super::resonance::Resonance;
use super::stability::Critical;
use super::test_function::{
    Alternation, Amplitude, Auxiliary, ConditionValue, Criticality, TestFunction,
};
use crate::core::problem::Dynamics;
use crate::core::system::Kind;
use serde::de::{Error, Visitor};
use serde::{Deserialize, Deserializer};
use std::f64::consts::PI;
use std::sync::{Arc, LazyLock};

/// A function that creates a defining system for branches in the parameter with the given index.
pub(crate) type Make = fn(usize) -> Box<dyn DefiningSystem>;

/// A function that creates a test function.
pub(crate) type MakeTest = fn() -> Arc<dyn TestFunction>;

/// A kind of bifurcation.
pub(crate) struct Bifurcation {
    pub kind: Kind,
    /// The eigenvalues or multipliers that are critical at the point.
    pub critical: Critical,
    /// Computes the normal form at a bifurcation of this kind on a branch of solutions.
    pub normal_form: Option<ComputeNormalForm>,
    /// Computes which solutions exist on the two sides of a curve of bifurcations of this kind in
    /// the plane of two parameters.
    pub division: Option<ComputeDivision>,
    pub seen: &'static [Sighting],
}

/// The detection of a kind of bifurcation on one type of curve.
pub(crate) struct Sighting {
    /// The kinds of bifurcation whose defining systems are held along the curve; empty for branches
    /// of solutions.
    pub held: &'static [Kind],
    /// The type of the solutions on the curve.
    pub of: Solutions,
    /// The name of the bifurcation on this curve.
    pub name: &'static str,
    /// The function that creates the test function of the bifurcation on this type of curve.
    pub test: MakeTest,
    /// The function that creates the defining system, which together with the equations of the
    /// curve is regular at the point. `None` if the point is located by bracketing, for one of two
    /// reasons: the bifurcation has no defining system, or the equations of the curve are singular
    /// at the point and the values there are limits along the curve.
    pub defined_by: Option<Make>,
    pub beyond: Beyond,
    /// The kinds of special points whose curves emanate from the bifurcation, with one entry for
    /// each emanating curve; the curve on which the bifurcation is found is not included.
    #[cfg_attr(not(feature = "scene"), expect(dead_code, reason = "scenes follow curves"))]
    pub leaving: &'static [Kind],
}

/// The type of the solutions on a curve.
#[derive(Clone, Copy, PartialEq)]
pub(crate) enum Solutions {
    Any,
    Equilibria,
    Orbits,
}

/// The continuation of a curve beyond a bifurcation.
#[derive(Clone, Copy)]
pub(crate) enum Beyond {
    /// The curve continues beyond the bifurcation.
    Further,
    /// The curve continues beyond the bifurcation, but the defining systems that hold along the
    /// curve become singular at the bifurcation point. The defining system created by this function
    /// replaces the defining systems that become singular.
    Through(Make),
    /// The curve ends at the bifurcation. The defining systems held along the curve are singular at
    /// the end of the curve, and the defining system created by this function replaces them.
    End(Make),
    /// The continuation ends at the bifurcation, because the part of the curve beyond it is the
    /// mirror image of the part before it.
    Mirror,
}

impl Sighting {
    /// Whether a curve of bifurcations of this kind can be continued with one more released
    /// parameter.
    fn can_be_held(&self) -> bool {
        matches!(self.beyond, Beyond::Further) && self.defined_by.is_some()
    }

    /// Sets the kinds of the curves that emanate from a bifurcation of this kind.
    const fn leading_to(self, leaving: &'static [Kind]) -> Self {
        Sighting { leaving, ..self }
    }
}

impl Solutions {
    /// Whether the solutions of a system with the given dynamics are of this type.
    pub fn are(self, dynamics: Dynamics) -> bool {
        match self {
            Solutions::Any => true,
            Solutions::Equilibria => dynamics.is_flow(),
            Solutions::Orbits => dynamics == Dynamics::Periodic,
        }
    }

    fn words(self) -> &'static str {
        match self {
            Solutions::Any => "solutions",
            Solutions::Equilibria => "equilibria of a flow",
            Solutions::Orbits => "periodic orbits",
        }
    }
}

const fn seen(
    held: &'static [Kind],
    of: Solutions,
    name: &'static str,
    test: MakeTest,
    defined_by: Make,
) -> Sighting {
    let beyond = Beyond::Further;
    Sighting { held, of, name, test, defined_by: Some(defined_by), beyond, leaving: &[] }
}

/// Creates the detection of a bifurcation that is located by bracketing.
const fn bracketed(
    held: &'static [Kind],
    of: Solutions,
    name: &'static str,
    test: MakeTest,
) -> Sighting {
    let beyond = Beyond::Further;
    Sighting { held, of, name, test, defined_by: None, beyond, leaving: &[] }
}

const fn mirror(held: &'static [Kind], name: &'static str, test: MakeTest) -> Sighting {
    let beyond = Beyond::Mirror;
    Sighting { held, of: Solutions::Orbits, name, test, defined_by: None, beyond, leaving: &[] }
}

const fn row(
    kind: Kind,
    critical: Critical,
    normal_form: Option<ComputeNormalForm>,
    seen: &'static [Sighting],
) -> Bifurcation {
    Bifurcation { kind, critical, normal_form, division: None, seen }
}

use Solutions::{Any, Equilibria, Orbits};

const FOLDS: &[Kind] = &[Kind::LP];
const HOPF: &[Kind] = &[Kind::HB];
const DOUBLINGS: &[Kind] = &[Kind::PD];
const TORI: &[Kind] = &[Kind::TR];
const GRAZINGS: &[Kind] = &[Kind::G];

const CONDITION: MakeTest = || Arc::new(ConditionValue);
const PAIRS: MakeTest = || Arc::new(UnstablePairs);
const AMPLITUDE: MakeTest = || Arc::new(Amplitude);
const ALTERNATION: MakeTest = || Arc::new(Alternation::default());

const FOLD: Make = |_| Box::new(Fold::default());
const FLIP: Make = |_| Box::new(Fold::period_doubling());
const TORUS: Make = |_| Box::new(Hopf::neimark_sacker());
const CUSP: Make = |_| Box::new(DegenerateFold::cusp());

/// The test function of a resonance on a curve of torus points: the angle of the critical
/// multipliers, minus a level.
macro_rules! angle {
    ($level:expr) => {
        || Arc::new(Auxiliary { unknown: 0, level: $level })
    };
}

/// All kinds of bifurcation, in the order in which they are tested.
pub(crate) static CATALOGUE: [Bifurcation; 24] = [
    row(
        Kind::BP,
        Critical::One,
        Some(normal_form::crossing),
        &[seen(
            &[],
            Any,
            "branch point",
            || Arc::new(BorderedDeterminant),
            |parameter| Box::new(BranchPoint::new(parameter)),
        )],
    )
    .dividing(normal_form::of_crossings),
    row(
        Kind::LP,
        Critical::One,
        Some(normal_form::fold),
        &[seen(&[], Any, "fold", || Arc::new(ParameterSlope), FOLD)],
    )
    .dividing(normal_form::of_folds),
    row(
        Kind::HB,
        Critical::Pair,
        Some(normal_form::hopf),
        &[
            seen(&[], Equilibria, "Hopf point", PAIRS, |_| Box::new(Hopf::of_equilibria())),
            mirror(&[], "Hopf point: the cycles shrink onto an equilibrium", AMPLITUDE),
        ],
    )
    .dividing(normal_form::of_pairs),
    row(
        Kind::PD,
        Critical::MinusOne,
        Some(normal_form::doubling),
        &[seen(&[], Orbits, "period doubling", || Arc::new(FlippedCount), FLIP)],
    )
    .dividing(normal_form::of_doublings),
    row(
        Kind::TR,
        Critical::Pair,
        Some(normal_form::torus),
        &[seen(&[], Orbits, "torus point", PAIRS, TORUS)],
    )
    .dividing(normal_form::of_pairs),
    row(
        Kind::CP,
        Critical::None,
        Some(normal_form::cusp),
        &[seen(FOLDS, Any, "cusp", CONDITION, CUSP)],
    ),
    row(
        Kind::BT,
        Critical::None,
        Some(normal_form::bogdanov_takens),
        &[
            seen(FOLDS, Equilibria, "Bogdanov–Takens point", CONDITION, |_| {
                Box::new(DegenerateFold::bogdanov_takens())
            })
            .leading_to(&[Kind::HB, Kind::HOM]),
            // Where the frequency, the auxiliary unknown of Hopf points, vanishes: the curve beyond
            // would repeat itself with negative frequency.
            Sighting {
                held: HOPF,
                of: Equilibria,
                name: "Bogdanov–Takens point",
                test: || Arc::new(Auxiliary { unknown: 0, level: 0.0 }),
                defined_by: Some(|_| Box::new(DegenerateFold::bogdanov_takens())),
                beyond: Beyond::End(FOLD),
                leaving: &[Kind::LP, Kind::HOM],
            },
        ],
    ),
    row(
        Kind::GH,
        Critical::None,
        Some(normal_form::bautin),
        &[
            bracketed(HOPF, Equilibria, "generalised Hopf point", || {
                Arc::new(Criticality(normal_form::pair_rate))
            })
            .leading_to(FOLDS),
            mirror(
                FOLDS,
                "generalised Hopf point: the cycles shrink onto an equilibrium",
                AMPLITUDE,
            ),
        ],
    ),
    row(
        Kind::ZH,
        Critical::None,
        Some(normal_form::fold_hopf),
        &[
            seen(HOPF, Equilibria, "fold–Hopf point", CONDITION, FOLD)
                .leading_to(&[Kind::LP, Kind::TR]),
            seen(FOLDS, Equilibria, "fold–Hopf point", PAIRS, |_| Box::new(Hopf::of_equilibria()))
                .leading_to(&[Kind::HB, Kind::TR]),
            // The angle of the critical multipliers vanishes with the amplitude.
            mirror(TORI, "fold–Hopf point: the cycles shrink onto an equilibrium", angle!(0.0)),
        ],
    ),
    row(
        Kind::HH,
        Critical::None,
        Some(normal_form::double_hopf),
        &[
            seen(HOPF, Equilibria, "double Hopf point", PAIRS, |_| Box::new(Hopf::second(false)))
                // A curve of torus points emanates for the cycles of each of the two pairs.
                .leading_to(&[Kind::HB, Kind::TR, Kind::TR]),
            mirror(TORI, "double Hopf point: the cycles shrink onto an equilibrium", AMPLITUDE),
        ],
    ),
    row(
        Kind::R1,
        Critical::None,
        Some(normal_form::one_to_one),
        &[
            seen(FOLDS, Orbits, "resonance 1:1", CONDITION, |_| {
                Box::new(DegenerateFold::double_one())
            })
            .leading_to(TORI),
            Sighting {
                held: TORI,
                of: Orbits,
                name: "resonance 1:1",
                test: angle!(0.0),
                defined_by: Some(|_| Box::new(DegenerateFold::double_one())),
                beyond: Beyond::End(FOLD),
                leaving: FOLDS,
            },
        ],
    ),
    row(
        Kind::R2,
        Critical::None,
        Some(normal_form::one_to_two),
        &[
            seen(DOUBLINGS, Orbits, "resonance 1:2", CONDITION, |_| {
                Box::new(DegenerateFold::double_minus_one())
            })
            // The second curve consists of doubled orbits.
            .leading_to(&[Kind::TR, Kind::TR]),
            Sighting {
                held: TORI,
                of: Orbits,
                name: "resonance 1:2",
                test: angle!(PI),
                defined_by: Some(|_| Box::new(DegenerateFold::double_minus_one())),
                beyond: Beyond::End(FLIP),
                // Torus points of doubled orbits.
                leaving: &[Kind::PD, Kind::TR],
            },
        ],
    ),
    row(
        Kind::R3,
        Critical::None,
        Some(normal_form::one_to_three),
        &[Sighting {
            held: TORI,
            of: Orbits,
            name: "resonance 1:3",
            test: angle!(2.0 * PI / 3.0),
            defined_by: Some(|_| Box::new(Resonance::imaginary(2.0 * PI / 3.0))),
            beyond: Beyond::Through(|_| Box::new(Resonance::real(2.0 * PI / 3.0))),
            leaving: &[],
        }],
    ),
    row(
        Kind::R4,
        Critical::None,
        Some(normal_form::one_to_four),
        &[Sighting {
            held: TORI,
            of: Orbits,
            name: "resonance 1:4",
            test: angle!(0.5 * PI),
            defined_by: Some(|_| Box::new(Resonance::imaginary(0.5 * PI))),
            beyond: Beyond::Through(|_| Box::new(Resonance::real(0.5 * PI))),
            leaving: &[],
        }],
    ),
    row(
        Kind::GPD,
        Critical::None,
        Some(normal_form::generalised_doubling),
        &[
            bracketed(DOUBLINGS, Orbits, "generalised period doubling", || {
                Arc::new(Criticality(normal_form::doubling_rate))
            })
            .leading_to(FOLDS),
            mirror(
                FOLDS,
                "generalised period doubling: the doubled orbits shrink onto orbits of half the period",
                ALTERNATION,
            ),
        ],
    ),
    row(
        Kind::CH,
        Critical::None,
        Some(normal_form::chenciner),
        &[bracketed(TORI, Orbits, "Chenciner point", || {
            Arc::new(Criticality(normal_form::pair_rate))
        })],
    ),
    row(
        Kind::LPPD,
        Critical::None,
        Some(normal_form::fold_flip),
        &[
            seen(FOLDS, Orbits, "fold–flip point", CONDITION, FLIP).leading_to(DOUBLINGS),
            seen(DOUBLINGS, Orbits, "fold–flip point", CONDITION, FOLD).leading_to(FOLDS),
        ],
    ),
    row(
        Kind::LPNS,
        Critical::None,
        Some(normal_form::fold_torus),
        &[
            seen(FOLDS, Orbits, "fold–torus point", PAIRS, TORUS).leading_to(TORI),
            seen(TORI, Orbits, "fold–torus point", CONDITION, FOLD).leading_to(FOLDS),
        ],
    ),
    row(
        Kind::PDNS,
        Critical::None,
        Some(normal_form::flip_torus),
        &[
            seen(DOUBLINGS, Orbits, "flip–torus point", PAIRS, TORUS).leading_to(TORI),
            seen(TORI, Orbits, "flip–torus point", CONDITION, FLIP).leading_to(DOUBLINGS),
            mirror(
                TORI,
                "flip–torus point: the doubled orbits shrink onto orbits of half the period",
                ALTERNATION,
            ),
        ],
    ),
    row(
        Kind::NSNS,
        Critical::None,
        Some(normal_form::double_torus),
        &[seen(TORI, Orbits, "double torus point", PAIRS, |_| Box::new(Hopf::second(true)))
            .leading_to(TORI)],
    ),
    row(
        Kind::GD,
        Critical::None,
        None,
        &[seen(GRAZINGS, Any, "degenerate grazing", CONDITION, |_| {
            Box::new(GrazingBifurcation::of(Kind::GD))
        })],
    ),
    row(
        Kind::GF,
        Critical::None,
        None,
        &[seen(GRAZINGS, Orbits, "degenerate grazing of flip type", CONDITION, |_| {
            Box::new(GrazingBifurcation::of(Kind::GF))
        })],
    ),
    row(
        Kind::GL,
        Critical::None,
        None,
        &[seen(GRAZINGS, Any, "nonhyperbolic grazing of fold type", CONDITION, |_| {
            Box::new(GrazingBifurcation::of(Kind::GL))
        })],
    ),
    row(
        Kind::GP,
        Critical::None,
        None,
        &[seen(GRAZINGS, Orbits, "nonhyperbolic grazing of flip type", CONDITION, |_| {
            Box::new(GrazingBifurcation::of(Kind::GP))
        })],
    ),
];

/// Kinds of codimension-two points.
impl Kind {
    /// `GH`: a generalised Hopf (Bautin) point, where the first Lyapunov coefficient vanishes and a
    /// curve of folds of cycles ends on a curve of Hopf points.
    pub const GH: Kind = Kind::new("GH", "generalised Hopf point");
    /// `ZH`: a fold–Hopf (zero–Hopf) point of equilibria.
    pub const ZH: Kind = Kind::new("ZH", "fold–Hopf point");
    /// `HH`: a double Hopf (Hopf–Hopf) point of equilibria.
    pub const HH: Kind = Kind::new("HH", "double Hopf point");
    /// `R1`: a resonance 1:1 of periodic orbits, with a double multiplier 1.
    pub const R1: Kind = Kind::new("R1", "resonance 1:1");
    /// `R2`: a resonance 1:2 of periodic orbits, with a double multiplier −1.
    pub const R2: Kind = Kind::new("R2", "resonance 1:2");
    /// `R3`: a resonance 1:3 of periodic orbits, with the multipliers `e^{±2πi/3}`.
    pub const R3: Kind = Kind::new("R3", "resonance 1:3");
    /// `R4`: a resonance 1:4 of periodic orbits, with the multipliers `±i`.
    pub const R4: Kind = Kind::new("R4", "resonance 1:4");
    /// `GPD`: a generalised period doubling, where the emanating branch of doubled orbits changes
    /// between supercritical and subcritical.
    pub const GPD: Kind = Kind::new("GPD", "generalised period doubling");
    /// `CH`: a Chenciner point, where the emanating branch of tori changes between supercritical
    /// and subcritical.
    pub const CH: Kind = Kind::new("CH", "Chenciner point");
    /// `LPPD`: a fold–flip point of periodic orbits, with the multipliers 1 and −1.
    pub const LPPD: Kind = Kind::new("LPPD", "fold–flip point");
    /// `LPNS`: a fold–torus point of periodic orbits, with the multipliers 1 and `e^{±iθ}`.
    pub const LPNS: Kind = Kind::new("LPNS", "fold–torus point");
    /// `PDNS`: a flip–torus point of periodic orbits, with the multipliers −1 and `e^{±iθ}`.
    pub const PDNS: Kind = Kind::new("PDNS", "flip–torus point");
    /// `NSNS`: a double torus point of periodic orbits, with two critical pairs of multipliers.
    pub const NSNS: Kind = Kind::new("NSNS", "double torus point");
}

/// Returns the row of a kind of bifurcation in the catalogue.
pub(crate) fn row_of(kind: Kind) -> Option<&'static Bifurcation> {
    CATALOGUE.iter().find(|row| row.kind == kind)
}

/// Returns the kinds of special points that can be followed along curves in two parameters.
#[cfg(feature = "scene")]
pub(crate) fn of_curves() -> Vec<Kind> {
    let alone = |it: &Sighting| it.held.is_empty() && matches!(it.beyond, Beyond::Further);
    let rows = CATALOGUE.iter().filter(|row| row.seen.iter().any(alone));
    rows.map(|row| row.kind).chain([Kind::G, Kind::HOM]).collect()
}

/// Returns the kinds of the curves that emanate at a point of kind `kind` on a curve of points of
/// kind `held`.
#[cfg(feature = "scene")]
pub(crate) fn leaving(held: Kind, kind: Kind) -> &'static [Kind] {
    let on = |it: &&Sighting| it.held == [held] && !it.leaving.is_empty();
    row_of(kind).and_then(|row| row.seen.iter().find(on)).map_or(&[], |it| it.leaving)
}

/// Whether the solutions at all special points of this kind are periodic orbits, or homoclinic
/// orbits.
#[cfg(feature = "scene")]
pub(crate) fn is_of_orbits(kind: Kind) -> bool {
    let seen = row_of(kind).map_or(&[][..], |row| row.seen);
    kind == Kind::HOM || !seen.is_empty() && seen.iter().all(|it| it.of == Orbits)
}

/// Whether a curve that emanates at a codimension-two point of equilibria consists of cycles.
/// `held` is the kind of the points along the emanating curve.
pub(crate) fn is_of_cycles(point: Kind, held: Kind) -> bool {
    matches!(
        (point, held),
        (Kind::GH, Kind::LP) | (Kind::ZH | Kind::HH, Kind::TR) | (Kind::BT, Kind::HOM)
    )
}

/// Whether a curve that emanates at a codimension-two point consists of doubled orbits. Examples
/// are the curve that emanates at a resonance 1:2 found on a curve of torus points, and the second
/// curve that emanates at a resonance 1:2 found on another curve.
pub(crate) fn is_of_doubled((point, on): (Kind, Option<Kind>), held: Kind, which: usize) -> bool {
    match (point, held) {
        (Kind::GPD, Kind::LP) => true,
        (Kind::R2, Kind::TR) => which > 0 || on == Some(Kind::TR),
        _ => false,
    }
}

/// Returns the kinds of codimension-two points at which further curves of bifurcations emanate.
#[cfg(feature = "scene")]
pub(crate) fn crossings() -> Vec<Kind> {
    let leads = |row: &&Bifurcation| row.seen.iter().any(|it| !it.leaving.is_empty());
    CATALOGUE.iter().filter(leads).map(|row| row.kind).collect()
}

impl Bifurcation {
    /// Sets the function that computes how a curve of bifurcations of this kind divides the plane
    /// of two parameters.
    const fn dividing(self, division: ComputeDivision) -> Self {
        Bifurcation { division: Some(division), ..self }
    }

    /// Returns how this bifurcation is detected on curves along which the defining systems of the
    /// kinds `others` are held.
    pub fn on(&self, dynamics: Dynamics, others: &[Kind]) -> Option<&Sighting> {
        let fits = |it: &&Sighting| {
            it.of.are(dynamics) && it.held.iter().all(|kind| others.contains(kind))
        };
        self.seen.iter().filter(|it| it.can_be_held()).find(fits)
    }

    /// Returns the reason why this bifurcation cannot be held along a curve together with the kinds
    /// `others`; `None` if it can be held.
    pub fn why_not_held(&self, dynamics: Dynamics, others: &[Kind]) -> Option<String> {
        if self.on(dynamics, others).is_some() {
            return None;
        }
        let passed = self.seen.iter().filter(|it| it.can_be_held());
        let curves = passed.map(|it| match it.held {
            [] => format!("branches of {}", it.of.words()),
            [kind, ..] => format!(
                "curves of {}s of {} (hold {kind} as well, and release one more parameter)",
                kind.meaning(),
                it.of.words()
            ),
        });
        let curves: Vec<String> = curves.collect();
        if curves.is_empty() {
            return Some(
                "the library has no defining system for curves of special points of this kind"
                    .into(),
            );
        }
        Some(format!("it lies on {}", curves.join(", and on ")))
    }
}

/// The abbreviations of all kinds.
static LETTERS: LazyLock<Vec<&'static str>> = LazyLock::new(|| all().map(Kind::letters).collect());

fn all() -> impl Iterator<Item = Kind> {
    CATALOGUE.iter().map(|row| row.kind).chain(Kind::PLAIN)
}

impl Kind {
    /// Whether the library defines this kind, so that files can contain points of the kind.
    pub fn is_known(self) -> bool {
        all().any(|kind| kind == self)
    }
}

impl<'de> Deserialize<'de> for Kind {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        struct Letters;
        impl Visitor<'_> for Letters {
            type Value = Kind;

            fn expecting(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
                write!(f, "the kind of a special point: one of {}", LETTERS.join(", "))
            }

            fn visit_str<E: Error>(self, letters: &str) -> Result<Kind, E> {
                let unknown = || E::unknown_variant(letters, &LETTERS);
                all().find(|kind| kind.letters() == letters).ok_or_else(unknown)
            }
        }
        deserializer.deserialize_identifier(Letters)
    }
}

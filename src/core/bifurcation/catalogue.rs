//! The catalogue of bifurcations: a row for each kind says which curves it lies on, how it is
//! noticed there, and what defines it. A further kind is a file with its defining system, and a row
//! here.

use super::branch_point::{BorderedDeterminant, BranchPoint};
use super::defining_system::DefiningSystem;
use super::degenerate_fold::DegenerateFold;
use super::fold::{FlippedCount, Fold, ParameterSlope};
use super::grazing::GrazingBifurcation;
use super::hopf::{Hopf, UnstablePairs};
use super::normal_form::{self, NormalForm};
use super::stability::Critical;
use super::test_function::{Amplitude, Auxiliary, ConditionValue, TestFunction};
use crate::core::problem::Dynamics;
use crate::core::system::Kind;
use serde::de::{Error, Visitor};
use serde::{Deserialize, Deserializer};
use std::f64::consts::PI;
use std::sync::{Arc, LazyLock};

/// Makes a condition for branches in the parameter at this position.
pub(crate) type Make = fn(usize) -> Box<dyn DefiningSystem>;

/// Makes a test function.
pub(crate) type MakeTest = fn() -> Arc<dyn TestFunction>;

/// A kind of bifurcation.
pub(crate) struct Bifurcation {
    pub kind: Kind,
    /// Its defining system, which together with the branch is regular at the point; `None` where
    /// the branch's own equations are singular there, and its values are limits.
    pub defined_by: Option<Make>,
    /// The eigenvalues or multipliers that are critical there.
    pub critical: Critical,
    /// Its normal form on branches of solutions.
    pub normal_form: Option<NormalForm>,
    pub seen: &'static [Sighting],
}

/// How a kind of bifurcation is noticed on one sort of curve.
pub(crate) struct Sighting {
    /// What is held along the curve: nothing along branches of solutions.
    pub held: &'static [Kind],
    /// What the solutions are.
    pub of: Solutions,
    /// Its name there.
    pub name: &'static str,
    /// Its test function.
    pub test: MakeTest,
    pub beyond: Beyond,
}

/// What solutions are.
#[derive(Clone, Copy, PartialEq)]
pub(crate) enum Solutions {
    Any,
    Equilibria,
    Orbits,
}

/// How a curve goes on beyond a bifurcation.
#[derive(Clone, Copy)]
pub(crate) enum Beyond {
    /// It does.
    Further,
    /// It ends. The conditions held along it are singular there, and this one stands in their
    /// place.
    End(Make),
    /// It goes back over itself, as its own mirror image, and so ends.
    Mirror,
}

impl Solutions {
    /// Whether those of a system are such ones.
    pub fn are(self, dynamics: Dynamics) -> bool {
        match self {
            Solutions::Any => true,
            Solutions::Equilibria => dynamics == Dynamics::Flow,
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
) -> Sighting {
    Sighting { held, of, name, test, beyond: Beyond::Further }
}

const fn mirror(held: &'static [Kind], name: &'static str, test: MakeTest) -> Sighting {
    Sighting { held, of: Solutions::Orbits, name, test, beyond: Beyond::Mirror }
}

use Solutions::{Any, Equilibria, Orbits};

/// All kinds, in the order in which they are looked for.
pub(crate) static CATALOGUE: [Bifurcation; 14] = [
    Bifurcation {
        kind: Kind::BP,
        defined_by: Some(|parameter| Box::new(BranchPoint::new(parameter))),
        critical: Critical::One,
        normal_form: None,
        seen: &[seen(&[], Any, "branch point", || Arc::new(BorderedDeterminant))],
    },
    Bifurcation {
        kind: Kind::LP,
        defined_by: Some(|_| Box::new(Fold::default())),
        critical: Critical::One,
        normal_form: Some(normal_form::fold),
        seen: &[seen(&[], Any, "fold", || Arc::new(ParameterSlope))],
    },
    Bifurcation {
        kind: Kind::HB,
        defined_by: Some(|_| Box::new(Hopf::of_equilibria())),
        critical: Critical::Pair,
        normal_form: Some(normal_form::hopf),
        seen: &[
            seen(&[], Equilibria, "Hopf point", || Arc::new(UnstablePairs)),
            mirror(&[], "Hopf point: the cycles shrink onto an equilibrium", || {
                Arc::new(Amplitude)
            }),
        ],
    },
    Bifurcation {
        kind: Kind::PD,
        defined_by: Some(|_| Box::new(Fold::period_doubling())),
        critical: Critical::MinusOne,
        normal_form: None,
        seen: &[seen(&[], Orbits, "period doubling", || Arc::new(FlippedCount))],
    },
    Bifurcation {
        kind: Kind::TR,
        defined_by: Some(|_| Box::new(Hopf::neimark_sacker())),
        critical: Critical::Pair,
        normal_form: None,
        seen: &[seen(&[], Orbits, "torus point", || Arc::new(UnstablePairs))],
    },
    Bifurcation {
        kind: Kind::CP,
        defined_by: Some(|_| Box::new(DegenerateFold::cusp())),
        critical: Critical::None,
        normal_form: None,
        seen: &[seen(&[Kind::LP], Any, "cusp", || Arc::new(ConditionValue))],
    },
    Bifurcation {
        kind: Kind::BT,
        defined_by: Some(|_| Box::new(DegenerateFold::bogdanov_takens())),
        critical: Critical::None,
        normal_form: None,
        seen: &[
            seen(&[Kind::LP], Equilibria, "Bogdanov–Takens point", || Arc::new(ConditionValue)),
            // Where the frequency, the auxiliary unknown of Hopf points, vanishes: beyond, the
            // curve would be traced back with negative frequency.
            Sighting {
                held: &[Kind::HB],
                of: Equilibria,
                name: "Bogdanov–Takens point",
                test: || Arc::new(Auxiliary { unknown: 0, level: 0.0 }),
                beyond: Beyond::End(|_| Box::new(Fold::default())),
            },
        ],
    },
    Bifurcation {
        kind: Kind::GH,
        defined_by: None,
        critical: Critical::None,
        normal_form: None,
        seen: &[mirror(
            &[Kind::LP],
            "generalised Hopf point: the cycles shrink onto an equilibrium",
            || Arc::new(Amplitude),
        )],
    },
    Bifurcation {
        kind: Kind::R1,
        defined_by: None,
        critical: Critical::None,
        normal_form: None,
        seen: &[mirror(&[Kind::TR], "resonance 1:1", || {
            Arc::new(Auxiliary { unknown: 0, level: 0.0 })
        })],
    },
    Bifurcation {
        kind: Kind::R2,
        defined_by: None,
        critical: Critical::None,
        normal_form: None,
        seen: &[mirror(&[Kind::TR], "resonance 1:2", || {
            Arc::new(Auxiliary { unknown: 0, level: PI })
        })],
    },
    Bifurcation {
        kind: Kind::GD,
        defined_by: Some(|_| Box::new(GrazingBifurcation::of(Kind::GD))),
        critical: Critical::None,
        normal_form: None,
        seen: &[seen(&[Kind::G], Any, "degenerate grazing", || Arc::new(ConditionValue))],
    },
    Bifurcation {
        kind: Kind::GF,
        defined_by: Some(|_| Box::new(GrazingBifurcation::of(Kind::GF))),
        critical: Critical::None,
        normal_form: None,
        seen: &[seen(&[Kind::G], Orbits, "degenerate grazing of flip type", || {
            Arc::new(ConditionValue)
        })],
    },
    Bifurcation {
        kind: Kind::GL,
        defined_by: Some(|_| Box::new(GrazingBifurcation::of(Kind::GL))),
        critical: Critical::None,
        normal_form: None,
        seen: &[seen(&[Kind::G], Any, "nonhyperbolic grazing of fold type", || {
            Arc::new(ConditionValue)
        })],
    },
    Bifurcation {
        kind: Kind::GP,
        defined_by: Some(|_| Box::new(GrazingBifurcation::of(Kind::GP))),
        critical: Critical::None,
        normal_form: None,
        seen: &[seen(&[Kind::G], Orbits, "nonhyperbolic grazing of flip type", || {
            Arc::new(ConditionValue)
        })],
    },
];

/// Kinds at which curves of periodic orbits end as their own mirror images.
impl Kind {
    /// `GH`: a generalised Hopf (Bautin) point, where a curve of folds of cycles ends on a curve of
    /// Hopf points.
    pub const GH: Kind = Kind::new("GH", "generalised Hopf point");
    /// `R1`: a resonance 1:1, where a curve of torus points ends with a double multiplier 1.
    pub const R1: Kind = Kind::new("R1", "resonance 1:1");
    /// `R2`: a resonance 1:2, where a curve of torus points ends with a double multiplier −1.
    pub const R2: Kind = Kind::new("R2", "resonance 1:2");
}

/// The row of a kind.
pub(crate) fn row(kind: Kind) -> Option<&'static Bifurcation> {
    CATALOGUE.iter().find(|row| row.kind == kind)
}

/// The kinds of special points that are followed along curves in two parameters.
#[cfg(feature = "scene")]
pub(crate) fn of_curves() -> Vec<Kind> {
    let alone = |it: &Sighting| it.held.is_empty() && matches!(it.beyond, Beyond::Further);
    let rows =
        CATALOGUE.iter().filter(|row| row.defined_by.is_some() && row.seen.iter().any(alone));
    rows.map(|row| row.kind).chain([Kind::G]).collect()
}

impl Bifurcation {
    /// Why such points of a system's solutions cannot be held along a curve on which others are
    /// held; `None` if they can.
    pub fn why_not_held(&self, dynamics: Dynamics, others: &[Kind]) -> Option<String> {
        let passed = self.seen.iter().filter(|it| matches!(it.beyond, Beyond::Further));
        let fits =
            |it: &Sighting| it.of.are(dynamics) && it.held.iter().all(|kind| others.contains(kind));
        if passed.clone().any(fits) {
            return None;
        }
        let curves = passed.map(|it| match it.held {
            [] => format!("branches of {}", it.of.words()),
            [kind, ..] => format!(
                "curves of {}s of {} (hold {kind} as well, and release one more parameter)",
                kind.meaning(),
                it.of.words()
            ),
        });
        let curves: Vec<String> = curves.collect();
        Some(format!("it lies on {}", curves.join(", and on ")))
    }
}

/// The letters of all kinds.
static LETTERS: LazyLock<Vec<&'static str>> = LazyLock::new(|| all().map(Kind::letters).collect());

fn all() -> impl Iterator<Item = Kind> {
    CATALOGUE.iter().map(|row| row.kind).chain(Kind::PLAIN)
}

impl Kind {
    /// Whether the library has this kind, so that files can hold points of the kind.
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

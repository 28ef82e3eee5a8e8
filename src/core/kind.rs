//! Kinds of special points.

use serde::{Deserialize, Serialize};

/// The kind of a special point, written as the two letters that the field reads at a glance.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[non_exhaustive]
pub enum Kind {
    /// `EP`: an end of the branch, or its start.
    EP,
    /// `LP`: a limit point or fold.
    LP,
    /// `BP`: a branch point.
    BP,
    /// `HB`: a Hopf point.
    HB,
    /// `CP`: a cusp on a curve of folds.
    CP,
    /// `BT`: a Bogdanov–Takens point.
    BT,
    /// `PD`: a period doubling of periodic orbits.
    PD,
    /// `TR`: a torus (Neimark–Sacker) point of periodic orbits.
    TR,
    /// `GH`: a generalised Hopf (Bautin) point, where a curve of folds of cycles ends on a curve of Hopf points.
    GH,
    /// `R1`: a resonance 1:1, where a curve of torus points ends with a double multiplier 1.
    R1,
    /// `R2`: a resonance 1:2, where a curve of torus points ends with a double multiplier −1.
    R2,
    /// `ND`: an unclassified point: the number of unstable eigenvalues changes, and no event that was looked for
    /// explains it.
    ND,
    /// `G`: a grazing: the solution touches a surface.
    G,
    /// `RG`: a regular point that was saved on request.
    RG,
    /// `UZ`: a user's event.
    UZ,
    /// `MX`: the branch ended because a method failed.
    MX,
}

impl Kind {
    /// What the two letters mean, in words.
    ///
    /// ```
    /// use tangency::core::continuation::Kind;
    /// assert_eq!((Kind::LP.to_string(), Kind::LP.meaning()), ("LP".to_string(), "fold"));
    /// ```
    pub fn meaning(self) -> &'static str {
        match self {
            Kind::EP => "end point",
            Kind::LP => "fold",
            Kind::BP => "branch point",
            Kind::HB => "Hopf point",
            Kind::CP => "cusp",
            Kind::BT => "Bogdanov–Takens point",
            Kind::PD => "period doubling",
            Kind::TR => "torus point",
            Kind::GH => "generalised Hopf point",
            Kind::R1 => "resonance 1:1",
            Kind::R2 => "resonance 1:2",
            Kind::ND => "unclassified point",
            Kind::G => "grazing",
            Kind::RG => "regular point",
            Kind::UZ => "user's point",
            Kind::MX => "method failed",
        }
    }
}

impl std::fmt::Display for Kind {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.pad(&format!("{self:?}"))
    }
}

//! Kinds of special points.

use serde::{Serialize, Serializer};

/// The kind of a special point, with its usual label of two or three letters.
///
/// Kinds of bifurcations are declared with their defining systems and listed in the catalogue in
/// `bifurcation/catalogue.rs`.
///
/// ```
/// use tangency::core::system::Kind;
/// assert_eq!((Kind::LP.to_string(), Kind::LP.meaning()), ("LP".to_string(), "fold"));
/// ```
#[derive(Clone, Copy, PartialEq, Eq, Hash)]
pub struct Kind {
    letters: &'static str,
    meaning: &'static str,
}

/// Declares the kinds of special points that are not bifurcations.
impl Kind {
    /// `EP`: an end point of the branch, or the start of the branch.
    pub const EP: Kind = Kind::new("EP", "end point");
    /// `G`: a grazing: the solution touches a surface.
    pub const G: Kind = Kind::new("G", "grazing");
    /// `HOM`: a homoclinic orbit.
    pub const HOM: Kind = Kind::new("HOM", "homoclinic orbit");
    /// `NSS`: a homoclinic orbit to a neutral saddle, whose leading eigenvalues have opposite real parts.
    pub const NSS: Kind = Kind::new("NSS", "neutral saddle");
    /// `DRS`: a homoclinic orbit to a saddle with a double leading stable eigenvalue, at the transition
    /// to a saddle-focus.
    pub const DRS: Kind = Kind::new("DRS", "double leading stable eigenvalue");
    /// `DRU`: a homoclinic orbit to a saddle with a double leading unstable eigenvalue.
    pub const DRU: Kind = Kind::new("DRU", "double leading unstable eigenvalue");
    /// `OFS`: an orbit flip: a homoclinic orbit that enters along the strong stable manifold.
    pub const OFS: Kind = Kind::new("OFS", "orbit flip in the stable manifold");
    /// `OFU`: an orbit flip: a homoclinic orbit that leaves along the strong unstable manifold.
    pub const OFU: Kind = Kind::new("OFU", "orbit flip in the unstable manifold");
    /// `RG`: a regular point that was saved on request.
    pub const RG: Kind = Kind::new("RG", "regular point");
    /// `UZ`: a user-defined event.
    pub const UZ: Kind = Kind::new("UZ", "user's point");
    /// `ND`: an unclassified point: the number of unstable eigenvalues changes, and none of the monitored
    /// events explains the change.
    pub const ND: Kind = Kind::new("ND", "unclassified point");
    /// `MX`: the branch ended because a method failed.
    pub const MX: Kind = Kind::new("MX", "method failed");

    /// All kinds that are not bifurcations.
    pub(crate) const PLAIN: [Kind; 12] = [
        Kind::EP,
        Kind::G,
        Kind::HOM,
        Kind::NSS,
        Kind::DRS,
        Kind::DRU,
        Kind::OFS,
        Kind::OFU,
        Kind::RG,
        Kind::UZ,
        Kind::ND,
        Kind::MX,
    ];
}

impl Kind {
    /// Creates a kind with the given letters and meaning, for example for a user-defined event.
    /// Documents that contain points of an unknown kind (see [`is_known`](Kind::is_known)) cannot
    /// be saved.
    ///
    /// ```
    /// use tangency::core::system::Kind;
    /// const NS: Kind = Kind::new("NS", "neutral saddle");
    /// assert_eq!(format!("{NS}: {}", NS.meaning()), "NS: neutral saddle");
    /// assert!(!NS.is_known() && Kind::LP.is_known());
    /// ```
    pub const fn new(letters: &'static str, meaning: &'static str) -> Self {
        Kind { letters, meaning }
    }

    /// The letters of the kind, such as `LP`.
    pub fn letters(self) -> &'static str {
        self.letters
    }

    /// The meaning of the letters of the kind, in words.
    pub fn meaning(self) -> &'static str {
        self.meaning
    }
}

impl std::fmt::Debug for Kind {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(self.letters)
    }
}

impl std::fmt::Display for Kind {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.pad(self.letters)
    }
}

/// Serialises a kind as the variant of an enumeration, for example `LP`, without quotation marks if
/// the format permits.
impl Serialize for Kind {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.serialize_unit_variant("Kind", 0, self.letters)
    }
}

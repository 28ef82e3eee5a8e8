//! What can be wrong with the description of a plate.

/// A plate that cannot be set up, and what to change.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum PlateError {
    /// Letters that do not name four edges.
    #[error(
        "supports \"{letters}\": write four letters out of S (simply supported), C (clamped) and \
         F (free), for the edges x = 0, y = 0, x = 1, y = 1, such as \"SCSF\""
    )]
    Supports {
        /// What was written.
        letters: String,
    },
    /// A name of no in-plane model.
    #[error("in-plane edges \"{name}\": write slide, immovable, straight or free")]
    InPlane {
        /// What was written.
        name: String,
    },
    /// Nothing holds the plate.
    #[error(
        "supports {supports} leave the plate free to move as a rigid body: hold it by one clamped \
         edge or two supported ones"
    )]
    Unsupported {
        /// The supports.
        supports: String,
    },
    /// More or fewer functions than can be worked with.
    #[error("{count} {which} functions along {axis}: choose between {least} and {most}")]
    Orders {
        /// Transverse or in-plane.
        which: &'static str,
        /// The direction.
        axis: &'static str,
        /// The offending number.
        count: usize,
        /// The smallest possible.
        least: usize,
        /// The largest possible.
        most: usize,
    },
    /// Stresses were asked of a plate without stretching, or with too many in-plane functions for them.
    #[error("the plate has no in-plane stresses: set theory to von_karman, with fewer functions")]
    NoMembrane,
    /// A value of a parameter without meaning.
    #[error(transparent)]
    Domain(#[from] crate::core::zero::LeftDomain),
}

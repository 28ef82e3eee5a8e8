//! The supports of the edges of a plate, against deflection and against in-plane displacements.

use super::error::PlateError;

/// The support of an edge against deflection.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub enum Support {
    /// A simply supported edge: `w = 0`, and no bending moment.
    SimplySupported,
    /// A clamped edge: `w = 0`, `∂w/∂n = 0`.
    Clamped,
    /// A free edge: no bending moment and no shear force. A free edge is also free of in-plane
    /// forces.
    Free,
}

/// The supports of the edges against deflection, in the order x = 0, y = 0, x = 1, y = 1.
///
/// ```
/// use tangency::problems::plate::{Support, Supports};
/// let cantilever: Supports = "CFFF".parse()?;
/// assert_eq!(cantilever.x(), [Support::Clamped, Support::Free]);
/// assert!("SCX".parse::<Supports>().is_err());
/// # Ok::<(), tangency::problems::plate::PlateError>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct Supports(pub [Support; 4]);

impl Supports {
    /// Returns the supports of the edges x = 0 and x = 1.
    pub fn x(&self) -> [Support; 2] {
        [self.0[0], self.0[2]]
    }

    /// Returns the supports of the edges y = 0 and y = 1.
    pub fn y(&self) -> [Support; 2] {
        [self.0[1], self.0[3]]
    }

    /// Returns, for each direction (x, then y), whether the two opposite edges have the same
    /// support.
    pub fn alike(&self) -> [bool; 2] {
        [self.x(), self.y()].map(|[first, second]| first == second)
    }

    /// Returns whether at least one edge is free.
    pub fn any_free(&self) -> bool {
        self.0.contains(&Support::Free)
    }

    /// Returns the default in-plane supports: `slide` for a plate with four simply supported edges,
    /// `immovable` for all other plates.
    pub fn usual_in_plane(&self) -> InPlane {
        if self.0 == [Support::SimplySupported; 4] { InPlane::Slide } else { InPlane::Immovable }
    }
}

impl std::str::FromStr for Supports {
    type Err = PlateError;

    fn from_str(letters: &str) -> Result<Self, PlateError> {
        let unknown = || PlateError::Supports { letters: letters.into() };
        let edges: Vec<Support> = letters
            .chars()
            .map(|letter| match letter {
                'S' | 's' => Ok(Support::SimplySupported),
                'C' | 'c' => Ok(Support::Clamped),
                'F' | 'f' => Ok(Support::Free),
                _ => Err(unknown()),
            })
            .collect::<Result<_, _>>()?;
        Ok(Supports(edges.try_into().map_err(|_| unknown())?))
    }
}

impl std::fmt::Display for Supports {
    fn fmt(&self, out: &mut std::fmt::Formatter) -> std::fmt::Result {
        for edge in self.0 {
            out.write_str(match edge {
                Support::SimplySupported => "S",
                Support::Clamped => "C",
                Support::Free => "F",
            })?;
        }
        Ok(())
    }
}

/// The supports of the edges against in-plane displacements: four different models, whose pull-in
/// loads differ by a factor of two at `α₁ = 2`.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, serde::Serialize, serde::Deserialize)]
#[serde(rename_all = "snake_case")]
#[non_exhaustive]
pub enum InPlane {
    /// No displacement normal to the edge, and no shear traction.
    Slide,
    /// No in-plane displacement at the edge: `u = v = 0`.
    Immovable,
    /// The edge stays straight: its normal displacement is constant along the edge. The mean normal
    /// force and the shear traction on the edge are zero.
    Straight,
    /// No traction.
    Free,
}

impl InPlane {
    /// Returns the name of the in-plane support in scenes and figures.
    pub fn name(self) -> &'static str {
        match self {
            InPlane::Slide => "slide",
            InPlane::Immovable => "immovable",
            InPlane::Straight => "straight",
            InPlane::Free => "free",
        }
    }

    /// Returns the in-plane support of an edge: `Free` for an edge that is free against deflection,
    /// otherwise this support.
    pub fn at(self, support: Support) -> InPlane {
        if support == Support::Free { InPlane::Free } else { self }
    }
}

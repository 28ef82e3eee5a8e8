//! The solutions on the two sides of a curve of bifurcations in the plane of two parameters.

use super::at::At;
use super::catalogue::row_of;
use super::normal_form::Division;
use super::stability::certain_count;
use crate::core::failure::Failure;
use crate::core::linalg::SpectrumRequest;
use crate::core::system::Kind;

/// Heuristic: the number of eigenvalues to compute: enough for two critical pairs near a double
/// Hopf point.
const EIGENVALUES: usize = 4;

/// The solutions near a point of a curve of bifurcations, on both sides of the curve in the plane
/// of the two released parameters. Let `n` be the number of noncritical unstable directions. On one
/// side of a fold, two solutions with `n` and `n + 1` unstable directions exist, and on the other
/// side no solution. At a Hopf or torus point, the number of unstable directions changes between
/// `n` and `n + 2`, and at a period doubling between `n` and `n + 1`.
///
/// ```text
/// LP      towards = −sign(p B(q, q)) p F_λ
/// HB, TR  towards = Re p* B(q, z_λ)           p* L' q = −1,  F_z z_λ = −F_λ
/// PD, BP  towards = −p B(q, z_λ)/(p L' q)
/// ```
///
/// The formulas for `towards` hold for each of the two parameters `λ`; `q` and `p` are the null
/// vectors of the linearisation `L`, and `B = F_zz`.
#[derive(Clone, Debug, PartialEq)]
pub(in crate::core) struct Sides {
    /// A normal covector of the curve: the derivatives, with respect to both parameters, of a
    /// function that increases from one side of the curve to the other.
    pub towards: [f64; 2],
    /// The number of unstable directions of each solution on the side to which the normal `towards`
    /// points, in increasing order. Cycles that emanate from Hopf points, tori and doubled orbits
    /// are not included.
    pub there: Vec<usize>,
    /// The number of unstable directions of each solution on the side opposite to the normal
    /// `towards`.
    pub opposite: Vec<usize>,
    /// The number of noncritical unstable directions of the solution on the curve itself.
    pub unstable: usize,
}

impl Sides {
    /// Computes the solutions on the two sides of a curve of bifurcations of a given kind; `None`
    /// if such curves do not divide the parameter plane, if growth rates are undefined, or if
    /// another eigenvalue is nearly critical.
    ///
    /// # Errors
    /// [`Failure`] if eigenvalues or derivatives do not exist, or if a matrix is singular.
    pub fn of(kind: Kind, mut at: At) -> Result<Option<Self>, Failure> {
        let Some(row) = row_of(kind) else { return Ok(None) };
        let Some(divide) = row.division else { return Ok(None) };
        let dynamics = at.system.dynamics();
        at.system.assemble(at.x)?;
        let spectrum = at.system.spectrum(at.x, SpectrumRequest::new(EIGENVALUES))?;
        let counted = spectrum.and_then(|all| certain_count(dynamics, &all, row.critical));
        let Some(unstable) = counted else { return Ok(None) };
        let beyond = |counts: &[usize]| counts.iter().map(|count| unstable + count).collect();
        let sides = |Division { normal, positive, negative }| Sides {
            towards: normal,
            there: beyond(positive),
            opposite: beyond(negative),
            unstable,
        };
        Ok(divide(&mut at)?.map(sides))
    }
}

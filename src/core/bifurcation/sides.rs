//! The solutions on the two sides of a curve of bifurcations in the plane of two parameters.

use super::at::At;
use super::catalogue::row_of;
use super::normal_form::Division;
use super::stability::certain_count;
use crate::core::failure::Failure;
use crate::core::linalg::SpectrumRequest;
use crate::core::system::Kind;

/// (H) The number of requested eigenvalues: two critical pairs near a double Hopf point.
const EIGENVALUES: usize = 4;

/// The solutions near a point of a curve of bifurcations, in the plane of the two released
/// parameters. With `n` noncritical unstable directions, a fold separates no solution from two with
/// `n` and `n + 1`; a Hopf or torus point `n` from `n + 2`, a period doubling `n` from `n + 1`.
///
/// ```text
/// LP      towards = −sign(p B(q, q)) p F_λ
/// HB, TR  towards = Re p* B(q, z_λ)           p* L' q = −1,  F_z z_λ = −F_λ
/// PD, BP  towards = −p B(q, z_λ)/(p L' q)
/// ```
///
/// for both parameters `λ`, with the null vectors `q`, `p` of the linearisation `L` and `B = F_zz`.
#[derive(Clone, Debug, PartialEq)]
pub(in crate::core) struct Sides {
    /// A normal of the curve as a covector: the derivatives, with respect to both parameters, of a
    /// function that increases towards one side.
    pub towards: [f64; 2],
    /// The number of unstable directions of each solution on that side, in increasing order. Cycles
    /// that emanate at a Hopf point, tori and doubled orbits are not included.
    pub there: Vec<usize>,
    /// The number of unstable directions of each solution on the other side.
    pub opposite: Vec<usize>,
    /// The number of noncritical unstable directions on the curve.
    pub unstable: usize,
}

impl Sides {
    /// Computes the sides of a curve of points of a kind; `None` if such curves do not divide the
    /// plane, if rates are unknown, or if another eigenvalue is nearly critical.
    ///
    /// # Errors
    /// [`Failure`] where eigenvalues or derivatives do not exist, or a matrix is singular.
    pub fn of(kind: Kind, mut at: At) -> Result<Option<Self>, Failure> {
        let Some(row) = row_of(kind) else { return Ok(None) };
        let Some(divide) = row.division else { return Ok(None) };
        let dynamics = at.system.dynamics();
        at.system.assemble(at.x)?;
        let spectrum = at.system.spectrum(at.x, SpectrumRequest { count: EIGENVALUES })?;
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

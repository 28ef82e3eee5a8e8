//! The largest Floquet multipliers of periodic orbits with sparse matrices.

use super::liouville::Orbit;
use super::sparse_factors::SparseOrbitLu;
use super::sparse_orbit::SparseOrbit;
use crate::core::failure::Failure;
use crate::core::linalg::{LANES, Lanes, Largest, Spectrum, dot, norm};

/// Discretisation: a vector counts as an eigenvector of the multiplier 1 if it satisfies the equation
/// of eigenvectors to this relative accuracy.
const TRIVIAL: f64 = 1e-3;

/// The largest Floquet multipliers of orbits along a branch.
#[derive(Default)]
pub(super) struct LeadingMultipliers {
    flow: SparseOrbitLu,
    largest: Largest,
}

impl LeadingMultipliers {
    /// Computes all Floquet multipliers outside the unit circle and the `least` largest others, without
    /// the trivial multiplier of an autonomous orbit, in descending order of their size.
    ///
    /// The multiplier 1 is removed by a deflation with its known eigenvector `f(x(0))`: the matrix `M
    /// (I − v vᵀ / vᵀv)` has the eigenvalues of the monodromy matrix `M`, with 0 in place of 1 (H.
    /// Wielandt; Y. Saad, *Numerical Methods for Large Eigenvalue Problems*, SIAM 2011, ch. 4).
    pub fn deciding(
        &mut self,
        of: &Orbit,
        sparse: &SparseOrbit,
        least: usize,
    ) -> Result<Spectrum, Failure> {
        let (layout, assembled) = (&of.equations.layout, of.assembled);
        let n = layout.states;
        let Self { flow, largest } = self;
        flow.factor_flow(sparse, (layout, assembled))?;
        // The vectors are in units of the states.
        let units: Vec<f64> = match assembled.units.get(..n) {
            Some(units) => units.to_vec(),
            None => vec![1.0; n],
        };
        let mut apply = |states: &mut Lanes| {
            let scaled = |states: &mut Lanes, factor: fn(f64) -> f64| {
                for (row, unit) in states.iter_mut().zip(&units) {
                    row.iter_mut().for_each(|x| *x *= factor(*unit));
                }
            };
            scaled(states, |unit| unit);
            flow.flow(layout, states);
            scaled(states, f64::recip);
        };
        if !layout.phase {
            return largest.outside((n, least), apply);
        }
        // At a Hopf point the motion at the start vanishes; the reference contains the motion of the
        // emanating orbits.
        let reference = of.phase.motion.clone();
        for mut motion in [of.motion_at(0), reference] {
            motion.iter_mut().zip(&units).for_each(|(x, unit)| *x /= unit);
            let square = dot(&motion, &motion);
            let mut image: Vec<[f64; LANES]> = motion.iter().map(|x| [*x; LANES]).collect();
            apply(&mut image);
            let deviation: Vec<f64> = image.iter().zip(&motion).map(|(a, x)| a[0] - x).collect();
            if square == 0.0 || norm(&deviation) > TRIVIAL * square.sqrt() {
                continue;
            }
            return largest.outside((n, least), |states| {
                for lane in 0..LANES {
                    let along = motion.iter().zip(&*states).map(|(v, x)| v * x[lane]).sum::<f64>();
                    let part = along / square;
                    states.iter_mut().zip(&motion).for_each(|(x, v)| x[lane] -= part * v);
                }
                apply(states);
            });
        }
        let mut found = largest.outside((n, least + 1), apply)?;
        let distance = |mu: &(f64, f64)| (mu.0 - 1.0).hypot(mu.1);
        let nearest =
            (0..found.len()).min_by(|&a, &b| distance(&found[a]).total_cmp(&distance(&found[b])));
        nearest.map(|nearest| found.remove(nearest));
        Ok(found)
    }
}

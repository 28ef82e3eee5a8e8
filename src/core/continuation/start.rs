//! The start of a curve: the first correction, the scales, and the first tangent.

use super::metric::Metric;
use super::stepper::AT_START;
use crate::core::bifurcation::generic_vector;
use crate::core::extended::{Closing, Extended};
use crate::core::newton::{Newton, NewtonError, Tolerances, scaled_norm};
use crate::core::zero::Names;

/// Of the tangents at a branch point, the one most aligned with the branch that one comes from, or the
/// other one.
pub(super) fn branch_along(
    tangents: [Vec<f64>; 2],
    along: Option<&[f64]>,
    other: bool,
) -> Vec<f64> {
    let [first, second] = tangents;
    let Some(along) = along else { return second };
    let aligned = |t: &[f64]| {
        let dot: f64 = t.iter().zip(along).map(|(a, b)| a * b).sum();
        let norm: f64 = t.iter().map(|t| t * t).sum();
        dot.abs() / norm.sqrt()
    };
    if (aligned(&first) > aligned(&second)) == other { second } else { first }
}

/// A direction `(z, p)` with zeros for the conditions' own unknowns.
pub(super) fn with_own(direction: &[f64], n: usize, length: usize) -> Vec<f64> {
    let mut out = direction.to_vec();
    out.splice(n..n, std::iter::repeat_n(0.0, length - direction.len()));
    out
}

/// What the first correction needs.
pub(super) struct Starting<'s, 'a> {
    pub equations: &'s mut Extended<'a>,
    pub newton: Newton,
    pub tolerances: Tolerances,
    pub ranges: &'s [[f64; 2]],
    /// Scales that the user gives, of groups and then of released parameters.
    pub scales: &'s [Option<f64>],
}

impl Starting<'_, '_> {
    /// Corrects the start on the hyperplane across `direction`, or with a parameter fixed, and
    /// returns the scales and the tangent (of scaled length 1, the last released parameter growing).
    pub fn begin(
        &mut self,
        names: &Names,
        unknowns: &mut [f64],
        direction: Option<Vec<f64>>,
        correct: bool,
    ) -> Result<(Metric, Vec<f64>), NewtonError> {
        let length = unknowns.len();
        let n = names.dimension();
        let rough = self.metric(names, unknowns, &vec![0.0; length]);
        let weights = rough.weights(names);
        let base = unknowns.to_vec();
        let mut rows: Vec<Vec<f64>> = Vec::new();
        if let Some(direction) = &direction {
            rows.push(direction.iter().zip(&weights).map(|(t, w)| t * w).collect());
        }
        for fixed in (self.equations.parameters_at()..length).rev() {
            let mut row = vec![0.0; length];
            row[fixed] = 1.0;
            rows.push(row);
        }
        let mut outcome: Option<Result<Vec<f64>, NewtonError>> = None;
        for row in &rows {
            unknowns.copy_from_slice(&base);
            let tried = self.correct(unknowns, row, &weights, correct);
            // The first failure is the one that tells: later rows only try harder.
            if tried.is_ok() || outcome.is_none() {
                let done = tried.is_ok();
                outcome = Some(tried);
                if done {
                    break;
                }
            }
        }
        let mut outcome = outcome.unwrap_or_else(|| Ok(vec![0.0; length]));
        if outcome.is_err() {
            // A start that is a solution already may be a fold, which a hyperplane across some unknowns
            // passes through, or a branch point, where this fails as well.
            let mut row = generic_vector(length, 1);
            row[n..].fill(0.0);
            row.iter_mut().zip(&weights).for_each(|(r, w)| *r *= w.sqrt());
            unknowns.copy_from_slice(&base);
            if let Ok(tangent) = self.correct(unknowns, &row, &weights, correct) {
                let moved: Vec<f64> = unknowns.iter().zip(&base).map(|(x, b)| x - b).collect();
                if scaled_norm(&moved, &weights) <= AT_START {
                    outcome = Ok(tangent);
                }
            }
        }
        let mut tangent = outcome?;
        if let (Some(direction), false) = (direction, correct) {
            tangent = direction;
        }
        let metric = self.metric(names, unknowns, &tangent);
        let weights = metric.weights(names);
        let size = scaled_norm(&tangent, &weights);
        let sign = match tangent[length - 1] {
            // A vertical start (a fold, a pitchfork) grows in its largest unknown.
            p if p.abs() * weights[length - 1].sqrt() < 1e-9 * size => {
                let by_size = |a: &&f64, b: &&f64| a.abs().total_cmp(&b.abs());
                tangent[..n].iter().max_by(by_size).map_or(1.0, |z| z.signum())
            }
            p => p.signum(),
        };
        tangent.iter_mut().for_each(|t| *t *= sign / size);
        Ok((metric, tangent))
    }

    /// Corrects on the hyperplane of `row` through the start, and solves for the tangent.
    fn correct(
        &mut self,
        unknowns: &mut [f64],
        row: &[f64],
        weights: &[f64],
        correct: bool,
    ) -> Result<Vec<f64>, NewtonError> {
        let base = unknowns.to_vec();
        let closing = Closing { row, base: &base, length: 0.0 };
        if correct {
            let tolerances = self.tolerances;
            self.newton.solve(self.equations, unknowns, Some(closing), weights, tolerances)?;
        }
        let mut tangent = vec![0.0; unknowns.len()];
        self.equations
            .residual(unknowns, None, &mut tangent)
            .and_then(|()| self.equations.factor(unknowns, Some(row)))
            .or_else(|cause| if correct { Err(cause) } else { Ok(()) })
            .map_err(|cause| NewtonError::from_evaluation(0, cause))?;
        tangent.fill(0.0);
        if let Some(last) = tangent.last_mut() {
            *last = 1.0;
        }
        if correct {
            self.equations.solve(&mut tangent);
        }
        Ok(tangent)
    }

    fn metric(&self, names: &Names, unknowns: &[f64], tangent: &[f64]) -> Metric {
        let n = names.dimension();
        let parameters = self.equations.parameters_at();
        let own = self.equations.own_sizes(unknowns);
        let (z, p) = (&tangent[..n], &tangent[parameters..]);
        let values = &unknowns[parameters..];
        Metric::new(names, &unknowns[..n], z, self.ranges, values, p, &own).with_scales(self.scales)
    }
}

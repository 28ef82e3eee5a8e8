//! The other solutions that graze where one of a system does: with the event that it touches, or without it.

use super::BoundarySystem;
use crate::core::condition::Failure;
use crate::core::zero::{Across, System};

/// A solution that grazes, as one of the others that do.
pub(super) struct Beside {
    /// The solution of this system that it belongs to.
    at: Vec<f64>,
    system: Box<BoundarySystem>,
    x: Vec<f64>,
}

impl BoundarySystem {
    /// The states where the segments of a solution begin, and its numbers `q`.
    pub(super) fn starts_of(&self, z: &[f64], p: &[f64]) -> (Vec<f64>, Vec<f64>) {
        let layout = &self.equations.layout;
        let starts = layout.ends[..layout.states].iter().map(|&k| z[k]).collect();
        (starts, [p, &z[layout.values()..]].concat())
    }

    /// The other solution at a grazing, computed once for each.
    pub(super) fn beside_at(&mut self, x: &[f64]) -> Result<Option<Across<'_>>, Failure> {
        if self.beside.as_ref().is_none_or(|beside| beside.at != x) {
            self.beside = self.beside_found(x)?;
        }
        let Some(Beside { system, x, .. }) = &mut self.beside else { return Ok(None) };
        Ok(Some(Across { system: &mut **system, x }))
    }

    fn beside_found(&mut self, x: &[f64]) -> Result<Option<Beside>, Failure> {
        let passes = (self as &mut dyn System).passes_touched(x)?;
        let (z, p) = x.split_at(self.equations.layout.dimension);
        let (starts, q) = self.starts_of(z, p);
        let problem = self.problem();
        let other = match passes {
            true => problem.without_touched(&starts, &q)?,
            // What holds at the start of a curve holds along it.
            false if self.beside.is_some() || problem.touch_matters(&starts, &q)? => {
                problem.with_touched(&starts, &q)?
            }
            false => None,
        };
        let Some(other) = other else { return Ok(None) };
        let (method, intervals) = (self.equations.method.clone(), self.meshes()[0].intervals());
        let (system, mut x_there) = other.discretised(p, method, intervals)?;
        x_there.extend_from_slice(p);
        Ok(Some(Beside { at: x.to_vec(), system: Box::new(system), x: x_there }))
    }
}

//! Solutions on one mesh carried over to another.

use super::equations::{Equations, Work};
use super::layout::{Layout, span};
use crate::core::bvp::{BoundaryProblem, Mesh, Method};
use crate::core::scalar::Scalar;
use crate::core::zero::LeftDomain;

/// The nodes on which a solution is wanted.
pub(super) struct Onto<'a> {
    pub meshes: &'a [Mesh],
    pub layout: &'a Layout,
    /// The places of the nodes in an interval.
    pub places: &'a [f64],
}

impl<P: BoundaryProblem, M: Method> Equations<P, M> {
    /// The states at a place in an interval, at the arguments of `work`.
    pub fn value<T: Scalar>(
        &self,
        work: &mut Work<T, M>,
        (segment, interval): (usize, usize),
        place: f64,
        out: &mut [T],
    ) -> Result<(), LeftDomain> {
        let nodes = &work.nodes[self.layout.interval(segment, interval)];
        let (span, buffers) = (self.span(segment, interval), &mut work.local.method);
        self.method.value(&self.problem, span, nodes, &work.q, place, buffers, out)
    }

    /// `x = (z, p)` on other nodes.
    pub fn carried(&self, onto: &Onto, x: &[f64]) -> Result<Vec<f64>, LeftDomain> {
        let mut out = vec![0.0; onto.layout.values()];
        out.extend_from_slice(&x[self.layout.values()..]);
        self.carry(onto, |i| x[i], |z, value: f64| out[z] = value)?;
        Ok(out)
    }

    /// The reference of the phase condition on other nodes, if there is one.
    pub fn carried_reference(&self, onto: &Onto) -> Result<Option<Vec<f64>>, LeftDomain> {
        let reference = &self.phase.reference;
        (!reference.is_empty()).then(|| self.carried(onto, reference)).transpose()
    }

    /// Hands the values at other nodes to `put`, with their positions.
    fn carry<T: Scalar>(
        &self,
        onto: &Onto,
        argument: impl Fn(usize) -> T,
        mut put: impl FnMut(usize, T),
    ) -> Result<(), LeftDomain> {
        let mut work: Work<T, M> = Work::new(&self.layout);
        work.load(&self.layout, argument);
        for (s, j) in onto.layout.intervals() {
            let (span, n) = (span(onto.meshes, s, j), onto.layout.segments[s].states);
            let mut states = vec![T::zero(); n];
            let nodes = onto.layout.order[onto.layout.interval(s, j)].chunks_exact(n);
            for (place, node) in onto.places.iter().zip(nodes) {
                let (interval, place) =
                    self.meshes[s].locate(span.start + (span.end - span.start) * place);
                self.value(&mut work, (s, interval), place, &mut states)?;
                node.iter().zip(&states).for_each(|(&z, state)| put(z, *state));
            }
        }
        Ok(())
    }
}

//! Scratch space for arguments and left-hand sides of the equations in one scalar type.

use super::layout::UnknownLayout;
use crate::core::bvp::method::MethodWork;
use crate::core::scalar::Scalar;

/// Scratch space for arguments and residual in one scalar type, kept to avoid repeated allocations.
pub(super) struct Work<T: Scalar> {
    /// The values at the nodes of all segments, node by node.
    pub nodes: Vec<T>,
    /// The vector `q = (p, e)` of parameters and extra unknowns.
    pub q: Vec<T>,
    /// The vectors `q` of all segments, one after another.
    pub numbers: Vec<T>,
    pub r: Vec<T>,
    pub ends: Vec<T>,
    pub local: Local<T>,
}

/// Buffers for computations within an interval.
pub(super) struct Local<T: Scalar> {
    pub method: MethodWork<T>,
    pub x: Vec<T>,
    pub g: Vec<T>,
}

impl<T: Scalar> Local<T> {
    pub fn new(layout: &UnknownLayout) -> Self {
        let most = layout.segments.iter().map(|s| s.states).max().unwrap_or(0);
        let (x, g) = (vec![T::zero(); most], vec![T::zero(); layout.integrals]);
        Local { method: Default::default(), x, g }
    }
}

impl<T: Scalar> Work<T> {
    pub fn new(layout: &UnknownLayout) -> Self {
        let zeros = |length: usize| vec![T::zero(); length];
        Work {
            nodes: zeros(layout.values()),
            q: zeros(layout.numbers()),
            numbers: Vec::new(),
            r: zeros(layout.dimension),
            ends: zeros(2 * layout.states),
            local: Local::new(layout),
        }
    }

    /// Loads the arguments; the function `argument` returns the component of `x = (z, p)` with a
    /// given index.
    pub fn load(&mut self, layout: &UnknownLayout, argument: impl Fn(usize) -> T) {
        self.nodes.iter_mut().zip(&layout.order).for_each(|(node, &z)| *node = argument(z));
        for (k, q) in self.q.iter_mut().enumerate() {
            *q = argument(layout.number(k));
        }
        layout.spread(&self.q, &mut self.numbers);
    }
}

/// Collects the states at the starts of all segments, then the states at the ends of all segments.
pub(super) fn gather_ends<T: Scalar>(layout: &UnknownLayout, nodes: &[T], ends: &mut [T]) {
    let (start, end) = ends.split_at_mut(layout.states);
    for s in &layout.segments {
        let place = s.ends..s.ends + s.states;
        let last = s.values + (s.nodes - 1) * s.states;
        start[place.clone()].copy_from_slice(&nodes[s.values..s.values + s.states]);
        end[place].copy_from_slice(&nodes[last..last + s.states]);
    }
}

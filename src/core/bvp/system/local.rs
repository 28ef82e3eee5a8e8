//! Derivatives of parts of the equations with respect to the unknowns on which they depend, one
//! chunk of directions at a time.

use super::layout::UnknownLayout;
use super::work::Local;
use crate::core::bvp::erased::{Number, WatchNumber};
use crate::core::failure::Failure;
use crate::core::linalg::refill;
use crate::core::scalar::{CHUNK, Chunk, Directional, seeded};
use num_dual::Dual64;

/// The arguments of a part of the equations: unknowns at nodes, and entries of `q`.
#[derive(Clone, Copy)]
pub(super) struct Dependence<'a> {
    /// The positions of the unknowns in `z`.
    pub unknowns: &'a [usize],
    /// The segment to which the part of the equations belongs; `None` if it does not belong to a
    /// segment.
    pub segment: Option<usize>,
    /// The positions of the arguments in the segment's vector `q`, or in the problem's vector `q`
    /// if the part of the equations does not belong to a segment.
    pub numbers: &'a [usize],
}

impl Dependence<'_> {
    /// Returns the number of directions of differentiation.
    pub fn len(&self) -> usize {
        self.unknowns.len() + self.numbers.len()
    }

    /// Adds the derivative in one direction to a gradient of the same length as `x`.
    fn scatter(&self, layout: &UnknownLayout, k: usize, slope: f64, out: &mut [f64]) {
        let Some(number) = k.checked_sub(self.unknowns.len()) else {
            out[self.unknowns[k]] += slope;
            return;
        };
        match self.segment {
            Some(segment) => layout.scatter(segment, self.numbers[number], slope, out),
            None => out[layout.number(self.numbers[number])] += slope,
        }
    }
}

/// The entries of `q` with respect to which derivatives are computed.
#[derive(Default)]
pub(super) struct Numbers {
    /// The positions of these entries in each segment's vector `q`.
    pub local: Vec<usize>,
    /// The positions of these entries in the problem's vector `q`.
    pub all: Vec<usize>,
}

impl Numbers {
    /// Selects the entries of `q` for which derivatives are computed: the released parameters, and
    /// all entries that are not parameters. Sets all entries of `out` to zero.
    pub fn release(&mut self, layout: &UnknownLayout, released: &[usize], out: &mut [f64]) {
        let of_segments = layout.parameters..layout.parameters + layout.own();
        let own = [of_segments, layout.parameters..layout.numbers()];
        for (numbers, own) in [&mut self.local, &mut self.all].into_iter().zip(own) {
            refill(numbers, own);
            numbers.extend_from_slice(released);
        }
        out[..layout.dimension].fill(0.0);
        released.iter().for_each(|p| out[layout.dimension + p] = 0.0);
    }
}

/// The gradient of a scalar function at `x` with respect to the unknowns and the selected
/// parameters; the gradient is added to `out`, which has the same length as `x`.
pub(super) struct Gradient<'a> {
    pub x: &'a [f64],
    pub numbers: &'a Numbers,
    pub passes: &'a mut Passes<Chunk>,
    pub out: &'a mut [f64],
}

/// A derivative of a scalar function: its gradient, or its derivative along a direction.
pub(super) trait Derivative {
    /// The numbers with which the function is differentiated.
    type Number: Number + WatchNumber;

    /// Adds the derivative of a function that depends on some unknowns, and on the vector `q` of a
    /// segment or of the whole problem.
    fn add(
        &mut self,
        layout: &UnknownLayout,
        unknowns: &[usize],
        segment: Option<usize>,
        function: impl FnMut(&mut Passes<Self::Number>) -> Result<Self::Number, Failure>,
    ) -> Result<(), Failure>;
}

impl Derivative for Gradient<'_> {
    type Number = Chunk;

    fn add(
        &mut self,
        layout: &UnknownLayout,
        unknowns: &[usize],
        segment: Option<usize>,
        function: impl FnMut(&mut Passes<Chunk>) -> Result<Chunk, Failure>,
    ) -> Result<(), Failure> {
        let numbers = if segment.is_some() { &self.numbers.local } else { &self.numbers.all };
        let dependence = Dependence { unknowns, segment, numbers };
        self.passes.add_gradient(layout, dependence, Arguments::plain(self.x), self.out, function)
    }
}

/// The derivative of a scalar function at a point along a direction.
pub(super) struct Slope<'a> {
    pub at: Arguments<'a>,
    pub passes: &'a mut Passes<Dual64>,
    pub value: f64,
}

impl Derivative for Slope<'_> {
    type Number = Dual64;

    fn add(
        &mut self,
        layout: &UnknownLayout,
        unknowns: &[usize],
        segment: Option<usize>,
        mut function: impl FnMut(&mut Passes<Dual64>) -> Result<Dual64, Failure>,
    ) -> Result<(), Failure> {
        let Arguments { x, v } = self.at;
        let passes = &mut *self.passes;
        refill(&mut passes.unknowns, unknowns.iter().map(|&z| Dual64::new(x[z], v[z])));
        passes.take_numbers(layout, segment, self.at);
        let [x, v] = &passes.real;
        refill(&mut passes.q, x.iter().zip(v).map(|(x, v)| Dual64::new(*x, *v)));
        self.value += function(passes)?.eps;
        Ok(())
    }
}

/// The point at which derivatives are computed, and the direction of differentiation.
#[derive(Clone, Copy)]
pub(super) struct Arguments<'a> {
    /// The point.
    pub x: &'a [f64],
    /// The direction of differentiation, of the same length as `x`.
    pub v: &'a [f64],
}

impl<'a> Arguments<'a> {
    /// Returns arguments for derivatives of functions of the values at nodes.
    pub fn plain(x: &'a [f64]) -> Self {
        Arguments { x, v: x }
    }
}

/// Scratch space for the arguments and values of a part of the equations, kept to avoid repeated
/// allocations.
pub(super) struct Passes<T: Number> {
    pub unknowns: Vec<T>,
    pub q: Vec<T>,
    pub r: Vec<T>,
    pub local: Local<T>,
    /// The vector `q` of the problem or of a segment, at the point and along the direction.
    real: [Vec<f64>; 2],
    pub slopes: Vec<f64>,
}

impl<T: Number> Passes<T> {
    pub fn new(layout: &UnknownLayout) -> Self {
        let each = layout.segments.iter().map(|s| layout.degree * s.states).max().unwrap_or(0);
        let most = (each + 1).max(layout.boundary).max(layout.integrals);
        Passes {
            unknowns: Vec::new(),
            q: Vec::new(),
            r: vec![T::zero(); most],
            local: Local::new(layout),
            real: Default::default(),
            slopes: Vec::new(),
        }
    }

    /// Loads the vector `q` of a segment, or the vector `q` of the problem if no segment is given.
    pub fn take_numbers(&mut self, layout: &UnknownLayout, segment: Option<usize>, at: Arguments) {
        for (real, from) in self.real.iter_mut().zip([at.x, at.v]) {
            real.clear();
            match segment {
                Some(segment) => layout.numbers_of(segment, from, real),
                None => real.extend((0..layout.numbers()).map(|k| from[layout.number(k)])),
            }
        }
    }
}

impl<T: Directional + Number> Passes<T> {
    /// Loads the arguments as dual numbers; the arguments in the chunk of directions that begins at
    /// `start` get unit derivatives.
    pub fn load(
        &mut self,
        layout: &UnknownLayout,
        dependence: Dependence,
        start: usize,
        at: Arguments,
    ) {
        let Arguments { x, v } = at;
        let unknowns = dependence.unknowns.iter().enumerate();
        refill(&mut self.unknowns, unknowns.map(|(k, &z)| T::along(seeded(x[z], k, start), v[z])));
        self.take_numbers(layout, dependence.segment, at);
        self.seed(dependence.numbers, dependence.unknowns.len(), start);
    }

    /// Creates dual numbers for the vector `q` of a segment or of the problem; the entries selected
    /// for differentiation become successive directions, numbered from `first`.
    pub fn seed(&mut self, numbers: &[usize], first: usize, start: usize) {
        let [x, v] = &self.real;
        refill(&mut self.q, x.iter().zip(v).map(|(x, v)| T::along(Chunk::from(*x), *v)));
        for (k, &number) in numbers.iter().enumerate() {
            self.q[number] = T::along(seeded(x[number], first + k, start), v[number]);
        }
    }

    /// Adds the gradient of a function of some unknowns and entries of `q` to `out` (of the same
    /// length as `x`); the arguments of the function are loaded by [`load`](Self::load).
    pub fn add_gradient(
        &mut self,
        layout: &UnknownLayout,
        dependence: Dependence,
        at: Arguments,
        out: &mut [f64],
        mut function: impl FnMut(&mut Self) -> Result<Chunk, Failure>,
    ) -> Result<(), Failure> {
        for start in (0..dependence.len()).step_by(CHUNK) {
            self.load(layout, dependence, start, at);
            let slopes = function(self)?.eps;
            for (k, slope) in (start..dependence.len()).zip(slopes) {
                dependence.scatter(layout, k, slope, out);
            }
        }
        Ok(())
    }
}

/// A directional derivative of the weighted sum `wᵀ F(x)`, whose gradient is computed.
pub(super) struct Weighted<'a> {
    pub at: Arguments<'a>,
    /// The weights `w`, one for each equation.
    pub w: &'a [f64],
    /// The entries of `q` with respect to which the gradient is computed.
    pub numbers: &'a Numbers,
}

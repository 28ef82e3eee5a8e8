//! Derivatives of parts of the equations by the unknowns on which they depend, a chunk at a time.

use super::equations::{Discretised, Local};
use super::layout::Layout;
use crate::core::bvp::Number;
use crate::core::chunk::{CHUNK, Chunk, seeded};
use crate::core::failure::Failure;
use crate::core::scalar::Scalar;

/// What a part of the equations depends on.
#[derive(Clone, Copy)]
pub(super) struct Dependence<'a> {
    /// Positions in `z`.
    pub unknowns: &'a [usize],
    /// Components of `q`.
    pub numbers: &'a [usize],
}

impl Dependence<'_> {
    /// The number of directions.
    pub fn len(&self) -> usize {
        self.unknowns.len() + self.numbers.len()
    }

    /// The position in `x` of a direction.
    pub fn position(&self, layout: &Layout, k: usize) -> usize {
        match self.unknowns.get(k) {
            Some(&z) => z,
            None => layout.number(self.numbers[k - self.unknowns.len()]),
        }
    }
}

/// Arguments and values of a part of the equations, kept so that nothing is allocated twice.
pub(super) struct Passes<T: Scalar> {
    pub unknowns: Vec<T>,
    pub q: Vec<T>,
    pub r: Vec<T>,
    pub local: Local<T>,
}

impl<T: Scalar> Passes<T> {
    pub fn new(layout: &Layout) -> Self {
        let each = layout.segments.iter().map(|s| layout.degree * s.states).max().unwrap_or(0);
        let most = each.max(layout.boundary).max(layout.integrals);
        Passes {
            unknowns: Vec::new(),
            q: Vec::new(),
            r: vec![T::zero(); most],
            local: Local::new(layout),
        }
    }

    /// Takes arguments: `make` is handed the position of each in `x`, and its value, seeded if it is one of
    /// the directions of the chunk that begins at `start`.
    pub fn load(
        &mut self,
        layout: &Layout,
        dependence: Dependence,
        start: usize,
        x: &[f64],
        make: impl Fn(usize, Chunk) -> T,
    ) {
        let unknowns = dependence.unknowns.iter().enumerate();
        self.unknowns.clear();
        self.unknowns.extend(unknowns.map(|(k, &z)| make(z, seeded(x[z], k, start))));
        let numbers = (0..layout.numbers()).map(|k| layout.number(k));
        self.q.clear();
        self.q.extend(numbers.map(|i| make(i, Chunk::from(x[i]))));
        for (k, &number) in dependence.numbers.iter().enumerate() {
            let i = layout.number(number);
            self.q[number] = make(i, seeded(x[i], dependence.unknowns.len() + k, start));
        }
    }
    /// Adds the gradient of a function of some unknowns and numbers at `x` to `out` (as long as `x`), with
    /// arguments as [`load`](Self::load) takes them.
    pub fn add_gradient(
        &mut self,
        layout: &Layout,
        dependence: Dependence,
        (x, make): (&[f64], &dyn Fn(usize, Chunk) -> T),
        out: &mut [f64],
        mut function: impl FnMut(&mut Self) -> Result<Chunk, Failure>,
    ) -> Result<(), Failure> {
        for start in (0..dependence.len()).step_by(CHUNK) {
            self.load(layout, dependence, start, x, make);
            let slopes = function(self)?.eps;
            for (k, slope) in (start..dependence.len()).zip(slopes) {
                out[dependence.position(layout, k)] += slope;
            }
        }
        Ok(())
    }
}

/// An argument of a function as [`Passes::load`] seeds it.
pub(super) fn plain(_position: usize, seeded: Chunk) -> Chunk {
    seeded
}

/// `wᵀ F(x)` as a scalar that carries derivatives, whose gradient is wanted.
pub(super) struct Weighted<'a, T> {
    /// Where.
    pub x: &'a [f64],
    /// One weight for each equation.
    pub w: &'a [f64],
    /// The components of `q` by which derivatives are wanted.
    pub numbers: &'a [usize],
    /// An argument from its position in `x` and its seeded value.
    pub make: &'a dyn Fn(usize, Chunk) -> T,
    /// The derivative, along a direction, whose gradient is wanted.
    pub take: fn(&T) -> Chunk,
}

impl Discretised {
    /// Adds the gradient of a weighted sum of all left sides to `out` (as long as `x`).
    pub fn add_gradient<T: Number>(
        &self,
        &Weighted { x, w, numbers, make, take }: &Weighted<T>,
        passes: &mut Passes<T>,
        out: &mut [f64],
    ) -> Result<(), Failure> {
        let layout = &self.layout;
        let (boundary, closing) = w[layout.conditions()..].split_at(layout.boundary);
        let weighted = |values: &[T], weights: &[f64]| {
            let terms = values.iter().zip(weights);
            terms.fold(Chunk::from(0.0), |sum, (value, weight)| sum + take(value) * *weight)
        };
        for (s, j) in layout.intervals() {
            let rows = layout.equations(s, j);
            let unknowns = &layout.order[layout.interval(s, j)];
            let dependence = Dependence { unknowns, numbers };
            passes.add_gradient(layout, dependence, (x, make), out, |passes| {
                let Passes { unknowns, q, r, local } = passes;
                let interval = self.interval((s, j), unknowns, q);
                self.method.residual(interval, &mut local.method, &mut r[..rows.len()])?;
                let sum = weighted(&r[..rows.len()], &w[rows.clone()]);
                let sums = &mut r[..layout.integrals];
                sums.fill(T::zero());
                self.integrals(interval, local, sums)?;
                Ok(sum + weighted(sums, &closing[..layout.integrals]))
            })?;
        }
        let dependence = Dependence { unknowns: &layout.ends, numbers };
        passes.add_gradient(layout, dependence, (x, make), out, |passes| {
            let b = &mut passes.r[..layout.boundary];
            self.boundary(&passes.unknowns, &passes.q, b);
            Ok(weighted(b, boundary))
        })
    }
}

//! The linearisation about a periodic orbit of a vector field with a sparse Jacobian, as one sparse
//! matrix.
//!
//! The matrix contains the collocation equations of all intervals and the return conditions; the
//! derivatives with respect to the period, and the phase condition, are part of its border:
//!
//! ```text
//!     ⎡ ℓ'(ρ_c) I − ℓ(ρ_c) h L f_x │  ∂/∂L   B ⎤
//!     ⎢ μ x(0) − x(1)              │           ⎥
//!     ⎢ phase condition            │           ⎥
//!     ⎣ C                          │         D ⎦
//! ```
//!
//! Row `k` of the matrix is the equation that determines unknown number `k`: collocation equation `c`
//! of an interval determines the interval's node `c + 1`, and the return conditions determine the
//! first node.

use super::discretisation::DiscretisedProblem;
use super::layout::{UnknownLayout, span};
use super::work::Work;
use crate::core::bvp::collocation::Collocation;
use crate::core::bvp::colored::ColoredField;
use crate::core::bvp::interval::{Block, Interval};
use crate::core::bvp::method::Method;
use crate::core::failure::Failure;
use crate::core::linalg::{Elimination, Pattern, refill};
use crate::core::scalar::CHUNK;
use crate::core::system::Matrices;
use std::sync::Arc;

/// Heuristic: the smallest number of states for which sparse matrices are chosen by default, if they
/// also [pay](PAYS).
const LEAST: usize = 24;

/// Heuristic: a sparse matrix is used if its factorisation takes at most this fraction of the
/// multiplications of a condensation of dense intervals. Branches of cycles of the Brusselator with
/// diffusion take 0.9 of the time with sparse matrices at a fraction of 0.77 (24 states), and 0.56 of the
/// time at a fraction of 0.39 (48 states; `docs/evidence/speed-and-accuracy.md`).
const PAYS: f64 = 0.75;

/// The reason why a boundary-value problem cannot use sparse matrices.
const NOT_PERIODIC: &str = "sparse matrices exist only for periodic orbits of vector fields: use \
                            dense matrices for other boundary-value problems";

/// How the equations of intervals are stored.
#[derive(Clone, Default)]
pub(super) enum Structure {
    /// Not yet determined.
    #[default]
    Unknown,
    /// As dense blocks.
    Dense,
    /// As the sparse Jacobian of the vector field at all Gauss points.
    Sparse(Box<SparseOrbit>),
}

impl Structure {
    /// The sparse Jacobians, if the structure is sparse.
    pub fn sparse(&self) -> Option<&SparseOrbit> {
        match self {
            Structure::Sparse(sparse) => Some(sparse),
            _ => None,
        }
    }

    /// Chooses the structure at the first point, from the numbers of multiplications.
    pub fn choose(
        &mut self,
        equations: &mut DiscretisedProblem,
        work: &Work<f64>,
    ) -> Result<(), Failure> {
        if !matches!(self, Structure::Unknown) {
            return Ok(());
        }
        let states = equations.layout.segments[0].states;
        let matrices = match &equations.method {
            Method::Collocation(method) => method.matrices,
            Method::Shooting(_) => Matrices::Dense,
        };
        let (closes, stated) = (equations.layout.closes(), matrices == Matrices::Sparse);
        if stated && !closes {
            return Err(Failure::Unsupported(NOT_PERIODIC.into()));
        }
        *self = Structure::Dense;
        if closes && (stated || matrices == Matrices::Cheaper && states >= LEAST) {
            let known = Pattern::of_places(states, &[]);
            let sparse = SparseOrbit::about(equations, work, &known)?;
            let used = |sparse: &SparseOrbit| stated || sparse.pays(&equations.layout);
            if let Some(sparse) = sparse.filter(used) {
                *self = Structure::Sparse(Box::new(sparse));
            }
        }
        Ok(())
    }
}

/// The sparse Jacobians of the vector field along a periodic orbit.
#[derive(Clone)]
pub(super) struct SparseOrbit {
    field: ColoredField,
    /// The entries of `h L f_x` at each Gauss point of each interval.
    slopes: Vec<f64>,
    /// The weights of the nodes of an interval in the derivative and in the value of the polynomial at
    /// the Gauss points.
    weights: [Vec<f64>; 2],
    /// The order of elimination of the matrix of the whole orbit.
    pub elimination: Arc<Elimination>,
    /// The row of the matrix for each interval equation, then for each return condition.
    pub rows: Arc<[usize]>,
    /// The positions, in the matrix of the whole orbit, of the entries of the interval equations: for
    /// each Gauss point and each node of its interval, the entries of the field's pattern.
    places: Arc<[usize]>,
    /// The positions of the derivatives of the return conditions with respect to `x(0)` and `x(1)`.
    ends: Arc<[[usize; 2]]>,
}

impl SparseOrbit {
    /// Determines the sparsity pattern of the vector field along an orbit, in addition to a `known`
    /// pattern; `None` for shooting, and for a pattern that is not sparse.
    fn about(
        equations: &mut DiscretisedProblem,
        work: &Work<f64>,
        known: &Pattern,
    ) -> Result<Option<Self>, Failure> {
        let DiscretisedProblem { problem, method, meshes, layout, .. } = equations;
        let Method::Collocation(method) = method else { return Ok(None) };
        let n = layout.segments[0].states;
        let mut places: Vec<[usize; 2]> = (0..known.count()).map(|k| known.place(k)).collect();
        for start in (0..n).step_by(CHUNK) {
            let mut seen = vec![[false; CHUNK]; n];
            for (s, j) in layout.intervals() {
                let (span, nodes) = (span(meshes, s, j), &work.nodes[layout.interval(s, j)]);
                let q = &work.numbers[layout.local(s)];
                let interval = Interval { problem: &**problem, span, nodes, q };
                method.mark_dependences(interval, start, &mut seen)?;
            }
            for (i, seen) in seen.iter().enumerate() {
                let own = seen.iter().enumerate().filter(|(_, seen)| **seen);
                places.extend(own.map(|(k, _)| [i, start + k]));
            }
        }
        let pattern = Pattern::of_places(n, &places);
        let is_sparse = method.matrices == Matrices::Sparse || pattern.count() <= n * n / 4;
        Ok(is_sparse.then(|| Self::of(layout, method, pattern)))
    }

    fn of(layout: &UnknownLayout, method: &Collocation, field: Pattern) -> Self {
        let (s, m, order) = (&layout.segments[0], layout.degree, &layout.order);
        let n = s.states;
        let at = |node: usize, i: usize| order[node * n + i];
        let mut all = Vec::new();
        for j in 0..s.intervals {
            for (c, k) in (0..m).flat_map(|c| (0..=m).map(move |k| (c, k))) {
                let entries = (0..field.count()).map(|e| field.place(e));
                all.extend(entries.map(|[i, l]| [at(j * m + c + 1, i), at(j * m + k, l)]));
            }
        }
        let intervals = all.len();
        let last = s.nodes - 1;
        all.extend((0..n).flat_map(|i| [[at(0, i), at(0, i)], [at(0, i), at(last, i)]]));
        let pattern = Pattern::of_places(layout.values(), &all);
        let position = |&[i, j]: &[usize; 2]| {
            let found = pattern.column(j).binary_search(&i);
            pattern.start(j) + found.unwrap_or_else(|_| unreachable!("the entry was added above"))
        };
        let rows = (n..s.nodes * n).chain(0..n).map(|value| order[value]);
        SparseOrbit {
            slopes: vec![0.0; s.intervals * m * field.count()],
            weights: [method.slopes(), method.arguments()].map(<[f64]>::to_vec),
            rows: rows.collect(),
            places: all[..intervals].iter().map(position).collect(),
            ends: all[intervals..]
                .as_chunks::<2>()
                .0
                .iter()
                .map(|ends| ends.each_ref().map(position))
                .collect(),
            elimination: Arc::new(Elimination::of(pattern)),
            field: ColoredField::of(field),
        }
    }

    /// Whether the sparse factorisation takes fewer multiplications than the condensation of dense
    /// intervals.
    fn pays(&self, layout: &UnknownLayout) -> bool {
        let s = &layout.segments[0];
        let (n, m) = (s.states as f64, layout.degree as f64);
        let dense = s.intervals as f64 * (m.powi(3) / 3.0 + 2.0) * n.powi(3);
        self.elimination.products() <= PAYS * dense
    }

    /// Extends the pattern of the vector field by the entries that differ from zero at another
    /// solution; returns whether the pattern was extended.
    pub fn widen(
        &mut self,
        equations: &mut DiscretisedProblem,
        work: &Work<f64>,
    ) -> Result<bool, Failure> {
        let before = self.field.pattern.count();
        let wider = Self::about(equations, work, &self.field.pattern)?;
        let wider = wider.filter(|wider| wider.field.pattern.count() > before);
        let extended = wider.is_some();
        if let Some(wider) = wider {
            *self = wider;
        }
        Ok(extended)
    }

    /// Computes the residual and the derivatives of an interval, given the storage of a dense
    /// interval without its `nodes`. Returns whether the Jacobian agrees with its pattern.
    pub fn linearise(
        &mut self,
        (method, j): (&mut Method, usize),
        interval: Interval<f64>,
        active: &[usize],
        block: Block,
    ) -> Result<bool, Failure> {
        let Method::Collocation(method) = method else { return Ok(false) };
        let gauss = method.places().len() - 1;
        let length = gauss * self.field.pattern.count();
        let nodes = &mut self.slopes[j * length..(j + 1) * length];
        method.linearise_colored(interval, (active, &self.field), Block { nodes, ..block })
    }

    /// The entries of `h L f_x` at all Gauss points.
    pub fn slopes(&self) -> &[f64] {
        &self.slopes
    }

    /// The component of the vector field to which an entry of [`slopes`](Self::slopes) belongs, as a
    /// position among the interval equations.
    pub fn equation_of(&self, entry: usize) -> usize {
        let count = self.field.pattern.count();
        entry / count * self.field.pattern.size() + self.field.pattern.place(entry % count)[0]
    }

    /// Writes the equations of an interval as a dense block.
    pub fn block(&self, interval: usize, out: &mut Vec<f64>) {
        let [slopes, values] = &self.weights;
        let (n, count) = (self.field.pattern.size(), self.field.pattern.count());
        let gauss = self.weights[0].len().isqrt();
        let nodes = slopes.len() / gauss;
        refill(out, std::iter::repeat_n(0.0, gauss * n * nodes * n));
        for c in 0..gauss {
            let own = &self.slopes[(interval * gauss + c) * count..][..count];
            for (k, weight) in (0..nodes).zip(&values[c * nodes..]) {
                for (e, slope) in own.iter().enumerate() {
                    let [i, l] = self.field.pattern.place(e);
                    let diagonal = if i == l { slopes[c * nodes + k] } else { 0.0 };
                    out[((c * n + i) * nodes + k) * n + l] = diagonal - weight * slope;
                }
            }
        }
    }

    /// Writes the entries of the matrix of the whole orbit, whose return conditions are `start x(0) +
    /// end x(1)`.
    pub fn fill(&self, [start, end]: [f64; 2], entries: &mut Vec<f64>) {
        let pattern = &self.field.pattern;
        let [slopes, values] = &self.weights;
        refill(entries, std::iter::repeat_n(0.0, self.elimination.pattern.count()));
        let mut places = self.places.iter();
        let gauss = slopes.len().isqrt();
        let nodes = slopes.len() / gauss;
        for (g, own) in self.slopes.chunks_exact(pattern.count()).enumerate() {
            let first = g % gauss * nodes;
            for (slope, value) in slopes[first..first + nodes].iter().zip(&values[first..]) {
                for j in 0..pattern.size() {
                    let column = own[pattern.start(j)..].iter().zip(pattern.column(j));
                    for ((entry, &i), &place) in column.zip(&mut places) {
                        let diagonal = if i == j { *slope } else { 0.0 };
                        entries[place] += diagonal - value * entry;
                    }
                }
            }
        }
        for [first, last] in &*self.ends {
            entries[*first] += start;
            entries[*last] += end;
        }
    }

    /// Writes a matrix whose only entries are the derivatives of the return conditions with respect to
    /// `x(0)`, all with the same value.
    pub fn fill_returns(&self, value: f64, entries: &mut Vec<f64>) {
        refill(entries, std::iter::repeat_n(0.0, self.elimination.pattern.count()));
        self.ends.iter().for_each(|[first, _]| entries[*first] = value);
    }

    /// Returns, for each return condition, its position among the equations, and the position of its
    /// component of `x(0)` among the unknowns.
    pub fn returns(&self, layout: &UnknownLayout) -> impl Iterator<Item = [usize; 2]> {
        (0..layout.states).map(|i| [layout.conditions() + i, layout.order[i]])
    }
}

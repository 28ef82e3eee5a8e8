//! Sparse Jacobians `F_z`: pattern, differentiation by colors, and solution of linear systems.

use super::eigenvalues::all_eigenvalues;
use super::work::Work;
use crate::core::failure::Failure;
use crate::core::linalg::{
    Border, Coloring, Elimination, Factors, Form, KnownFactors, Leading, MassMatrix, Pattern,
    Pencil, Rightmost, SharedLu, SparseShiftedLu, Spectrum, SpectrumRequest, factors_with_mass,
    generic,
};
use crate::core::problem::{Dynamics, TracedEquations, ZeroEquations};
use crate::core::scalar::{CHUNK, Chunk, Traced, seeded};
use std::sync::Arc;

/// Heuristic: a sparse matrix is used if its factorisation takes at most this fraction of the
/// multiplications of a dense factorisation.
const PAYS: f64 = 0.25;

/// Heuristic: the number of unknowns up to which all eigenvalues are computed with a dense matrix, which is
/// faster than the computation of the eigenvalues nearest to zero with a sparse matrix, and certain. If a
/// diagonal scaling makes the matrix symmetric, the sparse matrix is faster and certain, too.
const DENSELY: usize = 200;

/// A sparse `F_z`.
pub(super) struct SparseJacobian {
    elimination: Arc<Elimination>,
    coloring: Coloring,
    entries: Vec<f64>,
    /// The entries of the mass matrix, in the same pattern; `None` for the identity matrix.
    mass: Option<Vec<f64>>,
    /// Scratch space: the products of the matrix with the probe, and the sizes of their terms.
    products: Vec<[f64; 2]>,
    leading: Leading,
    /// The last factors of the current matrix in a border.
    known: KnownFactors,
    /// The number of points at which the count of unstable eigenvalues is uncertain.
    uncertain: usize,
}

impl SparseJacobian {
    /// Heuristic: the number of unknowns below which dense matrices are always at least as fast as
    /// sparse ones.
    pub const LEAST: usize = 48;

    /// Creates the sparse matrix of a problem, with its pattern at `x`; `None` if the residual
    /// takes more than `most` recorded operations.
    pub fn traced(problem: &dyn TracedEquations, x: &[f64], most: usize) -> Option<Self> {
        let n = problem.names().dimension();
        Some(Self::of(Pattern::of_places(n, &places(problem, x, most)?)))
    }

    fn of(pattern: Pattern) -> Self {
        SparseJacobian {
            coloring: Coloring::of(&pattern),
            entries: vec![0.0; pattern.count()],
            mass: None,
            products: Vec::new(),
            leading: Leading::default(),
            known: KnownFactors::default(),
            uncertain: 0,
            elimination: Arc::new(Elimination::of(pattern)),
        }
    }

    fn pattern(&self) -> &Pattern {
        &self.elimination.pattern
    }

    /// Whether the factorisation of the sparse matrix costs less than a dense factorisation.
    pub fn pays(&self) -> bool {
        let n = self.coloring.size() as f64;
        self.elimination.products() <= PAYS * n * n * n / 3.0
    }

    /// The entries of the mass matrix in the order of the pattern; `None` for the identity matrix.
    pub fn mass(&self) -> Option<&[f64]> {
        self.mass.as_deref()
    }

    pub fn entries(&self) -> &[f64] {
        &self.entries
    }

    /// The row and column of entry number `k` of the matrix.
    pub fn place(&self, k: usize) -> [usize; 2] {
        self.pattern().place(k)
    }

    /// Computes `F_z`, and the mass matrix of a flow, by dual numbers, all columns of a color
    /// together. The last pass also differentiates along the probe and along the parameters, as far
    /// as the pass has room for these directions.
    pub fn differentiate(
        &mut self,
        chunk: &mut Work<Chunk>,
        problem: &dyn ZeroEquations,
        x: &[f64],
    ) {
        self.known = KnownFactors::default();
        let implicit = problem.dynamics() == Dynamics::Implicit;
        let count = self.entries.len();
        let mut mass = implicit.then(|| self.mass.take().unwrap_or_else(|| vec![0.0; count]));
        let mut entries = std::mem::take(&mut self.entries);
        let (count, probe) = (self.coloring.count, &self.coloring.probe);
        for start in (0..count).step_by(CHUNK) {
            let color = |i: usize| self.coloring.color(i).unwrap_or(usize::MAX);
            let direction =
                |i: usize| self.coloring.color(i).unwrap_or(count + 1 + i - probe.len());
            let argument = |i: usize| {
                let mut number: Chunk = seeded(x[i], direction(i), start);
                if let (Some(part), Some(along)) = (number.eps.get_mut(count - start), probe.get(i))
                {
                    *part = *along;
                }
                number
            };
            let r = chunk.evaluate(problem, argument);
            self.scatter(r, start, &mut entries);
            if let Some(mass) = &mut mass {
                let seed = |i: usize| seeded(0.0, color(i), start);
                let products = chunk.products(problem, |i| Chunk::from(x[i]), seed);
                self.scatter(products, start, mass);
            }
        }
        (self.entries, self.mass) = (entries, mass);
    }

    /// Writes the derivatives of all equations in a chunk of directions as entries of a matrix; the
    /// chunk begins at the color `start`.
    fn scatter(&self, equations: &[Chunk], start: usize, entries: &mut [f64]) {
        let derivative = |i: usize, part: usize| equations[i].eps[part];
        self.coloring.scatter(self.pattern(), (start, CHUNK), derivative, entries);
    }

    /// Whether the last pass of a differentiation leaves the equations in its scratch space.
    pub fn keeps_equations(&self) -> bool {
        self.mass.is_none()
    }

    /// Returns the part of the dual numbers in the last pass of a differentiation that contains the
    /// derivatives along the probe (for `None`) or along a parameter; `None` if the pass had no room
    /// for this direction.
    pub fn part(&self, parameter: Option<usize>) -> Option<usize> {
        let first = self.coloring.count % CHUNK;
        let part = parameter.map_or(first, |parameter| first + 1 + parameter);
        (self.keeps_equations() && first > 0 && part < CHUNK).then_some(part)
    }

    /// The probe: a direction along which the matrix is compared with a directional derivative.
    pub fn probe(&self) -> &[f64] {
        &self.coloring.probe
    }

    /// Whether directional derivatives along the probe agree with the products of the matrix with
    /// the probe: the derivatives of `F`, or the products of the mass matrix with rates.
    pub fn agrees(&mut self, derivatives: impl Iterator<Item = f64>, of_mass: bool) -> bool {
        let entries = self.mass.as_ref().filter(|_| of_mass).unwrap_or(&self.entries);
        let matrix = (&self.elimination.pattern, &entries[..]);
        self.coloring.agrees(matrix, derivatives, &mut self.products)
    }

    /// Extends the pattern by the entries on which the residual depends at `x`. Returns whether any
    /// entries were added.
    pub fn widen(&mut self, problem: &dyn TracedEquations, x: &[f64]) -> bool {
        let own = (0..self.entries.len()).map(|k| self.place(k));
        let Some(mut all) = places(problem, x, usize::MAX) else { return false };
        let before = self.entries.len();
        all.extend(own);
        let pattern = Pattern::of_places(self.coloring.size(), &all);
        let wider = pattern.count() > before;
        if wider {
            *self = Self::of(pattern);
        }
        wider
    }

    /// Factors the matrix, or the variant of it that `form` selects, bordered by additional rows
    /// and columns.
    pub fn factor(
        &mut self,
        form: Form,
        border: Border,
        (mass, into): (Option<MassMatrix>, &mut Factors),
    ) -> Result<(), Failure> {
        let pencil = Pencil { entries: &self.entries, mass: self.mass.as_deref() };
        match form {
            Form::Oscillation(omega) => {
                let lu: &mut SparseShiftedLu = factors_with_mass(into, mass);
                lu.factor(&self.elimination, (pencil, omega), border)
            }
            _ => {
                let lu: &mut SharedLu = factors_with_mass(into, mass);
                self.known = lu.factor(&self.elimination, pencil, border)?;
                Ok(())
            }
        }
    }

    /// Computes the rightmost eigenvalues that decide stability: all unstable ones, and at least
    /// the requested number.
    pub fn spectrum(
        &mut self,
        dynamics: Dynamics,
        request: SpectrumRequest,
    ) -> Result<Spectrum, Failure> {
        let (n, pattern) = (self.coloring.size(), &self.elimination.pattern);
        let is_real = || self.mass.is_none() && pattern.symmetrising(&self.entries).is_some();
        if n <= DENSELY && !is_real() {
            let mass = self.mass.as_ref().map(|mass| self.dense(mass));
            return all_eigenvalues((&self.dense(&self.entries), mass.as_deref()), dynamics);
        }
        if request.only_pairs && is_real() {
            return Ok(Spectrum::new());
        }
        let sign = if dynamics.is_flow() { 1.0 } else { -1.0 };
        let entries: Vec<f64> = self.entries.iter().map(|a| sign * a).collect();
        let pencil = Pencil { entries: &entries, mass: self.mass.as_deref() };
        let matrix = (&self.elimination, pencil);
        let found = self.known.with(|known| {
            let known = known.filter(|_| dynamics.is_flow());
            self.leading.rightmost(matrix, request.count, known)
        })?;
        let Rightmost { spectrum, certain } = found;
        self.uncertain += usize::from(!certain);
        Ok(spectrum)
    }

    /// Returns a matrix with this pattern as a dense matrix, column by column.
    pub fn dense(&self, entries: &[f64]) -> Vec<f64> {
        let n = self.coloring.size();
        let mut dense = vec![0.0; n * n];
        for (k, a) in entries.iter().enumerate() {
            let [i, j] = self.place(k);
            dense[j * n + i] = *a;
        }
        dense
    }

    /// A message if the counts of unstable eigenvalues are uncertain at any point.
    pub fn doubts(&self) -> Option<String> {
        let count = self.uncertain;
        (count > 0).then(|| {
            format!(
                "the number of unstable eigenvalues is uncertain in {count} spectra: only the \
                 eigenvalues nearest to zero were computed, and further unstable eigenvalues are \
                 possible (set `matrices: dense` to compute all eigenvalues)"
            )
        })
    }

    /// The number of directions in which a gradient is computed: one for each color, and one for
    /// each released parameter.
    pub fn seeds(&self, released: &[usize]) -> usize {
        self.coloring.count + released.len()
    }

    /// The index of the direction in which a component of `x` varies; `usize::MAX` for a component
    /// that is constant in all directions.
    pub fn seed(&self, i: usize, released: &[usize]) -> usize {
        let n = self.coloring.size();
        match self.coloring.color(i) {
            Some(color) => color,
            None => {
                let at = released.iter().position(|parameter| n + parameter == i);
                at.map_or(usize::MAX, |at| self.coloring.count + at)
            }
        }
    }

    /// Computes a part of the gradient of a weighted sum of the equations: the components for the
    /// chunk of directions that begins at direction `start`. The equations are given as dual
    /// numbers with derivatives in these directions.
    pub fn weigh<'a>(
        &self,
        number: impl Fn(usize) -> &'a Chunk,
        (weights, released, start): (&[f64], &[usize], usize),
        out: &mut [f64],
    ) {
        let (n, pattern) = (self.coloring.size(), self.pattern());
        for (j, part) in self.coloring.columns(start, CHUNK) {
            out[j] = pattern.column(j).iter().map(|&i| weights[i] * number(i).eps[part]).sum();
        }
        for (at, parameter) in released.iter().enumerate() {
            let part = (self.coloring.count + at).wrapping_sub(start);
            if part < CHUNK {
                let parts = weights.iter().enumerate().map(|(i, w)| w * number(i).eps[part]);
                out[n + parameter] = parts.sum();
            }
        }
    }
}

/// Determines the sparsity pattern of `F_z` at `x`: the equations that depend on each unknown. For a
/// flow with a mass matrix, an equation also depends on the unknowns and the rates in the products
/// of the mass matrix with the rates.
fn places(problem: &dyn TracedEquations, x: &[f64], most: usize) -> Option<Vec<[usize; 2]>> {
    let n = problem.names().dimension();
    Traced::begin();
    let inputs: Vec<Traced> = x[..n].iter().map(|x| Traced::input(*x)).collect();
    let parameters: Vec<Traced> = x[n..].iter().map(|p| Traced::from(*p)).collect();
    let mut residual = vec![Traced::from(0.0); n];
    if problem.dynamics() != Dynamics::Implicit {
        problem.traced_residual(&inputs, &parameters, &mut residual);
        return Traced::places(&residual, n, most);
    }
    let rates: Vec<Traced> = generic(n, 5).into_iter().map(Traced::input).collect();
    let mut products = residual.clone();
    problem.traced_residual(&inputs, &parameters, &mut residual);
    problem.traced_mass_product(&inputs, &parameters, &rates, &mut products);
    let sums: Vec<Traced> = residual.iter().zip(products).map(|(r, m)| *r - m).collect();
    let both = Traced::places(&sums, 2 * n, most)?;
    Some(both.into_iter().map(|[equation, input]| [equation, input % n]).collect())
}

//! Mass matrices, and factors of linearisations of flows with a mass matrix.

use super::factors::{Factorisation, Factors};

/// The entries of a mass matrix that are not zero.
#[derive(Clone, Debug, Default, PartialEq)]
pub(in crate::core) struct MassMatrix {
    n: usize,
    /// The row, the column and the value of each entry.
    entries: Vec<(usize, usize, f64)>,
}

impl MassMatrix {
    /// Creates an `n × n` matrix from some of its entries, each with its row and column.
    pub fn new(n: usize, entries: impl Iterator<Item = ([usize; 2], f64)>) -> Self {
        let kept = entries.filter(|(_, m)| *m != 0.0);
        MassMatrix { n, entries: kept.map(|([i, j], m)| (i, j, m)).collect() }
    }

    /// Returns the values of the entries.
    pub fn entries(&self) -> Vec<f64> {
        self.entries.iter().map(|(_, _, m)| *m).collect()
    }

    /// Returns, for each unknown, whether its rate occurs in an equation.
    pub fn moving(&self) -> Vec<bool> {
        let mut moving = vec![false; self.n];
        self.entries.iter().for_each(|(_, j, _)| moving[*j] = true);
        moving
    }

    /// Computes `−M v`, or `−Mᵀ v`, for a real vector, or for a complex vector that consists of
    /// real parts followed by imaginary parts.
    fn minus_times(&self, v: &[f64], out: &mut [f64], transposed: bool) {
        out.fill(0.0);
        let size = self.n.max(1);
        for (v, out) in v.chunks(size).zip(out.chunks_mut(size)) {
            for &(i, j, m) in &self.entries {
                let [row, column] = if transposed { [j, i] } else { [i, j] };
                out[row] -= m * v[column];
            }
        }
    }
}

/// The factors of a linearisation `A − σ M` with a mass matrix `M`.
#[derive(Default)]
struct WithMass<F> {
    factors: F,
    mass: MassMatrix,
}

/// Returns the previous factors if they have the requested type, and new factors otherwise; with a
/// mass matrix `M`, the factors of a linearisation `A − σ M`.
pub(in crate::core) fn factors_with_mass<F: Factorisation + Default>(
    into: &mut Factors,
    mass: Option<MassMatrix>,
) -> &mut F {
    let Some(mass) = mass else { return into.reuse(|_: &F| true, F::default) };
    let with_mass = into.reuse(|_: &WithMass<F>| true, WithMass::default);
    with_mass.mass = mass;
    &mut with_mass.factors
}

impl<F: Factorisation> Factorisation for WithMass<F> {
    fn solve(&mut self, right: &mut [f64]) {
        self.factors.solve(right);
    }

    fn solve_transposed(&mut self, right: &mut [f64]) {
        self.factors.solve_transposed(right);
    }

    fn determinant_sign(&self) -> f64 {
        self.factors.determinant_sign()
    }

    fn growth_derivative(&self, v: &[f64], out: &mut [f64]) {
        self.mass.minus_times(v, out, false);
    }

    fn growth_derivative_transposed(&self, w: &[f64], out: &mut [f64]) {
        self.mass.minus_times(w, out, true);
    }
}

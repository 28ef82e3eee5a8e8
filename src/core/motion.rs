//! The linearised motion about a solution: oscillations, and what decides stability.

use super::linear::BorderedLu;
use super::zero::{Border, Dynamics, Singular, Spectrum};

/// The linearised motion `L(ω) v = 0` of oscillations `e^{iωt}` about an equilibrium, `L = F_z − iω`, or
/// of multipliers `e^{iω}` about a periodic orbit, `L = F_z` with `x(1) = e^{iω} x(0)` in place of the
/// boundary conditions (and further unknowns, such as the period, zero).
///
/// Complex vectors are given as their real parts, one after the other, and then their imaginary parts.
pub trait Oscillation {
    /// Factors `L(ω)` at the point assembled last within a complex column `b` and row `c*` (each of
    /// length `2n`).
    ///
    /// # Errors
    /// [`Singular`] if the bordered matrix is.
    fn factor(&mut self, omega: f64, column: &[f64], row: &[f64]) -> Result<(), Singular>;

    /// Solves with the bordered matrix, in place: real parts of the `n + 1` unknowns, then imaginary
    /// parts.
    fn solve(&mut self, right: &mut [f64]);

    /// Solves with the conjugate transposed bordered matrix, in place.
    fn solve_transposed(&mut self, right: &mut [f64]);

    /// `∂L/∂ω v` at the point assembled last.
    fn slope(&mut self, omega: f64, v: &[f64], out: &mut [f64]);
}

/// What a spectrum says about stability, and the test functions of bifurcations that it holds.
///
/// ```
/// use tangency::core::{motion::Stability, zero::Dynamics};
/// // Multipliers of an orbit beyond a period doubling.
/// let orbit = Stability::of(Dynamics::Periodic, &[(-1.2, 0.0), (0.1, 0.0)]);
/// assert!(orbit.unstable == 1 && orbit.doubling < 0.0 && orbit.oscillation < 0.0);
/// // Eigenvalues of an equilibrium beyond a Hopf point.
/// let equilibrium = Stability::of(Dynamics::Flow, &[(0.1, 2.0), (0.1, -2.0), (-1.0, 0.0)]);
/// assert!(equilibrium.unstable == 2 && equilibrium.oscillation > 0.0);
/// ```
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Stability {
    /// How many eigenvalues or multipliers are unstable.
    pub unstable: usize,
    /// A number whose sign changes where a pair `±iω` of eigenvalues, or `e^{±iω}` of multipliers, crosses
    /// (or a neutral saddle, `λ, −λ` or `μ, 1/μ`); 0 where no such motion is meant.
    pub oscillation: f64,
    /// `Π (1 + μ)/(1 + |μ|)` over all multipliers, which vanishes where one is −1; 1 for an equilibrium.
    /// As a product over all it does not depend on telling them apart.
    pub doubling: f64,
}

impl Stability {
    /// The verdict on a spectrum.
    pub fn of(dynamics: Dynamics, spectrum: &[(f64, f64)]) -> Self {
        let count = |unstable: &dyn Fn(&(f64, f64)) -> bool| {
            spectrum.iter().filter(|eigenvalue| unstable(eigenvalue)).count()
        };
        match dynamics {
            Dynamics::Periodic => Stability {
                unstable: count(&|mu| mu.0.hypot(mu.1) > 1.0),
                oscillation: pairs(spectrum, |a, b| a * b - 1.0, |re, im| re.hypot(im) - 1.0),
                doubling: spectrum.iter().map(doubling_factor).product(),
            },
            Dynamics::Flow => Stability {
                unstable: count(&|lambda| lambda.0 > 0.0),
                oscillation: pairs(spectrum, |a, b| a + b, |re, _| re),
                doubling: 1.0,
            },
            _ => Stability {
                unstable: count(&|lambda| lambda.0 > 0.0),
                oscillation: 0.0,
                doubling: 1.0,
            },
        }
    }

    /// The same with test functions that keep their signs where a multiplier passes through infinity.
    pub fn oriented(self, orientation: f64) -> Self {
        let Stability { unstable, oscillation, doubling } = self;
        Stability {
            unstable,
            oscillation: oscillation * orientation,
            doubling: doubling * orientation,
        }
    }
}

/// `(1 + μ)/(1 + |μ|)`, or the square root of its square for one of a complex pair.
fn doubling_factor(mu: &(f64, f64)) -> f64 {
    let size = mu.0.hypot(mu.1);
    match (mu.1 == 0.0, size.is_finite()) {
        (_, false) => mu.0.signum(),
        (true, _) => (1.0 + mu.0) / (1.0 + size),
        (false, _) => (1.0 + mu.0).hypot(mu.1) / (1.0 + size),
    }
}

/// The sign of the product of `real(a, b)` over all pairs of real eigenvalues and of `complex(re, im)` over
/// all complex pairs.
fn pairs(
    spectrum: &[(f64, f64)],
    real: impl Fn(f64, f64) -> f64,
    complex: impl Fn(f64, f64) -> f64,
) -> f64 {
    let mut sign = 1.0_f64;
    let reals = || spectrum.iter().filter(|l| l.1 == 0.0).map(|l| l.0);
    for (i, a) in reals().enumerate() {
        for b in reals().skip(i + 1) {
            sign *= real(a, b).signum();
        }
    }
    spectrum.iter().filter(|l| l.1 > 0.0).fold(sign, |sign, l| sign * complex(l.0, l.1).signum())
}

/// [`Oscillation`] of a dense matrix `A`: `L = A − iω`, in real arithmetic of twice the size.
#[derive(Default)]
pub struct DenseOscillation {
    matrix: Vec<f64>,
    columns: Vec<f64>,
    rows: Vec<f64>,
    work: Vec<f64>,
    lu: BorderedLu,
}

impl DenseOscillation {
    /// Factors `A − iω` (`A` one column after the other) within a complex column and row.
    ///
    /// # Errors
    /// [`Singular`] if the bordered matrix is.
    pub fn factor(
        &mut self,
        matrix: &[f64],
        omega: f64,
        column: &[f64],
        row: &[f64],
    ) -> Result<(), Singular> {
        let n = matrix.len().isqrt();
        let size = 2 * n;
        self.matrix.clear();
        self.matrix.resize(size * size, 0.0);
        for j in 0..n {
            for i in 0..n {
                let entry = matrix[j * n + i];
                self.matrix[j * size + i] = entry;
                self.matrix[(n + j) * size + n + i] = entry;
            }
            self.matrix[(n + j) * size + j] = omega;
            self.matrix[j * size + n + j] = -omega;
        }
        // Columns b·1 and b·i; rows of c*·v, real and imaginary part.
        self.columns.resize(2 * size, 0.0);
        self.rows.resize(2 * size, 0.0);
        for i in 0..n {
            self.columns[i] = column[i];
            self.columns[n + i] = column[n + i];
            self.columns[size + i] = -column[n + i];
            self.columns[size + n + i] = column[i];
            self.rows[i] = row[i];
            self.rows[n + i] = row[n + i];
            self.rows[size + i] = -row[n + i];
            self.rows[size + n + i] = row[i];
        }
        let border =
            Border { width: 2, columns: &self.columns, rows: &self.rows, corner: &[0.0; 4] };
        self.lu.factor(&self.matrix, border)
    }

    /// Solves as [`Oscillation::solve`].
    pub fn solve(&mut self, right: &mut [f64]) {
        self.permuted(right, |lu, work| lu.solve(work));
    }

    /// Solves as [`Oscillation::solve_transposed`].
    pub fn solve_transposed(&mut self, right: &mut [f64]) {
        self.permuted(right, |lu, work| lu.solve_transposed(work));
    }

    /// The border's unknown comes after its part of the vector outside, after both parts inside.
    fn permuted(&mut self, right: &mut [f64], solve: impl Fn(&mut BorderedLu, &mut [f64])) {
        let n = right.len() / 2 - 1;
        self.work.clear();
        self.work.extend_from_slice(&right[..n]);
        self.work.extend_from_slice(&right[n + 1..2 * n + 1]);
        self.work.extend([right[n], right[2 * n + 1]]);
        solve(&mut self.lu, &mut self.work);
        right[..n].copy_from_slice(&self.work[..n]);
        right[n + 1..2 * n + 1].copy_from_slice(&self.work[n..2 * n]);
        (right[n], right[2 * n + 1]) = (self.work[2 * n], self.work[2 * n + 1]);
    }

    /// `∂L/∂ω v = −i v`.
    pub fn slope(v: &[f64], out: &mut [f64]) {
        let n = v.len() / 2;
        for i in 0..n {
            (out[i], out[n + i]) = (v[n + i], -v[i]);
        }
    }
}

/// Beyond this size eigenvalues are infinite but for rounding.
const INFINITE: f64 = 1e8;

/// The first eigenvalues of a spectrum by falling real parts, so that each of them is continuous along a branch;
/// none if one is infinite.
pub(super) fn deciding(spectrum: &[(f64, f64)], count: usize) -> Spectrum {
    let mut first: Spectrum = spectrum.iter().take(count).copied().collect();
    if !first.iter().all(|(real, imaginary)| real.hypot(*imaginary) < INFINITE) {
        return Spectrum::new();
    }
    first.sort_by(|a, b| b.0.total_cmp(&a.0).then(b.1.total_cmp(&a.1)));
    first
}

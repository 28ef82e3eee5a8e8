//! Center manifolds of equilibria to any order, in complex coordinates.
//!
//! With critical eigenvalues `λ_j`, null vectors `q_j` and `p_j`, the manifold `z = z₀ + W(ξ)` and
//! the motion `ξ' = R(ξ)` on it satisfy `F(z₀ + W(ξ)) = DW(ξ) R(ξ)`. Order by order, for each
//! monomial `ξ^α`,
//!
//! ```text
//!     (F_z − λ·α) W_α = Σ_j R_jα q_j − N_α + D_α,
//! ```
//!
//! where `N_α` and `D_α` follow from lower orders. `R_jα = 0` but where `λ·α = λ_j`: there `R_jα`
//! makes the equation solvable, and `p_j* W_α = 0` (X. Cabré, E. Fontich and R. de la Llave, *J.
//! Differential Equations* 218:444, 2005). `N_α` comes from evaluating `F` on jets.

use super::forms::Forms;
use crate::core::failure::Failure;
use crate::core::linalg::{Border, Factors, Form};
use crate::core::scalar::Space;
use faer::c64;

/// A critical eigenvalue `iω`. Unless `ω = 0`, its conjugate is critical as well.
pub(super) struct Eigenvalue {
    pub omega: f64,
    pub right: Vec<c64>,
    pub left: Vec<c64>,
}

/// A polynomial in all variables, by the monomials of a space.
type Coefficients = Vec<c64>;

const ZERO: c64 = c64::new(0.0, 0.0);
const ONE: c64 = c64::new(1.0, 0.0);
const I: c64 = c64::new(0.0, 1.0);

/// The motion on a center manifold.
pub(super) struct Motion {
    space: &'static Space,
    /// `R_j` of the first variable of each eigenvalue: its own, not the conjugate.
    rates: Vec<Coefficients>,
}

impl Motion {
    /// The coefficient of a monomial in the rate of an eigenvalue's variable. The variables are, for
    /// each eigenvalue, one that is real, or one and its conjugate.
    pub fn of(&self, eigenvalue: usize, exponents: &[u8]) -> c64 {
        self.space.position(exponents).map_or(ZERO, |k| self.rates[eigenvalue][k])
    }
}

/// The product of two polynomials.
fn product(space: &Space, a: &[c64], b: &[c64]) -> Coefficients {
    let mut product = vec![ZERO; space.len()];
    for [i, j, k] in &space.products {
        product[usize::from(*k)] += a[usize::from(*i)] * b[usize::from(*j)];
    }
    product
}

/// Each monomial as a polynomial in new variables, given the old variables as polynomials in them.
fn substitution(space: &Space, variables: &[Coefficients]) -> Vec<Coefficients> {
    let mut all = vec![vec![ZERO; space.len()]];
    all[0][0] = ONE;
    for (rest, variable) in &space.factors {
        let next = product(space, &all[usize::from(*rest)], &variables[usize::from(*variable)]);
        all.push(next);
    }
    all
}

/// The variables of the eigenvalues: positions of the first one of each, and how many there are.
fn places(eigenvalues: &[Eigenvalue]) -> (Vec<usize>, usize) {
    let mut count = 0;
    let mut places = Vec::new();
    for eigenvalue in eigenvalues {
        places.push(count);
        count += if eigenvalue.omega == 0.0 { 1 } else { 2 };
    }
    (places, count)
}

/// Changes of variables between `(z, z̄)` and `(u, v)`, `z = u + iv`.
struct Changes {
    to_real: Vec<Coefficients>,
    to_complex: Vec<Coefficients>,
}

impl Changes {
    fn new(space: &'static Space, eigenvalues: &[Eigenvalue]) -> Self {
        let (places, count) = places(eigenvalues);
        let linear = |terms: &[(usize, c64)]| {
            let mut polynomial = vec![ZERO; space.len()];
            terms.iter().for_each(|(variable, factor)| polynomial[1 + variable] = *factor);
            polynomial
        };
        let (mut real, mut complex) = (Vec::with_capacity(count), Vec::with_capacity(count));
        for (eigenvalue, k) in eigenvalues.iter().zip(places) {
            if eigenvalue.omega == 0.0 {
                real.push(linear(&[(k, ONE)]));
                complex.push(linear(&[(k, ONE)]));
                continue;
            }
            let (half, turned) = (ONE * 0.5, I * 0.5);
            real.extend([linear(&[(k, ONE), (k + 1, I)]), linear(&[(k, ONE), (k + 1, -I)])]);
            complex.extend([
                linear(&[(k, half), (k + 1, half)]),
                linear(&[(k, -turned), (k + 1, turned)]),
            ]);
        }
        Changes { to_real: substitution(space, &real), to_complex: substitution(space, &complex) }
    }

    /// Vectors of coefficients in the other variables.
    fn changed(by: &[Coefficients], terms: &[Vec<c64>], n: usize) -> Vec<Vec<c64>> {
        let mut changed = vec![vec![ZERO; n]; by.len()];
        for (term, polynomial) in terms.iter().zip(by) {
            for (target, factor) in changed.iter_mut().zip(polynomial).filter(|it| *it.1 != ZERO) {
                target.iter_mut().zip(term).for_each(|(out, c)| *out += factor * c);
            }
        }
        changed
    }
}

/// The motion on the center manifold of these eigenvalues, to an order.
pub(super) fn motion(
    forms: &mut Forms,
    eigenvalues: &[Eigenvalue],
    order: usize,
) -> Result<Motion, Failure> {
    let n = forms.n;
    let (first, count) = places(eigenvalues);
    let space = Space::of(count, order).map_err(|cause| Failure::Unsupported(cause.to_string()))?;
    let changes = Changes::new(space, eigenvalues);
    let mut manifold = vec![vec![ZERO; n]; space.len()];
    let mut rates = vec![vec![ZERO; space.len()]; count];
    for (eigenvalue, k) in eigenvalues.iter().zip(&first) {
        manifold[1 + k].clone_from(&eigenvalue.right);
        if eigenvalue.omega != 0.0 {
            manifold[2 + k] = eigenvalue.right.iter().map(c64::conj).collect();
        }
    }
    for degree in 2..=order {
        let real = Changes::changed(&changes.to_real, &manifold, n);
        let real: Vec<Vec<f64>> = real.iter().map(|w| w.iter().map(|c| c.re).collect()).collect();
        let images = forms.expand(space, &real)?;
        let complex = |f: &Vec<f64>| f.iter().map(|f| c64::new(*f, 0.0)).collect();
        let images: Vec<Vec<c64>> = images.iter().map(complex).collect();
        let images = Changes::changed(&changes.to_complex, &images, n);
        let carried = carried(space, &manifold, &rates, degree);
        for monomial in space.of_degree(degree) {
            let exponents = space.exponents(monomial);
            let turns = turns(eigenvalues, exponents);
            let omega: f64 =
                turns.iter().zip(eigenvalues).map(|(k, e)| f64::from(*k) * e.omega).sum();
            let right: Vec<c64> =
                images[monomial].iter().zip(&carried[monomial]).map(|(f, d)| d - f).collect();
            match resonant(eigenvalues, &turns) {
                Some((j, false)) => {
                    let Eigenvalue { right: q, left: p, .. } = &eigenvalues[j];
                    let (w, rate) = forms.solve_bordered(omega, (q, p), &right)?;
                    manifold[monomial] = w;
                    rates[first[j]][monomial] = rate;
                }
                // The conjugate of another monomial.
                Some((j, true)) => {
                    let Eigenvalue { right: q, left: p, .. } = &eigenvalues[j];
                    let conjugate = |v: &[c64]| v.iter().map(c64::conj).collect::<Vec<_>>();
                    let border = (&conjugate(q)[..], &conjugate(p)[..]);
                    let (w, rate) = forms.solve_bordered(omega, border, &right)?;
                    manifold[monomial] = w;
                    rates[first[j] + 1][monomial] = rate;
                }
                None => manifold[monomial] = forms.solve_complex(omega, &right)?,
            }
        }
    }
    let rates = first.iter().map(|k| std::mem::take(&mut rates[*k])).collect();
    Ok(Motion { space, rates })
}

/// How often each pair turns in a monomial: the power of `z` less that of `z̄`; 0 for a zero
/// eigenvalue.
fn turns(eigenvalues: &[Eigenvalue], exponents: &[u8]) -> Vec<i32> {
    let (places, _) = places(eigenvalues);
    let of = |(eigenvalue, k): (&Eigenvalue, usize)| match eigenvalue.omega == 0.0 {
        true => 0,
        false => i32::from(exponents[k]) - i32::from(exponents[k + 1]),
    };
    eigenvalues.iter().zip(places).map(of).collect()
}

/// The eigenvalue that a monomial resonates with, and whether it does so with its conjugate.
fn resonant(eigenvalues: &[Eigenvalue], turns: &[i32]) -> Option<(usize, bool)> {
    let sum: i32 = turns.iter().map(|k| k.abs()).sum();
    match sum {
        0 => eigenvalues.iter().position(|e| e.omega == 0.0).map(|j| (j, false)),
        1 => {
            let j = turns.iter().position(|k| *k != 0)?;
            Some((j, turns[j] < 0))
        }
        _ => None,
    }
}

/// The terms `D_α` of one degree, `Σ_j ∂W/∂ξ_j R_j` without those of `W` of first order and of `R`
/// of first order.
fn carried(
    space: &Space,
    manifold: &[Vec<c64>],
    rates: &[Coefficients],
    degree: usize,
) -> Vec<Vec<c64>> {
    let n = manifold[0].len();
    let mut sums = vec![vec![ZERO; n]; space.len()];
    for low in 2..degree {
        for (beta, gamma) in space
            .of_degree(low)
            .flat_map(|beta| space.of_degree(degree + 1 - low).map(move |gamma| (beta, gamma)))
        {
            for (j, rate) in rates.iter().enumerate().filter(|(_, rate)| rate[gamma] != ZERO) {
                let mut exponents = space.exponents(beta).to_vec();
                let power = f64::from(exponents[j]);
                if power == 0.0 {
                    continue;
                }
                exponents[j] -= 1;
                exponents.iter_mut().zip(space.exponents(gamma)).for_each(|(e, g)| *e += g);
                let Some(alpha) = space.position(&exponents) else { continue };
                let factor = rate[gamma] * power;
                let terms = sums[alpha].iter_mut().zip(&manifold[beta]);
                terms.for_each(|(sum, w)| *sum += factor * w);
            }
        }
    }
    sums
}

impl Forms<'_, '_> {
    /// The coefficients of `F(z₀ + W)` for a polynomial `W`, at all parameters as they are.
    fn expand(
        &mut self,
        space: &'static Space,
        terms: &[Vec<f64>],
    ) -> Result<Vec<Vec<f64>>, Failure> {
        self.at.system.expand(self.at.x, space, terms)
    }

    /// `W` and `R` with `(F_z − iω) W = R q + right` and `p* W = 0`.
    fn solve_bordered(
        &mut self,
        omega: f64,
        (q, p): (&[c64], &[c64]),
        right: &[c64],
    ) -> Result<(Vec<c64>, c64), Failure> {
        let n = self.n;
        let parts = |v: &[c64]| -> Vec<f64> {
            v.iter().map(|c| c.re).chain(v.iter().map(|c| c.im)).collect()
        };
        let (columns, rows) = (parts(q), parts(p));
        let border =
            Border { width: 1, columns: &columns, rows: &rows, corner: &[0.0], units: &[] };
        let mut factors = Factors::default();
        self.at.system.assemble(self.at.x)?;
        self.at.system.factor(Form::Oscillation(omega), border, &mut factors)?;
        let mut all: Vec<f64> = right.iter().map(|c| c.re).chain([0.0]).collect();
        all.extend(right.iter().map(|c| c.im).chain([0.0]));
        factors.solve(&mut all);
        let (re, im) = all.split_at(n + 1);
        let mut solution: Vec<c64> = re.iter().zip(im).map(|(a, b)| c64::new(*a, *b)).collect();
        let rate = -solution.pop().unwrap_or_default();
        Ok((solution, rate))
    }
}

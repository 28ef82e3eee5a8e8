//! Polynomials with complex coefficients, and polynomial maps.

use crate::core::scalar::Space;
use faer::c64;

/// The coefficients of a polynomial in all variables, one for each monomial of a space of
/// polynomials.
pub(super) type Coefficients = Vec<c64>;

pub(super) const ZERO: c64 = c64::new(0.0, 0.0);
pub(super) const ONE: c64 = c64::new(1.0, 0.0);
pub(super) const I: c64 = c64::new(0.0, 1.0);

/// The type of a variable of a polynomial: real, or one of a complex conjugate pair.
#[derive(Clone, Copy, PartialEq)]
pub(super) enum Variable {
    /// A real variable.
    Real,
    /// The first variable `z` of a complex pair `z`, `z̄`.
    Complex,
    /// The second variable `z̄` of a complex pair `z`, `z̄`.
    Conjugate,
}

/// Creates a linear polynomial from variables and their coefficients.
pub(super) fn linear(space: &Space, terms: &[(usize, c64)]) -> Coefficients {
    let mut polynomial = vec![ZERO; space.len()];
    terms.iter().for_each(|(variable, factor)| polynomial[1 + variable] = *factor);
    polynomial
}

/// Returns the product of two polynomials.
fn product(space: &Space, a: &[c64], b: &[c64]) -> Coefficients {
    let mut product = vec![ZERO; space.len()];
    for [i, j, k] in &space.products {
        product[usize::from(*k)] += a[usize::from(*i)] * b[usize::from(*j)];
    }
    product
}

/// Returns each monomial of the old variables as a polynomial in new variables, given the old
/// variables as polynomials in the new variables.
pub(super) fn substitution(space: &Space, variables: &[Coefficients]) -> Vec<Coefficients> {
    let mut all = vec![vec![ZERO; space.len()]];
    all[0][0] = ONE;
    for (rest, variable) in &space.factors {
        let next = product(space, &all[usize::from(*rest)], &variables[usize::from(*variable)]);
        all.push(next);
    }
    all
}

/// Returns the derivative of each monomial along a vector field.
pub(super) fn derivation(space: &Space, field: &[Coefficients]) -> Vec<Coefficients> {
    let mut all = vec![vec![ZERO; space.len()]];
    for (rest, variable) in &space.factors {
        let (rest, variable) = (usize::from(*rest), usize::from(*variable));
        let monomial = |k: usize| {
            let mut polynomial = vec![ZERO; space.len()];
            polynomial[k] = ONE;
            polynomial
        };
        let mut next = product(space, &all[rest], &monomial(1 + variable));
        let second = product(space, &monomial(rest), &field[variable]);
        next.iter_mut().zip(second).for_each(|(sum, term)| *sum += term);
        all.push(next);
    }
    all
}

/// Computes the vector field `V` whose time-one flow is the map `S = exp V`. The linear part of `S`
/// must be triangular with ones on its diagonal. With `S* f = f ∘ S`, the vector field is the
/// series `V = (S* − 1) ξ − (S* − 1)² ξ/2 + …`. The series is finite, since `S* − 1` is nilpotent
/// on polynomials of bounded degree.
pub(super) fn logarithm(space: &Space, map: &[Coefficients]) -> Vec<Coefficients> {
    let mut change = substitution(space, map);
    change.iter_mut().enumerate().for_each(|(k, image)| image[k] -= ONE);
    let of_variable = |k: usize| {
        let mut sum = vec![ZERO; space.len()];
        let mut term = linear(space, &[(k, ONE)]);
        for power in 1..=space.len() {
            term = applied(&change, &term);
            if term.iter().all(|c| *c == ZERO) {
                break;
            }
            let factor = if power % 2 == 1 { 1.0 } else { -1.0 } / power as f64;
            sum.iter_mut().zip(&term).for_each(|(sum, c)| *sum += factor * c);
        }
        sum
    };
    (0..map.len()).map(of_variable).collect()
}

/// Applies a linear map of polynomials, given by the images of the monomials.
fn applied(images: &[Coefficients], polynomial: &[c64]) -> Coefficients {
    let mut sum = vec![ZERO; polynomial.len()];
    for (image, factor) in images.iter().zip(polynomial).filter(|it| *it.1 != ZERO) {
        sum.iter_mut().zip(image).for_each(|(sum, c)| *sum += factor * c);
    }
    sum
}

/// Changes of variables between complex pairs `(z, z̄)` and real pairs `(u, v)`, where `z = u +
/// iv`.
pub(super) struct Changes {
    to_real: Vec<Coefficients>,
    to_complex: Vec<Coefficients>,
}

impl Changes {
    pub fn new(space: &Space, variables: &[Variable]) -> Self {
        let (mut real, mut complex) = (Vec::new(), Vec::new());
        for (k, variable) in variables.iter().enumerate() {
            let (half, turned) = (ONE * 0.5, I * 0.5);
            let (old, new) = match variable {
                Variable::Real => ([(k, ONE), (k, ONE)], [(k, ONE), (k, ONE)]),
                Variable::Complex => ([(k, ONE), (k + 1, I)], [(k, half), (k + 1, half)]),
                Variable::Conjugate => ([(k - 1, ONE), (k, -I)], [(k - 1, -turned), (k, turned)]),
            };
            real.push(linear(space, &old));
            complex.push(linear(space, &new));
        }
        Changes { to_real: substitution(space, &real), to_complex: substitution(space, &complex) }
    }

    /// Converts vectors of coefficients of polynomials in `(z, z̄)` to real coefficients of
    /// polynomials in `(u, v)`.
    pub fn to_real(&self, terms: &[Vec<c64>], n: usize) -> Vec<Vec<f64>> {
        let changed = Self::changed(&self.to_real, terms, n);
        changed.iter().map(|vector| vector.iter().map(|c| c.re).collect()).collect()
    }

    /// Converts vectors of real coefficients of polynomials in `(u, v)` to coefficients of
    /// polynomials in `(z, z̄)`.
    pub fn to_complex(&self, terms: &[Vec<f64>], n: usize) -> Vec<Vec<c64>> {
        let complex = |vector: &Vec<f64>| vector.iter().map(|c| c64::new(*c, 0.0)).collect();
        let terms: Vec<Vec<c64>> = terms.iter().map(complex).collect();
        Self::changed(&self.to_complex, &terms, n)
    }

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

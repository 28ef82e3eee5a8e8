//! The monomials of jets and their multiplication table.

use std::collections::BTreeMap;
use std::sync::{Mutex, OnceLock, PoisonError};

/// The highest order of a jet. Up to this order, integration by the method of order 8 is exact for
/// durations whose real part is zero.
pub(crate) const MOST_ORDER: usize = 8;

/// The largest number of coefficients of a jet.
const MOST_COEFFICIENTS: usize = 1024;

/// The reason why a jet cannot be created.
#[derive(Clone, Copy, Debug, PartialEq, Eq, miette::Diagnostic, thiserror::Error)]
#[non_exhaustive]
pub enum JetError {
    /// The order of the jet is too high, or the jet has too many coefficients.
    #[error(
        "a jet of order {order} in {variables} variables has {coefficients} coefficients, but at \
         most {most} coefficients, up to order {MOST_ORDER}, are supported"
    )]
    #[diagnostic(help("use a jet of lower order, or a jet in fewer variables"))]
    TooLarge {
        /// The number of variables of the jet.
        variables: usize,
        /// The order.
        order: usize,
        /// The number of coefficients that the jet would have.
        coefficients: usize,
        /// The largest possible number of coefficients.
        most: usize,
    },
    /// The variable does not exist in the space of the jet.
    #[error("a jet in {variables} variables has no variable with the number {variable}")]
    NoVariable {
        /// The number of variables of the space.
        variables: usize,
        /// The requested variable.
        variable: usize,
    },
}

/// The monomials of jets of one order in a given number of variables: all `ε^α` with `|α| ≤ N`,
/// sorted by increasing degree, and for equal degrees by decreasing powers of the first variable.
///
/// ```
/// use tangency::core::scalar::Space;
/// let space = Space::of(2, 2)?;
/// let monomials: Vec<&[u8]> = (0..space.len()).map(|k| space.exponents(k)).collect();
/// assert_eq!(monomials, [[0, 0], [1, 0], [0, 1], [2, 0], [1, 1], [0, 2]]);
/// assert_eq!(space.position(&[1, 1]), Some(4));
/// # Ok::<(), tangency::core::scalar::JetError>(())
/// ```
pub struct Space {
    variables: usize,
    order: usize,
    /// The exponents of all monomials, stored one monomial after another.
    exponents: Vec<u8>,
    /// The position of the first monomial of each degree; the last entry is the number of
    /// monomials.
    degrees: Vec<usize>,
    /// The products `ε^α ε^β = ε^γ`, stored as positions `(α, β, γ)` of monomials.
    pub(crate) products: Vec<[u16; 3]>,
    /// For each monomial except the first, an earlier monomial and a variable whose product is the
    /// monomial.
    pub(crate) factors: Vec<(u16, u16)>,
}

impl std::fmt::Debug for Space {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "order {} in {} variables", self.order, self.variables)
    }
}

/// Returns the binomial coefficient `n` over `k`, saturated at the largest integer.
fn binomial(n: usize, k: usize) -> usize {
    (1..=k).fold(1, |product: usize, i| product.saturating_mul(n - k + i) / i)
}

/// Appends the exponents of all monomials of one degree to a list.
fn of_degree(variables: usize, degree: usize, prefix: &mut Vec<u8>, out: &mut Vec<u8>) {
    if variables == 1 {
        out.extend_from_slice(prefix);
        out.push(degree as u8);
        return;
    }
    for first in (0..=degree).rev() {
        prefix.push(first as u8);
        of_degree(variables - 1, degree - first, prefix, out);
        prefix.pop();
    }
}

impl Space {
    /// Returns the space of jets of a given order in `variables` variables (at least one variable).
    /// Each space is created at its first use and shared by the whole program.
    ///
    /// # Errors
    /// [`JetError::TooLarge`] if the order exceeds 8, or the number of coefficients exceeds 1024.
    pub fn of(variables: usize, order: usize) -> Result<&'static Space, JetError> {
        static KNOWN: OnceLock<Mutex<BTreeMap<(usize, usize), &'static Space>>> = OnceLock::new();
        let coefficients = binomial(variables.saturating_add(order), order.min(variables));
        if order > MOST_ORDER || variables == 0 || coefficients > MOST_COEFFICIENTS {
            let most = MOST_COEFFICIENTS;
            return Err(JetError::TooLarge { variables, order, coefficients, most });
        }
        let known = KNOWN.get_or_init(Mutex::default);
        let mut known = known.lock().unwrap_or_else(PoisonError::into_inner);
        Ok(*known
            .entry((variables, order))
            .or_insert_with(|| Box::leak(Box::new(Space::new(variables, order)))))
    }

    fn new(variables: usize, order: usize) -> Self {
        let (mut exponents, mut degrees) = (Vec::new(), vec![0]);
        for degree in 0..=order {
            of_degree(variables, degree, &mut Vec::new(), &mut exponents);
            degrees.push(exponents.len() / variables);
        }
        let (products, factors) = Default::default();
        let mut space = Space { variables, order, exponents, degrees, products, factors };
        space.multiply();
        space
    }

    /// Tabulates the products of monomials, sorted by the resulting monomial.
    fn multiply(&mut self) {
        let monomials: Vec<&[u8]> = self.exponents.chunks(self.variables).collect();
        let numbers = monomials.iter().enumerate().map(|(k, monomial)| (*monomial, k as u16));
        let places: BTreeMap<&[u8], u16> = numbers.collect();
        let (mut products, mut factors) = (Vec::new(), Vec::new());
        for (i, a) in monomials.iter().enumerate() {
            for (j, b) in monomials.iter().enumerate() {
                let product: Vec<u8> = a.iter().zip(*b).map(|(a, b)| a + b).collect();
                if let Some(k) = places.get(product.as_slice()) {
                    products.push([i as u16, j as u16, *k]);
                }
            }
        }
        for monomial in &monomials[1..] {
            let mut rest = monomial.to_vec();
            let variable = rest.iter().position(|power| *power > 0).unwrap_or(0);
            rest[variable] -= 1;
            factors.push((places[rest.as_slice()], variable as u16));
        }
        products.sort_by_key(|[_, _, k]| *k);
        (self.products, self.factors) = (products, factors);
    }

    /// Returns the number of variables.
    pub fn variables(&self) -> usize {
        self.variables
    }

    /// The order.
    pub fn order(&self) -> usize {
        self.order
    }

    /// Returns the number of monomials, which is the number of coefficients of a jet.
    #[allow(clippy::len_without_is_empty, reason = "the constant is always there")]
    pub fn len(&self) -> usize {
        self.degrees[self.order + 1]
    }

    /// Returns the exponents of all variables in a monomial.
    pub fn exponents(&self, monomial: usize) -> &[u8] {
        &self.exponents[monomial * self.variables..(monomial + 1) * self.variables]
    }

    /// Returns the positions of the monomials of one degree; an empty range if the degree exceeds
    /// the order.
    pub(crate) fn of_degree(&self, degree: usize) -> std::ops::Range<usize> {
        match self.degrees.get(degree..degree + 2) {
            Some(ends) => ends[0]..ends[1],
            None => self.len()..self.len(),
        }
    }

    /// Returns the position of the monomial with these powers of the variables; `None` if the
    /// degree exceeds the order.
    pub fn position(&self, exponents: &[u8]) -> Option<usize> {
        if exponents.len() != self.variables {
            return None;
        }
        let degree = exponents.iter().map(|power| usize::from(*power)).sum();
        self.of_degree(degree).find(|k| self.exponents(*k) == exponents)
    }
}

//! Why equations cannot be evaluated.

/// A value at which the equations have no meaning: outside the domain, or not finite.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[error("{quantity} = {value:.6e} {verdict}: {remedy}")]
pub struct LeftDomain {
    /// What has the offending value, by name.
    pub quantity: String,
    /// The offending value.
    pub value: f64,
    /// What is wrong with it: that it is outside the domain of the equations, or that a step is too small.
    pub verdict: &'static str,
    /// What the domain is, or what to change.
    pub remedy: String,
}

impl LeftDomain {
    /// A value out of its domain.
    pub fn new(quantity: impl Into<String>, value: f64, remedy: impl Into<String>) -> Self {
        let verdict = "is outside the domain of the equations";
        LeftDomain { quantity: quantity.into(), value, verdict, remedy: remedy.into() }
    }
}

/// A matrix without an inverse, in arithmetic of 16 digits.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[error("{}", self.words())]
pub struct Singular {
    /// The smallest pivot.
    pub pivot: f64,
    /// The largest pivot.
    pub largest: f64,
}

impl Singular {
    /// A pivot this much smaller than what it is compared with counts as zero: the largest pivot of an
    /// equilibrated matrix, or the largest entry of its row.
    pub(crate) const THRESHOLD: f64 = 1e-15;

    fn words(&self) -> String {
        let Singular { pivot, largest } = self;
        if pivot.is_nan() {
            return "the matrix has an empty row or column, or an entry that is not a number: is every equation written, \
                    and does every unknown occur in one?"
                .into();
        }
        format!("the matrix is singular: pivot {pivot:.1e} where the largest is {largest:.1e}")
    }
}

/// Why equations could not be evaluated.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum Failure {
    /// The point lies outside the domain of the equations.
    #[error(transparent)]
    LeftDomain(#[from] LeftDomain),
    /// A matrix that defines a condition is singular.
    #[error(transparent)]
    Singular(#[from] Singular),
    /// Eigenvalues or multipliers that an iterative method did not find.
    #[error(
        "the {0} do not converge: the matrix may have entries that are not finite, or of very different sizes"
    )]
    Eigenvalues(&'static str),
    /// The condition does not apply at this point.
    #[error("{0}")]
    NotApplicable(String),
}

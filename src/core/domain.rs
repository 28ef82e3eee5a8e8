//! Values at which equations have no meaning.

/// A value outside the domain of the equations.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[error("{quantity} = {value:.6e} is outside the domain of the equations: {remedy}")]
pub struct OutOfDomain {
    /// What has the offending value, by name.
    pub quantity: String,
    /// The offending value.
    pub value: f64,
    /// What the domain is, or what to change.
    pub remedy: String,
}

impl OutOfDomain {
    /// A value outside its domain.
    pub fn new(quantity: impl Into<String>, value: f64, remedy: impl Into<String>) -> Self {
        OutOfDomain { quantity: quantity.into(), value, remedy: remedy.into() }
    }
}

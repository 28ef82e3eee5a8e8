//! The discretisation chosen for a requested accuracy.

use serde::{Deserialize, Serialize};
use std::fmt;

/// The discretisation chosen for a requested accuracy, and its estimated error.
///
/// ```
/// let chosen = tangency::output::Chosen {
///     accuracy: 1e-6,
///     settings: vec![("flow_tolerance".into(), "1e-7".into())],
///     estimate: 2.5e-7,
///     of: "fold of `P(1,1)`".into(),
/// };
/// let text = "for an accuracy of 1e-6: flow_tolerance = 1e-7, error 2.5e-7 (fold of `P(1,1)`)";
/// assert_eq!(chosen.to_string(), text);
/// ```
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Chosen {
    /// The requested maximum relative error of special points.
    pub accuracy: f64,
    /// The names and values of the settings that were chosen.
    pub settings: Vec<(String, String)>,
    /// The largest estimated relative error among all special points.
    pub estimate: f64,
    /// The special point with the largest estimated error.
    pub of: String,
}

impl fmt::Display for Chosen {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        let settings: Vec<String> =
            self.settings.iter().map(|(name, value)| format!("{name} = {value}")).collect();
        let Chosen { accuracy, estimate, of, .. } = self;
        let settings = settings.join(", ");
        write!(f, "for an accuracy of {accuracy:e}: {settings}, error {estimate:.1e} ({of})")
    }
}

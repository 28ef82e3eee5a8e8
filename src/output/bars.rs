//! The ranges of simulated histories as vertical bars over a diagram.

use super::axis::Scale;
use super::diagram::usual_axes;
use super::document::Document;
use crate::core::continuation::{Branch, Point};

/// The range of a state in a simulated history, in the axes of a diagram.
#[derive(Clone, Debug, PartialEq, serde::Serialize)]
pub(crate) struct Bar {
    /// The name of the state.
    pub state: String,
    /// The position on the horizontal axis.
    pub at: f64,
    /// The smallest and the largest value on the vertical axis.
    pub low: f64,
    pub high: f64,
}

impl Bar {
    /// Returns the range of a history over the diagram of a document with the chosen axes; `None` if
    /// the horizontal axis is not a parameter of the history, or the vertical axis is not a state.
    pub(crate) fn of(
        history: &Branch,
        document: &Document,
        axes: [Option<&str>; 2],
    ) -> Option<Bar> {
        let usual = usual_axes(&[("", document)])?;
        let [x, y] = [0, 1].map(|k| axes[k].unwrap_or(&usual[k]));
        let scales = [Scale::of(document, x).ok()?, Scale::of(document, y).ok()?];
        let state = y.strip_prefix("max_").or_else(|| y.strip_prefix("min_"));
        let state = state.filter(|_| history.column(y).is_some()).unwrap_or(y);
        let point = history.points.first()?;
        let value = |name: &str| Point::value(point, history.column(name)?);
        let at = value(history.parameters.iter().find(|name| *name == x)?)?;
        let ends = [value(&format!("min_{state}"))?, value(&format!("max_{state}"))?];
        let at = scales[0].shown(at);
        let [a, b] = ends.map(|end| scales[1].shown(end));
        // A scale may turn the axis round, and logarithmic axes show only positive values.
        let positive = [(x, at), (y, a.min(b))];
        let is_shown = positive.iter().all(|(name, value)| {
            value.is_finite() && (!document.plot.is_logarithmic(name) || *value > 0.0)
        });
        is_shown.then(|| Bar { state: state.into(), at, low: a.min(b), high: a.max(b) })
    }
}

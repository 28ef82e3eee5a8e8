//! What is attached to a curve from outside: further monitors, and conditions held along it.

use super::{Continuation, Kind, TraceError};
use crate::core::chunk::Chunk;
use crate::core::condition::Condition;
use crate::core::function::{Attached, TestPoint};
use std::sync::Arc;

impl Continuation<'_> {
    /// Records a function of points as a further monitor, which can be marked and bounded by its
    /// name. Without a gradient it cannot be held; its levels are located by bracketing.
    ///
    /// ```
    /// use tangency::core::continuation::{Continuation, Kind};
    /// use tangency::core::dense::Dense;
    /// use tangency::problems::classic::ParallelPlate;
    /// let mut plate = Dense::new(ParallelPlate);
    /// let curve = Continuation::of(&mut plate).along("load", 0.0..=1.0);
    /// let curve = curve.monitor("gap", |at| 1.0 - at.state[0]).mark("gap", 0.5);
    /// let branch = curve.trace()?;
    /// // u (1 − u)² at u = 1/2.
    /// let half = branch.of_kind(Kind::UZ).next().unwrap();
    /// assert!((half.parameters[0] - 0.125).abs() < 1e-9 && (half.monitors[0] - 0.5).abs() < 1e-9);
    /// # Ok::<(), tangency::core::continuation::TraceError>(())
    /// ```
    pub fn monitor(
        mut self,
        name: impl Into<String>,
        function: impl Fn(&TestPoint) -> f64 + Send + Sync + 'static,
    ) -> Self {
        let (name, function) = (name.into(), Arc::new(function));
        self.attached.push(Attached { name, function, dual: None });
        self
    }

    /// As [`monitor`](Self::monitor), a function `f(z, p)` of the unknowns and all parameters on
    /// dual numbers: with its gradient, levels are special points like others, and can be held
    /// along a curve.
    ///
    /// ```
    /// use tangency::core::continuation::Continuation;
    /// use tangency::core::dense::Dense;
    /// use tangency::problems::classic::Hyperbola;
    /// // x² = μ² + ε² with x μ = 20, along ε to 3: x = 5, μ = 4.
    /// let mut hyperbola = Dense::new(Hyperbola);
    /// let curve = Continuation::of(&mut hyperbola).from(&[4.5]).at("mu", 4.5).at("epsilon", 0.25);
    /// let curve = curve.smooth_monitor("product", |x, p| x[0] * p[0]).hold_level("product", 20.0);
    /// let branch = curve.along("mu", 0.0..=9.0).along("epsilon", 0.0..=3.0).trace()?;
    /// let end = branch.special.iter().find(|point| (point.parameters[1] - 3.0).abs() < 1e-9).unwrap();
    /// assert!((end.state[0] - 5.0).abs() < 1e-9 && (end.parameters[0] - 4.0).abs() < 1e-9);
    /// # Ok::<(), tangency::core::continuation::TraceError>(())
    /// ```
    pub fn smooth_monitor(
        mut self,
        name: impl Into<String>,
        function: impl Fn(&[Chunk], &[Chunk]) -> Chunk + Send + Sync + 'static,
    ) -> Self {
        self.attached.push(Attached::dual(name.into(), Arc::new(function)));
        self
    }

    /// Holds the condition of a kind of special point along the curve; one more parameter must be
    /// released. `LP`, `BP` and `HB` are known to the core; `CP` and `BT` are, too, for curves on
    /// which `LP` is held already.
    pub fn hold(mut self, kind: Kind) -> Self {
        self.held.push((kind, None));
        self
    }

    /// Holds a parameter or a monitor at a level along the curve, as at a mark; one more parameter
    /// must be released.
    pub fn hold_level(mut self, name: &str, level: f64) -> Self {
        let no_gradient = || TraceError::NoGradient(name.into());
        let held = self.quantity(name).and_then(|quantity| {
            self.level_condition((quantity, level), Kind::UZ).ok_or_else(no_gradient)
        });
        match held {
            Ok(make) => self.held.push((Kind::UZ, Some(make))),
            Err(error) => self.errors.push(error),
        }
        self
    }

    /// Holds a condition of the user's own.
    pub fn hold_condition<C: Condition + 'static>(
        mut self,
        condition: impl Fn() -> C + Send + Sync + 'static,
    ) -> Self {
        let kind = condition().kind();
        self.held.push((kind, Some(Arc::new(move || Box::new(condition())))));
        self
    }
}

//! Functions of points that a user gives as closures, on numbers or on dual numbers.

use super::condition::{At, Condition, Failure};
use super::kind::Kind;
use num_dual::Dual64;
use std::sync::Arc;

/// What a function of the user's own is given of a point on a branch.
#[derive(Clone, Copy, Debug)]
#[non_exhaustive]
pub struct TestPoint<'a> {
    /// The unknowns, on the discretisation that the point is computed on.
    pub state: &'a [f64],
    /// All parameters.
    pub parameters: &'a [f64],
    /// All monitors that come before.
    pub monitors: &'a [f64],
    /// The eigenvalues or multipliers as (real part, imaginary part); empty where they are not
    /// computed.
    pub eigenvalues: &'a [(f64, f64)],
}

/// A function of points.
pub(crate) type PointFunction = Arc<dyn Fn(&TestPoint) -> f64 + Send + Sync>;

/// A function `f(z, p)` on dual numbers, which has a gradient.
pub(crate) type DualFunction = Arc<dyn Fn(&[Dual64], &[Dual64]) -> Dual64 + Send + Sync>;

/// A monitor that a user attaches to a curve.
#[derive(Clone)]
pub(crate) struct Attached {
    pub name: String,
    pub function: PointFunction,
    /// The same on dual numbers, where it is given so.
    pub dual: Option<DualFunction>,
}

impl Attached {
    /// A function on dual numbers.
    pub fn dual(name: String, dual: DualFunction) -> Self {
        let plain = dual.clone();
        let constant = |x: &f64| Dual64::from(*x);
        let function: PointFunction = Arc::new(move |at: &TestPoint| {
            let [z, p] = [at.state, at.parameters].map(|x| x.iter().map(constant).collect());
            let (z, p): (Vec<Dual64>, Vec<Dual64>) = (z, p);
            plain(&z, &p).re
        });
        Attached { name, function, dual: Some(dual) }
    }
}

/// The condition `f(z, p) = level`, with the gradient by forward-mode dual numbers, one component
/// of `(z, p)` after the other.
pub(crate) struct Equation {
    function: DualFunction,
    level: f64,
    kind: Kind,
    x: Vec<Dual64>,
}

impl Equation {
    pub fn new(function: DualFunction, level: f64, kind: Kind) -> Self {
        Equation { function, level, kind, x: Vec::new() }
    }

    fn value(&self, n: usize) -> Dual64 {
        (self.function)(&self.x[..n], &self.x[n..])
    }
}

impl Condition for Equation {
    fn kind(&self) -> Kind {
        self.kind
    }

    fn values(&mut self, at: At, _y: &[f64], values: &mut [f64]) -> Result<(), Failure> {
        self.x.clear();
        self.x.extend(at.x.iter().map(|x| Dual64::from(*x)));
        values[0] = self.value(at.system.names().dimension()).re - self.level;
        if !values[0].is_finite() {
            let remedy = "bound the branch to where the function has a value";
            return Err(Failure::not_finite("a function of the event's", values[0], remedy));
        }
        Ok(())
    }

    fn gradients(&mut self, at: At, rows: &mut [f64], _own: &mut [f64]) -> Result<(), Failure> {
        let n = at.system.names().dimension();
        rows.fill(0.0);
        for k in (0..n).chain(at.released.iter().map(|&p| n + p)) {
            self.x[k].eps = 1.0;
            rows[k] = self.value(n).eps;
            self.x[k].eps = 0.0;
        }
        Ok(())
    }
}

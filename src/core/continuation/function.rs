//! User-defined test functions and monitors: functions of the points of a curve, written for real
//! numbers or for dual numbers.

use crate::core::bifurcation::{At, DefiningSystem, PointValues, TestFunction};
use crate::core::failure::Failure;
use crate::core::scalar::{CHUNK, Chunk};
use crate::core::system::Kind;
use std::sync::Arc;

/// The arguments of a user-defined test function or monitor.
#[derive(Clone, Copy, Debug)]
#[non_exhaustive]
pub struct TestPoint<'a> {
    /// The unknowns `z`, on the discretisation of the point.
    pub state: &'a [f64],
    /// All parameters.
    pub parameters: &'a [f64],
    /// All preceding monitors.
    pub monitors: &'a [f64],
    /// The eigenvalues or multipliers as (real part, imaginary part); empty if they were not
    /// computed.
    pub eigenvalues: &'a [(f64, f64)],
}

/// A test function given by a user-defined function of points.
pub(super) struct OfPoint<F>(pub F);

impl<F: Fn(&TestPoint) -> f64 + Send + Sync> TestFunction for OfPoint<F> {
    fn value(&self, at: &mut At, known: &PointValues) -> Result<Option<f64>, Failure> {
        let (state, parameters) = at.x.split_at(at.system.names().dimension());
        let eigenvalues = known.spectrum.unwrap_or_default();
        let point = TestPoint { state, parameters, monitors: known.monitors, eigenvalues };
        Ok(Some((self.0)(&point)).filter(|value| !value.is_nan()))
    }
}

/// A user-defined function of the points of a curve.
pub(crate) type PointFunction = Arc<dyn Fn(&TestPoint) -> f64 + Send + Sync>;

/// A user-defined function `f(z, p)`, written for dual numbers, from which its gradient is
/// computed.
pub(crate) type DualFunction = Arc<dyn Fn(&[Chunk], &[Chunk]) -> Chunk + Send + Sync>;

/// A user-defined monitor of a curve.
#[derive(Clone)]
pub(crate) struct Attached {
    pub name: String,
    pub function: PointFunction,
    /// The function written for dual numbers, if it was given.
    pub dual: Option<DualFunction>,
}

impl Attached {
    /// Creates a monitor from a function written for dual numbers.
    pub fn dual(name: String, dual: DualFunction) -> Self {
        let plain = dual.clone();
        let constant = |x: &f64| Chunk::of(*x);
        let function: PointFunction = Arc::new(move |at: &TestPoint| {
            let [z, p] = [at.state, at.parameters].map(|x| x.iter().map(constant).collect());
            let (z, p): (Vec<Chunk>, Vec<Chunk>) = (z, p);
            plain(&z, &p).re
        });
        Attached { name, function, dual: Some(dual) }
    }
}

/// The defining system `f(z, p) = level`. The gradient of `f` is computed with forward-mode dual
/// numbers; one evaluation gives the derivatives with respect to [`CHUNK`] components of `(z, p)`.
pub(crate) struct Equation {
    function: DualFunction,
    level: f64,
    kind: Kind,
    x: Vec<Chunk>,
    /// The indices of the components of `x` with respect to which gradients are computed.
    components: Vec<usize>,
}

impl Equation {
    pub fn new(function: DualFunction, level: f64, kind: Kind) -> Self {
        Equation { function, level, kind, x: Vec::new(), components: Vec::new() }
    }
}

impl DefiningSystem for Equation {
    fn kind(&self) -> Kind {
        self.kind
    }

    fn values(&mut self, at: At, _y: &[f64], values: &mut [f64]) -> Result<(), Failure> {
        self.x.clear();
        self.x.extend(at.x.iter().map(|x| Chunk::of(*x)));
        let (z, p) = self.x.split_at(at.system.names().dimension());
        values[0] = (self.function)(z, p).re - self.level;
        if !values[0].is_finite() {
            let remedy = "bound the branch so that it stays in the domain of the event's function";
            return Err(Failure::not_finite("a function of the event's", values[0], remedy));
        }
        Ok(())
    }

    fn gradients(&mut self, at: At, rows: &mut [f64], _own: &mut [f64]) -> Result<(), Failure> {
        let n = at.system.names().dimension();
        rows.fill(0.0);
        let Equation { function, x, components, .. } = self;
        components.clear();
        components.extend((0..n).chain(at.released.iter().map(|&p| n + p)));
        for directions in components.chunks(CHUNK) {
            directions.iter().enumerate().for_each(|(j, &k)| x[k].eps[j] = 1.0);
            let slopes = function(&x[..n], &x[n..]).eps;
            for (&k, slope) in directions.iter().zip(slopes) {
                rows[k] = slope;
                x[k].eps = [0.0; CHUNK];
            }
        }
        Ok(())
    }
}

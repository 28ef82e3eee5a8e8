//! User-defined functions of points, on numbers or on dual numbers.

use crate::core::bifurcation::{At, DefiningSystem, PointValues, TestFunction};
use crate::core::failure::Failure;
use crate::core::scalar::{CHUNK, Chunk};
use crate::core::system::Kind;
use std::sync::Arc;

/// Arguments of a user-defined test function or monitor.
#[derive(Clone, Copy, Debug)]
#[non_exhaustive]
pub struct TestPoint<'a> {
    /// The unknowns, on the discretisation of the point.
    pub state: &'a [f64],
    /// All parameters.
    pub parameters: &'a [f64],
    /// All preceding monitors.
    pub monitors: &'a [f64],
    /// The eigenvalues or multipliers as (real part, imaginary part); empty if not computed.
    pub eigenvalues: &'a [(f64, f64)],
}

/// A user-defined function of points as a test function.
pub(super) struct OfPoint<F>(pub F);

impl<F: Fn(&TestPoint) -> f64 + Send + Sync> TestFunction for OfPoint<F> {
    fn value(&self, at: &mut At, known: &PointValues) -> Result<Option<f64>, Failure> {
        let (state, parameters) = at.x.split_at(at.system.names().dimension());
        let eigenvalues = known.spectrum.unwrap_or_default();
        let point = TestPoint { state, parameters, monitors: known.monitors, eigenvalues };
        Ok(Some((self.0)(&point)).filter(|value| !value.is_nan()))
    }
}

/// A function of points.
pub(crate) type PointFunction = Arc<dyn Fn(&TestPoint) -> f64 + Send + Sync>;

/// A function `f(z, p)` on dual numbers, which has a gradient.
pub(crate) type DualFunction = Arc<dyn Fn(&[Chunk], &[Chunk]) -> Chunk + Send + Sync>;

/// A user-defined monitor of a curve.
#[derive(Clone)]
pub(crate) struct Attached {
    pub name: String,
    pub function: PointFunction,
    /// The function on dual numbers, if given.
    pub dual: Option<DualFunction>,
}

impl Attached {
    /// Creates a monitor from a function on dual numbers.
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

/// The defining system `f(z, p) = level`, with the gradient by forward-mode dual numbers, [`CHUNK`]
/// components of `(z, p)` in one evaluation.
pub(crate) struct Equation {
    function: DualFunction,
    level: f64,
    kind: Kind,
    x: Vec<Chunk>,
    /// The positions in `x` of the components by which gradients are taken.
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

//! A system whose evaluations are counted.

use std::sync::{Arc, Mutex};
use tangency::core::failure::Failure;
use tangency::core::linalg::{Border, Factorisation, Factors, Form, Spectrum, SpectrumRequest};
use tangency::core::problem::{Dynamics, Names, Profile};
use tangency::core::scalar::Space;
use tangency::core::system::{Deviation, Discretised, Functional, Refinement, System};

/// How often a system was evaluated.
#[derive(Clone, Copy, Debug, Default)]
pub struct Counts {
    pub residuals: usize,
    pub assemblies: usize,
    pub factorisations: usize,
    pub solves: usize,
    pub derivatives: usize,
    pub spectra: usize,
}

/// A system whose evaluations are counted.
pub struct Counted {
    inner: Box<dyn System>,
    counts: Arc<Mutex<Counts>>,
}

impl Counted {
    /// The system, and where its evaluations are counted.
    pub fn new(inner: Box<dyn System>) -> (Self, Arc<Mutex<Counts>>) {
        let counts = Arc::new(Mutex::default());
        (Counted { inner, counts: Arc::clone(&counts) }, counts)
    }

    fn count(&mut self, of: fn(&mut Counts) -> &mut usize) -> &mut dyn System {
        *of(&mut self.counts.lock().unwrap()) += 1;
        &mut *self.inner
    }
}

/// Factors whose solutions are counted.
struct Solved {
    factors: Factors,
    counts: Arc<Mutex<Counts>>,
}

impl Factorisation for Solved {
    fn solve(&mut self, right: &mut [f64]) {
        self.counts.lock().unwrap().solves += 1;
        self.factors.solve(right);
    }
    fn solve_transposed(&mut self, right: &mut [f64]) {
        self.counts.lock().unwrap().solves += 1;
        self.factors.solve_transposed(right);
    }
    fn determinant_sign(&self) -> f64 {
        self.factors.determinant_sign()
    }
    fn growth_derivative(&self, v: &[f64], out: &mut [f64]) {
        self.factors.growth_derivative(v, out);
    }
    fn growth_derivative_transposed(&self, w: &[f64], out: &mut [f64]) {
        self.factors.growth_derivative_transposed(w, out);
    }
}

impl System for Counted {
    fn names(&self) -> &Names {
        self.inner.names()
    }
    fn residual(&mut self, x: &[f64], r: &mut [f64]) -> Result<(), Failure> {
        self.count(|counts| &mut counts.residuals).residual(x, r)
    }
    fn assemble(&mut self, x: &[f64]) -> Result<(), Failure> {
        self.count(|counts| &mut counts.assemblies).assemble(x)
    }
    fn factor(&mut self, form: Form, border: Border, into: &mut Factors) -> Result<(), Failure> {
        let counts = Arc::clone(&self.counts);
        let own = into.reuse(|_: &Solved| true, || Solved { factors: Factors::default(), counts });
        self.count(|counts| &mut counts.factorisations).factor(form, border, &mut own.factors)
    }
    fn derivative(
        &mut self,
        x: &[f64],
        directions: &[&[f64]],
        out: &mut [f64],
    ) -> Result<(), Failure> {
        self.count(|counts| &mut counts.derivatives).derivative(x, directions, out)
    }
    fn gradient(
        &mut self,
        x: &[f64],
        of: Functional,
        released: &[usize],
        out: &mut [f64],
    ) -> Result<(), Failure> {
        self.count(|counts| &mut counts.derivatives).gradient(x, of, released, out)
    }
    fn dynamics(&self) -> Dynamics {
        self.inner.dynamics()
    }
    fn spectrum(
        &mut self,
        x: &[f64],
        request: SpectrumRequest,
    ) -> Result<Option<Spectrum>, Failure> {
        self.count(|counts| &mut counts.spectra).spectrum(x, request)
    }
    fn expand(
        &mut self,
        x: &[f64],
        space: &'static Space,
        terms: &[Vec<f64>],
    ) -> Result<Vec<Vec<f64>>, Failure> {
        self.count(|counts| &mut counts.derivatives).expand(x, space, terms)
    }
    fn deviation(&mut self, x: &[f64], d: &[f64]) -> Result<Deviation, Failure> {
        self.inner.deviation(x, d)
    }
    fn monitors(&mut self, x: &[f64], first: usize, values: &mut [f64]) -> Result<(), Failure> {
        self.inner.monitors(x, first, values)
    }
    fn profiles(&mut self, x: &[f64]) -> Vec<Profile> {
        self.inner.profiles(x)
    }
    fn discretised(&mut self) -> Option<&mut dyn Discretised> {
        let exact = self.inner.discretised().is_none();
        if exact { None } else { Some(self) }
    }
}

/// Evaluations of finer plates count as well.
impl Discretised for Counted {
    fn refined(&mut self, x: &[f64]) -> Option<Refinement> {
        let Refinement { system, x } = self.inner.discretised()?.refined(x)?;
        let counts = Arc::clone(&self.counts);
        Some(Refinement { system: Box::new(Counted { inner: system, counts }), x })
    }
}

//! A trace costs a few residuals, Jacobians, factorisations and spectra for each point, however
//! many unknowns there are.

use crate::plates::models::{plate, system, through_pull_in};
use std::sync::{Arc, Mutex};
use tangency::core::continuation::Settings;
use tangency::core::failure::Failure;
use tangency::core::linalg::{Border, Factorisation, Factors, Form, Spectrum};
use tangency::core::problem::{Dynamics, Names, Profile};
use tangency::core::system::{Discretised, Functional, Kind, Refinement, System};
use tangency::problems::plate::{InPlane, Orders};

/// How often a system was evaluated.
#[derive(Clone, Copy, Debug, Default)]
struct Counts {
    residuals: usize,
    assemblies: usize,
    factorisations: usize,
    solves: usize,
    derivatives: usize,
    spectra: usize,
}

/// A system whose evaluations are counted.
struct Counted {
    inner: Box<dyn System>,
    counts: Arc<Mutex<Counts>>,
}

impl Counted {
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
    fn spectrum(&mut self, x: &[f64]) -> Result<Option<Spectrum>, Failure> {
        self.count(|counts| &mut counts.spectra).spectrum(x)
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

/// The points of a trace of the clamped plate, and how often its system was evaluated.
fn trace(orders: Option<Orders>, settings: &Settings) -> (usize, Counts) {
    let mut settings_of_plate = plate("CCCC", InPlane::Immovable);
    settings_of_plate.orders = orders;
    let counts = Arc::new(Mutex::default());
    let inner = system(&settings_of_plate, 1.0);
    let mut counted = Counted { inner, counts: Arc::clone(&counts) };
    let curve = through_pull_in(&mut counted, &[]).settings(settings.clone());
    let branch = curve.mark("frequency_ratio", 0.1).trace().unwrap();
    assert_eq!(branch.of_kind(Kind::LP).count(), 1);
    let counts = *counts.lock().unwrap();
    (branch.points.len(), counts)
}

/// Special points, and finer plates for their errors, are included.
#[test]
fn a_point_costs_few_evaluations_however_many_unknowns_there_are() {
    let unrefined = Settings { refinement: 0.0, ..Settings::default() };
    for (orders, settings) in [
        (None, Settings::default()),
        (None, unrefined.clone()),
        (Some(4), unrefined.clone()),
        (Some(8), unrefined.clone()),
        (Some(12), unrefined),
    ] {
        let orders =
            orders.map(|count| Orders { transverse: [count; 2], in_plane: [count + 2; 2] });
        let (points, counts) = trace(orders, &settings);
        let Counts { residuals, assemblies, factorisations, solves, derivatives, spectra } = counts;
        let most = |count: usize, of_a_point: usize| count <= of_a_point * points;
        let iterations = most(residuals, 6) && most(assemblies, 8) && most(factorisations, 5);
        let others = most(solves, 10) && most(derivatives, 4) && most(spectra, 2);
        println!("{points} points: {counts:?}");
        assert!(iterations && others, "{points} points: {counts:?}");
    }
}

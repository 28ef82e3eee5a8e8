//! Boundary-value problems that are given as text.

use super::assembling::Assembling;
use super::basis::{Basis, monitors_of, plain, sizes_of, states_of, values_of};
use super::duration::Duration;
use super::source::{Fault, ModelError, Source};
use super::statement::Boundary;
use super::tape::Tape;
use crate::core::bvp::{BoundaryProblem, Ends, Monitor, Watched};
use crate::core::problem::{Measure, Observable};
use crate::core::scalar::Scalar;

/// A boundary-value problem that is given as text: on one segment.
#[derive(Clone, Debug)]
pub struct Conditions {
    pub(super) basis: Basis,
    states: Vec<String>,
    unknowns: Vec<String>,
    rates: Tape,
    /// In the states at the beginning, then those at the end.
    conditions: Tape,
    integrands: Tape,
    integrals: usize,
    length: Option<Duration>,
    monitors: Vec<(String, Tape)>,
    scales: Vec<f64>,
}

impl Conditions {
    /// Understands a statement, for a scene that gives some parameters.
    pub(super) fn new(
        source: &Source,
        statement: Boundary,
        given: &[String],
    ) -> Result<Self, ModelError> {
        let common = statement.common();
        let mut basis = Basis::of(source, common, given)?;
        let (states, rates) = states_of(&basis, common, &statement.states, "state")?;
        let unknowns = statement.unknowns.iter().map(|name| plain(source, name));
        let unknowns = unknowns.collect::<Result<Vec<_>, _>>()?;
        let mut scope = basis.scope(common, &states)?;
        for (k, (name, phrase)) in unknowns.iter().zip(&statement.unknowns).enumerate() {
            scope.declare_unknown(phrase, name, basis.parameters.len() + k)?;
        }
        basis.begin_along(common, &scope)?;
        let mut assembling = Assembling::new(&scope);
        assembling.check_named()?;
        let values = values_of(&mut assembling, &rates)?;
        let rates = assembling.tape(&values);
        let values = statement.integrals.iter().map(|formula| assembling.read(formula));
        let values = values.collect::<Result<Vec<_>, _>>()?;
        let integrands = assembling.tape(&values);
        let mut ends = Assembling::at_ends(&scope);
        let values = statement.conditions.iter().map(|formula| ends.read(formula));
        let values = values.collect::<Result<Vec<_>, _>>()?;
        let conditions = ends.tape(&values);
        check_count(source, &statement, values.len() + statement.integrals.len(), states.len())?;
        let length =
            statement.length.as_ref().map(|length| Duration::read(&scope, "the length", length));
        let length = length.transpose()?;
        let monitors = monitors_of(&scope, &statement.monitors)?;
        basis.look_for_unused(&[&scope]);
        let states: Vec<String> = states.into_iter().map(|(_, name)| name).collect();
        let scales = sizes_of(source, &statement.scales, &states)?;
        let integrals = statement.integrals.len();
        Ok(Conditions {
            basis,
            states,
            unknowns,
            rates,
            conditions,
            integrands,
            integrals,
            length,
            monitors,
            scales,
        })
    }
}

impl Conditions {
    /// Where branches begin at a time in units of the length, for values of the parameters; further
    /// unknowns are taken as 0.
    pub(super) fn initial_along(&self, tau: f64, p: &[f64]) -> Vec<(String, f64)> {
        let q = [p, &vec![0.0; self.unknowns.len()]].concat();
        let length = self.length.as_ref().map_or(1.0, |length| length.value(&q));
        self.basis.initial_at(tau * length, p)
    }

    /// The error of a length that is not positive for some parameters; nothing is known of one that
    /// depends on unknowns.
    pub(super) fn refused_duration(&self, p: &[f64]) -> Option<ModelError> {
        self.length.as_ref()?.refused(&self.basis.source, p)
    }
}

/// Refuses more or fewer conditions than there are states and unknowns.
fn check_count(
    source: &Source,
    statement: &Boundary,
    given: usize,
    states: usize,
) -> Result<(), ModelError> {
    let unknowns = statement.unknowns.len();
    if given == states + unknowns {
        return Ok(());
    }
    let what = format!("{given} conditions and integrals");
    let needed = format!(
        "there must be {}, as many as states ({states}) and unknowns ({unknowns})",
        states + unknowns
    );
    let phrase = statement.conditions.first().cloned().unwrap_or_default();
    Err(source.fault_of(&phrase, Fault::Missing { what, needed }))
}

/// Values at both ends of so many states need no allocation.
const FEW: usize = 16;

impl BoundaryProblem for Conditions {
    fn segments(&self) -> Vec<Vec<String>> {
        vec![self.states.clone()]
    }

    fn parameters(&self) -> Vec<String> {
        self.basis.parameters.clone()
    }

    fn defaults(&self) -> Vec<f64> {
        self.basis.defaults.clone()
    }

    fn extras(&self) -> Vec<String> {
        self.unknowns.clone()
    }

    fn field<T: Scalar>(&self, _segment: usize, t: T, x: &[T], q: &[T], f: &mut [T]) {
        self.rates.evaluate(t, x, q, f);
    }

    fn duration<T: Scalar>(&self, _segment: usize, q: &[T]) -> T {
        self.length.as_ref().map_or(T::one(), |length| length.value(q))
    }

    fn boundary<T: Scalar>(&self, ends: Ends<T>, q: &[T], b: &mut [T]) {
        let n = ends.start.len();
        let mut few = [T::zero(); FEW];
        match few.get_mut(..2 * n) {
            Some(x) => {
                x[..n].copy_from_slice(ends.start);
                x[n..].copy_from_slice(ends.end);
                self.conditions.evaluate(T::zero(), x, q, b);
            }
            None => self.conditions.evaluate(T::zero(), &[ends.start, ends.end].concat(), q, b),
        }
    }

    fn integrals(&self) -> usize {
        self.integrals
    }

    fn integrand<T: Scalar>(&self, _segment: usize, t: T, x: &[T], q: &[T], g: &mut [T]) {
        self.integrands.evaluate(t, x, q, g);
    }

    fn watch<T: Scalar>(&self, function: usize, _segment: usize, t: T, x: &[T], q: &[T]) -> T {
        self.monitors[function].1.value(t, x, q)
    }

    /// Extremes of all states, and of every monitor its mean and its extremes.
    fn monitors(&self) -> Vec<(String, Monitor)> {
        let monitors = self.monitors.iter().map(|(name, _)| name);
        let observable = |name: &String| {
            let state = self.states.iter().position(|state| state == name);
            let monitor = || monitors.clone().position(|monitor| monitor == name);
            state.map(Observable::State).or_else(|| monitor().map(Observable::Function))
        };
        let watched =
            |name: &String| observable(name).map(|o| Watched::new(0, o)).into_iter().collect();
        let all = Measure::by_default(self.states.clone(), monitors.clone().cloned().collect());
        all.into_iter().map(|(name, measure)| (name, measure.map(watched))).collect()
    }

    fn scales(&self, _segment: usize, _q: &[f64]) -> Vec<f64> {
        self.scales.clone()
    }
}

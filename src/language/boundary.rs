//! Boundary-value problems given as text.

use super::assembling::Assembling;
use super::basis::{Basis, Kind, names_of, states_of, values_of};
use super::duration::Duration;
use super::scope::Meaning;
use super::source::{Fault, ModelError, Phrase, Source};
use super::statement::{Boundary, Common};
use super::syntax::Declared;
use super::tape::Tape;
use crate::core::bvp::{BoundaryProblem, Ends, Monitor, Watched};
use crate::core::problem::Observable;
use crate::core::scalar::Scalar;

/// A boundary-value problem given as text; its interval is a single segment.
#[derive(Clone, Debug)]
pub struct Conditions {
    basis: Basis,
    unknowns: Vec<String>,
    rates: Tape,
    /// The boundary conditions, as functions of the states at the beginning followed by the states
    /// at the end.
    conditions: Tape,
    integrands: Tape,
    integrals: usize,
}

/// Assembles the statement of a boundary-value problem, for a scene that gives values to some
/// parameters.
pub(super) fn understood(
    source: &Source,
    statement: &Boundary,
    given: &[String],
) -> Result<Conditions, ModelError> {
    let common = statement.common();
    let mut basis = Basis::of(source, common, given)?;
    let states = states_of(&basis, common, &statement.states, "state")?;
    let unknowns = statement.unknowns.iter().map(|name| Declared::plain(source, name));
    let unknowns = unknowns.collect::<Result<Vec<_>, _>>()?;
    let mut scope = basis.scope(common, &states)?;
    // Additional unknown numbers follow the parameters.
    for (k, (name, phrase)) in unknowns.iter().zip(&statement.unknowns).enumerate() {
        scope.declare(phrase, name, Meaning::Parameter(basis.parameters.len() + k))?;
    }
    basis.begin_along(common, &scope)?;
    basis.states = names_of(&states);
    let mut assembling = Assembling::new(&scope);
    assembling.check_named()?;
    let rates = values_of(&mut assembling, &states)?;
    let rates = assembling.tape(&rates);
    let tape = |assembling: &mut Assembling, formulas: &[Phrase]| {
        let values = formulas.iter().map(|formula| assembling.read(formula));
        let values = values.collect::<Result<Vec<_>, _>>()?;
        Ok(assembling.tape(&values))
    };
    let integrands = tape(&mut assembling, &statement.integrals)?;
    let conditions = tape(&mut Assembling::at_ends(&scope), &statement.conditions)?;
    check_count(source, statement, basis.states.len())?;
    let length = Duration::read(&scope, "the length", statement.length.as_ref())?;
    basis.finish(common, &[&scope], length, false)?;
    // Time is the position on the interval.
    basis.aperiodic = false;
    name_position(&mut basis, common);
    let integrals = statement.integrals.len();
    Ok(Conditions { basis, unknowns, rates, conditions, integrands, integrals })
}

/// Labels the axis that shows the position on the interval, unless the statement gives a label: the
/// label is `t`, the name of the position in the equations, because the position need not be a
/// time.
fn name_position(basis: &mut Basis, common: Common) {
    let monitors = basis.monitor_names();
    let mut others = basis.states.iter().chain(&basis.parameters).chain(&monitors);
    let labelled = common.labels.iter().any(|(name, _)| name.text == "t");
    if labelled || others.any(|name| name == "time") {
        return;
    }
    match basis.labels.iter_mut().find(|(column, _)| column == "time") {
        // Only the unit is stated.
        Some((_, label)) => *label = label.replacen("time", "t", 1),
        None => basis.labels.push(("time".into(), "t".into())),
    }
}

impl Kind for Conditions {
    fn basis(&self) -> &Basis {
        &self.basis
    }

    fn may_jump(&self) -> bool {
        self.rates.may_jump()
    }

    /// Returns the values of the initial profiles, which are evaluated with the additional unknowns
    /// set to 0.
    fn initial_along(&self, tau: f64, p: &[f64]) -> Vec<(String, f64)> {
        let q = [p, &vec![0.0; self.unknowns.len()]].concat();
        self.basis.initial_at(tau * self.basis.duration.value(&q), p)
    }
}

/// Returns an error unless the number of boundary conditions and integral conditions equals the
/// number of states plus the number of additional unknowns.
fn check_count(source: &Source, statement: &Boundary, states: usize) -> Result<(), ModelError> {
    let given = statement.conditions.len() + statement.integrals.len();
    let unknowns = statement.unknowns.len();
    if given == states + unknowns {
        return Ok(());
    }
    let what = format!("the problem has {given} `conditions` and `integrals` in total");
    let needed = format!(
        "give {} `conditions` and `integrals` in total: one for each state ({states}), and one for \
         each entry of `unknowns` ({unknowns})",
        states + unknowns
    );
    let phrase = statement.conditions.first().cloned().unwrap_or_default();
    Err(source.fault_of(&phrase, Fault::Missing { what, needed }))
}

/// The maximum number of boundary values (of all states at both ends) that are stored without an
/// allocation.
const FEW: usize = 16;

impl BoundaryProblem for Conditions {
    fn segments(&self) -> Vec<Vec<String>> {
        vec![self.basis.states.clone()]
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
        self.basis.duration.value(q)
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
        self.basis.monitor(function, 0, t, x, q)
    }

    /// Returns the monitors of a solution: the extremes of all states, the norms of long arrays,
    /// and the mean and extremes of every model monitor.
    fn monitors(&self) -> Vec<(String, Monitor)> {
        let Basis { states, .. } = &self.basis;
        let monitors = self.basis.monitor_names();
        let observable = |name: &String| {
            let state = states.iter().position(|state| state == name);
            let monitor = || monitors.iter().position(|monitor| monitor == name);
            state.map(Observable::State).or_else(|| monitor().map(Observable::Function))
        };
        let watched =
            |name: &String| observable(name).map(|o| Watched::new(0, o)).into_iter().collect();
        let all = self.basis.measures.iter();
        all.map(|(name, measure)| (name.clone(), measure.map(watched))).collect()
    }

    fn scales(&self, _segment: usize, _q: &[f64]) -> Vec<f64> {
        self.basis.sizes.clone()
    }
}

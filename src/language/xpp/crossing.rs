//! Decides, from the formulas, whether the motion continues across the surface of a `global`
//! condition when the event of this condition occurs.

use super::super::affine::Affine;
use super::super::assembling::Assembling;
use super::super::assembly::Value;
use super::super::basis::{Basis, names_of, states_of, values_of};
use super::super::source::{ModelError, Source};
use super::super::statement::HybridEquations;
use std::collections::BTreeMap;

/// The relative size below which a constant counts as zero.
const ROUNDING: f64 = 1e-12;

/// The `global` conditions of a file, for a system with a single mode that is valid on both sides
/// of the surface of each condition.
pub(super) struct Crossings {
    conditions: Vec<Condition>,
    /// The rate of each state if it is affine, and the states on which the rate depends.
    rates: Vec<(Option<Affine>, Vec<bool>)>,
    /// The states and the time, as affine values.
    inputs: BTreeMap<Value, Affine>,
}

/// A `global` condition: the function that is positive before its event, and the resets of the
/// event; `None` replaces a formula that is not affine.
struct Condition {
    guard: Option<Affine>,
    resets: BTreeMap<usize, Option<Affine>>,
}

impl Crossings {
    /// Collects the `global` conditions of a statement that has one mode.
    pub fn of(source: &Source, statement: &HybridEquations) -> Result<Self, ModelError> {
        let common = statement.common();
        let basis = Basis::of(source, common, &[])?;
        let states = statement.modes.first().map(|mode| mode.states.clone()).unwrap_or_default();
        let rates = states_of(&basis, common, &states, "state")?;
        let (scope, states) = (basis.scope(common, &rates)?, names_of(&rates));
        let mut assembling = Assembling::new(&scope);
        let affine = |assembling: &Assembling, value| {
            assembling.assembly().affine(&[value], &basis.defaults).remove(0)
        };
        let state = |k: usize| Value::State(k as u32);
        let rates = values_of(&mut assembling, &rates)?.into_iter().map(|rate| {
            let depends = |k| assembling.depends(&[rate], |input| input == state(k));
            (affine(&assembling, rate), (0..states.len()).map(depends).collect())
        });
        let rates = rates.collect();
        let mut conditions = Vec::new();
        for guard in &statement.guards {
            let mut resets = BTreeMap::new();
            for (name, formula) in &guard.reset {
                let value = assembling.read(formula)?;
                let k = states.iter().position(|state| *state == name.text);
                resets.extend(k.map(|k| (k, affine(&assembling, value))));
            }
            let function = guard.function.as_ref().map(|function| assembling.read(function));
            let guard = function.transpose()?.and_then(|guard| affine(&assembling, guard));
            conditions.push(Condition { guard, resets });
        }
        let inputs = (0..states.len()).map(state).chain([Value::Time]);
        let inputs = inputs.map(|input| (input, Affine::input(input))).collect();
        Ok(Crossings { conditions, rates, inputs })
    }

    /// Returns whether the motion may continue across the surface of a condition after the event of
    /// this condition; `None` if the relevant parts of the formulas are not affine.
    pub fn goes_on(&self, k: usize) -> Option<bool> {
        let Condition { guard, resets } = &self.conditions[k];
        let guard = guard.as_ref()?;
        let reset = |input: Value| match input {
            Value::State(k) if resets.contains_key(&(k as usize)) => resets[&(k as usize)].as_ref(),
            input => self.inputs.get(&input),
        };
        // The guard is zero at the event.
        let (_, after) = guard.after(reset)?.without(guard);
        if !after.is_constant() || after.constant.abs() > ROUNDING * guard.constant.abs() {
            return Some(!after.is_constant() || after.constant < 0.0);
        }
        // The guard is also zero after the event, so its rate decides.
        let rate = |input: &Value| match input {
            Value::State(k) => Some(&self.rates[*k as usize]),
            _ => None,
        };
        let changes = |(_, depends): &(_, Vec<bool>)| resets.keys().any(|k| depends[*k]);
        if !guard.slopes.keys().filter_map(rate).any(changes) {
            return Some(true);
        }
        let mut speed = Affine::number(guard.slopes.get(&Value::Time).copied().unwrap_or(0.0));
        for (input, slope) in &guard.slopes {
            if let Some((rate, _)) = rate(input) {
                speed = speed.plus(*slope, rate.as_ref()?);
            }
        }
        let (_, after) = speed.after(reset)?.without(guard);
        let (_, speed) = speed.without(guard);
        let (factor, rest) = after.without(&speed);
        let falls = !speed.is_constant() || speed.constant < 0.0;
        Some(falls && (!rest.is_constant() || factor > 0.0 || rest.constant < 0.0))
    }
}

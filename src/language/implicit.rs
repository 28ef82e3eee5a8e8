//! Equations of a flow with a left-hand side: algebraic equations `0 = g(x, y)`, and left-hand sides
//! that are linear in the rates, such as `2*x' + m*y' = f(x, y)`.
//!
//! The left-hand sides are assembled in a scope in which the rates are further states: `x'` is the
//! rate of `x`, and `u'[3]` the rate of `u[3]`.

use super::assembling::Assembling;
use super::assembly::{Assembly, Value};
use super::basis::Stated;
use super::operation::Operation;
use super::scope::{Meaning, Scope};
use super::source::{Fault, ModelError, Phrase, Source};
use super::statement::Formulas;
use super::syntax::Formula;
use super::tape::Tape;

/// The help for left-hand sides that are not allowed.
const REMEDY: &str = "write each equation as `0 = g(x, y)` or, for example, `2*x' + m*y' = f(x, y)`: \
                      every term on the left contains one rate, whose factor may depend on states and \
                      parameters, or no term contains a rate";

/// The equations of a flow, with the left-hand sides that are stated.
pub(super) struct Sides {
    /// The unknowns with the right-hand sides of their equations.
    pub right: Formulas,
    /// The left-hand sides; `None` for an equation whose left-hand side is the rate of its unknown.
    left: Vec<Option<Phrase>>,
}

/// The left-hand sides of the equations of a flow.
pub(super) struct Left {
    /// The products of the mass matrix with the rates, as functions of the states and their rates.
    pub mass: Tape,
    /// The left-hand sides without rates, each with the index of its equation.
    pub at_rest: Vec<(usize, Formula, super::elements::Indices)>,
}

/// Returns the position of the sign `=` that separates the two sides of an equation.
fn separator(text: &str) -> Option<usize> {
    let is_sign = |at: usize| {
        let around = [text[..at].chars().next_back(), text[at + 1..].chars().next()];
        !around[0].is_some_and(|c| "<>=!".contains(c)) && around[1] != Some('=')
    };
    text.match_indices('=').map(|(at, _)| at).find(|at| is_sign(*at))
}

impl Sides {
    /// Separates the two sides of every equation.
    pub fn of(source: &Source, equations: &Formulas) -> Self {
        let (mut right, mut left) = (Vec::new(), Vec::new());
        for (unknown, equation) in equations {
            let text = &equation.text;
            let at = separator(text);
            left.push(at.map(|at| equation.part(source, 0..at)));
            let first = at.map_or(0, |at| at + 1);
            let first = first + text[first..].len() - text[first..].trim_start().len();
            right.push((unknown.clone(), equation.part(source, first..text.len())));
        }
        Sides { right, left }
    }

    /// Returns the first left-hand side that is stated.
    pub fn first(&self) -> Option<&Phrase> {
        self.left.iter().flatten().next()
    }

    /// Assembles the left-hand sides; `None` if every equation determines the rate of its unknown.
    ///
    /// # Errors
    /// [`ModelError`] if a left-hand side is not linear in the rates.
    pub fn assemble(&self, scope: &Scope, rows: &[Stated]) -> Result<Option<Left>, ModelError> {
        let (n, moving) = (scope.dimension, with_rates(scope)?);
        let mut assembling = Assembling::new(&moving);
        let (mut values, mut at_rest) = (Vec::new(), Vec::new());
        for (Stated { elements, .. }, left) in rows.iter().zip(&self.left) {
            let left = left.as_ref().map(|left| Formula::read(&scope.source, left)).transpose()?;
            for at in elements.values() {
                let equation = values.len();
                let Some(formula) = &left else {
                    values.push(Value::State((n + equation) as u32));
                    continue;
                };
                let value = assembling.indexed(formula, &at)?;
                let rate_free = Value::number(0.0);
                values.push(match degree(assembling.assembly(), value, n) {
                    Some(1) => value,
                    Some(_) => {
                        if value != rate_free {
                            at_rest.push((equation, formula.clone(), at));
                        }
                        rate_free
                    }
                    None => return Err(nonlinear(&scope.source, formula)),
                });
            }
        }
        scope.used.borrow_mut().extend(moving.used.take());
        let explicit = |(k, value): (usize, &Value)| *value == Value::State((n + k) as u32);
        if values.iter().enumerate().all(explicit) {
            return Ok(None);
        }
        let mass = assembling.tape(&values);
        Ok(Some(Left { mass, at_rest }))
    }
}

impl Left {
    /// Subtracts the left-hand sides without rates from the right-hand sides.
    pub fn subtract(
        &self,
        assembling: &mut Assembling,
        right: &mut [Value],
    ) -> Result<(), ModelError> {
        for (equation, formula, at) in &self.at_rest {
            let left = assembling.indexed(formula, at)?;
            right[*equation] = assembling.difference(formula, [right[*equation], left]);
        }
        Ok(())
    }
}

/// Returns the name of the rate of a state.
fn rate_of(state: &str) -> String {
    let (name, indices) = state.split_at(state.find('[').unwrap_or(state.len()));
    format!("{name}'{indices}")
}

/// Returns a scope in which the rates of all states are further states.
fn with_rates(scope: &Scope) -> Result<Scope, ModelError> {
    let (mut moving, n) = (scope.clone(), scope.dimension);
    let rates: Vec<String> = scope.states().map(|state| rate_of(state)).collect();
    for (k, rate) in rates.iter().enumerate() {
        moving.declare(&rate.as_str().into(), rate, Meaning::State(n + k))?;
    }
    Ok(moving)
}

/// Returns 0 if a value does not depend on rates, 1 if it is a linear combination of rates, and
/// `None` otherwise; states from number `n` on are rates.
fn degree(assembly: &Assembly, value: Value, n: usize) -> Option<u8> {
    let mut known: Vec<Option<u8>> = Vec::new();
    let of = |known: &[Option<u8>], value: Value| match value {
        Value::State(k) => Some(u8::from(k as usize >= n)),
        Value::Result(k) => known[k as usize],
        _ => Some(0),
    };
    let needed = assembly.needed(&[value]);
    for ((operation, arguments), needed) in assembly.applied.iter().zip(needed) {
        if !needed {
            known.push(None);
            continue;
        }
        let given = arguments.map(|argument| of(&known, argument));
        let zero = arguments.map(|argument| argument == Value::number(0.0));
        let equal = |i: usize, j: usize| match (zero[i], zero[j]) {
            (true, _) => given[j],
            (_, true) => given[i],
            _ => given[i].filter(|_| given[i] == given[j]),
        };
        let free = |k: usize| given[k] == Some(0);
        known.push(match operation {
            Operation::Add | Operation::Subtract => equal(0, 1),
            Operation::Negate => given[0],
            Operation::Multiply => given[0].zip(given[1]).map(|(a, b)| a + b).filter(|d| *d < 2),
            Operation::Divide => given[0].filter(|_| free(1)),
            Operation::Select => equal(1, 2).filter(|_| free(0)),
            _ => (0..operation.arity()).all(free).then_some(0),
        });
    }
    of(&known, value)
}

/// Returns the error for a left-hand side that is not linear in the rates.
fn nonlinear(source: &Source, left: &Formula) -> ModelError {
    let what = format!("the left-hand side `{}`", left.phrase.text.trim());
    let reason = "the terms of a left-hand side must all be linear in the rates".into();
    source.fault_of(&left.phrase, Fault::Misplaced { what, reason }).with_help(REMEDY)
}

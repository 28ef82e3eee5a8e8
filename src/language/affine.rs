//! Affine values of formulas: a constant plus a linear combination of the states and time.

use super::assembly::{Assembly, Value};
use super::operation::Operation;
use std::collections::BTreeMap;

/// The relative size below which a coefficient counts as zero, because it is due to rounding.
const ROUNDING: f64 = 1e-12;

/// An affine value: a constant plus multiples of the states and of time.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct Affine {
    pub constant: f64,
    pub slopes: BTreeMap<Value, f64>,
}

impl Affine {
    pub fn number(constant: f64) -> Self {
        Affine { constant, ..Affine::default() }
    }

    pub fn input(value: Value) -> Self {
        Affine { constant: 0.0, slopes: BTreeMap::from([(value, 1.0)]) }
    }

    pub fn is_constant(&self) -> bool {
        self.slopes.is_empty()
    }

    /// Adds a multiple of another affine value.
    pub fn plus(mut self, factor: f64, other: &Affine) -> Self {
        self.constant += factor * other.constant;
        for (input, slope) in &other.slopes {
            let sum = self.slopes.entry(*input).or_default();
            let [before, added] = [*sum, factor * slope];
            *sum += added;
            if sum.abs() <= ROUNDING * (before.abs() + added.abs()) {
                self.slopes.remove(input);
            }
        }
        self
    }

    fn times(&self, factor: f64) -> Self {
        Affine::default().plus(factor, self)
    }

    /// Substitutes affine values for the inputs; returns `None` if the value of an input is not
    /// affine.
    pub fn after<'a>(&self, value: impl Fn(Value) -> Option<&'a Affine>) -> Option<Self> {
        let begin = Some(Affine::number(self.constant));
        self.slopes
            .iter()
            .fold(begin, |sum, (input, slope)| Some(sum?.plus(*slope, value(*input)?)))
    }

    /// Divides an affine value by another affine value (the divisor): returns the factor, and a
    /// remainder that does not depend on the input with the largest coefficient in the divisor.
    pub fn without(self, other: &Affine) -> (f64, Self) {
        let largest = other.slopes.iter().max_by(|a, b| a.1.abs().total_cmp(&b.1.abs()));
        let Some((input, slope)) = largest else { return (0.0, self) };
        let factor = self.slopes.get(input).map_or(0.0, |own| own / slope);
        (factor, self.plus(-factor, other))
    }
}

impl Assembly {
    /// Returns the affine forms of values for given parameters; a value that is not affine yields
    /// `None`.
    pub fn affine(&self, values: &[Value], p: &[f64]) -> Vec<Option<Affine>> {
        let needed = self.needed(values);
        let mut forms: Vec<Option<Affine>> = Vec::with_capacity(self.applied.len());
        let form = |value: &Value, forms: &[Option<Affine>]| match value {
            Value::Result(k) => forms[*k as usize].clone(),
            Value::Parameter(k) => p.get(*k as usize).map(|p| Affine::number(*p)),
            input => Some(input.as_number().map_or(Affine::input(*input), Affine::number)),
        };
        for ((operation, arguments), needed) in self.applied.iter().zip(needed) {
            let given = &arguments[..if needed { operation.arity() } else { 0 }];
            let given: Option<Vec<Affine>> =
                given.iter().map(|value| form(value, &forms)).collect();
            forms.push(given.filter(|_| needed).and_then(|given| applied(*operation, &given)));
        }
        values.iter().map(|value| form(value, &forms)).collect()
    }
}

/// Applies an operation to affine values; returns `None` if the result is not affine.
fn applied(operation: Operation, given: &[Affine]) -> Option<Affine> {
    use Operation::*;
    match (operation, given) {
        (Add, [a, b]) => Some(a.clone().plus(1.0, b)),
        (Subtract, [a, b]) => Some(a.clone().plus(-1.0, b)),
        (Negate, [a]) => Some(a.times(-1.0)),
        (Multiply, [a, b]) if b.is_constant() => Some(a.times(b.constant)),
        (Multiply, [a, b]) if a.is_constant() => Some(b.times(a.constant)),
        (Divide, [a, b]) if b.is_constant() => Some(a.times(b.constant.recip())),
        (Select, [condition, a, b]) if condition.is_constant() => {
            Some(if condition.constant != 0.0 { a } else { b }.clone())
        }
        _ => {
            let mut numbers = given.iter().map(|a| a.constant).chain([0.0, 0.0]);
            let [a, b, c] = std::array::from_fn(|_| numbers.next().unwrap_or_default());
            given.iter().all(Affine::is_constant).then(|| Affine::number(operation.of(&a, &b, &c)))
        }
    }
    .filter(|form| form.constant.is_finite() && form.slopes.values().all(|slope| slope.is_finite()))
}

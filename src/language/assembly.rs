//! Construction of tapes (lists of operations) for formulas: merges common subexpressions, folds
//! constants, and shares registers.

use super::operation::Operation;
use std::collections::HashMap;
use std::hash::{BuildHasherDefault, Hasher};
use std::ops::Range;

/// A value in a formula: a number, an input, or the result of an earlier operation.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub(super) enum Value {
    /// A number, given by its bit pattern.
    Number(u64),
    Time,
    State(u32),
    Parameter(u32),
    /// The result of an earlier operation, given by the index of the operation.
    Result(u32),
}

impl Value {
    pub fn number(value: f64) -> Self {
        Value::Number(value.to_bits())
    }

    /// Returns the index of the parameter, or `None` if the value is not a parameter.
    pub fn as_parameter(self) -> Option<u32> {
        match self {
            Value::Parameter(k) => Some(k),
            _ => None,
        }
    }

    pub fn is_parameter(self) -> bool {
        self.as_parameter().is_some()
    }

    /// Returns whether the value is the parameter with the given index.
    pub fn is_at(self, parameter: usize) -> bool {
        self == Value::Parameter(parameter as u32)
    }

    pub fn as_number(self) -> Option<f64> {
        match self {
            Value::Number(bits) => Some(f64::from_bits(bits)),
            _ => None,
        }
    }
}

/// The origin of an operation in the text: the index of a phrase (a part of the text) in the list
/// of all parsed phrases, and the range of the operation in this phrase.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub(super) struct Origin {
    pub phrase: usize,
    pub part: Range<usize>,
}

/// An operation with its arguments, stored as three values; if the operation has fewer arguments,
/// the first argument is repeated.
pub(super) type Applied = (Operation, [Value; 3]);

/// Operations without duplicates.
#[derive(Clone, Debug, Default)]
pub(super) struct Assembly {
    pub applied: Vec<Applied>,
    origins: Vec<Origin>,
    known: HashMap<Key, u32, BuildHasherDefault<Mixer>>,
    /// The index of each number that occurs in the formulas; numbers are counted in the order of
    /// their first occurrence.
    numbers: HashMap<u64, u32, BuildHasherDefault<Mixer>>,
}

/// The key of an operation in the hash table: the operation and its arguments, in 32 bits each, to
/// save memory in models with millions of operations.
type Key = (u64, u64);

/// An index larger than any index in a model.
const NOWHERE: u32 = u32::MAX >> 2;

/// A fast hash. The keys of the hash table are indices, so that the author of a text cannot choose
/// colliding keys.
#[derive(Default)]
struct Mixer(u64);

impl Hasher for Mixer {
    fn write(&mut self, bytes: &[u8]) {
        bytes.iter().for_each(|byte| self.write_u64(u64::from(*byte)));
    }

    fn write_u64(&mut self, n: u64) {
        self.0 = (self.0.rotate_left(23) ^ n).wrapping_mul(0x9E37_79B9_7F4A_7C15);
    }

    fn finish(&self) -> u64 {
        self.0 ^ (self.0 >> 32)
    }
}

impl Assembly {
    /// Returns the number of operations in the assembly.
    pub fn len(&self) -> usize {
        self.applied.len()
    }

    /// Makes room for a number of further operations.
    pub fn reserve(&mut self, count: usize) {
        self.applied.reserve(count);
        self.origins.reserve(count);
        self.known.reserve(count);
    }

    /// Adds an operation on one to three values, and returns the value that denotes its result.
    pub fn apply(&mut self, operation: Operation, given: &[Value], origin: &Origin) -> Value {
        use Operation::*;
        let arguments = std::array::from_fn(|k| given.get(k).copied().unwrap_or(given[0]));
        let [a, b, c] = arguments;
        let numbers = arguments.map(Value::as_number);
        if let [Some(x), Some(y), Some(z)] = numbers {
            let value = operation.of(&x, &y, &z);
            // Values that are not finite are not folded, so that errors can show their place in the
            // text.
            if f64::is_finite(value) {
                return Value::number(value);
            }
            return self.once((operation, arguments), origin);
        }
        match (operation, numbers) {
            (Select, [Some(condition), ..]) => return if condition != 0.0 { b } else { c },
            (Add | Subtract, [_, Some(0.0), _])
            | (Multiply | Divide | Power, [_, Some(1.0), _]) => return a,
            (Add, [Some(0.0), ..]) | (Multiply, [Some(1.0), ..]) => return b,
            (Power, [_, Some(exponent), _]) => {
                let simple = [(2.0, Square), (3.0, Cube), (0.5, SquareRoot), (-1.0, Reciprocal)];
                if let Some((_, simple)) = simple.into_iter().find(|(known, _)| *known == exponent)
                {
                    return self.once((simple, [a, a, a]), origin);
                }
            }
            // The reciprocal is exact, and a product is faster than a quotient.
            (Divide, [_, Some(n), _]) if is_power_of_two(n) => {
                return self.apply(Multiply, &[a, Value::number(n.recip())], origin);
            }
            (Add | Multiply, _) if b < a => return self.once((operation, [b, a, b]), origin),
            _ => {}
        }
        self.once((operation, arguments), origin)
    }

    fn once(&mut self, applied: Applied, origin: &Origin) -> Value {
        let next = self.applied.len() as u32;
        let numbers = &mut self.numbers;
        let number = |bits: u64| {
            let count = numbers.len() as u32;
            *numbers.entry(bits).or_insert(count)
        };
        let position = *self.known.entry(key(&applied, number)).or_insert(next);
        if position == next {
            self.applied.push(applied);
            self.origins.push(origin.clone());
        }
        Value::Result(position)
    }

    /// Returns the index of an operation, or `None` if the assembly does not contain the operation.
    pub fn position(&self, applied: &Applied) -> Option<u32> {
        let number = |bits: u64| self.numbers.get(&bits).copied().unwrap_or(NOWHERE);
        self.known.get(&key(applied, number)).copied()
    }

    /// Discards the tables that are needed only while operations are added.
    pub fn complete(&mut self) {
        (self.known, self.numbers) = Default::default();
    }

    /// Returns whether at least one of the given values depends on an input for which a predicate
    /// is true.
    pub fn depends(&self, values: &[Value], sort: impl Fn(Value) -> bool) -> bool {
        let needed = self.needed(values);
        let operations = self.applied.iter().zip(needed).filter(|(_, needed)| *needed);
        let inputs = operations.flat_map(|((operation, all), _)| &all[..operation.arity()]);
        let input = |value: &Value| !matches!(value, Value::Number(_) | Value::Result(_));
        inputs.chain(values).any(|value| input(value) && sort(*value))
    }

    /// Evaluates, in real numbers, the operations on which the given results depend, and returns
    /// the first operation whose value is not finite, with its arguments.
    pub fn undefined(&self, results: &[Value], t: f64, x: &[f64], p: &[f64]) -> Option<Undefined> {
        let needed = self.needed(results);
        let mut values: Vec<f64> = Vec::with_capacity(self.applied.len());
        for (k, (operation, arguments)) in self.applied.iter().enumerate() {
            let given = arguments.map(|argument| match argument {
                Value::Number(bits) => f64::from_bits(bits),
                Value::Time => t,
                Value::State(i) => x[i as usize],
                Value::Parameter(i) => p[i as usize],
                Value::Result(i) => values[i as usize],
            });
            let [a, b, c] = &given;
            let value: f64 = operation.of(a, b, c);
            let given = &given[..operation.arity()];
            if !value.is_finite() && needed[k] && given.iter().all(|value| value.is_finite()) {
                let (operation, arguments) = (*operation, given.to_vec());
                return Some(Undefined {
                    operation,
                    arguments,
                    value,
                    origin: self.origins[k].clone(),
                });
            }
            values.push(value);
        }
        None
    }

    /// Returns, for each operation, whether the given results depend on it.
    pub fn needed(&self, results: &[Value]) -> Vec<bool> {
        let mut needed = vec![false; self.applied.len()];
        let mut mark = |value: &Value| {
            if let Value::Result(k) = value {
                needed[*k as usize] = true;
            }
        };
        results.iter().for_each(&mut mark);
        for k in (0..self.applied.len()).rev() {
            if needed[k] {
                let (operation, arguments) = &self.applied[k];
                for argument in &arguments[..operation.arity()] {
                    if let Value::Result(i) = argument {
                        needed[*i as usize] = true;
                    }
                }
            }
        }
        needed
    }
}

/// Returns the key of an operation in the hash table, by which equal operations are recognised. The
/// callback `number` returns the index of a number among all numbers of the assembly.
fn key((operation, arguments): &Applied, mut number: impl FnMut(u64) -> u32) -> Key {
    let [a, b, c] = arguments.map(|value| {
        let [sort, position] = match value {
            Value::Number(bits) => [0, number(bits)],
            Value::State(k) => [1, k],
            Value::Parameter(k) => [2, k],
            Value::Result(k) => [3, k],
            Value::Time => [2, NOWHERE],
        };
        u64::from((sort << 30) | position)
    });
    (((*operation as u64) << 32) | a, (b << 32) | c)
}

fn is_power_of_two(n: f64) -> bool {
    let inverse = n.recip();
    n.is_normal() && inverse.is_normal() && n.to_bits().trailing_zeros() >= 52
}

/// An operation whose result is not finite.
pub(super) struct Undefined {
    pub operation: Operation,
    pub arguments: Vec<f64>,
    pub value: f64,
    pub origin: Origin,
}

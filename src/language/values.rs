//! Data of values: where they are dense in tables, which take a fraction of the time of maps.

use super::assembly::Value;
use std::collections::HashMap;

/// Something for each value of some operations.
#[derive(Default)]
pub(super) struct Values<T> {
    time: T,
    states: Vec<T>,
    parameters: Vec<T>,
    results: Vec<T>,
    numbers: HashMap<u64, T>,
}

impl<T: Copy + Default> Values<T> {
    /// What a value has: the default if nothing was stated.
    pub fn get(&self, value: Value) -> T {
        let known = match value {
            Value::Time => Some(&self.time),
            Value::State(k) => self.states.get(k as usize),
            Value::Parameter(k) => self.parameters.get(k as usize),
            Value::Result(k) => self.results.get(k as usize),
            Value::Number(bits) => self.numbers.get(&bits),
        };
        known.copied().unwrap_or_default()
    }

    /// The place of what a value has.
    pub fn at(&mut self, value: Value) -> &mut T {
        let (table, k) = match value {
            Value::Time => return &mut self.time,
            Value::Number(bits) => return self.numbers.entry(bits).or_default(),
            Value::State(k) => (&mut self.states, k as usize),
            Value::Parameter(k) => (&mut self.parameters, k as usize),
            Value::Result(k) => (&mut self.results, k as usize),
        };
        if table.len() <= k {
            table.resize(k + 1, T::default());
        }
        &mut table[k]
    }

    /// How many parameters, from the first one on, may have something.
    pub fn parameters(&self) -> u32 {
        self.parameters.len() as u32
    }
}

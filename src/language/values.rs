//! Data that are attached to the values in formulas: tables for inputs and results, which are
//! faster than maps, and a map for numbers.

use super::assembly::Value;
use std::collections::HashMap;

/// Data attached to each value in a list of operations.
#[derive(Default)]
pub(super) struct Values<T> {
    time: T,
    states: Vec<T>,
    parameters: Vec<T>,
    results: Vec<T>,
    numbers: HashMap<u64, T>,
}

impl<T: Copy + Default> Values<T> {
    /// Returns the data that are attached to a value in a formula, or the default data if no data
    /// were stored.
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

    /// Returns a mutable reference to the data attached to a value.
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

    /// Returns 1 plus the index of the last parameter to which data are attached.
    pub fn parameters(&self) -> u32 {
        self.parameters.len() as u32
    }
}

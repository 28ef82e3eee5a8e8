//! Where the values of a tape are: registers, which values share that are not needed at the same time.

use super::assembly::{Assembly, Value};
use super::operation::Operation;
use super::tape::{Code, Step, Tape};
use std::collections::HashMap;

/// The most states that are in registers from the beginning.
const PRELOADED: usize = 6;

/// A tape that is being laid out.
pub(super) struct Layout<'a> {
    assembly: &'a Assembly,
    needed: Vec<bool>,
    /// How many times each value is still read.
    reads: HashMap<Value, usize>,
    /// The cosine that is computed with each sine, or the other way round.
    partners: HashMap<u32, u32>,
    registers: HashMap<Value, u32>,
    free: Vec<u32>,
    count: u32,
    preloaded: usize,
    steps: Vec<Step>,
}

impl<'a> Layout<'a> {
    pub fn of(assembly: &'a Assembly, results: &[Value]) -> Self {
        let needed = assembly.needed(results);
        let mut layout = Layout {
            assembly,
            needed,
            reads: HashMap::new(),
            partners: HashMap::new(),
            // The first register has the time from the beginning, and keeps it.
            registers: HashMap::from([(Value::Time, 0)]),
            free: Vec::new(),
            count: 1,
            preloaded: 0,
            steps: Vec::new(),
        };
        layout.reads.insert(Value::Time, usize::MAX / 2);
        for k in 0..assembly.len() {
            let (operation, arguments) = &assembly.applied[k];
            for argument in arguments[..operation.arity()].iter().filter(|_| layout.needed[k]) {
                *layout.reads.entry(*argument).or_default() += 1;
            }
        }
        for result in results {
            *layout.reads.entry(*result).or_default() += 1;
        }
        layout.pair_cosines();
        layout.preload();
        layout
    }

    /// The states of a small system, of which all are read, are in registers from the beginning: a step for each would
    /// take longer.
    fn preload(&mut self) {
        let read = (0..PRELOADED as u32).take_while(|k| self.reads.contains_key(&Value::State(*k)));
        self.preloaded = read.count();
        for k in 0..self.preloaded as u32 {
            self.registers.insert(Value::State(k), 1 + k);
            self.reads.insert(Value::State(k), usize::MAX / 2);
        }
        self.count += self.preloaded as u32;
    }

    /// Sine and cosine of one angle are computed at once, where the first of them is.
    fn pair_cosines(&mut self) {
        use Operation::{Cosine, Sine};
        for (k, (operation, [a, ..])) in self.assembly.applied.iter().enumerate() {
            let other = match operation {
                Sine => Cosine,
                Cosine => Sine,
                _ => continue,
            };
            let other = self.assembly.known.get(&(other, [*a; 3])).copied();
            let follows = |other: &u32| *other as usize > k && self.needed[*other as usize];
            if let Some(other) = other.filter(|other| self.needed[k] && follows(other)) {
                self.partners.insert(k as u32, other);
            }
        }
    }

    /// The tape, in which results are put away as soon as they are there.
    pub fn tape(mut self, results: &[Value]) -> Tape {
        let mut at: HashMap<Value, Vec<u32>> = HashMap::new();
        for (k, result) in results.iter().enumerate() {
            at.entry(*result).or_default().push(k as u32);
        }
        let fused = self.fused();
        for k in 0..self.assembly.len() as u32 {
            let value = Value::Result(k);
            if self.needed[k as usize]
                && !fused.contains_key(&k)
                && !self.registers.contains_key(&value)
            {
                self.compute(k, &fused);
            }
            if self.registers.contains_key(&value) {
                self.put_away(value, at.remove(&value).unwrap_or_default());
            }
        }
        // What is left are inputs and numbers.
        let mut left: Vec<(Value, Vec<u32>)> = at.into_iter().collect();
        left.sort();
        for (value, positions) in left {
            self.put_away(value, positions);
        }
        let Layout { steps, count, preloaded, .. } = self;
        Tape { steps, registers: count as usize, preloaded }
    }

    fn put_away(&mut self, value: Value, positions: Vec<u32>) {
        for into in positions {
            let a = self.read(value);
            self.push(Code::Result, into, [a; 3], 0.0);
            self.release(value);
        }
    }

    /// Products that are computed where they are added: those that nothing else reads.
    fn fused(&self) -> HashMap<u32, [Value; 2]> {
        let mut fused = HashMap::new();
        for (k, (operation, [a, b, _])) in self.assembly.applied.iter().enumerate() {
            let is_sum =
                matches!(operation, Operation::Add | Operation::Subtract) && self.needed[k];
            for (term, other) in [(b, a), (a, b)].into_iter().filter(|_| is_sum) {
                let first = *operation == Operation::Add || term == b;
                let Value::Result(product) = term else { continue };
                let taken = matches!(other, Value::Result(other) if fused.contains_key(other));
                let (multiply, factors) = self.assembly.applied[*product as usize];
                let once = self.reads.get(term) == Some(&1) && other.as_number().is_none();
                if first && once && !taken && multiply == Operation::Multiply {
                    fused.insert(*product, [factors[0], factors[1]]);
                    break;
                }
            }
        }
        fused
    }

    fn push(&mut self, code: Code, into: u32, registers: [u32; 3], n: f64) {
        self.push_operation((code, Operation::Add), into, registers, n);
    }

    /// Adds a step; its operation counts where it is a general one.
    fn push_operation(
        &mut self,
        (code, operation): (Code, Operation),
        into: u32,
        [a, b, c]: [u32; 3],
        n: f64,
    ) {
        self.steps.push(Step { code, operation, into, a, b, c, n });
    }

    /// The register of a value, into which inputs and numbers are loaded first.
    fn read(&mut self, value: Value) -> u32 {
        if let Some(register) = self.registers.get(&value) {
            return *register;
        }
        let (code, a, n) = match value {
            Value::State(k) => (Code::State, k, 0.0),
            Value::Parameter(k) => (Code::Parameter, k, 0.0),
            Value::Number(bits) => (Code::Number, 0, f64::from_bits(bits)),
            Value::Time | Value::Result(_) => (Code::Number, 0, f64::NAN),
        };
        let into = self.reserve(value);
        self.push(code, into, [a, 0, 0], n);
        into
    }

    fn reserve(&mut self, value: Value) -> u32 {
        let register = self.free.pop().unwrap_or_else(|| {
            self.count += 1;
            self.count - 1
        });
        self.registers.insert(value, register);
        register
    }

    /// A value has been read once more: its register is free behind the last time.
    fn release(&mut self, value: Value) {
        let Some(reads) = self.reads.get_mut(&value) else { return };
        *reads -= 1;
        if *reads == 0 {
            self.free.extend(self.registers.remove(&value));
        }
    }

    /// Adds the step of an operation.
    fn compute(&mut self, k: u32, fused: &HashMap<u32, [Value; 2]>) {
        let (operation, arguments) = self.assembly.applied[k as usize];
        let (code, inputs, n) = self.step(operation, arguments, fused);
        let mut registers = [0; 3];
        for (register, input) in registers.iter_mut().zip(&inputs) {
            *register = self.read(*input);
        }
        for input in &inputs {
            self.release(*input);
        }
        let into = self.reserve(Value::Result(k));
        match self.partners.get(&k).copied() {
            None => self.push_operation((code, operation), into, registers, n),
            Some(other) => {
                let second = self.reserve(Value::Result(other));
                let (sine, cosine) = match operation {
                    Operation::Sine => (into, second),
                    _ => (second, into),
                };
                self.push(Code::SineCosine, sine, [registers[0], registers[0], cosine], 0.0);
            }
        }
    }

    /// What an operation does, and which values it reads.
    fn step(
        &self,
        operation: Operation,
        arguments: [Value; 3],
        fused: &HashMap<u32, [Value; 2]>,
    ) -> (Code, Vec<Value>, f64) {
        use Operation::*;
        let [a, b, _] = arguments;
        let product = |value: Value| match value {
            Value::Result(k) => fused.get(&k).copied(),
            _ => None,
        };
        match (operation, [product(a), product(b)]) {
            (Add, [Some(factors), _]) => return sum_of_product(factors, b),
            (Add, [_, Some(factors)]) => return sum_of_product(factors, a),
            (Subtract, [_, Some([x, y])]) => return (Code::SubtractProduct, vec![x, y, a], 0.0),
            _ => {}
        }
        match (operation, [a.as_number(), b.as_number()]) {
            (Add, [Some(n), _]) => (Code::Shift, vec![b], n),
            (Add, [_, Some(n)]) => (Code::Shift, vec![a], n),
            (Subtract, [Some(n), _]) => (Code::Reflect, vec![b], n),
            (Subtract, [_, Some(n)]) => (Code::Shift, vec![a], -n),
            (Multiply, [Some(n), _]) => (Code::Scale, vec![b], n),
            (Multiply, [_, Some(n)]) => (Code::Scale, vec![a], n),
            (Divide, [Some(n), _]) => (Code::Invert, vec![b], n),
            // A power of two has an exact reciprocal.
            (Divide, [_, Some(n)]) if is_power_of_two(n) => (Code::Scale, vec![a], n.recip()),
            (Divide, [_, Some(n)]) => (Code::Share, vec![a], n),
            (Power, [_, Some(n)]) if n.fract() == 0.0 && n.abs() < 1e9 => {
                (Code::PowerInteger, vec![a], n)
            }
            (Power, [_, Some(n)]) => (Code::PowerReal, vec![a], n),
            (Add, _) => (Code::Add, vec![a, b], 0.0),
            (Subtract, _) => (Code::Subtract, vec![a, b], 0.0),
            (Multiply, _) => (Code::Multiply, vec![a, b], 0.0),
            (Divide, _) => (Code::Divide, vec![a, b], 0.0),
            (Square, _) => (Code::Square, vec![a], 0.0),
            _ => (Code::General, arguments[..operation.arity()].to_vec(), 0.0),
        }
    }
}

fn is_power_of_two(n: f64) -> bool {
    let inverse = n.recip();
    n.is_normal() && inverse.is_normal() && n.to_bits().trailing_zeros() >= 52
}

/// A product and a summand.
fn sum_of_product([x, y]: [Value; 2], summand: Value) -> (Code, Vec<Value>, f64) {
    match (x.as_number(), y.as_number()) {
        (Some(n), _) => (Code::ScaleAdd, vec![y, summand], n),
        (_, Some(n)) => (Code::ScaleAdd, vec![x, summand], n),
        _ => (Code::MultiplyAdd, vec![x, y, summand], 0.0),
    }
}

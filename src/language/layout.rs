//! Layout of a tape (the list of operations that evaluates formulas): assigns values to registers;
//! values that are not needed at the same time may share a register.

use super::assembly::{Assembly, Value};
use super::operation::Operation;
use super::tape::{Code, Step, Tape};
use super::values::Values;
use std::collections::HashMap;

/// The maximum number of states, and the maximum number of parameters, that are preloaded into
/// registers.
const PRELOADED: usize = 6;
/// The maximum number of results that stay in registers until the end of the tape.
const KEPT: usize = 8;

/// A special number of remaining reads, which marks a value that must never be dropped from its
/// register.
const KEPT_FOREVER: u32 = u32::MAX / 2;

/// A tape (list of operations) while values are assigned to its registers.
pub(super) struct Layout<'a> {
    assembly: &'a Assembly,
    needed: Vec<bool>,
    /// For each value, the number of operations that have not yet read it.
    reads: Values<u32>,
    /// The pairs of a sine and a cosine of the same angle, which are computed together: the index
    /// of the second operation, stored under the index of the first.
    partners: HashMap<u32, u32>,
    registers: Values<Option<u32>>,
    free: Vec<u32>,
    count: u32,
    preloaded: usize,
    parameters: Vec<u32>,
    steps: Vec<Step>,
}

impl<'a> Layout<'a> {
    pub fn of(assembly: &'a Assembly, results: &[Value]) -> Self {
        let needed = assembly.needed(results);
        let mut layout = Layout {
            assembly,
            needed,
            reads: Values::default(),
            partners: HashMap::new(),
            registers: Values::default(),
            free: Vec::new(),
            count: 1,
            preloaded: 0,
            parameters: Vec::new(),
            steps: Vec::new(),
        };
        // The first register holds the time throughout.
        *layout.registers.at(Value::Time) = Some(0);
        *layout.reads.at(Value::Time) = KEPT_FOREVER;
        for k in 0..assembly.len() {
            let (operation, arguments) = &assembly.applied[k];
            for argument in arguments[..operation.arity()].iter().filter(|_| layout.needed[k]) {
                *layout.reads.at(*argument) += 1;
            }
        }
        for result in results {
            *layout.reads.at(*result) += 1;
        }
        layout.pair_cosines();
        layout.preload();
        layout
    }

    /// Preloads the states of a small system and a few parameters into registers, because separate
    /// steps that load them would take longer.
    fn preload(&mut self) {
        let read = (0..PRELOADED as u32).take_while(|k| self.reads.get(Value::State(*k)) > 0);
        self.preloaded = read.count();
        let states = (0..self.preloaded as u32).map(Value::State);
        let parameters = 0..self.reads.parameters();
        self.parameters = parameters.filter(|k| self.reads.get(Value::Parameter(*k)) > 0).collect();
        if self.parameters.len() > PRELOADED {
            self.parameters.clear();
        }
        for value in states.chain(self.parameters.iter().map(|k| Value::Parameter(*k))) {
            *self.registers.at(value) = Some(self.count);
            *self.reads.at(value) = KEPT_FOREVER;
            self.count += 1;
        }
    }

    /// Pairs the sine and the cosine of the same angle, so that both are computed together at the
    /// first of the two operations.
    fn pair_cosines(&mut self) {
        use Operation::{Cosine, Sine};
        for (k, (operation, [a, ..])) in self.assembly.applied.iter().enumerate() {
            let other = match operation {
                Sine => Cosine,
                Cosine => Sine,
                _ => continue,
            };
            let other = self.assembly.position(&(other, [*a; 3]));
            let follows = |other: &u32| *other as usize > k && self.needed[*other as usize];
            if let Some(other) = other.filter(|other| self.needed[k] && follows(other)) {
                self.partners.insert(k as u32, other);
            }
        }
    }

    /// Computes the layout of the tape that yields the given results. A few results stay in
    /// registers until the end of the tape; if the tape has many results, each result is stored
    /// immediately.
    pub fn tape(mut self, results: &[Value]) -> Tape {
        let (kept, stored) = results.split_at(if results.len() > KEPT { 0 } else { results.len() });
        // `first` is the first result with each value, and `next` the next result with the same
        // value.
        let (mut first, mut next) = (Values::<Option<u32>>::default(), vec![None; stored.len()]);
        for (k, result) in stored.iter().enumerate().rev() {
            next[k] = first.at(*result).replace(k as u32);
        }
        let fused = self.fused();
        for k in 0..self.assembly.len() as u32 {
            let value = Value::Result(k);
            if self.needed[k as usize] && !fused[k as usize] && self.registers.get(value).is_none()
            {
                self.compute(k, &fused);
            }
            let mut result = first.get(value).filter(|_| self.registers.get(value).is_some());
            while let Some(into) = result {
                self.put_away(value, into);
                result = next[into as usize];
            }
        }
        // The remaining results are inputs and numbers.
        let others = stored.iter().copied().zip(0..);
        let mut left: Vec<(Value, u32)> =
            others.filter(|(value, _)| !matches!(value, Value::Result(_))).collect();
        left.sort();
        left.into_iter().for_each(|(value, into)| self.put_away(value, into));
        let outputs = kept.iter().map(|value| self.read(*value)).collect();
        let Layout { steps, count, preloaded, parameters, .. } = self;
        Tape { steps, registers: count as usize, preloaded, parameters, outputs }
    }

    fn put_away(&mut self, value: Value, into: u32) {
        let a = self.read(value);
        self.push(Code::Result, into, [a; 3], 0.0);
        self.release(value);
    }

    /// Returns a flag for each operation: true for a product that can be computed together with a
    /// sum, because no other operation reads the product.
    fn fused(&self) -> Vec<bool> {
        let mut fused = vec![false; self.assembly.len()];
        for (k, (operation, [a, b, _])) in self.assembly.applied.iter().enumerate() {
            for sum in [Sum::second(*operation, *a, *b), Sum::first(*operation, *a, *b)] {
                let Value::Result(product) = sum.product else { continue };
                let taken = matches!(sum.other, Value::Result(k) if fused[k as usize]);
                let (multiply, [x, y, _]) = self.assembly.applied[product as usize];
                let once = self.needed[k] && self.reads.get(sum.product) == 1 && !taken;
                if once && multiply == Operation::Multiply && sum.step([x, y]).is_some() {
                    fused[product as usize] = true;
                    break;
                }
            }
        }
        fused
    }

    fn push(&mut self, code: Code, into: u32, registers: [u32; 3], n: f64) {
        self.push_operation((code, Operation::Add), into, registers, n);
    }

    /// Adds a step to the tape; `operation` is used only if the code of the step is `General`.
    fn push_operation(
        &mut self,
        (code, operation): (Code, Operation),
        into: u32,
        [a, b, c]: [u32; 3],
        n: f64,
    ) {
        self.steps.push(Step { code, operation, into, a, b, c, n });
    }

    /// Returns the register that contains a value; inputs and numbers that are not in a register
    /// are first loaded into one.
    fn read(&mut self, value: Value) -> u32 {
        if let Some(register) = self.registers.get(value) {
            return register;
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
        *self.registers.at(value) = Some(register);
        register
    }

    /// Counts one read of a value, and frees the value's register after the last read.
    fn release(&mut self, value: Value) {
        let reads = self.reads.at(value);
        *reads = reads.saturating_sub(1);
        if *reads == 0 {
            self.free.extend(self.registers.at(value).take());
        }
    }

    /// Adds the step that computes an operation.
    fn compute(&mut self, k: u32, fused: &[bool]) {
        let (operation, arguments) = self.assembly.applied[k as usize];
        let Planned { code, inputs, n, m } = self.step(operation, arguments, fused);
        let bits = m.to_bits();
        let mut registers = match code {
            Code::Line => [0, (bits >> 32) as u32, bits as u32],
            _ => [0; 3],
        };
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

    /// Returns the step that computes an operation, and the values that the step reads.
    fn step(&self, operation: Operation, arguments: [Value; 3], fused: &[bool]) -> Planned {
        use Operation::*;
        let [a, b, _] = arguments;
        for sum in [Sum::second(operation, a, b), Sum::first(operation, a, b)] {
            let Value::Result(product) = sum.product else { continue };
            let (_, [x, y, _]) = self.assembly.applied[product as usize];
            let step = fused[product as usize].then(|| sum.step([x, y])).flatten();
            if let Some(step) = step {
                return step;
            }
        }
        match (operation, [a.as_number(), b.as_number()]) {
            (Add, [Some(n), _]) => Planned::new(Code::Shift, [b], n),
            (Add, [_, Some(n)]) => Planned::new(Code::Shift, [a], n),
            (Subtract, [Some(n), _]) => Planned::new(Code::Reflect, [b], n),
            (Subtract, [_, Some(n)]) => Planned::new(Code::Shift, [a], -n),
            (Multiply, [Some(n), _]) => Planned::new(Code::Scale, [b], n),
            (Multiply, [_, Some(n)]) => Planned::new(Code::Scale, [a], n),
            (Divide, [Some(n), _]) => Planned::new(Code::Invert, [b], n),
            (Divide, [_, Some(n)]) => Planned::new(Code::Share, [a], n),
            (Power, [_, Some(n)]) if n.fract() == 0.0 && n.abs() < 1e9 => {
                Planned::new(Code::PowerInteger, [a], n)
            }
            (Power, [_, Some(n)]) => Planned::new(Code::PowerReal, [a], n),
            (Add, _) => Planned::new(Code::Add, [a, b], 0.0),
            (Subtract, _) => Planned::new(Code::Subtract, [a, b], 0.0),
            (Multiply, _) => Planned::new(Code::Multiply, [a, b], 0.0),
            (Divide, _) => Planned::new(Code::Divide, [a, b], 0.0),
            (Square, _) => Planned::new(Code::Square, [a], 0.0),
            _ => Planned::new(Code::General, arguments[..operation.arity()].to_vec(), 0.0),
        }
    }
}

/// A planned step of the tape: its code, the values that it reads, and its constants.
struct Planned {
    code: Code,
    inputs: Vec<Value>,
    n: f64,
    /// The factor `m` of a step that computes `a m + n`.
    m: f64,
}

impl Planned {
    fn new(code: Code, inputs: impl Into<Vec<Value>>, n: f64) -> Self {
        Planned { code, inputs: inputs.into(), n, m: 0.0 }
    }
}

/// A sum or difference of two terms; the term named `product` is the one that may be a product.
struct Sum {
    product: Value,
    other: Value,
    /// The signs of the product and of the other term.
    signs: [f64; 2],
}

impl Sum {
    /// Creates a sum from an operation; the second term of the sum is tried as the product.
    fn second(operation: Operation, a: Value, b: Value) -> Self {
        let sign = if operation == Operation::Subtract { -1.0 } else { 1.0 };
        Sum { product: Sum::term(operation, b), other: a, signs: [sign, 1.0] }
    }

    /// Creates a sum from an operation; the first term of the sum is tried as the product.
    fn first(operation: Operation, a: Value, b: Value) -> Self {
        let sign = if operation == Operation::Subtract { -1.0 } else { 1.0 };
        Sum { product: Sum::term(operation, a), other: b, signs: [1.0, sign] }
    }

    /// Returns the given term if the operation is a sum or difference; otherwise returns the value
    /// `Time` as a placeholder, which is never a product.
    fn term(operation: Operation, term: Value) -> Value {
        match operation {
            Operation::Add | Operation::Subtract => term,
            _ => Value::Time,
        }
    }

    /// Returns the step that computes the product `x y` and the sum together, or `None` if no such
    /// step exists.
    fn step(&self, [x, y]: [Value; 2]) -> Option<Planned> {
        let Sum { other, signs: [sign, other_sign], .. } = *self;
        let scaled = [(x, y), (y, x)].into_iter().find_map(|(m, x)| Some((m.as_number()?, x)));
        let n = other.as_number().map(|n| other_sign * n);
        match (scaled, n) {
            (Some((m, x)), Some(n)) => {
                Some(Planned { m: sign * m, ..Planned::new(Code::Line, [x], n) })
            }
            (None, Some(n)) if sign > 0.0 => Some(Planned::new(Code::MultiplyShift, [x, y], n)),
            (_, None) if other_sign < 0.0 => None,
            (Some((m, x)), None) => Some(Planned::new(Code::ScaleAdd, [x, other], sign * m)),
            (None, None) if sign < 0.0 => {
                Some(Planned::new(Code::SubtractProduct, [x, y, other], 0.0))
            }
            (None, None) => Some(Planned::new(Code::MultiplyAdd, [x, y, other], 0.0)),
            (None, Some(_)) => None,
        }
    }
}

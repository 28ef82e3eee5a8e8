//! Tapes from operations: equal parts are found, constants computed, and registers shared.

use super::operation::Operation;
use super::tape::{Code, Place, Step, Tape};
use std::collections::{HashMap, HashSet};
use std::ops::Range;

/// A value in a formula: a number, an input, or what an earlier operation gave.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub(super) enum Value {
    /// The bits of a number.
    Number(u64),
    Time,
    State(u32),
    Parameter(u32),
    /// The result of an operation, by its position.
    Result(u32),
}

impl Value {
    pub fn number(value: f64) -> Self {
        Value::Number(value.to_bits())
    }

    pub fn is_parameter(self) -> bool {
        matches!(self, Value::Parameter(_))
    }

    pub fn as_number(self) -> Option<f64> {
        match self {
            Value::Number(bits) => Some(f64::from_bits(bits)),
            _ => None,
        }
    }
}

/// Where an operation stands: a phrase, by its position among all that were read, and a part of it.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub(super) struct Origin {
    pub phrase: usize,
    pub part: Range<usize>,
}

type Applied = (Operation, [Value; 3]);

/// Operations, each of which is there once.
#[derive(Default)]
pub(super) struct Assembly {
    applied: Vec<Applied>,
    origins: Vec<Origin>,
    known: HashMap<Applied, u32>,
}

impl Assembly {
    /// How many operations there are.
    pub fn len(&self) -> usize {
        self.applied.len()
    }

    /// An operation on one to three values.
    pub fn apply(&mut self, operation: Operation, given: &[Value], origin: &Origin) -> Value {
        use Operation::*;
        let arguments = std::array::from_fn(|k| given.get(k).copied().unwrap_or(given[0]));
        let [a, b, c] = arguments;
        let numbers = arguments.map(Value::as_number);
        if let [Some(x), Some(y), Some(z)] = numbers {
            return Value::number(operation.of(&x, &y, &z));
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
            (Add | Multiply, _) if b < a => return self.once((operation, [b, a, b]), origin),
            _ => {}
        }
        self.once((operation, arguments), origin)
    }

    fn once(&mut self, applied: Applied, origin: &Origin) -> Value {
        let next = self.applied.len() as u32;
        let position = *self.known.entry(applied).or_insert(next);
        if position == next {
            self.applied.push(applied);
            self.origins.push(origin.clone());
        }
        Value::Result(position)
    }

    /// Whether a value depends on an input of some sort.
    pub fn depends(&self, value: Value, sort: impl Fn(Value) -> bool) -> bool {
        let needed = self.needed(&[value]);
        let operations = self.applied.iter().zip(needed).filter(|(_, needed)| *needed);
        let inputs = operations.flat_map(|((operation, all), _)| &all[..operation.arity()]);
        let input = |value: &Value| !matches!(value, Value::Number(_) | Value::Result(_));
        inputs.chain([&value]).any(|value| input(value) && sort(*value))
    }

    /// The tape that computes some of the values.
    pub fn tape(&self, results: &[Value]) -> Tape {
        Layout::of(self, results).tape(results)
    }

    /// All values in real numbers: the operation that first gives one that is not finite, with its arguments, among
    /// those that some results need.
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

    /// Which operations some results need.
    fn needed(&self, results: &[Value]) -> Vec<bool> {
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

/// An operation that gives no finite number.
pub(super) struct Undefined {
    pub operation: Operation,
    pub arguments: Vec<f64>,
    pub value: f64,
    pub origin: Origin,
}

/// Where the values of a tape are.
struct Layout<'a> {
    assembly: &'a Assembly,
    needed: Vec<bool>,
    /// The last operation that reads each value.
    last_use: Vec<usize>,
    /// The cosine that is computed with each sine.
    cosines: HashMap<usize, usize>,
    places: Vec<Place>,
    free: Vec<usize>,
    registers: usize,
}

impl<'a> Layout<'a> {
    fn of(assembly: &'a Assembly, results: &[Value]) -> Self {
        let needed = assembly.needed(results);
        let count = assembly.applied.len();
        let mut last_use = vec![0; count];
        for (k, (operation, arguments)) in assembly.applied.iter().enumerate() {
            for argument in arguments[..operation.arity()].iter().filter(|_| needed[k]) {
                if let Value::Result(i) = argument {
                    last_use[*i as usize] = k;
                }
            }
        }
        let places = vec![Place::TIME; count];
        let mut layout = Layout {
            assembly,
            needed,
            last_use,
            cosines: HashMap::new(),
            places,
            free: Vec::new(),
            registers: 1,
        };
        layout.pair_cosines();
        for (k, result) in results.iter().enumerate().rev() {
            // What is a result is kept where results are; what several are, at the first of them.
            if let Value::Result(i) = result {
                layout.places[*i as usize] = Place::result(k);
            }
        }
        layout
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
            let other = self.assembly.known.get(&(other, [*a; 3])).map(|other| *other as usize);
            if let Some(other) =
                other.filter(|other| *other > k && self.needed[k] && self.needed[*other])
            {
                self.cosines.insert(k, other);
            }
        }
    }

    fn new_register(&mut self) -> usize {
        self.free.pop().unwrap_or_else(|| {
            self.registers += 1;
            self.registers - 1
        })
    }

    fn tape(mut self, results: &[Value]) -> Tape {
        let mut steps = Vec::new();
        let second: HashSet<usize> = self.cosines.values().copied().collect();
        // Registers are free again behind the last use of their values.
        let mut ending: HashMap<usize, Vec<usize>> = HashMap::new();
        for k in 0..self.assembly.applied.len() {
            if !self.needed[k] || second.contains(&k) {
                self.release(&mut ending, k);
                continue;
            }
            let mut step = self.step(k, &mut steps);
            self.release(&mut ending, k);
            step.into = self.place(k, &mut ending);
            if let Some(other) = self.cosines.get(&k).copied() {
                step.code = Code::SineCosine;
                step.c = self.place(other, &mut ending);
                if self.assembly.applied[k].0 == Operation::Cosine {
                    (step.into, step.c) = (step.c, step.into);
                }
            }
            steps.push(step);
        }
        for (k, result) in results.iter().enumerate() {
            let into = Place::result(k);
            let step = Step { code: Code::Copy, into, a: into, b: into, c: into, n: 0.0 };
            match result {
                Value::Number(bits) => {
                    steps.push(Step { code: Code::Number, n: f64::from_bits(*bits), ..step });
                }
                other => {
                    let a = self.input(other);
                    if a != into {
                        steps.push(Step { a, ..step });
                    }
                }
            }
        }
        Tape { steps, registers: self.registers }
    }

    fn release(&mut self, ending: &mut HashMap<usize, Vec<usize>>, k: usize) {
        self.free.extend(ending.remove(&k).into_iter().flatten());
    }

    /// Where the value of an operation goes.
    fn place(&mut self, k: usize, ending: &mut HashMap<usize, Vec<usize>>) -> Place {
        if self.places[k] == Place::TIME {
            let register = self.new_register();
            ending.entry(self.last_use[k]).or_default().push(register);
            self.places[k] = Place::register(register);
        }
        self.places[k]
    }

    fn input(&self, value: &Value) -> Place {
        match value {
            Value::Time | Value::Number(_) => Place::TIME,
            Value::State(k) => Place::state(*k as usize),
            Value::Parameter(k) => Place::parameter(*k as usize),
            Value::Result(k) => self.places[*k as usize],
        }
    }

    /// The step of an operation, but for where it goes; numbers that no code takes are put into registers before.
    fn step(&mut self, k: usize, steps: &mut Vec<Step>) -> Step {
        use Operation::*;
        let (operation, arguments) = self.assembly.applied[k];
        let numbers = arguments.map(Value::as_number);
        let [a, b, c] = arguments.map(|argument| self.input(&argument));
        let step = Step { code: Code::General(operation), into: a, a, b, c, n: 0.0 };
        let with = |code, a, n| Step { code, a, n, ..step };
        match (operation, numbers) {
            (Add, [Some(n), ..]) => with(Code::Shift, b, n),
            (Add, [_, Some(n), _]) => with(Code::Shift, a, n),
            (Subtract, [Some(n), ..]) => with(Code::Reflect, b, n),
            (Subtract, [_, Some(n), _]) => with(Code::Shift, a, -n),
            (Multiply, [Some(n), ..]) => with(Code::Scale, b, n),
            (Multiply, [_, Some(n), _]) => with(Code::Scale, a, n),
            (Divide, [Some(n), ..]) => with(Code::Invert, b, n),
            (Divide, [_, Some(n), _]) => with(Code::Share, a, n),
            (Power, [_, Some(n), _]) if n.fract() == 0.0 && n.abs() < 1e9 => {
                with(Code::PowerInteger, a, n)
            }
            (Power, [_, Some(n), _]) => with(Code::PowerReal, a, n),
            (Add, _) => with(Code::Add, a, 0.0),
            (Subtract, _) => with(Code::Subtract, a, 0.0),
            (Multiply, _) => with(Code::Multiply, a, 0.0),
            (Divide, _) => with(Code::Divide, a, 0.0),
            _ => self.general(step, numbers, operation.arity(), steps),
        }
    }

    /// A step of an operation whose numbers must be in registers: in ones of their own.
    fn general(
        &mut self,
        mut step: Step,
        numbers: [Option<f64>; 3],
        arity: usize,
        steps: &mut Vec<Step>,
    ) -> Step {
        let places = [&mut step.a, &mut step.b, &mut step.c];
        let mut given = Vec::new();
        for (place, number) in places.into_iter().zip(numbers).take(arity) {
            if let Some(n) = number {
                self.registers += 1;
                let register = Place::register(self.registers - 1);
                given.push((register, n));
                *place = register;
            }
        }
        let number = |(into, n)| Step { code: Code::Number, into, a: into, b: into, c: into, n };
        steps.extend(given.into_iter().map(number));
        step
    }
}

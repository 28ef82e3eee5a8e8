//! Formulas as tapes: steps over registers, evaluated in any scalar without allocation.

use super::operation::Operation;
use crate::core::scalar::Scalar;

/// Where a value is: in a register, or among states, parameters or results.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Place(u32);

impl Place {
    const BANK: u32 = 30;
    /// The register that holds the time.
    pub const TIME: Place = Place(0);
    /// The most places of a kind.
    pub const LIMIT: usize = 1 << Self::BANK;

    pub fn register(k: usize) -> Self {
        Place(k as u32)
    }

    pub fn state(k: usize) -> Self {
        Place(k as u32 | 1 << Self::BANK)
    }

    pub fn parameter(k: usize) -> Self {
        Place(k as u32 | 2 << Self::BANK)
    }

    pub fn result(k: usize) -> Self {
        Place(k as u32 | 3 << Self::BANK)
    }
}

/// What a step does. `a`, `b` and `c` are places, `n` is a number.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Code {
    /// `a + b`.
    Add,
    /// `a − b`.
    Subtract,
    /// `a b`.
    Multiply,
    /// `a/b`.
    Divide,
    /// `a + n`.
    Shift,
    /// `n − a`.
    Reflect,
    /// `a n`.
    Scale,
    /// `a/n`.
    Share,
    /// `n/a`.
    Invert,
    /// `a^n` for an integer `n`.
    PowerInteger,
    /// `a^n`.
    PowerReal,
    /// `sin a`, and `cos a` into `c`.
    SineCosine,
    /// `a`.
    Copy,
    /// `n`.
    Number,
    /// Any operation on `a`, `b` and `c`.
    General(Operation),
}

/// A step of a tape.
#[derive(Clone, Copy, Debug)]
pub(super) struct Step {
    pub code: Code,
    pub into: Place,
    pub a: Place,
    pub b: Place,
    pub c: Place,
    pub n: f64,
}

/// Several formulas of time, states and parameters as a list of steps, in which common parts are computed once.
#[derive(Clone, Debug, Default)]
pub(super) struct Tape {
    pub steps: Vec<Step>,
    /// How many registers it needs, that of the time among them.
    pub registers: usize,
}

/// What a tape reads and writes.
struct Banks<'a, T> {
    registers: &'a mut [T],
    x: &'a [T],
    p: &'a [T],
    results: &'a mut [T],
}

impl<T> Banks<'_, T> {
    #[inline(always)]
    fn at(&self, place: Place) -> &T {
        let k = (place.0 & (Place::LIMIT - 1) as u32) as usize;
        match place.0 >> Place::BANK {
            0 => &self.registers[k],
            1 => &self.x[k],
            2 => &self.p[k],
            _ => &self.results[k],
        }
    }

    #[inline(always)]
    fn put(&mut self, place: Place, value: T) {
        let k = (place.0 & (Place::LIMIT - 1) as u32) as usize;
        match place.0 >> Place::BANK {
            0 => self.registers[k] = value,
            _ => self.results[k] = value,
        }
    }
}

/// The largest array of registers on the stack, in bytes.
const ON_STACK: usize = 1 << 16;

impl Tape {
    /// Evaluates the formulas into `results`.
    #[inline]
    pub fn evaluate<T: Scalar>(&self, t: T, x: &[T], p: &[T], results: &mut [T]) {
        let fits = |registers: usize| {
            self.registers <= registers && registers * size_of::<T>() <= ON_STACK
        };
        match () {
            () if fits(4) => self.on_stack::<T, 4>(t, x, p, results),
            () if fits(8) => self.on_stack::<T, 8>(t, x, p, results),
            () if fits(16) => self.on_stack::<T, 16>(t, x, p, results),
            () if fits(64) => self.on_stack::<T, 64>(t, x, p, results),
            () if fits(512) => self.on_stack::<T, 512>(t, x, p, results),
            // Of many long numbers an allocation is no cost.
            () => self.run(Banks { registers: &mut vec![t; self.registers.max(1)], x, p, results }),
        }
    }

    /// Evaluates a tape of one formula.
    #[inline]
    pub fn value<T: Scalar>(&self, t: T, x: &[T], p: &[T]) -> T {
        let mut result = [T::zero()];
        self.evaluate(t, x, p, &mut result);
        result[0]
    }

    #[inline(never)]
    fn on_stack<T: Scalar, const N: usize>(&self, t: T, x: &[T], p: &[T], results: &mut [T]) {
        self.run(Banks { registers: &mut [t; N], x, p, results });
    }

    #[inline(never)]
    fn run<T: Scalar>(&self, mut banks: Banks<T>) {
        for &Step { code, into, a, b, c, n } in &self.steps {
            let value = match code {
                Code::Add => *banks.at(a) + banks.at(b),
                Code::Subtract => *banks.at(a) - banks.at(b),
                Code::Multiply => *banks.at(a) * banks.at(b),
                Code::Divide => *banks.at(a) / banks.at(b),
                Code::Shift => *banks.at(a) + n,
                Code::Reflect => -*banks.at(a) + n,
                Code::Scale => *banks.at(a) * n,
                Code::Share => *banks.at(a) / n,
                Code::Invert => banks.at(a).recip() * n,
                Code::PowerInteger => banks.at(a).powi(n as i32),
                Code::PowerReal => banks.at(a).powf(n),
                Code::SineCosine => {
                    let (sine, cosine) = banks.at(a).sin_cos();
                    banks.put(c, cosine);
                    sine
                }
                Code::Copy => *banks.at(a),
                Code::Number => T::constant(n),
                Code::General(operation) => {
                    general(operation, banks.at(a), banks.at(b), banks.at(c))
                }
            };
            banks.put(into, value);
        }
    }

    /// Whether its values are chosen by comparisons.
    pub fn decides(&self) -> bool {
        self.steps.iter().any(|step| match step.code {
            Code::General(operation) => operation.decides(),
            _ => false,
        })
    }
}

/// An operation that is not among the fastest.
#[inline(never)]
fn general<T: Scalar>(operation: Operation, a: &T, b: &T, c: &T) -> T {
    operation.of(a, b, c)
}

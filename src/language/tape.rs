//! Tapes, which evaluate formulas: a tape is a list of steps on registers that is evaluated in any
//! scalar type without allocation.

use super::elementary;
use super::operation::Operation;
use crate::core::scalar::{Scalar, in_registers_of};

/// The instruction that a step of a tape executes. In the descriptions of instructions, `a`, `b`
/// and `c` denote registers, and `n` denotes a number.
///
/// Some instructions compute a product and a sum, because selecting an instruction takes longer
/// than executing it on real numbers.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Code {
    /// Loads the state with index `a`.
    State,
    /// Loads the parameter with index `a`.
    Parameter,
    /// `n`.
    Number,
    /// Stores the value of register `a` as result number `into`; used if the tape has too many
    /// results to keep all of them in registers.
    Result,
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
    /// Computes `a m + n`, where `b` and `c` contain the bits of the number `m`.
    Line,
    /// `a/n`.
    Share,
    /// `n/a`.
    Invert,
    /// Computes `a b + c`.
    MultiplyAdd,
    /// Computes `a b + n`.
    MultiplyShift,
    /// Computes `c − a b`.
    SubtractProduct,
    /// Computes `a n + b`.
    ScaleAdd,
    /// `a²`.
    Square,
    /// Computes `a^n` for an integer `n`.
    PowerInteger,
    /// `a^n`.
    PowerReal,
    /// Computes `sin a`, and stores `cos a` in register `c`.
    SineCosine,
    /// Applies the operation that is stored in the step to `a`, `b` and `c`.
    General,
}

/// A step of a tape, which computes one value.
#[derive(Clone, Copy, Debug)]
pub(super) struct Step {
    pub code: Code,
    /// The operation, for a step with the code `General`.
    pub operation: Operation,
    pub into: u32,
    pub a: u32,
    pub b: u32,
    pub c: u32,
    pub n: f64,
}

/// Formulas of time, states and parameters, given as a list of steps in which common subexpressions
/// are computed only once.
#[derive(Clone, Debug, Default)]
pub(super) struct Tape {
    pub steps: Vec<Step>,
    /// The number of registers that the tape uses. The first register contains the time.
    pub registers: usize,
    /// The number of states that are loaded into registers before the first step; these registers
    /// follow the first register.
    pub preloaded: usize,
    /// The indices of the parameters that are loaded into registers before the first step; these
    /// registers follow the registers of the states.
    pub parameters: Vec<u32>,
    /// The registers that contain the results at the end; empty if the tape has many results.
    pub outputs: Vec<u32>,
}

/// A register. The alignment keeps the vector in a register within one cache line, because reading
/// a vector that was just stored is slow if the vector extends over two lines.
#[derive(Clone, Copy)]
#[repr(align(32))]
struct Register<T>(T);

/// The values of the states and parameters that a tape reads.
struct Inputs<'a, T> {
    x: &'a [T],
    p: &'a [T],
}

/// The maximum size, in bytes, of an array of registers on the stack.
const ON_STACK: usize = 1 << 16;

impl Tape {
    /// Evaluates the formulas of the tape, and writes their values to `results`.
    #[inline]
    pub fn evaluate<T: Scalar>(&self, t: T, x: &[T], p: &[T], results: &mut [T]) {
        let fits = |registers: usize| {
            self.registers <= registers && registers * size_of::<Register<T>>() <= ON_STACK
        };
        let inputs = Inputs { x, p };
        match () {
            () if fits(8) => self.on_stack::<T, 8>(t, inputs, results),
            () if fits(12) => self.on_stack::<T, 12>(t, inputs, results),
            () if fits(16) => self.on_stack::<T, 16>(t, inputs, results),
            () if fits(24) => self.on_stack::<T, 24>(t, inputs, results),
            () if fits(32) => self.on_stack::<T, 32>(t, inputs, results),
            () if fits(128) => self.on_stack::<T, 128>(t, inputs, results),
            () if fits(1024) => self.on_stack::<T, 1024>(t, inputs, results),
            // With many large numbers, the cost of an allocation is negligible.
            () => self.run(&mut vec![Register(t); self.registers.max(1)], inputs, results),
        }
    }

    /// Evaluates a tape that consists of one formula.
    #[inline]
    pub fn value<T: Scalar>(&self, t: T, x: &[T], p: &[T]) -> T {
        let mut result = [T::zero()];
        self.evaluate(t, x, p, &mut result);
        result[0]
    }

    #[inline(never)]
    fn on_stack<T: Scalar, const N: usize>(&self, t: T, inputs: Inputs<T>, results: &mut [T]) {
        self.run(&mut [Register(t); N], inputs, results);
    }

    #[inline(never)]
    fn run<T: Scalar>(&self, r: &mut [Register<T>], inputs: Inputs<T>, results: &mut [T]) {
        in_registers_of::<T, _>(
            #[inline(always)]
            || self.take_steps(r, inputs, results),
        );
    }

    #[inline(always)]
    #[allow(clippy::op_ref, reason = "values of numbers with many parts would be copied first")]
    fn take_steps<T: Scalar>(
        &self,
        r: &mut [Register<T>],
        Inputs { x, p }: Inputs<T>,
        results: &mut [T],
    ) {
        for (register, state) in r[1..=self.preloaded].iter_mut().zip(x) {
            register.0 = *state;
        }
        for (register, parameter) in r[1 + self.preloaded..].iter_mut().zip(&self.parameters) {
            register.0 = p[*parameter as usize];
        }
        for &Step { code, operation, into, a, b, c, n } in &self.steps {
            let [into, a, b, c] = [into as usize, a as usize, b as usize, c as usize];
            // Each arm stores its own result: a common result of all arms would be copied through
            // memory.
            match code {
                Code::State => r[into].0 = x[a],
                Code::Parameter => r[into].0 = p[a],
                Code::Number => r[into].0 = T::constant(n),
                Code::Result => results[into] = r[a].0,
                Code::Add => r[into].0 = r[a].0 + &r[b].0,
                Code::Subtract => r[into].0 = r[a].0 - &r[b].0,
                Code::Multiply => r[into].0 = r[a].0 * &r[b].0,
                Code::Divide => r[into].0 = r[a].0 / &r[b].0,
                Code::Shift => r[into].0 = r[a].0 + n,
                Code::Reflect => r[into].0 = -r[a].0 + n,
                Code::Line => r[into].0 = r[a].0 * f64::from_bits((b as u64) << 32 | c as u64) + n,
                Code::Scale => r[into].0 = r[a].0 * n,
                Code::Share => r[into].0 = r[a].0 / n,
                Code::Invert => r[into].0 = elementary::recip(&r[a].0) * n,
                Code::MultiplyAdd => r[into].0 = r[a].0 * &r[b].0 + &r[c].0,
                Code::MultiplyShift => r[into].0 = r[a].0 * &r[b].0 + n,
                Code::SubtractProduct => r[into].0 = r[c].0 - r[a].0 * &r[b].0,
                Code::ScaleAdd => r[into].0 = r[a].0 * n + &r[b].0,
                Code::Square => r[into].0 = r[a].0 * &r[a].0,
                Code::PowerInteger => r[into].0 = elementary::powi(&r[a].0, n as i32),
                Code::PowerReal => r[into].0 = elementary::powf(&r[a].0, n),
                Code::SineCosine => {
                    let (sine, cosine) = elementary::sin_cos(&r[a].0);
                    r[c].0 = cosine;
                    r[into].0 = sine;
                }
                Code::General => r[into].0 = general(operation, &r[a].0, &r[b].0, &r[c].0),
            }
        }
        for (result, register) in results.iter_mut().zip(&self.outputs) {
            *result = r[*register as usize].0;
        }
    }

    /// Returns whether a formula of the tape is a discontinuous function.
    pub fn jumps(&self) -> bool {
        self.steps.iter().any(|step| step.code == Code::General && step.operation.jumps())
    }

    /// Returns whether a formula of the tape may jump: the formula contains `if` or a discontinuous
    /// function.
    pub fn may_jump(&self) -> bool {
        let selects =
            |step: &Step| step.code == Code::General && step.operation == Operation::Select;
        self.jumps() || self.steps.iter().any(selects)
    }

    /// Returns whether a value of the tape depends on a comparison.
    pub fn decides(&self) -> bool {
        self.steps.iter().any(|step| step.code == Code::General && step.operation.decides())
    }
}

/// Evaluates an operation for which no specialised step exists.
#[inline(never)]
fn general<T: Scalar>(operation: Operation, a: &T, b: &T, c: &T) -> T {
    in_registers_of::<T, _>(
        #[inline(always)]
        || operation.of(a, b, c),
    )
}

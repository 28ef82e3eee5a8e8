//! Numbers that record how they were computed: what depends on what, and gradients in one pass.

use super::number::{number_of_reals, operations, signed_by_reals};
use num_dual::{Dual64, DualNum};
use std::cell::RefCell;
use std::fmt::{Display, Formatter};
use std::ops::Neg;

/// The node of numbers that depend on no input.
const CONSTANT: u32 = u32::MAX;

/// A number with its place in the record of its thread: a [`Scalar`](super::Scalar), compared by its
/// real part.
///
/// Each operation is recorded with its slopes. A pass backwards through the record gives the gradient
/// of a sum of results by all inputs, at a price that does not depend on their number (reverse mode;
/// A. Griewank and A. Walther, *Evaluating Derivatives*, SIAM 2008, ch. 3).
#[derive(Clone, Copy, Debug)]
pub struct Traced {
    re: f64,
    node: u32,
}

/// An operation: its operands and the slopes by them.
#[derive(Clone, Copy, Debug)]
struct Operation {
    operands: [u32; 2],
    slopes: [f64; 2],
}

/// The operations since the record began, and room for what is found on the way back.
#[derive(Default)]
struct Record {
    operations: Vec<Operation>,
    slopes: Vec<f64>,
    /// The result from which a node was last reached.
    reached: Vec<u32>,
    stack: Vec<u32>,
}

thread_local! {
    static RECORD: RefCell<Record> = RefCell::default();
}

impl Record {
    fn add(&mut self, operands: [u32; 2], slopes: [f64; 2]) -> u32 {
        self.operations.push(Operation { operands, slopes });
        (self.operations.len() - 1) as u32
    }

    fn gradient(&mut self, results: impl Iterator<Item = (Traced, f64)>, out: &mut [f64]) {
        let Record { operations, slopes, .. } = self;
        slopes.clear();
        slopes.resize(operations.len(), 0.0);
        for (result, weight) in results.filter(|(result, _)| result.node != CONSTANT) {
            slopes[result.node as usize] += weight;
        }
        for (node, operation) in operations.iter().enumerate().skip(out.len()).rev() {
            let slope = slopes[node];
            // What nothing depends on may have an infinite slope.
            if slope == 0.0 {
                continue;
            }
            for (operand, by) in operation.operands.into_iter().zip(operation.slopes) {
                if operand != CONSTANT {
                    slopes[operand as usize] += slope * by;
                }
            }
        }
        out.copy_from_slice(&slopes[..out.len()]);
    }

    fn places(
        &mut self,
        results: &[Traced],
        inputs: usize,
        most: usize,
    ) -> Option<Vec<[usize; 2]>> {
        let Record { operations, reached, stack, .. } = self;
        reached.clear();
        reached.resize(operations.len(), CONSTANT);
        let (mut places, mut visited) = (Vec::new(), 0);
        for (i, result) in results.iter().enumerate() {
            stack.push(result.node);
            while let Some(node) = stack.pop() {
                if node == CONSTANT || reached[node as usize] == i as u32 {
                    continue;
                }
                visited += 1;
                if visited > most {
                    stack.clear();
                    return None;
                }
                reached[node as usize] = i as u32;
                match (node as usize) < inputs {
                    true => places.push([i, node as usize]),
                    false => stack.extend(operations[node as usize].operands),
                }
            }
        }
        Some(places)
    }
}

impl Traced {
    /// Begins a record, and forgets the one before.
    pub(in crate::core) fn begin() {
        RECORD.with_borrow_mut(|record| record.operations.clear());
    }

    /// An input: all are made before anything is computed, in their order.
    pub(in crate::core) fn input(value: f64) -> Self {
        let node = RECORD.with_borrow_mut(|record| record.add([CONSTANT; 2], [0.0; 2]));
        Traced { re: value, node }
    }

    /// The gradient of a sum of results with these weights by the first inputs.
    pub(in crate::core) fn gradient(results: impl Iterator<Item = (Traced, f64)>, out: &mut [f64]) {
        RECORD.with_borrow_mut(|record| record.gradient(results, out));
    }

    /// The pairs (result, input) where a result depends on one of the first inputs; `None` if finding
    /// them takes more than `most` steps.
    pub(in crate::core) fn places(
        results: &[Traced],
        inputs: usize,
        most: usize,
    ) -> Option<Vec<[usize; 2]>> {
        RECORD.with_borrow_mut(|record| record.places(results, inputs, most))
    }

    fn constant(re: f64) -> Self {
        Traced { re, node: CONSTANT }
    }

    /// A function of this number, with its slope there.
    #[inline]
    fn of_one(&self, re: f64, slope: f64) -> Self {
        self.of_two(&Traced::constant(0.0), re, [slope, 0.0])
    }

    /// A function of two numbers, with its slopes there.
    #[inline]
    fn of_two(&self, other: &Self, re: f64, slopes: [f64; 2]) -> Self {
        let operands = [self.node, other.node];
        if operands == [CONSTANT; 2] {
            return Traced::constant(re);
        }
        Traced { re, node: RECORD.with_borrow_mut(|record| record.add(operands, slopes)) }
    }

    #[inline]
    fn chained(&self, function: Dual64) -> Self {
        self.of_one(function.re, function.eps)
    }

    #[inline]
    fn unit(&self) -> Dual64 {
        Dual64::new(self.re, 1.0)
    }

    #[inline]
    fn product(&self, other: &Self) -> Self {
        self.of_two(other, self.re * other.re, [other.re, self.re])
    }

    #[inline]
    fn quotient(&self, other: &Self) -> Self {
        let inverse = other.re.recip();
        let quotient = self.re * inverse;
        self.of_two(other, quotient, [inverse, -quotient * inverse])
    }
}

number_of_reals!([] Traced, real: |x: &Self| x.re, constant: Self::constant);

impl Neg for Traced {
    type Output = Self;
    #[inline]
    fn neg(self) -> Self {
        self.of_one(-self.re, -1.0)
    }
}

// The remainder of a division is that which is truncated as its real part is.
operations! { [] Traced, |a, b|
    += *a = a.of_two(b, a.re + b.re, [1.0, 1.0]), a.re += b;
    -= *a = a.of_two(b, a.re - b.re, [1.0, -1.0]), a.re -= b;
    *= *a = a.product(b), *a = a.of_one(a.re * b, b);
    /= *a = a.quotient(b), *a = a.of_one(a.re / b, b.recip());
    %= *a -= *b * (a.re / b.re).trunc(), *a %= &Self::from(b);
}

impl Display for Traced {
    fn fmt(&self, f: &mut Formatter<'_>) -> std::fmt::Result {
        write!(f, "{}", self.re)
    }
}

signed_by_reals!([] Traced);

/// Functions of one number by the chain rule.
macro_rules! chained {
    ($($function:ident $(($argument:ident: $kind:ty))?),* $(,)?) => {$(
        #[inline]
        fn $function(&self $(, $argument: $kind)?) -> Self {
            self.chained(DualNum::$function(&self.unit() $(, $argument)?))
        }
    )*};
}

impl DualNum for Traced {
    type Primitive = f64;
    type InnerDual = f64;
    const NDERIV: usize = 1;

    #[inline]
    fn from_re(re: f64) -> Self {
        Traced::constant(re)
    }

    #[inline]
    fn scale(self, factor: &f64) -> Self {
        self * *factor
    }

    fn sin_cos(&self) -> (Self, Self) {
        let (sin, cos) = self.unit().sin_cos();
        (self.chained(sin), self.chained(cos))
    }

    fn atan2(&self, other: Self) -> Self {
        let square = self.re * self.re + other.re * other.re;
        self.of_two(&other, self.re.atan2(other.re), [other.re / square, -self.re / square])
    }

    chained! {
        recip, powi(n: i32), powf(n: f64), sqrt, cbrt, exp, exp2, exp_m1, ln, log(base: f64), log2, log10, ln_1p, sin,
        cos, tan, asin, acos, atan, sinh, cosh, tanh, asinh, acosh, atanh, sph_j0, sph_j1, sph_j2,
    }
}

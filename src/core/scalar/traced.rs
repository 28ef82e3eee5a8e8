//! Numbers that record the operations of a computation; sparsity patterns are determined from the
//! record, and a gradient is computed in one pass through it.

use super::number::{number_of_reals, operations, signed_by_reals};
use num_dual::{Dual64, DualNum};
use std::cell::RefCell;
use std::fmt::{Display, Formatter};
use std::ops::Neg;

/// The node of a number that does not depend on any input.
const CONSTANT: u32 = u32::MAX;

/// A number with its position in the record of operations of the current thread; it is a
/// [`Scalar`](super::Scalar) and is compared by its real part.
///
/// Each operation is recorded together with its partial derivatives. A backward pass through the
/// record computes the gradient of a weighted sum of results with respect to all inputs, at a cost
/// independent of the number of inputs (reverse mode; A. Griewank and A. Walther, *Evaluating
/// Derivatives*, SIAM 2008, ch. 3).
#[derive(Clone, Copy, Debug)]
pub struct Traced {
    re: f64,
    node: u32,
}

/// A recorded operation: its operands, and its derivatives with respect to the operands.
#[derive(Clone, Copy, Debug)]
struct Operation {
    operands: [u32; 2],
    slopes: [f64; 2],
}

/// The operations since the beginning of the record, and scratch space for the backward pass.
#[derive(Default)]
struct Record {
    operations: Vec<Operation>,
    slopes: Vec<f64>,
    /// For each node of the record, the index of the last result from which a search of the
    /// dependencies has reached the node.
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
            // A node without influence on the results may have infinite slopes.
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
    /// Begins a new record for the thread and discards the previous record.
    pub(in crate::core) fn begin() {
        RECORD.with_borrow_mut(|record| record.operations.clear());
    }

    /// Creates an input. All inputs must be created in their order before any computation.
    pub(in crate::core) fn input(value: f64) -> Self {
        let node = RECORD.with_borrow_mut(|record| record.add([CONSTANT; 2], [0.0; 2]));
        Traced { re: value, node }
    }

    /// Computes the gradient of a weighted sum of results with respect to the first inputs of the
    /// record, one input for each element of `out`.
    pub(in crate::core) fn gradient(results: impl Iterator<Item = (Traced, f64)>, out: &mut [f64]) {
        RECORD.with_borrow_mut(|record| record.gradient(results, out));
    }

    /// Returns all pairs (result, input) in which the result depends on the input, but only for the
    /// first `inputs` inputs; `None` if the search takes more than `most` steps.
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

    /// Records a function of this number, with the derivative of the function.
    #[inline]
    fn of_one(&self, re: f64, slope: f64) -> Self {
        self.of_two(&Traced::constant(0.0), re, [slope, 0.0])
    }

    /// Records a function of two numbers, with its partial derivatives.
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

// The remainder of a division uses the quotient truncated by its real part.
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

/// Implements functions of one number by the chain rule.
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

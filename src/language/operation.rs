//! The operations in formulas, with their names and their values.

use super::elementary;
use crate::core::scalar::Scalar;

/// The smoothness of an operation: how its value depends on its arguments.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Sort {
    /// The value is given by one smooth formula.
    Smooth,
    /// The value is given by one of several smooth formulas; a comparison of numbers selects the
    /// formula.
    Chosen,
    /// The value is a discontinuous function of the arguments.
    Jumping,
}

/// A function that formulas can call.
pub(super) struct Function {
    pub name: &'static str,
    pub operation: Operation,
    /// Whether XPPAUT supports the function, too.
    pub of_xpp: bool,
}

/// Declares the operations: the sort of each operation, its value, and its names as a function in
/// formulas; `xpp` follows a name that XPPAUT uses, too.
macro_rules! operations {
    ($(
        $(#[$docs:meta])*
        $sort:ident $operation:ident($($argument:ident),+) = $value:expr $(, $name:literal $($xpp:ident)?)*;
    )*) => {
        /// An operation that one step of a tape applies to the values of its arguments.
        #[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
        pub(super) enum Operation {
            $($(#[$docs])* $operation,)*
        }

        /// The functions.
        pub(super) const FUNCTIONS: &[Function] = &[$($(Function {
            name: $name,
            operation: Operation::$operation,
            of_xpp: operations!(@of_xpp $($xpp)?),
        },)*)*];

        impl Operation {
            /// Returns the name of the operation in formulas; for an operation without such a name,
            /// returns a description for messages.
            pub fn name(self) -> &'static str {
                let function = FUNCTIONS.iter().find(|function| function.operation == self);
                match (self, function) {
                    (_, Some(function)) => function.name,
                    $((Operation::$operation, _) => stringify!($operation),)*
                }
            }

            /// Returns the number of arguments of the operation.
            pub fn arity(self) -> usize {
                match self {
                    $(Operation::$operation => [$(stringify!($argument)),+].len(),)*
                }
            }

            fn sort(self) -> Sort {
                match self {
                    $(Operation::$operation => Sort::$sort,)*
                }
            }

            /// Returns the value.
            #[inline(always)]
            pub fn of<T: Scalar>(self, a: &T, b: &T, c: &T) -> T {
                match self {
                    $(Operation::$operation => {
                        operations!(@bind [a, b, c] $($argument),+);
                        $value
                    })*
                }
            }
        }
    };
    (@of_xpp) => { false };
    (@of_xpp xpp) => { true };
    (@bind [$a:ident, $b:ident, $c:ident] $x:ident) => { let $x = *$a; let _ = ($b, $c); };
    (@bind [$a:ident, $b:ident, $c:ident] $x:ident, $y:ident) => { let ($x, $y) = (*$a, *$b); let _ = $c; };
    (@bind [$a:ident, $b:ident, $c:ident] $x:ident, $y:ident, $z:ident) => { let ($x, $y, $z) = (*$a, *$b, *$c); };
}

operations! {
    Smooth Add(a, b) = a + b;
    Smooth Subtract(a, b) = a - b;
    Smooth Multiply(a, b) = a * b;
    Smooth Divide(a, b) = a / b;
    Smooth Negate(a) = -a;
    /// The power `a^b`; integer powers are computed as products, which is faster and exact, and
    /// constant exponents have separate kinds of steps.
    Chosen Power(a, b) = power(&a, &b), "pow";
    Chosen Less(a, b) = truth(a.real() < b.real());
    Chosen AtMost(a, b) = truth(a.real() <= b.real());
    Chosen More(a, b) = truth(a.real() > b.real());
    Chosen AtLeast(a, b) = truth(a.real() >= b.real());
    Chosen Equal(a, b) = truth(a.real() == b.real());
    Chosen Unequal(a, b) = truth(a.real() != b.real());
    Chosen And(a, b) = truth(a.real() != 0.0 && b.real() != 0.0);
    Chosen Or(a, b) = truth(a.real() != 0.0 || b.real() != 0.0);
    Chosen Not(a) = truth(a.real() == 0.0), "not";
    /// The second argument if the first argument is not zero, and otherwise the third argument.
    Chosen Select(c, a, b) = if c.real() != 0.0 { a } else { b };
    Chosen Minimum(a, b) = if b.real() < a.real() { b } else { a }, "min" xpp;
    Chosen Maximum(a, b) = if b.real() > a.real() { b } else { a }, "max" xpp;
    Chosen Absolute(a) = if a.real() < 0.0 { -a } else { a }, "abs" xpp;
    /// The sign of the argument: −1, 0 or 1.
    Jumping Sign(a) = constant(if a.real() == 0.0 { 0.0 } else { a.real().signum() }), "sign" xpp, "sgn", "signum";
    /// The Heaviside step function: 0 for negative arguments, otherwise 1.
    Jumping Heaviside(a) = truth(a.real() >= 0.0), "heaviside", "heav" xpp;
    Jumping Floor(a) = constant(a.real().floor()), "floor", "flr" xpp;
    Jumping Ceiling(a) = constant(a.real().ceil()), "ceil";
    Jumping Round(a) = constant(a.real().round()), "round";
    /// The remainder `a − b ⌊a/b⌋`.
    Jumping Modulo(a, b) = a - b * (a.real() / b.real()).floor(), "mod" xpp;
    Smooth Square(a) = a * a;
    Smooth Cube(a) = a * a * a;
    Smooth Reciprocal(a) = elementary::recip(&a), "recip";
    Smooth SquareRoot(a) = elementary::sqrt(&a), "sqrt" xpp;
    Smooth CubeRoot(a) = elementary::cbrt(&a), "cbrt";
    Smooth Exponential(a) = elementary::exp(&a), "exp" xpp;
    Smooth Exponential2(a) = elementary::exp2(&a), "exp2";
    Smooth ExponentialLessOne(a) = elementary::exp_m1(&a), "exp_m1", "expm1";
    Smooth Logarithm(a) = elementary::ln(&a), "ln" xpp, "log" xpp;
    Smooth Logarithm2(a) = elementary::log2(&a), "log2";
    Smooth Logarithm10(a) = elementary::log10(&a), "log10" xpp;
    Smooth LogarithmOfOnePlus(a) = elementary::ln_1p(&a), "ln_1p", "log1p";
    Smooth Sine(a) = elementary::sin(&a), "sin" xpp;
    Smooth Cosine(a) = elementary::cos(&a), "cos" xpp;
    Smooth Tangent(a) = elementary::tan(&a), "tan" xpp;
    Smooth ArcSine(a) = elementary::asin(&a), "asin" xpp;
    Smooth ArcCosine(a) = elementary::acos(&a), "acos" xpp;
    Smooth ArcTangent(a) = elementary::atan(&a), "atan" xpp;
    Smooth ArcTangent2(a, b) = elementary::atan2(&a, &b), "atan2" xpp;
    Smooth HyperbolicSine(a) = elementary::sinh(&a), "sinh" xpp;
    Smooth HyperbolicCosine(a) = elementary::cosh(&a), "cosh" xpp;
    Chosen HyperbolicTangent(a) = hyperbolic_tangent(&a), "tanh" xpp;
    Smooth AreaSine(a) = elementary::asinh(&a), "asinh";
    Smooth AreaCosine(a) = elementary::acosh(&a), "acosh";
    Smooth AreaTangent(a) = elementary::atanh(&a), "atanh";
    Chosen Hypotenuse(a, b) = hypotenuse(&a, &b), "hypot";
}

impl Operation {
    /// Returns whether the value of the operation is a discontinuous function of its arguments.
    pub fn jumps(self) -> bool {
        self.sort() == Sort::Jumping
    }

    /// Returns whether the value depends on a comparison; if it does, a batch of motions with
    /// different results of the comparison cannot be evaluated together.
    pub fn decides(self) -> bool {
        self.sort() != Sort::Smooth
    }
}

/// Returns the function with a given name in formulas.
pub(super) fn function(name: &str) -> Option<&'static Function> {
    FUNCTIONS.iter().find(|function| function.name == name)
}

fn constant<T: Scalar>(value: f64) -> T {
    T::constant(value)
}

fn truth<T: Scalar>(holds: bool) -> T {
    constant(if holds { 1.0 } else { 0.0 })
}

/// Computes `√(a² + b²)`; if the value of `f64::hypot` is infinite or zero, the result equals this
/// value.
fn hypotenuse<T: Scalar>(a: &T, b: &T) -> T {
    let scale = a.real().abs().max(b.real().abs());
    if scale == 0.0 || !scale.is_finite() {
        return constant(scale);
    }
    let [a, b] = [*a / scale, *b / scale];
    elementary::sqrt(&(a * a + b * b)) * scale
}

/// Computes `tanh a`, for larger arguments from `e^{−2|a|}`: the quotient of `sinh` and `cosh` and
/// the derivative of this quotient are undefined where both functions overflow, as in friction laws
/// `tanh(v/ε)`.
fn hyperbolic_tangent<T: Scalar>(a: &T) -> T {
    let sign = a.real().signum();
    if a.real().abs() < 1.0 || a.real().is_nan() {
        return elementary::tanh(a);
    }
    let rest = elementary::exp(&(*a * (-2.0 * sign)));
    (-rest + 1.0) / (rest + 1.0) * sign
}

/// Computes `a^b`. For a base `a` that is not positive, only integer exponents `b` are allowed.
fn power<T: Scalar>(a: &T, b: &T) -> T {
    let exponent = b.real();
    if a.real() > 0.0 {
        return elementary::exp(&(elementary::ln(a) * b));
    }
    if exponent.fract() != 0.0 && a.real() != 0.0 {
        return constant(f64::NAN);
    }
    if exponent.fract() == 0.0 && exponent.abs() <= i32::MAX as f64 {
        return elementary::powi(a, exponent as i32);
    }
    elementary::powf(a, exponent)
}

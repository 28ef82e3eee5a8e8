//! The operations of formulas: what they are called, and what they do to numbers.

use super::elementary;
use crate::core::scalar::Scalar;

/// Declares the operations, with the names of those that are called as functions and their values.
macro_rules! operations {
    ($(
        $(#[$docs:meta])*
        $operation:ident($($argument:ident),+) = $value:expr $(, $name:literal)*;
    )*) => {
        /// The operation of a step of a tape on the values of its arguments.
        #[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
        pub(super) enum Operation {
            $($(#[$docs])* $operation,)*
        }

        /// The names of functions, with their operations.
        pub(super) const FUNCTIONS: &[(&str, Operation)] = &[$($(($name, Operation::$operation),)*)*];

        impl Operation {
            /// The name in formulas; of what has none there, one for messages.
            pub fn name(self) -> &'static str {
                let function = FUNCTIONS.iter().find(|(_, operation)| *operation == self);
                match (self, function) {
                    (_, Some((name, _))) => name,
                    $((Operation::$operation, _) => stringify!($operation),)*
                }
            }

            /// How many arguments it has.
            pub fn arity(self) -> usize {
                match self {
                    $(Operation::$operation => [$(stringify!($argument)),+].len(),)*
                }
            }

            /// Its value.
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
    (@bind [$a:ident, $b:ident, $c:ident] $x:ident) => { let $x = *$a; let _ = ($b, $c); };
    (@bind [$a:ident, $b:ident, $c:ident] $x:ident, $y:ident) => { let ($x, $y) = (*$a, *$b); let _ = $c; };
    (@bind [$a:ident, $b:ident, $c:ident] $x:ident, $y:ident, $z:ident) => { let ($x, $y, $z) = (*$a, *$b, *$c); };
}

operations! {
    Add(a, b) = a + b;
    Subtract(a, b) = a - b;
    Multiply(a, b) = a * b;
    Divide(a, b) = a / b;
    Negate(a) = -a;
    /// A product of integer powers is faster and exact: constant exponents have steps of their own.
    Power(a, b) = power(&a, &b), "pow";
    Less(a, b) = truth(a.real() < b.real());
    AtMost(a, b) = truth(a.real() <= b.real());
    More(a, b) = truth(a.real() > b.real());
    AtLeast(a, b) = truth(a.real() >= b.real());
    Equal(a, b) = truth(a.real() == b.real());
    Unequal(a, b) = truth(a.real() != b.real());
    And(a, b) = truth(a.real() != 0.0 && b.real() != 0.0);
    Or(a, b) = truth(a.real() != 0.0 || b.real() != 0.0);
    Not(a) = truth(a.real() == 0.0), "not";
    /// The second value where the first is not zero, else the third.
    Select(c, a, b) = if c.real() != 0.0 { a } else { b };
    Minimum(a, b) = if b.real() < a.real() { b } else { a }, "min";
    Maximum(a, b) = if b.real() > a.real() { b } else { a }, "max";
    Absolute(a) = if a.real() < 0.0 { -a } else { a }, "abs";
    /// −1, 0 or 1.
    Sign(a) = constant(if a.real() == 0.0 { 0.0 } else { a.real().signum() }), "sign", "sgn", "signum";
    /// 0 before zero, else 1.
    Heaviside(a) = truth(a.real() >= 0.0), "heaviside", "heav";
    Floor(a) = constant(a.real().floor()), "floor", "flr";
    Ceiling(a) = constant(a.real().ceil()), "ceil";
    Round(a) = constant(a.real().round()), "round";
    /// `a − b ⌊a/b⌋`.
    Modulo(a, b) = a - b * (a.real() / b.real()).floor(), "mod";
    Square(a) = a * a;
    Cube(a) = a * a * a;
    Reciprocal(a) = elementary::recip(&a), "recip";
    SquareRoot(a) = elementary::sqrt(&a), "sqrt";
    CubeRoot(a) = elementary::cbrt(&a), "cbrt";
    Exponential(a) = elementary::exp(&a), "exp";
    Exponential2(a) = elementary::exp2(&a), "exp2";
    ExponentialLessOne(a) = elementary::exp_m1(&a), "exp_m1", "expm1";
    Logarithm(a) = elementary::ln(&a), "ln", "log";
    Logarithm2(a) = elementary::log2(&a), "log2";
    Logarithm10(a) = elementary::log10(&a), "log10";
    LogarithmOfOnePlus(a) = elementary::ln_1p(&a), "ln_1p", "log1p";
    Sine(a) = elementary::sin(&a), "sin";
    Cosine(a) = elementary::cos(&a), "cos";
    Tangent(a) = elementary::tan(&a), "tan";
    ArcSine(a) = elementary::asin(&a), "asin";
    ArcCosine(a) = elementary::acos(&a), "acos";
    ArcTangent(a) = elementary::atan(&a), "atan";
    ArcTangent2(a, b) = elementary::atan2(&a, &b), "atan2";
    HyperbolicSine(a) = elementary::sinh(&a), "sinh";
    HyperbolicCosine(a) = elementary::cosh(&a), "cosh";
    HyperbolicTangent(a) = hyperbolic_tangent(&a), "tanh";
    AreaSine(a) = elementary::asinh(&a), "asinh";
    AreaCosine(a) = elementary::acosh(&a), "acosh";
    AreaTangent(a) = elementary::atanh(&a), "atanh";
    Hypotenuse(a, b) = hypotenuse(&a, &b), "hypot";
}

/// Functions of several names, in other programs written so.
impl Operation {
    /// Whether its value jumps from one number to another.
    pub fn jumps(self) -> bool {
        use Operation::*;
        matches!(self, Sign | Heaviside | Floor | Ceiling | Round | Modulo)
    }

    /// Whether its value is chosen by a comparison, so that one evaluation cannot be right for
    /// several motions at once.
    pub fn decides(self) -> bool {
        use Operation::*;
        matches!(
            self,
            Power
                | Less
                | AtMost
                | More
                | AtLeast
                | Equal
                | Unequal
                | And
                | Or
                | Not
                | Select
                | Minimum
                | Maximum
                | Absolute
                | Sign
                | Heaviside
                | Floor
                | Ceiling
                | Round
                | Modulo
                | HyperbolicTangent
                | Hypotenuse
        )
    }
}

fn constant<T: Scalar>(value: f64) -> T {
    T::constant(value)
}

fn truth<T: Scalar>(holds: bool) -> T {
    constant(if holds { 1.0 } else { 0.0 })
}

/// `√(a² + b²)`, with the value of `f64::hypot` where that is infinite or zero.
fn hypotenuse<T: Scalar>(a: &T, b: &T) -> T {
    let scale = a.real().abs().max(b.real().abs());
    if scale == 0.0 || !scale.is_finite() {
        return constant(scale);
    }
    let [a, b] = [*a / scale, *b / scale];
    elementary::sqrt(&(a * a + b * b)) * scale
}

/// `tanh a`: by `e^{−2|a|}` away from zero, since the quotient of `sinh` and `cosh` has no value,
/// nor derivative, where these are infinite, as in friction laws `tanh(v/ε)`.
fn hyperbolic_tangent<T: Scalar>(a: &T) -> T {
    let sign = a.real().signum();
    if a.real().abs() < 1.0 || a.real().is_nan() {
        return elementary::tanh(a);
    }
    let rest = elementary::exp(&(*a * (-2.0 * sign)));
    (-rest + 1.0) / (rest + 1.0) * sign
}

/// `a^b`. Of numbers that are not positive there are only integer powers.
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

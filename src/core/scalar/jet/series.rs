//! Taylor series of the elementary functions at a real number, one function per name.

use super::taylor;
use super::taylor::Series;
use std::f64::consts::{LN_2, LN_10};

/// Defines functions that return the Taylor series of an elementary function at a real number `a`.
macro_rules! series {
    ($a:ident: $($function:ident = $series:expr;)*) => {$(
        pub fn $function($a: f64) -> Series {
            $series
        }
    )*};
}

series! { a:
    recip = taylor::power(a.recip(), a, -1.0);
    sqrt = taylor::power(a.sqrt(), a, 0.5);
    cbrt = taylor::power(a.cbrt(), a, 1.0 / 3.0);
    exp = taylor::exp(a);
    exp_m1 = taylor::of_value(a.exp_m1(), taylor::exp(a));
    ln = taylor::ln(a.ln(), a);
    ln_1p = taylor::ln(a.ln_1p(), 1.0 + a);
    sin = taylor::sin_cos(a)[0];
    cos = taylor::sin_cos(a)[1];
    tan = taylor::tangent(a.tan(), 1.0);
    asin = taylor::inverse(a.asin(), a, 1.0, [1.0, -1.0, -0.5]);
    acos = taylor::inverse(a.acos(), a, -1.0, [1.0, -1.0, -0.5]);
    atan = taylor::inverse(a.atan(), a, 1.0, [1.0, 1.0, -1.0]);
    sinh = taylor::sinh_cosh(a)[0];
    cosh = taylor::sinh_cosh(a)[1];
    tanh = taylor::tangent(a.tanh(), -1.0);
    asinh = taylor::inverse(a.asinh(), a, 1.0, [1.0, 1.0, -0.5]);
    acosh = taylor::inverse(a.acosh(), a, 1.0, [-1.0, 1.0, -0.5]);
    atanh = taylor::inverse(a.atanh(), a, 1.0, [1.0, -1.0, -1.0]);
    exp2 = taylor::of_value(a.exp2(), taylor::stretched(taylor::exp(a * LN_2), LN_2));
    log2 = taylor::of_value(a.log2(), taylor::ln(a.ln(), a).map(|f| f / LN_2));
    log10 = taylor::of_value(a.log10(), taylor::ln(a.ln(), a).map(|f| f / LN_10));
}

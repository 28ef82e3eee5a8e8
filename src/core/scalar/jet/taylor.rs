//! Taylor coefficients `f⁽ᵏ⁾(a)/k!` of elementary functions at a real number, by recurrence.

pub(crate) use super::space::MOST_ORDER;

/// The Taylor coefficients of a function up to the highest order of jets.
pub(crate) type Series = [f64; MOST_ORDER + 1];

/// Computes a Taylor series, given its first coefficient; `next` computes coefficient `k + 1` from
/// the coefficients up to `k`.
fn continued(first: f64, next: impl Fn(usize, &Series) -> f64) -> Series {
    let mut f = [0.0; MOST_ORDER + 1];
    f[0] = first;
    for k in 0..MOST_ORDER {
        f[k + 1] = next(k, &f);
    }
    f
}

/// Returns the series of the integral of `f`, given the integral's value at the expansion point.
fn integral(value: f64, f: &Series) -> Series {
    continued(value, |k, _| f[k] / (k + 1) as f64)
}

/// Returns the series of `exp a`.
pub(super) fn exp(a: f64) -> Series {
    continued(a.exp(), |k, f| f[k] / (k + 1) as f64)
}

/// Returns the series of `aʳ`, given the value of `aʳ`.
pub(super) fn power(value: f64, a: f64, r: f64) -> Series {
    continued(value, |k, f| f[k] * (r - k as f64) / ((k + 1) as f64 * a))
}

/// Returns the series of `aʳ` for any `a`; at `a = 0` the coefficients are computed from binomial
/// coefficients, since the derivatives up to the order `r` exist.
pub(crate) fn real_power(a: f64, r: f64) -> Series {
    if a != 0.0 {
        return power(a.powf(r), a, r);
    }
    let mut binomial = 1.0;
    std::array::from_fn(|k| {
        let f = if binomial == 0.0 { 0.0 } else { binomial * a.powf(r - k as f64) };
        binomial *= (r - k as f64) / (k + 1) as f64;
        f
    })
}

/// Returns the series of `f(ca)` in powers of the change of `a`, given the series of `f` at `ca`.
pub(super) fn stretched(f: Series, c: f64) -> Series {
    let mut power = 1.0 / c;
    f.map(|f| {
        power *= c;
        f * power
    })
}

/// Returns the series of `ln a`, or of a function that differs from `ln a` by a constant, given the
/// value of the function.
pub(super) fn ln(value: f64, a: f64) -> Series {
    integral(value, &power(a.recip(), a, -1.0))
}

/// Returns the series of a function whose successive derivatives repeat the given values
/// cyclically.
fn cycle<const P: usize>(values: [f64; P]) -> Series {
    let mut factorial = 1.0;
    std::array::from_fn(|k| {
        factorial *= k.max(1) as f64;
        values[k % P] / factorial
    })
}

/// Returns the series of `sin a` and `cos a`.
pub(crate) fn sin_cos(a: f64) -> [Series; 2] {
    let (sin, cos) = a.sin_cos();
    [cycle([sin, cos, -sin, -cos]), cycle([cos, -sin, -cos, sin])]
}

/// Returns the series of `sinh a` and `cosh a`.
pub(super) fn sinh_cosh(a: f64) -> [Series; 2] {
    let (sinh, cosh) = (a.sinh(), a.cosh());
    [cycle([sinh, cosh]), cycle([cosh, sinh])]
}

/// Returns the series of the solution of `f' = 1 + s f²`: `tan` for `s = 1`, `tanh` for `s = −1`.
pub(super) fn tangent(value: f64, s: f64) -> Series {
    continued(value, |k, f| {
        let square: f64 = (0..=k).map(|i| f[i] * f[k - i]).sum();
        (f64::from(u8::from(k == 0)) + s * square) / (k + 1) as f64
    })
}

/// Replaces the first coefficient of a series by a more accurate value of the function.
pub(super) fn of_value(value: f64, mut f: Series) -> Series {
    f[0] = value;
    f
}

/// Returns the series at `a` of a function whose derivative is `factor · (c + s x²)ʳ`, given the
/// value of the function. All inverse circular and hyperbolic functions have derivatives of this
/// form.
pub(super) fn inverse(value: f64, a: f64, factor: f64, [c, s, r]: [f64; 3]) -> Series {
    let p = [c + s * a * a, 2.0 * s * a, s];
    let slope = continued(p[0].powf(r), |k, b| {
        let term = |j: usize| (r * j as f64 - (k + 1 - j) as f64) * p[j] * b[k + 1 - j];
        let second = if k == 0 { 0.0 } else { term(2) };
        (term(1) + second) / ((k + 1) as f64 * p[0])
    });
    of_value(value, integral(0.0, &slope).map(|f| f * factor))
}

//! Elementary functions of jets.

use super::number::Jet;
use super::taylor;

impl<const C: usize> Jet<C> {
    pub(super) fn reciprocal(&self) -> Self {
        let a = self.c[0];
        self.composed(&taylor::power(a.recip(), a, -1.0))
    }

    pub(super) fn power_real(&self, r: f64) -> Self {
        let a = self.c[0];
        self.composed(&taylor::power(a.powf(r), a, r))
    }

    /// By repeated squares, so that nothing is divided by.
    pub(super) fn power_integer(&self, n: i32) -> Self {
        let (mut rest, mut square, mut power) = (n.unsigned_abs(), *self, Jet::constant(1.0));
        while rest > 0 {
            if rest % 2 == 1 {
                power *= &square;
            }
            rest /= 2;
            if rest > 0 {
                square *= square;
            }
        }
        if n < 0 { power.reciprocal() } else { power }
    }

    pub(super) fn square_root(&self) -> Self {
        let a = self.c[0];
        self.composed(&taylor::power(a.sqrt(), a, 0.5))
    }

    pub(super) fn cubic_root(&self) -> Self {
        let a = self.c[0];
        self.composed(&taylor::power(a.cbrt(), a, 1.0 / 3.0))
    }

    pub(super) fn exponential(&self) -> Self {
        self.composed(&taylor::exp(self.c[0]))
    }

    /// `eˣ − 1`.
    pub(super) fn exponential_less_one(&self) -> Self {
        let mut series = taylor::exp(self.c[0]);
        series[0] = self.c[0].exp_m1();
        self.composed(&series)
    }

    pub(super) fn logarithm(&self) -> Self {
        let a = self.c[0];
        self.composed(&taylor::ln(a.ln(), a))
    }

    /// `ln(1 + x)`.
    pub(super) fn logarithm_of_more(&self) -> Self {
        let a = self.c[0];
        self.composed(&taylor::ln(a.ln_1p(), 1.0 + a))
    }

    pub(super) fn circular(&self) -> (Self, Self) {
        let [sin, cos] = taylor::sin_cos(self.c[0]);
        (self.composed(&sin), self.composed(&cos))
    }

    pub(super) fn hyperbolic(&self) -> (Self, Self) {
        let [sinh, cosh] = taylor::sinh_cosh(self.c[0]);
        (self.composed(&sinh), self.composed(&cosh))
    }

    /// The tangent for `s = 1`, the hyperbolic one for `s = −1`, given its value.
    pub(super) fn tangent(&self, value: f64, s: f64) -> Self {
        self.composed(&taylor::tangent(value, s))
    }

    /// A function with the derivative `factor · (c + s x²)ʳ`, given its value.
    pub(super) fn inverse(&self, value: f64, factor: f64, [c, s, r]: [f64; 3]) -> Self {
        let a = self.c[0];
        let mut series = taylor::integral_of_power(0.0, [c + s * a * a, 2.0 * s * a, s], r);
        series.iter_mut().for_each(|f| *f *= factor);
        series[0] = value;
        self.composed(&series)
    }

    pub(super) fn arctangent(&self) -> Self {
        self.inverse(self.c[0].atan(), 1.0, [1.0, 1.0, -1.0])
    }

    /// The angle of the point `(x, y)` by the quotient that is at most 1 in size; `self` is `y`.
    pub(super) fn angle(&self, x: &Self) -> Self {
        let value = self.c[0].atan2(x.c[0]);
        let mut angle = match self.c[0].abs() <= x.c[0].abs() {
            true => (*self / x).arctangent(),
            false => -(*x / self).arctangent(),
        };
        angle.c[0] = value;
        angle
    }

    /// The spherical Bessel function `j_n`, `n ≤ 2`: by its power series near 0 (DLMF 10.53.1), in closed
    /// form elsewhere (DLMF 10.49.3).
    pub(super) fn spherical_bessel(&self, n: i32) -> Self {
        let x = *self;
        if x.c[0].abs() < 1.0 {
            let half = x * x * -0.5;
            let mut sum = Jet::constant(0.0);
            for k in (0..12).rev() {
                // 1 / (2n + 2k + 1)!! and 1 / k!, one factor at a time.
                sum = sum * half / (f64::from(k + 1) * f64::from(2 * n + 2 * k + 3)) + 1.0;
            }
            let first: f64 = (0..=n).map(|k| f64::from(2 * k + 1)).product();
            return sum * x.power_integer(n) / first;
        }
        let (sin, cos) = x.circular();
        match n {
            0 => sin / x,
            1 => (sin / x - cos) / x,
            _ => ((sin * 3.0 / x - cos * 3.0) / x - sin) / x,
        }
    }
}

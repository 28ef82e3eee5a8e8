//! The vector fields of AUTO's demos, with the parameter values that the demos begin with.

use std::f64::consts::{PI, TAU};
use tangency::core::problem::{Names, VectorField};
use tangency::core::scalar::Scalar;

/// A vector field from its states, its parameters with their values, and its right side.
macro_rules! field {
    ($(#[$doc:meta])* $name:ident, [$($state:expr),*], [$($parameter:expr => $value:expr),*], |$x:ident, $p:ident, $f:ident| $body:block) => {
        $(#[$doc])*
        #[derive(Clone, Copy)]
        pub struct $name;

        impl VectorField for $name {
            fn names(&self) -> Names {
                Names::new([$($state),*], [$($parameter),*])
            }
            fn defaults(&self) -> Vec<f64> {
                vec![$($value),*]
            }
            fn field<T: Scalar>(&self, _t: T, $x: &[T], $p: &[T], $f: &mut [T]) $body
        }
    };
}

field!(
    /// `ab`: two reactions A → B → C in a stirred tank.
    Ab, ["u1", "u2"], ["D" => 0.0, "B" => 14.0], |x, p, f| {
        let r = p[0] * (T::one() - x[0]) * x[1].exp();
        f[0] = r - x[0];
        f[1] = p[1] * r - x[1] * 4.0;
    }
);

field!(
    /// `pp2`: a predator and its prey, which is harvested.
    Pp2, ["u", "v"], ["p" => 0.0], |x, p, f| {
        let (u, v) = (x[0], x[1]);
        f[0] = u * 3.0 * (T::one() - u) - u * v - p[0] * (T::one() - (u * -5.0).exp());
        f[1] = u * v * 3.0 - v;
    }
);

field!(
    /// `ppp`: a predator, its prey, and a predator of both.
    Ppp, ["u", "v", "w"], ["p" => 0.0, "p4" => 3.0], |x, p, f| {
        let (u, v, w) = (x[0], x[1], x[2]);
        f[0] = u * (T::one() - u) - p[1] * u * v;
        f[1] = v * -0.25 + p[1] * u * v - v * w * 3.0 - p[0] * (T::one() - (v * -5.0).exp());
        f[2] = w * -0.5 + v * w * 3.0;
    }
);

field!(
    /// `abc`: three reactions A → B → C → D.
    Abc, ["u1", "u2", "u3"], ["D" => 0.0, "beta" => 1.55], |x, p, f| {
        let (c, e) = (T::one() - x[0], x[2].exp());
        f[0] = p[0] * c * e - x[0];
        f[1] = p[0] * e * (c - x[1] * 0.04) - x[1];
        f[2] = p[0] * e * (c + x[1] * 0.04) * 8.0 - (p[1] + 1.0) * x[2];
    }
);

field!(
    /// `plp`: an enzyme whose substrate inhibits it.
    Plp, ["S", "A"], ["rho" => 2.021628, "S0" => 110.0], |x, p, f| {
        let r = p[0] * x[0] * x[1] / (T::one() + x[0] + x[0] * x[0] * 0.1);
        f[0] = p[1] - x[0] - r;
        f[1] = (-x[1] + 500.0) * 0.2 - r;
    }
);

field!(
    /// `enz`: two coupled cells with the same enzyme.
    Enz, ["s1", "s2"], ["s0" => 0.0], |x, p, f| {
        let rate = |s: T| s * 100.0 / (T::one() + s + s * s);
        f[0] = p[0] - x[0] + (x[1] - x[0]) - rate(x[0]);
        f[1] = p[0] - x[1] + (x[0] - x[1]) - rate(x[1]);
    }
);

field!(
    /// `chu`: Chua's circuit with a smooth resistor.
    Chu, ["x", "y", "z"], ["alpha" => 5.0], |x, p, f| {
        let modulus = |s: T| s * 2.0 * (s * 10.0).atan() / PI;
        let h = x[0] * (2.0 / 7.0) - (modulus(x[0] + 1.0) - modulus(x[0] - 1.0)) * (3.0 / 14.0);
        f[0] = p[0] * (x[1] - h);
        f[1] = x[0] - x[1] + x[2];
        f[2] = x[1] * -14.3;
    }
);

field!(
    /// `cusp`: the normal form.
    Cusp, ["x"], ["mu" => 0.0, "lambda" => 1.0], |x, p, f| {
        f[0] = p[0] + p[1] * x[0] - x[0].powi(3);
    }
);

field!(
    /// `vhb`: a vertical family of cycles from a Hopf point.
    Vhb, ["u", "v"], ["p" => -0.5], |x, p, f| {
        f[0] = p[0] * x[0] - x[1];
        f[1] = x[0] * (T::one() - x[0]);
    }
);

field!(
    /// `lor`: Lorenz' equations.
    Lor, ["x", "y", "z"], ["rho" => 280.0, "b" => 8.0 / 3.0, "sigma" => 10.0], |x, p, f| {
        f[0] = p[2] * (x[1] - x[0]);
        f[1] = p[0] * x[0] - x[1] - x[0] * x[2];
        f[2] = x[0] * x[1] - p[1] * x[2];
    }
);

field!(
    /// `frc`: FitzHugh–Nagumo equations forced by an oscillator.
    Frc, ["v", "w", "x", "y"], ["r" => 0.0, "beta" => 100.0], |x, p, f| {
        let s = x[2] * x[2] + x[3] * x[3];
        f[0] = (x[0] * (x[0] - 0.5) * (T::one() - x[0]) - x[1]) / 0.005;
        f[1] = x[0] - x[1] - (p[0] * x[2] + 0.5);
        f[2] = x[2] + p[1] * x[3] - x[2] * s;
        f[3] = x[3] - p[1] * x[2] - x[3] * s;
    }
);

field!(
    /// `lcbp`: two families of circles that cross.
    Lcbp, ["x", "y"], ["p1" => 1.0, "p2" => 2.0, "p3" => 0.0], |x, p, f| {
        let r2 = x[0] * x[0] + x[1] * x[1];
        let g = -(r2 - (p[0] + p[1]) * r2.sqrt() + p[0] * p[1] + p[2]);
        f[0] = x[0] * g - x[1] * TAU;
        f[1] = x[1] * g + x[0] * TAU;
    }
);

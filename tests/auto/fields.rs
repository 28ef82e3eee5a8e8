//! The vector fields of AUTO's demos, with the parameter values that the demos begin with.

use std::f64::consts::{PI, TAU};
use tangency::vector_field;

vector_field! {
    /// `ab`: two reactions A → B → C in a stirred tank.
    pub struct Ab [u1, u2; D = 0.0, B = 14.0] {
        let r = D * (T::one() - u1) * u2.exp();
        d/dt u1 = r - u1;
        d/dt u2 = B * r - u2 * 4.0;
    }
}

vector_field! {
    /// `pp2`: a predator and its prey, which is harvested.
    pub struct Pp2 [u, v; p = 0.0] {
        d/dt u = u * 3.0 * (T::one() - u) - u * v - p * (T::one() - (u * -5.0).exp());
        d/dt v = u * v * 3.0 - v;
    }
}

vector_field! {
    /// `ppp`: a predator, its prey, and a predator of both.
    pub struct Ppp [u, v, w; p = 0.0, p4 = 3.0] {
        d/dt u = u * (T::one() - u) - p4 * u * v;
        d/dt v = v * -0.25 + p4 * u * v - v * w * 3.0 - p * (T::one() - (v * -5.0).exp());
        d/dt w = w * -0.5 + v * w * 3.0;
    }
}

vector_field! {
    /// `abc`: three reactions A → B → C → D.
    pub struct Abc [u1, u2, u3; D = 0.0, beta = 1.55] {
        let (c, e) = (T::one() - u1, u3.exp());
        d/dt u1 = D * c * e - u1;
        d/dt u2 = D * e * (c - u2 * 0.04) - u2;
        d/dt u3 = D * e * (c + u2 * 0.04) * 8.0 - (beta + 1.0) * u3;
    }
}

vector_field! {
    /// `plp`: an enzyme whose substrate inhibits it.
    pub struct Plp [S, A; rho = 2.021628, S0 = 110.0] {
        let r = rho * S * A / (T::one() + S + S * S * 0.1);
        d/dt S = S0 - S - r;
        d/dt A = (-A + 500.0) * 0.2 - r;
    }
}

vector_field! {
    /// `enz`: two coupled cells with the same enzyme.
    pub struct Enz [s1, s2; s0 = 0.0] {
        let rate = |s: T| s * 100.0 / (T::one() + s + s * s);
        d/dt s1 = s0 - s1 + (s2 - s1) - rate(s1);
        d/dt s2 = s0 - s2 + (s1 - s2) - rate(s2);
    }
}

vector_field! {
    /// `chu`: Chua's circuit with a smooth resistor.
    pub struct Chu [x, y, z; alpha = 5.0] {
        let modulus = |s: T| s * 2.0 * (s * 10.0).atan() / PI;
        let h = x * (2.0 / 7.0) - (modulus(x + 1.0) - modulus(x - 1.0)) * (3.0 / 14.0);
        d/dt x = alpha * (y - h);
        d/dt y = x - y + z;
        d/dt z = y * -14.3;
    }
}

vector_field! {
    /// `cusp`: the normal form.
    pub struct Cusp [x; mu = 0.0, lambda = 1.0] {
        d/dt x = mu + lambda * x - x.powi(3);
    }
}

vector_field! {
    /// `vhb`: a vertical family of cycles from a Hopf point.
    pub struct Vhb [u, v; p = -0.5] {
        d/dt u = p * u - v;
        d/dt v = u * (T::one() - u);
    }
}

vector_field! {
    /// `lor`: Lorenz' equations.
    pub struct Lor [x, y, z; rho = 280.0, b = 8.0 / 3.0, sigma = 10.0] {
        d/dt x = sigma * (y - x);
        d/dt y = rho * x - y - x * z;
        d/dt z = x * y - b * z;
    }
}

vector_field! {
    /// `frc`: FitzHugh–Nagumo equations forced by an oscillator.
    pub struct Frc [v, w, x, y; r = 0.0, beta = 100.0] {
        let s = x * x + y * y;
        d/dt v = (v * (v - 0.5) * (T::one() - v) - w) / 0.005;
        d/dt w = v - w - (r * x + 0.5);
        d/dt x = x + beta * y - x * s;
        d/dt y = y - beta * x - y * s;
    }
}

vector_field! {
    /// `lcbp`: two families of circles that cross.
    pub struct Lcbp [x, y; p1 = 1.0, p2 = 2.0, p3 = 0.0] {
        let r2 = x * x + y * y;
        let g = -(r2 - (p1 + p2) * r2.sqrt() + p1 * p2 + p3);
        d/dt x = x * g - y * TAU;
        d/dt y = y * g + x * TAU;
    }
}

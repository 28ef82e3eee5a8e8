//! The two projections of eq. 3.12 on the products of sines.

use super::airy::{self, Airy};
use super::basis::{Grid, LARGEST, row, wave};
use crate::core::scalar::Scalar;
use crate::problems::plate::parameters::Parameters;
use crate::problems::plate::tensor::dot;
use nalgebra::DMatrix;
use std::f64::consts::PI;

/// The products of sines in which the deflection of a plate is expanded: the coefficients that
/// couple them, and their values at the quadrature nodes.
#[derive(Clone, Debug)]
pub(super) struct Sines {
    /// `((m−1)/2, (n−1)/2)`.
    pub modes: Vec<(usize, usize)>,
    /// The stress function of the plate; `None` in the linear theory of plates.
    pub airy: Option<Airy>,
    pub grid: Grid,
    /// Whether the edges are immovable in the plane, so that a deflection stretches the plate.
    pub held: bool,
}

impl Sines {
    /// Evaluates the deflection `Σ z_i sin m_iπξ sin n_iπη`.
    pub fn deflection<T: Scalar>(&self, z: &[T], x: f64, y: f64) -> T {
        self.modes.iter().zip(z).fold(T::zero(), |sum, (&(k, l), &z)| {
            sum + z * ((wave(k) * x).sin() * (wave(l) * y).sin())
        })
    }

    /// Returns the mean in-plane forces `(κp_x, κp_y)` that the deflection causes between immovable
    /// edges, eqs. 3.22–3.23; zero for movable edges.
    pub fn held_tension<T: Scalar>(&self, z: &[T], plate: &Parameters<T>) -> [T; 2] {
        if !self.held {
            return [T::zero(); 2];
        }
        airy::edge_tension(&self.modes, z, [plate.gap_ratio, plate.aspect, plate.nu])
    }

    /// Returns `(κp_x − P_x, κp_y − P_y/α²)`, the uniform part of the in-plane forces; in the
    /// equation of motion, these numbers are the factors of `w_ξξ` and `w_ηη`.
    fn tension<T: Scalar>(&self, z: &[T], plate: &Parameters<T>) -> [T; 2] {
        let [x, y] = self.held_tension(z, plate);
        [x - plate.compression_x, y - plate.compression_y / (plate.aspect * plate.aspect)]
    }

    /// Returns the frequencies `ω_mn = π²(m² + n²/α²)` of the flat plate without in-plane forces.
    pub fn flat_frequency<T: Scalar>((k, l): (usize, usize), aspect: T) -> T {
        (aspect * aspect).recip() * wave(l).powi(2) + wave(k).powi(2)
    }

    /// Returns the integrals `∫∫ φ_mn = 4/(π²mn)` of the products of sines.
    fn mean((k, l): (usize, usize)) -> f64 {
        4.0 / (wave(k) * wave(l))
    }

    /// Computes the direct projection `r_i = ∫∫ φ_i [L(w) − κΦ(w,F) − pressure − λ/(1−w)²]`; all
    /// terms except the electrostatic load are exact.
    pub fn direct<T: Scalar>(&self, z: &[T], plate: &Parameters<T>, r: &mut [T]) {
        let [tension_x, tension_y] = self.tension(z, plate);
        for ((&mode, &z), r) in self.modes.iter().zip(z).zip(r.iter_mut()) {
            let (k, l) = mode;
            let stiffness = Self::flat_frequency(mode, plate.aspect).powi(2)
                + tension_x * wave(k).powi(2)
                + tension_y * wave(l).powi(2);
            *r = stiffness * z * 0.25 - plate.pressure * Self::mean(mode);
        }
        if let Some(airy) = &self.airy {
            airy.add_force(z, plate.aspect, kappa(plate), r);
        }
        let grid = &self.grid;
        for y in 0..grid.points.len() {
            let in_y = grid.sines(y);
            let deflections = row(&self.modes, z, |l| in_y[l]);
            let mut projected = [T::zero(); LARGEST];
            for (x, &weight) in grid.weights.iter().enumerate() {
                let in_x = grid.sines(x);
                let gap = T::one() - dot(&deflections[..grid.width], in_x);
                let load = plate.load * (weight * grid.weights[y]) / (gap * gap);
                for (projected, &function) in projected.iter_mut().zip(in_x) {
                    *projected += load * function;
                }
            }
            for (&(k, l), r) in self.modes.iter().zip(r.iter_mut()) {
                *r -= projected[k] * in_y[l];
            }
        }
    }

    /// Computes the multiplied projection `r_i = ∫∫ φ_i {(1−w)² [L(w) − κΦ(w,F) − pressure] − λ}`
    /// of eq. 3.26 by quadrature instead of the tensors in that equation. The integrand is a
    /// trigonometric polynomial, and the number of quadrature points is large enough to integrate
    /// it exactly up to rounding.
    pub fn multiplied<T: Scalar>(&self, z: &[T], plate: &Parameters<T>, r: &mut [T]) {
        for (&mode, r) in self.modes.iter().zip(r.iter_mut()) {
            *r = -plate.load * Self::mean(mode);
        }
        let tension = self.tension(z, plate);
        let bending: Vec<T> = (self.modes.iter().zip(z))
            .map(|(&mode, &z)| Self::flat_frequency(mode, plate.aspect).powi(2) * z)
            .collect();
        let stress = self.stress_coefficients(z, plate);
        let grid = &self.grid;
        let mut line = Line::new(grid.width);
        for y in 0..grid.points.len() {
            line.cut(self, y, z, &bending, &stress);
            let mut projected = [T::zero(); LARGEST];
            for (x, &weight) in grid.weights.iter().enumerate() {
                let in_x = grid.sines(x);
                let force = line.force(grid, x, tension) - plate.pressure;
                let gap = T::one() - dot(&line.w[..grid.width], in_x);
                let scaled = force * gap * gap * (weight * grid.weights[y]);
                for (projected, &function) in projected.iter_mut().zip(in_x) {
                    *projected += scaled * function;
                }
            }
            let in_y = grid.sines(y);
            for (&(k, l), r) in self.modes.iter().zip(r.iter_mut()) {
                *r += projected[k] * in_y[l];
            }
        }
    }

    /// Returns the coefficients `κ f_jl` of `cos 2jπξ cos 2lπη`, row by row in `j`; all
    /// coefficients are zero in linear theory.
    fn stress_coefficients<T: Scalar>(&self, z: &[T], plate: &Parameters<T>) -> Vec<T> {
        let stresses = 2 * self.grid.width;
        let kappa = kappa(plate);
        let mut stress = vec![T::zero(); stresses * stresses];
        for (m, n, f) in self.airy.iter().flat_map(|airy| airy.coefficients(z, plate.aspect)) {
            stress[(m / 2) * stresses + n / 2] = f * kappa;
        }
        stress
    }

    /// Returns the inertia of eq. 3.26, `∫∫ φ_ℓ φ_r (1−w)²`, for two fields given by their
    /// coefficients.
    pub fn inertia<T: Scalar>(&self, z: &[T], left: &[f64], right: &[f64]) -> T {
        let grid = &self.grid;
        let mut sum = T::zero();
        for y in 0..grid.points.len() {
            let in_y = grid.sines(y);
            let deflection = row(&self.modes, z, |l| in_y[l]);
            let [left, right] = [left, right].map(|field| row(&self.modes, field, |l| in_y[l]));
            for (x, &weight) in grid.weights.iter().enumerate() {
                let in_x = grid.sines(x);
                let fields = dot(&left[..grid.width], in_x) * dot(&right[..grid.width], in_x);
                let gap = T::one() - dot(&deflection[..grid.width], in_x);
                sum += gap * gap * (fields * weight * grid.weights[y]);
            }
        }
        sum
    }

    /// Returns the matrix of the bilinear form [`inertia`](Self::inertia): `∫∫ φ_i φ_j (1−w)²`.
    pub fn mass(&self, z: &[f64]) -> DMatrix<f64> {
        let grid = &self.grid;
        let count = grid.points.len();
        let scaled = DMatrix::from_fn(count * count, 1, |point, _| {
            let (x, y) = (point % count, point / count);
            let in_y = grid.sines(y);
            let deflection = row(&self.modes, z, |l| in_y[l]);
            let gap = 1.0 - dot(&deflection[..grid.width], grid.sines(x));
            gap * (grid.weights[x] * grid.weights[y]).sqrt()
        });
        let functions = DMatrix::from_fn(count * count, z.len(), |point, i| {
            let (k, l) = self.modes[i];
            scaled[point] * grid.sines(point % count)[k] * grid.sines(point / count)[l]
        });
        functions.tr_mul(&functions)
    }

    /// Returns the largest deflection at the quadrature points and at the centre, and its position:
    /// `(w, x, y)`.
    pub fn largest(&self, z: &[f64]) -> (f64, f64, f64) {
        let grid = &self.grid;
        let mut largest = (self.deflection(z, 0.5, 0.5), 0.5, 0.5);
        for y in 0..grid.points.len() {
            let in_y = grid.sines(y);
            let deflection = row(&self.modes, z, |l| in_y[l]);
            for x in 0..grid.points.len() {
                let w = dot(&deflection[..grid.width], grid.sines(x));
                if w > largest.0 {
                    largest = (w, grid.points[x], grid.points[y]);
                }
            }
        }
        largest
    }
}

/// The terms of eq. 3.26 along one line `η = const`, each given by its coefficients in an expansion
/// in functions of `ξ`.
struct Line<T> {
    /// The coefficients of `w`, `w_η`, `w_ηη` and `L(w)` in their expansions in odd sines of `ξ`.
    w: [T; LARGEST],
    w_y: [T; LARGEST],
    w_yy: [T; LARGEST],
    bending: [T; LARGEST],
    /// The coefficients of `κF`, `κF_η`, `κF_ηη`, without the uniform forces, in their expansions
    /// in even cosines of `ξ`.
    stress: [Vec<T>; 3],
}

impl<T: Scalar> Line<T> {
    fn new(width: usize) -> Line<T> {
        let (odd, even) = ([T::zero(); LARGEST], vec![T::zero(); 2 * width]);
        let stress = [even.clone(), even.clone(), even];
        Line { w: odd, w_y: odd, w_yy: odd, bending: odd, stress }
    }

    /// Evaluates the terms of eq. 3.26 on the line `η = const` that contains point `y` of the grid.
    fn cut(&mut self, sines: &Sines, y: usize, z: &[T], bending: &[T], stress: &[T]) {
        let (modes, grid) = (&sines.modes, &sines.grid);
        let (in_y, slope_in_y) = (grid.sines(y), grid.cosines(y));
        self.w = row(modes, z, |l| in_y[l]);
        self.w_y = row(modes, z, |l| slope_in_y[l] * wave(l));
        self.w_yy = row(modes, z, |l| -in_y[l] * wave(l).powi(2));
        self.bending = row(modes, bending, |l| in_y[l]);
        let (cosines, sines) = (grid.even_cosines(y), grid.even_sines(y));
        let [plain, first, second] = &mut self.stress;
        for (j, coefficients) in stress.chunks_exact(plain.len()).enumerate() {
            (plain[j], first[j], second[j]) = (T::zero(), T::zero(), T::zero());
            for (l, &f) in coefficients.iter().enumerate() {
                plain[j] += f * cosines[l];
                first[j] -= f * (sines[l] * even_wave(l));
                second[j] -= f * (cosines[l] * even_wave(l).powi(2));
            }
        }
    }

    /// Returns `L(w) − κΦ(w,F)` at point `x` of the line `η = const`, given the uniform in-plane
    /// forces `[tension_x, tension_y]`.
    fn force(&self, grid: &Grid, x: usize, [tension_x, tension_y]: [T; 2]) -> T {
        let (in_x, slope_in_x) = (grid.sines(x), grid.cosines(x));
        let w_yy = dot(&self.w_yy[..grid.width], in_x);
        let (mut w_xx, mut w_xy) = (T::zero(), T::zero());
        for k in 0..grid.width {
            w_xx -= self.w[k] * (in_x[k] * wave(k).powi(2));
            w_xy += self.w_y[k] * (slope_in_x[k] * wave(k));
        }
        let (cosines, sines) = (grid.even_cosines(x), grid.even_sines(x));
        let [plain, first, second] = &self.stress;
        let (mut f_xx, mut f_xy) = (T::zero(), T::zero());
        for j in 0..plain.len() {
            f_xx -= plain[j] * (cosines[j] * even_wave(j).powi(2));
            f_xy -= first[j] * (sines[j] * even_wave(j));
        }
        let f_yy = dot(second, cosines);
        let bracket = w_xx * (f_yy + tension_x) + w_yy * (f_xx + tension_y) - w_xy * f_xy * 2.0;
        dot(&self.bending[..grid.width], in_x) - bracket
    }
}

/// Returns the factor `κ = 12(1−ν²)α₁²/α²` of eq. 3.26.
fn kappa<T: Scalar>(plate: &Parameters<T>) -> T {
    let ratio = plate.gap_ratio / plate.aspect;
    (T::one() - plate.nu * plate.nu) * ratio * ratio * 12.0
}

/// Returns `2kπ`.
fn even_wave(k: usize) -> f64 {
    2.0 * PI * k as f64
}

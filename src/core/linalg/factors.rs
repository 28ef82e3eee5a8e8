//! Factored matrices that are stored as values.

use super::border::Border;
use super::lu::{BorderedLu, differ};
use crate::core::failure::Failure;
use faer::c64;
use std::any::Any;
use std::ops::{Deref, DerefMut};

/// A factored bordered matrix, created by a [`System`](crate::core::system::System).
///
/// A complex vector consists of the real parts of all components, followed by the imaginary parts.
pub trait Factorisation: Any + Send {
    /// Solves a linear system with the matrix, in place.
    fn solve(&mut self, right: &mut [f64]);

    /// Solves a linear system with the transpose (for a complex matrix, the conjugate transpose),
    /// in place.
    fn solve_transposed(&mut self, right: &mut [f64]);

    /// Returns the sign of the determinant, −1 or 1; 1 for complex matrices.
    fn determinant_sign(&self) -> f64;

    /// Computes the product of a vector `v` with the derivative of the matrix (without its border)
    /// with respect to the exponent `σ`. The matrix describes deviations that change like `e^{σt}`,
    /// or by the factor `e^σ` in each period. The default implementation returns `−v`, which is
    /// correct for the matrix `A − σ`.
    fn growth_derivative(&self, v: &[f64], out: &mut [f64]) {
        out.iter_mut().zip(v).for_each(|(out, v)| *out = -v);
    }

    /// Multiplies the transpose of the matrix's derivative with respect to the exponent `σ` by `w`,
    /// for a real matrix.
    fn growth_derivative_transposed(&self, w: &[f64], out: &mut [f64]) {
        out.iter_mut().zip(w).for_each(|(out, w)| *out = -w);
    }
}

/// A factored matrix. The factors of a matrix; refactoring reuses the buffers of the previous
/// matrix.
pub struct Factors(Box<dyn Factorisation>);

impl Default for Factors {
    /// Creates the factors of an empty matrix.
    fn default() -> Self {
        Factors(Box::<BorderedLu>::default())
    }
}

impl Factors {
    /// Returns the previous factors if they have the requested type and `fits` accepts them;
    /// otherwise replaces them by the result of `make`.
    pub fn reuse<F: Factorisation>(
        &mut self,
        fits: impl FnOnce(&F) -> bool,
        make: impl FnOnce() -> F,
    ) -> &mut F {
        if !(&*self.0 as &dyn Any).downcast_ref::<F>().is_some_and(fits) {
            self.0 = Box::new(make());
        }
        let factors: &mut dyn Any = &mut *self.0;
        factors.downcast_mut().unwrap_or_else(|| unreachable!("the type was checked above"))
    }
}

impl Deref for Factors {
    type Target = dyn Factorisation;

    fn deref(&self) -> &Self::Target {
        &*self.0
    }
}

impl DerefMut for Factors {
    fn deref_mut(&mut self) -> &mut Self::Target {
        &mut *self.0
    }
}

impl Factorisation for BorderedLu {
    fn solve(&mut self, right: &mut [f64]) {
        self.solve(right);
    }

    fn solve_transposed(&mut self, right: &mut [f64]) {
        self.solve_transposed(right);
    }

    fn determinant_sign(&self) -> f64 {
        self.determinant_sign()
    }
}

/// Factors of a complex matrix.
pub(super) trait ComplexFactors: Send + 'static {
    fn solve(&mut self, right: &mut [c64]);

    /// Solves a linear system with the conjugate transpose, in place.
    fn solve_transposed(&mut self, right: &mut [c64]);
}

/// Factors of a complex matrix; each vector consists of the real parts, followed by the imaginary
/// parts.
#[derive(Default)]
pub(crate) struct Shifted<L> {
    pub(super) lu: L,
    work: Vec<c64>,
}

impl<L> Shifted<L> {
    fn complex(&mut self, right: &mut [f64], solve: impl Fn(&mut L, &mut [c64])) {
        let (real, imaginary) = right.split_at_mut(right.len() / 2);
        self.work.clear();
        self.work.extend(real.iter().zip(&*imaginary).map(|(re, im)| c64::new(*re, *im)));
        solve(&mut self.lu, &mut self.work);
        for ((value, re), im) in self.work.iter().zip(real).zip(imaginary) {
            (*re, *im) = (value.re, value.im);
        }
    }
}

impl<L: ComplexFactors> Factorisation for Shifted<L> {
    fn solve(&mut self, right: &mut [f64]) {
        self.complex(right, L::solve);
    }

    fn solve_transposed(&mut self, right: &mut [f64]) {
        self.complex(right, L::solve_transposed);
    }

    fn determinant_sign(&self) -> f64 {
        1.0
    }
}

/// The factors of `A − iω` bordered by complex columns and rows.
pub(crate) type ShiftedLu = Shifted<BorderedLu<c64>>;

impl ComplexFactors for BorderedLu<c64> {
    fn solve(&mut self, right: &mut [c64]) {
        self.solve(right);
    }

    fn solve_transposed(&mut self, right: &mut [c64]) {
        self.solve_transposed(right);
    }
}

impl ShiftedLu {
    /// Factors the bordered matrix `A − iω M` (`A` and `M` stored column by column; without `M`,
    /// the identity matrix), whose border consists of complex columns and rows, each given as real
    /// parts followed by imaginary parts, and a zero corner. The rows of the border enter as their
    /// complex conjugates.
    pub fn factor(
        &mut self,
        pencil: (&[f64], Option<&[f64]>),
        omega: f64,
        border: Border,
    ) -> Result<(), Failure> {
        let outcome = self.factor_in_units(pencil, omega, border, &[]);
        match differ(border.units) {
            true => outcome.or_else(|_| self.factor_in_units(pencil, omega, border, border.units)),
            false => outcome,
        }
    }

    fn factor_in_units(
        &mut self,
        (matrix, mass): (&[f64], Option<&[f64]>),
        omega: f64,
        border: Border,
        units: &[f64],
    ) -> Result<(), Failure> {
        let (n, m) = (matrix.len().isqrt(), border.width);
        let size = n + m;
        let room = self.lu.room(size);
        room.fill(c64::new(0.0, 0.0));
        for j in 0..n {
            let column = &mut room[j * size..(j + 1) * size];
            for (entry, real) in column.iter_mut().zip(&matrix[j * n..(j + 1) * n]) {
                *entry = c64::new(*real, 0.0);
            }
            match mass {
                None => column[j].im = -omega,
                Some(mass) => {
                    let mass = &mass[j * n..(j + 1) * n];
                    column.iter_mut().zip(mass).for_each(|(entry, m)| entry.im = -omega * m);
                }
            }
        }
        for k in 0..m {
            let [column, row] =
                [border.columns, border.rows].map(|given| &given[2 * k * n..2 * (k + 1) * n]);
            for i in 0..n {
                room[(n + k) * size + i] = c64::new(column[i], column[n + i]);
                room[i * size + n + k] = c64::new(row[i], -row[n + i]);
            }
        }
        self.lu.factor_room(units)
    }
}

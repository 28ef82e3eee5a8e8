//! Codimension-two points with a degenerate fold: cusps, Bogdanov–Takens points, and periodic
//! orbits with a double multiplier 1 or −1.
//!
//! Cusps are zeros of `a = wᵀ F_zz[v, v]`, and Bogdanov–Takens points are zeros of `c = wᵀ L' v`.
//! The null vectors `v` and `w` depend on `x`. Differentiating the bordered systems of the null
//! vectors gives `M (δv, δg) = −(δF_z v, 0)` and `Mᵀ (δw, δg) = −(δF_zᵀ w, 0)`. Transposing the two
//! bordered systems gives
//!
//! ```text
//!     qᵀ δv = −ξᵀ δF_z v   with  Mᵀ (ξ, ·) = (q, 0)
//!     hᵀ δw = −wᵀ δF_z η   with  M (η, ·) = (h, 0)
//! ```
//!
//! Therefore the gradients of `a` and `c` are computed as gradients of bilinear forms in `F_z`.

use super::at::At;
use super::defining_system::DefiningSystem;
use super::null::NullVectors;
use crate::core::failure::Failure;
use crate::core::linalg::{Form, dot};
use crate::core::problem::Dynamics;
use crate::core::system::{Functional, Kind};

impl Kind {
    /// `CP`: a cusp on a curve of folds.
    pub const CP: Kind = Kind::new("CP", "cusp");
    /// `BT`: a Bogdanov–Takens point.
    pub const BT: Kind = Kind::new("BT", "Bogdanov–Takens point");
}

/// A degenerate point of a curve of folds: a cusp, where `a = wᵀ F_zz[v, v] = 0`, or a
/// Bogdanov–Takens point, where `c = wᵀ L' v = 0` and the eigenvalue zero is double. For
/// equilibria, `L' = −M` is the derivative of the linearisation `L(σ) = F_z − σ M` with respect to
/// the exponent `σ` of deviations; the mass matrix `M` is the identity matrix for most flows. With
/// the `L'` of periodic orbits, `c = 0` defines a resonance 1:1 on curves of folds, and a resonance
/// 1:2 on curves of period doublings.
pub struct DegenerateFold {
    kind: Kind,
    form: Form,
    /// The vector `L' v`.
    growth: Vec<f64>,
    second: Vec<f64>,
    gradient: Vec<f64>,
    adjoint: Vec<f64>,
    direct: Vec<f64>,
    extended: Vec<f64>,
}

impl DegenerateFold {
    /// Creates the defining system of a cusp.
    pub fn cusp() -> Self {
        Self::new(Kind::CP, Form::Jacobian)
    }

    /// Creates the defining system of a Bogdanov–Takens point.
    pub fn bogdanov_takens() -> Self {
        Self::new(Kind::BT, Form::Jacobian)
    }

    /// Creates the defining system of periodic orbits with a double multiplier 1.
    pub fn double_one() -> Self {
        Self::new(Kind::R1, Form::Jacobian)
    }

    /// Creates the defining system of periodic orbits with a double multiplier −1.
    pub fn double_minus_one() -> Self {
        Self::new(Kind::R2, Form::Antiperiodic)
    }

    /// Creates the defining system of a double eigenvalue or multiplier of the kind `BT`, `R1` or
    /// `R2`.
    pub(super) fn double(kind: Kind) -> Self {
        let form = if kind == Kind::R2 { Form::Antiperiodic } else { Form::Jacobian };
        Self::new(kind, form)
    }

    /// The form of the linearisation that has the double eigenvalue or multiplier.
    pub(super) fn form(&self) -> Form {
        self.form
    }

    fn new(kind: Kind, form: Form) -> Self {
        let [growth, second, gradient, adjoint, direct, extended] = Default::default();
        DegenerateFold { kind, form, growth, second, gradient, adjoint, direct, extended }
    }
}

impl DefiningSystem for DegenerateFold {
    fn kind(&self) -> Kind {
        self.kind
    }

    fn assembles(&self) -> bool {
        true
    }

    fn start(&mut self, At { system, x, null, .. }: At, _y: &mut [f64]) -> Result<(), Failure> {
        let n = system.names().dimension();
        self.second.resize(n, 0.0);
        self.growth = vec![0.0; n];
        self.gradient = vec![0.0; x.len()];
        self.extended = vec![0.0; x.len()];
        self.adjoint = vec![0.0; n + 1];
        self.direct = vec![0.0; n + 1];
        null.start(system, x, self.form, None)
    }

    fn values(
        &mut self,
        At { system, x, null, .. }: At,
        _y: &[f64],
        values: &mut [f64],
    ) -> Result<(), Failure> {
        let null = null.of(system, x, self.form, None)?;
        values[0] = if self.kind == Kind::CP {
            system.derivative(x, &[&null.right[0][..]; 2], &mut self.second)?;
            dot(&null.left[0], &self.second)
        } else {
            null.factors.growth_derivative(&null.right[0][..self.growth.len()], &mut self.growth);
            dot(&null.left[0], &self.growth)
        };
        Ok(())
    }

    fn gradients(
        &mut self,
        At { system, x, released, null, .. }: At,
        rows: &mut [f64],
        _own: &mut [f64],
    ) -> Result<(), Failure> {
        let n = self.second.len();
        let NullVectors { left, right, factors, .. } = null.of(system, x, self.form, None)?;
        let (left, right) = (&left[0], &right[0]);
        // Computes ξ and η from the factors of the value.
        (self.adjoint[n], self.direct[n]) = (0.0, 0.0);
        if self.kind == Kind::CP {
            system.gradient(x, Functional::Second(left, right), released, rows)?;
            system.gradient(x, Functional::First(left, right), released, &mut self.gradient)?;
            self.adjoint[..n].iter_mut().zip(&self.gradient).for_each(|(q, form)| *q = 2.0 * form);
            self.direct[..n].copy_from_slice(&self.second);
        } else {
            match system.dynamics() {
                // The mass matrix in L' = −M can depend on x.
                Dynamics::Implicit => {
                    let at_rest = [&vec![0.0; x.len()], &right[..n]].concat();
                    system.gradient(x, Functional::First(left, &at_rest), released, rows)?;
                }
                _ => rows.fill(0.0),
            }
            factors.growth_derivative_transposed(left, &mut self.adjoint[..n]);
            self.direct[..n].copy_from_slice(&self.growth);
        }
        factors.solve_transposed(&mut self.adjoint);
        factors.solve(&mut self.direct);
        self.extended[..n].copy_from_slice(&self.direct[..n]);
        for (w, v) in [(&self.adjoint[..n], right), (&left[..], &self.extended)] {
            system.gradient(x, Functional::First(w, v), released, &mut self.gradient)?;
            rows.iter_mut().zip(&self.gradient).for_each(|(row, form)| *row -= form);
        }
        Ok(())
    }
}

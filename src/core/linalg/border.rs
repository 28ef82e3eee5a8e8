//! Borders of matrices, forms of a linearisation, and spectra: the types shared by systems and
//! factorisations.

/// Columns `B`, rows `C` and corner `D` that border `F_z`:
///
/// ```text
///     ⎡ F_z  B ⎤     n rows
///     ⎣ C    D ⎦     m rows
/// ```
#[derive(Clone, Copy, Debug)]
pub struct Border<'a> {
    /// The width `m`.
    pub width: usize,
    /// `B`, `n × m`, one column after the other.
    pub columns: &'a [f64],
    /// `C`, `m × n`, one row after the other.
    pub rows: &'a [f64],
    /// `D`, `m × m`, one row after the other.
    pub corner: &'a [f64],
    /// The sizes of the `n` unknowns, used as units in the choice of pivots; empty if unknown.
    pub units: &'a [f64],
}

impl Border<'_> {
    /// An empty border.
    pub const NONE: Border<'static> =
        Border { width: 0, columns: &[], rows: &[], corner: &[], units: &[] };
}

/// A linearisation that is singular at a bifurcation.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[non_exhaustive]
pub enum Form {
    /// `F_z`.
    #[default]
    Jacobian,
    /// The matrix `F_z` of periodic orbits with the Floquet multiplier −1: `x(1) = −x(0)` replaces
    /// the boundary conditions, and further unknowns, such as the period, are zero.
    Antiperiodic,
    /// A complex matrix: `F_z − iω` about an equilibrium, or `F_z` of periodic orbits with the
    /// Floquet multiplier `e^{iω}`.
    ///
    /// Complex vectors are given as the real parts of their components, then the imaginary parts. The
    /// border's rows enter as their conjugates, its corner is zero, and its width is 1 unless the
    /// system supports any width.
    Oscillation(f64),
}

/// The requested eigenvalues: all unstable ones, and at least `count` in total, the rightmost first
/// (for Floquet multipliers, the largest first).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct SpectrumRequest {
    /// The least number of eigenvalues, if that many exist. A system whose eigenvalues all have the
    /// same cost may return all of them; a system with sparse matrices returns at most 48.
    pub count: usize,
}

/// Eigenvalues of the linearised motion, as (real part, imaginary part). For an equilibrium: the
/// eigenvalues of `z' = F_z z` for a flow, or of `−∇²Π` (with the mass matrix, if there is one) for a
/// potential, the rightmost first. For a periodic orbit: the Floquet multipliers without the trivial
/// one, the largest first.
pub type Spectrum = Vec<(f64, f64)>;

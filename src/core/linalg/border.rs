//! Borders of matrices, the forms of a linearisation, and spectra: the words in which systems and
//! factorisations speak of matrices.

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
    /// The sizes of the `n` unknowns, in units of which pivots are chosen; empty if they are not
    /// known.
    pub units: &'a [f64],
}

impl Border<'_> {
    /// No border at all.
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
    /// `F_z` of periodic orbits with the multiplier −1: with `x(1) = −x(0)` in place of the
    /// boundary conditions (and further unknowns, such as the period, zero).
    Antiperiodic,
    /// Complex: `F_z − iω` about an equilibrium; of periodic orbits `F_z` with the multiplier
    /// `e^{iω}`.
    ///
    /// Complex vectors are given as the real parts of their components, then the imaginary parts.
    /// The conjugates of the border's rows enter, its corner is zero, and its width is 1 unless the
    /// system takes any.
    Oscillation(f64),
}

/// The eigenvalues that are wanted: all unstable ones, and at least `count` of all, the rightmost
/// (of multipliers the largest) first.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct SpectrumRequest {
    /// The least number of eigenvalues, if there are as many. A system whose eigenvalues all come
    /// at one price may return all, and one with sparse matrices 48 at most.
    pub count: usize,
}

/// Eigenvalues of the linearised motion, as (real part, imaginary part). About an equilibrium, the
/// rightmost first: `z' = F_z z` for a flow, `−∇²Π` (with the mass matrix, where there is one) for
/// a potential. About a periodic orbit its multipliers, the largest first and without the trivial
/// one.
pub type Spectrum = Vec<(f64, f64)>;

//! Borders of matrices, forms of a linearisation, and spectra: the types shared by systems and
//! factorisations.

/// A border of the matrix `F_z`, with columns `B`, rows `C` and a corner `D`:
///
/// ```text
///     ⎡ F_z  B ⎤     n rows
///     ⎣ C    D ⎦     m rows
/// ```
#[derive(Clone, Copy, Debug)]
pub struct Border<'a> {
    /// The width `m`.
    pub width: usize,
    /// The columns `B`, an `n × m` matrix stored column by column.
    pub columns: &'a [f64],
    /// The rows `C`, an `m × n` matrix stored row by row.
    pub rows: &'a [f64],
    /// The corner `D`, an `m × m` matrix stored row by row.
    pub corner: &'a [f64],
    /// The sizes of the `n` unknowns, used as units in the choice of pivots; empty if unknown.
    pub units: &'a [f64],
}

impl Border<'_> {
    /// An empty border.
    pub const NONE: Border<'static> =
        Border { width: 0, columns: &[], rows: &[], corner: &[], units: &[] };
}

/// A form of the linearisation that is singular at a bifurcation.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[non_exhaustive]
pub enum Form {
    /// `F_z`.
    #[default]
    Jacobian,
    /// The matrix `F_z` of periodic orbits with the Floquet multiplier −1: the boundary conditions
    /// are replaced by `x(1) = −x(0)`, and extra unknowns, such as the period, are zero.
    Antiperiodic,
    /// A complex matrix: `F_z − iω M` about an equilibrium (`M` is the mass matrix, or the identity
    /// matrix), or `F_z` of periodic orbits with the
    /// Floquet multiplier `e^{iω}`.
    ///
    /// Complex vectors are given as the real parts of all components, followed by the imaginary
    /// parts. The border's rows enter as their complex conjugates, its corner is zero, and its width
    /// is 1 unless the system supports any width.
    Oscillation(f64),
}

/// A request for eigenvalues: all unstable eigenvalues, and at least `count` in total, starting
/// with the rightmost (for Floquet multipliers, with the largest).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct SpectrumRequest {
    /// The smallest number of eigenvalues to return, if the linearisation has this many
    /// eigenvalues. A system can return all eigenvalues if they all have the same cost; a system
    /// with sparse matrices returns at most 48 eigenvalues.
    pub count: usize,
    /// Whether only complex pairs are of interest. A system can then return an empty spectrum if
    /// all eigenvalues are known to be real without computing them.
    pub only_pairs: bool,
}

impl SpectrumRequest {
    /// Requests at least `count` eigenvalues, real and complex.
    pub const fn new(count: usize) -> Self {
        SpectrumRequest { count, only_pairs: false }
    }

    /// Requests the complex pairs among at least `count` eigenvalues.
    pub const fn pairs(count: usize) -> Self {
        SpectrumRequest { count, only_pairs: true }
    }
}

/// The eigenvalues of the linearised motion, each as (real part, imaginary part). For an
/// equilibrium, the spectrum consists of the finite eigenvalues of `M z' = F_z z` for a flow, or of `−∇²Π`
/// (with the mass matrix, if the system defines one) for a potential, starting with the rightmost.
/// For a periodic orbit, the spectrum consists of the Floquet multipliers except the trivial
/// multiplier, starting with the largest.
pub type Spectrum = Vec<(f64, f64)>;

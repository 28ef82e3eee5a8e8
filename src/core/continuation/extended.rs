//! The extended system from which points and tangents of a curve are computed: a zero problem
//! together with the held defining systems. The unknowns of the extended system are `X = (z, y,
//! p)`, where `y` are the auxiliary unknowns and `p` contains only the released parameters.
//!
//! ```text
//!     F(z, p) + Σ yⱼ bⱼ = 0      n equations
//!     conditions(z, p, y) = 0    k + 1 for each defining system with k auxiliary unknowns
//!     ⟨row, X − base⟩ = length   one closing equation, for points of a curve
//! ```

use crate::core::bifurcation::{At, DefiningSystem, NullSpace};
use crate::core::cancel::CancelToken;
use crate::core::failure::Failure;
use crate::core::linalg::{Border, Factors, Form, along};
use crate::core::problem::Names;
use crate::core::system::{Effort, System, SystemRef};

/// The closing equation of the extended system: a hyperplane across the curve, or a fixed
/// parameter.
#[derive(Clone, Copy)]
pub struct Closing<'a> {
    /// The covector of the hyperplane, of the same length as `X`.
    pub row: &'a [f64],
    /// The base point.
    pub base: &'a [f64],
    /// The distance of the hyperplane from the base point.
    pub length: f64,
}

/// A zero problem together with the held defining systems.
///
/// ```
/// use tangency::core::continuation::{Extended, Newton, NewtonError, Tolerances};
/// use tangency::core::bifurcation::Fold;
/// use tangency::core::system::Dense;
/// use tangency::problems::classic::ParallelPlate;
/// // The fold at u = 1/3, from a nearby point.
/// let (mut system, near) = (Dense::new(ParallelPlate), [0.3, 0.14]);
/// let mut equations = Extended::new(&mut system, &near, vec![0]);
/// let mut unknowns = equations.hold(Box::<Fold>::default(), &near)?;
/// let tolerances = Tolerances::new(1e-12, 12);
/// Newton::default().solve(&mut equations, &mut unknowns, None, &[1.0; 2], tolerances)?;
/// assert!((unknowns[0] - 1.0 / 3.0).abs() < 1e-14);
/// # Ok::<(), NewtonError>(())
/// ```
pub struct Extended<'a> {
    pub(super) system: SystemRef<'a>,
    pub(super) conditions: Vec<Box<dyn DefiningSystem + 'a>>,
    /// The indices of the released parameters among all parameters.
    pub(crate) released: Vec<usize>,
    /// The vector `x = (z, p)`, where `p` are all parameters, including constant ones.
    pub(super) x: Vec<f64>,
    /// The auxiliary unknowns of the defining systems, taken from the `X` that was loaded last.
    pub(super) auxiliary: Vec<f64>,
    /// The null vectors at the last evaluated point.
    pub(super) null: NullSpace,
    edges: Edges,
    /// The factors of the last factored matrix.
    pub(crate) factors: Factors,
    /// The token that interrupts an assembly.
    pub(crate) cancel: CancelToken,
}

impl<'a> Extended<'a> {
    /// Creates the extended system at `x = (z, p)` with the given parameters released and no
    /// defining system.
    pub fn new(system: &'a mut dyn System, x: &[f64], released: Vec<usize>) -> Self {
        Self::of(SystemRef::Borrowed(system), x, released)
    }

    /// Creates the extended system of an owned or borrowed zero problem.
    pub(crate) fn of(system: SystemRef<'a>, x: &[f64], released: Vec<usize>) -> Self {
        let mut extended = Extended {
            x: x.to_vec(),
            system,
            conditions: Vec::new(),
            released,
            auxiliary: Vec::new(),
            null: NullSpace::default(),
            edges: Edges::default(),
            factors: Factors::default(),
            cancel: CancelToken::default(),
        };
        extended.resize();
        extended
    }

    /// Adds a defining system, sets it up at `X`, and returns `X` extended by the auxiliary
    /// unknowns of the defining system.
    ///
    /// # Errors
    /// [`Failure`] if the defining system cannot be set up at `X`.
    pub fn hold(
        &mut self,
        mut condition: Box<dyn DefiningSystem + 'a>,
        unknowns: &[f64],
    ) -> Result<Vec<f64>, Failure> {
        self.load(unknowns);
        let mut y = vec![0.0; condition.unknowns()];
        condition.start(self.at(), &mut y)?;
        let place = self.dimension() + self.auxiliary.len();
        let mut unknowns = unknowns.to_vec();
        unknowns.splice(place..place, y.iter().copied());
        self.auxiliary.extend(y);
        self.conditions.push(condition);
        self.resize();
        Ok(unknowns)
    }

    /// Replaces the held defining systems by other defining systems, which must already be set up,
    /// and returns the former defining systems.
    pub(crate) fn exchange(
        &mut self,
        conditions: Vec<Box<dyn DefiningSystem + 'a>>,
    ) -> Vec<Box<dyn DefiningSystem + 'a>> {
        let own = conditions.iter().map(|condition| condition.unknowns()).sum();
        self.auxiliary.clear();
        self.auxiliary.resize(own, 0.0);
        let former = std::mem::replace(&mut self.conditions, conditions);
        self.null.forget();
        self.resize();
        former
    }

    /// Returns the number `n` of unknowns `z` of the zero problem.
    pub(crate) fn dimension(&self) -> usize {
        self.x.len() - self.system.names().parameters.len()
    }

    /// Returns the number of components of `X`.
    pub(crate) fn length(&self) -> usize {
        self.dimension() + self.auxiliary.len() + self.released.len()
    }

    /// Returns the index of the first released parameter in `X`.
    pub(crate) fn parameters_at(&self) -> usize {
        self.dimension() + self.auxiliary.len()
    }

    /// The system.
    pub(crate) fn system(&mut self) -> &mut dyn System {
        &mut *self.system
    }

    /// Returns the names of the unknowns, parameters and monitors of the zero problem.
    pub(crate) fn names(&self) -> &Names {
        self.system.names()
    }

    /// Returns typical sizes of the groups of unknowns; empty if the sizes are unknown. If
    /// solutions have a mesh, the size of a group of unknowns without a specified size is 1.
    pub(crate) fn unknown_scales(&self) -> Vec<f64> {
        let mut scales = self.system.unknown_scales(&self.x[self.dimension()..]);
        if scales.is_empty() && self.system.representation().is_on_mesh() {
            scales.resize(self.names().unknowns.len(), 1.0);
        }
        scales
    }

    /// Returns the zero problem together with the last loaded `x = (z, p)` and the released
    /// parameters.
    pub(crate) fn at(&mut self) -> At<'_> {
        let Extended { system, x, released, auxiliary, null, .. } = self;
        At { system: &mut **system, x, released, held: auxiliary, null }
    }

    /// Loads `X`: writes its unknowns and released parameters into `x = (z, p)`, and returns `x`.
    pub(crate) fn load(&mut self, unknowns: &[f64]) -> &[f64] {
        let n = self.dimension();
        self.x[..n].copy_from_slice(&unknowns[..n]);
        for (&p, value) in self.released.iter().zip(&unknowns[n + self.auxiliary.len()..]) {
            self.x[n + p] = *value;
        }
        let own = self.auxiliary.len();
        self.auxiliary.copy_from_slice(&unknowns[n..n + own]);
        &self.x
    }

    /// Converts a direction in the extended unknowns `X` to a direction in `x = (z, p)`.
    pub(crate) fn direction_of(&self, v: &[f64]) -> Vec<f64> {
        let n = self.dimension();
        let mut direction = vec![0.0; self.x.len()];
        direction[..n].copy_from_slice(&v[..n]);
        for (&p, part) in self.released.iter().zip(&v[self.parameters_at()..]) {
            direction[n + p] = *part;
        }
        direction
    }

    /// Returns the names and the last loaded values of those auxiliary unknowns of the defining
    /// systems that have names.
    pub(crate) fn recorded(&self) -> impl Iterator<Item = f64> {
        let mut rest = &self.auxiliary[..];
        self.conditions.iter().flat_map(move |condition| {
            let (own, others) = rest.split_at(condition.unknowns());
            rest = others;
            own[..condition.names().len()].iter().copied()
        })
    }

    /// Converts `x = (z, p)` to `X`, with all auxiliary unknowns set to zero.
    pub fn unload(&self, x: &[f64]) -> Vec<f64> {
        let n = self.dimension();
        let own = std::iter::repeat_n(0.0, self.auxiliary.len());
        let released = self.released.iter().map(|&p| x[n + p]);
        x[..n].iter().copied().chain(own).chain(released).collect()
    }

    /// Returns the sizes of the auxiliary unknowns; the size of an auxiliary unknown that unfolds
    /// the problem, and vanishes at the solution, is `None`.
    pub(crate) fn own_sizes(&self, unknowns: &[f64]) -> Vec<Option<f64>> {
        let place = self.dimension();
        self.conditions
            .iter()
            .flat_map(|c| (0..c.unknowns()).map(|j| c.unfolding(j, &self.null).is_none()))
            .zip(&unknowns[place..])
            .map(|(measured, y)| measured.then_some(y.abs()))
            .collect()
    }

    /// Adapts the mesh and the phase condition of the zero problem to `X`, and interpolates `X` and
    /// the given directions to the new mesh.
    pub(crate) fn on_accepted(&mut self, unknowns: &mut [f64], directions: &mut [&mut [f64]]) {
        let n = self.dimension();
        self.load(unknowns);
        if let Some(system) = self.system.discretised() {
            system.on_accepted(&mut self.x, directions);
            self.null.forget();
        }
        unknowns[..n].copy_from_slice(&self.x[..n]);
    }

    /// Loads the unknowns after the mesh of the zero problem has changed, and discards stored data
    /// whose number of unknowns differs.
    pub(crate) fn adopt(&mut self, unknowns: &[f64]) {
        let n = unknowns.len() - self.auxiliary.len() - self.released.len();
        self.x.splice(..self.dimension(), unknowns[..n].iter().copied());
        self.null = NullSpace::default();
        self.factors = Factors::default();
        self.resize();
    }

    /// Turns the borders of all defining systems towards the current null vectors.
    pub(crate) fn adapt(&mut self) {
        self.null.adapt();
        self.conditions.iter_mut().for_each(|condition| condition.adapt());
    }

    /// Sets the error allowed in evaluations of the zero problem during the first Newton
    /// iterations. Defining systems must not be set up with inexact data.
    pub(crate) fn set_inexactness(&mut self, error: f64) {
        if (error == 0.0 || self.conditions.is_empty())
            && let Some(system) = self.system.discretised()
        {
            system.set_effort(Effort { error, exact_gradients: false, cancel: &self.cancel });
            self.null.forget();
        }
    }

    /// Assembles the matrix `F_z` of the zero problem at `X`.
    pub(crate) fn assemble(&mut self, unknowns: &[f64]) -> Result<(), Failure> {
        self.cancel.check()?;
        self.load(unknowns);
        self.system.assemble(&self.x)
    }

    /// Evaluates the left sides of all equations into `out`, which has the length of `X`. If no
    /// closing equation is given, the last entry of `out` is not written.
    pub(crate) fn residual(
        &mut self,
        unknowns: &[f64],
        closing: Option<Closing>,
        out: &mut [f64],
    ) -> Result<(), Failure> {
        let n = self.dimension();
        self.load(unknowns);
        if self.conditions.iter().any(|condition| condition.assembles()) {
            self.system.assemble(&self.x)?;
        }
        self.system.residual(&self.x, &mut out[..n])?;
        let (mut row, mut place) = (n, n);
        let Extended { system, conditions, x, released, auxiliary, null, .. } = self;
        let mut at = At { system: &mut **system, x, released, held: auxiliary, null };
        for condition in conditions {
            let k = condition.unknowns();
            let y = &unknowns[place..place + k];
            for (j, y) in y.iter().enumerate() {
                if let Some(null) = condition.unfolding(j, at.null) {
                    out[..n].iter_mut().zip(null.border()).for_each(|(r, b)| *r += y * b);
                }
            }
            condition.values(at.again(), y, &mut out[row..row + k + 1])?;
            row += k + 1;
            place += k;
        }
        if let Some(Closing { row: covector, base, length }) = closing {
            out[row] = along(covector, unknowns, base) - length;
        }
        Ok(())
    }

    /// Assembles and factors the matrix of all equations at the point where
    /// [`residual`](Extended::residual) was called last.
    pub(crate) fn factor(&mut self, closing_row: Option<&[f64]>) -> Result<(), Failure> {
        let Extended { system, conditions, released, x, auxiliary, null, edges, factors, .. } =
            self;
        let mut at = At { system: &mut **system, x, released, held: auxiliary, null };
        edges.fill_rows(conditions, at.again())?;
        edges.fill_columns(conditions, at)?;
        if let Some(row) = closing_row {
            edges.close(row);
        }
        system.assemble(x)?;
        let Edges { columns, rows, corner, width, .. } = edges;
        let n = system.names().dimension();
        let units = null.sizes(n);
        let border = Border { width: *width, columns, rows, corner, units };
        system.factor(Form::Jacobian, border, factors)
    }

    /// Computes the tangent of the curve at the point where the matrix was last factored with a
    /// closing row, normalised such that the inner product of the closing row and the tangent is 1.
    pub(crate) fn tangent(&mut self, tangent: &mut [f64]) {
        tangent.fill(0.0);
        if let Some(last) = tangent.last_mut() {
            *last = 1.0;
        }
        self.factors.solve(tangent);
    }

    fn resize(&mut self) {
        let width = self.auxiliary.len() + self.released.len();
        let most = self.conditions.iter().map(|c| c.unknowns()).max().unwrap_or(0);
        self.edges.resize(self.dimension(), self.x.len(), width, most);
    }
}

/// The rows and columns that border the matrix `F_z` of the zero problem.
#[derive(Default)]
struct Edges {
    width: usize,
    columns: Vec<f64>,
    rows: Vec<f64>,
    corner: Vec<f64>,
    gradients: Vec<f64>,
    own_gradients: Vec<f64>,
    direction: Vec<f64>,
}

impl Edges {
    /// Allocates the border for `n` unknowns `z`, a vector `x` of the given length, and defining
    /// systems with at most `most` auxiliary unknowns each.
    fn resize(&mut self, n: usize, length: usize, width: usize, most: usize) {
        self.width = width;
        self.columns.resize(n * width, 0.0);
        self.rows.resize(n * width, 0.0);
        self.corner.resize(width * width, 0.0);
        self.gradients.resize((most + 1) * length, 0.0);
        self.own_gradients.resize((most + 1) * most.max(1), 0.0);
        self.direction.resize(length, 0.0);
    }

    /// Fills in the rows of the defining systems, and the corresponding part of the corner block.
    fn fill_rows(
        &mut self,
        conditions: &mut [Box<dyn DefiningSystem + '_>],
        mut at: At,
    ) -> Result<(), Failure> {
        let (n, length, width) = (at.system.names().dimension(), at.x.len(), self.width);
        self.corner.fill(0.0);
        let (mut row, mut place) = (0, 0);
        for condition in conditions {
            let k = condition.unknowns();
            let gradients = &mut self.gradients[..(k + 1) * length];
            let own = &mut self.own_gradients[..(k + 1) * k];
            condition.gradients(at.again(), gradients, own)?;
            for i in 0..=k {
                let gradient = &gradients[i * length..(i + 1) * length];
                self.rows[(row + i) * n..(row + i + 1) * n].copy_from_slice(&gradient[..n]);
                let corner = &mut self.corner[(row + i) * width..(row + i + 1) * width];
                corner[place..place + k].copy_from_slice(&own[i * k..(i + 1) * k]);
                for (entry, &p) in corner[at.held.len()..].iter_mut().zip(at.released) {
                    *entry = gradient[n + p];
                }
            }
            row += k + 1;
            place += k;
        }
        Ok(())
    }

    /// Fills in the columns that contain the derivatives of the zero problem with respect to the
    /// auxiliary unknowns and the released parameters.
    fn fill_columns(
        &mut self,
        conditions: &[Box<dyn DefiningSystem + '_>],
        At { system, x, released, null, .. }: At,
    ) -> Result<(), Failure> {
        let n = system.names().dimension();
        let unfolding =
            |c: &dyn DefiningSystem, j: usize, target: &mut [f64]| match c.unfolding(j, null) {
                Some(null) => target.copy_from_slice(null.border()),
                None => target.fill(0.0),
            };
        let mut columns = self.columns.chunks_exact_mut(n.max(1));
        let auxiliary = conditions.iter().flat_map(|c| (0..c.unknowns()).map(move |j| (c, j)));
        auxiliary.zip(&mut columns).for_each(|((c, j), target)| unfolding(&**c, j, target));
        for (&p, target) in released.iter().zip(columns) {
            self.direction[n + p] = 1.0;
            let outcome = system.derivative(x, &[&self.direction], target);
            self.direction[n + p] = 0.0;
            outcome?;
        }
        Ok(())
    }

    /// Writes the row of the closing equation, which is the last row.
    fn close(&mut self, row: &[f64]) {
        let (width, n) = (self.width, row.len() - self.width);
        self.rows[(width - 1) * n..].copy_from_slice(&row[..n]);
        self.corner[(width - 1) * width..].copy_from_slice(&row[n..]);
    }
}

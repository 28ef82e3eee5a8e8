//! Meshes of segments.

/// The mesh of a segment: increasing breakpoints in units of the segment's duration, from 0 to 1,
/// or from 0 to the number of periods for a solution that spans several periods.
///
/// ```
/// use tangency::core::bvp::Mesh;
/// assert_eq!(Mesh::uniform(4).points(), [0.0, 0.25, 0.5, 0.75, 1.0]);
/// assert_eq!(Mesh::uniform(4).stretched(2.0).end(), 2.0);
/// assert_eq!(Mesh::uniform(4).locate(0.375), (1, 0.5));
/// assert_eq!(Mesh::uniform(2).divided(2), Mesh::uniform(4));
/// assert!(Mesh::new(vec![0.0, 0.7, 0.3, 1.0]).is_err());
/// // Three times as dense in the first half.
/// let mesh = Mesh::uniform(2).equidistributed(&[3.0, 1.0], 4);
/// assert_eq!(mesh.points(), [0.0, 1.0 / 6.0, 1.0 / 3.0, 0.5, 1.0]);
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct Mesh {
    points: Vec<f64>,
}

/// The error that reports breakpoints that do not form a mesh.
#[derive(Clone, Debug, PartialEq, miette::Diagnostic, thiserror::Error)]
#[non_exhaustive]
pub enum MeshError {
    /// The mesh has no intervals.
    #[error("the mesh has {0} breakpoints, but needs at least 2 breakpoints")]
    Empty(usize),
    /// The mesh does not begin at 0.
    #[error("the mesh begins at {0}, but must begin at 0")]
    Start(f64),
    /// The breakpoints do not increase strictly.
    #[error(
        "breakpoint {index} of the mesh is {next}, but must be above the breakpoint before, \
         {before}"
    )]
    Order {
        /// The position of the offending breakpoint.
        index: usize,
        /// The previous breakpoint.
        before: f64,
        /// The breakpoint.
        next: f64,
    },
}

impl Mesh {
    /// Creates a mesh with given breakpoints.
    ///
    /// # Errors
    /// [`MeshError`] unless the breakpoints are finite and increase strictly from 0.
    pub fn new(points: Vec<f64>) -> Result<Self, MeshError> {
        if points.len() < 2 {
            return Err(MeshError::Empty(points.len()));
        }
        if points[0] != 0.0 {
            return Err(MeshError::Start(points[0]));
        }
        let rises = |k: &usize| points[k - 1] < points[*k] && points[*k].is_finite();
        match (1..points.len()).find(|k| !rises(k)) {
            Some(index) => {
                Err(MeshError::Order { index, before: points[index - 1], next: points[index] })
            }
            None => Ok(Mesh { points }),
        }
    }

    /// Whether all intervals have the same length, up to rounding errors.
    pub fn is_uniform(&self) -> bool {
        let length = self.end() / self.intervals() as f64;
        let is_same = |pair: &[f64]| (pair[1] - pair[0] - length).abs() <= 1e-10 * length;
        self.points.windows(2).all(is_same)
    }

    /// Creates a mesh of `intervals` intervals of equal length; the number of intervals is at least
    /// one.
    pub fn uniform(intervals: usize) -> Self {
        let count = intervals.max(1);
        Mesh { points: (0..=count).map(|k| k as f64 / count as f64).collect() }
    }

    /// Multiplies all breakpoints by a number, for example for a mesh of several periods. The mesh
    /// is unchanged if the number is not finite or not positive.
    pub fn stretched(mut self, factor: f64) -> Self {
        if factor.is_finite() && factor > 0.0 {
            self.points.iter_mut().for_each(|point| *point *= factor);
        }
        self
    }

    /// Divides each interval into `parts` intervals of equal length.
    pub fn divided(&self, parts: usize) -> Self {
        let mut points = vec![0.0];
        for pair in self.points.windows(2) {
            let length = pair[1] - pair[0];
            points.extend((1..parts).map(|k| pair[0] + length * (k as f64 / parts as f64)));
            points.push(pair[1]);
        }
        Mesh { points }
    }

    /// Creates the mesh whose intervals all have the same integral of a density, given as a constant
    /// on each interval of this mesh (C. de Boor, *Good approximation by splines with variable knots
    /// II*, 1974).
    ///
    /// Densities that are not finite, or all zero, give a uniform mesh.
    pub fn equidistributed(&self, density: &[f64], intervals: usize) -> Self {
        let end = self.end();
        let parts: Vec<f64> = self.lengths().zip(density).map(|(h, density)| h * density).collect();
        let total: f64 = parts.iter().sum();
        if !(total.is_finite() && total > 0.0) {
            return Mesh::uniform(intervals).stretched(end);
        }
        let mut points = vec![0.0];
        let (mut interval, mut before) = (0, 0.0);
        for k in 1..intervals.max(1) {
            let level = total * k as f64 / intervals as f64;
            while interval + 1 < parts.len() && before + parts[interval] < level {
                before += parts[interval];
                interval += 1;
            }
            let fraction = ((level - before) / parts[interval]).clamp(0.0, 1.0);
            let length = self.points[interval + 1] - self.points[interval];
            points.push(self.points[interval] + fraction * length);
        }
        points.push(end);
        Mesh { points }
    }

    /// Returns the integral of a density that is constant on each interval.
    pub(super) fn integral(&self, density: &[f64]) -> f64 {
        self.lengths().zip(density).map(|(h, density)| h * density).sum()
    }

    fn lengths(&self) -> impl Iterator<Item = f64> + '_ {
        self.points.windows(2).map(|pair| pair[1] - pair[0])
    }

    /// The breakpoints.
    pub fn points(&self) -> &[f64] {
        &self.points
    }

    /// The number of intervals.
    pub fn intervals(&self) -> usize {
        self.points.len() - 1
    }

    /// Returns the end of the mesh: 1, or the number of periods that the mesh spans.
    pub fn end(&self) -> f64 {
        self.points[self.intervals()]
    }

    /// Returns the interval that contains `tau`, and the position of `tau` in it from 0 to 1; if
    /// `tau` lies outside the mesh, returns the nearer end of the mesh.
    pub fn locate(&self, tau: f64) -> (usize, f64) {
        let above = self.points.partition_point(|point| *point <= tau);
        let interval = above.clamp(1, self.intervals()) - 1;
        let [start, end] = [self.points[interval], self.points[interval + 1]];
        (interval, ((tau - start) / (end - start)).clamp(0.0, 1.0))
    }
}

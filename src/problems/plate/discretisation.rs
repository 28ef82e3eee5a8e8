//! The parts of a plate model that do not depend on the deflection of the plate: functions,
//! quadrature rules, tables, moments.

use super::basis::{Basis, Table};
use super::edges::{InPlane, Supports};
use super::error::PlateError;
use super::orders::Orders;
use super::parameters::Units;
use super::plane::PlaneSpace;
use super::tensor::{Product, Rule, means, moments, pairs};
use super::terms::Theory;
use crate::core::failure::OutOfDomain;

/// The description of a plate from which [`Ritz::new`](super::Ritz::new) creates the model.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RitzSettings {
    /// The supports of the edges against deflection.
    pub supports: Supports,
    /// The supports of the edges against in-plane displacements.
    pub in_plane: InPlane,
    /// The theory of the plate: bending only, or bending and stretching.
    pub theory: Theory,
    /// The numbers of basis functions; by default numbers that suit the aspect ratio `aspect`.
    pub orders: Option<Orders>,
    /// The aspect ratio for which the default numbers of functions are chosen: the largest aspect
    /// ratio of interest if it is above 1, the smallest one if it is below 1.
    pub aspect: f64,
    /// The units and the meaning of the named parameters.
    pub units: Units,
    /// Whether to use the symmetry of the plate in each direction in which the two opposite edges
    /// have the same support. A load that breaks the symmetry (`edge_shear`) requires this setting
    /// to be `false`.
    pub symmetric: bool,
}

impl RitzSettings {
    /// Creates the settings of a plate with default in-plane supports and numbers of functions, von
    /// Kármán's theory and dimensionless parameters.
    pub fn new(supports: Supports) -> RitzSettings {
        RitzSettings {
            supports,
            in_plane: supports.usual_in_plane(),
            theory: Theory::default(),
            orders: None,
            aspect: 1.0,
            units: Units::Dimensionless,
            symmetric: true,
        }
    }

    /// Returns a flag for each direction: whether only displacements that are symmetric in this
    /// direction are considered.
    pub(super) fn symmetries(&self) -> [bool; 2] {
        self.supports.alike().map(|alike| alike && self.symmetric)
    }
}

/// The means, over one direction, of products of two transverse functions (basis functions of the
/// deflection); the pair `(i, k)` has the position `i·n + k`.
pub(super) struct LineMoments {
    pub values: Vec<f64>,
    pub slopes: Vec<f64>,
    pub curvatures: Vec<f64>,
    /// The means `⟨f_i" f_k⟩` of products of functions and their curvatures, and the transposed
    /// matrix.
    pub mixed: [Vec<f64>; 2],
    /// The means `⟨f_i' f_k⟩` of products of functions and their slopes, and the transposed matrix;
    /// zero by symmetry in symmetric directions.
    pub skew: [Vec<f64>; 2],
    pub means: Vec<f64>,
}

/// The transverse functions (basis functions of the deflection) at the nodes of one of the
/// quadrature rules for the electrostatic load.
pub(super) struct LoadRule {
    pub rules: [Rule; 2],
    pub tables: [Table; 2],
    /// The products `f_i f_k`, `i ≤ k`, of two transverse functions at the nodes.
    pub squares: [Vec<f64>; 2],
    /// The largest deflection at which this quadrature rule for the load is accurate to 1e-11.
    pub largest: f64,
}

/// The products of a transverse function and another function at the nodes of the quadrature rule
/// for stretching; the first index is the order of the derivative of the other function, the second
/// index is the order of the derivative of the transverse function.
pub(super) type PairTables = [[Vec<f64>; 2]; 2];

/// The tables at the nodes of the quadrature rule that integrates all products of strains exactly.
pub(super) struct Membrane {
    pub rules: [Rule; 2],
    pub w: [Table; 2],
    pub u: [Table; 2],
    pub v: [Table; 2],
    /// The products of two transverse functions, as tables for each direction.
    pub ww: [PairTables; 2],
    /// The products of basis functions of the displacement `u` and transverse functions, as tables
    /// for each direction.
    pub uw: [PairTables; 2],
    /// The products of basis functions of the displacement `v` and transverse functions, as tables
    /// for each direction.
    pub vw: [PairTables; 2],
}

/// The parts of a plate model that do not depend on the deflection of the plate.
pub(super) struct Discretisation {
    pub settings: RitzSettings,
    pub orders: Orders,
    /// A flag for each direction: whether only displacements that are symmetric in this direction
    /// are considered.
    pub symmetric: [bool; 2],
    pub transverse: [Basis; 2],
    pub lines: [LineMoments; 2],
    pub loads: Vec<LoadRule>,
    pub membrane: Option<Membrane>,
    pub plane: PlaneSpace,
    /// The factors by which the products `f_i g_j` of basis functions are scaled; see [`scales`].
    pub scale: Vec<f64>,
}

/// The largest allowed deflection, relative to the gap. At larger deflections, the quadrature error
/// of the electrostatic load exceeds 1e-11.
pub(super) const LARGEST_DEFLECTION: f64 = 0.96;

impl Discretisation {
    pub fn new(settings: RitzSettings) -> Result<Discretisation, PlateError> {
        let supports = settings.supports;
        let symmetric = settings.symmetries();
        let orders = settings.orders.unwrap_or_else(|| Orders::usual(symmetric, settings.aspect));
        orders.check()?;
        check_held(supports)?;
        let ends = [supports.x(), supports.y()];
        let transverse = [0, 1].map(|axis| {
            Basis::transverse(ends[axis], symmetric[axis], orders.transverse[axis])
                .into_beam_modes(symmetric[axis])
        });
        let plane = PlaneSpace::new(supports, settings.in_plane, symmetric, orders.in_plane);
        let membrane = (settings.theory == Theory::VonKarman)
            .then(|| Membrane::new(&transverse, &plane, symmetric));
        let lines = [0, 1].map(|axis| LineMoments::new(&transverse[axis], symmetric[axis]));
        let loads = [(16, 0.5), (24, 0.75), (32, 0.88), (48, LARGEST_DEFLECTION)]
            .map(|(count, largest)| LoadRule::new(&transverse, symmetric, count, largest))
            .into();
        let scale = scales(&lines);
        Ok(Discretisation {
            settings,
            orders,
            symmetric,
            transverse,
            lines,
            loads,
            membrane,
            plane,
            scale,
        })
    }

    /// Returns the mass matrix of the plate.
    pub fn mass(&self) -> Vec<f64> {
        let [x, y] = &self.lines;
        let [nx, ny] = [0, 1].map(|axis| self.transverse[axis].len());
        let n = nx * ny;
        let entry = |k: usize| {
            let (row, column) = (k % n, k / n);
            let products =
                x.values[(row / ny) * nx + column / ny] * y.values[(row % ny) * ny + column % ny];
            products * self.scale[row] * self.scale[column]
        };
        (0..n * n).map(entry).collect()
    }

    /// Returns the number of unknowns of the plate model.
    pub fn unknowns(&self) -> usize {
        self.transverse[0].len() * self.transverse[1].len()
    }

    /// Returns the quadrature rules for both directions that integrate products of two transverse
    /// functions, or of their slopes, exactly.
    pub fn product_rules(&self) -> [Rule; 2] {
        [0, 1].map(|axis| Rule::exact(2 * self.transverse[axis].degree(), self.symmetric[axis]))
    }

    /// Returns an error if a shear force is applied but symmetry excludes the functions that
    /// describe its effect.
    pub fn check_shear(&self, shear: f64) -> Result<(), OutOfDomain> {
        if shear == 0.0 || self.symmetric == [false; 2] || self.settings.supports.any_free() {
            return Ok(());
        }
        let remedy = "shear breaks the plate's symmetry: build the plate with symmetric = false";
        Err(OutOfDomain::new("edge_shear", shear, remedy))
    }

    /// Returns the quadrature rule for the electrostatic load that is accurate up to the deflection
    /// `largest`.
    pub fn load_rule(&self, largest: f64) -> &LoadRule {
        let good = self.loads.iter().find(|rule| largest <= rule.largest);
        good.unwrap_or(&self.loads[self.loads.len() - 1])
    }
}

/// Returns the factors `d_ij` of the functions `d_ij f_i g_j`, which satisfy
///
/// ```text
/// d_ij² (bending energy of f_i g_j + 100 mean square) = 100
/// ```
///
/// With these factors, a change of an unknown by 1 changes the deflection by about one gap in the
/// lowest modes. Products of two functions of high order contain almost no bending energy; without
/// scaling, rounding errors in their coefficients would dominate the norm of the unknowns.
fn scales([x, y]: &[LineMoments; 2]) -> Vec<f64> {
    let count = [x, y].map(|line| line.means.len());
    let mut scales = Vec::with_capacity(count[0] * count[1]);
    for i in (0..count[0]).map(|i| i * (count[0] + 1)) {
        for j in (0..count[1]).map(|j| j * (count[1] + 1)) {
            let bending = x.curvatures[i] * y.values[j]
                + x.values[i] * y.curvatures[j]
                + 2.0 * x.slopes[i] * y.slopes[j];
            scales.push(10.0 / (16.0 * bending + 100.0 * x.values[i] * y.values[j]).sqrt());
        }
    }
    scales
}

/// Returns an error if the supports permit a rigid-body motion: a translation, a rotation, or a
/// twist.
fn check_held(supports: Supports) -> Result<(), PlateError> {
    use super::edges::Support::{Clamped, Free};
    let clamped = supports.0.contains(&Clamped);
    let held = supports.0.iter().filter(|edge| **edge != Free).count();
    if clamped || held >= 2 {
        Ok(())
    } else {
        Err(PlateError::Unsupported { supports: supports.to_string() })
    }
}

impl LineMoments {
    fn new(basis: &Basis, symmetric: bool) -> LineMoments {
        let rule = Rule::exact(2 * basis.degree(), symmetric);
        let Table { values, slopes, curvatures, .. } = basis.table(&rule.nodes);
        let mut skew = [moments(&rule, &slopes, &values), moments(&rule, &values, &slopes)];
        if symmetric {
            skew.iter_mut().for_each(|matrix| matrix.fill(0.0));
        }
        LineMoments {
            values: moments(&rule, &values, &values),
            slopes: moments(&rule, &slopes, &slopes),
            curvatures: moments(&rule, &curvatures, &curvatures),
            mixed: [moments(&rule, &curvatures, &values), moments(&rule, &values, &curvatures)],
            skew,
            means: means(&rule, &values),
        }
    }
}

impl LoadRule {
    fn new(transverse: &[Basis; 2], symmetric: [bool; 2], count: usize, largest: f64) -> LoadRule {
        let rules = [0, 1].map(|axis| {
            // The bending moments require at least this number of nodes.
            Rule::halves(count.max(transverse[axis].degree() + 2), symmetric[axis])
        });
        let tables = [0, 1].map(|axis| transverse[axis].table(&rules[axis].nodes));
        let squares = [0, 1].map(|axis| {
            let (points, values) = (rules[axis].len(), &tables[axis].values);
            let products = values.chunks_exact(points).enumerate();
            products.flat_map(|(i, f)| pairs(points, f, &values[i * points..])).collect()
        });
        LoadRule { rules, tables, squares, largest }
    }

    pub fn values(&self) -> Product<'_> {
        Product {
            x: &self.tables[0].values,
            y: &self.tables[1].values,
            points: [self.rules[0].len(), self.rules[1].len()],
        }
    }
}

impl Membrane {
    fn new(transverse: &[Basis; 2], plane: &PlaneSpace, symmetric: [bool; 2]) -> Membrane {
        let rules = [0, 1].map(|axis| {
            let w = transverse[axis].degree();
            let s = plane.u[axis].degree().max(plane.v[axis].degree());
            Rule::exact((4 * w).max(2 * w + s).max(2 * s), symmetric[axis])
        });
        let tables = |bases: &[Basis; 2]| [0, 1].map(|axis| bases[axis].table(&rules[axis].nodes));
        let (w, u, v) = (tables(transverse), tables(&plane.u), tables(&plane.v));
        let with_w = |others: &[Table; 2]| {
            [0, 1].map(|axis| {
                let (points, w) = (rules[axis].len(), &w[axis]);
                [&others[axis].values, &others[axis].slopes]
                    .map(|other| [pairs(points, other, &w.values), pairs(points, other, &w.slopes)])
            })
        };
        let (ww, uw, vw) = (with_w(&w), with_w(&u), with_w(&v));
        Membrane { rules, w, u, v, ww, uw, vw }
    }

    pub fn points(&self) -> [usize; 2] {
        [self.rules[0].len(), self.rules[1].len()]
    }

    /// Returns two tables of products of functions, which give the derivatives with respect to ξ
    /// and to ζ of a field that is expanded in the functions of `tables`.
    pub fn slopes<'a>(&self, tables: &'a [Table; 2]) -> [Product<'a>; 2] {
        let points = self.points();
        [
            Product { x: &tables[0].slopes, y: &tables[1].values, points },
            Product { x: &tables[0].values, y: &tables[1].slopes, points },
        ]
    }
}

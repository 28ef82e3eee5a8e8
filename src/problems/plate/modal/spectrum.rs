//! The modes of the flat plate, computed to a requested accuracy and in a reproducible order.

use super::settings::ModalSettings;
use super::tables::Nodes;
use crate::problems::plate::discretisation::RitzSettings;
use crate::problems::plate::error::PlateError;
use crate::problems::plate::modes::Modes;
use crate::problems::plate::orders::Orders;
use crate::problems::plate::ritz::Ritz;
use crate::problems::plate::tensor::Rule;
use crate::problems::plate::terms::Theory;
use faer::{Mat, Side};

/// The maximum number of basis functions of the deflection; with more functions, the solution of
/// the eigenproblem would take seconds.
const LARGEST_RUNG: usize = 600;

/// The number of modes that are computed in addition to the requested modes, so that all modes with
/// the same frequency as the last requested mode are known when modes of equal frequency are
/// chosen.
const BEYOND: usize = 6;

/// The number by which the in-plane functions exceed the transverse functions in each direction;
/// more in-plane functions are needed because stresses contain products of slopes.
const IN_PLANE_BEYOND: usize = 6;

/// The lowest modes of the flat plate, in the unknowns of a full plate model.
pub(super) struct FlatModes {
    /// The full plate model in whose unknowns the modes are expressed.
    pub plate: Ritz,
    /// `ω²`.
    pub squares: Vec<f64>,
    /// The coefficients of the modes in the unknowns of `plate`; each mode has the mean square 1
    /// over the plate.
    pub shapes: Vec<Vec<f64>>,
}

impl FlatModes {
    /// Computes the modes of the flat plate that the settings request. If the settings do not
    /// contain numbers of functions, successively finer discretisations are tried until the modes
    /// of two successive discretisations agree; otherwise the modes for the given numbers of
    /// functions must agree with the modes of the next finer discretisation.
    pub fn new(settings: &ModalSettings) -> Result<FlatModes, PlateError> {
        let asked = settings.modes;
        let mut orders = settings.plate.orders.unwrap_or_else(|| first_rung(settings));
        let mut coarse = Rung::new(settings, orders)?;
        loop {
            let fine = Rung::new(settings, orders.finer())?;
            let error = coarse.error(&fine, asked);
            let fits = error <= settings.mode_accuracy;
            if fits && settings.plate.orders.is_some() {
                return coarse.ordered(settings, orders);
            }
            orders = with_in_plane(orders.finer());
            if fits {
                return fine.ordered(settings, orders);
            }
            let [x, y] = orders.finer().transverse;
            if settings.plate.orders.is_some() || x * y > LARGEST_RUNG {
                let good = (0..asked)
                    .take_while(|&k| coarse.error(&fine, k + 1) <= settings.mode_accuracy);
                return Err(PlateError::Accuracy {
                    modes: asked,
                    accuracy: settings.mode_accuracy,
                    error,
                    functions: settings.plate.orders.unwrap_or(orders).transverse,
                    accurate: good.count(),
                });
            }
            coarse = fine;
        }
    }
}

/// Adds the numbers of in-plane functions that suit the given numbers of transverse functions.
fn with_in_plane(orders: Orders) -> Orders {
    Orders { in_plane: orders.transverse.map(|n| n + IN_PLANE_BEYOND), ..orders }
}

/// Returns the smallest sufficient numbers of functions, starting with the default numbers: the
/// functions must outnumber the requested modes by at least [`BEYOND`].
fn first_rung(settings: &ModalSettings) -> Orders {
    let RitzSettings { supports, symmetric, aspect, .. } = settings.plate;
    let symmetric = supports.alike().map(|alike| alike && symmetric);
    let mut orders = Orders::usual(symmetric, aspect);
    while orders.transverse[0] * orders.transverse[1] < settings.modes + BEYOND {
        orders = orders.finer();
    }
    with_in_plane(orders)
}

/// The modes computed with one of the successively finer discretisations, whose basis functions
/// span a space of polynomials.
struct Rung {
    plate: Ritz,
    modes: Modes,
}

impl Rung {
    fn new(settings: &ModalSettings, orders: Orders) -> Result<Rung, PlateError> {
        let bending = RitzSettings {
            theory: Theory::Linear,
            // Only bending is needed, so the in-plane functions are the fewest possible.
            orders: Some(Orders { transverse: orders.transverse, in_plane: [2, 2] }),
            ..settings.plate
        };
        let mut plate = Ritz::new(bending)?;
        let (aspect, count) = (settings.plate.aspect, settings.modes + BEYOND);
        let modes = plate.flat_modes(aspect, settings.nu, count)?;
        Ok(Rung { plate, modes })
    }

    /// Returns the largest relative difference between the squared frequencies `ω²` of the lowest
    /// `count` modes in two discretisations; infinite if one of the discretisations has fewer
    /// modes.
    fn error(&self, finer: &Rung, count: usize) -> f64 {
        let (coarse, fine) = (&self.modes.squares, &finer.modes.squares);
        if coarse.len().min(fine.len()) < count {
            return f64::INFINITY;
        }
        let pairs = coarse.iter().zip(fine).take(count);
        pairs.map(|(a, b)| (a - b).abs() / b.abs()).fold(0.0, f64::max)
    }

    /// Makes the choice of modes with equal frequency unique: for the chosen modes, the matrix of
    /// the means `⟨φ_ix φ_kx⟩` is diagonal, in ascending order. Without this rule, the combination
    /// of modes of equal frequency would depend on rounding errors; for a supported square plate,
    /// the rule yields the modes (1,3), (3,1). The sign of each mode is chosen so that its first
    /// nonzero moment is positive.
    fn ordered(self, settings: &ModalSettings, orders: Orders) -> Result<FlatModes, PlateError> {
        let Rung { plate: bending, modes: Modes { squares, mut shapes } } = self;
        let rules = bending.model.product_rules();
        let nodes =
            |shapes: &[Vec<f64>]| Nodes::new(&bending, shapes, &rules, settings.plate.aspect);
        let mut first = 0;
        while first < squares.len() {
            let equal = |square: f64| square <= squares[first] * (1.0 + settings.mode_accuracy);
            let last = first + squares[first..].iter().take_while(|s| equal(**s)).count().max(1);
            if last > first + 1 {
                separate(&nodes(&shapes[first..last]), &mut shapes[first..last]);
            }
            first = last;
        }
        shapes.truncate(settings.modes);
        let at_nodes = nodes(&shapes);
        for (mode, shape) in shapes.iter_mut().enumerate() {
            let sign = sign(&at_nodes, mode, &rules);
            shape.iter_mut().for_each(|c| *c *= sign);
        }
        // The plate has the same transverse functions, with in-plane ones added.
        let plate = Ritz::new(RitzSettings { orders: Some(orders), ..settings.plate })?;
        Ok(FlatModes { plate, squares: squares[..settings.modes].to_vec(), shapes })
    }
}

/// Rotates orthonormal shapes within their span such that the matrix of the means `⟨φ_ix φ_kx⟩`
/// becomes diagonal, in ascending order.
fn separate(nodes: &Nodes, shapes: &mut [Vec<f64>]) {
    let count = shapes.len();
    let gram = nodes.gram(&nodes.slopes[0], &nodes.slopes[0]);
    let gram = Mat::from_fn(count, count, |i, k| gram[i * count + k]);
    // If the eigenproblem has no solution (values that are not finite), the shapes are unchanged.
    let Ok(eigen) = gram.self_adjoint_eigen(Side::Lower) else { return };
    let turned: Vec<Vec<f64>> = (0..count)
        .map(|mode| {
            let mut shape = vec![0.0; shapes[0].len()];
            for (k, old) in shapes.iter().enumerate() {
                let factor = eigen.U()[(k, mode)];
                shape.iter_mut().zip(old).for_each(|(new, old)| *new += factor * old);
            }
            shape
        })
        .collect();
    shapes.clone_from_slice(&turned);
}

/// Returns the sign of a mode: the sign of its first moment whose absolute value exceeds rounding
/// errors.
fn sign(nodes: &Nodes, mode: usize, rules: &[Rule; 2]) -> f64 {
    let modes = nodes.values.len() / nodes.weights.len();
    let moment = |[i, j]: [i32; 2]| -> f64 {
        let terms = nodes.values.iter().skip(mode).step_by(modes).zip(&nodes.weights).enumerate();
        let columns = rules[1].len();
        let terms = terms.map(|(node, (w, weight))| {
            let [x, y] = [rules[0].nodes[node / columns], rules[1].nodes[node % columns]];
            w * weight * x.powi(i) * y.powi(j)
        });
        terms.sum()
    };
    let moments = [[0, 0], [2, 0], [1, 0], [0, 1], [1, 1], [2, 1], [1, 2], [3, 0], [0, 3]];
    let noted = moments.into_iter().map(moment).find(|moment| moment.abs() > 1e-6);
    noted.map_or(1.0, f64::signum)
}

//! The flat plate's modes, accurate to what is asked for and in a reproducible order.

use super::error::ModalError;
use super::{ModalSettings, tables};
use crate::problems::plate::Modes;
use crate::problems::plate::model::{Model, RitzSettings, Theory};
use crate::problems::plate::orders::Orders;
use crate::problems::plate::ritz::Ritz;
use crate::problems::plate::tensor::Rule;
use faer::{Mat, Side};

/// The most transverse functions tried: the eigenproblem of the next rung would take seconds.
const LARGEST_RUNG: usize = 600;

/// Modes computed beyond those asked for, so that the last one's equals are all there to be ordered.
const BEYOND: usize = 6;

/// In-plane functions beyond the transverse ones in each direction: stresses contain products of slopes.
const IN_PLANE_BEYOND: usize = 6;

/// The lowest modes of the flat plate.
pub(super) struct FlatModes {
    /// Functions that the modes are combinations of.
    pub model: Model,
    /// Numbers of functions, for the deflection and in the plane.
    pub orders: Orders,
    /// `ω²`.
    pub squares: Vec<f64>,
    /// Coefficients in the unknowns of `model`, of mean square 1 over the plate.
    pub shapes: Vec<Vec<f64>>,
}

impl FlatModes {
    /// As many modes as the settings ask for. Without orders in the settings, rung after rung of the
    /// ladder of orders until two agree; with them, their modes must agree with the next rung's.
    pub fn new(settings: &ModalSettings) -> Result<FlatModes, ModalError> {
        let asked = settings.modes;
        let mut orders = settings.plate.orders.unwrap_or_else(|| first_rung(settings));
        let mut coarse = Rung::new(settings, orders)?;
        loop {
            let fine = Rung::new(settings, orders.finer())?;
            let error = coarse.error(&fine, asked);
            let fits = error <= settings.mode_accuracy;
            if fits && settings.plate.orders.is_some() {
                return Ok(coarse.ordered(settings, orders));
            }
            orders = fine_orders(orders);
            if fits {
                return Ok(fine.ordered(settings, orders));
            }
            let [x, y] = orders.finer().transverse;
            if settings.plate.orders.is_some() || x * y > LARGEST_RUNG {
                let good = (0..asked)
                    .take_while(|&k| coarse.error(&fine, k + 1) <= settings.mode_accuracy);
                return Err(ModalError::Accuracy {
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

/// The next rung, with in-plane functions to go with it.
fn fine_orders(orders: Orders) -> Orders {
    with_in_plane(orders.finer())
}

fn with_in_plane(orders: Orders) -> Orders {
    Orders {
        in_plane: orders
            .transverse
            .map(|n| n + IN_PLANE_BEYOND + super::projection::env("MORE_PLANE")),
        ..orders
    }
}

/// The usual orders, or the first ones above with more functions than modes and their equals.
fn first_rung(settings: &ModalSettings) -> Orders {
    let RitzSettings { supports, symmetric, aspect, .. } = settings.plate;
    let symmetric = supports.alike().map(|alike| alike && symmetric);
    let mut orders = Orders::usual(supports, symmetric, aspect);
    while orders.transverse[0] * orders.transverse[1] < settings.modes + BEYOND {
        orders = orders.finer();
    }
    with_in_plane(orders)
}

/// The modes in one space of polynomials.
struct Rung {
    model: Model,
    modes: Modes,
}

impl Rung {
    fn new(settings: &ModalSettings, orders: Orders) -> Result<Rung, ModalError> {
        let bending = RitzSettings {
            theory: Theory::Linear,
            // Bending alone: no in-plane functions are wanted, and these are the fewest.
            orders: Some(Orders { transverse: orders.transverse, in_plane: [2, 2] }),
            ..settings.plate
        };
        let mut plate = Ritz::new(bending)?;
        let modes = plate.flat_modes(settings.plate.aspect, settings.nu, settings.modes + BEYOND);
        let modes = modes.map_err(crate::problems::plate::PlateError::from)?;
        Ok(Rung { model: plate.model, modes })
    }

    /// The largest relative difference of `ω²` among the lowest modes; infinite where there are not as many.
    fn error(&self, finer: &Rung, count: usize) -> f64 {
        let (coarse, fine) = (&self.modes.squares, &finer.modes.squares);
        if coarse.len().min(fine.len()) < count {
            return f64::INFINITY;
        }
        let pairs = coarse.iter().zip(fine).take(count);
        pairs.map(|(a, b)| (a - b).abs() / b.abs()).fold(0.0, f64::max)
    }

    /// Chooses among modes of equal frequency: those in which `⟨φ_x²⟩` is diagonal, in ascending order.
    /// The eigenproblem leaves their combination to rounding; a supported square plate's become
    /// (1,3), (3,1). Signs are such that the first of some moments that is not zero is positive.
    fn ordered(self, settings: &ModalSettings, orders: Orders) -> FlatModes {
        let Rung { model, modes: Modes { squares, mut shapes } } = self;
        let rules = [0, 1]
            .map(|axis| Rule::exact(2 * model.transverse[axis].degree(), model.symmetric[axis]));
        let mut first = 0;
        while first < squares.len() {
            let equal = |square: f64| square <= squares[first] * (1.0 + settings.mode_accuracy);
            let last = first + squares[first..].iter().take_while(|s| equal(**s)).count().max(1);
            if last > first + 1 {
                separate(&model, &rules, &mut shapes[first..last]);
            }
            first = last;
        }
        shapes.truncate(settings.modes);
        for shape in &mut shapes {
            let sign = sign(&model, &rules, shape);
            shape.iter_mut().for_each(|c| *c *= sign);
        }
        FlatModes { model, orders, squares: squares[..settings.modes].to_vec(), shapes }
    }
}

/// Turns orthonormal shapes within the space they span until `⟨φ_x²⟩` is diagonal and ascends.
fn separate(model: &Model, rules: &[Rule; 2], shapes: &mut [Vec<f64>]) {
    let slopes = tables::fields(model, shapes, rules, [1, 0]);
    let weights = tables::weights(rules);
    let count = shapes.len();
    let gram = Mat::from_fn(count, count, |i, k| {
        let products = slopes[i].iter().zip(&slopes[k]).zip(&weights);
        products.map(|((a, b), w)| a * b * w).sum::<f64>()
    });
    // Without a solution (values that are not finite) the shapes stay as they are.
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

/// The sign of the first moment of a mode that is not zero to rounding.
fn sign(model: &Model, rules: &[Rule; 2], shape: &[f64]) -> f64 {
    let field = &tables::fields(model, &[shape.to_vec()], rules, [0, 0])[0];
    let weights = tables::weights(rules);
    let columns = rules[1].len();
    let moment = |[i, j]: [i32; 2]| -> f64 {
        let terms = field.iter().zip(&weights).enumerate().map(|(node, (w, weight))| {
            let [x, y] = [rules[0].nodes[node / columns], rules[1].nodes[node % columns]];
            w * weight * x.powi(i) * y.powi(j)
        });
        terms.sum()
    };
    let moments = [[0, 0], [2, 0], [1, 0], [0, 1], [1, 1], [2, 1], [1, 2], [3, 0], [0, 3]];
    let noted = moments.into_iter().map(moment).find(|moment| moment.abs() > 1e-6);
    noted.map_or(1.0, f64::signum)
}

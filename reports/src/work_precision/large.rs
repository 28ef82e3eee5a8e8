//! Diagrams of the time that dense and sparse matrices take, against the number of unknowns:
//! Bratu's problem on a line and in a square, and cycles of the Brusselator with diffusion.

use super::plan::{Answer, Method, Plan};
use crate::Drawn;
use diffusive_brusselator::DiffusiveBrusselator;
use tangency::core::bvp::Collocation;
use tangency::core::continuation::{Continuation, Settings};
use tangency::core::failure::one_line;
use tangency::core::orbit::periodic_orbits;
use tangency::core::problem::{Equilibria, Names, ZeroProblem};
use tangency::core::scalar::Scalar;
use tangency::core::system::{Dense, Kind, Matrices, Sparse, System};

#[path = "../../../tests/common/diffusive_brusselator.rs"]
mod diffusive_brusselator;

/// Bratu's problem, `Δu + λ eᵘ = 0` with `u = 0` on the boundary, discretised by second-order
/// differences.
#[derive(Clone, Copy)]
struct Bratu {
    /// The number of interior mesh points in each direction.
    points: usize,
    /// The number of spatial dimensions: 1 or 2.
    directions: u32,
}

impl Bratu {
    fn unknowns(self) -> usize {
        self.points.pow(self.directions)
    }
}

impl ZeroProblem for Bratu {
    fn names(&self) -> Names {
        Names::new([("u", self.unknowns())], ["lambda"]).with_monitors(["middle"])
    }

    fn residual<T: Scalar>(&self, u: &[T], p: &[T], r: &mut [T]) {
        let m = self.points;
        let inverse = ((m + 1) * (m + 1)) as f64;
        for (k, r) in r.iter_mut().enumerate() {
            *r = p[0] * u[k].exp();
            for direction in 0..self.directions {
                let (from, place) = (m.pow(direction), k / m.pow(direction) % m);
                let left = if place > 0 { u[k - from] } else { T::zero() };
                let right = if place + 1 < m { u[k + from] } else { T::zero() };
                *r += (left + right - u[k] * 2.0) * inverse;
            }
        }
    }

    fn monitors<T: Scalar>(&self, u: &[T], _p: &[T], values: &mut [T]) {
        let middle =
            (0..self.directions).map(|direction| self.points.pow(direction)).sum::<usize>();
        values[0] = u[self.points / 2 * middle];
    }
}

/// Computes the load λ at the fold, from a branch traced to twice the deflection at the fold.
fn fold(system: &mut dyn System, most: f64) -> Result<Answer, String> {
    let unknowns = system.names().dimension();
    let settings = Settings { max_points: 60, ..Settings::default() };
    let run = Continuation::new(system).settings(settings).along("lambda", 0.0..=most);
    let branch = run.bound("middle", ..=2.0).trace().map_err(|cause| one_line(&cause))?;
    let fold = branch.of_kind(Kind::LP).next().ok_or("no fold")?;
    Ok(Answer { numbers: vec![fold.parameters[0]], work: unknowns as f64 })
}

/// Plans the diagram of the time to trace a branch against the number of unknowns. The error in the
/// diagram is the discretisation error of the finite differences.
fn plan(name: &str, directions: u32, exact: f64, points: [&[usize]; 2]) -> Plan {
    let most = 2.0 * exact;
    let method = |sparse: bool, points: usize| {
        let problem = Bratu { points, directions };
        let line = if sparse { "sparse matrices" } else { "dense matrices" };
        Method::new(line, problem.unknowns().to_string(), move || match sparse {
            true => fold(&mut Sparse::new(problem), most),
            false => fold(&mut Dense::new(problem), most),
        })
    };
    let reference = Method::new("the fold of the equations", "", move || {
        Ok(Answer { numbers: vec![exact], work: 0.0 })
    });
    let [dense, sparse] = points;
    let plan = Plan::of(name, reference).counting("unknowns").relative();
    plan.drawing(Drawn::TimeAgainstWork)
        .with(dense.iter().map(|points| method(false, *points)))
        .with(sparse.iter().map(|points| method(true, *points)))
}

/// Computes the period of the cycle at `L = 0.6` on the branch from the first Hopf point.
fn period(points: usize, matrices: Matrices) -> Result<Answer, String> {
    let problem = || DiffusiveBrusselator::new(points);
    let rest = [vec![2.0; points], vec![5.45 / 2.0; points]].concat();
    let mut equilibria = Sparse::new(Equilibria::new(problem()));
    let stated = Continuation::new(&mut equilibria).at("L", 0.5).at("A", 2.0).at("B", 5.45);
    let branch =
        stated.from(&rest[..]).along("L", 0.5..=0.7).trace().map_err(|cause| one_line(&cause))?;
    let hopf = branch.of_kind(Kind::HB).next().ok_or("no Hopf point")?;
    let method = Collocation::new(4).map_err(|cause| one_line(&cause))?.with_matrices(matrices);
    let mut orbits = periodic_orbits(problem(), 20, method).map_err(|cause| one_line(&cause))?;
    let cycles = Continuation::new(&mut orbits).restart(&branch, hopf.label);
    let cycles = cycles.along("L", 0.5..=0.6).trace().map_err(|cause| one_line(&cause))?;
    let end = cycles.special.last().ok_or("no end")?;
    let period = end.state.last().copied().unwrap_or(f64::NAN);
    Ok(Answer { numbers: vec![period], work: 2.0 * points as f64 })
}

/// Plans the diagram of the time to trace a branch of cycles against the number of states. The error in
/// the diagram is the discretisation error in space.
fn cycles() -> Plan {
    let method = |matrices: Matrices, points: usize| {
        let line = if matrices == Matrices::Sparse { "sparse matrices" } else { "dense matrices" };
        Method::new(line, (2 * points).to_string(), move || period(points, matrices))
    };
    let reference = Method::new("Richardson's extrapolation", "", || {
        let [coarse, fine] = [40, 80].map(|points: usize| -> Result<_, String> {
            let squared = ((points + 1) as f64).powi(-2);
            Ok((squared, period(points, Matrices::Sparse)?.numbers[0]))
        });
        let ((h, coarse), (k, fine)): ((f64, f64), (f64, f64)) = (coarse?, fine?);
        Ok(Answer { numbers: vec![(h * fine - k * coarse) / (h - k)], work: 0.0 })
    });
    Plan::of("Cycles of the Brusselator on a line", reference)
        .counting("states")
        .relative()
        .drawing(Drawn::TimeAgainstWork)
        .with([4, 8, 12, 24, 40].map(|points| method(Matrices::Dense, points)))
        .with([4, 8, 12, 24, 40, 80].map(|points| method(Matrices::Sparse, points)))
}

/// Plans the diagrams of time against the number of unknowns, on a line and in a square, and of
/// cycles.
pub(super) fn plans() -> Vec<Plan> {
    // 8 (θ / cosh θ)² with θ tanh θ = 1.
    let line = plan(
        "Bratu's problem on a line",
        1,
        3.513_830_719_125_162,
        [&[20, 40, 60, 80, 160, 320], &[20, 40, 60, 80, 160, 320, 1280, 5120, 20480]],
    );
    // The reference value comes from Richardson's extrapolation.
    let square = plan(
        "Bratu's problem in a square",
        2,
        6.808_124_423,
        [&[5, 7, 9, 12, 18], &[5, 7, 9, 12, 18, 36, 72, 144]],
    );
    vec![line, square, cycles()]
}

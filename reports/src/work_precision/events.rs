//! Work-precision diagram of a grazing point: one method solves the defining system of the grazing
//! point; the other methods simulate the motion repeatedly, and find the largest displacement of
//! the motion at mesh points or inside integration steps.

use super::period::{Period, parameters};
use super::plan::{Answer, Method, Plan};
use super::scenes::{Counted, GRAZING, PASSING, tracing};
use tangency::core::ode::work;

/// The distance between the resting mass and the stopper.
const CLEARANCE: f64 = 0.5;
/// The two voltages between which the orbit grazes the stopper.
const BRACKET: [f64; 2] = [0.2, 0.24];

/// The distance between the stopper and the orbit without impacts, as a function of the voltage;
/// each orbit is the initial guess for the next orbit.
struct Distance {
    near: [f64; 2],
    tolerance: f64,
    mesh: Option<usize>,
}

impl Distance {
    fn at(&mut self, voltage: f64) -> Result<f64, String> {
        let period = Period { impacts: false, p: parameters(voltage), tolerance: self.tolerance };
        self.near = period.fixed_point(self.near)?;
        Ok(CLEARANCE - period.largest(self.near, self.mesh)?)
    }
}

/// The method that finds the voltage at which the distance between the orbit and the stopper is
/// zero.
#[derive(Clone, Copy)]
enum Finder {
    Bisection,
    Secant,
}

impl Finder {
    fn zero(
        self,
        mut f: impl FnMut(f64) -> Result<f64, String>,
        tolerance: f64,
    ) -> Result<f64, String> {
        let [mut a, mut b] = BRACKET;
        let [mut at_a, mut at_b] = [f(a)?, f(b)?];
        for _ in 0..60 {
            let next = match self {
                Finder::Bisection => 0.5 * (a + b),
                Finder::Secant => b - at_b * (b - a) / (at_b - at_a),
            };
            let value = f(next)?;
            let change = match self {
                Finder::Bisection => b - a,
                Finder::Secant => next - b,
            };
            match self {
                Finder::Bisection if value * at_b <= 0.0 => (a, at_a) = (next, value),
                Finder::Bisection => (b, at_b) = (next, value),
                Finder::Secant => ((a, at_a), (b, at_b)) = ((b, at_b), (next, value)),
            }
            if change.abs() <= tolerance || value == 0.0 {
                return Ok(next);
            }
        }
        Ok(b)
    }
}

fn repeated(line: &'static str, finder: Finder, tolerance: f64, mesh: Option<usize>) -> Method {
    let setting = match mesh {
        Some(parts) => format!("{parts} parts"),
        None => format!("{tolerance:.0e}"),
    };
    Method::new(line, setting, move || {
        let before = work().evaluations;
        let mut distance =
            Distance { near: [0.0; 2], tolerance: (0.1 * tolerance).max(1e-14), mesh };
        let voltage = finder.zero(|voltage| distance.at(voltage), tolerance)?;
        Ok(Answer { numbers: vec![voltage], work: (work().evaluations - before) as f64 })
    })
}

/// Plans the diagram of the voltage at which the orbit without impacts grazes the stopper.
pub(super) fn plans() -> Vec<Plan> {
    let defining = |tolerance: &str, line: &str| {
        let settings = [("flow_tolerance", tolerance)];
        tracing((line, tolerance.into()), PASSING, &settings, GRAZING, Counted::Evaluations)
    };
    let mut methods = Vec::new();
    for tolerance in [1e-3, 1e-5, 1e-7, 1e-9, 1e-11] {
        methods.push(repeated("bisection", Finder::Bisection, tolerance, None));
        methods.push(repeated("secant method", Finder::Secant, tolerance, None));
    }
    let on_mesh = "secant method, largest value on a mesh";
    let parts = [16, 64, 256, 1024, 4096].map(Some);
    methods.extend(parts.map(|parts| repeated(on_mesh, Finder::Secant, 1e-11, parts)));
    let tolerances = ["1e-4", "1e-6", "1e-8", "1e-10", "1e-12"];
    methods.extend(tolerances.map(|tolerance| defining(tolerance, "defining system on a branch")));
    let reference = defining("1e-14", "the defining system");
    let plan = Plan::of("Voltage of a grazing", reference).counting("evaluations of the field");
    vec![plan.with(methods).recommending("defining system on a branch", "1e-12")]
}

//! Parallel-plate actuator, u = load/(1 − u)²: it pulls in at u = 1/3, load = 4/27.
use tangency::core::continuation::{Continuation, Settings};
use tangency::core::problem::{Names, ZeroProblem};
use tangency::core::scalar::Scalar;
use tangency::core::system::Dense;
use tangency::output::{Document, csv, diagram, draw, write_atomically};

struct ParallelPlate;

impl ZeroProblem for ParallelPlate {
    fn names(&self) -> Names {
        Names::new(["u"], ["load"]).with_monitors(["deflection"])
    }

    fn residual<T: Scalar>(&self, u: &[T], p: &[T], r: &mut [T]) {
        r[0] = p[0] / (T::one() - u[0]).powi(2) - u[0];
    }

    fn monitors<T: Scalar>(&self, u: &[T], _p: &[T], values: &mut [T]) {
        values[0] = u[0];
    }
}

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let mut plate = Dense::new(ParallelPlate);
    let branch = Continuation::new(&mut plate)
        .named("plate")
        .along("load", 0.0..=1.0)
        .bound("deflection", 0.0..=0.9)
        .settings(Settings { max_step: 0.03, ..Settings::default() })
        .trace()?;
    let document = Document::new("Parallel-plate actuator", vec![branch]);
    print!("{}", csv(&document.branches));
    document.save("out/parallel_plate.ron")?;
    let figure = diagram(&[("plate", &document)], None, None)?;
    Ok(write_atomically("out/parallel_plate.svg", &draw(&[figure])?)?)
}

//! Parallel-plate actuator, u = load/(1 − u)²: it pulls in at u = 1/3, load = 4/27.
use tangency::core::continuation::{Continuation, Settings};
use tangency::core::system::Dense;
use tangency::output::{Document, csv, diagram, draw, write_atomically};
use tangency::zero_problem;

zero_problem! {
    struct ParallelPlate [u; load] {
        0 = load / (T::one() - u).powi(2) - u;
        monitor deflection = u;
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

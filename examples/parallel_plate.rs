//! Parallel-plate actuator, u = load/(1 − u)²: it pulls in at u = 1/3, load = 4/27.
use tangency::prelude::*;

zero_problem! {
    struct ParallelPlate [u; load] { 0 = load / (T::one() - u).powi(2) - u; monitor deflection = u; }
}

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let mut plate = Dense::new(ParallelPlate);
    let run = Continuation::new(&mut plate).named("plate").along("load", 0.0..=1.0);
    let branch = run.bound("deflection", 0.0..=0.9).trace()?;
    let document = Document::new("Parallel-plate actuator", vec![branch]);
    print!("{}", csv(&document.branches));
    document.save("out/parallel_plate.ron")?;
    let figure = diagram(&[("plate", &document)], None, &[])?;
    Ok(write_atomically("out/parallel_plate.svg", &draw(&[figure], PAGE)?)?)
}

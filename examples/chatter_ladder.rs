//! The ladder of chatter of Mita's actuator: the voltages `c_n` at which motions with `n` impacts a
//! period become stable, each found by continuation as a period doubling, and the ratios of their
//! distances.

use tangency::core::system::Kind;
use tangency::scene::{BUILT_IN, Scene, execute};

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let ladder = BUILT_IN.iter().find(|scene| scene.name == "mita-ladder").ok_or("no scene")?;
    let outcome = execute(&Scene::parse(ladder.text)?, None, &mut ());
    if let Some(error) = outcome.error {
        return Err(error.into());
    }
    let mut rungs: Vec<f64> = Vec::new();
    println!(" n  c_n             error    (c_n − c_(n−1))/(c_(n−1) − c_(n−2))");
    for n in 4..=10 {
        let branch = outcome.document.branch(&format!("P({n},1)"))?;
        let doubling = branch.of_kind(Kind::PD).next().ok_or("no period doubling")?;
        rungs.push(doubling.parameters[0]);
        let ratio = match rungs[..] {
            [.., a, b, c] => format!("{:.6}", (c - b) / (b - a)),
            _ => String::new(),
        };
        println!("{n:2}  {:.12}  {:.1e}  {ratio}", doubling.parameters[0], doubling.error);
    }
    Ok(())
}

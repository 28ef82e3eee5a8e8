//! What branches of impacting orbits cost: `mita-type-1`, and the grazing curve with both
//! codimension-two points; and beside each as many evaluations of the field as it takes, in plain
//! flows of one period. Tracing is dominated by flow evaluations: the rest is linear algebra of a
//! few unknowns.

use criterion::{Criterion, criterion_group, criterion_main};
use std::hint::black_box;
use tangency::core::ode::{Flow, Settings, work};
use tangency::core::problem::VectorField;
use tangency::problems::mita::Block;
use tangency::scene::{BUILT_IN, Scene, execute};

const PARAMETERS: [f64; 3] = [0.2, 0.5, 0.04];

/// Flows of one period each, until so many evaluations are made.
fn flows(flow: &mut Flow<f64>, evaluations: u64) -> u64 {
    let period = Block.period(&PARAMETERS);
    let (mut made, mut periods) = (0, 0);
    while made < evaluations {
        let mut x = [-0.1, 0.0];
        let statistics = flow.advance(&Block, 0.0, period, &mut x, &PARAMETERS);
        made += statistics.expect("a flow").evaluations as u64;
        periods += 1;
        black_box(x);
    }
    periods
}

fn impacts(criterion: &mut Criterion) {
    let mut flow = Flow::new(Settings::default()).expect("settings");
    for name in ["mita-type-1", "mita-grazing-curve"] {
        let built_in = BUILT_IN.iter().find(|scene| scene.name == name).expect("a scene");
        let scene = Scene::parse(built_in.text).expect("a scene");
        let before = work();
        assert_eq!(execute(&scene, None, &mut ()).error, None);
        let after = work();
        let count = after.evaluations - before.evaluations;
        let periods = (after.time - before.time) / Block.period(&PARAMETERS);
        let plain = flows(&mut flow, count);
        println!(
            "{name}: flows over {periods:.0} periods, with {count} evaluations of the field, as many as in {plain} \
             plain flows of a period"
        );
        criterion.bench_function(name, |b| b.iter(|| black_box(execute(&scene, None, &mut ()))));
        let plain = format!("{name}: its evaluations in plain flows");
        criterion.bench_function(&plain, |b| b.iter(|| flows(&mut flow, count)));
    }
}

criterion_group!(benches, impacts);
criterion_main!(benches);

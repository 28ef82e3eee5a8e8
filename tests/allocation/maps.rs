//! Promises: after a warm-up, no Newton iteration on cycles of maps allocates, and their memory
//! grows as the number of iterates does.

use crate::allocation::allocations::allocations;
use crate::orbits::map_cycles::{Delayed, Locked};
use tangency::core::bifurcation::{DefiningSystem, Fold, Hopf};
use tangency::core::continuation::{Continuation, Settings};
use tangency::core::orbit::MapCycle;

#[test]
fn newton_on_map_cycles_allocates_nothing() {
    for held in [false, true] {
        let mut cycles = MapCycle::of(Locked(8), 8);
        let z = cycles.unknowns(&Locked(8).cycle(1.01));
        let x = [&z[..], &[1e-4, 0.7]].concat();
        let condition = held.then(|| Box::<Fold>::default() as Box<dyn DefiningSystem>);
        let released = if held { vec![0] } else { vec![] };
        assert_eq!(allocations(&mut cycles, &x, released, condition), 0);
    }
    // A torus point of the delayed logistic map as a cycle of two.
    let mut cycles = MapCycle::of(Delayed, 2);
    let condition: Box<dyn DefiningSystem> = Box::new(Hopf::neimark_sacker());
    let x = [0.52, 0.52, 0.52, 0.52, 2.01, 0.0];
    assert_eq!(allocations(&mut cycles, &x, vec![0], Some(condition)), 0);
}

#[test]
fn memory_of_map_cycles_grows_with_their_iterates() {
    let memory = |iterates: i32| {
        let start = Locked(iterates).cycle(1.25);
        allocation_counter::measure(|| {
            let mut cycles = MapCycle::of(Locked(iterates), iterates as usize);
            let z = cycles.unknowns(&start);
            let branch = Continuation::new(&mut cycles)
                .from(&z)
                .at("p", 0.0625)
                .at("s", 0.7)
                .along("p", 0.0..=1.0)
                .settings(Settings { max_points: 5, ..Settings::default() })
                .trace();
            drop(branch.unwrap());
        })
        .bytes_max as f64
    };
    let [few, many] = [512, 4096].map(memory);
    assert!(many < 8.5 * few && many < 2e7, "{few} and {many} bytes");
}

//! Promise: motion of a Filippov system begins where its state says, on either side of the surface
//! or on it.

use crate::common::close;
use crate::hybrid::systems::sliding::Sliding;
use tangency::core::attractor::CycleSearch;
use tangency::core::hybrid::filippov::{Filippov, FilippovSystem, Side};
use tangency::core::hybrid::{HybridFlow, HybridSettings, HybridState, HybridSystem};
use tangency::core::scalar::Scalar;
use tangency::core::sweep::Part;
use tangency::output::SweepTable;
use tangency::scene::{Scene, execute, sweep};

const ABOVE: usize = Filippov::<Sliding>::ABOVE;
const BELOW: usize = Filippov::<Sliding>::BELOW;
const SLIDING: usize = Filippov::<Sliding>::SLIDING;

/// `x' = y` above and `x' = z` below the surface `x = 0`, in units of `size`.
struct Between {
    size: f64,
}

impl FilippovSystem for Between {
    fn states(&self) -> Vec<String> {
        ["x", "y", "z"].map(String::from).into()
    }
    fn parameters(&self) -> Vec<String> {
        Vec::new()
    }
    fn surface<T: Scalar>(&self, _t: T, x: &[T], _p: &[T]) -> T {
        x[0]
    }
    fn field<T: Scalar>(&self, side: Side, _t: T, x: &[T], _p: &[T], f: &mut [T]) {
        f.fill(T::zero());
        f[0] = if side == Side::Above { x[1] } else { x[2] };
    }
    fn scales(&self, _p: &[f64]) -> tangency::core::hybrid::Scales {
        let scales = tangency::core::hybrid::Scales::default();
        ["x", "y", "z"].iter().fold(scales, |scales, name| scales.state(*name, self.size))
    }
}

#[test]
fn a_state_says_in_which_mode_motion_begins() {
    for size in [1.0, 1e-12] {
        let system = Filippov(Between { size });
        let mode =
            |mode: usize, x: [f64; 3]| system.initial_mode(mode, 0.0, &x.map(|x| x * size), &[]);
        for given in [ABOVE, BELOW, SLIDING] {
            assert_eq!(mode(given, [1e-3, -1.0, 1.0]), ABOVE);
            assert_eq!(mode(given, [-1e-3, -1.0, 1.0]), BELOW);
            // On the surface: both fields point at it, up, down.
            assert_eq!(mode(given, [1e-16, -1.0, 1.0]), SLIDING);
            assert_eq!(mode(given, [1e-16, 1.0, 1.0]), ABOVE);
            assert_eq!(mode(given, [-1e-16, -1.0, -1.0]), BELOW);
            // They leave it on both sides: either motion is one.
            assert_eq!(mode(given, [0.0, 1.0, -1.0]), given);
        }
    }
}

/// The mass on a belt from slower than the belt, faster, and on it: one cycle.
#[test]
fn all_starts_settle_on_one_cycle() {
    let (system, p) = (Filippov(Sliding::Friction), [2.0, 3.0, 1.5, 1.5, 0.45]);
    let mut flow = HybridFlow::new(&system, HybridSettings::default()).unwrap();
    let search = CycleSearch { transient: 60.0, tolerance: 1e-9, ..CycleSearch::default() };
    let mut cycle = |x: [f64; 2]| {
        let start = HybridState { mode: ABOVE, time: 0.0, x: x.into() };
        search.find(&mut flow, start, &p).unwrap()
    };
    let largest = |cycle: &tangency::core::hybrid::Cycle| {
        cycle.legs.iter().map(|leg| leg.start[0]).fold(f64::NEG_INFINITY, f64::max)
    };
    let slower = cycle([1.0, 0.1]);
    assert!(slower.legs.iter().any(|leg| leg.mode == SLIDING));
    for x in [[1.0, 1.5], [-0.4, 2.5], [0.0, 1.0], [3.0, 1.0]] {
        let other = cycle(x);
        assert_eq!(other.legs.len(), slower.legs.len());
        close(largest(&other), largest(&slower), 1e-7);
    }
}

/// The runs of the only sweep of a scene: start values on both axes, the mode in the end and the
/// states there.
fn runs(text: &str) -> Vec<Vec<f64>> {
    let scene = Scene::parse(text).unwrap_or_else(|error| panic!("{error}"));
    let sweeps = sweep(&scene, "t", Part::WHOLE, None, &mut ()).unwrap();
    let table: &SweepTable = &sweeps.sweeps[0];
    assert!(table.is_complete() && table.rows.values().all(|row| row.failure.is_none()));
    let first = table.run_columns.iter().position(|name| name == "end_mode").unwrap();
    let row = |row: &tangency::output::Row| {
        [&row.values[2..2 + table.axes.len()], &row.values[first..first + 3]].concat()
    };
    table.rows.values().map(row).collect()
}

/// Motion slides at `x = 0` to `y = ±1`, whichever side it begins on.
#[test]
fn basins_of_sliding_motion_have_both_sides() {
    let found = runs(
        "Scene(title: \"t\", problem: FilippovEquations(
            surface: \"x\", period: \"1\",
            above: [(\"x\", \"cos(2*pi*t)/2 - 1\"), (\"y\", \"y - y^3\")],
            below: [(\"x\", \"cos(2*pi*t)/2 + 1\"), (\"y\", \"y - y^3\")],
        ), sweeps: [(name: \"s\", over: [
            (name: \"x\", low: -2, high: 2, count: 5), (name: \"y\", low: -1.5, high: 1.5, count: 4),
        ], search: (transient: 20, recorded_periods: 20, lyapunov_periods: 0))])",
    );
    assert_eq!(found.len(), 20);
    for run in found {
        let [_, y, mode, ends @ ..] = &run[..] else { panic!() };
        assert_eq!(*mode, SLIDING as f64, "{run:?}");
        close(ends[0], 0.0, 1e-9);
        close(ends[1], y.signum(), 1e-9);
    }
}

/// Both fields leave the surface: each side is the basin of the orbit
/// `±1 + (cos 2πt + 2π sin 2πt)/(2 + 8π²)`.
#[test]
fn basins_on_both_sides_are_told_apart() {
    let found = runs(
        "Scene(title: \"t\", problem: FilippovEquations(
            surface: \"x\", period: \"1\",
            above: [(\"x\", \"1 - x + cos(2*pi*t)/2\"), (\"y\", \"-y\")],
            below: [(\"x\", \"-1 - x + cos(2*pi*t)/2\"), (\"y\", \"-y\")],
        ), sweeps: [(name: \"s\", over: [
            (name: \"x\", low: -2, high: 2, count: 6), (name: \"y\", low: -1, high: 1, count: 2),
        ], search: (transient: 20, recorded_periods: 20, lyapunov_periods: 0))])",
    );
    assert_eq!(found.len(), 12);
    let phase = 0.5 / (1.0 + std::f64::consts::TAU.powi(2));
    for run in found {
        let [x, _, mode, ends @ ..] = &run[..] else { panic!() };
        assert_eq!(*mode, if *x > 0.0 { ABOVE } else { BELOW } as f64, "{run:?}");
        close(ends[0], x.signum() + phase, 1e-9);
    }
}

/// Runs that follow each other, each on the surface of the one before: the surface has moved.
#[test]
fn runs_that_follow_each_other_find_the_surface_where_it_is() {
    for order in ["up", "down"] {
        let found = runs(&format!(
            "Scene(title: \"t\", problem: FilippovEquations(
                surface: \"x - c\", period: \"1\",
                above: [(\"x\", \"cos(2*pi*t)/2 - 1\"), (\"y\", \"-y\")],
                below: [(\"x\", \"cos(2*pi*t)/2 + 1\"), (\"y\", \"-y\")],
            ), parameters: [(\"c\", 0)], sweeps: [(name: \"s\", order: {order}, over: [
                (name: \"c\", low: -1, high: 1, count: 5),
            ], search: (transient: 20, recorded_periods: 20, lyapunov_periods: 0))])",
        ));
        assert_eq!(found.len(), 5);
        for run in found {
            assert_eq!(run[1], SLIDING as f64, "{run:?}");
            close(run[2], run[0], 1e-9);
        }
    }
}

/// The relay is odd: a history from below is the mirror image of that from above.
#[test]
fn a_scene_begins_on_either_side() {
    let history = |x: [f64; 3]| {
        let [x, y, z] = x;
        let text = format!(
            "Scene(title: \"t\", problem: FilippovEquations(
                surface: \"x\",
                above: [(\"x\", \"y - x - 1\"), (\"y\", \"z - 4*x + 2\"), (\"z\", \"-x/5 - 1\")],
                below: [(\"x\", \"y - x + 1\"), (\"y\", \"z - 4*x - 2\"), (\"z\", \"-x/5 + 1\")],
                initial: [(\"x\", {x}), (\"y\", {y}), (\"z\", {z})],
            ), parameters: [(\"p\", 1)], runs: [(name: \"h\", start: Simulated(transient: 0, duration: 8))])"
        );
        let scene = Scene::parse(&text).unwrap_or_else(|error| panic!("{error}"));
        let document = execute(&scene, None, &mut ()).document;
        let point = document.branches[0].of_kind(tangency::core::system::Kind::UZ).next();
        let value =
            |name| point.unwrap().value(document.branches[0].column(name).unwrap()).unwrap();
        [value("max_y"), value("min_y"), value("events")]
    };
    let [above, below] = [history([0.5, 0.1, -0.3]), history([-0.5, -0.1, 0.3])];
    assert!(above[2] > 0.0);
    close(above[0], -below[1], 1e-9);
    close(above[1], -below[0], 1e-9);
    assert_eq!(above[2], below[2]);
}

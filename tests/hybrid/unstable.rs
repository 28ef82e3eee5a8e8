//! Promise: branches begin at the grazings of orbits of any multiplier, if segments are short
//! enough for the digits.

use crate::common::close;
use std::f64::consts::{PI, TAU};
use tangency::core::bvp::{BoundarySystem, Collocation, Mesh, Method, Shooting};
use tangency::core::continuation::{Branch, Continuation, End, Settings, TraceError};
use tangency::core::failure::one_line;
use tangency::core::hybrid::{Guard, HybridSystem, Mode};
use tangency::core::local_map::GrazingPoint;
use tangency::core::orbit::{HybridOrbit, Itinerary};
use tangency::core::problem::Forcing;
use tangency::core::scalar::Scalar;
use tangency::core::system::Kind;

/// An inverted oscillator, `x'' = b² x + (1 + b²) a cos(t + φ)`, beside one wall at `x = 1`, or
/// between that and one at `x = −1`, with impacts of restitution 0.8.
///
/// Without impacts `x = −a cos(t + φ)` with the multipliers `e^{±2πb}`: it touches the walls at
/// `a = 1`, at `t + φ = π` and 0.
#[derive(Clone)]
struct Inverted {
    rate: f64,
    walls: usize,
    phase: f64,
}

const RESTITUTION: f64 = 0.8;

impl HybridSystem for Inverted {
    fn modes(&self) -> Vec<Mode> {
        vec![Mode::new("free", ["x", "v"])]
    }
    fn guards(&self) -> Vec<Guard> {
        [Guard::new("right", [0]), Guard::new("left", [0])][..self.walls].to_vec()
    }
    fn parameters(&self) -> Vec<String> {
        vec!["a".into()]
    }
    fn field<T: Scalar>(&self, _mode: usize, t: T, x: &[T], p: &[T], f: &mut [T]) {
        let square = self.rate * self.rate;
        f[0] = x[1];
        f[1] = x[0] * square + p[0] * (t + self.phase).cos() * (1.0 + square);
    }
    fn guard<T: Scalar>(&self, guard: usize, _mode: usize, _t: T, x: &[T], _p: &[T]) -> T {
        if guard == 0 { -x[0] + 1.0 } else { x[0] + 1.0 }
    }
    fn reset<T: Scalar>(
        &self,
        _guard: usize,
        _modes: (usize, usize),
        _t: T,
        x: &[T],
        _p: &[T],
        after: &mut [T],
    ) {
        (after[0], after[1]) = (x[0], x[1] * -RESTITUTION);
    }
    fn next_mode(&self, _guard: usize, _mode: usize, _t: f64, _x: &[f64], _p: &[f64]) -> usize {
        0
    }
    fn forcing(&self) -> Forcing {
        Forcing::Periodic { phase: TAU }
    }
    fn period<T: Scalar>(&self, _p: &[T]) -> T {
        T::constant(TAU)
    }
}

impl Inverted {
    /// `(1 − e) b` times the factor by which both ends of a leg see each other, `tanh πb` over a
    /// period, `coth πb/2` over half of one.
    fn stiffness(&self) -> f64 {
        let ends = if self.walls == 1 {
            (PI * self.rate).tanh()
        } else {
            1.0 / (PI * self.rate / 2.0).tanh()
        };
        (1.0 - RESTITUTION) * self.rate * ends
    }

    /// The amplitude of the orbits that hit each wall once a period at a speed: with
    /// `h = 1 + a cos t` at the impact at `x = 1`, motion between impacts is `−a cos t` and a sum
    /// of exponentials that is `h` at both ends (`−h` at the other one), so that
    /// `(1 + e) a sin t = κ h` and the speed is `2 κ h/(1 − e²)`.
    fn amplitude(&self, speed: f64) -> f64 {
        let stiffness = self.stiffness();
        let h = speed * (1.0 - RESTITUTION * RESTITUTION) / (2.0 * stiffness);
        (stiffness * h / (1.0 + RESTITUTION)).hypot(h - 1.0)
    }

    /// The least of these.
    fn fold(&self) -> f64 {
        self.stiffness() / self.stiffness().hypot(1.0 + RESTITUTION)
    }
}

/// The orbits without impacts, and one of them.
fn free(inverted: Inverted, method: Method, mesh: Mesh) -> (BoundarySystem, Vec<f64>) {
    let phase = inverted.phase;
    let orbit = HybridOrbit::of(inverted, Itinerary::smooth(0, 1)).unwrap();
    let system = BoundarySystem::new(orbit, method, vec![mesh]).unwrap();
    let z = system.sampled(&[], |_, tau, x| {
        let (sine, cosine) = (TAU * tau + phase).sin_cos();
        (x[0], x[1]) = (-0.5 * cosine, 0.5 * sine);
    });
    (system, z)
}

/// Nothing divides segments.
fn as_it_begins() -> Settings {
    Settings { target_mesh_error: f64::MAX, ..Settings::default() }
}

/// The branch of these, on as many segments as it begins with, with the label of its grazing.
fn to_grazing(system: &mut BoundarySystem, z: &[f64]) -> Result<(Branch, usize), TraceError> {
    let run = Continuation::new(system).from(z).at("a", 0.5).along("a", 0.1..=2.0);
    run.settings(as_it_begins()).trace().map(|branch| {
        let label = branch.of_kind(Kind::G).next().expect("a grazing").label;
        (branch, label)
    })
}

/// Multipliers from 3e5 to 2e27, with one wall and with two that are touched at a time, one of them
/// where the orbit begins and ends. The contact at `t = π` is a node of 20 intervals, and none of
/// 31.
#[test]
fn impacting_branches_begin_where_unstable_orbits_graze() {
    let collocation = || Method::from(Collocation::new(7).unwrap());
    for (rate, method, intervals) in [
        (2.0, Method::from(Shooting::default()), 1),
        (2.0, Shooting::default().into(), 20),
        (3.0, Shooting::default().into(), 20),
        (10.0, Shooting::default().into(), 20),
        (10.0, Shooting::default().into(), 31),
        (2.0, collocation(), 31),
        (10.0, collocation(), 30),
    ] {
        for walls in [1, 2] {
            let inverted = Inverted { rate, walls, phase: 0.0 };
            let (mut system, z) = free(inverted.clone(), method.clone(), Mesh::uniform(intervals));
            // Rounding grows over a segment as deviations do.
            let digits = 1e-12 + 1e-15 * (TAU * rate / intervals as f64).exp();
            let (branch, label) = to_grazing(&mut system, &z).unwrap();
            let grazing = branch.of_kind(Kind::G).next().unwrap();
            close(grazing.parameters[0], 1.0, digits);
            let point = GrazingPoint::at(&mut system, &branch.solution(grazing)).unwrap();
            close(point.x[0].abs(), 1.0, 10.0 * digits);
            close(point.time.sin(), 0.0, 1e-6);
            let run = Continuation::new(&mut system).restart(&branch, label).switch();
            let born = run.along("a", 0.1..=2.0).trace().unwrap();
            let speed = born.column("approach").unwrap();
            assert!(born.points.len() > 5);
            for point in &born.points {
                let exact = inverted.amplitude(point.value(speed).unwrap());
                close(point.parameters[0], exact, 10.0 * digits);
            }
            let fold = born.of_kind(Kind::LP).next();
            // Two walls: the fold is within 1e-8 of where symmetry is lost if the rate is large.
            if walls == 1 || rate == 2.0 {
                close(fold.expect("a fold").parameters[0], inverted.fold(), 10.0 * digits);
            }
        }
    }
}

/// An orbit over two periods, as a doubled one, touches twice, and is that of the branch with an
/// impact in each period.
#[test]
fn births_are_found_in_all_periods_of_an_orbit() {
    let inverted = Inverted { rate: 2.0, walls: 1, phase: 0.0 };
    let mesh = Mesh::uniform(20).stretched(2.0);
    let (mut system, z) = free(inverted.clone(), Shooting::default().into(), mesh);
    let (branch, label) = to_grazing(&mut system, &z).unwrap();
    let run = Continuation::new(&mut system).restart(&branch, label).switch();
    let born = run.along("a", 0.5..=2.0).trace().unwrap();
    assert_eq!(born.itinerary, "2* free:right free:right");
    let speed = born.column("approach").unwrap();
    assert!(born.points.len() > 3);
    for point in &born.points {
        close(point.parameters[0], inverted.amplitude(point.value(speed).unwrap()), 1e-11);
    }
}

/// With one segment the largest multipliers leave no digits, and others too few for what is
/// singular but for them: for the border of a matrix, where all velocities among the unknowns
/// vanish, or for the correction at a birth.
#[test]
fn one_segment_says_where_its_digits_end() {
    let of = |rate: f64, phase: f64| {
        free(Inverted { rate, walls: 1, phase }, Shooting::default().into(), Mesh::uniform(1))
    };
    let grown = |error: TraceError, growth: &str| {
        let error = one_line(&error);
        let cause = format!("deviations and rounding errors grow by {growth}");
        assert!(error.contains(&cause) && error.contains("use more shooting segments"), "{error}");
    };
    // A deviation grows by cosh 2πb.
    let (mut system, z) = of(1.0, 0.0);
    to_grazing(&mut system, &z).unwrap();
    for (rate, growth) in [(3.0, "7.7e7"), (6.0, "1.2e16"), (10.0, "9.7e26")] {
        let (mut system, z) = of(rate, 0.0);
        grown(to_grazing(&mut system, &z).expect_err("a refusal"), growth);
    }
    let mut refused = 0;
    for rate in (15..27).map(|k| f64::from(k) / 5.0) {
        let (mut system, z) = of(rate, 0.3);
        let born = to_grazing(&mut system, &z).and_then(|(branch, label)| {
            assert!(branch.ends.iter().all(told), "{:?}", branch.ends);
            let run = Continuation::new(&mut system).restart(&branch, label).switch();
            run.along("a", 0.1..=2.0).settings(as_it_begins()).trace()
        });
        match born {
            Ok(born) => assert!(born.ends.iter().all(told), "{:?}", born.ends),
            Err(error) => {
                grown(error, "");
                refused += 1;
            }
        }
    }
    assert!((1..4).contains(&refused), "{refused}");
}

/// Whether a branch ends at a bound, at a grazing or by growth.
fn told(end: &End) -> bool {
    match end {
        End::ParameterBound { .. } | End::Grazing { .. } => true,
        other => other.to_string().contains("deviations grow"),
    }
}

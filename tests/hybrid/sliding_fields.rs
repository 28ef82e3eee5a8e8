//! Promise: a field of sliding motion that a user states keeps to the surface, or is refused where
//! it does not, with the velocity at which it leaves.

use crate::common::close;
use tangency::core::continuation::End;
use tangency::core::failure::one_line;
use tangency::core::hybrid::HybridSystem;
use tangency::core::hybrid::filippov::{Filippov, FilippovSystem, Side};
use tangency::core::scalar::Scalar;
use tangency::scene::{Outcome, Scene, execute};

/// A forced mass on a belt of velocity `V`, `x'' + x = A cos ωt − F sgn(x' − V)`, with a field of
/// sliding.
fn belt(sliding: &str) -> Outcome {
    let text = format!(
        "Scene(title: \"t\", problem: FilippovEquations(
            surface: \"v - V\", period: \"2*pi/w\", {sliding}
            above: [(\"x\", \"v\"), (\"v\", \"A*cos(w*t) - x - F\")],
            below: [(\"x\", \"v\"), (\"v\", \"A*cos(w*t) - x + F\")],
            initial: [(\"x\", 0.3), (\"v\", -0.2)],
        ), parameters: [(\"V\", 0.05), (\"w\", 0.8), (\"A\", 1), (\"F\", 0.9)], runs: [(
            name: \"b\", start: Simulated(transient: 100), along: [(name: \"V\", low: 0.05, high: 0.2)],
        )])"
    );
    let scene = Scene::parse(&text).unwrap_or_else(|error| panic!("{error}"));
    execute(&scene, None, &mut ())
}

#[test]
fn a_field_along_the_surface_is_followed() {
    let [own, filippov] = ["sliding: [(\"x\", \"V\"), (\"v\", \"0\")],", ""].map(belt);
    let last = |outcome: &Outcome| {
        assert!(outcome.error.is_none(), "{:?}", outcome.error);
        let branch = &outcome.document.branches[0];
        assert!(branch.itinerary.contains("sliding"), "{}", branch.itinerary);
        let point = branch.points.last().unwrap();
        assert_eq!(point.parameters[0], 0.2);
        point.value(branch.column("max_x").unwrap()).unwrap()
    };
    close(last(&own), last(&filippov), 1e-9);
}

#[test]
fn a_field_off_the_surface_is_refused() {
    let outcome = belt("sliding: [(\"x\", \"V\"), (\"v\", \"1/8\")],");
    let error = one_line(&outcome.error.expect("a refusal"));
    let velocity =
        "the normal velocity of the field of sliding motion on the surface = 1.250000e-1";
    assert!(error.contains("in mode sliding") && error.contains(velocity), "{error}");
    assert!(error.contains("correct `sliding`"), "{error}");
    // What is rounded constants is not.
    let outcome = belt("sliding: [(\"x\", \"V\"), (\"v\", \"1e-8\")],");
    assert!(outcome.error.is_none(), "{:?}", outcome.error);
}

/// It keeps to the surface at the start of a branch only.
#[test]
fn a_branch_ends_where_its_field_leaves_the_surface() {
    let outcome = belt("sliding: [(\"x\", \"V\"), (\"v\", \"(V - 0.05)/10\")],");
    let branch = &outcome.document.branches[0];
    let refused = |end: &End| matches!(end, End::StepTooSmall { cause, .. } if cause.contains("normal velocity"));
    assert!(branch.ends.iter().any(refused), "{:?}", branch.ends);
    let last = branch.points.last().unwrap().parameters[0];
    assert!((0.05..0.051).contains(&last), "{last}");
}

/// A surface that moves as `x = sin t`, in units of `size`, with sliding at a rate `share` of its
/// velocity.
struct Tide {
    size: f64,
    share: f64,
}

impl FilippovSystem for Tide {
    fn states(&self) -> Vec<String> {
        vec!["x".into()]
    }
    fn parameters(&self) -> Vec<String> {
        Vec::new()
    }
    fn surface<T: Scalar>(&self, t: T, x: &[T], _p: &[T]) -> T {
        x[0] - t.sin() * self.size
    }
    fn field<T: Scalar>(&self, side: Side, _t: T, _x: &[T], _p: &[T], f: &mut [T]) {
        f[0] = T::from(if side == Side::Above { -2.0 * self.size } else { 2.0 * self.size });
    }
    fn sliding<T: Scalar>(&self, t: T, _x: &[T], _p: &[T], f: &mut [T]) {
        f[0] = t.cos() * (self.size * self.share);
    }
    fn scales(&self, _p: &[f64]) -> tangency::core::hybrid::Scales {
        tangency::core::hybrid::Scales::default().state("x", self.size)
    }
}

#[test]
fn a_surface_that_moves_is_followed_at_its_velocity() {
    for size in [1.0, 1e-9, 1e9] {
        for t in [0.0, 1.0, std::f64::consts::FRAC_PI_2, 4.0] {
            let at = |share: f64| {
                let tide = Filippov(Tide { size, share });
                tide.domain_at_ends(Filippov::<Tide>::SLIDING, t, &[t.sin() * size], &[])
            };
            assert_eq!(at(1.0), Ok(()));
            let wrong = at(0.9);
            match t.cos().abs() > 1e-3 {
                true => close(wrong.unwrap_err().value / size, -0.1 * t.cos(), 1e-12),
                false => assert_eq!(wrong, Ok(())),
            }
            let beside = Filippov(Tide { size, share: 0.0 });
            assert_eq!(beside.domain_at_ends(Filippov::<Tide>::ABOVE, t, &[size], &[]), Ok(()));
        }
    }
}

//! Promise: a flow that cannot be computed says what, where and what to do, and does not panic.

use tangency::core::failure::{Failure, FlowError, OutOfDomain, one_line};
use tangency::core::ode::{Flow, Scheme, Settings, SettingsError};
use tangency::vector_field;

const ALL: [Scheme; 3] = [Scheme::DormandPrince8, Scheme::DormandPrince5, Scheme::Rodas5P];

vector_field! {
    /// `x' = λ (x − cos t) − sin t` (Prothero and Robinson 1974), `x = cos t` for any `λ`.
    struct ProtheroRobinson [x; lambda; t] {
        d/dt x = lambda * (x - t.cos()) - t.sin();
    }
}

#[test]
fn explicit_methods_call_a_stiff_field_stiff_and_the_implicit_one_computes_it() {
    for (scheme, bound) in [(Scheme::DormandPrince8, 6.1), (Scheme::DormandPrince5, 3.25)] {
        let mut flow = Flow::new(Settings::new(scheme, 1e-6)).unwrap();
        let error = flow.advance(&ProtheroRobinson, 0.0, 2.0, &mut [1.0], &[-1e6]).unwrap_err();
        let FlowError::Stiff { time, step, product } = error else { panic!("{error}") };
        assert!((0.0..0.01).contains(&time), "noticed early: {time}");
        assert!((bound..2.0 * bound).contains(&product), "{product}");
        assert!((step * 1e6 / product - 1.0).abs() < 0.1, "h|λ| is that of the field");
        assert!(one_line(&error).contains("use the implicit method"), "{error}");
    }
    let mut flow = Flow::new(Settings::new(Scheme::Rodas5P, 1e-9)).unwrap();
    let mut x = [1.0];
    let statistics = flow.advance(&ProtheroRobinson, 0.0, 2.0, &mut x, &[-1e6]).unwrap();
    assert!((x[0] - 2f64.cos()).abs() < 1e-9, "{:e}", x[0] - 2f64.cos());
    assert!(statistics.accepted < 200, "{statistics:?}");
}

/// `x' = −λ x` is stiff, but over few time constants cheaper than another method.
#[test]
fn a_little_stiffness_is_borne() {
    let mut flow = Flow::new(Settings::new(Scheme::DormandPrince8, 1e-6)).unwrap();
    let mut x = [1.0];
    flow.advance(&ProtheroRobinson, 0.0, 2.0, &mut x, &[-1e3]).unwrap();
    assert!((x[0] - 2f64.cos()).abs() < 1e-6);
}

vector_field! {
    /// `x' = x²` from 1 blows up at `t = 1`.
    struct BlowUp [x] {
        d/dt x = x * x;
    }
}

#[test]
fn a_solution_that_blows_up_ends_there() {
    for scheme in ALL {
        let mut flow = Flow::new(Settings::new(scheme, 1e-8)).unwrap();
        let mut x = [1.0];
        let error = flow.advance(&BlowUp, 0.0, 2.0, &mut x, &[]).unwrap_err();
        let FlowError::StepTooSmall { time, .. } = error else { panic!("{scheme:?}: {error}") };
        assert!((time - 1.0).abs() < 1e-6, "{scheme:?}: {time}");
        assert!(x[0] > 1e6, "x is where the flow ended");
        let cause = Failure::from(error);
        assert!(one_line(&cause).contains("is too large: the solution blows up"), "{cause}");
    }
}

vector_field! {
    /// A plate that pulls in: `x' = 1`, with a gap that closes at `x = 1`.
    struct Gap [gap] {
        d/dt gap = T::one();
        fn domain(&self, x: &[f64], _p: &[f64]) -> Result<(), OutOfDomain> {
            if x[0] < 1.0 { Ok(()) } else { Err(OutOfDomain::new("gap", x[0], "it must be below 1")) }
        }
    }
}

#[test]
fn leaving_the_domain_is_reported_with_its_time() {
    for scheme in ALL {
        let settings = Settings { largest_step: 0.01, ..Settings::new(scheme, 1e-8) };
        let mut flow = Flow::new(settings).unwrap();
        let error = flow.advance(&Gap, 5.0, 2.0, &mut [0.0], &[]).unwrap_err();
        let FlowError::OutOfDomain { time, left } = &error else { panic!("{scheme:?}: {error}") };
        assert!((time - 6.0).abs() < 0.021, "{scheme:?}: {time}");
        assert_eq!(left.quantity, "gap");
    }
    let mut flow = Flow::new(Settings::default()).unwrap();
    let error = flow.advance(&Gap, 5.0, 2.0, &mut [1.5], &[]).unwrap_err();
    assert!(matches!(error, FlowError::OutOfDomain { time: 5.0, .. }), "at once: {error}");
}

vector_field! {
    /// `x' = −√x / 2` from 1 reaches 0 at `t = 4`; beyond, the root is not a number.
    struct Torricelli [level] {
        d/dt level = level.sqrt() * -0.5 - 1e-3;
    }
}

#[test]
fn a_field_that_is_not_finite_ends_the_flow_where_it_becomes_so() {
    for scheme in ALL {
        let mut flow = Flow::new(Settings::new(scheme, 1e-8)).unwrap();
        let mut x = [1.0];
        let error = flow.advance(&Torricelli, 0.0, 6.0, &mut x, &[]).unwrap_err();
        let FlowError::NotFinite { time, state, .. } = error else { panic!("{scheme:?}: {error}") };
        assert!((3.9..4.0).contains(&time), "{scheme:?}: {time}");
        assert_eq!(state, "level");
        let error = flow.advance(&Torricelli, 0.0, 6.0, &mut [-1.0], &[]).unwrap_err();
        assert!(matches!(error, FlowError::NotFinite { time: 0.0, .. }), "{error}");
    }
}

#[test]
fn steps_are_limited() {
    let settings = Settings { max_steps: 10, ..Settings::new(Scheme::DormandPrince8, 1e-10) };
    let mut flow = Flow::new(settings).unwrap();
    let error = flow.advance(&ProtheroRobinson, 0.0, 100.0, &mut [1.0], &[-1.0]).unwrap_err();
    assert!(matches!(error, FlowError::TooManySteps { steps: 10, .. }), "{error}");
}

#[test]
fn settings_without_a_meaning_are_refused() {
    let fine = Settings::default;
    for settings in [
        Settings { relative: 0.0, ..fine() },
        Settings { relative: f64::NAN, ..fine() },
        Settings { absolute: -1.0, ..fine() },
        Settings { absolute: 0.0, ..fine() },
        Settings { absolute: f64::INFINITY, ..fine() },
    ] {
        let error = Flow::<f64>::new(settings.clone()).err();
        assert!(matches!(error, Some(SettingsError::Tolerance { .. })), "{settings:?}");
    }
    for settings in [
        Settings { largest_step: 0.0, ..fine() },
        Settings { first_step: Some(2.0), ..fine() },
        Settings { first_step: Some(f64::NAN), ..fine() },
    ] {
        let error = Flow::<f64>::new(settings.clone()).err();
        assert!(matches!(error, Some(SettingsError::Step(_))), "{settings:?}");
    }
    let error = Flow::<f64>::new(Settings { max_steps: 0, ..fine() }).err();
    assert_eq!(error, Some(SettingsError::Steps));
}

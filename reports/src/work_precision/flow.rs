//! Work-precision diagrams of integrators: on the stick phase of Mita's actuator, over a period
//! with an impact, on a stiff field, and on dual numbers.

use super::period::{PERIOD, parameters};
use super::plan::{Answer, Method, Plan};
use num_dual::{Dual64, HyperDual64};
use tangency::core::failure::one_line;
use tangency::core::hybrid::{HybridFlow, HybridSettings, HybridState, InMode};
use tangency::core::ode::{Flow, Scheme, Settings};
use tangency::core::problem::VectorField;
use tangency::core::scalar::Scalar;
use tangency::problems::classic::ProtheroRobinson;
use tangency::problems::mita::Actuator;

const SCHEMES: [(Scheme, &str); 3] = [
    (Scheme::DormandPrince8, "order 8"),
    (Scheme::DormandPrince5, "order 5"),
    (Scheme::Rodas5P, "Rodas5P, order 5"),
];

const TOLERANCES: [f64; 7] = [1e-3, 1e-4, 1e-6, 1e-8, 1e-10, 1e-12, 1e-13];

/// Integrates a vector field over a given time in a given scalar type.
fn over<F: VectorField + 'static, T: Scalar>(
    field: F,
    settings: Settings,
    (x, time): (Vec<T>, f64),
    p: Vec<f64>,
) -> impl FnMut() -> Result<Answer, String> + 'static {
    move || {
        let mut flow = Flow::<T>::new(settings.clone()).map_err(|cause| one_line(&cause))?;
        let (mut x, p): (Vec<T>, Vec<T>) = (x.clone(), p.iter().map(|p| T::constant(*p)).collect());
        let (start, length) = (T::zero(), T::constant(time));
        let statistics = flow.advance(&field, start, length, &mut x, &p);
        let statistics = statistics.map_err(|cause| one_line(&cause))?;
        let numbers = x.iter().map(T::real).collect();
        Ok(Answer { numbers, work: statistics.evaluations as f64 })
    }
}

/// Returns a method for each integration scheme and each tolerance.
fn all(method: impl Fn(Settings) -> Box<dyn FnMut() -> Result<Answer, String>>) -> Vec<Method> {
    let one = |(scheme, name): &(Scheme, &str), tolerance: f64| {
        let settings = Settings { max_steps: 1_000_000, ..Settings::new(*scheme, tolerance) };
        Method::new(*name, format!("{tolerance:.0e}"), method(settings))
    };
    let of = |scheme: &(Scheme, &'static str)| TOLERANCES.map(|tolerance| one(scheme, tolerance));
    SCHEMES.iter().flat_map(of).collect()
}

/// Returns the reference method, whose integration error is smaller than the error of all other
/// methods.
fn exact<R>(motion: impl Fn(Settings) -> R) -> Method
where
    R: FnMut() -> Result<Answer, String> + 'static,
{
    let settings = Settings::new(Scheme::DormandPrince8, 1e-15);
    Method::new("order 8", "at a tolerance of 1e-15", motion(settings))
}

/// Integrates the stick phase of Mita's actuator over a period, in a given scalar type.
fn stuck<T: Scalar>(settings: Settings) -> impl FnMut() -> Result<Answer, String> + 'static {
    let field = InMode { system: &Actuator, mode: Actuator::STICK };
    over(field, settings, ([0.1, -0.2].map(T::constant).to_vec(), PERIOD), parameters(0.2).to_vec())
}

/// Plans the diagram of integrators on the stick phase of Mita's actuator over one period.
fn stick() -> Plan {
    Plan::of("Mita's actuator sticking, one period", exact(stuck::<f64>))
        .with(all(|settings| Box::new(stuck::<f64>(settings))))
        .recommending("order 8", "1e-12")
}

/// Plans the diagram of integrators over a period of Mita's actuator with an impact and a slip
/// phase.
fn impacting() -> Plan {
    let motion = |settings: Settings| {
        move || {
            let settings = HybridSettings { flow: settings.clone(), ..HybridSettings::default() };
            let mut flow = HybridFlow::new(&Actuator, settings).map_err(|e| one_line(&e))?;
            let x = vec![-0.4, 0.2];
            let mut state = HybridState { mode: Actuator::STICK, time: 0.0, x };
            let statistics = flow.advance(&mut state, PERIOD, &parameters(0.52), &mut ());
            let statistics = statistics.map_err(|cause| one_line(&cause))?;
            Ok(Answer { numbers: state.x, work: statistics.flow.evaluations as f64 })
        }
    };
    Plan::of("Mita's actuator, one period with impacts", exact(motion))
        .with(all(|settings| Box::new(motion(settings))))
        .recommending("order 8", "1e-10")
}

/// Defines the work-precision diagram that compares integrators on a stiff vector field.
fn stiff() -> Plan {
    let time = 2.0_f64;
    let exact = move || Ok(Answer { numbers: vec![time.cos()], work: 0.0 });
    let reference = Method::new("the exact solution", "", exact);
    let motion = move |settings| over(ProtheroRobinson, settings, (vec![1.0], time), vec![1e5]);
    Plan::of("x' = −10⁵ (x − cos t) − sin t", reference)
        .with(all(|settings| Box::new(motion(settings))))
        .recommending("Rodas5P, order 5", "1e-10")
}

/// Plans the diagram of integrators on the stick phase of Mita's actuator, with several types of
/// dual numbers.
fn duals() -> Plan {
    fn methods<T: Scalar>(line: &'static str) -> impl Iterator<Item = Method> {
        [1e-4, 1e-6, 1e-8, 1e-10, 1e-12].into_iter().map(move |tolerance| {
            let settings = Settings::new(Scheme::DormandPrince8, tolerance);
            Method::new(line, format!("{tolerance:.0e}"), stuck::<T>(settings))
        })
    }
    Plan::of(
        "Cost of derivatives: the stick phase integrated with dual numbers",
        exact(stuck::<f64>),
    )
    .with(methods::<f64>("f64"))
    .with(methods::<Dual64>("first derivatives"))
    .with(methods::<HyperDual64>("second derivatives"))
}

/// Plans four panels.
pub(super) fn plans() -> Vec<Plan> {
    let plans = [stick(), impacting(), stiff(), duals()];
    plans.map(|plan| plan.counting("evaluations of the field")).into()
}

//! What motions settle on: cycles and their exponents against multipliers, chaos against exact
//! exponents, chatter.

use crate::common::ALL;
use crate::common::{close, solved};
use crate::hybrid::systems::bouncing_ball::BouncingBall;
use crate::hybrid::systems::impact_oscillator::ClosedForm;
use num_dual::Dual64;
use proptest::prelude::*;
use std::collections::BTreeMap;
use std::num::NonZeroUsize;
use tangency::core::attractor::{
    Attractor, AttractorSearch, CrisisSearch, CycleSearch, Exponent, Layout, Period, PeriodMap,
    StroboscopicError, StroboscopicMap,
};
use tangency::core::bvp::Shooting;
use tangency::core::cancel::CancelToken;
use tangency::core::hybrid::{HybridFlow, HybridSettings, HybridState, HybridSystem, Member};
use tangency::core::ode::{Scheme, Settings};
use tangency::core::orbit::from_cycle;
use tangency::core::sweep::{Axis, Found, Order, Part, Plan, PlanError, Quantity, execute};
use tangency::core::system::System;
use tangency::hybrid_system;
use tangency::problems::classic::ImpactOscillator;
use tangency::problems::mita::Actuator;

fn at(mode: usize, x: &[f64]) -> HybridState<f64> {
    HybridState { mode, time: 0.0, x: x.to_vec() }
}

fn settled<S: HybridSystem>(
    system: &S,
    start: &[f64],
    p: &[f64],
    search: AttractorSearch,
) -> Attractor {
    let mut motion = PeriodMap::of(system, HybridSettings::default(), &[]).unwrap();
    search.follow(&mut motion, at(0, start), p).unwrap()
}

fn mita(voltage: f64, frequency: f64) -> [f64; 9] {
    let mut p = Actuator::DEFAULTS;
    (p[0], p[1]) = (voltage, frequency);
    p
}

hybrid_system! {
    /// A map without motion: `x ↦ 1 − a x²` at the end of every period of 1, by a clock that resets it.
    struct Quadratic [a] {
        period = T::one(), phase = 1.0;
        mode wait [x, clock] {
            d/dt x = T::zero();
            d/dt clock = T::one();
            event tick: -clock + 0.5 => wait { x: -a * x.powi(2) + 1.0, clock: clock - 1.0 };
        }
    }
}

/// `x ↦ 1 − 2x²` has the exponent ln 2, and the estimate is off by no more than its error says.
#[test]
fn the_exponent_of_chaos_is_known() {
    // A clock that neither grows nor shrinks would hide slower growth, not this.
    let search =
        AttractorSearch { lyapunov_periods: 20_000, transient: 20, ..AttractorSearch::default() };
    let found = settled(&Quadratic, &[0.3, 0.0], &[2.0], search);
    let Exponent { value, error } = found.exponent.unwrap();
    assert_eq!(found.periods, None);
    assert!(error > 1e-5 && error < 0.01, "{error}");
    close(value, 2.0_f64.ln(), 4.0 * error);
}

/// With one impact a period the map's determinant is `e² exp(−cT)`, and where its multipliers are
/// complex the exponent is half the logarithm.
#[test]
fn the_exponent_of_an_oscillator_is_its_damping() {
    let (frequency, restitution, damping) = (2.2, 0.8, 0.1);
    let form = ClosedForm::new(frequency, restitution, damping, 1.0);
    let u = 3.0;
    assert!(form.trace(u).powi(2) < 4.0 * form.determinant());
    let p = [form.amplitude(u), frequency, restitution, damping, 1.0];
    let found = settled(&ImpactOscillator, &[0.0, 0.0], &p, AttractorSearch::default());
    assert_eq!((found.periods, found.count("impact")), (Some(1), 1.0));
    let period = std::f64::consts::TAU / frequency;
    let exact = 0.5 * (restitution * restitution * (-damping * period).exp()).ln();
    close(found.exponent.unwrap().value, exact, 1e-10);
}

/// The exponent of a cycle is the logarithm of the largest multiplier of the orbit that shooting
/// finds from a simulation of its own: the actuator at ω = 0.5.
#[test]
fn exponents_of_cycles_are_logarithms_of_multipliers() {
    let cycles = [(0.24, 1, 1.0), (0.52, 1, 1.0), (0.57, 2, 2.0), (0.75, 1, 2.0), (0.85, 1, 4.0)];
    for (voltage, periods, impacts) in cycles {
        let p = mita(voltage, 0.5);
        let found = settled(&Actuator, &[0.1, -0.2], &p, AttractorSearch::default());
        assert_eq!(
            (found.periods, found.count("front")),
            (Some(periods), impacts),
            "V = {voltage}"
        );
        let mut flow = HybridFlow::new(&Actuator, HybridSettings::default()).unwrap();
        let search = CycleSearch { transient: 3000.0, ..CycleSearch::default() };
        let cycle = search.find(&mut flow, at(0, &[0.1, -0.2]), &p).unwrap();
        let method = Shooting::new(Scheme::DormandPrince8, 1e-13).unwrap();
        let (mut system, z) = from_cycle(Actuator, &cycle, &p, method, 1).unwrap();
        let x = solved(&mut system, &z, &p).unwrap();
        system.assemble(&x).unwrap();
        let (re, im) = system.spectrum(&x, ALL).unwrap().unwrap()[0];
        let exponent = found.exponent.unwrap();
        close(exponent.value, re.hypot(im).ln() / f64::from(periods as u32), 1e-8);
        assert!(exponent.error < 1e-8, "{exponent:?}");
    }
}

/// The band beyond the grazing of type II is chaotic, and P(1,1) beyond it is not.
#[test]
fn exponents_tell_chaos_from_windows() {
    let of = |voltage| {
        settled(
            &Actuator,
            &[0.1, -0.2],
            &mita(voltage, 0.485),
            AttractorSearch { transient: 1000, ..AttractorSearch::default() },
        )
    };
    let (chaos, window) = (of(0.1735), of(0.177));
    let exponent = chaos.exponent.unwrap();
    assert!(chaos.periods.is_none() && exponent.value > 10.0 * exponent.error, "{exponent:?}");
    assert!(window.periods == Some(1) && window.exponent.unwrap().value < -0.01);
}

/// Above V = 0.872 impacts accumulate and the block sticks to the stopper: all is forgotten there,
/// and motion is the same from the first period on. Below there are finitely many.
#[test]
fn sticking_forgets_everything() {
    for (voltage, impacts, accumulations) in [(0.85, 4.0, 0.0), (0.875, f64::INFINITY, 1.0)] {
        let found =
            settled(&Actuator, &[0.1, -0.2], &mita(voltage, 0.5), AttractorSearch::default());
        assert_eq!((found.periods, found.accumulations), (Some(1), accumulations));
        assert_eq!(found.count("front"), impacts);
        let exponent = found.exponent.unwrap().value;
        assert_eq!(exponent == f64::NEG_INFINITY, accumulations > 0.0, "{exponent}");
    }
}

/// Restitution of 0, nearly 1, and 1: one impact and contact; many; and no loss at all. Nothing
/// stalls.
#[test]
fn chatter_at_any_restitution_neither_stalls_nor_miscounts() {
    let of = |e: f64| {
        let search = AttractorSearch {
            transient: 50,
            recorded_periods: 20,
            lyapunov_periods: 0,
            ..AttractorSearch::default()
        };
        let mut p = mita(0.875, 0.5);
        p[3] = e;
        let mut motion = PeriodMap::of(&Actuator, HybridSettings::default(), &[]).unwrap();
        search.follow(&mut motion, at(0, &[0.1, -0.2]), &p)
    };
    let plastic = of(0.0).unwrap();
    assert_eq!((plastic.periods, plastic.accumulations), (Some(1), 1.0));
    for e in [0.99, 1.0] {
        let found = of(e).unwrap();
        assert!(found.count("front") > 0.0 && found.records.len() <= 20, "e = {e}: {found:?}");
    }
    // A ball over a table at rest bounces for ever at e = 1, with the same height.
    let search = AttractorSearch {
        transient: 0,
        recorded_periods: 50,
        lyapunov_periods: 0,
        ..AttractorSearch::default()
    };
    let mut motion = PeriodMap::of(&BouncingBall, HybridSettings::default(), &[]).unwrap();
    let found =
        search.follow(&mut motion, at(BouncingBall::FLIGHT, &[0.5, 0.0]), &[0.0, 1.0]).unwrap();
    let total: usize = found.records.iter().map(|period| period.events.len()).sum();
    // It falls for a time of 1 and is back after 2 more.
    let exact = (found.records.len() as f64 * std::f64::consts::TAU - 1.0).div_euclid(2.0) + 1.0;
    assert_eq!(total as f64, exact);
}

/// What is measured in a period is what the orbit's monitors are.
#[test]
fn measures_of_a_period_are_those_of_the_orbit() {
    let names =
        ["max_displacement", "displacement_range", "poincare_velocity", "impact_velocity", "step"];
    let names = names.map(String::from);
    let mut motion = PeriodMap::of(&Actuator, HybridSettings::default(), &names).unwrap();
    let found = AttractorSearch::default()
        .follow(&mut motion, at(0, &[0.1, -0.2]), &mita(0.24, 0.5))
        .unwrap();
    let measures = &found.records[0].measures;
    close(measures[0], 0.5, 1e-14);
    let impact = &found.records[0].events[0];
    close(impact.before.x[1], measures[3], 1e-14);
    // The frame slips with u₁ = 1.8 u/6 against μN/5 + …: by the momentum that the impact gives it.
    assert!(measures[1] > 0.9 && measures[2] > 0.4 && measures[4] > 0.0, "{measures:?}");
    let unknown = PeriodMap::of(&Actuator, HybridSettings::default(), &["pressure".into()]).err();
    assert!(matches!(unknown, Some(StroboscopicError::NoMeasure { .. })));
}

fn plan(order: Order, strands: usize, count: usize) -> Plan {
    let axis = Axis { quantity: Quantity::Parameter(0), low: 0.55, high: 0.62, count };
    let search = AttractorSearch {
        transient: 30,
        recorded_periods: 10,
        lyapunov_periods: 20,
        ..AttractorSearch::default()
    };
    Plan {
        axes: vec![axis],
        starts: vec![at(0, &[0.1, -0.2])],
        order,
        strands,
        search,
        crisis: None,
    }
}

fn swept(
    plan: &Plan,
    part: Part,
    known: &BTreeMap<usize, Found>,
    most: usize,
) -> BTreeMap<usize, Found> {
    let make = || -> Result<Box<dyn StroboscopicMap>, StroboscopicError> {
        let flow = Settings::new(Scheme::DormandPrince8, 1e-9);
        let settings = HybridSettings { flow, ..HybridSettings::default() };
        Ok(Box::new(PeriodMap::of(&Actuator, settings, &[])?))
    };
    let end = |found: &Found| found.attractor.as_ref().ok().map(|settled| settled.end.clone());
    let done = |run: usize| known.get(&run).map(end);
    let mut all = known.clone();
    let mut left = most;
    let cancel = CancelToken::default();
    let search = AttractorSearch { cancel: cancel.clone(), ..plan.search.clone() };
    let plan = &Plan { search, ..plan.clone() };
    execute(plan, part, &mita(0.0, 0.5), &make, &done, &mut |found: Found| {
        if left == 0 {
            return;
        }
        all.insert(found.run, found);
        left -= 1;
        if left == 0 {
            cancel.cancel();
        }
    })
    .unwrap();
    all
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(6))]

    /// However a sweep is stopped, resumed and split, its runs are bit-identical.
    #[test]
    fn sweeps_do_not_depend_on_how_they_are_done(
        order in prop::sample::select(vec![Order::Anew, Order::Up, Order::Down]),
        strands in 1..4_usize,
        stop in 1..8_usize,
        parts in 1..4_usize,
    ) {
        let plan = plan(order, strands, 9);
        let nothing = BTreeMap::new();
        let whole = swept(&plan, Part::WHOLE, &nothing, usize::MAX);
        prop_assert_eq!(whole.len(), 9);
        let begun = swept(&plan, Part::WHOLE, &nothing, stop);
        prop_assert_eq!(begun.len(), stop);
        prop_assert_eq!(&swept(&plan, Part::WHOLE, &begun, usize::MAX), &whole);
        let mut merged = BTreeMap::new();
        for number in 1..=parts {
            let part = Part { number, of: parts, threads: NonZeroUsize::new(number) };
            merged.append(&mut swept(&plan, part, &nothing, usize::MAX));
        }
        prop_assert_eq!(&merged, &whole);
    }
}

#[test]
fn plans_without_meaning_are_refused() {
    let refused = |plan: &Plan| plan.check(9).unwrap_err();
    assert_eq!(refused(&plan(Order::Up, 1, 0)), PlanError::Nothing("the count of an axis"));
    let mut grid = plan(Order::Up, 1, 3);
    grid.axes.push(grid.axes[0]);
    assert_eq!(refused(&grid), PlanError::Followed(2));
    grid.order = Order::Anew;
    assert_eq!((grid.runs(), grid.check(9)), (9, Ok(())));
    grid.axes[0].high = f64::NAN;
    assert!(matches!(refused(&grid), PlanError::Interval { .. }));
}

/// A parameter, a state, or a setting of the search for a crisis that is invalid is an error,
/// where the plan is checked and where it is executed.
#[test]
fn plans_for_another_system_are_refused() {
    let refused = |plan: &Plan| {
        let make = || -> Result<Box<dyn StroboscopicMap>, StroboscopicError> {
            Ok(Box::new(PeriodMap::of(&Actuator, HybridSettings::default(), &[])?))
        };
        let visit = &mut |_: Found| {};
        let (p, nothing) = (Actuator::DEFAULTS, &|_| None);
        let executed = execute(plan, Part::WHOLE, &p, &make, nothing, visit);
        let (executed, checked) = (executed.unwrap_err(), plan.check(9).unwrap_err());
        assert_eq!(executed.to_string(), checked.to_string());
        executed
    };
    let mut varied = plan(Order::Anew, 1, 2);
    varied.axes[0].quantity = Quantity::Parameter(9);
    let expected = PlanError::Quantity { axis: 0, what: "parameter", position: 9, count: 9 };
    assert_eq!(refused(&varied), expected);
    varied.axes[0].quantity = Quantity::State(2);
    let expected = PlanError::Quantity { axis: 0, what: "state", position: 2, count: 2 };
    assert_eq!(refused(&varied), expected);
    let sound = CrisisSearch::of(0, [0.24, 0.2345], 2e-5);
    let invalid = [
        (CrisisSearch { parameter: 9, ..sound }, "the system has only 9 parameters"),
        (CrisisSearch { steps: 0, ..sound }, "has 0 steps"),
        (CrisisSearch { tolerance: 0.0, ..sound }, "tolerance of 0"),
        (CrisisSearch { tolerance: -1e-3, ..sound }, "tolerance of -0.001"),
        (CrisisSearch { tolerance: f64::NAN, ..sound }, "tolerance of NaN"),
        (CrisisSearch { between: [0.24, f64::INFINITY], ..sound }, "finite"),
    ];
    for (crisis, message) in invalid {
        let sought = Plan { crisis: Some(crisis), ..plan(Order::Anew, 1, 2) };
        let error = refused(&sought).to_string();
        assert!(error.contains(message), "{error}");
        let mut motion = PeriodMap::of(&Actuator, HybridSettings::default(), &[]).unwrap();
        let (start, p) = (at(0, &[0.1, -0.2]), Actuator::DEFAULTS);
        let error = AttractorSearch::default().crisis(&mut motion, start, &p, &crisis);
        assert!(matches!(error, Err(StroboscopicError::CrisisSearch(_))), "{error:?}");
    }
}

/// The largest chaotic band of `x ↦ 1 − a x²` is lost at `a = 2`: beyond, motion goes to infinity.
#[derive(Default)]
struct Parabola {
    layout: Layout,
    iterates: usize,
    /// Is cancelled at this iterate.
    cancel: Option<(CancelToken, usize)>,
}

impl StroboscopicMap for Parabola {
    fn layout(&self) -> &Layout {
        &self.layout
    }
    fn advance(&mut self, Member { state, p }: &mut Member<f64>) -> Result<(), StroboscopicError> {
        self.iterates += 1;
        if let Some((cancel, at)) = &self.cancel
            && self.iterates == *at
        {
            cancel.cancel();
        }
        state.x[0] = 1.0 - p[0] * state.x[0].powi(2);
        let stays = state.x[0].abs() < 3.0;
        if stays { Ok(()) } else { Err(StroboscopicError::Map("motion leaves".into())) }
    }
    fn record(&mut self, member: &mut Member<f64>) -> Result<Period, StroboscopicError> {
        let start = member.state.clone();
        self.advance(member)?;
        Ok(Period { start, events: Vec::new(), measures: Vec::new() })
    }
    fn push_forward(&mut self, member: &mut Member<Dual64>) -> Result<(), StroboscopicError> {
        let Member { state, p } = member;
        state.x[0] = -p[0] * state.x[0] * state.x[0] + 1.0;
        Ok(())
    }
}

/// A tolerance below the spacing of numbers ends at neighbouring numbers, and a search that is
/// cancelled ends.
#[test]
fn a_search_for_a_crisis_ends() {
    let search = AttractorSearch {
        transient: 20_000,
        lyapunov_periods: 0,
        recorded_periods: 50,
        ..AttractorSearch::default()
    };
    let sought = CrisisSearch::of(0, [1.9, 2.1], 1e-300);
    let mut map = Parabola::default();
    let found = search.crisis(&mut map, at(0, &[0.3]), &[0.0], &sought).unwrap();
    let [chaos, lost] = found.between;
    assert_eq!(chaos.next_up(), lost);
    // Motion that leaves within 20 000 iterates is seen from a − 2 of about 1e-8 on.
    assert!((chaos - 2.0).abs() < 1e-6, "{chaos:.12}");
    let cancel = CancelToken::default();
    let search = AttractorSearch { cancel: cancel.clone(), ..search };
    let mut map = Parabola { cancel: Some((cancel, 30_000)), ..Parabola::default() };
    let sought = CrisisSearch { steps: 1_000_000, ..sought };
    let found = search.crisis(&mut map, at(0, &[0.3]), &[0.0], &sought);
    // No iterate follows the cancellation.
    assert_eq!((found.is_err(), map.iterates), (true, 30_000), "{found:?}");
}

/// Downwards, the chaotic band of type III ends in a crisis. X. Zhao (2004) has it at V = 0.2355;
/// chaos lives on for thousands of periods below, and dies by V = 0.23538.
#[test]
fn a_chaotic_band_ends_in_a_crisis() {
    let mut motion = PeriodMap::of(&Actuator, HybridSettings::default(), &[]).unwrap();
    let search =
        AttractorSearch { transient: 3000, lyapunov_periods: 0, ..AttractorSearch::default() };
    let start = at(0, &[0.1, -0.2]);
    let p = mita(0.0, 0.45);
    let find = |motion: &mut PeriodMap, between| {
        search.crisis(motion, start.clone(), &p, &CrisisSearch::of(0, between, 2e-5))
    };
    let crisis = find(&mut motion, [0.24, 0.2345]).unwrap();
    let [alive, lost] = crisis.between;
    assert!(alive > lost && alive < 0.23545 && lost > 0.2353, "{crisis:?}");
    assert_eq!(crisis.beyond, Some(1));
    // Chaos at both ends.
    let refused = find(&mut motion, [0.25, 0.24]).unwrap_err();
    assert_eq!(refused, StroboscopicError::NoCrisis { from: 0.25, to: 0.24, steps: 1 });
}

/// Motions followed abreast are on the attractors on which they are alone: at rest from impacts,
/// and with one or more in a period.
#[test]
fn attractors_found_abreast_are_those_found_one_by_one() {
    let penetration = ["penetration".to_string()];
    let mut map =
        PeriodMap::of(&ImpactOscillator, HybridSettings::default(), &penetration).unwrap();
    let member = |(k, amplitude): (usize, f64)| Member {
        state: at(ImpactOscillator::FLIGHT, &[0.1 * k as f64, -0.2]),
        p: vec![amplitude, 2.2, 0.8, 0.1, 1.0],
    };
    let members: Vec<_> =
        [1.0, 2.0, 3.0, 5.0, 5.5, 6.0].into_iter().enumerate().map(member).collect();
    let search = AttractorSearch { lyapunov_periods: 0, ..AttractorSearch::default() };
    let abreast = search.follow_all(&mut map, members.clone());
    let mut cycles = 0;
    for (Member { state, p }, found) in members.into_iter().zip(abreast) {
        let (found, alone) = (found.unwrap(), search.follow(&mut map, state, &p).unwrap());
        assert_eq!(found.periods, alone.periods);
        if found.periods.is_some() {
            cycles += 1;
            assert_eq!((&found.events, found.accumulations), (&alone.events, alone.accumulations));
            found.end.x.iter().zip(&alone.end.x).for_each(|(a, b)| close(*a, *b, 1e-8));
            let measured = |of: &Attractor| of.records[0].measures[0];
            close(measured(&found), measured(&alone), 1e-7);
            close(found.exponent.unwrap().value, alone.exponent.unwrap().value, 1e-7);
        }
    }
    assert!(cycles >= 4);
}

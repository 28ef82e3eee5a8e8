//! Motions in lanes of all widths that the processor has are bit-identical, and those of
//! the widest registers are chosen where nothing was said to the compiler.

use num_dual::{Dual64, DualNum};
use std::f64::consts::PI;
use std::ops::ControlFlow;
use tangency::core::hybrid::{
    Fleet, FleetObserver, Guard, HybridEquations, HybridSettings, HybridState, HybridStatistics,
    HybridSystem, Member, Mode,
};
use tangency::core::ode::{Scheme, Settings};
use tangency::core::scalar::{LaneWidth, Scalar};
use tangency::language::{Model, Source};
use tangency::problems::mita::Actuator;

/// The actuator by formulas.
const ACTUATOR: &str = include_str!("../models/actuator.ron");

/// Follows members for some periods.
struct Periods(Vec<usize>);

impl<T: Scalar> FleetObserver<T> for Periods {
    fn arrived(
        &mut self,
        member: usize,
        state: &mut HybridState<T>,
        _statistics: &HybridStatistics,
    ) -> ControlFlow<()> {
        state.time = T::zero();
        self.0[member] += 1;
        if self.0[member] < 3 { ControlFlow::Continue(()) } else { ControlFlow::Break(()) }
    }
}

fn settings(scheme: Scheme) -> HybridSettings {
    HybridSettings { flow: Settings::new(scheme, 1e-11), ..HybridSettings::default() }
}

/// From motion without impacts, by way of chatter, to chaos.
fn members() -> Vec<Member<f64>> {
    let member = |k: usize| {
        let mut p = Actuator::DEFAULTS.to_vec();
        p[0] = 0.2 + 0.006 * k as f64;
        let x = vec![0.1 - 0.002 * k as f64, 0.05];
        Member { state: HybridState { mode: Actuator::STICK, time: 0.0, x }, p }
    };
    (0..99).map(member).collect()
}

/// The same with derivatives with respect to the voltage.
fn seeded() -> Vec<Member<Dual64>> {
    let seed = |Member { state, p }: Member<f64>| {
        let HybridState { mode, time, x } = state;
        let mut p: Vec<Dual64> = p.into_iter().map(Dual64::from).collect();
        p[0] = p[0].derivative();
        let x = x.into_iter().map(Dual64::from).collect();
        Member { state: HybridState { mode, time: time.into(), x }, p }
    };
    members().into_iter().map(seed).collect()
}

/// What becomes of members in lanes of a width, by a function of a name for each scalar.
macro_rules! moved {
    ($($name:ident: $number:ty;)*) => {$(
        fn $name(
            system: &dyn HybridEquations,
            mut members: Vec<Member<$number>>,
            (scheme, width): (Scheme, LaneWidth),
        ) -> Vec<Member<$number>> {
            let mut periods = Periods(vec![0; members.len()]);
            let mut fleet = Fleet::in_lanes(system, settings(scheme), width).expect("settings");
            assert_eq!(fleet.lanes(), width.lanes());
            let period = |member: &Member<$number>| member.p[1].recip() * PI;
            let results = fleet.advance(&mut members, period, &mut periods);
            assert!(results.iter().all(Result::is_ok));
            members
        }
    )*};
}

moved! { moved: f64; moved_with_slopes: Dual64; }

/// All digits of the states, derivatives included.
fn digits<T: std::fmt::Debug>(members: &[Member<T>]) -> String {
    members.iter().map(|member| format!("{:?}\n", member.state)).collect()
}

#[test]
fn motions_are_the_same_to_the_last_bit_in_lanes_of_all_widths() {
    let Ok(Model::Hybrid(text)) = Model::read(&Source::new("actuator.ron", ACTUATOR), &[]) else {
        panic!("a hybrid system")
    };
    for scheme in [Scheme::DormandPrince8, Scheme::DormandPrince5] {
        for system in [&Actuator as &dyn HybridEquations, &*text] {
            let narrow = (scheme, LaneWidth::Baseline);
            let states = digits(&moved(system, members(), narrow));
            for width in LaneWidth::available().skip(1) {
                let wide = (scheme, width);
                let found = digits(&moved(system, members(), wide));
                assert_eq!(found, states, "{scheme:?}, {width}");
            }
        }
    }
}

/// States to the last bit, derivatives to rounding.
#[test]
fn derivatives_are_the_same_in_lanes_of_all_widths() {
    let narrow =
        moved_with_slopes(&Actuator, seeded(), (Scheme::DormandPrince8, LaneWidth::Baseline));
    for width in LaneWidth::available().skip(1) {
        let wide = moved_with_slopes(&Actuator, seeded(), (Scheme::DormandPrince8, width));
        for (a, b) in narrow.iter().zip(&wide) {
            assert_eq!(a.state.mode, b.state.mode);
            for (a, b) in a.state.x.iter().zip(&b.state.x) {
                assert_eq!(a.re.to_bits(), b.re.to_bits(), "{width}");
                assert!((a.eps - b.eps).abs() <= 1e-9 * (1.0 + a.eps.abs()), "{width}: {a} {b}");
            }
        }
    }
}

/// `x' = sin a`, `y' = cos a`, `z' = √|a|`: after a time of 1 states from 0 are the functions.
struct Circular;

impl HybridSystem for Circular {
    fn modes(&self) -> Vec<Mode> {
        vec![Mode::new("free", ["x", "y", "z"])]
    }

    fn guards(&self) -> Vec<Guard> {
        Vec::new()
    }

    fn parameters(&self) -> Vec<String> {
        vec!["a".into()]
    }

    fn field<T: Scalar>(&self, _mode: usize, _t: T, _x: &[T], p: &[T], f: &mut [T]) {
        (f[0], f[1], f[2]) = (p[0].sin(), p[0].cos(), (p[0] * p[0]).sqrt().sqrt());
    }

    fn guard<T: Scalar>(&self, _guard: usize, _mode: usize, _t: T, _x: &[T], _p: &[T]) -> T {
        T::one()
    }

    fn next_mode(&self, _guard: usize, mode: usize, _t: f64, _x: &[f64], _p: &[f64]) -> usize {
        mode
    }

    fn in_lanes(&self) -> Option<LaneWidth> {
        Some(LaneWidth::compiled())
    }
}

/// Ends where members arrive.
struct Once;

impl FleetObserver<f64> for Once {
    fn arrived(
        &mut self,
        _member: usize,
        _state: &mut HybridState<f64>,
        _statistics: &HybridStatistics,
    ) -> ControlFlow<()> {
        ControlFlow::Break(())
    }
}

/// In all quadrants, and for numbers too large to be reduced exactly. The field is compiled without
/// the instructions of wide registers.
#[test]
fn sines_in_lanes_are_those_of_real_numbers() {
    let quadrants = (-4000..4000).map(|k| 0.08 * f64::from(k) + 1e-3);
    let large = [1e6, -3e8, 1.0, f64::INFINITY, 0.0, 2e5, 7.0, -1.0];
    let angles: Vec<f64> = quadrants.chain(large).collect();
    let state = HybridState { mode: 0, time: 0.0, x: vec![0.0; 3] };
    let member = |a: &f64| Member { state: state.clone(), p: vec![*a] };
    let starts: Vec<Member<f64>> = angles.iter().map(member).collect();
    let mut narrow = None;
    for width in LaneWidth::available() {
        let (mut fleet, scheme) = (starts.clone(), Scheme::DormandPrince8);
        let mut many = Fleet::in_lanes(&Circular, settings(scheme), width).expect("settings");
        let results = many.advance(&mut fleet, |_| 1.0, &mut Once);
        for ((a, member), result) in angles.iter().zip(&fleet).zip(&results) {
            assert_eq!(result.is_ok(), a.is_finite(), "{a}");
            if let ([x, y, z], Ok(())) = (&member.state.x[..], result) {
                assert!((x - a.sin()).abs() < 3e-15 && (y - a.cos()).abs() < 3e-15, "{a}: {x} {y}");
                assert!((z - a.abs().sqrt()).abs() <= 1e-14 * z, "{a}: {z}");
            }
        }
        let narrow = narrow.get_or_insert(digits(&fleet));
        assert_eq!(*narrow, digits(&fleet), "{width}");
    }
}

/// This program is compiled for every processor of its target, as those are that use the library
/// without flags of their own.
#[test]
fn lanes_are_as_wide_as_the_registers_of_the_processor() {
    let available: Vec<LaneWidth> = LaneWidth::available().collect();
    assert_eq!(available[0], LaneWidth::Baseline);
    assert_eq!(available.last(), Some(&LaneWidth::widest()));
    assert!(available.is_sorted() && available.contains(&LaneWidth::compiled()));
    #[cfg(target_arch = "x86_64")]
    {
        let has_avx2 = is_x86_feature_detected!("avx2") && is_x86_feature_detected!("fma");
        assert_eq!(available.contains(&LaneWidth::Avx2), has_avx2);
        let has_avx512 = is_x86_feature_detected!("avx512vbmi2");
        assert_eq!(LaneWidth::widest().lanes(), if has_avx512 { 8 } else { 4 });
    }
    let lanes = |system| {
        Fleet::<f64>::new(system, settings(Scheme::DormandPrince8)).expect("settings").lanes()
    };
    assert_eq!(lanes(&Actuator as &dyn HybridEquations), LaneWidth::widest().lanes());
    // Not all that it calls is known to be inlined.
    assert_eq!(lanes(&Circular), LaneWidth::compiled().lanes());
    let implicit = Fleet::<f64>::new(&Actuator, settings(Scheme::Rodas5P)).expect("settings");
    assert_eq!(implicit.lanes(), 1);
}

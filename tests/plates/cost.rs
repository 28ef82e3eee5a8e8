//! A trace costs little more than its algebra: residuals, Jacobians, linear solves, derivatives, spectra.

use crate::models::{plate, system, through_pull_in};
use std::cell::Cell;
use std::rc::Rc;
use std::time::{Duration, Instant};
use tangency::core::continuation::{Kind, Settings};
use tangency::core::zero::{
    Border, Dynamics, LeftDomain, Names, Profile, Refinement, Singular, Slot, Spectrum, System,
};
use tangency::problems::plate::{InPlane, Orders};

/// A system that adds up the time spent in it.
struct Timed {
    inner: Box<dyn System>,
    spent: Rc<Cell<Duration>>,
}

impl Timed {
    fn time<T>(&mut self, work: impl FnOnce(&mut dyn System) -> T) -> T {
        let started = Instant::now();
        let result = work(&mut *self.inner);
        self.spent.set(self.spent.get() + started.elapsed());
        result
    }
}

impl System for Timed {
    fn names(&self) -> &Names {
        self.inner.names()
    }
    fn residual(&mut self, x: &[f64], r: &mut [f64]) -> Result<(), LeftDomain> {
        self.time(|system| system.residual(x, r))
    }
    fn assemble(&mut self, x: &[f64]) -> Result<(), LeftDomain> {
        self.time(|system| system.assemble(x))
    }
    fn factor(&mut self, slot: Slot, border: Border) -> Result<(), Singular> {
        self.time(|system| system.factor(slot, border))
    }
    fn solve(&mut self, slot: Slot, right: &mut [f64]) {
        self.time(|system| system.solve(slot, right));
    }
    fn solve_transposed(&mut self, slot: Slot, right: &mut [f64]) {
        self.time(|system| system.solve_transposed(slot, right));
    }
    fn jacobian(&mut self, out: &mut [f64]) {
        self.time(|system| system.jacobian(out));
    }
    fn determinant_sign(&self, slot: Slot) -> f64 {
        self.inner.determinant_sign(slot)
    }
    fn derivative(&mut self, x: &[f64], d: &[f64], out: &mut [f64]) {
        self.time(|system| system.derivative(x, d, out));
    }
    fn second_derivative(&mut self, x: &[f64], d: &[f64], e: &[f64], out: &mut [f64]) {
        self.time(|system| system.second_derivative(x, d, e, out));
    }
    fn third_derivative(&mut self, x: &[f64], d: &[f64], e: &[f64], f: &[f64], out: &mut [f64]) {
        self.time(|system| system.third_derivative(x, d, e, f, out));
    }
    fn gradient(&mut self, x: &[f64], w: &[f64], v: &[f64], released: &[usize], out: &mut [f64]) {
        self.time(|system| system.gradient(x, w, v, released, out));
    }
    fn second_gradient(
        &mut self,
        x: &[f64],
        w: &[f64],
        v: &[f64],
        released: &[usize],
        out: &mut [f64],
    ) {
        self.time(|system| system.second_gradient(x, w, v, released, out));
    }
    fn dynamics(&self) -> Dynamics {
        self.inner.dynamics()
    }
    fn spectrum(&mut self, x: &[f64]) -> Option<Spectrum> {
        self.time(|system| system.spectrum(x))
    }
    fn monitors(&mut self, x: &[f64], values: &mut [f64]) -> Result<(), LeftDomain> {
        self.time(|system| system.monitors(x, values))
    }
    fn monitor_gradient(&mut self, monitor: usize, x: &[f64], released: &[usize], out: &mut [f64]) {
        self.time(|system| system.monitor_gradient(monitor, x, released, out));
    }
    fn profiles(&mut self, x: &[f64]) -> Vec<Profile> {
        self.inner.profiles(x)
    }
    /// Setting up a finer plate (tables of functions and their products) does not count as algebra.
    fn refined(&self, x: &[f64]) -> Option<Refinement> {
        let Refinement { system, x } = self.inner.refined(x)?;
        let spent = Rc::clone(&self.spent);
        Some(Refinement { system: Box::new(Timed { inner: system, spent }), x })
    }
}

/// The whole time of a trace of the clamped plate, and the time spent in its algebra.
fn trace(orders: Option<Orders>, settings: &Settings) -> [Duration; 2] {
    let mut settings_of_plate = plate("CCCC", InPlane::Immovable);
    settings_of_plate.orders = orders;
    let spent = Rc::new(Cell::new(Duration::ZERO));
    let inner = system(&settings_of_plate, 1.0);
    let mut timed = Timed { inner, spent: Rc::clone(&spent) };
    let started = Instant::now();
    let curve = through_pull_in(&mut timed, &[]).settings(settings.clone());
    let branch = curve.mark("frequency_ratio", 0.1).trace().unwrap();
    let whole = started.elapsed();
    assert_eq!(branch.of_kind(Kind::LP).count(), 1);
    [whole, spent.get()]
}

/// The least of several runs, of which the machine has disturbed some: the whole time, the time spent in
/// algebra, and the least time spent elsewhere.
fn least(orders: Option<Orders>, settings: &Settings) -> [Duration; 3] {
    let runs: Vec<_> = (0..5).map(|_| trace(orders, settings)).collect();
    let smallest = |pick: fn(&[Duration; 2]) -> Duration| runs.iter().map(pick).min().unwrap();
    [smallest(|run| run[0]), smallest(|run| run[1]), smallest(|run| run[0] - run[1])]
}

/// At default settings nine tenths of the time of `plate-clamped` are spent in algebra, and nearly all of it
/// on the branch's own discretisation, where no finer plate is set up. Shows how time grows with the number
/// of functions.
#[test]
fn a_trace_spends_nine_tenths_of_its_time_in_algebra() {
    let coarse = Settings { refinement: 0.0, ..Settings::default() };
    for (what, settings) in [("default settings", Settings::default()), ("unrefined", coarse)] {
        let [whole, algebra, rest] = least(None, &settings);
        let share = algebra.as_secs_f64() / (algebra + rest).as_secs_f64();
        println!("{what}: {whole:.1?}, of which {:.1} % in algebra", 100.0 * share);
        assert!(share > 0.9, "{what}: {algebra:?} in algebra, {rest:?} elsewhere");
    }
    println!("functions each way, unknowns, time of a trace without refinement:");
    let settings = Settings { refinement: 0.0, ..Settings::default() };
    let times = [4, 6, 8, 10, 12].map(|count| {
        let orders = Orders { transverse: [count; 2], in_plane: [count + 2; 2] };
        let [whole, algebra, rest] = least(Some(orders), &settings);
        println!("{count:>4} {:>6} {:>10.1} ms", count * count, 1e3 * whole.as_secs_f64());
        // What is not algebra grows no faster than it.
        assert!(rest < algebra / 9, "{count}: {algebra:?} in algebra, {rest:?} elsewhere");
        whole.as_secs_f64()
    });
    // Nine times the unknowns cost less than the cube of nine, which dense algebra alone would.
    assert!(times[4] / times[0] < 729.0, "{times:?}");
    assert!(times.windows(2).all(|pair| pair[1] > pair[0]), "{times:?}");
}

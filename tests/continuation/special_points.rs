//! Promise: a special point is good to about 1e-10, and its error estimate and bracket are honest.

use crate::common::{CuspForm, close, first, values};
use proptest::prelude::*;
use tangency::core::bifurcation::{At, DefiningSystem};
use tangency::core::continuation::{Branch, Continuation, End, Event, Settings, TraceError};
use tangency::core::failure::{Failure, one_line};
use tangency::core::linalg::{Border, Factors, Form, Spectrum, SpectrumRequest};
use tangency::core::problem::{Dynamics, Equilibria, Names, ZeroProblem};
use tangency::core::scalar::Scalar;
use tangency::core::system::{Dense, Discretised, Functional, Kind, Refinement, System};
use tangency::problems::classic::Hyperbola;
use tangency::{vector_field, zero_problem};

/// `load = scale (x − a)(x − b)(x − c)` in units: folds where the cubic's slope vanishes.
#[derive(Clone, Debug)]
struct Cubic {
    roots: [f64; 3],
    unit: f64,
    scale: f64,
}

impl Cubic {
    /// The cubic and its slope over `scale`, in units of `x`.
    fn value(&self, x: f64) -> f64 {
        self.roots.iter().map(|a| x - a).product::<f64>() * self.scale
    }

    /// Both folds, ascending in `x`: roots of 3x² − 2Sx + P, S = a + b + c, P = ab + bc + ca.
    fn folds(&self) -> [(f64, f64); 2] {
        let [a, b, c] = self.roots;
        let (s, p) = (a + b + c, a * b + b * c + c * a);
        let root = (s * s - 3.0 * p).sqrt();
        let larger = (s + root.copysign(s)) / 3.0;
        let smaller = if larger == 0.0 { -root / 3.0 } else { p / (3.0 * larger) };
        let mut x = [larger, smaller];
        x.sort_by(f64::total_cmp);
        x.map(|x| (x, self.value(x)))
    }
}

impl ZeroProblem for Cubic {
    fn names(&self) -> Names {
        Names::new(["x"], ["load"])
    }
    fn residual<T: Scalar>(&self, x: &[T], p: &[T], r: &mut [T]) {
        let x = x[0] / self.unit;
        r[0] = p[0] - (x - self.roots[0]) * (x - self.roots[1]) * (x - self.roots[2]) * self.scale;
    }
    fn dynamics(&self) -> Dynamics {
        Dynamics::None
    }
}

vector_field! {
    /// `load = x²` at rest.
    struct Parabola [x; load] {
        d/dt x = load - x * x;
    }
}

/// A start that is a fold, or is near one, leads to both of its sides, and the fold is found: near it
/// x is small, and measured by its size there, but the load goes to its bounds.
#[test]
fn a_start_at_a_fold() {
    for start in [0.0, 1e-12, 5e-9, 1e-6] {
        let mut system = Dense::new(Equilibria::new(Parabola));
        let branch = Continuation::new(&mut system)
            .from(&[start])
            .at("load", start * start)
            .along("load", -1.0..=1.0)
            .trace()
            .unwrap();
        let at_bound = |end: &End| matches!(end, End::ParameterBound { value: 1.0, .. });
        assert!(branch.ends.iter().all(at_bound), "{start}: {:?}", branch.ends);
        let folds: Vec<_> =
            branch.of_kind(Kind::LP).map(|it| (it.converged, it.state[0])).collect();
        assert_eq!(folds.len(), 1, "{start}: {folds:?}");
        assert!(folds[0].0 && folds[0].1.abs() < 1e-10, "{start}: {folds:?}");
    }
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 100, failure_persistence: None, ..ProptestConfig::default() })]

    /// Random cubics in random units: both folds, found to 1e-10 of the load's range, within the
    /// error estimate (and rounding in the exact value), within the bracket.
    #[test]
    fn folds_of_random_cubics(
        a in -2.0..-0.3_f64,
        b in -0.3..0.3_f64,
        c in 0.3..2.0_f64,
        unit in -6.0..6.0_f64,
        scale in -6.0..6.0_f64,
    ) {
        let problem =
            Cubic { roots: [a, b, c], unit: 10f64.powf(unit), scale: 10f64.powf(scale) };
        let (unit, scale) = (problem.unit, problem.scale);
        let exact = problem.folds();
        let start = problem.value(a - 0.5);
        let low = start.min(exact[1].1) - 0.1 * scale;
        let high = problem.value(c + 0.5).max(exact[0].1) + 0.1 * scale;
        let mut system = Dense::new(problem);
        let branch = Continuation::new(&mut system)
            .from(&[(a - 0.5) * unit])
            .at("load", start)
            .along("load", low..=high)
            .trace()
            .unwrap();
        let folds: Vec<_> = branch.of_kind(Kind::LP).collect();
        prop_assert_eq!(folds.len(), 2);
        for (fold, (x, load)) in folds.iter().zip(exact) {
            let off = (fold.parameters[0] - load).abs();
            prop_assert!(fold.converged && fold.error < 1e-10 * (high - low));
            prop_assert!(off <= fold.error + 8.0 * f64::EPSILON * scale, "{off:.1e} {:.1e}", fold.error);
            prop_assert!((fold.state[0] / unit - x).abs() < 1e-10);
            // The fold is an extremum of the load between two points that enclose it.
            let [before, behind] = fold.bracket;
            let maximum = load > before.min(behind);
            let beyond = if maximum { before.max(behind) <= load } else { before.min(behind) >= load };
            prop_assert!(beyond, "{before} {load} {behind}");
            let enclosing = [fold.after, fold.after + 1].map(|i| branch.points[i].parameters[0]);
            prop_assert_eq!(enclosing, fold.bracket);
        }
    }
}

/// Two folds that come together in a cusp, `a → 0`: both are found, or neither, and each is right.
#[test]
fn folds_close_to_a_cusp() {
    for a in [1e-1, 1e-2, 1e-3, 1e-4] {
        let mut system = Dense::new(CuspForm);
        let branch = Continuation::new(&mut system)
            .from(&[-1.0])
            .at("b", -1.0)
            .at("a", a)
            .along("b", -2.0..=2.0)
            .trace()
            .unwrap();
        let found = values(&branch, Kind::LP, "b");
        let exact = 2.0 * (a / 3.0_f64).powf(1.5);
        assert_eq!(found.len(), 2, "a = {a}");
        close(found[0], -exact, 1e-14);
        close(found[1], exact, 1e-14);
        for fold in branch.of_kind(Kind::LP) {
            assert!((fold.parameters[0].abs() - exact).abs() <= fold.error + 1e-16);
        }
    }
}

/// Through the cusp itself, a = 0: a vertical tangent that is no fold.
#[test]
fn a_cusp_is_no_fold() {
    let mut system = Dense::new(CuspForm);
    let branch =
        Continuation::new(&mut system).from(&[-1.0]).at("b", -1.0).along("b", -2.0..=2.0).trace();
    let branch = branch.unwrap();
    assert_eq!(branch.of_kind(Kind::LP).count() % 2, 0);
    assert_eq!(branch.of_kind(Kind::BP).count(), 0);
    for fold in branch.of_kind(Kind::LP) {
        close(fold.parameters[0], 0.0, fold.error + 1e-12);
    }
}

/// A fold close to a branch point: the branch `p = x + x²/d − …` folds near the crossing at 0.
#[test]
fn a_fold_near_a_branch_point() {
    zero_problem! {
        /// `x (p − x² + d x)`: crossing at p = 0, fold of the curved branch at x = d/2, p = −d²/4.
        struct Near { d: f64 } [x; p] {
            0 = x * (p - x * x + x * d);
        }
    }
    for d in [0.1, 0.01, 0.001] {
        let mut system = Dense::new(Near { d });
        let x: f64 = -0.6;
        let branch = Continuation::new(&mut system)
            .from(&[x])
            .at("p", x * x - x * d)
            .along("p", -1.0..=1.0)
            .trace()
            .unwrap();
        let (branching, folds) = (values(&branch, Kind::BP, "p"), values(&branch, Kind::LP, "p"));
        assert_eq!((branching.len(), folds.len()), (1, 1), "d = {d}");
        close(branching[0], 0.0, 1e-12);
        close(folds[0], -d * d / 4.0, 1e-12);
        for special in branch.special.iter().filter(|s| s.kind != Kind::EP) {
            let exact = if special.kind == Kind::BP { 0.0 } else { -d * d / 4.0 };
            assert!((special.parameters[0] - exact).abs() <= special.error + 1e-15);
        }
    }
}

/// Bratu's problem on `n` points with two monitors, in either order.
#[derive(Clone, Copy)]
struct Grid {
    n: usize,
    middle_first: bool,
}

impl ZeroProblem for Grid {
    fn names(&self) -> Names {
        let monitors = if self.middle_first { ["middle", "slope"] } else { ["slope", "middle"] };
        Names::new([("u", self.n)], ["lambda"]).with_monitors(monitors)
    }
    fn residual<T: Scalar>(&self, u: &[T], p: &[T], r: &mut [T]) {
        crate::common::Bratu(self.n).residual(u, p, r);
    }
    fn monitors<T: Scalar>(&self, u: &[T], _p: &[T], values: &mut [T]) {
        let place = usize::from(!self.middle_first);
        values[place] = u[self.n / 2];
        values[1 - place] = u[0] * (self.n + 1) as f64;
    }
}

/// That problem, which can be refined to `2n + 1`: everything else is that of `Dense`.
struct Refinable(Dense<Grid>, Grid);

impl Refinable {
    fn new(grid: Grid) -> Self {
        Refinable(Dense::new(grid), grid)
    }
}

impl System for Refinable {
    fn names(&self) -> &Names {
        self.0.names()
    }
    fn residual(&mut self, x: &[f64], r: &mut [f64]) -> Result<(), Failure> {
        self.0.residual(x, r)
    }
    fn assemble(&mut self, x: &[f64]) -> Result<(), Failure> {
        self.0.assemble(x)
    }
    fn factor(&mut self, form: Form, border: Border, into: &mut Factors) -> Result<(), Failure> {
        self.0.factor(form, border, into)
    }
    fn derivative(
        &mut self,
        x: &[f64],
        directions: &[&[f64]],
        out: &mut [f64],
    ) -> Result<(), Failure> {
        self.0.derivative(x, directions, out)
    }
    fn gradient(
        &mut self,
        x: &[f64],
        of: Functional,
        released: &[usize],
        out: &mut [f64],
    ) -> Result<(), Failure> {
        self.0.gradient(x, of, released, out)
    }
    fn dynamics(&self) -> Dynamics {
        Dynamics::None
    }
    fn spectrum(&mut self, _: &[f64], _: SpectrumRequest) -> Result<Option<Spectrum>, Failure> {
        Ok(None)
    }
    fn monitors(&mut self, x: &[f64], first: usize, values: &mut [f64]) -> Result<(), Failure> {
        self.0.monitors(x, first, values)
    }
    fn discretised(&mut self) -> Option<&mut dyn Discretised> {
        Some(self)
    }
}

impl Discretised for Refinable {
    fn refined(&mut self, x: &[f64]) -> Option<Refinement> {
        let Grid { n, middle_first } = self.1;
        if n > 100 {
            return None;
        }
        let at = |i: usize| if i == 0 || i > n { 0.0 } else { x[i - 1] };
        let mut fine: Vec<f64> = (1..=2 * n + 1)
            .map(|i| if i % 2 == 0 { at(i / 2) } else { 0.5 * (at(i / 2) + at(i / 2 + 1)) })
            .collect();
        fine.push(x[n]);
        Some(Refinement {
            system: Box::new(Refinable::new(Grid { n: 2 * n + 1, middle_first })),
            x: fine,
        })
    }

    fn coarser(&mut self, x: &[f64]) -> Option<Refinement> {
        let Grid { n, middle_first } = self.1;
        let mut coarse: Vec<f64> = (2..n).step_by(2).map(|i| x[i - 1]).collect();
        coarse.push(x[n]);
        Some(Refinement {
            system: Box::new(Refinable::new(Grid { n: (n - 1) / 2, middle_first })),
            x: coarse,
        })
    }
}

/// The exact fold of Bratu's problem, 8θ²/cosh²θ with θ tanh θ = 1.
const BRATU: f64 = 3.513_830_719_125_16;

fn bratu(n: usize, refinement: f64) -> Branch {
    let settings = Settings { refinement, ..Settings::default() };
    bratu_on(Grid { n, middle_first: true }, settings).unwrap()
}

fn bratu_on(grid: Grid, settings: Settings) -> Result<Branch, TraceError> {
    let mut system = Refinable::new(grid);
    Continuation::new(&mut system)
        .along("lambda", 0.0..=10.0)
        .bound("middle", 0.0..=3.0)
        .mark("middle", 0.5)
        .settings(settings)
        .trace()
}

/// What must settle is the parameter and what settings name, in whatever order monitors come.
#[test]
fn the_order_of_monitors_does_not_decide_what_settles() {
    let folds = |refinement: f64, refine: &[&str]| {
        [true, false].map(|middle_first| {
            let refine = refine.iter().map(|name| name.to_string()).collect();
            let settings = Settings { refinement, refine, ..Settings::default() };
            let branch = bratu_on(Grid { n: 7, middle_first }, settings).unwrap();
            let fold = first(&branch, Kind::LP).clone();
            let slope = fold.value(branch.column("slope").unwrap()).unwrap();
            (fold.parameters[0], fold.error, slope)
        })
    };
    let [alone, permuted] = folds(1e-2, &[]);
    assert_eq!(alone, permuted);
    let [with_slope, permuted] = folds(1e-2, &["slope"]);
    assert_eq!(with_slope, permuted);
    // The one-sided slope at the boundary, 4 at the fold, converges with the first order only.
    let off = |fold: (f64, f64, f64)| (fold.2 / 4.0 - 1.0).abs();
    assert!(off(with_slope) < 1e-2 && off(alone) > 2e-2, "{with_slope:?} {alone:?}");
    let settings = Settings { refine: vec!["slop".into()], ..Settings::default() };
    let unknown = one_line(&bratu_on(Grid { n: 7, middle_first: true }, settings).unwrap_err());
    assert!(unknown.contains("`slop`; did you mean `slope`?"), "{unknown}");
}

/// On the finest grid, n = 127, the error is the distance from the fold on a coarser grid, n = 63.
#[test]
fn without_a_finer_grid_special_points_are_compared_with_a_coarser_one() {
    let branch = bratu(127, 1e-9);
    let fold = first(&branch, Kind::LP);
    let off = (fold.parameters[0] - BRATU).abs();
    assert!(off > 1e-5 && fold.converged);
    assert!(off <= fold.error && fold.error < 10.0 * off, "{off:.1e} {:.1e}", fold.error);
    let said = "special points (UZ, LP) have a larger error than `refinement` = 1e-9 permits";
    assert!(branch.warnings[0].starts_with(said), "{:?}", branch.warnings);
}

/// Special points are finished on finer grids, n = 7, 15, 31, 63, 127, and the error covers what
/// the finest grid still is off; without refinement the answer is that of the coarse grid.
#[test]
fn special_points_are_finished_on_finer_grids() {
    let coarse = bratu(7, 0.0);
    let fine = bratu(7, 1e-9);
    let (rough, fold) =
        (crate::common::first(&coarse, Kind::LP), crate::common::first(&fine, Kind::LP));
    assert!((rough.parameters[0] - BRATU).abs() > 0.02);
    let off = (fold.parameters[0] - BRATU).abs();
    assert!(off < 2e-4, "{off:.1e}");
    assert!(off <= fold.error && fold.error < 10.0 * off, "{off:.1e} {:.1e}", fold.error);
    let said = "the relative error of `lambda` is up to";
    let warns = |branch: &Branch| branch.warnings.iter().any(|warning| warning.contains(said));
    assert!(warns(&fine) && !warns(&coarse), "{:?}", fine.warnings);
    // A refinement that a coarser grid reaches stops there.
    let modest = bratu(7, 1e-2);
    assert!(!warns(&modest));
    let fold = crate::common::first(&modest, Kind::LP);
    let off = (fold.parameters[0] - BRATU).abs();
    assert!(off > 3e-4 && off <= fold.error, "{off:.1e} {:.1e}", fold.error);
    // The state stays on the branch's own grid, from which it can be restarted.
    assert_eq!(fold.state.len(), 7);
    close(crate::common::first(&fine, Kind::UZ).monitors[0], 0.5, 1e-10);
}

#[test]
fn steps_do_not_go_over_to_a_branch_beside() {
    let trace = |epsilon: f64, settings: Settings| {
        let mut system = Dense::new(Hyperbola);
        Continuation::new(&mut system)
            .from(&[1.0_f64.hypot(epsilon)])
            .at("mu", -1.0)
            .at("epsilon", epsilon)
            .along("mu", -1.0..=1.0)
            .settings(settings)
            .trace()
            .unwrap()
    };
    for epsilon in [0.1, 0.01, 0.001] {
        let branch = trace(epsilon, Settings::default());
        assert_eq!(branch.of_kind(Kind::BP).count(), 0, "{epsilon}: {:?}", branch.special);
        close(branch.special.last().unwrap().state[0], 1.0_f64.hypot(epsilon), 1e-12);
    }
    // Steps that may not be shortened end with the reason.
    let fixed = Settings { initial_step: 0.1, min_step: 0.1, max_step: 0.1, ..Settings::default() };
    let End::StepTooSmall { cause, .. } = &trace(0.001, fixed).ends[1] else { panic!() };
    assert!(cause.contains("jumps to another branch"), "{cause}");
    // Where branches cross, there is a branch point.
    let crossing = trace(0.0, Settings::default());
    close(first(&crossing, Kind::BP).parameters[0], 0.0, 1e-12);
}

/// `x μ = 20`, which is not known below a value of `μ`.
struct Product {
    from: f64,
}

impl DefiningSystem for Product {
    fn kind(&self) -> Kind {
        Kind::UZ
    }
    fn start(&mut self, at: At, _y: &mut [f64]) -> Result<(), Failure> {
        match at.x[1] < self.from {
            true => Err(Failure::Undetermined("not known yet".into())),
            false => Ok(()),
        }
    }
    fn values(&mut self, at: At, _y: &[f64], values: &mut [f64]) -> Result<(), Failure> {
        values[0] = at.x[0] * at.x[1] - 20.0;
        Ok(())
    }
    fn gradients(&mut self, at: At, rows: &mut [f64], _own: &mut [f64]) -> Result<(), Failure> {
        rows.copy_from_slice(&[at.x[1], at.x[0], 0.0]);
        Ok(())
    }
}

/// A condition that cannot be stated where a branch begins is detected from where it can: on
/// `x² = μ² + 9` at `x = 5`, `μ = 4`.
#[test]
fn a_condition_is_asked_again_where_it_was_not_known() {
    for (from, found) in [(0.0, 1), (2.0, 1), (4.5, 0), (100.0, 0)] {
        let mut hyperbola = Dense::new(Hyperbola);
        let curve = Continuation::new(&mut hyperbola).from(&[3.0]).at("epsilon", 3.0);
        let event = Event::new("x μ = 20", move || Product { from });
        let branch = curve.along("mu", 0.0..=9.0).event(event).trace().unwrap();
        assert!(matches!(branch.ends[1], End::ParameterBound { .. }), "{:?}", branch.ends);
        let points: Vec<f64> = branch.of_kind(Kind::UZ).map(|point| point.parameters[0]).collect();
        assert_eq!(points.len(), found, "{from}: {points:?}");
        points.iter().for_each(|mu| close(*mu, 4.0, 1e-12));
    }
}

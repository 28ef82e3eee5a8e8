//! Promise: the algebraic reference problems come out to the digits that are printed, and every
//! event on them can be continued as a curve.

use crate::common::{
    Bratu, Columns, CuspSlice, Oxidation, PredatorPrey, TrivialBranch, close, first, values,
};
use std::f64::consts::PI;
use tangency::core::bifurcation::{At, DefiningSystem};
use tangency::core::continuation::{Branch, Continuation, Direction, End, Event};
use tangency::core::failure::Failure;
use tangency::core::system::{Dense, Kind, System};
use tangency::zero_problem;

#[test]
fn cusp_slice() {
    let mut system = Dense::new(CuspSlice);
    let branch = Continuation::new(&mut system)
        .from(&[-2.0])
        .at("mu", -1.0)
        .along("mu", -1.0..=1.0)
        .trace()
        .unwrap();
    let folds: Vec<_> = branch.of_kind(Kind::LP).collect();
    assert_eq!(folds.len(), 2);
    for (fold, sign) in folds.iter().zip([1.0, -1.0]) {
        close(fold.parameters[0], sign * 2.0 / 3.0, 1e-15);
        close(fold.state[0], -sign, 1e-12);
        assert!(fold.error < 1e-14 && fold.converged);
        // At a fold the branch is vertical.
        close(fold.tangent[1], 0.0, 1e-12);
        let outer = fold.parameters[0].abs();
        assert!(fold.bracket.iter().all(|mu| mu.abs() <= outer && mu.abs() > 0.9 * outer));
    }
    assert_eq!(branch.ends[1], End::ParameterBound { name: "mu".into(), value: 1.0 });
}

/// From the trivial branch over the branch without predators to coexistence, and to its Hopf point.
#[test]
fn predator_prey() {
    let mut system = Dense::new(PredatorPrey);
    let trivial =
        Continuation::new(&mut system).named("trivial").along("p", 0.0..=1.0).trace().unwrap();
    assert_eq!(trivial.of_kind(Kind::BP).count(), 1);
    close(first(&trivial, Kind::BP).parameters[0], 0.6, 1e-14);
    let prey = Continuation::new(&mut system)
        .named("prey")
        .restart(&trivial, first(&trivial, Kind::BP).label)
        .switch()
        .along("p", 0.0..=1.0)
        .trace()
        .unwrap();
    assert_eq!(values(&prey, Kind::LP, "p").len(), 1);
    assert_eq!(values(&prey, Kind::BP, "p").len(), 1, "the start is not found again");
    close(first(&prey, Kind::LP).parameters[0], 0.832929322, 5e-10);
    let branching = first(&prey, Kind::BP);
    close(branching.parameters[0], 0.821904345, 5e-10);
    close(branching.state[0], 1.0 / 3.0, 1e-12);
    let both = Continuation::new(&mut system)
        .named("both")
        .restart(&prey, branching.label)
        .switch()
        .along("p", 0.0..=1.0)
        .trace()
        .unwrap();
    let hopf = first(&both, Kind::HB);
    close(hopf.parameters[0], 0.671593847, 5e-10);
    close(hopf.state[1], 0.3657615360, 5e-11);
}

fn oxidation_branch(system: &mut dyn System) -> Branch {
    Continuation::new(system)
        .from(&[0.001137, 0.891483, 0.062345])
        .at("q2", 2.0)
        .at("k", 0.4)
        .along("q2", 0.5..=2.0)
        .trace()
        .unwrap()
}

/// `a₁a₂ − a₃` of the characteristic polynomial `λ³ + a₁λ² + a₂λ + a₃` of the CO problem, from
/// derivatives written down by hand; it vanishes at a Hopf point.
fn routh_hurwitz(u: &[f64], q2: f64, k: f64) -> f64 {
    let (x, y, s) = (u[0], u[1], u[2]);
    let z = 1.0 - x - y - s;
    let e = 0.0675;
    let j = [
        [-10.0 * z - 4.0 * x - 10.0 * y, -10.0 * z - 10.0 * x, -10.0 * z],
        [-q2 - 10.0 * y, -q2 - 0.1 - 10.0 * x, -q2],
        [-e, -e, -e - e * k],
    ];
    let minor = |a: usize, b: usize| j[a][a] * j[b][b] - j[a][b] * j[b][a];
    let determinant = j[0][0] * minor(1, 2) - j[0][1] * (j[1][0] * j[2][2] - j[1][2] * j[2][0])
        + j[0][2] * (j[1][0] * j[2][1] - j[1][1] * j[2][0]);
    let a1 = -(j[0][0] + j[1][1] + j[2][2]);
    a1 * (minor(0, 1) + minor(0, 2) + minor(1, 2)) + determinant
}

/// Folds and Hopf points at k = 0.4. The reference prints the lower Hopf point as 1.0409915698;
/// evaluated with 40 digits it is 1.04099156953261628…, where a₁a₂ − a₃ does vanish.
#[test]
fn oxidation() {
    let mut system = Dense::new(Oxidation);
    let branch = oxidation_branch(&mut system);
    let folds = values(&branch, Kind::LP, "q2");
    assert_eq!(folds.len(), 2);
    close(folds[0], 1.0420485053785, 1e-13);
    close(folds[1], 1.0522002878700, 1e-13);
    let hopf = values(&branch, Kind::HB, "q2");
    assert_eq!(hopf.len(), 2);
    close(hopf[0], 1.040_991_569_532_616_3, 1e-14);
    close(hopf[1], 1.051_557_462_457_730_4, 1e-14);
    for point in branch.of_kind(Kind::HB) {
        let test = routh_hurwitz(&point.state, point.parameters[0], 0.4);
        let beside = routh_hurwitz(&point.state, point.parameters[0] + 2.7e-10, 0.4);
        assert!(test.abs() < 1e-11 && beside.abs() > 1e-9, "{test:.1e} {beside:.1e}");
    }
}

#[test]
fn oxidation_fold_curve() {
    let mut system = Dense::new(Oxidation);
    let branch = oxidation_branch(&mut system);
    let curve = Continuation::new(&mut system)
        .named("folds")
        .restart(&branch, first(&branch, Kind::LP).label)
        .hold(Kind::LP)
        .along("q2", 0.5..=2.0)
        .along("k", 0.1..=2.0)
        .trace()
        .unwrap();
    assert_eq!(curve.condition, Some(Kind::LP));
    assert_eq!(curve.of_kind(Kind::CP).count(), 1);
    let cusp = first(&curve, Kind::CP);
    close(cusp.parameters[0], 1.0064083296783, 1e-13);
    close(cusp.parameters[1], 0.3559912732087, 1e-13);
    let takens: Vec<_> = curve.of_kind(Kind::BT).collect();
    assert_eq!(takens.len(), 2);
    let (q2, k) = (values(&curve, Kind::BT, "q2"), values(&curve, Kind::BT, "k"));
    close(q2[0], 1.1611987, 5e-8);
    close(k[0], 0.7223391, 5e-8);
    close(q2[1], 1.4176276, 5e-8);
    close(k[1], 0.9713976, 5e-8);
    // Both branches of the curve leave the cusp with the other fold of the slice k = 0.4 among
    // them.
    let again = Continuation::new(&mut system)
        .restart(&curve, cusp.label)
        .hold(Kind::LP)
        .along("q2", 0.5..=2.0)
        .along("k", 0.1..=2.0)
        .mark("k", 0.4)
        .trace()
        .unwrap();
    let folds = values(&again, Kind::UZ, "q2");
    close(folds[0], 1.0420485053785, 1e-13);
    close(folds[1], 1.0522002878700, 1e-13);
}

/// Curves of Hopf points: the Routh–Hurwitz determinant vanishes all along them, and each ends
/// where its frequency vanishes, in a Bogdanov–Takens point of the fold curve.
#[test]
fn oxidation_hopf_curves() {
    let mut system = Dense::new(Oxidation);
    let branch = oxidation_branch(&mut system);
    let mut takens = Vec::new();
    for hopf in branch.of_kind(Kind::HB) {
        let mut continuation = Continuation::new(&mut system)
            .named("Hopf")
            .restart(&branch, hopf.label)
            .hold(Kind::HB)
            .along("q2", 0.5..=2.0)
            .along("k", 0.2..=2.0);
        for k in 3..9 {
            continuation = continuation.mark("k", f64::from(k) * 0.1 + 0.05);
        }
        let curve = continuation.trace().unwrap();
        assert!(curve.of_kind(Kind::UZ).count() > 2);
        for point in curve.of_kind(Kind::UZ) {
            let test = routh_hurwitz(&point.state, point.parameters[0], point.parameters[1]);
            assert!(test.abs() < 1e-11 && point.error < 1e-13, "{test:.1e} {:.1e}", point.error);
        }
        let end = curve.special.last().unwrap();
        assert_eq!(end.kind, Kind::BT);
        assert_eq!(curve.ends[1], End::Event { event: "Bogdanov–Takens point".into() });
        takens.push((end.parameters[0], end.parameters[1]));
    }
    takens.sort_by(|a, b| a.0.total_cmp(&b.0));
    close(takens[0].0, 1.1611987, 5e-8);
    close(takens[0].1, 0.7223391, 5e-8);
    close(takens[1].0, 1.4176276, 5e-8);
    close(takens[1].1, 0.9713976, 5e-8);
}

#[test]
fn bratu() {
    let mut system = Dense::new(Bratu(99));
    let branch = Continuation::new(&mut system)
        .along("lambda", 0.0..=10.0)
        .bound("middle", 0.0..=5.0)
        .trace()
        .unwrap();
    let fold = values(&branch, Kind::LP, "lambda");
    assert_eq!(fold.len(), 1);
    close(fold[0], 3.513647903969, 5e-13);
    assert_eq!(branch.ends[1], End::MonitorBound { name: "middle".into(), value: 5.0 });
    close(branch.points.last().unwrap().monitors[0], 5.0, 1e-11);
    assert_eq!(branch.ends[0], End::ParameterBound { name: "lambda".into(), value: 0.0 });
}

/// Branch points of the trivial branch, and the branch that crosses at the first, traced both ways:
/// with b = 1 it is a pitchfork's mirror image only to leading order, so both halves differ.
#[test]
fn trivial_branch() {
    let n = 29;
    let mut system = Dense::new(TrivialBranch(n));
    let branch = Continuation::new(&mut system).along("a", 0.0..=10.0).trace().unwrap();
    let h = 1.0 / (n as f64 + 1.0);
    let exact = |k: i32| (2.0 / h * (f64::from(k) * PI * h / 2.0).sin()).powi(2) / 10.0;
    let found = values(&branch, Kind::BP, "a");
    assert_eq!(found.len(), 3);
    for (found, k) in found.iter().zip(1..) {
        close(*found, exact(k), 1e-12);
    }
    let crossing = Continuation::new(&mut system)
        .restart(&branch, first(&branch, Kind::BP).label)
        .switch()
        .along("a", 0.0..=10.0)
        .trace()
        .unwrap();
    assert!(crossing.points.len() > 10);
    let start = crossing.points.iter().position(|p| p.parameters[0] == found[0]).unwrap();
    assert!(start > 3 && start + 3 < crossing.points.len(), "both directions: {start}");
    // One half has u > 0, and goes on to where eᵘ is hardly a number any more, the other u < 0.
    let [first, last] = [crossing.special.first(), crossing.special.last()].map(Option::unwrap);
    let ends = [first, last].map(|end| (end.kind, end.state[n / 2]));
    assert!(ends[0].1 > 100.0, "{ends:?}");
    assert!(ends[1].0 == Kind::EP && ends[1].1 < 0.0, "{ends:?}");
}

/// A branch point that symmetry keeps is a curve in two parameters: here `p = 1 + c` or `1 − c`.
#[test]
fn branch_points_of_a_symmetric_problem() {
    let mut system = Dense::new(Columns);
    let trivial =
        Continuation::new(&mut system).at("c", 0.25).along("p", 0.0..=2.0).trace().unwrap();
    let found = values(&trivial, Kind::BP, "p");
    assert_eq!(found.len(), 2);
    close(found[0], 0.75, 1e-14);
    close(found[1], 1.25, 1e-14);
    let curve = Continuation::new(&mut system)
        .restart(&trivial, first(&trivial, Kind::BP).label)
        .hold(Kind::BP)
        .along("p", 0.0..=2.0)
        .along("c", 0.1..=0.9)
        .trace()
        .unwrap();
    assert!(curve.points.len() > 3);
    for point in &curve.points {
        close(point.parameters[0] + point.parameters[1], 1.0, 1e-12);
    }
}

/// `x y = 2`, a condition of a user's own.
struct Product;

impl DefiningSystem for Product {
    fn kind(&self) -> Kind {
        Kind::UZ
    }
    fn values(&mut self, at: At, _y: &[f64], values: &mut [f64]) -> Result<(), Failure> {
        values[0] = at.x[0] * at.x[1] - 2.0;
        Ok(())
    }
    fn gradients(&mut self, at: At, rows: &mut [f64], _own: &mut [f64]) -> Result<(), Failure> {
        rows.fill(0.0);
        rows[0] = at.x[1];
        rows[1] = at.x[0];
        Ok(())
    }
}

zero_problem! {
    /// `x = p`, `y = p q`.
    struct Line [x, y; p, q] {
        0 = p - x;
        0 = p * q - y;
        monitor sum = x + y;
    }
}

/// On the line, `x y = p² q = 2`: found on the branch with q = 1 at p = √2, in one direction or
/// both, and held along `q = 2/p²`.
#[test]
fn a_users_condition_is_found_and_held() {
    let mut system = Dense::new(Line);
    let mut trace = |direction: Direction| {
        Continuation::new(&mut system)
            .from(&[0.5, 0.5])
            .at("p", 0.5)
            .at("q", 1.0)
            .along("p", -3.0..=3.0)
            .event(Event::new("product", || Product).in_direction(direction))
            .trace()
            .unwrap()
    };
    let branch = trace(Direction::Either);
    assert_eq!(values(&branch, Kind::UZ, "p").len(), 2);
    close(values(&branch, Kind::UZ, "p")[0], -2.0_f64.sqrt(), 1e-15);
    close(values(&branch, Kind::UZ, "p")[1], 2.0_f64.sqrt(), 1e-15);
    // p² falls through 2 at −√2 and rises through it at √2, whichever way a half was traced.
    for (direction, expected) in [(Direction::Falling, -1.0), (Direction::Rising, 1.0)] {
        let one = trace(direction);
        let found = values(&one, Kind::UZ, "p");
        assert_eq!(found.len(), 1);
        close(found[0], expected * 2.0_f64.sqrt(), 1e-15);
    }
    let curve = Continuation::new(&mut system)
        .restart(&branch, branch.of_kind(Kind::UZ).last().unwrap().label)
        .hold_condition(|| Product)
        .along("p", 0.5..=3.0)
        .along("q", 0.1..=5.0)
        .mark("sum", 3.0)
        .trace()
        .unwrap();
    for point in &curve.points {
        close(point.parameters[0].powi(2) * point.parameters[1], 2.0, 1e-11);
    }
    // x + 2/x = 3 at x = 1 and 2.
    let marks = values(&curve, Kind::UZ, "p");
    assert_eq!(marks.len(), 2);
    close(marks[0], 1.0, 1e-14);
    close(marks[1], 2.0, 1e-14);
}

#[test]
fn a_terminal_event_ends_the_branch() {
    let mut system = Dense::new(Line);
    let branch = Continuation::new(&mut system)
        .at("q", 1.0)
        .along("p", 0.0..=3.0)
        .event(Event::new("product", || Product).ending())
        .trace()
        .unwrap();
    assert_eq!(branch.ends[1], End::Event { event: "product".into() });
    close(branch.points.last().unwrap().parameters[0], 2.0_f64.sqrt(), 1e-14);
    assert_eq!(branch.special.last().unwrap().kind, Kind::UZ);
    // In both directions, from the middle.
    let both = Continuation::new(&mut system)
        .at("q", 1.0)
        .along("p", -3.0..=3.0)
        .event(Event::new("product", || Product).ending())
        .trace()
        .unwrap();
    let kinds: Vec<_> = both.special.iter().map(|s| (s.kind, s.after)).collect();
    assert_eq!(kinds, [(Kind::UZ, 0), (Kind::UZ, both.points.len() - 1)]);
    close(both.points[0].parameters[0], -2.0_f64.sqrt(), 1e-14);
    // And can be left from there.
    let on = Continuation::new(&mut system)
        .restart(&branch, branch.special.last().unwrap().label)
        .along("p", 0.0..=3.0)
        .event(Event::new("product", || Product).ending())
        .forward()
        .trace()
        .unwrap();
    assert_eq!(on.ends[1], End::ParameterBound { name: "p".into(), value: 3.0 });
}

/// A quartic's cusps are a curve in three parameters: `x⁴ + a x² + b x + c = 0` has
/// `a = −6x²`, `b = 8x³`, `c = −3x⁴`.
#[test]
fn a_curve_of_cusps() {
    zero_problem! {
        struct Swallowtail [x; a, b, c] {
            0 = x.powi(4) + a * x * x + b * x + c;
        }
    }
    let mut system = Dense::new(Swallowtail);
    let curve = Continuation::new(&mut system)
        .from(&[0.5])
        .at("a", -1.5)
        .at("b", 1.0)
        .at("c", -3.0 / 16.0)
        .hold(Kind::LP)
        .hold(Kind::CP)
        .along("a", -3.0..=0.0)
        .along("b", -3.0..=3.0)
        .along("c", -3.0..=0.0)
        .mark("b", 0.125)
        .trace()
        .unwrap();
    let found = first(&curve, Kind::UZ);
    close(found.state[0], 0.25, 1e-12);
    close(found.parameters[0], -6.0 / 16.0, 1e-12);
    close(found.parameters[2], -3.0 / 256.0, 1e-12);
}

/// A pitchfork is left in both directions along its vertical branch, here `x = y = ±√(p − 1 + c)`,
/// whose turning point at the start is a branch point and no fold.
#[test]
fn a_pitchfork_is_switched_at() {
    let mut system = Dense::new(Columns);
    let trivial =
        Continuation::new(&mut system).at("c", 0.25).along("p", 0.0..=1.1).trace().unwrap();
    let branch = Continuation::new(&mut system)
        .restart(&trivial, first(&trivial, Kind::BP).label)
        .switch()
        .along("p", 0.0..=1.1)
        .trace()
        .unwrap();
    assert_eq!(branch.of_kind(Kind::LP).count(), 0);
    let ends: Vec<_> = branch.of_kind(Kind::EP).collect();
    assert_eq!(ends.len(), 2);
    for (end, side) in ends.iter().zip([-1.0, 1.0]) {
        close(end.parameters[0], 1.1, 1e-14);
        close(end.state[0].abs(), 0.35_f64.sqrt(), 1e-10);
        close(end.state[0] * side, ends[1].state[0], 1e-10);
    }
    // Restarted there without switching, the trivial branch goes on.
    let same = Continuation::new(&mut system)
        .restart(&trivial, first(&trivial, Kind::BP).label)
        .along("p", 0.0..=1.1)
        .trace()
        .unwrap();
    assert!(same.points.iter().all(|point| (0.0..=1.1).contains(&point.parameters[0])));
    assert!(same.of_kind(Kind::EP).all(|end| end.state[0].abs() < 1e-9));
}

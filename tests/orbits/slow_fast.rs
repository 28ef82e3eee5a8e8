//! Cycles of slow–fast systems: relaxation oscillations and canard explosions, on the mesh that they
//! need.

use crate::common::{VanDerPol, close};
use crate::orbits::cycles::{collocated, collocation, cycle_of, equilibria};
use tangency::core::attractor::CycleSearch;
use tangency::core::continuation::{Branch, Continuation, End, Settings};
use tangency::core::orbit::{Smooth, from_cycle};
use tangency::core::system::{Kind, System};
use tangency::vector_field;

vector_field! {
    /// FitzHugh and Nagumo's equations with `a = 0.7`, `b = 0.8`, symmetric about `I = 0.875`.
    struct FitzHughNagumo [v, w; I, eps] {
        d/dt v = v - v.powi(3) / 3.0 - w + I;
        d/dt w = eps * (v + 0.7 - w * 0.8);
    }
}

vector_field! {
    /// Hindmarsh and Rose's model of bursting.
    struct HindmarshRose [x, y, z; I] {
        d/dt x = y - x.powi(3) + x * x * 3.0 - z + I;
        d/dt y = T::one() - x * x * 5.0 - y;
        d/dt z = ((x + 1.6) * 4.0 - z) * 0.01;
    }
}

vector_field! {
    /// The Oregonator of Tyson and Fife with `ε = 0.01`, `q = 8·10⁻⁴`.
    struct Oregonator [x, z; f] {
        let q = 8e-4;
        d/dt x = (x * (T::one() - x) - f * z * (x - q) / (x + q)) * 100.0;
        d/dt z = x - z;
    }
}

/// Bursts of two spikes begin where cycles of one spike double their period: the family ends there,
/// though both halves of the orbit differ by the error of the mesh, and does not go back.
#[test]
fn bursts_end_where_spikes_double_their_period() {
    let rest = equilibria(HindmarshRose, &[-1.6, -12.0, 0.0], &[0.0], [0.0, 4.0]);
    let hopf = rest.of_kind(Kind::HB).next().expect("a Hopf point").label;
    let branch = Continuation::new(&mut collocated(HindmarshRose, 20))
        .restart(&rest, hopf)
        .along("I", 0.0..=4.0)
        .trace()
        .unwrap();
    let end = &branch.ends[1];
    assert!(matches!(end, End::Event { event } if event.contains("half the period")), "{end:?}");
    let last = branch.special.last().unwrap();
    assert!(last.kind == Kind::PD && last.converged);
    // The same from 80 intervals.
    close(last.parameters[0], 3.544_438_583_33, 1e-9);
}

/// The cycles of FitzHugh and Nagumo's equations from one of both Hopf points.
fn canards(eps: f64, upper: bool, intervals: usize, settings: Settings) -> Branch {
    let (guess, start) = if upper { ([1.2, 2.4], 2.0) } else { ([-1.2, -0.6], 0.0) };
    let rest = equilibria(FitzHughNagumo, &guess, &[start, eps], [0.0, 2.0]);
    let mut hopf: Vec<_> = rest.of_kind(Kind::HB).collect();
    hopf.sort_by(|a, b| a.parameters[0].total_cmp(&b.parameters[0]));
    assert_eq!(hopf.len(), 2);
    let hopf = hopf[usize::from(upper)].label;
    Continuation::new(&mut collocated(FitzHughNagumo, intervals))
        .restart(&rest, hopf)
        .along("I", 0.0..=2.0)
        .settings(settings)
        .trace()
        .unwrap()
}

/// `∮ tr f_x dt` of a saved cycle, whose sign is that of the logarithm of its multiplier, by Simpson's
/// rule on 4000 intervals, independent of the library's.
fn log_multiplier(branch: &Branch, label: usize) -> f64 {
    let special = branch.special.iter().find(|special| special.label == label).unwrap();
    let (solution, period) = (branch.solution(special), special.monitors[0]);
    let mut system = collocated(FitzHughNagumo, 1);
    let start = [&system.resume_from(&solution).unwrap().z[..], &solution.parameters].concat();
    let trace = |tau: f64| {
        let x = system.states(&start, 0, tau).unwrap();
        1.0 - x[0] * x[0] - 0.8 * solution.parameters[1]
    };
    let count = 4000;
    let weight = |k: usize| if k == 0 || k == count { 1.0 } else { 2.0 + 2.0 * (k % 2) as f64 };
    let sum: f64 = (0..=count).map(|k| weight(k) * trace(k as f64 / count as f64)).sum();
    period * sum / (3 * count) as f64
}

/// The families go from one Hopf point through both canard explosions to the other one, on any mesh
/// and with any step; what folds are found are at the true ones, and the stability of each cycle is
/// the one of Liouville's formula, or unknown.
#[test]
fn canard_families_are_complete() {
    let kept = || Settings { save_every: 1, ..Settings::default() };
    // The first fold by multiple shooting; all are the same from both ends on 150 and 300 intervals.
    for (eps, fold, upper, intervals, max_step) in [
        (0.08, 1.4258214775, false, 20, 0.1),
        (0.08, 1.4258214775, true, 20, 0.1),
        (0.08, 1.4258214775, false, 80, 0.1),
        (0.08, 1.4258214775, true, 20, 0.03),
        (0.05, 1.43802018165, false, 20, 0.1),
        (0.05, 1.43802018165, true, 150, 0.1),
        (0.02, 1.45020878771, true, 20, 0.1),
        // A mesh that loses half of its intervals has an error of 6e-3, from which no step leads on.
        (0.01, 1.45427098989, false, 20, 0.1),
        // Some 1900 points: a jump moves by no more than its thickness in a step.
        (0.005, 1.45630212769, true, 20, 0.1),
    ] {
        let settings = Settings { max_step, initial_step: max_step.min(0.02), ..kept() };
        let branch = canards(eps, upper, intervals, settings);
        let place = format!("{eps} {upper} {intervals} {max_step}: {:?}", branch.ends);
        assert!(
            matches!(&branch.ends[1], End::Event { event } if event.contains("Hopf")),
            "{place}"
        );
        let folds = branch.of_kind(Kind::LP).count();
        assert!(if intervals == 150 { folds == 2 } else { folds <= 2 }, "{place}: {folds}");
        for special in &branch.special {
            match special.kind {
                Kind::EP | Kind::HB => {}
                Kind::LP => {
                    let distance = (special.parameters[0] - 0.875).abs() - (fold - 0.875);
                    let least = if intervals == 150 { 1e-10 } else { 1e-8 };
                    // A fold that is not found on its defining system is one of the mesh.
                    let most = if special.converged { special.error } else { 1e-4 };
                    let most = if intervals == 150 { least } else { most.max(least) };
                    assert!(distance.abs() <= most, "{place}: {distance:e}");
                }
                Kind::RG => {
                    let Some(unstable) = special.unstable else { continue };
                    let log = log_multiplier(&branch, special.label);
                    let told = (log > 0.0) == (unstable > 0);
                    assert!(told || log.abs() < 1e-3, "{place}: {log} {unstable}");
                }
                kind => panic!("{place}: {kind} {:?}", special.parameters),
            }
        }
    }
}

/// The family of the Oregonator that begins at its upper Hopf point passes its canard explosion, in
/// 700 points, to relaxation oscillations; the cycles are stable there, and nothing bifurcates.
#[test]
fn the_oregonator_passes_its_upper_canard_explosion() {
    let rest = equilibria(Oregonator, &[0.8, 0.8], &[0.2], [0.2, 3.0]);
    let hopf = rest.of_kind(Kind::HB).last().expect("two Hopf points").label;
    let branch = Continuation::new(&mut collocated(Oregonator, 20))
        .restart(&rest, hopf)
        .along("f", 0.2..=3.0)
        .settings(Settings { max_points: 700, ..Settings::default() })
        .trace()
        .unwrap();
    assert_eq!(branch.ends[1], End::PointLimit { points: 700 });
    assert!(branch.special.iter().all(|it| it.kind == Kind::EP), "{:?}", branch.special);
    let last = branch.points.last().unwrap();
    assert!(last.parameters[0] < 2.37 && last.unstable == Some(0), "{last:?}");
}

/// A cycle whose jumps take a thousandth of its period begins on a mesh that is distributed for the
/// simulated orbit. Dorodnitsyn's series gives the period 52.5 at `μ = 30` to a part in a hundred.
#[test]
fn relaxation_cycles_begin_on_a_mesh_of_their_own() {
    let cycle = cycle_of(VanDerPol, CycleSearch::default(), &[1.0, 0.0], &[30.0]).unwrap();
    let start = from_cycle(Smooth(VanDerPol), &cycle, &[30.0], collocation(4), 20);
    let (mut system, z) = start.unwrap();
    assert!(system.mesh_error(&[&z[..], &[30.0]].concat()) < 0.1);
    let branch = Continuation::new(&mut system)
        .from(&z)
        .at("mu", 30.0)
        .along("mu", 0.1..=60.0)
        .settings(Settings { save_every: 1, ..Settings::default() })
        .trace()
        .unwrap();
    assert!(branch.special.iter().all(|it| matches!(it.kind, Kind::EP | Kind::RG)));
    let period = branch.points.iter().find(|it| it.parameters[0] == 30.0).unwrap().monitors[0];
    let mu = 30.0_f64;
    let series = (3.0 - 4.0_f64.ln()) * mu + 7.014_32 * mu.powf(-1.0 / 3.0)
        - (2.0 / 3.0) * mu.ln() / mu
        - 1.3246 / mu;
    close(period, series, 1e-2);
}

/// A start on a mesh that is far too coarse gets the intervals that it needs, and the branch goes on
/// to `μ = 20`, and back.
#[test]
fn relaxation_cycles_get_the_mesh_that_they_need() {
    let cycle = cycle_of(VanDerPol, CycleSearch::default(), &[1.0, 0.0], &[5.0]).unwrap();
    let (mut system, z) =
        from_cycle(Smooth(VanDerPol), &cycle, &[5.0], collocation(4), 20).unwrap();
    let limit = Settings::default().target_mesh_error;
    assert!(system.mesh_error(&[&z[..], &[5.0]].concat()) > limit);
    let branch = Continuation::new(&mut system)
        .from(&z)
        .at("mu", 5.0)
        .along("mu", 0.1..=20.0)
        .settings(Settings { save_every: 1, ..Settings::default() })
        .trace()
        .unwrap();
    let reached = |end: &End| matches!(end, End::ParameterBound { .. });
    assert!(branch.ends.iter().all(reached), "{:?}", branch.ends);
    let start = branch.points.iter().find(|point| point.parameters[0] == 5.0).unwrap();
    close(start.monitors[0], 11.612230667, 1e-6);
    let column = branch.monitors.iter().position(|name| name == "mesh_error").unwrap();
    let most = branch.points.iter().map(|point| point.monitors[column]).fold(0.0, f64::max);
    assert!(most < 10.0 * limit, "{most:e}");
    assert!(branch.points.iter().all(|point| point.unstable == Some(0)));
    let intervals: Vec<usize> = branch.special.iter().map(|point| point.mesh.len() - 1).collect();
    assert!(intervals.iter().all(|count| (20..200).contains(count)), "{intervals:?}");
}

//! Diagrams of computing time against the numbers of unknowns, mesh intervals, shooting segments,
//! parameters and threads.

use super::differences::{Differences, IMPACTING};
use super::period::Period;
use super::plan::{Answer, Method, Plan};
use super::plates::{PLATE, PULL_IN};
use super::scenes::{Counted, GRAZING, PASSING, number_of, scene, tracing};
use crate::{Clock, Drawn};
use nalgebra::SVector;
use num_dual::Dual64;
use std::array;
use std::num::NonZeroUsize;
use tangency::core::failure::one_line;
use tangency::core::hybrid::{EventNumber, GuardOf};
use tangency::core::problem::Watchable;
use tangency::core::scalar::DualChunk;
use tangency::core::sweep::Part;
use tangency::scene::sweep;

/// A scene of attractors of Mita's actuator beyond grazing: periodic orbits and chaos.
const SWEEP: &str = r#"Scene(
    title: "Beyond grazing",
    problem: Mita(),
    parameters: [("frequency", 0.5)],
    sweeps: [(
        name: "voltages",
        over: [(name: "voltage", low: 0.55, high: 0.85, count: 32)],
        search: (transient: 200, lyapunov_periods: 400),
    )],
)"#;

/// Plans the diagram of computing time against the number of unknowns of a plate.
fn unknowns() -> Plan {
    let plate = |line: &str, order: usize| {
        let in_plane = order + 2;
        let orders =
            format!("(transverse: ({order}, {order}), in_plane: ({in_plane}, {in_plane}))");
        let setting = format!("{order} and {in_plane}");
        let settings = [
            ("supports", "CCCC"),
            ("in_plane", "immovable"),
            ("gap_ratio", "1"),
            ("orders", &*orders),
        ];
        tracing((line, setting), PLATE, &settings, PULL_IN, Counted::Unknowns)
    };
    let methods = [3, 4, 6, 8, 10].map(|order| plate("full model", order));
    let plan = Plan::of("A clamped plate, for each order", plate("the full model", 13));
    plan.counting("unknowns").relative().drawing(Drawn::TimeAgainstWork).with(methods)
}

/// Plans the diagram of computing time against the number of mesh intervals for collocation, and
/// against the number of segments for shooting.
fn pieces() -> Plan {
    let orbits = |line: String, pieces: usize, settings: &[(&str, &str)]| {
        let count = pieces.to_string();
        let [piece, name] =
            if line == "shooting" { ["segment", "segments"] } else { ["interval", "intervals"] };
        let settings = [settings, &[(name, count.as_str())]].concat();
        let setting = number_of(pieces, piece);
        tracing((line.as_str(), setting), PASSING, &settings, GRAZING, Counted::Unknowns)
    };
    let mut methods = Vec::new();
    for degree in ["3", "5", "7"] {
        for intervals in [10, 20, 40, 80, 160] {
            let settings = [("method", "collocation"), ("degree", degree)];
            methods.push(orbits(format!("collocation, {degree} points"), intervals, &settings));
        }
    }
    let shooting = |segments| orbits("shooting".into(), segments, &[]);
    methods.extend([1, 2, 4, 8, 16, 32].map(shooting));
    let reference = orbits("shooting".into(), 1, &[("flow_tolerance", "1e-14")]);
    let plan = Plan::of("Orbits, for each number of intervals and segments", reference)
        .counting("unknowns");
    plan.drawing(Drawn::TimeAgainstWork).with(methods)
}

/// Differentiates the period map with an impact with respect to its first `count` parameters, by
/// dual numbers with `W` parameters in each pass.
fn duals<const W: usize>(count: usize, x: [f64; 2], tolerance: f64) -> Result<Vec<f64>, String>
where
    DualChunk<f64, W>: EventNumber,
    GuardOf<'static>: Watchable<DualChunk<f64, W>>,
{
    let (mut numbers, period) = (Vec::new(), Period { tolerance, ..IMPACTING });
    for first in (0..count).step_by(W) {
        let p = array::from_fn(|k| DualChunk::<f64, W>::seeded(period.p[k], k.wrapping_sub(first)));
        let image = period.at(p).image(x.map(DualChunk::from))?;
        let [x, u] = [image[0].eps, image[1].eps];
        let all = x.into_iter().zip(u).take(count - first);
        numbers.extend(all.flat_map(|(x, u)| [x, u]));
    }
    Ok(numbers)
}

/// Computes the derivative of the period map with respect to its first `count` parameters, by dual
/// numbers with one pass for each parameter.
fn one_by_one(count: usize, x: [f64; 2], tolerance: f64) -> Result<Vec<f64>, String> {
    let (mut numbers, period) = (Vec::new(), Period { tolerance, ..IMPACTING });
    for parameter in 0..count {
        let mut p = period.p.map(Dual64::from);
        p[parameter] = p[parameter].derivative();
        let image = period.at(p).image(x.map(Dual64::from))?;
        numbers.extend([image[0].eps, image[1].eps]);
    }
    Ok(numbers)
}

/// Computes the derivative of the period map with respect to its first `N` parameters, by one-sided
/// finite differences.
fn differences<const N: usize>(x: [f64; 2]) -> Result<Vec<f64>, String> {
    let image = |first: SVector<f64, N>| {
        let mut p = IMPACTING.p;
        p[..N].copy_from_slice(first.as_slice());
        IMPACTING.at(p).image(x)
    };
    let here = SVector::from_fn(|k, _| IMPACTING.p[k]);
    Ok(Differences::OneSided(1e-7).matrix(image, here)?.as_slice().to_vec())
}

/// Plans the diagram of computing time against the number of parameters of a derivative.
fn parameters() -> Plan {
    let x = IMPACTING.settled();
    let tolerance = IMPACTING.tolerance;
    let method = |line: &str, count: usize, find: fn(usize, [f64; 2], f64) -> _| {
        let x = x.clone();
        Method::new(line, number_of(count, "parameter"), move || {
            Ok(Answer { numbers: find(count, x.clone()?, tolerance)?, work: count as f64 })
        })
    };
    type Find = fn(usize, [f64; 2], f64) -> Result<Vec<f64>, String>;
    let sizes: [(usize, Find, Find); 4] = [
        (1, one_by_one, |_, x, _| differences::<1>(x)),
        (2, duals::<4>, |_, x, _| differences::<2>(x)),
        (4, duals::<4>, |_, x, _| differences::<4>(x)),
        (8, duals::<8>, |_, x, _| differences::<8>(x)),
    ];
    let at = x.clone();
    let exact = Method::new("dual numbers", "at a tolerance of 1e-15", move || {
        Ok(Answer { numbers: duals::<8>(8, at.clone()?, 1e-15)?, work: 0.0 })
    });
    let mut plan =
        Plan::of("Derivatives of a period with an impact, for each number of parameters", exact)
            .counting("parameters")
            .drawing(Drawn::TimeAgainstWork);
    for (count, together, differences) in sizes {
        plan = plan.with([
            method("dual numbers, all parameters in one pass", count, together),
            method("dual numbers, one parameter per pass", count, one_by_one),
            method("one-sided differences, step 1e-7", count, differences),
        ]);
    }
    plan
}

/// Plans the diagram of computing time against the number of threads.
fn threads() -> Plan {
    let scene = scene(SWEEP, &[]);
    let method = |threads: NonZeroUsize| {
        let setting = number_of(threads.get(), "thread");
        let (scene, part) = (scene.clone(), Part { threads: Some(threads), ..Part::WHOLE });
        Method::new("a sweep over 32 voltages", setting, move || {
            let swept = sweep(scene.as_ref()?, "threads", part, None, &mut ());
            let swept = swept.map_err(|cause| one_line(&cause))?;
            let rows = swept.sweeps.iter().flat_map(|table| table.rows.values());
            // Columns that do not apply to a motion are NaN.
            let numbers = rows.flat_map(|row| &row.values).filter(|value| value.is_finite());
            let numbers = numbers.copied().collect();
            Ok(Answer { numbers, work: threads.get() as f64 })
        })
    };
    let counts = [1, 2, 4].into_iter().filter_map(NonZeroUsize::new);
    let plan = Plan::of("A sweep, for each number of threads", method(NonZeroUsize::MIN))
        .counting("threads");
    plan.by(Clock::Wall).drawing(Drawn::TimeAgainstWork).with(counts.map(method))
}

/// Plans the four diagrams of computing time: for plates, orbits, derivatives and sweeps.
pub(super) fn plans() -> Vec<Plan> {
    vec![unknowns(), pieces(), parameters(), threads()]
}

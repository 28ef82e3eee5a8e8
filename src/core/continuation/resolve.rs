//! Preparation of a specified curve: resolves names, loads the saved solution at its start, and
//! collects its events.

use super::admissible::{self, AT_LIMIT, divided};
use super::beside::{amplitude, beside, released_in};
use super::bounds::Bound;
use super::builder::Continuation;
use super::error::TraceError;
use super::event::{Event, MakeCondition};
use super::homoclinic_end::is_near;
use super::quantities::Quantities;
use super::settings::Settings;
use crate::core::bifurcation::catalogue;
use crate::core::bifurcation::catalogue::CATALOGUE;
use crate::core::bifurcation::{Hopf, Needs, is_possible};
use crate::core::failure::{Failure, one_line};
use crate::core::problem::{Dynamics, Names, position};
use crate::core::system::{
    Discretised, Effort, Emanating, HOMOCLINIC_RADIUS, HOMOCLINIC_RATES, Kind, Site, Solution,
    Start, SystemRef,
};
use std::sync::Arc;

/// The error message for a curve of homoclinic orbits that does not start at a suitable cycle.
const NO_CYCLE: &str = "a branch of homoclinic orbits starts from a cycle near a homoclinic orbit, \
                        such as the last cycle of a branch of cycles";

/// The specification of a curve, with names replaced by indices of parameters and monitors.
pub(super) struct Resolved {
    /// The indices of the released parameters among all parameters.
    pub released: Vec<usize>,
    pub held: Vec<MakeCondition>,
    pub events: Vec<Event>,
    /// The bounds of parameters and monitors, which come first in `events`.
    pub bounds: Vec<Bound>,
    /// The user-defined scales: the scales of the groups of unknowns, followed by the scales of the
    /// released parameters.
    pub scales: Vec<Option<f64>>,
    /// The indices of the parameters and monitors whose values must converge on finer
    /// discretisations at special points.
    pub settled: Vec<usize>,
}

/// Resolves the names in the specification of a curve, and loads the saved solution at its start.
pub(super) fn resolve(curve: &mut Continuation) -> Result<(Resolved, Start), TraceError> {
    Quantities::new(curve.system.names(), &curve.attached).check()?;
    if let Some(system) = curve.system.discretised() {
        let cancel = &curve.settings.cancel;
        system.set_effort(Effort { error: 0.0, exact_gradients: false, cancel });
    }
    let branch = curve.name.clone();
    let not_started = |cause: Failure| {
        let (branch, place) = (branch.clone(), "the point to restart from".into());
        TraceError::Start { branch, place, cause: Box::new(cause.into()) }
    };
    let start = take_over(curve).map_err(not_started)?;
    // The curve may consist of solutions of another system.
    Quantities::new(curve.system.names(), &curve.attached).check()?;
    let released = released(curve)?;
    let multipliers = curve.system.traits(&curve.x).smooth_multipliers;
    let limits = limits(curve).map_err(not_started)?;
    check_held(&curve.held, curve.system.dynamics())?;
    check_kind(&curve.held, curve.origin.as_ref())?;
    let quantities = Quantities::new(curve.system.names(), &curve.attached);
    let dynamics = curve.system.dynamics();
    let of = (&curve.held[..], curve.origin.as_ref());
    let held = held(of, &quantities, (released[0], dynamics), &limits)?;
    let (events, bounds) = gather(curve, &quantities, limits, (released[0], multipliers))?;
    let own = held.iter().map(|make| make().unknowns()).sum();
    events.iter().try_for_each(|event| quantities.check_event(event, own))?;
    let settled = curve.settings.refine.iter().map(|name| quantities.column(name));
    let settled = settled.collect::<Result<_, _>>()?;
    let parameters = &curve.system.names().parameters;
    for (name, _) in &curve.settings.tolerances {
        position("parameter", name, parameters)?;
    }
    let scales = scales(curve, &released)?;
    Ok((Resolved { released, held, events, bounds, scales, settled }, start))
}

/// Passes the saved solution at the start of a curve to the system; the system may adopt the mesh
/// of the solution.
fn take_over(curve: &mut Continuation) -> Result<Start, Failure> {
    let switched = curve.switch.is_some();
    let n = curve.system.names().dimension();
    let Some(mut solution) = curve.origin.clone() else {
        let site = if switched { Site::BranchPoint } else { Site::Point };
        return Ok(Start { site, ..Start::point(curve.x[..n].to_vec(), None) });
    };
    solution.parameters = curve.x[n..].to_vec();
    solution.switch = curve.switch;
    let shift = curve.origin.as_mut().and_then(|origin| origin.mesh_shift.take());
    if curve.held.iter().any(|(kind, make)| *kind == Kind::HOM && make.is_none()) {
        return homoclinic(curve, solution);
    }
    solution.beside = amplitude(curve, &solution);
    let start = curve.system.resume_from(&solution)?;
    curve.x = [&start.z[..], &solution.parameters].concat();
    if start.site == Site::Beside {
        let frequency = start.angle;
        curve.origin = Some(Solution { frequency, ..solution });
        return Ok(start);
    }
    if let Some(start) = beside(curve, &solution, &start)? {
        return Ok(start);
    }
    if let (AT_LIMIT, Some(which)) = (solution.kind, solution.switch)
        && let Some(emanating) = admissible::emanating(&mut *curve.system, &curve.x, which)?
    {
        let Emanating { system, z, along } = emanating;
        curve.x = [&z[..], &solution.parameters].concat();
        curve.system = SystemRef::Owned(system);
        return Ok(Start { site: Site::Limit, ..Start::point(z, along) });
    }
    if start.site == Site::OtherBranch {
        return Ok(Start { site: Site::Point, ..start });
    }
    let (kind, of_solutions) = (solution.kind, solution.condition.is_none());
    let at_point = start.site == Site::Point;
    // If several folds coincide, branches cross as well.
    let several_folds = kind == Kind::LP && solution.multiplicity > 1;
    if switched && at_point && kind != Kind::BP && !several_folds {
        return Err(Failure::Mismatch(format!(
            "the start is a {}, but branches can be switched only at branch points (BP), where \
             branches cross",
            kind.meaning()
        )));
    }
    let crosses = switched || kind == Kind::BP && of_solutions && curve.held.is_empty();
    let site = if at_point && crosses { Site::BranchPoint } else { start.site };
    let start = Start { site, ..start };
    if let Some(shift) = shift.filter(|_| stays_on_mesh(&start, kind)) {
        let parameters = &mut curve.x[start.z.len()..];
        parameters.iter_mut().zip(&shift).for_each(|(p, shift)| *p += shift);
        curve.origin.iter_mut().for_each(|origin| origin.mesh_shift = Some(shift.clone()));
    }
    Ok(start)
}

/// Whether a branch starts at a branch point on the mesh of the saved solution. If a branch starts
/// at a branch point on the mesh of the saved solution, the parameters are set to their unrefined
/// values on this mesh. The refined values differ from the branch point on this mesh by the
/// discretisation error, so that the emanating branch would not be found at the refined values. For
/// a start on another mesh, or on an orbit with other events, no unrefined values exist.
fn stays_on_mesh(start: &Start, kind: Kind) -> bool {
    let is_crossing = start.site == Site::BranchPoint && start.direction.is_some();
    is_crossing && matches!(kind, Kind::BP | Kind::PD)
}

/// Returns the start of a curve of homoclinic orbits. The start is a saved homoclinic orbit, or a
/// homoclinic orbit near a cycle or near a Bogdanov–Takens point. If the start is near a
/// Bogdanov–Takens point, the curve is continued in the direction away from that point.
fn homoclinic(curve: &mut Continuation, mut solution: Solution) -> Result<Start, Failure> {
    let released = released_in(curve.system.names(), &curve.released);
    let system = curve.system.discretised();
    let system = system.ok_or_else(|| Failure::Unsupported(NO_CYCLE.into()))?;
    let mut away = None;
    let emanating = if solution.kind == Kind::BT && solution.mesh.is_empty() {
        let (emanating, parameters) =
            from_takens((system, &solution), (&released, &curve.released), &curve.settings)?;
        let both = parameters.iter().zip(&solution.parameters);
        away = Some(both.map(|(there, here)| there - here).collect::<Vec<f64>>());
        solution.parameters = parameters;
        emanating
    } else {
        system.homoclinic(&solution, HOMOCLINIC_RADIUS)?
    };
    let Emanating { system, z, .. } = emanating;
    check_columns(system.names())?;
    curve.x = [&z[..], &solution.parameters].concat();
    curve.system = SystemRef::Owned(system);
    let Some(away) = away else { return Ok(Start::point(z, None)) };
    let direction = [vec![0.0; z.len()], away].concat();
    let (site, one_sided) = (Site::Beside, true);
    Ok(Start { site, one_sided, ..Start::point(z, Some(direction)) })
}

/// Heuristic: the sizes of homoclinic orbits that are tried near a Bogdanov–Takens point, in units
/// of the first size. Larger orbits deviate more from the normal form; smaller orbits are dominated
/// by rounding.
const LOOPS: [f64; 7] = [1.0, 0.25, 4.0, 0.0625, 16.0, 0.015625, 0.00390625];

/// Returns a homoclinic orbit near a Bogdanov–Takens point, and its parameters. Several sizes of
/// the orbit are tried. The first size is used for which the parameters lie within the ranges of
/// the released parameters and Newton's method converges to a homoclinic orbit. If no size
/// succeeds, the error for the first size with parameters within the ranges is returned.
fn from_takens(
    (system, point): (&dyn Discretised, &Solution),
    (released, ranges): (&[usize], &[(String, [f64; 2])]),
    settings: &Settings,
) -> Result<(Emanating, Vec<f64>), Failure> {
    let mut first = None;
    for factor in LOOPS {
        let cycle = system.beside_takens(point, (released, [settings.initial_step, factor]))?;
        let p = &cycle.parameters;
        let within = |(at, (_, [low, high])): (&usize, &(String, [f64; 2]))| {
            (*low..=*high).contains(&p[*at])
        };
        if !released.iter().zip(ranges).all(within) {
            continue;
        }
        let ways = released.iter().zip(ranges).map(|(&at, (_, range))| {
            let way = (p[at] - point.parameters[at]).abs();
            (at, way, *range)
        });
        let part = |(_, way, [low, high]): &(usize, f64, [f64; 2])| way / (high - low);
        let Some(longest) = ways.max_by(|a, b| part(a).total_cmp(&part(b))) else { continue };
        let found = system.homoclinic(&cycle, HOMOCLINIC_RADIUS).and_then(|mut emanating| {
            let near = is_near(&mut emanating, p, longest, settings);
            near.map(|()| emanating).map_err(|cause| Failure::Mismatch(one_line(&cause)))
        });
        match found {
            Ok(emanating) => return Ok((emanating, cycle.parameters)),
            Err(cause) => _ = first.get_or_insert(cause),
        }
    }
    Err(first.unwrap_or_else(|| {
        Failure::Mismatch(
            "the homoclinic orbits near the start point are outside the ranges of the parameters: \
             widen the ranges, or lower `initial_step`"
                .into(),
        )
    }))
}

/// Returns an error if a parameter has the same name as a column of homoclinic orbits.
fn check_columns(names: &Names) -> Result<(), Failure> {
    match names.parameters.iter().find(|name| names.monitors.contains(name)) {
        Some(name) => Err(Failure::Mismatch(format!(
            "the parameter `{name}` has the same name as a column of homoclinic orbits: rename the \
             parameter"
        ))),
        None => Ok(()),
    }
}

/// Returns the indices of the released parameters among all parameters, after checking their
/// values.
fn released(curve: &mut Continuation) -> Result<Vec<usize>, TraceError> {
    let needed = 1 + curve.held.len();
    if curve.released.len() != needed {
        return Err(TraceError::Released { released: curve.released.len(), needed });
    }
    let names = curve.system.names();
    let mut released = Vec::new();
    for (name, [low, high]) in &curve.released {
        let p = position("parameter", name, &names.parameters)?;
        let value = &mut curve.x[names.dimension() + p];
        // A point saved at a bound may be beyond it by rounding after it is read.
        let inside = value.clamp(*low, *high);
        let is_inside = (inside - *value).abs() <= 1e-12 * inside.abs().max(1.0);
        if !is_inside {
            let (name, value, low, high) = (name.clone(), *value, *low, *high);
            return Err(TraceError::OutOfRange { name, value, low, high });
        }
        *value = inside;
        if released.contains(&p) {
            return Err(TraceError::Twice(name.clone()));
        }
        released.push(p);
    }
    Ok(released)
}

/// The limits of admissible solutions along a curve, given by the indices of the monitors that
/// vanish at these limits.
struct Limits {
    /// The monitors that vanish at all points of the curve; the first of these monitors is held at
    /// zero.
    vanishing: Vec<usize>,
    /// The monitors that may vanish at single points of the curve.
    others: Vec<usize>,
    /// Whether the solutions have an order of events that must be checked.
    ordered: bool,
}

/// Returns the limits of admissible solutions along a curve. On a curve of solutions that all lie
/// at a limit of admissible solutions, the order of the events is not checked, because rounding
/// errors determine the order.
fn limits(curve: &mut Continuation) -> Result<Limits, Failure> {
    let at_limit = curve.held.iter().any(|(kind, make)| *kind == AT_LIMIT && make.is_none());
    let system = &mut *curve.system;
    let (vanishing, others) = match at_limit {
        true => divided(system, &curve.x)?,
        false => {
            let n = system.names().dimension();
            let limits = admissible::limits(system, &curve.x[n..]);
            (Vec::new(), limits.iter().map(|limit| limit.monitor).collect())
        }
    };
    let ordered = vanishing.is_empty() && !system.representation().itinerary.is_empty();
    Ok(Limits { vanishing, others, ordered })
}

/// Returns an error if special points of a held kind do not occur for the problem, or if this kind
/// can be held only together with another kind.
fn check_held(
    held: &[(Kind, Option<MakeCondition>)],
    dynamics: Dynamics,
) -> Result<(), TraceError> {
    let kinds: Vec<Kind> = held.iter().map(|(kind, _)| *kind).collect();
    let known = held.iter().filter(|(_, make)| make.is_none());
    let mut rows = known.filter_map(|(kind, _)| catalogue::row_of(*kind));
    let refused = rows.find_map(|row| Some((row.kind, row.why_not_held(dynamics, &kinds)?)));
    match refused {
        Some((kind, reason)) => Err(TraceError::NotOfProblem { kind, reason }),
        None => Ok(()),
    }
}

/// The kinds of special points of codimension one that do not coincide on a branch of solutions.
const DISTINCT: [Kind; 6] = [Kind::LP, Kind::BP, Kind::HB, Kind::PD, Kind::TR, Kind::G];

/// Returns an error if a curve of special points of one kind starts at a special point of another kind
/// of codimension one: Newton's method might converge to a different curve.
fn check_kind(
    held: &[(Kind, Option<MakeCondition>)],
    origin: Option<&Solution>,
) -> Result<(), TraceError> {
    let ([(kind, None)], Some(origin)) = (held, origin) else { return Ok(()) };
    let differs =
        *kind != origin.kind && [*kind, origin.kind].iter().all(|it| DISTINCT.contains(it));
    match differs && origin.condition.is_none() {
        true => Err(TraceError::OtherKind { held: *kind, start: origin.kind }),
        false => Ok(()),
    }
}

/// Returns the constructors of the held defining systems; the first of the vanishing monitors is
/// held at zero.
fn held(
    (held, origin): (&[(Kind, Option<MakeCondition>)], Option<&Solution>),
    quantities: &Quantities,
    (parameter, dynamics): (usize, Dynamics),
    limits: &Limits,
) -> Result<Vec<MakeCondition>, TraceError> {
    let kinds: Vec<Kind> = held.iter().map(|(kind, _)| *kind).collect();
    // If two pairs are critical, the curve follows the other pair; near a point of equilibria, the
    // multipliers with the angle of the start.
    let is_known = |origin: &&Solution| {
        [Kind::HH, Kind::NSNS].contains(&origin.kind) || origin.beside.is_some()
    };
    let other = origin.filter(is_known).and_then(|origin| origin.frequency);
    let make = |(kind, make): &(Kind, Option<MakeCondition>)| {
        let known = || match (*kind, other) {
            (AT_LIMIT, _) => quantities.limit(*limits.vanishing.first()?).condition,
            (Kind::HOM, _) => quantities.homoclinic()?.condition,
            (Kind::HB | Kind::TR, Some(frequency)) => {
                let periodic = dynamics == Dynamics::Periodic;
                let make: MakeCondition =
                    Arc::new(move || Box::new(Hopf::near(frequency, periodic)));
                Some(make)
            }
            (kind, _) => {
                let make = catalogue::row_of(kind)?.on(dynamics, &kinds)?.defined_by?;
                let make: MakeCondition = Arc::new(move || make(parameter));
                Some(make)
            }
        };
        let unknown = || match *kind {
            AT_LIMIT if !limits.others.is_empty() => TraceError::NotAtLimit(AT_LIMIT),
            kind => TraceError::NotHeld(kind),
        };
        make.clone().or_else(known).ok_or_else(unknown)
    };
    held.iter().map(make).collect()
}

/// Collects the events of a curve. The bounds come first, so that a branch ends at a bound before
/// events beyond it are reported.
fn gather(
    curve: &Continuation,
    quantities: &Quantities,
    limits: Limits,
    of: (usize, Option<usize>),
) -> Result<(Vec<Event>, Vec<Bound>), TraceError> {
    let (mut events, mut bounds) = (Vec::new(), Vec::new());
    let at_limits: Vec<Event> = limits.others.iter().map(|m| quantities.limit(*m)).collect();
    for (name, range) in curve.released.iter().chain(&curve.bounds) {
        for column in quantities.showing(name) {
            let quantity = quantities.find(&column)?;
            for (level, side) in range.iter().zip([-1.0, 1.0]) {
                if level.is_finite() {
                    events.push(quantities.event(Kind::EP, &column, (quantity, *level)).ending());
                    bounds.push(Bound { side, range: *range });
                }
            }
        }
    }
    if !curve.beyond {
        let bound = |_| Bound { side: -1.0, range: [0.0, f64::INFINITY] };
        bounds.extend(at_limits.iter().map(bound));
        events.extend(at_limits.iter().cloned().map(Event::ending));
    }
    let of_homoclinic_orbits = curve.held.iter().any(|(kind, _)| *kind == Kind::HOM);
    if of_homoclinic_orbits {
        // Beyond these bounds the equilibrium is not a saddle, and the solutions are spurious.
        let ranges = [[0.0, f64::INFINITY], [f64::NEG_INFINITY, 0.0]];
        for ((name, range), side) in HOMOCLINIC_RATES.into_iter().zip(ranges).zip([-1.0, 1.0]) {
            let quantity = quantities.find(name)?;
            events.push(quantities.event(Kind::EP, name, (quantity, 0.0)).ending());
            bounds.push(Bound { side, range });
        }
    }
    for (name, level, kind) in &curve.marks {
        for column in quantities.showing(name) {
            let at = (quantities.find(&column)?, *level);
            events.push(quantities.event(*kind, format!("{column} = {level}"), at));
        }
    }
    if curve.beyond {
        events.extend(at_limits);
    }
    if limits.ordered {
        events.push(Event { terminal: !curve.beyond, ..Event::of_itinerary() });
    }
    events.extend(bifurcations(curve, of));
    if of_homoclinic_orbits {
        events.extend(quantities.on_homoclinic_curves());
    }
    events.extend(curve.events.iter().cloned());
    Ok((events, bounds))
}

/// Returns the events of the bifurcations that can occur on a curve. Terminal events come first,
/// because other events may be mirror images of terminal events.
fn bifurcations(
    curve: &Continuation,
    (parameter, multipliers): (usize, Option<usize>),
) -> Vec<Event> {
    let possible = |kind: Kind| multipliers.is_none_or(|all| is_possible(kind, all));
    let dynamics = curve.system.dynamics();
    let held: Vec<Kind> = curve.held.iter().map(|(kind, _)| *kind).collect();
    let Settings { detect, stability, .. } = &curve.settings;
    let wanted = |event: &Event| {
        let asked = detect.is_empty() || detect.contains(&event.kind);
        event.terminal
            || asked
                && possible(event.kind)
                && (*stability || event.test.needs() != Needs::Eigenvalues)
    };
    let sightings = CATALOGUE.iter().flat_map(|row| row.seen.iter().map(move |it| (row, it)));
    let here = sightings.filter(|(_, it)| it.held == held && it.of.are(dynamics));
    let events = here.map(|(row, it)| Event::of_catalogue(row, it, parameter)).filter(wanted);
    let (ends, others): (Vec<Event>, Vec<Event>) = events.partition(|event| event.terminal);
    [ends, others].concat()
}

/// Returns the user-defined scales: the scales of the groups of unknowns, followed by the scales of
/// the released parameters.
fn scales(curve: &Continuation, released: &[usize]) -> Result<Vec<Option<f64>>, TraceError> {
    let names = curve.system.names();
    let groups = names.unknowns.iter().map(|group| group.name.as_str());
    let parameters = released.iter().map(|&p| names.parameters[p].as_str());
    let known: Vec<&str> = groups.chain(parameters).collect();
    let mut scales = vec![None; known.len()];
    for (name, value) in &curve.scales {
        scales[position("group of unknowns or released parameter", name, &known)?] = Some(*value);
    }
    Ok(scales)
}

//! The start of a curve: the first correction, the scales, and the first tangent.

use super::admissible;
use super::bounds::{AT_START, Bounds};
use super::branch::Branch;
use super::builder::Continuation;
use super::corrector::Corrector;
use super::crossing::{Departure, reach_at_crossing, tangents_at_crossing};
use super::curve::Curve;
use super::curve_point::CurvePoint;
use super::detector::Detector;
use super::end::End;
use super::event::MakeCondition;
use super::extended::{Closing, Extended};
use super::linear_range::linear_range;
use super::log::Log;
use super::metric::{Metric, StartSizes, in_units};
use super::newton::NewtonError;
use super::persistence;
use super::quantities::Quantities;
use super::recorder::Recorder;
use super::refiner::Refiner;
use super::resolve::Resolved;
use super::singular_start::{beside, off_critical, off_fold};
use super::step_control::StepControl;
use super::steps::Steps;
use crate::core::bifurcation::Quantity;
use crate::core::failure::Failure;
use crate::core::linalg::{dot, generic, largest};
use crate::core::system::{Kind, Representation, Site, Solution, Start};
use std::iter::repeat_n;

/// Discretisation: unknowns whose sizes differ by less than this threshold, relative to their size,
/// count as equal in size: the two halves of a doubled orbit differ by the discretisation error.
const EQUAL: f64 = 1e-4;

/// Discretisation: if a curve emanates from a limit of admissible solutions, a level of a parameter
/// or monitor whose distance from the start, in scaled arclength, is below this threshold counts as
/// that limit. The bound is the square root of the discretisation error, because the maximum of an
/// orbit depends quadratically on arclength.
const AT_LIMIT: f64 = 1e-2;

/// Heuristic: the steps along the parameter's range, as fractions of the range ahead, after which
/// the slopes of unknowns that are zero at the start are measured to find the sizes of the unknowns.
/// Shorter steps are tried if no solution is found after a longer step. After a short step, the slope
/// of an unknown that grows as the square of the parameter is much smaller than on most of the
/// branch.
const FURTHER: [f64; 4] = [0.3, 0.1, 1e-2, 1e-3];

/// Heuristic: the maximal number of times that mesh intervals are added at the start of a curve.
/// Each addition of mesh intervals may double their number.
const MOST_FITTINGS: usize = 10;

/// Heuristic: the maximal number of corrections of a start. After each correction, the scales are
/// computed again, because the scales for the first correction are computed from the guess only.
const PASSES: usize = 3;

/// Creates the branch of a specified curve, without points.
fn branch(stated: &mut Continuation, held: &[MakeCondition]) -> Branch {
    let Representation { itinerary, method, .. } = stated.system.representation();
    let names = stated.system.names();
    let quantities = Quantities::new(names, &stated.attached);
    let own = held.iter().flat_map(|make| make().names()).copied();
    Branch {
        name: stated.name.clone(),
        condition: stated.held.first().map(|(kind, _)| *kind),
        itinerary,
        method,
        unknowns: names.unknowns.clone(),
        parameters: names.parameters.clone(),
        released: stated.released.iter().map(|released| released.0.clone()).collect(),
        monitors: quantities.monitors().chain(own).map(ToString::to_string).collect(),
        points: Vec::new(),
        special: Vec::new(),
        stretches: Vec::new(),
        ends: [End::Start, End::Start],
        warnings: Vec::new(),
        settings: stated.settings.clone(),
    }
}

/// The kinds of special points that a solution keeps if other parameters vary along the branch:
/// these kinds depend only on critical eigenvalues or multipliers. At a branch point, other
/// parameters separate the branches.
const KEPT: [Kind; 4] = [Kind::LP, Kind::HB, Kind::PD, Kind::TR];

/// Corrects the start of a curve, and computes the scales and the tangent at the start.
pub(super) fn begin<'a>(
    mut stated: Continuation<'a>,
    resolved: Resolved,
    start: &Start,
) -> Result<Steps<'a>, NewtonError> {
    let Resolved { released, held, events, bounds, scales, settled } = resolved;
    let mut branch = branch(&mut stated, &held);
    let Continuation { system, x, settings, origin, attached, .. } = stated;
    let condition = origin.as_ref().and_then(|origin| origin.condition);
    let mut equations = Extended::of(system, &x, released);
    equations.cancel.clone_from(&settings.cancel);
    let bare = equations.unload(&x);
    let mut unknowns = held.iter().try_fold(bare, |x, make| equations.hold(make(), &x))?;
    if let Some(angle) = start.angle {
        // The multipliers of a guess are not yet critical.
        unknowns[equations.dimension()] = angle;
    }
    let known = start.direction(condition == branch.condition, held.is_empty());
    let known = known.map(|t| equations.unload(t));
    let ranges: Vec<[f64; 2]> = stated.released.iter().map(|released| released.1).collect();
    let scaling: &Scaling = &|equations, unknowns, tangent, reach| {
        metric(equations, (unknowns, tangent, reach), &ranges).with_scales(&scales)
    };
    // Components of a saved tangent that should be zero are rounding errors of unknown scale.
    let still = vec![0.0; unknowns.len()];
    let on_mesh = equations.system().representation().is_on_mesh();
    let rough = known.as_deref().filter(|_| on_mesh).unwrap_or(&still);
    let rough = scaling(&equations, &unknowns, rough, None);
    let mut corrector = Corrector::new(equations, rough, &settings);
    let beginning = Beginning {
        site: start.site,
        known: known.as_deref(),
        crossing: (origin.as_ref().map_or(1, equations_at_crossing), stated.switch),
        range: ranges[0],
        held: &held,
        target: settings.mesh_target(!held.is_empty()),
    };
    let left = leave(&mut corrector, &unknowns, &beginning, scaling);
    // If the branch point breaks up, Newton's method may fail, too.
    let point = left.as_ref().map_or(&unknowns, |left| &left.unknowns).clone();
    match persistence::check(&mut corrector.equations, &point) {
        Err(cause) if left.is_ok() || matches!(cause, Failure::Unsupported(_)) => {
            return Err(cause.into());
        }
        _ => {}
    }
    let Leaving { unknowns, tangent, parent, from_branch_point, said } = left?;
    branch.warnings.extend(said);
    let is_anew = beginning.is_anew() && origin.is_none();
    let to_one_side = start.site == Site::Beside || start.site == Site::Limit && from_branch_point;
    let tangent = oriented(&corrector, tangent, to_one_side);
    let kinds: Vec<Kind> = held.iter().map(|make| make().kind()).collect();
    let recorder = Recorder::new(attached, &kinds, &events, &settings);
    let detector = Detector::new(events);
    if !settings.stability && detector.branch_points().is_none() {
        corrector.keep_factors();
    }
    let mut curve = Curve {
        corrector,
        detector,
        recorder,
        refiner: Refiner {
            held,
            settled,
            accuracy: settings.accuracy(),
            tolerances: settings.tolerances.clone(),
        },
        unused: None,
    };
    let mut place = curve.arrive_first(unknowns, tangent, from_branch_point)?;
    if is_anew {
        place = off_critical(&mut curve, place, ranges[0])?;
    }
    if let Some(shift) = origin.as_ref().and_then(|origin| origin.mesh_shift.as_ref()) {
        place.point.parameters.iter_mut().zip(shift).for_each(|(p, shift)| *p -= shift);
    }
    // Where a branch of cycles emanates, both directions give the same cycles.
    let one_sided = to_one_side || start.one_sided;
    let slopes = settle(&mut curve, &mut place, start, (from_branch_point, one_sided))?;
    let departure = parent.map(|parent| Departure::new(&curve.corrector.norm, &place, parent));
    let home = curve.corrector.solution_at(&place);
    let directions = if one_sided { [false, true] } else { [stated.backward, stated.forward] };
    let at_start = origin.iter().flat_map(|it| repeat_n(it.kind, it.multiplicity.max(1)));
    let at_start: Vec<Kind> = at_start.chain(condition).collect();
    // A start that is an end of the branch is reported as an end.
    let inside = directions == [true; 2] && !from_branch_point && curve.recorder.solutions;
    let reported = at_start.iter().copied().filter(|kind| inside && KEPT.contains(kind)).collect();
    Ok(Steps {
        home: (home, curve.corrector.norm.metric.clone()),
        control: StepControl::new(&settings, departure),
        curve,
        log: Log::new(branch),
        start: place,
        bounds: Bounds { bounds, slopes },
        directions,
        from_branch_point,
        error: origin.as_ref().map_or(0.0, |it| it.error),
        origin: at_start,
        reported,
        marked: Vec::new(),
        current: None,
        behind: None,
        ahead: None,
        settings,
    })
}

/// Adapts the mesh at the start of a curve: intervals are added until the mesh is fine enough, and
/// the start is corrected on each mesh. On each mesh, the start is corrected in the hyperplane
/// across the tangent if the direction of the curve was known before, and with a fixed parameter if
/// not. Returns the tangent.
fn fit_start(
    corrector: &mut Corrector,
    (unknowns, across): (&mut Vec<f64>, bool),
    mut tangent: Vec<f64>,
    (held, target): (&[MakeCondition], f64),
) -> Result<Vec<f64>, NewtonError> {
    for _ in 0..MOST_FITTINGS {
        let (mut fitted, mut along) = (unknowns.clone(), tangent.clone());
        if !corrector.needs_fit(unknowns, target)
            || !corrector.fit(&mut fitted, &mut [&mut along], target)
        {
            break;
        }
        corrector.restore(&fitted, corrector.norm.metric.clone(), held)?;
        tangent = first_tangent(corrector, &mut fitted, across.then_some(&along))?;
        *unknowns = fitted;
    }
    Ok(tangent)
}

/// A function that computes the scales at a point from the unknowns, the tangent and, if known, the
/// reach along the tangent.
type Scaling<'s> = dyn Fn(&Extended, &[f64], &[f64], Option<f64>) -> Metric + 's;

/// The data of a curve's start that are known before the start is corrected.
struct Beginning<'s> {
    site: Site,
    /// The direction of the curve at the start, if known.
    known: Option<&'s [f64]>,
    /// The number of algebraic bifurcation equations for the branches that cross at the start, and
    /// the index of the branch that is followed.
    crossing: (usize, Option<usize>),
    /// The range of the continued parameter.
    range: [f64; 2],
    /// The held defining systems.
    held: &'s [MakeCondition],
    /// The target for the discretisation error.
    target: f64,
}

impl Beginning<'_> {
    /// Whether only the starting point is known, without a direction of the curve.
    fn is_anew(&self) -> bool {
        self.site == Site::Point && self.known.is_none() && self.held.is_empty()
    }
}

/// The corrected start of a curve, with its tangent.
struct Leaving {
    unknowns: Vec<f64>,
    tangent: Vec<f64>,
    /// The tangent of the parent branch, if the curve starts at a branch point.
    parent: Option<Vec<f64>>,
    from_branch_point: bool,
    /// A warning about the start, if any.
    said: Option<String>,
}

/// Corrects a start, and computes its scales and its tangent. If the new scales are much smaller
/// than the scales used in the correction, the corrected start is corrected again.
fn leave(
    corrector: &mut Corrector,
    unknowns: &[f64],
    beginning: &Beginning,
    scaling: &Scaling,
) -> Result<Leaving, NewtonError> {
    let (mut passes, mut start) = (0..PASSES, unknowns.to_vec());
    loop {
        passes.next();
        let mut leaving = leave_in_scales(corrector, start, beginning)?;
        let Leaving { unknowns: point, tangent, from_branch_point, .. } = &leaving;
        let is_exact = corrector.is_exact();
        let [point, direction] = match is_exact && !from_branch_point && beginning.held.is_empty() {
            true => corrector.without_rounding(point, tangent, unknowns),
            // The oscillation at a Hopf point has an eigenvector's components, whose units may
            // differ.
            false if beginning.site == Site::Singular => [point.clone(), tangent.clone()],
            false => [point.clone(), corrector.norm.without_rounding(tangent, !is_exact)],
        };
        let [point, direction] = match is_exact {
            true => corrector.norm.without_residue([point, direction], unknowns),
            false => [point, direction],
        };
        let reach = match (from_branch_point, beginning.site) {
            (true, Site::BranchPoint) if is_exact => {
                reach_at_crossing(corrector, &point, tangent, beginning.crossing.0)
            }
            (true, Site::Singular | Site::BranchPoint)
                if !is_exact && beginning.held.is_empty() =>
            {
                linear_range(corrector, &point, &direction)
            }
            _ => None,
        };
        let mut metric = scaling(&corrector.equations, &point, &direction, reach);
        if metric.is_uncertain() && is_exact && beginning.is_anew() {
            let slope = slope_further_along(corrector, &point, beginning.range);
            let further = slope.map(|slope| scaling(&corrector.equations, &point, &slope, None));
            metric = further.map_or(metric.clone(), |further| metric.with_unknown_from(&further));
        }
        let is_rough =
            !from_branch_point && is_exact && metric.is_finer_than(&corrector.norm.metric);
        corrector.set_metric(metric);
        if is_rough && !passes.is_empty() {
            start = leaving.unknowns;
            continue;
        }
        if beginning.is_anew() {
            off_fold(corrector, &mut leaving.unknowns, &mut leaving.tangent);
        }
        return Ok(leaving);
    }
}

/// Returns the tangent of the curve a step further along the parameter's range. There, an unknown
/// that grows from zero as a higher power of the parameter has a slope, and the slope multiplied by
/// the length of the range estimates the size of the unknown. The result is `None` if the range is
/// infinite or the correction fails.
fn slope_further_along(
    corrector: &mut Corrector,
    start: &[f64],
    [low, high]: [f64; 2],
) -> Option<Vec<f64>> {
    if (high - low).is_infinite() {
        return None;
    }
    let parameter = corrector.equations.parameters_at();
    let p = start[parameter];
    let end = if high - p >= p - low { high } else { low };
    FURTHER.into_iter().find_map(|fraction| {
        let mut point = start.to_vec();
        point[parameter] += fraction * (end - p);
        let tangent = first_tangent(corrector, &mut point, None).ok()?;
        let cleared = corrector.without_rounding(&point, &tangent, start);
        let [_, tangent] = corrector.norm.without_residue(cleared, start);
        Some(tangent)
    })
}

/// Corrects a start with the current scales, and computes the tangent.
fn leave_in_scales(
    corrector: &mut Corrector,
    mut unknowns: Vec<f64>,
    &Beginning { site, known, crossing, range, held, target }: &Beginning,
) -> Result<Leaving, NewtonError> {
    let [direction, parent] = leaving(corrector, site, &unknowns, known, crossing)?;
    let from_branch_point = direction.is_some();
    let first = |corrector: &mut Corrector, unknowns: &mut Vec<f64>| match (site, known) {
        // With a fixed parameter, cycles may shrink to the equilibrium.
        (Site::Beside, Some(direction)) => {
            let row = corrector.norm.covector(direction);
            correct_start(corrector, unknowns, &row)
        }
        _ => first_tangent(corrector, unknowns, known),
    };
    if let Some(tangent) = direction {
        return Ok(Leaving { unknowns, tangent, parent, from_branch_point, said: None });
    }
    let (tangent, said) = match first(corrector, &mut unknowns) {
        Ok(tangent) => (tangent, None),
        Err(cause) => {
            let (tangent, said) = beside(corrector, &mut unknowns, range, cause, first)?;
            (tangent, Some(said))
        }
    };
    let at = (&mut unknowns, known.is_some());
    let tangent = fit_start(corrector, at, tangent, (held, target))?;
    Ok(Leaving { unknowns, tangent, parent, from_branch_point, said })
}

/// Checks the order of the orbit's events at the start, discards values of test functions that
/// consist only of rounding errors, and adapts the mesh. Returns, for each level of a parameter or
/// monitor that is an event, the derivative of the event's test function along the curve.
fn settle(
    curve: &mut Curve,
    place: &mut CurvePoint,
    start: &Start,
    (from_branch_point, one_sided): (bool, bool),
) -> Result<Vec<f64>, Failure> {
    let equations = &mut curve.corrector.equations;
    // At a limit, rounding determines the order of events.
    if start.site != Site::Limit {
        let x = equations.load(&place.unknowns).to_vec();
        admissible::check(equations.system(), &x, &place.point.monitors)?;
    }
    if one_sided && start.site != Site::Beside {
        forget_stability_at(place);
    }
    let slopes = forget_levels_at(curve, place, start);
    if !from_branch_point {
        let equations = &mut curve.corrector.equations;
        equations.on_accepted(&mut place.unknowns, &mut [&mut place.tangent]);
    }
    Ok(slopes)
}

/// Computes the scales at a point from the unknowns and the tangent.
fn metric(
    equations: &Extended,
    (unknowns, tangent, reach): (&[f64], &[f64], Option<f64>),
    ranges: &[[f64; 2]],
) -> Metric {
    let (n, first) = (equations.dimension(), equations.parameters_at());
    let (own, units) = (equations.own_sizes(unknowns), equations.unknown_scales());
    let sizes = StartSizes {
        z: &unknowns[..n],
        z_tangent: &tangent[..n],
        p: &unknowns[first..],
        p_tangent: &tangent[first..],
        reach,
        units: &units,
    };
    Metric::new(equations.names(), &sizes, ranges, &own)
}

/// Returns the number of algebraic bifurcation equations for the branches that cross at a special
/// point. The number of algebraic bifurcation equations is the multiplicity of the special point;
/// at a fold, it is one smaller.
fn equations_at_crossing(origin: &Solution) -> usize {
    (origin.multiplicity - usize::from(origin.kind == Kind::LP).min(origin.multiplicity)).max(1)
}

/// Returns the tangent of a branch, if known before its start is corrected, and the tangent of the
/// parent branch. At a branch point, both tangents are computed from the algebraic bifurcation
/// equations.
fn leaving(
    corrector: &mut Corrector,
    site: Site,
    unknowns: &[f64],
    along: Option<&[f64]>,
    (multiplicity, switch): (usize, Option<usize>),
) -> Result<[Option<Vec<f64>>; 2], Failure> {
    let known = along.map(<[f64]>::to_vec);
    match site {
        Site::Singular | Site::Limit => return Ok([known, None]),
        Site::Point | Site::OtherBranch | Site::Beside => return Ok([None, None]),
        Site::BranchPoint => {}
    }
    let found = tangents_at_crossing(corrector, unknowns, multiplicity);
    let mut tangents = match found {
        Err(_) if known.is_some() && switch.is_none() => return Ok([known, None]),
        found => found?,
    };
    let Some(along) = along else { return Ok([tangents.pop(), None]) };
    let row = corrector.norm.covector(along);
    let parent = (0..tangents.len())
        .max_by(|&a, &b| {
            let cosine = |k: usize| dot(&row, &tangents[k]).abs();
            cosine(a).total_cmp(&cosine(b))
        })
        .unwrap_or_default();
    let parent = Some(tangents.remove(parent));
    let Some(branch) = switch else { return Ok([parent, None]) };
    let count = tangents.len();
    match tangents.into_iter().nth(branch) {
        None => Err(Failure::no_branch(branch, count)),
        tangent => Ok([tangent, parent]),
    }
}

/// Corrects the start in the hyperplane across `direction`, or with a fixed parameter if no
/// direction is given, and returns the tangent.
fn first_tangent(
    corrector: &mut Corrector,
    unknowns: &mut [f64],
    direction: Option<&[f64]>,
) -> Result<Vec<f64>, NewtonError> {
    let (length, base) = (unknowns.len(), unknowns.to_vec());
    let fixed = |parameter: usize| {
        let mut row = vec![0.0; length];
        row[parameter] = 1.0;
        row
    };
    let across = direction.map(|direction| corrector.norm.covector(direction));
    let fixed = (corrector.equations.parameters_at()..length).rev().map(fixed);
    let mut failure = None;
    for row in across.into_iter().chain(fixed) {
        unknowns.copy_from_slice(&base);
        match correct_start(corrector, unknowns, &row) {
            Ok(tangent) => return Ok(tangent),
            // The first failure is reported; later rows are only further attempts.
            Err(cause) => _ = failure.get_or_insert(cause),
        }
    }
    // A start that is already a solution may be a fold, which is regular on a hyperplane across
    // some unknowns, or a branch point, where this attempt fails as well.
    let mut row = generic(length, 1);
    row[corrector.equations.dimension()..].fill(0.0);
    row.iter_mut().enumerate().for_each(|(k, r)| *r = corrector.norm.scaled(k, *r));
    unknowns.copy_from_slice(&base);
    let tangent = correct_start(corrector, unknowns, &row);
    let moved = corrector.norm.distance(unknowns, &base);
    match failure {
        Some(failure) if tangent.is_err() || moved > AT_START => Err(failure),
        _ => tangent,
    }
}

/// Corrects the start in a hyperplane that passes through the start and is defined by the covector
/// `row`; computes the tangent without normalising it.
fn correct_start(
    corrector: &mut Corrector,
    unknowns: &mut [f64],
    row: &[f64],
) -> Result<Vec<f64>, NewtonError> {
    let base = unknowns.to_vec();
    corrector.correct(unknowns, Closing { row, base: &base, length: 0.0 })?;
    corrector.factor_at(unknowns, row)?;
    let mut tangent = vec![0.0; unknowns.len()];
    corrector.equations.tangent(&mut tangent);
    Ok(tangent)
}

/// Scales the tangent at the start to length 1 and orients it towards increasing values of the last
/// released parameter, unless its direction is already known.
fn oriented(corrector: &Corrector, mut tangent: Vec<f64>, known: bool) -> Vec<f64> {
    let Corrector { equations, norm, .. } = corrector;
    let (n, last) = (equations.dimension(), tangent.len() - 1);
    let size = norm.of(&tangent);
    let sign = match tangent[last] {
        _ if known => 1.0,
        // A vertical start (a fold, a pitchfork) is oriented towards increasing values of its
        // largest unknown; the first of several, such as the two halves of a doubled orbit.
        p if norm.scaled(last, p).abs() < 1e-9 * size => {
            let z = in_units(equations.names(), &equations.unknown_scales(), &tangent[..n]);
            let largest = largest(&z);
            let first = z.iter().find(|z| z.abs() >= (1.0 - EQUAL) * largest);
            first.map_or(1.0, |z| z.signum())
        }
        p => p.signum(),
    };
    tangent.iter_mut().for_each(|t| *t *= sign / size);
    tangent
}

/// Discards the stability at the start of a branch of cycles at a Hopf point. One nontrivial
/// multiplier equals 1 at the Hopf point, so stability is undefined and must not be compared with
/// the next point.
fn forget_stability_at(start: &mut CurvePoint) {
    (start.point.unstable, start.stability) = (None, None);
}

/// If a curve starts on levels of parameters or monitors, up to rounding, sets the test functions
/// of these levels to exactly zero, so that the first step does not pass the levels. Returns, for
/// each level of a parameter or monitor that is an event, the derivative of the event's test
/// function along the curve at the start.
///
/// If a curve emanates at a level, its start differs from the level by the discretisation error.
fn forget_levels_at(curve: &mut Curve, start: &mut CurvePoint, from: &Start) -> Vec<f64> {
    let Curve { corrector, detector, .. } = curve;
    let at_limit = from.site == Site::Limit;
    let vertical = at_limit && from.direction.is_some();
    let mut slopes = vec![0.0; detector.events.len()];
    for (i, event) in detector.events.iter().enumerate() {
        if at_limit && event.test.is_decision() {
            // Rounding determines the modes after zero-length segments.
            start.tests[i] = None;
        }
        let Some((quantity, level)) = event.test.level() else { continue };
        slopes[i] = corrector.slope_of(quantity, start.on_curve()).unwrap_or_default();
        // Parameters have no discretisation error, and a mark near the limit is another point.
        let is_limit = at_limit && matches!(quantity, Quantity::Monitor(_));
        let near = if is_limit && event.kind != Kind::UZ { AT_LIMIT } else { AT_START };
        let mut rounding = near * f64::abs(slopes[i]) + 1e-12 * level.abs();
        if let (true, admissible::AT_LIMIT, Quantity::Monitor(m)) = (vertical, event.kind, quantity)
        {
            // If the test function vanishes to second order, its sign and the sign of its slope are
            // rounding; the first step determines them.
            let p = &start.point.parameters;
            let zero = admissible::zero(corrector.equations.system(), p, m);
            if start.tests[i].is_some_and(|test| test.abs() <= zero) {
                (rounding, slopes[i]) = (zero, 0.0);
            }
        }
        if start.tests[i].is_some_and(|test| test.abs() <= rounding) {
            start.tests[i] = Some(0.0);
        }
    }
    slopes
}

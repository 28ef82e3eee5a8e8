//! Codimension-two points on curves of grazings.

use super::at::At;
use super::defining_system::DefiningSystem;
use super::fold::Fold;
use super::null::NullSpace;
use super::test_function::{PointValues, TestFunction};
use crate::core::failure::Failure;
use crate::core::linalg::{Border, Factors, Form, dot, generic};
use crate::core::system::{Across, Functional, Kind, Limit, System};

impl Kind {
    /// `GD`: a degenerate grazing, where the branch of orbits with the event begins at a fold,
    /// `∂P/∂θ = 0`.
    pub const GD: Kind = Kind::new("GD", "degenerate grazing");
    /// `GF`: a degenerate grazing of flip type, where a curve of period doublings of the orbits
    /// with the event ends.
    pub const GF: Kind = Kind::new("GF", "degenerate grazing of flip type");
    /// `GL`: a nonhyperbolic grazing of fold type, where the orbit without the event has a
    /// multiplier 1.
    pub const GL: Kind = Kind::new("GL", "nonhyperbolic grazing of fold type");
    /// `GP`: a nonhyperbolic grazing of flip type, where the orbit without the event has a
    /// multiplier −1.
    pub const GP: Kind = Kind::new("GP", "nonhyperbolic grazing of flip type");
}

/// A codimension-two point on a curve of grazings. The grazing orbit belongs to two families of
/// periodic orbits: orbits with the event at the grazing point, and orbits without it. The
/// linearisation `F_z` of one family is singular at the codimension-two point: of the orbits with
/// the event if the grazing is *degenerate*, of the orbits without the event if the grazing is
/// *nonhyperbolic*. The equations of the curve of grazings describe the orbits of only one of the
/// two families. If the linearisation is singular for the family that these equations do not
/// describe, the equation of the fold (or period doubling) is evaluated at an orbit of that family
/// ([`OrbitEvents::across`](crate::core::system::OrbitEvents::across)).
pub(super) struct GrazingBifurcation {
    kind: Kind,
    fold: Fold,
    /// The null vectors of the orbits on the other side of the grazing.
    null: NullSpace,
    /// Whether the orbits along the curve include the event that becomes tangent at the grazing.
    passes: bool,
    /// The number of unknowns of the orbits whose linearisation is singular.
    unknowns: usize,
    factors: Factors,
}

impl GrazingBifurcation {
    /// Creates the defining system of a kind of degenerate or nonhyperbolic grazing: a fold (`GD`,
    /// `GL`) or a period doubling (`GF`, `GP`) of the orbits with or without the event.
    pub fn of(kind: Kind) -> Self {
        let fold = match [Kind::GF, Kind::GP].contains(&kind) {
            true => Fold::period_doubling(),
            false => Fold::default(),
        };
        let (null, factors) = (NullSpace::default(), Factors::default());
        GrazingBifurcation { kind, fold, null, passes: false, unknowns: 0, factors }
    }

    /// Whether the linearisation becomes singular for the orbits along the curve, and stays regular
    /// for the orbits on the other side of the grazing.
    fn own(&self) -> bool {
        self.passes == [Kind::GD, Kind::GF].contains(&self.kind)
    }

    /// Returns the defining system of the fold or period doubling, and the orbit of the singular
    /// family at which the defining system is evaluated. An orbit whose number of unknowns differs
    /// from the number at the start of the curve is rejected: orbits along the curve may graze
    /// further surfaces.
    fn singular<'a>(&'a mut self, at: &'a mut At) -> Result<(&'a mut Fold, At<'a>), Failure> {
        let at = if self.own() { at.again() } else { across(at, self.passes, &mut self.null)? };
        match at.system.names().dimension() == self.unknowns {
            true => Ok((&mut self.fold, at)),
            false => Err(Failure::Undetermined(
                "the orbits on the other side of the grazing differ from those at the start of the curve".into(),
            )),
        }
    }

    /// Computes the gradient, with respect to the released parameters, of the left side of the fold
    /// equation, evaluated at the orbits on the other side of the grazing. These orbits also graze,
    /// so the monitor that vanishes at the grazing stays zero, and the change of the parameters
    /// determines the change of the orbit: `F_z δz + F_p δp = 0`.
    fn gradient_across(&mut self, mut at: At) -> Result<Vec<f64>, Failure> {
        let mut factors = std::mem::take(&mut self.factors);
        let (fold, mut at) = self.singular(&mut at)?;
        let (n, x, released) = (at.system.names().dimension(), at.x, at.released);
        let Some(touched) = limit_reached(at.system, x)? else { return Err(no_other()) };
        let (mut slope, mut rate) = (vec![0.0; x.len()], vec![0.0; x.len()]);
        fold.gradients(at.again(), &mut slope, &mut [])?;
        let system = at.system;
        system.gradient(x, Functional::Monitor(touched.monitor), released, &mut rate)?;
        let columns = generic(n, 3);
        let border =
            Border { width: 1, columns: &columns, rows: &rate[..n], corner: &[0.0], units: &[] };
        system.assemble(x)?;
        system.factor(Form::Jacobian, border, &mut factors)?;
        let mut adjoint = slope[..n].to_vec();
        adjoint.push(0.0);
        factors.solve_transposed(&mut adjoint);
        let (mut direction, mut column) = (vec![0.0; x.len()], vec![0.0; n]);
        let by = |p: &usize| {
            direction.fill(0.0);
            direction[n + p] = 1.0;
            system.derivative(x, &[&direction], &mut column)?;
            Ok(slope[n + p] - dot(&adjoint[..n], &column) - adjoint[n] * rate[n + p])
        };
        let slopes = released.iter().map(by).collect();
        self.factors = factors;
        slopes
    }
}

/// Returns the limit of admissible solutions that a solution has reached: the limit whose monitor
/// is smallest in units of its scale.
fn limit_reached(system: &mut dyn System, x: &[f64]) -> Result<Option<Limit>, Failure> {
    let n = system.names().dimension();
    let limits = system.events().map_or_else(Vec::new, |events| events.limits(&x[n..]));
    let (mut least, mut reached) = (f64::INFINITY, None);
    for limit in limits {
        let mut value = [0.0];
        system.monitors(x, limit.monitor, &mut value)?;
        let size = value[0].abs() / limit.scale;
        if size.total_cmp(&least).is_lt() {
            (least, reached) = (size, Some(limit));
        }
    }
    Ok(reached)
}

/// Heuristic: a solution counts as lying at a limit of admissible solutions if the limit's monitor,
/// in units of the monitor's scale, is smaller than this threshold.
const REACHED: f64 = 1e-6;

/// Returns the same orbit without an event that has zero speed and leaves the motion unchanged;
/// `None` if the orbit has no such event. The linearisation is singular if the event is included,
/// and regular if it is omitted.
pub(in crate::core) fn without_event<'a>(
    system: &'a mut dyn System,
    x: &[f64],
) -> Option<Across<'a>> {
    let n = system.names().dimension();
    let limits = system.events()?.limits(&x[n..]);
    let reached = limits.into_iter().filter(|limit| limit.passes).any(|limit| {
        let mut value = [0.0];
        let known = system.monitors(x, limit.monitor, &mut value).is_ok();
        known && value[0].abs() <= REACHED * limit.scale
    });
    let other = if reached { system.events()?.across(x, true).ok()?? } else { return None };
    let changes = other.system.events()?.across(other.x, false).ok()?.is_some();
    if changes { None } else { system.events()?.across(x, true).ok()? }
}

/// Returns the orbit on the other side of a grazing, at the same parameters.
fn across<'a>(at: &'a mut At, passes: bool, null: &'a mut NullSpace) -> Result<At<'a>, Failure> {
    let across = at.system.events().map(|events| events.across(at.x, passes));
    let Across { system, x } = across.transpose()?.flatten().ok_or_else(no_other)?;
    Ok(At { system, x, released: at.released, held: at.held, null })
}

fn no_other() -> Failure {
    Failure::Undetermined("the system provides no orbits on the other side of the grazing".into())
}

impl DefiningSystem for GrazingBifurcation {
    fn kind(&self) -> Kind {
        self.kind
    }

    fn assembles(&self) -> bool {
        self.own()
    }

    fn start(&mut self, mut at: At, y: &mut [f64]) -> Result<(), Failure> {
        self.passes = limit_reached(at.system, at.x)?.is_some_and(|limit| limit.passes);
        let own = self.own();
        // The linearisation of orbits with such an event is singular along the whole curve.
        if own && without_event(&mut *at.system, at.x).is_some() {
            return Err(Failure::Undetermined(
                "the event leaves the motion unchanged, so that the orbits with the event and the \
                 orbits without it have the same multipliers"
                    .into(),
            ));
        }
        let at = if own { at.again() } else { across(&mut at, self.passes, &mut self.null)? };
        self.unknowns = at.system.names().dimension();
        self.fold.start(at, y)
    }

    fn values(&mut self, mut at: At, y: &[f64], values: &mut [f64]) -> Result<(), Failure> {
        // The other orbits are computed anew at each point.
        self.null.forget();
        let (fold, at) = self.singular(&mut at)?;
        fold.values(at, y, values)
    }

    fn gradients(&mut self, at: At, rows: &mut [f64], own: &mut [f64]) -> Result<(), Failure> {
        if self.own() {
            return self.fold.gradients(at, rows, own);
        }
        let (n, released) = (at.system.names().dimension(), at.released);
        let slopes = self.gradient_across(at)?;
        rows.fill(0.0);
        released.iter().zip(slopes).for_each(|(p, slope)| rows[n + p] = slope);
        Ok(())
    }

    fn adapt(&mut self) {
        self.null.adapt();
    }
}

/// The test function of the order of events along an orbit: 1 if the events occur in the prescribed
/// order of modes, −1 if they do not.
pub(crate) struct OrderOfEvents;

impl TestFunction for OrderOfEvents {
    fn value(&self, at: &mut At, _known: &PointValues) -> Result<Option<f64>, Failure> {
        match at.system.events().map(|events| events.check(at.x)) {
            None => Ok(None),
            Some(Ok(())) => Ok(Some(1.0)),
            Some(Err(failure @ Failure::OutOfDomain(_))) => Err(failure),
            Some(Err(_)) => Ok(Some(-1.0)),
        }
    }

    fn is_decision(&self) -> bool {
        true
    }
}

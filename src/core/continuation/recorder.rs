//! Recording of points of a curve: their monitors, stability and profiles.

use super::admissible;
use super::branch::{Point, SpecialPoint};
use super::corrector::Corrector;
use super::curve_point::CurvePoint;
use super::end::End;
use super::event::Event;
use super::extended::Extended;
use super::function::{Attached, TestPoint};
use super::paired_multipliers::{self, besides_second_one};
use super::settings::Settings;
use crate::core::bifurcation::{
    At, Critical, Needs, Stability, catalogue, deciding, without_critical, without_event,
};
use crate::core::failure::{Failure, finite, one_line};
use crate::core::linalg::{Spectrum, SpectrumRequest};
use crate::core::problem::{Dynamics, PlaneField};
use crate::core::system::{Across, Kind, System};

/// Heuristic: the minimal number of eigenvalues computed at each point. The computed eigenvalues
/// include the rightmost stable eigenvalues, whose real parts may reach zero in the next step.
const LEAST: usize = 4;

/// The remedy for a monitor that is not finite.
const UNDEFINED: &str = "bound the branch before the solutions at which the monitor is undefined, or remove the monitor";

/// The recorded data of a point, without its unknowns.
pub(super) struct Recorded {
    pub point: Point,
    pub spectrum: Option<Spectrum>,
    /// The eigenvalues, without the eigenvalues that are critical at all points of the curve.
    pub others: Option<Spectrum>,
    /// The number of unstable eigenvalues in `others`: real, complex and in total.
    pub stability: Option<Stability>,
}

/// Specifies the quantities that are recorded along a curve, and records them.
pub(super) struct Recorder {
    /// User-defined monitors.
    attached: Vec<Attached>,
    /// Whether the curve is a branch of solutions, without held defining systems.
    pub solutions: bool,
    /// Whether stability is computed along the curve.
    pub stability: bool,
    /// The number of eigenvalues stored with each point.
    eigenvalues: usize,
    /// The types of eigenvalues that are critical at all points of the curve.
    critical: Vec<Critical>,
    /// The kind of the bifurcation points that form the curve; `None` if curves of this kind do not
    /// divide the plane of two parameters.
    pub dividing: Option<Kind>,
    /// Whether events are detected by the numbers of unstable eigenvalues, not counting the
    /// eigenvalues that are critical at all points of the curve.
    counts: bool,
    /// Whether the curve is a [family of cycles](super::conservative) at one value of the continued
    /// parameter.
    pub family: bool,
}

impl Recorder {
    /// Creates the recorder of a curve whose points are special points of the kinds `held`, and
    /// along which the given events are detected.
    pub fn new(
        attached: Vec<Attached>,
        held: &[Kind],
        events: &[Event],
        settings: &Settings,
    ) -> Self {
        let Settings { stability, eigenvalues, .. } = *settings;
        let critical = held.iter().filter_map(|kind| Some(catalogue::row_of(*kind)?.critical));
        let row = |kind: &Kind| catalogue::row_of(*kind).filter(|row| row.division.is_some());
        let dividing = match held {
            [kind] => row(kind).map(|row| row.kind),
            _ => None,
        };
        // On curves of branch points, no other event is detected; on curves of planar cycles, no
        // other multiplier can become critical. The counts of the regions next to the curve are known there, too.
        let counts = dividing == Some(Kind::BP)
            || dividing.is_some() && settings.detect.is_empty()
            || events.iter().any(|event| event.test.needs() == Needs::Eigenvalues);
        let (solutions, critical) = (held.is_empty(), critical.collect());
        let family = false;
        Recorder { attached, solutions, stability, eigenvalues, critical, dividing, counts, family }
    }

    /// Returns a spectrum without the eigenvalues that are critical at all points of the curve.
    fn others(&self, dynamics: Dynamics, mut spectrum: Spectrum) -> Spectrum {
        for critical in &self.critical {
            let distance = |l: &(f64, f64)| critical.distance(dynamics, l);
            spectrum = without_critical(&spectrum, critical.count(), distance);
        }
        spectrum
    }

    /// Whether eigenvalues are computed at every point. Eigenvalues are computed if stability is
    /// enabled and at least one of three conditions holds: the curve is a branch of solutions,
    /// eigenvalues are stored with points, or events are detected by eigenvalues.
    pub fn wants_stability(&self) -> bool {
        self.stability && (self.solutions || self.keeps_spectra() || self.counts)
    }

    /// The number of eigenvalues that are computed at least, if only some are computed.
    fn least(&self) -> usize {
        self.eigenvalues.max(LEAST)
    }

    /// Whether eigenvalues are stored with the points of the curve.
    pub fn keeps_spectra(&self) -> bool {
        self.eigenvalues > 0
    }

    /// Returns the parameters, monitors, stability and eigenvalues at the last assembled point.
    pub fn record(&self, equations: &mut Extended, stability: bool) -> Result<Recorded, Failure> {
        let at = equations.at();
        let n = at.system.names().dimension();
        let (spectrum, undetermined) = match stability {
            true => self.spectrum_of(&mut *at.system, at.x, self.least())?,
            false => (None, None),
        };
        let mut monitors = self.monitors(at, spectrum.as_ref())?;
        let At { system, x, .. } = equations.at();
        let (x, dynamics) = (x.to_vec(), system.dynamics());
        let own = &system.names().monitors;
        finite(&monitors[..own.len()], |k| format!("the monitor `{}`", own[k]), UNDEFINED)?;
        let parameters = x[n..].to_vec();
        let admissible = admissible::is_within(system, &parameters, &monitors)
            && admissible::check(system, &x, &monitors).is_ok();
        monitors.extend(equations.recorded());
        let eigenvalues = deciding(spectrum.as_deref().unwrap_or_default(), self.eigenvalues);
        let others = spectrum.clone().map(|all| self.others(dynamics, all));
        let count = |all: &[(f64, f64)]| match self.family {
            true => paired_multipliers::stability(all),
            false => Stability::of(dynamics, all),
        };
        let stability = others.as_deref().map(count);
        let unstable = stability.filter(|_| self.solutions).map(|stability| stability.unstable);
        let recorded = Point::new(parameters, monitors, unstable);
        let point = Point { undetermined, eigenvalues, admissible, ..recorded };
        Ok(Recorded { point, spectrum, others, stability })
    }

    /// Returns the eigenvalues of the last assembled point, or the reason why they could not be
    /// determined. On a branch of solutions, an event that leaves the motion unchanged is removed
    /// from the orbit before the eigenvalues are computed.
    fn spectrum_of(
        &self,
        system: &mut dyn System,
        x: &[f64],
        count: usize,
    ) -> Result<(Option<Spectrum>, Option<String>), Failure> {
        let other = if self.solutions { without_event(system, x) } else { None };
        let found = match other {
            Some(Across { system, x }) => {
                system.assemble(x).and_then(|()| system.spectrum(x, SpectrumRequest::new(count)))
            }
            None => system.spectrum(x, SpectrumRequest::new(count)),
        };
        match found {
            Err(Failure::Undetermined(reason)) => Ok((None, Some(reason))),
            found => {
                let all = found?;
                let all = if self.family { all.as_deref().map(besides_second_one) } else { all };
                Ok((all, None))
            }
        }
    }

    /// Returns the leading eigenvalues at a point, if they can be determined.
    pub fn spectrum_at(&self, equations: &mut Extended, unknowns: &[f64]) -> Option<Spectrum> {
        equations.assemble(unknowns).ok()?;
        let At { system, x, .. } = equations.at();
        self.spectrum_of(system, x, self.least()).ok()?.0
    }

    /// Returns the values of the monitors of a system at the last assembled point, followed by the
    /// values of user-defined monitors.
    pub fn monitors(
        &self,
        At { system, x, .. }: At,
        spectrum: Option<&Spectrum>,
    ) -> Result<Vec<f64>, Failure> {
        let (n, own) = (system.names().dimension(), system.names().monitors.len());
        let mut monitors = vec![0.0; own];
        system.monitors(x, 0, &mut monitors)?;
        for Attached { function, .. } in &self.attached {
            let value = function(&TestPoint {
                state: &x[..n],
                parameters: &x[n..],
                monitors: &monitors,
                eigenvalues: spectrum.map_or(&[], |all| all),
            });
            monitors.push(value);
        }
        Ok(monitors)
    }

    /// Creates the special point at an end of the branch.
    pub fn end_point(
        &self,
        corrector: &mut Corrector,
        place: &CurvePoint,
        end: &End,
        after: usize,
    ) -> SpecialPoint {
        let failed = matches!(
            end,
            End::StepTooSmall { .. } | End::MeshTooCoarse { .. } | End::NoProgress { .. }
        );
        let kind = if failed { Kind::MX } else { Kind::EP };
        let mut special = self.saved_point(corrector, place, (kind, &end.to_string()), after);
        // At a bound the continued parameter is exact; a start at a bound may be corrected
        // slightly.
        if let (true, End::ParameterBound { value, .. }) = (self.solutions, end) {
            let continued = corrector.equations.released[0];
            special.error = (special.parameters[continued] - value).abs();
        }
        // The parameter is as inaccurate as the solution on such a mesh, and near a homoclinic
        // orbit on any mesh.
        if let End::LongPeriod { .. }
        | End::Homoclinic { .. }
        | End::WeakSaddle { .. }
        | End::MeshTooCoarse { .. } = end
        {
            special.error += corrector.mesh_share(&place.unknowns);
        }
        special
    }

    /// Creates a special point with all data that are needed to start a branch at it.
    pub fn saved_point(
        &self,
        corrector: &mut Corrector,
        place: &CurvePoint,
        event: (Kind, &str),
        after: usize,
    ) -> SpecialPoint {
        let CurvePoint { unknowns, tangent, point, .. } = place;
        let (mut point, mut spectrum) = (point.clone(), None);
        // `place` may have the spectrum of an earlier Newton iterate's matrix, or none.
        if corrector.equations.assemble(unknowns).is_ok() && self.stability {
            let At { system, x, .. } = corrector.equations.at();
            if let Ok((own, undetermined)) = self.spectrum_of(system, x, self.least()) {
                point.unstable = point.unstable.filter(|_| undetermined.is_none());
                // Barely determined multipliers may be determined with only one of the two
                // matrices.
                point.undetermined = undetermined.or(point.undetermined);
                spectrum = own;
            }
        }
        let spectrum = spectrum.unwrap_or_default();
        let special = special_point(corrector, event, point, &spectrum, [unknowns, tangent]);
        SpecialPoint { after, ..special }
    }
}

/// Creates a special point from the last assembled unknowns and their tangent.
pub(super) fn special_point(
    corrector: &mut Corrector,
    (kind, event): (Kind, &str),
    point: Point,
    spectrum: &[(f64, f64)],
    [unknowns, tangent]: [&[f64]; 2],
) -> SpecialPoint {
    let error = corrector.parameter_error();
    let equations = &mut corrector.equations;
    let (n, first) = (equations.dimension(), equations.parameters_at());
    let At { system, x, .. } = equations.at();
    let mut profiles = system.profiles(x);
    let fields = PlaneField::of_arrays(&system.names().unknowns, x);
    let system_of_cycles = system.discretised().filter(|_| corrector.phase_response);
    let responses = system_of_cycles.map_or(Ok(Vec::new()), |system| system.phase_response(x));
    let without_phase_response = responses.map(|all| profiles.extend(all)).err();
    SpecialPoint {
        parameters: point.parameters,
        monitors: point.monitors,
        unstable: point.unstable,
        undetermined: point.undetermined,
        eigenvalues: deciding(spectrum, SpecialPoint::EIGENVALUES),
        error,
        bracket: [unknowns[first]; 2],
        state: unknowns[..n].to_vec(),
        tangent: [&tangent[..n], &tangent[first..]].concat(),
        slopes: point.slopes,
        profiles,
        fields,
        without_phase_response: without_phase_response.map(|cause| one_line(&cause)),
        mesh: system.representation().mesh,
        ..SpecialPoint::new(kind, event)
    }
}

//! What is recorded of a special point.

use super::event::Event;
use super::located::Located;
use super::stepper::{Place, Stepper};
use super::{End, Kind, Point, SpecialPoint};
use crate::core::condition::{At, Failure, Quantity};
use crate::core::motion::{Critical, Stability, deciding, without_critical};
use crate::core::vector::dot;
use crate::core::zero::{Profile, Spectrum};

impl Stepper<'_> {
    /// An end of the branch.
    pub fn end_point(&mut self, place: &Place, end: &End, after: usize) -> SpecialPoint {
        let failed = matches!(end, End::StepTooSmall { .. } | End::MeshTooCoarse { .. });
        let kind = if failed { Kind::MX } else { Kind::EP };
        let mut special = self.saved_point(place, kind, &end.to_string(), after);
        // On a bound the continued parameter is what it is; a start on a bound may be corrected by
        // a little.
        if let (true, End::ParameterBound { value, .. }) = (self.held.is_empty(), end) {
            let continued = self.equations.released()[0];
            special.error = (special.parameters[continued] - value).abs();
        }
        // On such a mesh the parameter depends on it as much as the solution does, and near a
        // homoclinic orbit on any.
        if let End::LongPeriod { .. } | End::MeshTooCoarse { .. } = end {
            special.error += self.mesh_share(&place.unknowns);
        }
        special
    }

    /// The relative error of the mesh, in units of the continued parameter.
    pub fn mesh_share(&mut self, unknowns: &[f64]) -> f64 {
        self.mesh_error(unknowns) * unknowns[self.equations.parameters_at()].abs()
    }

    /// The estimated relative error of a solution that its mesh causes.
    pub fn mesh_error(&mut self, unknowns: &[f64]) -> f64 {
        self.equations.load(unknowns);
        let At { system, x, .. } = self.equations.at();
        system.discretised().map_or(0.0, |discretised| discretised.mesh_error(x))
    }

    /// A point of the branch with everything that a branch can start from.
    pub fn saved_point(
        &mut self,
        place: &Place,
        kind: Kind,
        event: &str,
        after: usize,
    ) -> SpecialPoint {
        let (mut profiles, mut own) = (Vec::new(), None);
        if self.equations.assemble(&place.unknowns).is_ok() {
            profiles = self.profiles();
            // The place may hold the spectrum of an earlier Newton iterate's matrix, and
            // along curves of events eigenvalues are computed where they are saved only.
            if self.settings.stability {
                let At { system, x, .. } = self.equations.at();
                own = system.spectrum(x).ok().flatten();
            }
        }
        let Place { unknowns, tangent, point, .. } = place;
        let spectrum = own.unwrap_or_default();
        let special = self.special(kind, event, point.clone(), &spectrum, (unknowns, tangent));
        SpecialPoint { after, profiles, ..special }
    }

    /// The special point with everything that is recorded of it; `between` are the places that
    /// enclose it, and how far they are apart.
    pub fn describe(
        &mut self,
        index: usize,
        (between, length): ([&Place; 2], f64),
        located: Located,
    ) -> Result<Located, Failure> {
        let Located { along, unknowns, special, .. } = located;
        let SpecialPoint { error, numbers, converged, .. } = special;
        let [from, to] = between;
        let event = &self.events[index].clone();
        let tangent = self.tangent_between(event.kind, &unknowns, between, along / length)?;
        // Where multipliers are infinite, as at a grazing, nothing is known of them.
        let recorded = self.record(self.settings.stability);
        let (mut point, spectrum) = recorded.or_else(|_| self.record(false))?;
        let known = spectrum.as_ref().filter(|_| self.held.is_empty());
        point.unstable = match known {
            Some(all) => self.own_count(event.critical, all, (from, to)),
            None if spectrum.is_none() && event.kind == Kind::G => from.point.unstable,
            None => None,
        };
        let spectrum = spectrum.unwrap_or_default();
        if !converged {
            point.unstable = from.point.unstable.min(to.point.unstable);
        }
        let profiles = self.profiles();
        let parameter = self.equations.parameters_at();
        let bracket = [from.unknowns[parameter], to.unknowns[parameter]];
        let at = (&unknowns[..], &tangent[..]);
        let special = self.special(event.kind, &event.name, point, &spectrum, at);
        let subkind = self.subkind(index, (&special.state, &special.parameters));
        let special =
            SpecialPoint { subkind, error, bracket, converged, numbers, profiles, ..special };
        let special = self.with_error(event, special, &unknowns, &from.point);
        Ok(Located { event: Some(index), along, unknowns, special })
    }

    /// The special point with the error of its discretisation, on a finer one where its kind is
    /// worth it.
    fn with_error(
        &mut self,
        event: &Event,
        mut special: SpecialPoint,
        unknowns: &[f64],
        from: &Point,
    ) -> SpecialPoint {
        // Where a bound happens to cut a branch of solutions it is enough to know the branch's
        // error.
        let end_of_branch = event.kind == Kind::EP && self.held.is_empty();
        if event.condition.is_none() {
            special.error += self.mesh_share(unknowns);
            return special;
        }
        let rungs = if end_of_branch { 1 } else { usize::MAX };
        if special.converged
            && self.settings.refinement > 0.0
            && !self.refine(event, &mut special, from, rungs)
            && self.equations.system().approximation().is_some()
        {
            // Nothing is known of the discretisation's share: no digit is promised.
            special.converged = false;
            special.error = unknowns[self.equations.parameters_at()].abs();
        }
        if !special.converged {
            // Which grazing it is rests on the orbit at which it happens.
            special.subkind = None;
        }
        special
    }

    /// What the field calls a point of this event, from its solution and all parameters, if it is a
    /// grazing.
    pub fn subkind(&mut self, index: usize, (z, p): (&[f64], &[f64])) -> Option<String> {
        let event = &self.events[index];
        let (Kind::G, (Quantity::Monitor(monitor), _)) = (event.kind, event.test.level()?) else {
            return None;
        };
        let x = [&z[..self.equations.dimension()], p].concat();
        let system = self.equations.system();
        Some(system.events()?.name_of_limit(monitor, &x)?.into())
    }

    /// The number of unstable eigenvalues at a special point, without those that are critical
    /// there. Where a branch of periodic orbits begins, nothing is known of its stability.
    fn own_count(
        &mut self,
        critical: Critical,
        spectrum: &Spectrum,
        sides: (&Place, &Place),
    ) -> Option<usize> {
        sides.0.point.unstable.or(sides.1.point.unstable)?;
        let system = self.equations.system();
        let (dynamics, orientation) = (system.dynamics(), system.orientation());
        let distance = |l: &(f64, f64)| critical.distance(dynamics, l);
        let others = without_critical(spectrum, critical.count(), distance);
        Some(Stability::of(dynamics, &others).oriented(orientation).unstable)
    }

    /// Curves that belong to the solution assembled last.
    pub fn profiles(&mut self) -> Vec<Profile> {
        let at = self.equations.at();
        at.system.profiles(at.x)
    }

    /// A special point at the place loaded last, with its unknowns and tangent.
    pub fn special(
        &mut self,
        kind: Kind,
        event: &str,
        point: Point,
        spectrum: &[(f64, f64)],
        (unknowns, tangent): (&[f64], &[f64]),
    ) -> SpecialPoint {
        let (n, first) = (self.equations.dimension(), self.equations.parameters_at());
        SpecialPoint {
            parameters: point.parameters,
            monitors: point.monitors,
            unstable: point.unstable,
            eigenvalues: deciding(spectrum, SpecialPoint::EIGENVALUES),
            error: self.parameter_error(),
            bracket: [unknowns[first]; 2],
            state: unknowns[..n].to_vec(),
            tangent: [&tangent[..n], &tangent[first..]].concat(),
            mesh: self.equations.system().mesh(),
            ..SpecialPoint::new(kind, event)
        }
    }

    /// The tangent at a special point, which is left assembled, a share of the way from one place
    /// to another. At a branch point, where there are two or more, it is the one that goes on in
    /// the direction of the branch.
    fn tangent_between(
        &mut self,
        kind: Kind,
        unknowns: &[f64],
        [from, to]: [&Place; 2],
        share: f64,
    ) -> Result<Vec<f64>, Failure> {
        let parts = from.tangent.iter().zip(&to.tangent);
        let mut expected: Vec<f64> = parts.map(|(a, b)| (1.0 - share) * a + share * b).collect();
        self.rescale(&mut expected);
        let row = self.covector(&expected);
        self.equations.assemble(unknowns)?;
        if kind == Kind::BP && self.held.is_empty() {
            let crossing = self.tangents_at_crossing(unknowns, 1).unwrap_or_default();
            self.equations.assemble(unknowns)?;
            let cosine = |t: &Vec<f64>| dot(&row, t);
            let nearest =
                crossing.into_iter().max_by(|a, b| cosine(a).abs().total_cmp(&cosine(b).abs()));
            let Some(mut tangent) = nearest else { return Ok(expected) };
            let sign = cosine(&tangent).signum();
            tangent.iter_mut().for_each(|t| *t *= sign);
            return Ok(tangent);
        }
        let mut tangent = vec![0.0; unknowns.len()];
        self.equations.residual(unknowns, None, &mut tangent)?;
        let regular = self.equations.factor(Some(&row)).is_ok();
        if regular {
            self.tangent(&mut tangent);
        }
        Ok(if regular && dot(&row, &tangent) > 0.5 { tangent } else { expected })
    }
}

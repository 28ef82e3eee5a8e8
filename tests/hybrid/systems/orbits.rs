//! Hybrid orbits by both methods, from what closed forms know of them.

use super::dry_impact::{self, DryImpact};
use super::impact_oscillator::ClosedForm;
use super::reference::Reference;
use crate::common::ALL;
use crate::common::solved;
use std::f64::consts::{PI, TAU};
use tangency::core::bvp::{BoundarySystem, Collocation, IntoEquations, Mesh, Method, Shooting};
use tangency::core::continuation::{Branch, Continuation};
use tangency::core::hybrid::HybridSystem;
use tangency::core::linalg::Spectrum;
use tangency::core::ode::Scheme;
use tangency::core::orbit::{HybridOrbit, Itinerary};
use tangency::core::system::{Kind, System};

/// Closed forms are met to this, and so the methods agree to 1e-10.
pub const DIGITS: f64 = 5e-11;

/// First guesses are aside by this part.
pub const ASIDE: f64 = 1e-4;

/// An orbit about to be solved: its system by one method, unknowns near the solution, parameters.
pub struct Start {
    pub method: &'static str,
    pub system: Box<dyn System>,
    pub z: Vec<f64>,
    pub p: Vec<f64>,
}

/// The orbits of an itinerary by collocation and by shooting. Legs start at given states, where
/// trajectories begin that the methods' nodes are set on; the extra unknowns are the time of the
/// first leg's start, if the system is forced, and the durations of the legs.
pub fn by_both(
    hybrid: impl HybridSystem + Copy + 'static,
    itinerary: &str,
    starts: &[&[f64]],
    extras: &[f64],
    p: &[f64],
) -> [Start; 2] {
    let itinerary = Itinerary::read(itinerary, &hybrid).unwrap();
    let orbit = HybridOrbit::of(hybrid, itinerary).unwrap();
    let collocation = discretised(orbit.clone(), Collocation::new(7).unwrap(), 16);
    let shooting = Shooting::new(Scheme::DormandPrince8, 1e-13).unwrap();
    let shooting = discretised(orbit, shooting, 2);
    let z = [&collocation, &shooting].map(|s| s.flowed(&starts.concat(), extras, p).unwrap());
    let systems: [(&str, Box<dyn System>); 2] =
        [("collocation", Box::new(collocation)), ("shooting", Box::new(shooting))];
    let mut z = z.into_iter();
    systems.map(|(method, system)| Start { method, system, z: z.next().unwrap(), p: p.to_vec() })
}

/// The orbit of the impact oscillator without impacts, at a part of the amplitude at which it
/// grazes.
pub fn nonimpacting(form: &ClosedForm, part: f64) -> [Start; 2] {
    let amplitude = part * form.grazing();
    let p = [amplitude, form.frequency, form.restitution, form.damping, form.clearance];
    let state = form.motion(amplitude, 0.0).map(|x| x * (1.0 + ASIDE));
    by_both(Reference::ImpactOscillator, "flight", &[&state], &[], &p)
}

/// The orbit of the impact oscillator with one impact of speed `u` in a period.
pub fn impacting(form: &ClosedForm, u: f64) -> [Start; 2] {
    let p = [form.amplitude(u), form.frequency, form.restitution, form.damping, form.clearance];
    let state = [form.clearance, -form.restitution * u * (1.0 + ASIDE)];
    let extras = [form.time(u) * (1.0 + ASIDE), TAU / form.frequency];
    by_both(Reference::ImpactOscillator, "flight:impact", &[&state], &extras, &p)
}

/// The orbit of the mass that rests, is hit, moves up, down and rests again.
pub fn resting(stiffness: f64) -> [Start; 2] {
    let [_, friction, _, _, frequency, ..] = DryImpact::DEFAULTS;
    let mut p = DryImpact::DEFAULTS;
    p[0] = stiffness;
    let form = dry_impact::ClosedForm::new(p);
    let ([x, _], f, root) = (form.rest(), friction / stiffness, stiffness.sqrt());
    let (t, v) = (form.time(x), form.velocity(x));
    let (up, down) = ((v / root).atan2(x + f) / root, PI / root);
    let begins = t + up + down - TAU / frequency;
    let starts: [&[f64]; 3] = [&[x + ASIDE], &[x, v], &[(x + f).hypot(v / root) - f, 0.0]];
    let extras = [begins, t - begins, up, down];
    by_both(Reference::DryImpact, "stick:impact up:turn down:turn", &starts, &extras, &p)
}

fn discretised(
    problem: impl IntoEquations,
    method: impl Into<Method>,
    intervals: usize,
) -> BoundarySystem {
    let problem = problem.into_equations();
    let meshes = problem.segments().iter().map(|_| Mesh::uniform(intervals)).collect();
    BoundarySystem::new(problem, method, meshes).unwrap()
}

/// A solved orbit.
pub struct Solved {
    system: Box<dyn System>,
    x: Vec<f64>,
    /// Its multipliers, the largest first.
    pub multipliers: Spectrum,
}

impl Start {
    /// The solution at the start's parameters.
    pub fn solved(mut self) -> Solved {
        let x = solved(self.system.as_mut(), &self.z, &self.p)
            .unwrap_or_else(|error| panic!("{}: {error}", self.method));
        self.system.assemble(&x).unwrap();
        let multipliers = self.system.spectrum(&x, ALL).unwrap().unwrap();
        Solved { system: self.system, x, multipliers }
    }

    /// The continuation from the start, in a parameter.
    pub fn along(&mut self, parameter: &str, range: [f64; 2]) -> Continuation<'_> {
        let names = self.system.names().parameters.clone();
        let start = Continuation::new(self.system.as_mut()).named(self.method).from(&self.z);
        let start = names.iter().zip(&self.p).fold(start, |run, (name, p)| run.at(name, *p));
        start.along(parameter, range[0]..=range[1])
    }
}

impl Solved {
    /// The value of an unknown where its leg begins.
    pub fn first(&self, name: &str) -> f64 {
        let mut position = 0;
        for group in &self.system.names().unknowns {
            if group.name == name {
                return self.x[position];
            }
            position += group.length;
        }
        panic!("there is no unknown `{name}`: {:?}", self.system.names().unknowns)
    }

    /// The values of all monitors.
    pub fn monitor(&mut self, name: &str) -> f64 {
        let names = self.system.names().monitors.clone();
        let mut values = vec![0.0; names.len()];
        self.system.monitors(&self.x, 0, &mut values).unwrap();
        let position = names.iter().position(|known| known == name);
        values[position.unwrap_or_else(|| panic!("no monitor `{name}`: {names:?}"))]
    }
}

/// The special points of a branch but for its ends: kinds, and values of the continued parameter.
pub fn found(branch: &Branch) -> Vec<(Kind, f64)> {
    let column = branch.column(&branch.released[0]).unwrap();
    let inner = branch.special.iter().filter(|point| point.kind != Kind::EP);
    inner.map(|point| (point.kind, point.value(column).unwrap())).collect()
}

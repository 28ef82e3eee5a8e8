//! Filippov systems given as text.

use super::assembling::{Assembling, Program};
use super::basis::{Basis, Kind, Stated, program_of, states_of};
use super::duration::Duration;
use super::observed::Scalable;
use super::scope::Scope;
use super::source::{Fault, ModelError, Phrase, Source};
use super::statement::{FilippovEquations, Formulas};
use super::syntax::Declared;
use crate::core::hybrid::filippov::{
    Filippov, FilippovNames, FilippovSystem, Side, convex_combination, held_by_field,
};
use crate::core::hybrid::{HybridSystem, Scales};
use crate::core::problem::{Forcing, Measure, position};
use crate::core::scalar::Scalar;

/// A Filippov system given as text: two vector fields and the surface that separates them.
#[derive(Clone, Debug)]
pub struct TwoFields {
    basis: Basis,
    names: FilippovNames,
    /// The rates of the states above and below the surface.
    rates: [Program; 2],
    sliding: Option<Program>,
    surface: Program,
    /// Two functions that decide how long sliding lasts: a sliding motion does not leave the
    /// surface upwards while the first function is positive, and does not leave it downwards while
    /// the second function is positive.
    holds: [Option<Program>; 2],
}

/// Assembles the statement of a Filippov system, for a scene that gives values to some parameters.
pub(super) fn understood(
    source: &Source,
    statement: &FilippovEquations,
    given: &[String],
) -> Result<Filippov<TwoFields>, ModelError> {
    let (common, states) = (statement.common(), (&statement.above, "state"));
    let (mut basis, scope, above) = Basis::of_rates(source, common, states, given)?;
    Assembling::new(&scope).check_named()?;
    let field = |rates: &Formulas| {
        let rates = states_of(&basis, common, rates, "state")?;
        refuse_other_states(&basis, &rates)?;
        program_of(&scope, &rates)
    };
    let rates = [program_of(&scope, &above)?, field(&statement.below)?];
    let sliding = Some(&statement.sliding).filter(|rates| !rates.is_empty());
    let sliding = sliding.map(field).transpose()?;
    let surface = surface(statement, &scope)?;
    let names = names(source, &statement.names)?;
    let holds = holds(statement, &scope)?;
    let period = Duration::read(&scope, "the period", statement.period.as_ref())?;
    basis.finish(common, &[&scope], period, true)?;
    Ok(Filippov(TwoFields { basis, names, rates, sliding, surface, holds }))
}

impl Kind for Filippov<TwoFields> {
    fn basis(&self) -> &Basis {
        &self.0.basis
    }

    fn may_jump(&self) -> bool {
        let fields = self.0.rates.iter().chain(&self.0.sliding);
        fields.into_iter().any(|rates| rates.may_jump())
    }

    /// Checks that the surface and the rates have finite values; for a state on the surface, also
    /// checks the functions that decide whether the motion slides.
    fn undefined(&self, x: &[f64], p: &[f64]) -> Option<ModelError> {
        let TwoFields { basis, rates: [above, below], sliding, surface, holds, .. } = &self.0;
        let mode = self.initial_mode(Self::ABOVE, 0.0, x, p);
        let on_surface = surface.value(0.0, x, p) == 0.0 || mode == Self::SLIDING;
        let mut programs = vec![surface];
        match mode {
            _ if on_surface => {
                programs.extend(holds.iter().flatten().chain([above, below]).chain(sliding))
            }
            mode if mode == Self::ABOVE => programs.push(above),
            _ => programs.push(below),
        }
        programs.into_iter().find_map(|program| program.undefined(&basis.source, (0.0, x, p)))
    }
}

/// Returns an error unless a field has the same states, in the same order, as the field above the
/// surface.
fn refuse_other_states(basis: &Basis, own: &[Stated]) -> Result<(), ModelError> {
    let own = own.iter().flat_map(|it| it.elements.names().map(|name| (it.phrase.clone(), name)));
    let own: Vec<(Phrase, String)> = own.collect();
    let states = &basis.states;
    let differs = |k: &usize| own.get(*k).map(|own| &own.1) != states.get(*k);
    let Some(k) = (0..own.len().max(states.len())).find(differs) else { return Ok(()) };
    let place = own.get(k).or(own.last()).map_or(Phrase::default(), |(phrase, _)| phrase.clone());
    let name = |name: Option<&String>| name.map_or("none", String::as_str).to_string();
    let what = format!("state {} is {}", k + 1, name(own.get(k).map(|(_, name)| name)));
    let reason = format!(
        "in the field above the surface, the state at the same position is {}, but all fields must \
         have the same states in the same order",
        name(states.get(k))
    );
    Err(basis.source.fault_of(&place, Fault::Misplaced { what, reason }))
}

/// Returns the program that computes one formula.
fn program(scope: &Scope, formula: &Phrase) -> Result<Program, ModelError> {
    let mut assembling = Assembling::new(scope);
    let value = assembling.read(formula)?;
    Ok(assembling.program(vec![value]))
}

fn surface(statement: &FilippovEquations, scope: &Scope) -> Result<Program, ModelError> {
    let Some(surface) = &statement.surface else {
        let what = "the equations have no surface".into();
        let needed =
            "give the function that is positive above the surface, as in `surface: \"x\"`".into();
        return Err(scope.source.fault_of(&Phrase::default(), Fault::Missing { what, needed }));
    };
    program(scope, surface)
}

/// Returns the names of the modes and of the event; names that the statement does not give have
/// default values.
fn names(source: &Source, stated: &Formulas) -> Result<FilippovNames, ModelError> {
    let FilippovNames { above, below, sliding, surface } = FilippovNames::default();
    let known = ["above", "below", "sliding", "surface"];
    let mut names = [above, below, sliding, surface];
    let mut given = [false; 4];
    for (what, name) in stated {
        let k = position("mode or event", &what.text, known)
            .map_err(|unknown| source.fault_of(what, Fault::Unknown(unknown)))?;
        if std::mem::replace(&mut given[k], true) {
            return Err(source.twice(what, &what.text, "named"));
        }
        names[k] = Declared::plain(source, name)?;
    }
    // Events at which sliding ends have the names of the modes that follow.
    for (what, name) in stated {
        let own = known.iter().position(|known| *known == what.text);
        let others = names.iter().enumerate().filter(|(k, _)| Some(*k) != own);
        if others.into_iter().any(|(_, other)| *other == name.text) {
            return Err(source.twice(name, &name.text, "a mode or an event"));
        }
    }
    let [above, below, sliding, surface] = names;
    Ok(FilippovNames { above, below, sliding, surface })
}

/// Returns, for each side of the surface, a function: a sliding motion does not leave the surface
/// to this side while the function is positive; `None` if the statement does not contain the
/// function.
fn holds(statement: &FilippovEquations, scope: &Scope) -> Result<[Option<Program>; 2], ModelError> {
    let mut holds = [None, None];
    for (side, formula) in &statement.holds {
        let k = position("side", &side.text, ["above", "below"])
            .map_err(|unknown| scope.source.fault_of(side, Fault::Unknown(unknown)))?;
        if holds[k].replace(program(scope, formula)?).is_some() {
            return Err(scope.source.twice(side, &side.text, "held"));
        }
    }
    Ok(holds)
}

/// Returns the index of a side of the surface: 0 above, 1 below.
fn of(side: Side) -> usize {
    usize::from(side == Side::Below)
}

impl Scalable for Filippov<TwoFields> {
    fn basis_mut(&mut self) -> &mut Basis {
        &mut self.0.basis
    }
}

impl FilippovSystem for TwoFields {
    fn states(&self) -> Vec<String> {
        self.basis.states.clone()
    }

    fn parameters(&self) -> Vec<String> {
        self.basis.parameters.clone()
    }

    fn defaults(&self) -> Vec<f64> {
        self.basis.defaults.clone()
    }

    fn names(&self) -> FilippovNames {
        self.names.clone()
    }

    fn surface<T: Scalar>(&self, t: T, x: &[T], p: &[T]) -> T {
        self.surface.value(t, x, p)
    }

    #[inline]
    fn field<T: Scalar>(&self, side: Side, t: T, x: &[T], p: &[T], f: &mut [T]) {
        self.rates[of(side)].evaluate(t, x, p, f);
    }

    fn sliding<T: Scalar>(&self, t: T, x: &[T], p: &[T], f: &mut [T]) {
        match &self.sliding {
            Some(rates) => rates.evaluate(t, x, p, f),
            None => convex_combination(self, t, x, p, f),
        }
    }

    fn holds<T: Scalar>(&self, side: Side, t: T, x: &[T], p: &[T]) -> T {
        match &self.holds[of(side)] {
            Some(function) => function.value(t, x, p),
            None => held_by_field(self, side, t, x, p),
        }
    }

    fn forcing(&self) -> Forcing {
        self.basis.duration.forcing()
    }

    fn period<T: Scalar>(&self, p: &[T]) -> T {
        self.basis.duration.value(p)
    }

    fn scales(&self, _p: &[f64]) -> Scales {
        self.basis.scales.clone()
    }

    fn monitors(&self) -> Vec<String> {
        self.basis.monitor_names()
    }

    fn monitor<T: Scalar>(&self, monitor: usize, t: T, x: &[T], p: &[T]) -> T {
        self.basis.monitor(monitor, 0, t, x, p)
    }

    fn measures(&self) -> Vec<(String, Measure)> {
        self.basis.measures.clone()
    }
}

//! Filippov systems that are given as text.

use super::assembling::Assembling;
use super::basis::{
    Basis, States, measures, monitors_of, plain, scales_of, states_of, undefined,
    undefined_formula, values_of,
};
use super::hybrid::scales;
use super::period::Period;
use super::scope::Scope;
use super::source::{Fault, ModelError, Phrase, Source};
use super::statement::{FilippovEquations, Formulas};
use super::tape::Tape;
use crate::core::hybrid::Scales;
use crate::core::hybrid::filippov::{
    Filippov, FilippovNames, FilippovSystem, Side, convex_combination, held_by_field,
};
use crate::core::problem::{Forcing, Measure, position};
use crate::core::scalar::Scalar;

/// Two fields and a surface that are given as text.
#[derive(Clone, Debug)]
pub struct TwoFields {
    pub(super) basis: Basis,
    statement: FilippovEquations,
    states: Vec<String>,
    names: FilippovNames,
    /// Above and below.
    rates: [Tape; 2],
    sliding: Option<Tape>,
    surface: Tape,
    /// Against leaving upwards and downwards.
    holds: [Option<Tape>; 2],
    period: Period,
    monitor_names: Vec<String>,
    monitors: Vec<Tape>,
    measures: Vec<(String, Measure)>,
    scales: Scales,
    aperiodic: bool,
}

impl TwoFields {
    /// Understands a statement, for a scene that gives some parameters.
    pub(super) fn new(
        source: &Source,
        statement: FilippovEquations,
        given: &[String],
    ) -> Result<Self, ModelError> {
        let common = statement.common();
        let mut basis = Basis::of(source, common, given)?;
        let (states, _) = states_of(&basis, common, &statement.above, "state")?;
        let scope = basis.scope(common, &states)?;
        basis.begin(common, &scope)?;
        Assembling::new(&scope).check_named()?;
        let field = |rates: &Formulas| field(&basis, &statement, &scope, &states, rates);
        let rates = [field(&statement.above)?, field(&statement.below)?];
        let sliding = Some(&statement.sliding).filter(|rates| !rates.is_empty());
        let sliding = sliding.map(field).transpose()?;
        let surface = surface(&statement, &scope)?;
        let names = names(source, &statement.names)?;
        let holds = holds(&statement, &scope)?;
        let period = Period::read(&scope, statement.period.as_ref())?;
        let (monitor_names, monitors): (Vec<String>, Vec<Tape>) =
            monitors_of(&scope, &statement.monitors)?.into_iter().unzip();
        basis.look_for_unused(&[&scope]);
        let states: Vec<String> = states.into_iter().map(|(_, name)| name).collect();
        let scales = scales(&scales_of(source, &statement.scales, &states, true)?);
        let aperiodic = period.is_none() && scope.uses("t");
        let measures = measures(&states, monitor_names.clone());
        Ok(TwoFields {
            basis,
            statement,
            states,
            names,
            rates,
            sliding,
            surface,
            holds,
            period,
            monitor_names,
            monitors,
            measures,
            scales,
            aperiodic,
        })
    }

    /// Whether time enters, but not with a period: there are no periodic orbits then.
    pub fn is_aperiodic(&self) -> bool {
        self.aperiodic
    }

    /// The error of a period that is not positive for some parameters.
    pub(super) fn refused_duration(&self, p: &[f64]) -> Option<ModelError> {
        self.period.refused(&self.basis.source, p)
    }

    /// The formula that has no finite value where motion begins in a mode, if one has none: the
    /// surface, the rates, and on the surface all that decides there.
    pub(super) fn undefined(
        &self,
        mode: usize,
        (t, x, p): (f64, &[f64], &[f64]),
    ) -> Option<ModelError> {
        let FilippovEquations { above, below, sliding, surface, holds, .. } = &self.statement;
        let (common, at) = (self.statement.common(), (t, x, p));
        let of_fields = |fields: &[&Formulas]| {
            fields.iter().find_map(|rates| undefined(&self.basis, common, rates, at))
        };
        let of_formula = |formula| undefined_formula(&self.basis, common, (above, formula), at);
        let on_surface = self.surface.value(t, x, p) == 0.0 || mode == Filippov::<Self>::SLIDING;
        surface.as_ref().and_then(of_formula).or_else(|| match mode {
            _ if on_surface => holds
                .iter()
                .find_map(|(_, formula)| of_formula(formula))
                .or_else(|| of_fields(&[above, below]))
                .or_else(|| of_fields(&[sliding]).filter(|_| !sliding.is_empty())),
            Filippov::<Self>::ABOVE => of_fields(&[above]),
            _ => of_fields(&[below]),
        })
    }
}

/// The rates of a field, which must be those of the states above, in their order.
fn field(
    basis: &Basis,
    statement: &FilippovEquations,
    scope: &Scope,
    states: &States,
    rates: &Formulas,
) -> Result<Tape, ModelError> {
    let (own, formulas) = states_of(basis, statement.common(), rates, "state")?;
    let differs = |k: &usize| own.get(*k).map(|own| &own.1) != states.get(*k).map(|s| &s.1);
    if let Some(k) = (0..own.len().max(states.len())).find(differs) {
        let place =
            own.get(k).or(own.last()).map_or(Phrase::default(), |(phrase, _)| phrase.clone());
        let name = |all: &States| all.get(k).map_or("none", |(_, name)| name.as_str()).to_string();
        let (what, reason) = (
            format!("state {} is {}", k + 1, name(&own)),
            format!("above it is {}: all fields have the same states, in one order", name(states)),
        );
        return Err(basis.source.fault_of(&place, Fault::Misplaced { what, reason }));
    }
    let mut assembling = Assembling::new(scope);
    let values = values_of(&mut assembling, &formulas)?;
    Ok(assembling.tape(&values))
}

fn surface(statement: &FilippovEquations, scope: &Scope) -> Result<Tape, ModelError> {
    let Some(surface) = &statement.surface else {
        let what = "the equations have no surface".into();
        let needed = "give the function that is positive above it, as in `surface: \"x\"`".into();
        return Err(scope.source.fault_of(&Phrase::default(), Fault::Missing { what, needed }));
    };
    let mut assembling = Assembling::new(scope);
    let value = assembling.read(surface)?;
    Ok(assembling.tape(&[value]))
}

/// The names of modes and of the event, some of which are stated.
fn names(source: &Source, stated: &Formulas) -> Result<FilippovNames, ModelError> {
    let FilippovNames { above, below, sliding, surface } = FilippovNames::default();
    let known = ["above", "below", "sliding", "surface"];
    let mut names = [above, below, sliding, surface];
    let mut given = [false; 4];
    for (what, name) in stated {
        let k = position("mode or event", &what.text, known)
            .map_err(|unknown| source.fault_of(what, Fault::Unknown(unknown)))?;
        if std::mem::replace(&mut given[k], true) {
            let fault = Fault::Twice { name: what.text.clone(), first: "named" };
            return Err(source.fault_of(what, fault));
        }
        names[k] = plain(source, name)?;
    }
    // Events at which sliding ends have the names of the modes that follow.
    for (what, name) in stated {
        let own = known.iter().position(|known| *known == what.text);
        let others = names.iter().enumerate().filter(|(k, _)| Some(*k) != own);
        if others.into_iter().any(|(_, other)| *other == name.text) {
            let fault = Fault::Twice { name: name.text.clone(), first: "a mode or an event" };
            return Err(source.fault_of(name, fault));
        }
    }
    let [above, below, sliding, surface] = names;
    Ok(FilippovNames { above, below, sliding, surface })
}

/// The functions that are positive while sliding is held against leaving to each side, where they
/// are stated.
fn holds(statement: &FilippovEquations, scope: &Scope) -> Result<[Option<Tape>; 2], ModelError> {
    let mut holds = [None, None];
    for (side, formula) in &statement.holds {
        let k = position("side", &side.text, ["above", "below"])
            .map_err(|unknown| scope.source.fault_of(side, Fault::Unknown(unknown)))?;
        let mut assembling = Assembling::new(scope);
        let value = assembling.read(formula)?;
        if holds[k].replace(assembling.tape(&[value])).is_some() {
            let fault = Fault::Twice { name: side.text.clone(), first: "held" };
            return Err(scope.source.fault_of(side, fault));
        }
    }
    Ok(holds)
}

/// The position of what belongs to a side.
fn of(side: Side) -> usize {
    usize::from(side == Side::Below)
}

impl FilippovSystem for TwoFields {
    fn states(&self) -> Vec<String> {
        self.states.clone()
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
        self.period.forcing()
    }

    fn period<T: Scalar>(&self, p: &[T]) -> T {
        self.period.value(p)
    }

    fn scales(&self, _p: &[f64]) -> Scales {
        self.scales.clone()
    }

    fn monitors(&self) -> Vec<String> {
        self.monitor_names.clone()
    }

    fn monitor<T: Scalar>(&self, monitor: usize, t: T, x: &[T], p: &[T]) -> T {
        self.monitors[monitor].value(t, x, p)
    }

    fn measures(&self) -> Vec<(String, Measure)> {
        self.measures.clone()
    }
}

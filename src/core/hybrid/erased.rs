//! An object-safe trait that represents all hybrid systems.
//!
//! Users implement [`HybridSystem`] generically for all scalar types. Simulation, orbits and local
//! maps call a hybrid system through [`HybridEquations`], one scalar type at a time, and are
//! therefore compiled once for all systems.

use super::system::{Guard, HybridSystem, Mode, Passage, Scales};
use super::tangency::Tangency;
use crate::core::failure::OutOfDomain;
use crate::core::problem::{
    Domains, FieldRef, Fields, Forcing, Measure, Observable, UnknownName, Wide, WideFields,
    distinct, erased, position,
};
use crate::core::scalar::{
    Avx2, Avx512, Baseline, Chunk, DualLanes, Jet, LaneWidth, Lanes, Narrow, Registered, Scalar,
    in_registers,
};
use num_dual::{Dual, Dual2, Dual2_64, Dual64};

/// A scalar type in which the fields of every hybrid system can be evaluated.
pub trait FieldNumber: Scalar {
    /// Returns the fields of a system, evaluated in this scalar type.
    fn fields(system: &dyn HybridEquations) -> &dyn Fields<Self>;

    /// Returns the fields with derivatives if implicit schemes are supported in this scalar type;
    /// otherwise `None`.
    fn wide(_system: &dyn HybridEquations) -> Option<&dyn Fields<Wide<Self>>> {
        None
    }

    /// Returns the vector field of a mode as a function of the time since `start`.
    fn in_mode(system: &dyn HybridEquations, mode: usize, start: Self) -> FieldRef<'_, Self> {
        let (fields, wide) = (Self::fields(system), Self::wide(system));
        FieldRef {
            fields,
            wide,
            real: system,
            index: mode,
            start,
            numbers: usize::MAX,
            attraction: None,
            pace: None,
        }
    }
}

/// A scalar type in which the guards of every hybrid system can be evaluated.
pub trait GuardNumber: Scalar {
    /// Returns the guards of the system, evaluated in this scalar type.
    fn guards(system: &dyn HybridEquations) -> &dyn Guards<Self>;
}

/// A scalar type in which events of every hybrid system can be evaluated.
pub trait EventNumber: FieldNumber + GuardNumber {
    /// Returns the resets of the system, evaluated in this scalar type.
    fn resets(system: &dyn HybridEquations) -> &dyn Resets<Self>;
}

/// A scalar type in which the measures of every hybrid system can be evaluated.
pub trait MeasureNumber: Scalar {
    /// Returns the measures of the system, evaluated in this scalar type.
    fn measures(system: &dyn HybridEquations) -> &dyn Measures<Self>;
}

erased! {
    /// The guards of a hybrid system, evaluated in one scalar type.
    pub trait Guards<T> of HybridSystem by GuardNumber::guards of HybridEquations {
        /// Computes the value of a guard in a mode; the guard is positive while the mode lasts.
        fn guard as guard_in(guard: usize, mode: usize, t: T, x: &[T], p: &[T]) -> T;
    }
}

erased! {
    /// The resets and the forcing period of a hybrid system, evaluated in one scalar type.
    pub trait Resets<T> of HybridSystem by EventNumber::resets of HybridEquations {
        /// Computes the state `after` an event that leads from one mode to another, `(mode, next)`.
        fn reset as reset_in(
            guard: usize, modes: (usize, usize), t: T, x: &[T], p: &[T], after: &mut [T]
        ) -> ();
        /// Returns the period of a periodic forcing.
        fn period as period_in(p: &[T]) -> T;
    }
}

erased! {
    /// The measures, monitors and decision functions of a hybrid system, evaluated in one scalar
    /// type.
    pub trait Measures<T> of HybridSystem by MeasureNumber::measures of HybridEquations {
        /// Computes the measure with this index from the legs of a cycle, which lasts one or
        /// several forcing periods.
        fn measure as measure_in(
            position: usize, legs: &[Passage<T>], periods: usize, p: &[T]
        ) -> T;
        /// Computes the value of a monitor in a mode.
        fn monitor as monitor_in(monitor: usize, mode: usize, t: T, x: &[T], p: &[T]) -> T;
        /// Computes the decision function, which selects one of the possible modes after an event.
        fn decision as decision_in(
            position: usize, guard: usize, mode: usize, t: T, x: &[T], p: &[T]
        ) -> T;
    }
}

erased! {
    /// The methods of a hybrid system, in each scalar type that generic code needs.
    pub trait InScalars;

    impl FieldNumber by WideFields for [
        f64, Dual64, Narrow, Chunk, Dual<Chunk>, Dual2<Chunk>
    ] {
        fn fields(system: &dyn HybridEquations) -> &dyn Fields<Self> { system }
        fn wide(system: &dyn HybridEquations) -> Option<&dyn Fields<Wide<Self>>> { Some(system) }
    }
    impl FieldNumber by Fields for [
        Lanes<Baseline>, Lanes<Avx2>, Lanes<Avx512>,
        DualLanes<Baseline>, DualLanes<Avx2>, DualLanes<Avx512>,
        Jet<128>, Jet<1024>, Dual<Jet<128>>, Dual<Jet<1024>>
    ] {
        fn fields(system: &dyn HybridEquations) -> &dyn Fields<Self> { system }
    }
    impl GuardNumber by Guards for [
        f64, Dual64, Narrow, Chunk, Dual<Chunk>, Dual2<Chunk>,
        Dual2_64, Dual<Dual64>, Dual2<Dual64>, Dual<Narrow>, Dual2<Narrow>,
        Dual<Dual2<Chunk>>, Dual<Dual<Chunk>>, Dual2<Dual<Chunk>>,
        DualLanes<Baseline>, DualLanes<Avx2>, DualLanes<Avx512>,
        Jet<128>, Jet<1024>, Dual<Jet<128>>, Dual<Jet<1024>>,
        Dual<Dual<Jet<128>>>, Dual<Dual<Jet<1024>>>
    ] {
        fn guards(system: &dyn HybridEquations) -> &dyn Guards<Self> { system }
    }
    impl EventNumber by Resets for [
        f64, Dual64, Narrow, Chunk, Dual<Chunk>, Dual2<Chunk>,
        Jet<128>, Jet<1024>
    ] {
        fn resets(system: &dyn HybridEquations) -> &dyn Resets<Self> { system }
    }
    impl MeasureNumber by Measures for [f64, Dual64, Dual2_64, Chunk] {
        fn measures(system: &dyn HybridEquations) -> &dyn Measures<Self> { system }
    }
}

erased! {
    /// A hybrid system in the scalar types that simulation, orbits and local maps need. Every
    /// [`HybridSystem`] implements this trait; the methods are documented at [`HybridSystem`].
    pub trait HybridEquations: InScalars of HybridSystem {
        fn modes() -> Vec<Mode>;
        fn guards() -> Vec<Guard>;
        fn parameters() -> Vec<String>;
        fn defaults() -> Vec<f64>;
        fn initial_mode(mode: usize, t: f64, x: &[f64], p: &[f64]) -> usize;
        fn domain_at_ends(mode: usize, t: f64, x: &[f64], p: &[f64]) -> Result<(), OutOfDomain>;
        fn may_follow(guard: usize, mode: usize) -> Vec<usize>;
        fn next_mode(guard: usize, mode: usize, t: f64, x: &[f64], p: &[f64]) -> usize;
        fn mode_after_accumulation(
            guard: usize, mode: usize, t: f64, x: &[f64], p: &[f64]
        ) -> Option<usize>;
        fn kind_of_tangency(
            tangency: Tangency, t: f64, x: &[f64], p: &[f64]
        ) -> Option<&'static str>;
        fn in_lanes() -> Option<LaneWidth>;
        fn forcing() -> Forcing;
        fn scales(p: &[f64]) -> Scales;
        fn monitors() -> Vec<String>;
        fn measures() -> Vec<(String, Measure)>;
        fn cumulative_states() -> Vec<String>;
    }
}

impl dyn HybridEquations + '_ {
    /// Computes the vector field of a mode and writes it into `f`.
    pub fn field<T: FieldNumber>(&self, mode: usize, t: T, x: &[T], p: &[T], f: &mut [T]) {
        T::fields(self).field_of(mode, t, x, p, f);
    }

    /// Returns the typical size of each state of a mode.
    pub(crate) fn sizes_of(&self, mode: usize, p: &[f64]) -> Vec<f64> {
        let mut sizes = self.scales_of(mode, p);
        sizes.resize(self.states_of(mode).len(), 1.0);
        sizes
    }

    /// Computes the value of an observable, which is a state or a monitor, in a mode.
    pub fn observe<T: MeasureNumber>(
        &self,
        observable: Observable,
        mode: usize,
        t: T,
        x: &[T],
        p: &[T],
    ) -> T {
        match observable {
            Observable::State(i) => x[i],
            Observable::Function(monitor) => self.monitor(monitor, mode, t, x, p),
        }
    }

    /// Returns an error if a measure refers to a scalar that the system does not have.
    pub(crate) fn check_measures(&self) -> Result<(), UnknownName> {
        let (modes, monitors) = (self.modes(), self.monitors());
        let scalars = distinct(modes.iter().flat_map(|mode| &mode.states).chain(&monitors));
        for (name, measure) in self.measures() {
            let what = format!("monitor or state in the measure `{name}`");
            for scalar in measure.scalars() {
                position(&what, scalar, &scalars)?;
            }
        }
        Ok(())
    }

    /// Returns the scalar with this name in each of the system's modes: a state of the mode, or a
    /// monitor; `None` in modes without the scalar.
    pub fn scalars(&self, modes: &[Mode], name: &str) -> Vec<Option<Observable>> {
        let position = |names: &[String]| names.iter().position(|known| known == name);
        let monitor = position(&self.monitors()).map(Observable::Function);
        let of = |mode: &Mode| position(&mode.states).map(Observable::State).or(monitor);
        modes.iter().map(of).collect()
    }
}

impl<H: HybridSystem> Domains for H {
    fn domain_of(&self, mode: usize, x: &[f64], p: &[f64]) -> Result<(), OutOfDomain> {
        self.domain(mode, x, p)
    }

    fn states_of(&self, mode: usize) -> Vec<String> {
        HybridSystem::modes(self).swap_remove(mode).states
    }

    fn scales_of(&self, mode: usize, p: &[f64]) -> Vec<f64> {
        let scales = self.scales(p);
        if scales.states.is_empty() {
            return Vec::new();
        }
        self.states_of(mode).iter().map(|state| scales.of(state)).collect()
    }
}

impl<H: HybridSystem, T: Registered> Fields<T> for H {
    #[inline]
    fn field_of(&self, mode: usize, t: T, x: &[T], p: &[T], f: &mut [T]) {
        in_registers::<T, _>(
            #[inline(always)]
            || self.field(mode, t, x, p, f),
        );
    }

    fn constrain_of(&self, mode: usize, t: T, x: &mut [T], p: &[T]) {
        self.constrain(mode, t, x, p);
    }
}

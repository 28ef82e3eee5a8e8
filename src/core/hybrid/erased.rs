//! Hybrid systems behind one object-safe face.
//!
//! Users write a [`HybridSystem`] generically. Simulation, orbits and local maps see it through
//! [`HybridEquations`], one scalar at a time, so that they are compiled once and not for every system.

use super::passage::Passage;
use super::scales::{Scales, state_scales};
use super::system::{Guard, HybridSystem, Mode};
use crate::core::chunk::{Chunk, Narrow};
use crate::core::field::Forcing;
use crate::core::flow::Lanes;
use crate::core::jet::Jet;
use crate::core::measure::Measure;
use crate::core::scalar::Scalar;
use crate::core::scalar_field::{Domains, FieldRef, Fields, RealFields, Wide};
use crate::core::watch::Observable;
use crate::core::zero::LeftDomain;
use num_dual::{Dual, Dual2, Dual2_64, Dual64, HyperDual64, HyperHyperDual64};

/// The guards of a system in one scalar.
pub trait Guards<T> {
    /// A guard in a mode, positive while the mode lasts.
    fn guard_in(&self, guard: usize, mode: usize, t: T, x: &[T], p: &[T]) -> T;
}

/// The resets and the forcing of a system in one scalar.
pub trait Resets<T> {
    /// The state just after an event between modes `(mode, next)`, written into `after`.
    fn reset_in(
        &self,
        guard: usize,
        modes: (usize, usize),
        t: T,
        x: &[T],
        p: &[T],
        after: &mut [T],
    );

    /// The period of a periodic forcing.
    fn period_in(&self, p: &[T]) -> T;
}

/// The measures of a system's cycles, and its monitors, in one scalar.
pub trait Measures<T> {
    /// The number at a position, from the legs of a cycle of several periods.
    fn measure_in(&self, position: usize, legs: &[Passage<T>], periods: usize, p: &[T]) -> T;

    /// A monitor in a mode.
    fn monitor_in(&self, monitor: usize, mode: usize, t: T, x: &[T], p: &[T]) -> T;
}

/// Declares [`HybridEquations`] with the scalars in which fields, guards, resets and measures are evaluated,
/// and the traits by which generic code selects a scalar.
macro_rules! scalars {
    (
        wide: $($wide:ty)*;
        explicit: $($explicit:ty)*;
        only_wide: $($only_wide:ty)*;
        guards: $($guards:ty)*;
        resets: $($resets:ty)*;
        measures: $($measures:ty)*;
    ) => {
        /// A hybrid system in the scalars that simulation, orbits and local maps need. Every
        /// [`HybridSystem`] is one; its documentation says what each method means.
        pub trait HybridEquations:
            $(Fields<$wide> +)* $(Fields<$explicit> +)* $(Fields<$only_wide> +)*
            $(Guards<$guards> +)* $(Resets<$resets> +)* $(Measures<$measures> +)*
            RealFields + Send + Sync
        {
            /// The modes, with the names of their states.
            fn modes(&self) -> Vec<Mode>;
            /// The guards of all modes.
            fn guards(&self) -> Vec<Guard>;
            /// The names of the parameters.
            fn parameters(&self) -> Vec<String>;
            /// Default values of all parameters, if the system states them.
            fn defaults(&self) -> Vec<f64>;
            /// The mode that follows an event.
            fn next_mode(&self, guard: usize, mode: usize, t: f64, x: &[f64], p: &[f64]) -> usize;
            /// The mode in which motion goes on where the events of a guard accumulate.
            fn mode_after_accumulation(
                &self,
                guard: usize,
                mode: usize,
                t: f64,
                x: &[f64],
                p: &[f64],
            ) -> Option<usize>;
            /// Whether fields and guards may be evaluated in lanes.
            fn in_lanes(&self) -> bool;
            /// The forcing.
            fn forcing(&self) -> Forcing;
            /// Typical sizes of times and states.
            fn scales(&self, p: &[f64]) -> Scales;
            /// The names of the monitors.
            fn monitors(&self) -> Vec<String>;
            /// What is recorded along a branch of orbits, by name.
            fn measures(&self) -> Vec<(String, Measure)>;
            /// The names of states that count from the start of every mode.
            fn cumulative_states(&self) -> Vec<String>;
        }

        $(impl FieldNumber for $wide {
            fn fields<'a>(system: &'a (dyn HybridEquations + 'a)) -> &'a (dyn Fields<Self> + 'a) {
                system
            }
            fn wide<'a>(
                system: &'a (dyn HybridEquations + 'a),
            ) -> Option<&'a (dyn Fields<Wide<Self>> + 'a)> {
                Some(system)
            }
        })*
        $(impl FieldNumber for $explicit {
            fn fields<'a>(system: &'a (dyn HybridEquations + 'a)) -> &'a (dyn Fields<Self> + 'a) {
                system
            }
        })*
        $(impl GuardNumber for $guards {
            fn guards<'a>(system: &'a (dyn HybridEquations + 'a)) -> &'a (dyn Guards<Self> + 'a) {
                system
            }
        })*
        $(impl EventNumber for $resets {
            fn resets<'a>(system: &'a (dyn HybridEquations + 'a)) -> &'a (dyn Resets<Self> + 'a) {
                system
            }
        })*
        $(impl MeasureNumber for $measures {
            fn measures<'a>(
                system: &'a (dyn HybridEquations + 'a),
            ) -> &'a (dyn Measures<Self> + 'a) {
                system
            }
        })*
    };
}

/// A scalar in which the fields of any hybrid system can be evaluated.
pub trait FieldNumber: Scalar {
    /// The fields of a system in this scalar.
    fn fields<'a>(system: &'a (dyn HybridEquations + 'a)) -> &'a (dyn Fields<Self> + 'a);

    /// The fields with derivatives, if implicit schemes are supported in this scalar.
    fn wide<'a>(
        _system: &'a (dyn HybridEquations + 'a),
    ) -> Option<&'a (dyn Fields<Wide<Self>> + 'a)> {
        None
    }

    /// The field of a mode, whose own time begins at `start`.
    fn in_mode<'a>(
        system: &'a (dyn HybridEquations + 'a),
        mode: usize,
        start: Self,
    ) -> FieldRef<'a, Self> {
        let real: &dyn RealFields = system;
        FieldRef {
            fields: Self::fields(system),
            wide: Self::wide(system),
            real,
            index: mode,
            start,
            numbers: usize::MAX,
        }
    }
}

/// A scalar in which the guards of any hybrid system can be evaluated.
pub trait GuardNumber: Scalar {
    /// The guards of a system in this scalar.
    fn guards<'a>(system: &'a (dyn HybridEquations + 'a)) -> &'a (dyn Guards<Self> + 'a);
}

/// A scalar in which events of any hybrid system can be evaluated.
pub trait EventNumber: FieldNumber + GuardNumber {
    /// Resets and forcing of a system in this scalar.
    fn resets<'a>(system: &'a (dyn HybridEquations + 'a)) -> &'a (dyn Resets<Self> + 'a);
}

/// A scalar in which the measures of any hybrid system can be evaluated.
pub trait MeasureNumber: Scalar {
    /// The measures of a system in this scalar.
    fn measures<'a>(system: &'a (dyn HybridEquations + 'a)) -> &'a (dyn Measures<Self> + 'a);
}

scalars! {
    wide: f64 Dual64 HyperDual64 HyperHyperDual64 Narrow Chunk Dual<Chunk> Dual2<Chunk>;
    explicit: Lanes Dual<Lanes>
        Jet<16> Jet<64> Jet<256> Jet<1024>
        Dual<Jet<16>> Dual<Jet<64>> Dual<Jet<256>> Dual<Jet<1024>>;
    // Of the wide scalars, `Wide<f64>` is `Narrow`.
    only_wide: Wide<Dual64> Wide<HyperDual64> Wide<HyperHyperDual64> Wide<Narrow> Wide<Chunk>
        Wide<Dual<Chunk>> Wide<Dual2<Chunk>>;
    guards: f64 Dual64 HyperDual64 HyperHyperDual64 Narrow Chunk Dual<Chunk> Dual2<Chunk>
        Dual2_64 Dual<Dual64> Dual2<Dual64> Dual<Narrow> Dual2<Narrow>
        Dual<Dual<Chunk>> Dual2<Dual<Chunk>> Dual<Lanes>
        Jet<16> Jet<64> Jet<256> Jet<1024>
        Dual<Jet<16>> Dual<Jet<64>> Dual<Jet<256>> Dual<Jet<1024>>
        Dual<Dual<Jet<16>>> Dual<Dual<Jet<64>>> Dual<Dual<Jet<256>>> Dual<Dual<Jet<1024>>>;
    resets: f64 Dual64 HyperDual64 HyperHyperDual64 Narrow Chunk Dual<Chunk> Dual2<Chunk>
        Jet<16> Jet<64> Jet<256> Jet<1024>;
    measures: f64 Dual64 Dual2_64 Chunk;
}

/// What a [`HybridSystem`] evaluates, in any of the scalars listed.
impl dyn HybridEquations + '_ {
    /// The field of a mode, written into `f`.
    pub fn field<T: FieldNumber>(&self, mode: usize, t: T, x: &[T], p: &[T], f: &mut [T]) {
        T::fields(self).field_of(mode, t, x, p, f);
    }

    /// A guard in a mode.
    pub fn guard<T: GuardNumber>(&self, guard: usize, mode: usize, t: T, x: &[T], p: &[T]) -> T {
        T::guards(self).guard_in(guard, mode, t, x, p)
    }

    /// The state just after an event, written into `after`.
    pub fn reset<T: EventNumber>(
        &self,
        guard: usize,
        modes: (usize, usize),
        t: T,
        x: &[T],
        p: &[T],
        after: &mut [T],
    ) {
        T::resets(self).reset_in(guard, modes, t, x, p, after);
    }

    /// The period of a periodic forcing.
    pub fn period<T: EventNumber>(&self, p: &[T]) -> T {
        T::resets(self).period_in(p)
    }

    /// A measure of a cycle.
    pub fn measure<T: MeasureNumber>(
        &self,
        position: usize,
        legs: &[Passage<T>],
        periods: usize,
        p: &[T],
    ) -> T {
        T::measures(self).measure_in(position, legs, periods, p)
    }

    /// A state or a monitor in a mode.
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
            Observable::Function(monitor) => T::measures(self).monitor_in(monitor, mode, t, x, p),
        }
    }

    /// The scalar of a name in each of the system's modes: a state of the mode, or a monitor.
    pub fn scalars(&self, modes: &[Mode], name: &str) -> Vec<Option<Observable>> {
        let position = |names: &[String]| names.iter().position(|known| known == name);
        let monitor = position(&self.monitors()).map(Observable::Function);
        let of = |mode: &Mode| position(&mode.states).map(Observable::State).or(monitor);
        modes.iter().map(of).collect()
    }
}

impl<H: HybridSystem> Domains for H {
    fn domain_of(&self, mode: usize, x: &[f64], p: &[f64]) -> Result<(), LeftDomain> {
        self.domain(mode, x, p)
    }

    fn states_of(&self, mode: usize) -> Vec<String> {
        HybridSystem::modes(self).swap_remove(mode).states
    }

    fn scales_of(&self, mode: usize, p: &[f64]) -> Vec<f64> {
        state_scales(self, mode, p)
    }
}

impl<H: HybridSystem, T: Scalar> Fields<T> for H {
    #[inline]
    fn field_of(&self, mode: usize, t: T, x: &[T], p: &[T], f: &mut [T]) {
        self.field(mode, t, x, p, f);
    }
}

impl<H: HybridSystem, T: Scalar> Guards<T> for H {
    fn guard_in(&self, guard: usize, mode: usize, t: T, x: &[T], p: &[T]) -> T {
        self.guard(guard, mode, t, x, p)
    }
}

impl<H: HybridSystem, T: Scalar> Resets<T> for H {
    fn reset_in(
        &self,
        guard: usize,
        modes: (usize, usize),
        t: T,
        x: &[T],
        p: &[T],
        after: &mut [T],
    ) {
        self.reset(guard, modes, t, x, p, after);
    }

    fn period_in(&self, p: &[T]) -> T {
        self.period(p)
    }
}

impl<H: HybridSystem, T: Scalar> Measures<T> for H {
    fn measure_in(&self, position: usize, legs: &[Passage<T>], periods: usize, p: &[T]) -> T {
        self.measure(position, legs, periods, p)
    }

    fn monitor_in(&self, monitor: usize, mode: usize, t: T, x: &[T], p: &[T]) -> T {
        self.monitor(monitor, mode, t, x, p)
    }
}

/// Forwards methods that are no different behind the object-safe face.
macro_rules! forward {
    ($($name:ident($($argument:ident: $type:ty),*) -> $result:ty;)*) => {
        $(fn $name(&self, $($argument: $type),*) -> $result {
            HybridSystem::$name(self, $($argument),*)
        })*
    };
}

impl<H: HybridSystem> HybridEquations for H {
    forward! {
        modes() -> Vec<Mode>;
        guards() -> Vec<Guard>;
        parameters() -> Vec<String>;
        defaults() -> Vec<f64>;
        next_mode(guard: usize, mode: usize, t: f64, x: &[f64], p: &[f64]) -> usize;
        mode_after_accumulation(
            guard: usize, mode: usize, t: f64, x: &[f64], p: &[f64]
        ) -> Option<usize>;
        in_lanes() -> bool;
        forcing() -> Forcing;
        scales(p: &[f64]) -> Scales;
        monitors() -> Vec<String>;
        measures() -> Vec<(String, Measure)>;
        cumulative_states() -> Vec<String>;
    }
}

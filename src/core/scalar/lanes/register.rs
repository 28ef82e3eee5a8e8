//! Vector registers, selected at run time.
//!
//! A program is compiled for every processor of its target, and can therefore use only the
//! narrowest registers by default. Each wider kind of registers has its own number types. Code that
//! uses the number types of wider registers is called through [`in_registers`], and is compiled
//! with the instructions of these registers; such number types are used only on processors that
//! have the registers.

use self::target::{Middle, Narrow, Wide, middle, narrow, wide};
#[cfg(feature = "scene")]
use super::DualLanes;
use super::Lanes;
use crate::core::scalar::{DualChunk, Jet, Scalar, Traced};
use fearless_simd::{Level, Simd, SimdBase, SimdFloat, f64x4, f64x8};
use num_dual::{Dual, Dual2};
#[cfg(feature = "scene")]
use std::any::TypeId;
use std::fmt::{Debug, Display, Formatter};

/// The vector registers of x86-64.
#[cfg(target_arch = "x86_64")]
mod target {
    use fearless_simd::Level;
    pub use fearless_simd::x86::{Avx2 as Middle, Avx512 as Wide, Sse2 as Narrow};

    /// The baseline registers, which are known at compile time.
    #[inline(always)]
    pub fn narrow(_level: Level) -> Option<Narrow> {
        Level::baseline().as_sse2()
    }

    #[inline(always)]
    pub fn middle(level: Level) -> Option<Middle> {
        level.as_avx2()
    }

    #[inline(always)]
    pub fn wide(level: Level) -> Option<Wide> {
        level.as_avx512()
    }
}

/// The vector registers of other targets, which are the same on all processors of a target.
#[cfg(not(target_arch = "x86_64"))]
mod target {
    #[cfg(not(target_arch = "aarch64"))]
    pub use fearless_simd::Fallback as Narrow;
    use fearless_simd::Level;
    #[cfg(target_arch = "aarch64")]
    pub use fearless_simd::aarch64::Neon as Narrow;
    pub use {Narrow as Middle, Narrow as Wide};

    #[cfg(target_arch = "aarch64")]
    pub fn narrow(level: Level) -> Option<Narrow> {
        level.as_neon()
    }

    #[cfg(not(target_arch = "aarch64"))]
    pub fn narrow(_level: Level) -> Option<Narrow> {
        Some(Narrow::new())
    }

    pub fn middle(_level: Level) -> Option<Middle> {
        None
    }

    pub fn wide(_level: Level) -> Option<Wide> {
        None
    }
}

/// The largest number of lanes of any register.
pub const MOST_LANES: usize = 8;

/// A kind of vector registers, such as 256-bit registers.
pub trait Register: Copy + Debug + Send + Sync + 'static {
    /// The type that represents the instructions for these registers.
    type Simd: Simd;
    /// A vector of numbers that occupies one register or a few registers; a longer vector would
    /// spill to memory.
    type Vector: SimdFloat<Self::Simd, Element = f64>;
    /// The number of lanes of the vector.
    const LANES: usize = <Self::Vector as SimdBase<Self::Simd>>::LEN;
    /// The width by which users select this kind of registers.
    const WIDTH: LaneWidth;

    /// Returns the instructions for these registers if the instruction level of the processor
    /// includes them.
    fn of(level: Level) -> Option<Self::Simd>;

    /// The instructions.
    ///
    /// # Panics
    /// Panics if the processor does not have these registers.
    #[inline(always)]
    fn instructions() -> Self::Simd {
        Self::of(Level::new()).unwrap_or_else(|| {
            unreachable!(
                "vector registers must be chosen only if the processor supports their instructions"
            )
        })
    }
}

/// Declares kinds of registers, each given by its instructions, its vector of numbers and its
/// availability.
macro_rules! registers {
    ($($(#[$doc:meta])* $register:ident: $simd:ty, $vector:ty, $of:expr;)*) => {
        $(
            $(#[$doc])*
            #[derive(Clone, Copy, Debug)]
            pub struct $register;

            impl Register for $register {
                type Simd = $simd;
                type Vector = $vector;
                const WIDTH: LaneWidth = LaneWidth::$register;

                #[inline(always)]
                fn of(level: Level) -> Option<$simd> {
                    $of(level)
                }
            }
        )*

        /// The width of the vector registers in which batches of motions advance. The default is the
        /// widest kind of registers that the processor has at run time. The width affects only the
        /// run time: results are bit-identical for all widths.
        #[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
        pub enum LaneWidth {
            $($(#[$doc])* $register,)*
        }

        impl LaneWidth {
            const ALL: [Self; 3] = [$(LaneWidth::$register),*];

            fn is_in(self, level: Level) -> bool {
                match self {
                    $(LaneWidth::$register => $register::of(level).is_some(),)*
                }
            }

            /// Returns the number of lanes.
            pub fn lanes(self) -> usize {
                match self {
                    $(LaneWidth::$register => $register::LANES,)*
                }
            }
        }
    };
}

registers! {
    /// The registers that every processor of the target has.
    Baseline: Narrow, f64x4<Narrow>, narrow;
    /// Registers of 256 bits, on processors of level x86-64-v3 with AVX2.
    Avx2: Middle, f64x4<Middle>, middle;
    /// Registers of 512 bits, on processors with the AVX-512 instructions of Ice Lake or Zen 4.
    Avx512: Wide, f64x8<Wide>, wide;
}

impl LaneWidth {
    /// Returns the widest registers of the processor.
    pub fn widest() -> Self {
        Self::all_in(Level::new()).last().unwrap_or(LaneWidth::Baseline)
    }

    /// Returns the widest registers for which the whole program is compiled.
    pub fn compiled() -> Self {
        Self::all_in(Level::baseline()).last().unwrap_or(LaneWidth::Baseline)
    }

    /// Iterates over all kinds of registers that the processor has, from the narrowest to the
    /// widest.
    pub fn available() -> impl Iterator<Item = Self> {
        Self::all_in(Level::new())
    }

    fn all_in(level: Level) -> impl Iterator<Item = Self> {
        Self::ALL.into_iter().filter(move |width| width.is_in(level))
    }
}

impl Display for LaneWidth {
    fn fmt(&self, f: &mut Formatter<'_>) -> std::fmt::Result {
        let name = match self {
            LaneWidth::Baseline => "baseline",
            LaneWidth::Avx2 => "AVX2",
            LaneWidth::Avx512 => "AVX-512",
        };
        write!(f, "{name} ({} numbers)", self.lanes())
    }
}

/// A scalar type; generic code for this type is compiled with the instructions of the registers
/// that contain its lanes.
pub trait Registered: Scalar {
    /// The registers of the lanes; `None` for scalar types without lanes.
    const WIDTH: Option<LaneWidth> = None;
}

impl Registered for f64 {}

impl<T: Registered, const W: usize> Registered for DualChunk<T, W> {
    const WIDTH: Option<LaneWidth> = T::WIDTH;
}

impl<const SIZE: usize> Registered for Jet<SIZE> {}

impl Registered for Traced {}

impl<R: Register> Registered for Lanes<R> {
    const WIDTH: Option<LaneWidth> = Some(R::WIDTH);
}

impl<T: Registered> Registered for Dual<T> {
    const WIDTH: Option<LaneWidth> = T::WIDTH;
}

impl<T: Registered> Registered for Dual2<T> {
    const WIDTH: Option<LaneWidth> = T::WIDTH;
}

/// Evaluates a closure that computes with numbers of type `T`; numbers in lanes use the instructions
/// of their registers. Functions that are not inlined into the closure are compiled without these
/// instructions, which gives correct but slow code; therefore closures must be `#[inline(always)]`.
/// Each closure is called in only one place, so that compilers inline most of the functions that it
/// calls.
#[inline(always)]
pub(in crate::core) fn in_registers<T: Registered, X>(evaluate: impl FnOnce() -> X) -> X {
    // The width is known at code generation: other branches are not compiled.
    if const { matches!(T::WIDTH, Some(LaneWidth::Avx512)) } {
        Avx512::instructions().vectorize(evaluate)
    } else if const { matches!(T::WIDTH, Some(LaneWidth::Avx2)) } {
        Avx2::instructions().vectorize(evaluate)
    } else {
        evaluate()
    }
}

/// Evaluates a closure with AVX2 instructions if the processor has them; useful for loops over plain
/// numbers that compilers vectorise. The terms of sums are added in the same order with and without
/// AVX2, so that results are bit-identical. All functions that the closure calls must be
/// `#[inline(always)]`.
#[cfg(feature = "scene")]
#[inline(always)]
pub(crate) fn with_avx2<X>(evaluate: impl FnOnce() -> X) -> X {
    match Avx2::of(Level::new()) {
        Some(instructions) => instructions.vectorize(evaluate),
        None => evaluate(),
    }
}

/// Evaluates a closure in the same way as [`in_registers`], for any scalar type. All functions that
/// the closure calls must be `#[inline(always)]`.
#[cfg(feature = "scene")]
#[inline(always)]
pub(crate) fn in_registers_of<T: Scalar, X>(evaluate: impl FnOnce() -> X) -> X {
    // The test of the alignment avoids compiling the closure twice for other numbers.
    if const { align_of::<T>() == align_of::<Lanes<Avx512>>() } && is_in::<T, Avx512>() {
        return Avx512::instructions().vectorize(evaluate);
    }
    if const { align_of::<T>() == align_of::<Lanes<Avx2>>() } && is_in::<T, Avx2>() {
        return Avx2::instructions().vectorize(evaluate);
    }
    evaluate()
}

/// Whether a number type consists of lanes of registers `R`.
#[cfg(feature = "scene")]
#[inline(always)]
fn is_in<T: Scalar, R: Register>() -> bool {
    [TypeId::of::<Lanes<R>>(), TypeId::of::<DualLanes<R>>()].contains(&TypeId::of::<T>())
}

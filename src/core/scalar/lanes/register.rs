//! Vector registers, selected when the program runs.
//!
//! A program is compiled for every processor of its target, and so can hold only the narrowest
//! registers. Numbers in lanes of wider ones are types of their own. What computes with them is
//! compiled with the instructions of these registers where it is called by [`in_registers`]; such
//! types are used only on processors that have the registers.

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

/// What there is on x86-64.
#[cfg(target_arch = "x86_64")]
mod target {
    use fearless_simd::Level;
    pub use fearless_simd::x86::{Avx2 as Middle, Avx512 as Wide, Sse2 as Narrow};

    /// Known where the program is compiled.
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

/// Elsewhere all processors have the same registers.
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

/// The most numbers side by side.
pub const MOST_LANES: usize = 8;

/// A kind of vector registers.
pub trait Register: Copy + Debug + Send + Sync + 'static {
    /// The instructions for them.
    type Simd: Simd;
    /// As many numbers as registers hold, or a few registers: more of them would not stay in
    /// registers.
    type Vector: SimdFloat<Self::Simd, Element = f64>;
    /// How many numbers there are side by side.
    const LANES: usize = <Self::Vector as SimdBase<Self::Simd>>::LEN;
    /// Their name.
    const WIDTH: LaneWidth;

    /// The instructions, if they are among those of a level.
    fn of(level: Level) -> Option<Self::Simd>;

    /// The instructions.
    ///
    /// # Panics
    /// If the processor does not have them.
    #[inline(always)]
    fn instructions() -> Self::Simd {
        Self::of(Level::new()).unwrap_or_else(|| unreachable!("lanes are chosen by the processor"))
    }
}

/// Declares kinds of registers: instructions, vector of numbers, and where they are available.
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

        /// How many numbers vector registers hold, in which motions step abreast: those of the
        /// widest registers that the processor has when the program runs. Only time depends on it,
        /// results are the same to the last bit.
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

            /// How many numbers go side by side.
            pub fn lanes(self) -> usize {
                match self {
                    $(LaneWidth::$register => $register::LANES,)*
                }
            }
        }
    };
}

registers! {
    /// Registers that every processor of the target has.
    Baseline: Narrow, f64x4<Narrow>, narrow;
    /// Registers of 256 bits, of x86-64-v3 with AVX2.
    Avx2: Middle, f64x4<Middle>, middle;
    /// Registers of 512 bits, of processors with the AVX-512 of Ice Lake or Zen 4.
    Avx512: Wide, f64x8<Wide>, wide;
}

impl LaneWidth {
    /// The widest registers of the processor.
    pub fn widest() -> Self {
        Self::all_in(Level::new()).last().unwrap_or(LaneWidth::Baseline)
    }

    /// The widest registers for which all of the program is compiled.
    pub fn compiled() -> Self {
        Self::all_in(Level::baseline()).last().unwrap_or(LaneWidth::Baseline)
    }

    /// All registers of the processor, the narrowest ones first.
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

/// A scalar that generic code is compiled for by name, with the registers of its lanes.
pub trait Registered: Scalar {
    /// The registers; `None` for numbers that are not in lanes.
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

/// Evaluates a closure in numbers `T`: if these are in lanes, with the instructions of their
/// registers. What is not inlined into it is compiled without them, which is right but slow:
/// closures are `#[inline(always)]`. They are called in one place only, so that compilers inline
/// most of what they call unasked.
#[inline(always)]
pub(in crate::core) fn in_registers<T: Registered, X>(evaluate: impl FnOnce() -> X) -> X {
    // The width is known where code is generated: other branches are not compiled.
    if const { matches!(T::WIDTH, Some(LaneWidth::Avx512)) } {
        Avx512::instructions().vectorize(evaluate)
    } else if const { matches!(T::WIDTH, Some(LaneWidth::Avx2)) } {
        Avx2::instructions().vectorize(evaluate)
    } else {
        evaluate()
    }
}

/// Evaluates a closure with the instructions of AVX2, if the processor has them: for loops over
/// numbers that are not in lanes, which compilers put there. Sums keep their order, so that results
/// are the same to the last bit. All that is called is `#[inline(always)]`.
#[cfg(feature = "scene")]
#[inline(always)]
pub(crate) fn with_avx2<X>(evaluate: impl FnOnce() -> X) -> X {
    match Avx2::of(Level::new()) {
        Some(instructions) => instructions.vectorize(evaluate),
        None => evaluate(),
    }
}

/// Does what [`in_registers`] does, where nothing is known of a scalar but that it is one. All that
/// is called is `#[inline(always)]`.
#[cfg(feature = "scene")]
#[inline(always)]
pub(crate) fn in_registers_of<T: Scalar, X>(evaluate: impl FnOnce() -> X) -> X {
    // Nothing is compiled twice for numbers of other alignments.
    if const { align_of::<T>() == align_of::<Lanes<Avx512>>() } && is_in::<T, Avx512>() {
        return Avx512::instructions().vectorize(evaluate);
    }
    if const { align_of::<T>() == align_of::<Lanes<Avx2>>() } && is_in::<T, Avx2>() {
        return Avx2::instructions().vectorize(evaluate);
    }
    evaluate()
}

/// Whether numbers are in the lanes of registers.
#[cfg(feature = "scene")]
#[inline(always)]
fn is_in<T: Scalar, R: Register>() -> bool {
    [TypeId::of::<Lanes<R>>(), TypeId::of::<DualLanes<R>>()].contains(&TypeId::of::<T>())
}

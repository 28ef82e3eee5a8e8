//! Statements that are generic over scalars, behind object-safe traits.
//!
//! A statement cannot be a trait object, since its methods are generic. Its *face* in one scalar,
//! such as `Residual<f64>`, can. An *erased trait* has the faces in a list of scalars as
//! supertraits. Generic code selects a face by a *number trait*, which those scalars implement:
//!
//! ```text
//! trait Number: Scalar {
//!     fn residual(problem: &dyn Equations) -> &dyn Residual<Self>;
//! }
//! ```
//!
//! Faces and number traits are ordinary Rust. [`erased!`] writes what repeats for each scalar.

/// Writes what an erased trait repeats for each scalar, or takes over from a statement:
/// - `pub trait InScalars;` with `impl Number by Residual for [f64, …] { … }`: a trait whose
///   supertraits are the faces in each scalar of a list, and the number trait of these scalars;
/// - `impl Number for [f64, …] { … }`: a number trait without a face;
/// - `pub trait Erased: InScalars of Statement { fn … }`: an erased trait with those methods of a
///   statement that are not generic, implemented for every statement.
macro_rules! erased {
    (
        $(#[$doc:meta])* pub trait $faces:ident;
        $(impl $number:ident by $face:ident for [$($scalar:ty),* $(,)?] $body:tt)*
    ) => {
        $(#[$doc])*
        pub trait $faces: $($($face<$scalar> +)*)* {}

        impl<S: $($($face<$scalar> +)*)*> $faces for S {}

        $($(impl $number for $scalar $body)*)*
    };
    ($(impl $number:ident for [$($scalar:ty),*] $body:tt)*) => {
        $($(impl $number for $scalar $body)*)*
    };
    ($(#[$doc:meta])* pub trait $erased:ident: $faces:ident of $statement:ident {
        $(fn $name:ident($($argument:ident: $type:ty),*) -> $result:ty;)*
    }) => {
        $(#[$doc])*
        pub trait $erased: $faces + Send + Sync {
            $(
                #[doc = concat!("[`", stringify!($statement), "::", stringify!($name), "`].")]
                fn $name(&self, $($argument: $type),*) -> $result;
            )*
        }

        impl<S: $statement> $erased for S {
            $(fn $name(&self, $($argument: $type),*) -> $result {
                $statement::$name(self, $($argument),*)
            })*
        }
    };
}

pub(in crate::core) use erased;

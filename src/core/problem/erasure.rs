//! Generic user-defined models, converted to implementations of object-safe traits.
//!
//! A model trait is not object-safe, since its methods are generic over scalar types. The *face* of
//! a model trait in one scalar type, such as `Guards<f64>`, is object-safe. An *erased trait* has
//! the faces in several scalar types as supertraits. Generic code selects a face through a *number
//! trait*, which these scalar types implement:
//!
//! ```text
//! pub trait GuardNumber: Scalar {
//!     fn guards(system: &dyn HybridEquations) -> &dyn Guards<Self>;
//! }
//! ```
//!
//! Number traits, and faces with additional methods, are written as ordinary Rust code. [`erased!`]
//! generates the code that is the same for each scalar type or each method of a model trait.

/// Declares the erased form of a model trait (`Statement`):
/// - `pub trait InScalars;` with `impl Number by Face for [f64, …] { … }` declares a trait that has
///   the faces in each scalar type of a list as supertraits, and implements the number traits for
///   these scalar types;
/// - `impl Number for [f64, …] { … }` implements a number trait without a face of its own;
/// - `pub trait Erased: InScalars of Statement { fn … }` declares the erased trait of every model,
///   with the model's methods that are not generic;
/// - `pub trait Face<T> of Statement by Number::select of Erased { fn … }` declares the face of
///   every model, and the generic methods of the erased trait, which select a face.
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
    (
        $(#[$of_face:meta])* pub trait $face:ident<$scalar:ident>
            of $statement:ident by $number:ident::$select:ident of $erased:ident
        { $(
            $(#[$doc:meta])*
            fn $name:ident as $in_scalar:ident($($argument:ident: $type:ty),*) -> $result:ty;
        )* }
    ) => {
        $(#[$of_face])*
        pub trait $face<$scalar> {
            $($(#[$doc])* fn $in_scalar(&self, $($argument: $type),*) -> $result;)*
        }

        impl<S: $statement, $scalar: $crate::core::scalar::Registered> $face<$scalar> for S {
            $(fn $in_scalar(&self, $($argument: $type),*) -> $result {
                $crate::core::scalar::in_registers::<$scalar, _>(#[inline(always)] || {
                    $statement::$name(self, $($argument),*)
                })
            })*
        }

        impl dyn $erased + '_ {
            $($(#[$doc])* pub fn $name<$scalar: $number>(&self, $($argument: $type),*) -> $result {
                $scalar::$select(self).$in_scalar($($argument),*)
            })*
        }
    };
}

pub(in crate::core) use erased;

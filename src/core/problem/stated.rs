//! Macros that define vector fields and zero problems by formulas of named states and parameters.

/// Declares a struct, or a unit struct if no fields are given.
#[doc(hidden)]
#[macro_export]
macro_rules! __structure {
    ([$($head:tt)*]) => { $($head)*; };
    ([$($head:tt)*] { $($fields:tt)* }) => { $($head)* { $($fields)* } };
}

/// Asserts at compile time that the number of default values equals the number of parameters, or is
/// zero.
#[doc(hidden)]
#[macro_export]
macro_rules! __defaults {
    ($([$parameter:ident $($default:expr)?])*) => {
        const _: () = {
            let given = [$($(stringify!($default),)?)*] as [&str; _];
            let parameters = [$(stringify!($parameter)),*] as [&str; _];
            assert!(
                given.is_empty() || given.len() == parameters.len(),
                "give a default value to every parameter, or to no parameter"
            );
        };
    };
}

/// Creates the names of the states, parameters and monitors.
#[doc(hidden)]
#[macro_export]
macro_rules! __names {
    ([$($state:ident),+] [$($parameter:ident),*] [$($monitor:ident),*]) => {
        $crate::core::problem::Names::new(
            [$(stringify!($state)),+],
            [$(stringify!($parameter)),*] as [&str; _],
        )
        .with_monitors([$(stringify!($monitor)),*] as [&str; _])
    };
}

/// Binds variables to the first elements of a slice.
#[doc(hidden)]
#[macro_export]
macro_rules! __values {
    ([$($name:ident),*] = $values:ident) => {
        let [$($name,)* ..] = *$values else {
            panic!("{} values for {}", $values.len(), stringify!($($name),*))
        };
    };
}

/// Defines the forcing and its period; the phase grows by 2π in a period unless another number is
/// given.
#[doc(hidden)]
#[macro_export]
macro_rules! __forcing {
    () => {
        $crate::core::problem::Forcing::None
    };
    (period $period:expr) => {
        $crate::__forcing! { period $period, std::f64::consts::TAU }
    };
    (period $period:expr, $phase:expr) => {
        $crate::core::problem::Forcing::Periodic { phase: $phase }
    };
}

/// Defines a [`VectorField`](crate::core::problem::VectorField) by formulas for the rates of its states.
/// The declared struct is `Clone`, `Copy` and `Debug`.
///
/// The brackets after the struct's name contain, separated by semicolons: the states; the parameters,
/// all or none of them with default values; and optionally a name for the time. The rates of the states
/// can be given in any order. A numeric literal must be the right operand, as in `x * 3.0 + 1.0`, or be
/// converted, as in `T::constant(3.0)`, since `x` can be a dual number of the type `T`.
///
/// ```
/// use tangency::prelude::*;
/// vector_field! {
///     /// The Brusselator, with a Hopf point at b = 2.
///     pub struct Brusselator [x, y; b] {
///         let reaction = x * x * y;
///         d/dt x = reaction - (b + 1.0) * x + 1.0;
///         d/dt y = b * x - reaction;
///     }
/// }
/// let mut rest = Dense::new(Equilibria::new(Brusselator));
/// let branch = Continuation::new(&mut rest).from(&[1.0, 1.5]).at("b", 1.5).along("b", 1.5..=4.0).trace()?;
/// let hopf = branch.of_kind(Kind::HB).next().expect("a Hopf point");
/// assert!((hopf.parameters[0] - 2.0).abs() < 1e-12);
/// # Ok::<(), tangency::core::continuation::TraceError>(())
/// ```
///
/// The rates can be followed, in this order, by the `period` of a forcing, by monitors, and by trait
/// methods that the macro does not generate; all three are optional. The phase of the forcing grows in a
/// period by 2π, or by another number, as in `period = T::one(), phase = 1.0`. Formulas can refer to
/// fields of the struct by their names if these fields are `Copy`.
///
/// ```
/// use std::f64::consts::TAU;
/// use tangency::prelude::*;
/// vector_field! {
///     /// A linear oscillator under a force: `x'' + c x' + x = cos ωt`.
///     struct Oscillator { damping: f64 } [x, v; omega = 1.0; t] {
///         d/dt x = v;
///         d/dt v = (omega * t).cos() - x - v * damping;
///         period = omega.recip() * TAU;
///         monitor energy = (x * x + v * v) * 0.5;
///         fn scales(&self, _p: &[f64]) -> Vec<f64> {
///             vec![1.0, 2.0]
///         }
///     }
/// }
/// let oscillator = Oscillator { damping: 0.1 };
/// let mut f = [0.0; 2];
/// oscillator.field(0.0, &[0.5, 2.0], &[4.0], &mut f);
/// assert_eq!(f, [2.0, 1.0 - 0.5 - 0.2]);
/// assert_eq!((oscillator.defaults(), oscillator.period(&[4.0])), (vec![1.0], TAU / 4.0));
/// assert_eq!(oscillator.monitor(0, 0.0, &[1.0, 2.0], &[4.0]), 2.5);
/// ```
#[macro_export]
macro_rules! vector_field {
    (
        $(#[$attribute:meta])* $visible:vis struct $name:ident
        $({ $($(#[$of_field:meta])* $seen:vis $field:ident: $type:ty),* $(,)? })?
        [
            $($state:ident),+
            $(; $($parameter:ident $(= $default:expr)?),* $(; $time:ident)?)?
        ] {
            $(let $local:pat = $value:expr;)*
            $(d/dt $rated:ident = $rate:expr;)*
            $(period = $period:expr $(, phase = $phase:expr)?;)?
            $(monitor $monitor:ident = $observed:expr;)*
            $(fn $($methods:tt)*)?
        }
    ) => {
        $crate::__structure! {
            [$(#[$attribute])* #[derive(Clone, Copy, Debug)] $visible struct $name]
            $({ $($(#[$of_field])* $seen $field: $type),* })?
        }

        const _: () = {
            $crate::__defaults! { $($([$parameter $($default)?])*)? }

            #[allow(non_snake_case)]
            struct Rates<T> {
                $($state: T),+
            }

            #[allow(unused, irrefutable_let_patterns, non_snake_case)]
            impl $crate::core::problem::VectorField for $name {
                fn names(&self) -> $crate::core::problem::Names {
                    $crate::__names! {
                        [$($state),+] [$($($parameter),*)?] [$($monitor),*]
                    }
                }

                fn defaults(&self) -> Vec<f64> {
                    vec![$($($($default,)?)*)?]
                }

                fn field<T: $crate::core::scalar::Scalar>(
                    &self,
                    t: T,
                    x: &[T],
                    p: &[T],
                    f: &mut [T],
                ) {
                    $($(let $field = self.$field;)*)?
                    $($(let $time = t;)?)?
                    $crate::__values! { [$($state),+] = x }
                    $crate::__values! { [$($($parameter),*)?] = p }
                    $(let $local = $value;)*
                    let rates = Rates { $($rated: $rate),* };
                    f.copy_from_slice(&[$(rates.$state),+]);
                }

                fn forcing(&self) -> $crate::core::problem::Forcing {
                    $($(let $field = self.$field;)*)?
                    $crate::__forcing! { $(period $period $(, $phase)?)? }
                }

                fn period<T: $crate::core::scalar::Scalar>(&self, p: &[T]) -> T {
                    $($(let $field = self.$field;)*)?
                    $crate::__values! { [$($($parameter),*)?] = p }
                    [$($period,)? T::one()][0]
                }

                fn monitor<T: $crate::core::scalar::Scalar>(
                    &self,
                    monitor: usize,
                    t: T,
                    x: &[T],
                    p: &[T],
                ) -> T {
                    $($(let $field = self.$field;)*)?
                    $($(let $time = t;)?)?
                    $crate::__values! { [$($state),+] = x }
                    $crate::__values! { [$($($parameter),*)?] = p }
                    $(let $local = $value;)*
                    let values: &[T] = &[$($observed),*];
                    values.get(monitor).copied().unwrap_or(T::from(f64::NAN))
                }

                $(fn $($methods)*)?
            }
        };
    };
}

/// Defines a [`ZeroProblem`](crate::core::problem::ZeroProblem) by its residuals, one formula for
/// each unknown, in the order of the unknowns. If the formulas are the rates of a motion, this
/// order affects the computed stability. The declared struct is `Clone`, `Copy` and `Debug`.
///
/// The brackets after the struct's name contain the unknowns and, after a semicolon, the parameters,
/// all or none of them with default values. Local values, monitors, struct fields and further methods
/// are written in the same way as in [`vector_field!`](crate::vector_field).
///
/// ```
/// use tangency::prelude::*;
/// zero_problem! {
///     /// A parallel-plate actuator: pulls in at u = 1/3, load = 4/27.
///     struct ParallelPlate { gap: f64 } [u; load] {
///         let force = load / (-u + gap).powi(2);
///         0 = force - u;
///         monitor stiffness = force * 2.0 / (-u + gap);
///     }
/// }
/// let mut plate = Dense::new(ParallelPlate { gap: 1.0 });
/// let branch = Continuation::new(&mut plate).along("load", 0.0..=1.0).trace()?;
/// let fold = branch.of_kind(Kind::LP).next().expect("a fold");
/// assert!((fold.parameters[0] - 4.0 / 27.0).abs() < 1e-14);
/// # Ok::<(), tangency::core::continuation::TraceError>(())
/// ```
///
/// The number of formulas must equal the number of unknowns:
///
/// ```compile_fail
/// tangency::zero_problem! {
///     struct Short [x, y; p] { 0 = x + y - p; }
/// }
/// ```
#[macro_export]
macro_rules! zero_problem {
    (
        $(#[$attribute:meta])* $visible:vis struct $name:ident
        $({ $($(#[$of_field:meta])* $seen:vis $field:ident: $type:ty),* $(,)? })?
        [$($unknown:ident),+ $(; $($parameter:ident $(= $default:expr)?),*)?] {
            $(let $local:pat = $value:expr;)*
            $(0 = $residual:expr;)*
            $(monitor $monitor:ident = $observed:expr;)*
            $(fn $($methods:tt)*)?
        }
    ) => {
        $crate::__structure! {
            [$(#[$attribute])* #[derive(Clone, Copy, Debug)] $visible struct $name]
            $({ $($(#[$of_field])* $seen $field: $type),* })?
        }

        const _: () = {
            $crate::__defaults! { $($([$parameter $($default)?])*)? }

            #[allow(unused, irrefutable_let_patterns, non_snake_case)]
            impl $crate::core::problem::ZeroProblem for $name {
                fn names(&self) -> $crate::core::problem::Names {
                    $crate::__names! {
                        [$($unknown),+] [$($($parameter),*)?] [$($monitor),*]
                    }
                }

                fn defaults(&self) -> Vec<f64> {
                    vec![$($($($default,)?)*)?]
                }

                fn residual<T: $crate::core::scalar::Scalar>(&self, z: &[T], p: &[T], r: &mut [T]) {
                    const UNKNOWNS: usize = [$(stringify!($unknown)),+].len();
                    $($(let $field = self.$field;)*)?
                    $crate::__values! { [$($unknown),+] = z }
                    $crate::__values! { [$($($parameter),*)?] = p }
                    $(let $local = $value;)*
                    let residuals: [T; UNKNOWNS] = [$($residual),*];
                    r.copy_from_slice(&residuals);
                }

                fn monitors<T: $crate::core::scalar::Scalar>(
                    &self,
                    z: &[T],
                    p: &[T],
                    values: &mut [T],
                ) {
                    $($(let $field = self.$field;)*)?
                    $crate::__values! { [$($unknown),+] = z }
                    $crate::__values! { [$($($parameter),*)?] = p }
                    $(let $local = $value;)*
                    values.copy_from_slice(&[$($observed),*]);
                }

                $(fn $($methods)*)?
            }
        };
    };
}

//! Macros that define hybrid systems by formulas of named states and parameters, mode by mode.

/// Returns the index of a name among the distinct names in a list.
#[doc(hidden)]
pub const fn number_of(name: &str, listed: &[&str]) -> usize {
    let (mut number, mut k) = (0, 0);
    while !same(listed[k], name) {
        let (mut earlier, mut known) = (0, false);
        while earlier < k {
            known |= same(listed[earlier], listed[k]);
            earlier += 1;
        }
        number += !known as usize;
        k += 1;
    }
    number
}

const fn same(a: &str, b: &str) -> bool {
    let (a, b) = (a.as_bytes(), b.as_bytes());
    let mut k = 0;
    while k < a.len() && k < b.len() && a[k] == b[k] {
        k += 1;
    }
    k == a.len() && k == b.len()
}

/// Defines a [`HybridSystem`](crate::core::hybrid::HybridSystem) mode by mode. The declared struct is
/// `Clone`, `Copy` and `Debug`.
///
/// The brackets after the struct's name contain the parameters, all or none of them with default
/// values, and optionally, after a semicolon, a name for the time. Each mode lists its states in
/// brackets after its name. Within a mode,
/// - `d/dt x = …;` defines the rate of change of a state;
/// - `event name: guard => next { x, v: … };` defines an event: when the guard falls to zero, the
///   motion continues in the mode `next`, from the states in braces. If the braces are missing, the
///   event leaves the state unchanged. An event that can occur in several modes is written in each
///   mode, with the same name. Events are numbered in the order in which their names first appear;
/// - `=> up { … } if f, down { … } if g, stick { … };` lists several possible next modes: the motion
///   continues in the first mode whose [decision](crate::core::hybrid::HybridSystem::decision) function
///   is positive, or in the last mode if all functions are negative;
/// - `accumulates to contact { … };` after an event names the mode in which the motion continues
///   after infinitely many such events in a finite time;
/// - `event name.at(1): …` calls further methods of [`Guard`](crate::core::hybrid::Guard), here
///   [`Guard::at`](crate::core::hybrid::Guard::at).
///
/// Before the modes, the macro accepts local values and the `period` of a forcing, as in
/// [`vector_field!`](crate::vector_field); after the modes, it accepts trait methods that it does not
/// generate.
///
/// ```
/// use tangency::prelude::*;
/// hybrid_system! {
///     /// A ball above the ground, `y'' = −g`, that rebounds with the fraction `e` of its speed.
///     struct Ball [gravity = 9.81, restitution = 0.8] {
///         mode flight [height, velocity] {
///             d/dt height = velocity;
///             d/dt velocity = -gravity;
///             event bounce: height => flight { height, velocity: -restitution * velocity };
///             accumulates to rest { height };
///         }
///         mode rest [height] {
///             d/dt height = T::zero();
///         }
///     }
/// }
/// let mut after = [0.0; 2];
/// Ball.reset(0, (0, 0), 0.0, &[0.0, -2.0], &[9.81, 0.8], &mut after);
/// assert_eq!(after, [0.0, 1.6]);
/// assert_eq!(Ball.guards(), [Guard::new("bounce", [0]).accumulating_to(1)]);
/// ```
///
/// The documentation of [`HybridSystem::decision`](crate::core::hybrid::HybridSystem::decision)
/// contains an example of an event with several possible next modes.
#[macro_export]
macro_rules! hybrid_system {
    (
        $(#[$attribute:meta])* $visible:vis struct $name:ident
        $({ $($(#[$of_field:meta])* $seen:vis $field:ident: $type:ty),* $(,)? })?
        [$($parameter:ident $(= $default:expr)?),* $(; $time:ident)?] {
            $(let $local:pat = $value:expr;)*
            $(period = $period:expr $(, phase = $phase:expr)?;)?
            $(mode $mode:ident [$($state:ident),+] {
                $(let $of_mode:pat = $its:expr;)*
                $(d/dt $rated:ident = $rate:expr;)*
                $(
                    event $event:ident $(.$option:ident($($argument:expr),*))*: $guard:expr
                        => $($next:ident $({ $($after:tt)* })? $(if $decision:expr)?),+;
                    $(accumulates to $held:ident $({ $($at_rest:tt)* })?;)?
                )*
            })*
            $(fn $($methods:tt)*)?
        }
    ) => {
        $crate::__structure! {
            [$(#[$attribute])* #[derive(Clone, Copy, Debug)] $visible struct $name]
            $({ $($(#[$of_field])* $seen $field: $type),* })?
        }

        const _: () = {
            $crate::__defaults! { $([$parameter $($default)?])* }

            const __MODES: &[&str] = &[$(stringify!($mode)),*];
            const __EVENTS: &[&str] = &[$($(stringify!($event),)*)*];

            $(
                /// The states of one mode, by name.
                #[allow(non_camel_case_types, non_snake_case)]
                struct $mode<T> {
                    $($state: T),+
                }

                impl<T: Copy> $mode<T> {
                    const NUMBER: usize = $crate::core::hybrid::number_of(stringify!($mode), __MODES);

                    fn write(self, to: &mut [T]) {
                        to.copy_from_slice(&[$(self.$state),+]);
                    }
                }
            )*

            $($(
                const _: () = assert!(
                    ([$($(stringify!($decision),)?)+] as [&str; _]).len() + 1
                        == [$(stringify!($next)),+].len(),
                    "all possible next modes of an event except the last one need `if`"
                );
            )*)*

            #[allow(unused, irrefutable_let_patterns, non_snake_case, non_upper_case_globals)]
            impl $crate::core::hybrid::HybridSystem for $name {
                fn modes(&self) -> Vec<$crate::core::hybrid::Mode> {
                    vec![$(
                        $crate::core::hybrid::Mode::new(stringify!($mode), [$(stringify!($state)),+])
                    ),*]
                }

                fn guards(&self) -> Vec<$crate::core::hybrid::Guard> {
                    $($(let $field = self.$field;)*)?
                    let mut guards: Vec<$crate::core::hybrid::Guard> = Vec::new();
                    $($({
                        const NUMBER: usize = $crate::__event!($event);
                        if NUMBER == guards.len() {
                            guards.push($crate::core::hybrid::Guard::new(stringify!($event), []));
                        }
                        let mut guard = guards[NUMBER].clone();
                        guard.modes.push($mode::<f64>::NUMBER);
                        $(let guard = guard.accumulating_to($held::<f64>::NUMBER);)?
                        $(let guard = guard.$option($($argument),*);)*
                        guards[NUMBER] = guard;
                    })*)*
                    guards
                }

                fn parameters(&self) -> Vec<String> {
                    let names: &[&str] = &[$(stringify!($parameter)),*];
                    names.iter().map(|name| name.to_string()).collect()
                }

                fn defaults(&self) -> Vec<f64> {
                    vec![$($($default,)?)*]
                }

                fn field<T: $crate::core::scalar::Scalar>(
                    &self,
                    mode: usize,
                    t: T,
                    x: &[T],
                    p: &[T],
                    f: &mut [T],
                ) {
                    $($(let $field = self.$field;)*)?
                    $(let $time = t;)?
                    $crate::__values! { [$($parameter),*] = p }
                    $(let $local = $value;)*
                    $(if mode == $mode::<T>::NUMBER {
                        $crate::__values! { [$($state),+] = x }
                        $(let $of_mode = $its;)*
                        return $mode { $($rated: $rate),* }.write(f);
                    })*
                }

                fn guard<T: $crate::core::scalar::Scalar>(
                    &self,
                    guard: usize,
                    mode: usize,
                    t: T,
                    x: &[T],
                    p: &[T],
                ) -> T {
                    $($(let $field = self.$field;)*)?
                    $(let $time = t;)?
                    $crate::__values! { [$($parameter),*] = p }
                    $(let $local = $value;)*
                    $(if mode == $mode::<T>::NUMBER {
                        $crate::__values! { [$($state),+] = x }
                        $(let $of_mode = $its;)*
                        $(if guard == $crate::__event!($event) {
                            return $guard;
                        })*
                    })*
                    T::from(f64::NAN)
                }

                fn reset<T: $crate::core::scalar::Scalar>(
                    &self,
                    guard: usize,
                    modes: (usize, usize),
                    t: T,
                    x: &[T],
                    p: &[T],
                    after: &mut [T],
                ) {
                    $($(let $field = self.$field;)*)?
                    $(let $time = t;)?
                    $crate::__values! { [$($parameter),*] = p }
                    $(let $local = $value;)*
                    $(if modes.0 == $mode::<T>::NUMBER {
                        $crate::__values! { [$($state),+] = x }
                        $(let $of_mode = $its;)*
                        $(if guard == $crate::__event!($event) {
                            $($(if modes.1 == $next::<T>::NUMBER {
                                return $next { $($after)* }.write(after);
                            })?)+
                            $($(if modes.1 == $held::<T>::NUMBER {
                                return $held { $($at_rest)* }.write(after);
                            })?)?
                        })*
                    })*
                    match after.len() == x.len() {
                        true => after.copy_from_slice(x),
                        false => after.fill(T::from(f64::NAN)),
                    }
                }

                fn may_follow(&self, guard: usize, mode: usize) -> Vec<usize> {
                    $(if mode == $mode::<f64>::NUMBER {
                        $(if guard == $crate::__event!($event) {
                            return vec![$($next::<f64>::NUMBER),+];
                        })*
                    })*
                    Vec::new()
                }

                fn decision<T: $crate::core::scalar::Scalar>(
                    &self,
                    position: usize,
                    guard: usize,
                    mode: usize,
                    t: T,
                    x: &[T],
                    p: &[T],
                ) -> T {
                    $($(let $field = self.$field;)*)?
                    $(let $time = t;)?
                    $crate::__values! { [$($parameter),*] = p }
                    $(let $local = $value;)*
                    $(if mode == $mode::<T>::NUMBER {
                        $crate::__values! { [$($state),+] = x }
                        $(let $of_mode = $its;)*
                        $(if guard == $crate::__event!($event) {
                            let mut place = 0;
                            $($(
                                if place == position {
                                    return $decision;
                                }
                                place += 1;
                            )?)+
                        })*
                    })*
                    T::from(f64::NAN)
                }

                fn forcing(&self) -> $crate::core::problem::Forcing {
                    $($(let $field = self.$field;)*)?
                    $crate::__forcing! { $(period $period $(, $phase)?)? }
                }

                fn period<T: $crate::core::scalar::Scalar>(&self, p: &[T]) -> T {
                    $($(let $field = self.$field;)*)?
                    $crate::__values! { [$($parameter),*] = p }
                    [$($period,)? T::one()][0]
                }

                $(fn $($methods)*)?
            }
        };
    };
}

/// Returns the index of an event.
#[doc(hidden)]
#[macro_export]
macro_rules! __event {
    ($event:ident) => {{
        const NUMBER: usize = $crate::core::hybrid::number_of(stringify!($event), __EVENTS);
        NUMBER
    }};
}

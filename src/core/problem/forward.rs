//! Implementation of a trait by delegation to a contained value.

/// Implements methods by calling the methods with the same names on a contained value; `<T>` marks
/// methods that are generic over scalar types.
macro_rules! forward {
    (|$self:ident| $held:expr; $(
        fn $name:ident $(<$scalar:ident>)? ($($argument:ident: $type:ty),*) -> $result:ty;
    )*) => {$(
        fn $name $(<$scalar: $crate::core::scalar::Scalar>)? (&$self $(, $argument: $type)*) -> $result {
            $held.$name($($argument),*)
        }
    )*};
}

pub(in crate::core) use forward;

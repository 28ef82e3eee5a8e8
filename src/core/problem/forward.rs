//! Methods of a trait that are those of what a type holds.

/// Implements methods by calling those of the same name of what is held; `<T>` marks those that are
/// generic over scalars.
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

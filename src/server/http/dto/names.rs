//! Conversions between an enum of the JSON and an enum of the computation with the same variants.

/// Implements the conversion from an enum of the wire to the core's enum, variant by variant.
macro_rules! into_core {
    ($wire:ty => $core:ty, [$($variant:ident),+]) => {
        impl From<$wire> for $core {
            fn from(value: $wire) -> Self {
                match value { $(<$wire>::$variant => <$core>::$variant),+ }
            }
        }
    };
}
pub(in crate::http::dto) use into_core;

/// Implements the conversion from the core's enum to an enum of the wire, variant by variant.
macro_rules! from_core {
    ($core:ty => $wire:ty, [$($variant:ident),+]) => {
        impl From<$core> for $wire {
            fn from(value: $core) -> Self {
                match value { $(<$core>::$variant => <$wire>::$variant),+ }
            }
        }
    };
}
pub(in crate::http::dto) use from_core;

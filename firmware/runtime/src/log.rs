//! One logging macro per level: defmt on robots that enable it, nothing elsewhere. defmt does not
//! link on a host.

#[cfg(all(feature = "defmt", target_os = "none"))]
macro_rules! warn {
    ($($arguments:tt)*) => { defmt::warn!($($arguments)*) };
}

#[cfg(not(all(feature = "defmt", target_os = "none")))]
macro_rules! warn {
    ($text:literal $(, $argument:expr)* $(,)?) => {{ $(let _ = &$argument;)* }};
}

#[cfg(all(feature = "defmt", target_os = "none"))]
macro_rules! info {
    ($($arguments:tt)*) => { defmt::info!($($arguments)*) };
}

#[cfg(not(all(feature = "defmt", target_os = "none")))]
macro_rules! info {
    ($text:literal $(, $argument:expr)* $(,)?) => {{ $(let _ = &$argument;)* }};
}

//! The controller as a whole: percepts in, commands out.

mod advice_is_advice;
mod behaving;
mod bench;
mod reasons;
mod replay;
mod sensing;

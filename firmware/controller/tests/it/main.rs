//! The controller as a whole: percepts in, commands out.

mod advice_is_advice;
mod bench;
mod reasons;
mod replay;
mod sensing;

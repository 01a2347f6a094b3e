//! The controller as a whole: percepts in, commands out.

mod advice_is_advice;
mod arming;
mod behaving;
mod bench;
mod blending;
mod doubt;
mod guiding;
mod reasons;
mod replay;
mod reported;
mod sensing;

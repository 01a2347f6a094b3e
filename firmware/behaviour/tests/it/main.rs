//! The behaviour control system, from observations to what runs and why.

mod bench;
mod ploughing;

//! The behaviour control system, from observations to running actions and their reasons.

mod bench;
mod inputs;
mod monitoring;
mod ploughing;
mod states;
mod switching;
mod together;

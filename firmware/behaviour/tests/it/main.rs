//! The behaviour control system, from observations to running actions and their reasons.

mod bench;
mod inputs;
mod monitoring;
mod plan_frames;
mod ploughing;
mod protecting;
mod states;
mod switching;
mod together;

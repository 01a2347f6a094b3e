//! The behaviour control system, from observations to what runs and why.

mod bench;
mod inputs;
mod monitoring;
mod ploughing;
mod states;
mod switching;
mod together;

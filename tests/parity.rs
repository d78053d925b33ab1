//! Comparisons of the physics with MuJoCo and with its own laws, as one program; each file is a module.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, reason = "tests")]

mod actuation_parity;
mod collision_parity;
mod constraint_laws;
mod constraint_parity;
mod determinism;
mod elastic;
mod faults;
mod independent;
mod laws;
mod mirror;
mod mjcf_parity;
mod row_laws;
mod row_parity;
mod scene_parity;
mod scene_stages;
mod sensors;
mod smooth_lanes;
mod smooth_laws;
mod smooth_parity;
mod support;
mod wrap_jumps;

//! All tests of the program but the physics' (`parity.rs`) as one program, which is linked once; each file is a module.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, reason = "tests")]

mod actions;
mod advisories;
mod alignments;
mod channels;
mod cli;
mod cmc;
mod conditions;
mod directions;
mod draw;
mod episodes;
mod examples;
mod export;
mod hand_written;
mod human;
mod language_server;
mod motion_files;
mod motions;
mod muscle_sweep;
mod mutation;
mod paper;
mod physics_doors;
mod planning;
mod platforms;
mod randomization;
mod registered;
mod scenes;
mod support;
mod task_pages;
mod task_snapshots;
mod task_tests;
mod tasks;
mod together;
mod training;
mod vector;
mod vocabulary_fixture;

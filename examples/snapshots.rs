//! Tests of what tasks mean, as they stand in one's own repository: in `tests/rewards.rs`, without `main`.
//!
//! Try it: change a weight in `examples/crouch.msk`, then `cargo test --example snapshots`.
#![allow(clippy::panic, reason = "a test that panics has failed, which is its work")]

fn main() {}

#[test]
fn the_reward_of_crouch() {
    msk::assert_task_snapshot!("examples/crouch.msk", "crouch");
}

#[test]
fn a_task_that_does_not_exist_fails_with_those_that_do() {
    let file = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("examples/crouch.msk");
    let problem = msk::testing::snapshot(&file, "couch").err().unwrap_or_default();
    assert!(problem.contains("contains no task `couch`; it contains: crouch"), "{problem}");
}

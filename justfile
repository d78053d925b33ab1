# The daily commands. `just` lists them; each line can be typed by hand as well.

# Debug information doubles what the linker writes and is rarely looked at.
export CARGO_PROFILE_DEV_DEBUG := "0"

_default:
    @just --list --unsorted

# Formatting and clippy, warnings denied: the fast loop
check:
    cargo fmt --all --check
    cargo clippy --workspace --all-targets --locked -- -D warnings

# All tests
test:
    cargo test --workspace

# The tests whose names contain NAME
test-one NAME:
    cargo test --workspace --test suite {{NAME}}

# Write snapshots, tables of documents and recorded answers anew; read the difference
update:
    MSK_UPDATE=1 INSTA_UPDATE=always cargo test --workspace

# Everything that must hold before a change lands
ci:
    .ci/run

# The Python package: wheel and tests, in an environment of its own
python:
    .ci/python

# The documentation of all crates
docs:
    cargo doc --workspace --no-deps --open

# Steps per second and time per stage of the simulator
bench-physics:
    cargo run --release -- physics bench

# Compiled tasks beside the same formulas by hand
bench-compiled:
    cargo bench --bench compiled

# Fuzz TARGET for SECONDS of CPU time
fuzz TARGET SECONDS="3600":
    fuzz/run {{TARGET}} {{SECONDS}}

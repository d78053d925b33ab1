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

# The tests with other random cases, ROUNDS times; a failure names its seed
properties ROUNDS="10":
    for seed in $(shuf -i 1-4000000000 -n {{ROUNDS}}); do \
        PROPTEST_RNG_SEED=$seed cargo test --workspace --locked || { echo "PROPTEST_RNG_SEED=$seed"; exit 1; }; \
    done

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

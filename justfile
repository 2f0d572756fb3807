# Recipes: `just` lists them. `sh tests/run.sh` does everything without just, as CI does.

[private]
default:
    @just --list --unsorted

# formatting, lints, docs
check:
    cargo fmt --all --check
    cargo clippy --workspace --all-targets --locked -- -D warnings
    RUSTDOCFLAGS="-D warnings" cargo doc --workspace --no-deps --locked --quiet

# the Rust tests of one crate (signals, plant, estimate, files, experiment, report, paper, cli), or all
test crate="":
    {{ if crate == "" { "cargo test --workspace" } else { "cargo test -p frfid-" + crate } }}

# the wheel into the active virtual environment, its stubs, the Python tests
py *options="tests/python":
    pip install --quiet ".[test]"
    python -m mypy.stubtest frfid --ignore-disjoint-bases
    python -m pytest -q {{ options }}

# README, tutorial and how-to, command by command, with the installed frfid
docs:
    python -m pytest -q tests/docs

# figures of the house: lengths, rooms, circles, paths of the docs
house:
    python tests/house/measure.py
    python -m pytest -q tests/house

# criterion, all benches or those named
bench *names:
    cargo bench {{ names }}

# the same work with other packages, in an environment of its own: answers compared, ratios printed and written into the documents
peers *options:
    python3.12 benches/peers {{ options }}

# instructions of the same work, counted by valgrind, written into docs/performance.md
instructions:
    python3.12 benches/peers --instructions

# the same scenarios in best-linear-approximation and pyFRF: answers against each other and the truth, what each gives
answers:
    python tests/peers/side_by_side.py

# how often the stated regions hold the truth: every case, 6000 runs each (a quarter of an hour)
coverage:
    FRFID_COVERAGE_LINES=6000 cargo test --release -p frfid-estimate --test coverage --test excerpt_bias --test compare_noise -- --include-ignored --nocapture
    cargo test --release -p frfid-experiment --test glides -- --include-ignored --nocapture

# golden numbers anew, by numpy and scipy, and those of the command line; look at the difference
golden:
    python tests/golden/bla.py
    python tests/golden/pinv.py
    cargo build
    python tests/behaviour/golden.py target/debug/frfid

# the stubs against the compiled module
stubs:
    python -m mypy.stubtest frfid --ignore-disjoint-bases

# the paper, sections 6 and 7
demo:
    cargo run --release -- demo

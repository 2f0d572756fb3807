#!/usr/bin/env sh
# Every check of the project, in one command: formatting, lints, the Rust tests, the wheel in a fresh virtual environment,
# its stubs and the Python tests. Needs Rust, Python 3.10 or newer with venv, and a network for packages.
# What it makes beside target/ goes into a temporary folder that is removed at the end.
set -eu
cd "$(dirname "$0")/.."
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT

step() { printf '\n== %s\n' "$*"; }

step "formatting and lints"
cargo fmt --all --check
cargo clippy --workspace --all-targets --locked -- -D warnings
RUSTDOCFLAGS="-D warnings" cargo doc --workspace --no-deps --locked --quiet

step "the wheel, in a fresh virtual environment"
python3 -m venv "$work/venv"
. "$work/venv/bin/activate"
# in the profile of the Rust tests, which then find most of it built: minutes less, and the tests do not ask for speed
MATURIN_PEP517_ARGS="--profile dev" pip install --quiet --disable-pip-version-check ".[test]"

step "Rust tests"
cargo test --workspace --locked

step "benches, once each with their answers checked"
cargo test --workspace --bench '*' --locked   # the packages of before: nothing is built twice

step "stubs and Python tests"
python -m mypy.stubtest frfid --ignore-disjoint-bases
python -m pytest tests -q -n auto

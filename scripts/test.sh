#!/usr/bin/env bash
# Sets up, builds everything and runs all tests. Arguments go to ctest, e.g. scripts/test.sh -R Replay.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."

scripts/build.sh release
# Three more than cores: many tests wait for processes and networks more than they compute, and a test in the browser counts as two.
ctest --preset release --parallel "${HYDROSCOPE_TEST_JOBS:-$(($(nproc) + 3))}" "$@"

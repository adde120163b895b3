#!/usr/bin/env bash
# Sets up, builds everything and runs the tests but for the long ones. Arguments go to ctest.
#   scripts/test.sh              eight to nine minutes after the build
#   scripts/test.sh -R Replay    those whose names hold Replay
#   scripts/test.sh --long       the long ones of tests/long_tests.txt
#   scripts/test.sh --quarter    every fourth of the long ones, others after each commit
# Without arguments the tests of a suite share a process, as most take less than a process takes to begin; else each has its own.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."

which=(-LE '^long$')
if (($# == 0)); then which+=(-C suites); fi
case ${1:-} in
  --long) which=(-L '^long$') && shift ;;
  --quarter) which=(-L '^long$' -I "$(($(git rev-list --count HEAD) % 4 + 1)),,4") && shift ;;
esac
scripts/build.sh release
# Three more than cores: many tests wait for processes and networks more than they compute, and a test in the browser counts as two.
ctest --preset release "${which[@]}" --parallel "${HYDROSCOPE_TEST_JOBS:-$(($(nproc) + 3))}" "$@"

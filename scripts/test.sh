#!/usr/bin/env bash
# Sets up, builds everything and runs the tests but for the long ones. Arguments go to ctest.
#   scripts/test.sh              some seven minutes after the build
#   scripts/test.sh -R Replay    those whose names hold Replay
#   scripts/test.sh --long       the long ones of tests/long_tests.txt
#   scripts/test.sh --quarter    every fourth of the long ones, others after each commit
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."

which=(-LE '^long$')
case ${1:-} in
  --long) which=(-L '^long$') && shift ;;
  --quarter) which=(-L '^long$' -I "$(($(git rev-list --count HEAD) % 4 + 1)),,4") && shift ;;
esac
scripts/build.sh release
# Three more than cores: many tests wait for processes and networks more than they compute, and a test in the browser counts as two.
ctest --preset release "${which[@]}" --parallel "${HYDROSCOPE_TEST_JOBS:-$(($(nproc) + 3))}" "$@"

#!/usr/bin/env bash
# Sets up, builds everything and runs the tests. Those of the suites that end in AtLength prove by many or long cases what shorter
# tests guard, and take a fifth of the time: they run with --at-length, before a release and after changes of what they test.
#   scripts/test.sh              all but those
#   scripts/test.sh --at-length  all
#   scripts/test.sh -R Replay    other arguments go to ctest
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."

without=(-E 'AtLength\.')
if [[ ${1:-} == --at-length ]]; then without=() && shift; fi
scripts/build.sh release
# Three more than cores: many tests wait for processes and networks more than they compute, and a test in the browser counts as two.
ctest --preset release --parallel "${HYDROSCOPE_TEST_JOBS:-$(($(nproc) + 3))}" "${without[@]}" "$@"

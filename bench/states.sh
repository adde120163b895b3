#!/usr/bin/env bash
# Models with states: simulation with sensitivities beside plain simulation and beside the same by hand in C++; a fit beside
# scipy's solve_ivp and least_squares on the same log, in one run.
#   bench/states.sh [REPEATS]    default 20
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."

repeats=${1:-20}
scripts/build.sh bench states_bench
out=build/bench/data
mkdir -p "$out"
export OPENBLAS_NUM_THREADS=1 OMP_NUM_THREADS=1
{
  build/bench/bench/states_bench "$out/tanks.csv" "$repeats"
  /usr/bin/python3 bench/scipy_states.py "$out/tanks.csv"
} | awk '{ printf "%-40s %12.3f ms %s\n", $1, 1e3 * $2, substr($0, index($0, $3)) }'

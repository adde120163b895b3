#!/usr/bin/env bash
# The flexible axis fitted by the program beside differential evolution at the published settings (pagmo2), in one run: evaluations,
# time, cost. Differential evolution may take TIMES as many simulations as our fit costs, some ten minutes.
#   bench/flexible_axis.sh [MACHINE [TIMES]]    default 0 (the published sizes), 500
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."

scripts/build.sh bench flexible_axis_bench
build/bench/bench/flexible_axis_bench "${1:-0}" "${2:-500}"

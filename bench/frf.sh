#!/usr/bin/env bash
# Frequency response of 60 s at 1 kHz beside scipy's cross spectrum and coherence of the same noise, in one run.
#   bench/frf.sh [REPEATS]    default 20
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."

repeats=${1:-20}
scripts/build.sh bench frf_bench
out=build/bench/data
mkdir -p "$out"
export OPENBLAS_NUM_THREADS=1 OMP_NUM_THREADS=1
{
  build/bench/bench/frf_bench "$out/noise.bin" "$repeats"
  /usr/bin/python3 bench/scipy_csd.py "$out/noise.bin" "$repeats"
} | awk '{ printf "%-28s %8.2f ms\n", $1, 1e3 * $2 }'

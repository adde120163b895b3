#!/usr/bin/env bash
# The ranking step of `explain` beside scikit-learn's orthogonal matching pursuit on the same equations, in one run.
#   bench/ranking.sh [SECONDS_OF_LOG [REPEATS]]    default 120 s, 20
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."

seconds=${1:-120}
repeats=${2:-20}
scripts/build.sh bench ranking_bench hydroscope
out=build/bench/data
mkdir -p "$out"
log=$out/leak_$seconds.csv
[[ -f $log ]] || build/bench/hydroscope simulate press --out "$log" --seconds "$seconds" --seed 1 --effect internal_leakage
export OPENBLAS_NUM_THREADS=1 OMP_NUM_THREADS=1
ours=$(build/bench/bench/ranking_bench "$log" machines/die_cushion.toml "$out/equations.bin" "$repeats")
read -r _ _ _ columns base <<< "${ours%%$'\n'*}"
theirs=$(/usr/bin/python3 bench/sklearn_omp.py "$out/equations.bin" "$columns" "$base" "$repeats")
printf '%s\n%s\n' "$ours" "$theirs" | awk '
  $1 == "effect" || $1 == "columns" { rest = rest "\n" $0; next }
  { printf "%-28s %9.2f ms   %d equations, %d columns\n", $1, 1e3 * $2, $3, $4 }
  END { print rest }'

#!/usr/bin/env bash
# How fast a replay is, stage by stage, beside pandas on the same file in the same run. CPU time on one core, best of
# several runs.
#   bench/replay.sh [SECONDS_OF_LOG [REPEATS]]    default 2000 s (a million rows, 80 MB), 5
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."

seconds=${1:-2000}
repeats=${2:-5}
out=build/bench/data
mkdir -p "$out"
log=$out/press_$seconds.csv
scripts/build.sh bench replay_bench
if [[ ! -f $log ]]; then
  scripts/build.sh bench hydroscope
  build/bench/hydroscope simulate press --out "$log" --seconds "$seconds" --seed 1
fi

core=()
if command -v taskset > /dev/null; then core=(taskset -c "$(taskset -pc $$ | sed 's/.*[:,-] *//')"); fi
{
  "${core[@]}" build/bench/bench/replay_bench "$log" machines/die_cushion.toml "$repeats"
  "${core[@]}" /usr/bin/python3 bench/pandas_read.py "$log" "$repeats"
  "${core[@]}" /usr/bin/python3 bench/pandas_rls.py "$log" 50000
} | awk '
  { name[NR] = $1; ns[NR] = 1e9 * $2 / $3; if ($1 == "pandas.read_csv") pandas = ns[NR] }
  END {
    printf "\n%-24s %10s %14s %22s\n", "", "ns/row", "million rows/s", "times pandas.read_csv"
    for (k = 1; k <= NR; ++k) printf "%-24s %10.0f %14.2f %22.2f\n", name[k], ns[k], 1e3 / ns[k], pandas / ns[k]
  }'

#!/usr/bin/env bash
# CPU time of `hydroscope explain` on logs of a die cushion, the whole command: user and system, best of several runs.
#   bench/explain.sh [REPEATS [LOG...]]    default 5, and logs of 120 s with and without a hidden effect
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."

repeats=${1:-5}
shift || true
scripts/build.sh release hydroscope
hydroscope=build/release/hydroscope
logs=("$@")
if (($# == 0)); then
  out=build/bench/data
  mkdir -p "$out"
  effects=("" internal_leakage=4e-12 tank_back_pressure=8e11 oil_viscosity=0.006 spool_hysteresis=0.005)
  for k in "${!effects[@]}"; do
    name=${effects[k]%%=*}
    log=$out/explain_${name:-nothing}.csv
    "$hydroscope" simulate press --out "$log" --seconds 120 --seed $((k + 1)) ${effects[k]:+--effect "${effects[k]}"} >/dev/null
    logs+=("$log")
  done
fi

for log in "${logs[@]}"; do
  for ((k = 0; k < repeats; ++k)); do
    TIMEFORMAT='%U %S'
    { time "$hydroscope" explain "$log" --machine machines/die_cushion.toml >/dev/null 2>&1; } 2>&1
  done | awk -v name="$(basename "$log")" '
    { cpu = $1 + $2; if (NR == 1 || cpu < least) least = cpu } END { printf "%-32s %.2f s\n", name, least }'
done

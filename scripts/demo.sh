#!/usr/bin/env bash
# Builds Hydroscope and shows its main job on a simulated press whose piston seal wears: logs of ten days are replayed
# into a trend database, and a maintenance report is written.
#   scripts/demo.sh [DIRECTORY]    where logs, database and report go; default out/demo
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."

scripts/build.sh release hydroscope
hydroscope=build/release/hydroscope
machine=machines/die_cushion.toml
out=${1:-out/demo}
mkdir -p "$out"
out=$(cd "$out" && pwd)
rm -f "$out"/day_*.csv "$out"/press.db "$out"/press.db-wal "$out"/press.db-shm "$out"/report.html

echo
echo "1. Simulating the logs of ten days. The piston seal is whole for four days, then its leakage grows."
leakage=(0 0 0 0 1e-12 2e-12 3e-12 4e-12 5e-12 6e-12)  # m3/(s Pa)
oil_start=(26 31 28 33 27 30 34 29 32 28)              # degC; the cushion warms by about 8 K during each log
logs=()
for day in "${!leakage[@]}"; do
  log="$out/day_$(printf '%02d' $((day + 1))).csv"
  "$hydroscope" simulate press --out "$log" --seconds 60 --seed $((day + 1)) \
    --effect "internal_leakage=${leakage[$day]}" --oil "${oil_start[$day]}:$((oil_start[day] + 8))"
  logs+=("$log")
done

echo
echo "2. Parameters of the first day, as one fit:"
"$hydroscope" fit "${logs[0]}" --machine "$machine"

echo
echo "3. Replaying all logs through the pipeline that would watch the machine live:"
"$hydroscope" replay "${logs[@]}" --machine "$machine" --db "$out/press.db" --report "$out/report.html"

echo
echo "4. What does the model miss on the last day?"
"$hydroscope" explain "${logs[-1]}" --machine "$machine"

echo
echo "Open the maintenance report: $out/report.html"

#!/usr/bin/env bash
# Builds Hydroscope and shows its main job on a simulated press whose piston seal wears: logs of ten days are replayed
# into a trend database, what changed is found from the database alone, the missing effect is named, added to the model,
# and promoted, so that the leak has a trend of its own.
#   scripts/demo.sh [DIRECTORY]    where logs, database and report go; default out/demo
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."

scripts/build.sh release hydroscope
hydroscope=build/release/hydroscope
machine=machines/die_cushion.toml
out=${1:-out/demo}
mkdir -p "$out"
out=$(cd "$out" && pwd)
rm -f "$out"/day_*.csv "$out"/press.toml "$out"/press.v*.toml "$out"/press.db* "$out"/{report,explain}.html "$out"/{simulate,replay}.txt

step() { printf '\n\033[1m%s\033[0m\n' "$*"; }
show() { printf '$ hydroscope %s\n' "${*//$out\//}"; "$hydroscope" "$@"; }

step "1. Ten days of a press. The piston seal is whole for five days, then its leakage grows."
leakage=(0 0 0 0 0 2e-12 3e-12 4e-12 5e-12 6e-12)  # m3/(s Pa)
oil_start=(26 31 28 33 27 30 34 29 32 28)          # degC; the cushion warms by about 8 K during each log
logs=()
for day in "${!leakage[@]}"; do
  log="$out/day_$(printf '%02d' $((day + 1))).csv"
  "$hydroscope" simulate press --out "$log" --seconds 60 --seed $((day + 1)) \
    --effect "internal_leakage=${leakage[$day]}" --oil "${oil_start[$day]}:$((oil_start[day] + 8))" >"$out/simulate.txt"
  logs+=("$log")
done
cp "$machine" "$out/press.toml"
echo "Logs day_01.csv to day_10.csv and the machine file press.toml are in $out"

step "2. The first day: the parameters of the machine, as one fit."
show fit "${logs[0]}" --machine "$out/press.toml"

step "3. All days through the pipeline that would watch the machine live, into a trend database."
"$hydroscope" replay "${logs[@]}" --machine "$out/press.toml" --db "$out/press.db" --report "$out/report.html"

step "4. What changed between day 5 and day 6? From the database alone."
show explain --db "$out/press.db" --since run:6

step "5. The last day in detail: measured against modelled flow."
"$hydroscope" compare "${logs[-1]}" --machine "$out/press.toml" | sed -n '1,15p'

step "6. Which effect does the model miss?"
show explain "${logs[-1]}" --machine "$out/press.toml" --report "$out/explain.html"

step "7. Make it part of the model, and watch the error fall."
show model add internal_leakage "${logs[-1]}" --machine "$out/press.toml"
show model history --machine "$out/press.toml"

step "8. From now on replay and monitor use this model: the leak becomes a parameter with a trend."
show model promote --machine "$out/press.toml" --db "$out/press.db"
"$hydroscope" simulate press --out "$out/day_11.csv" --seconds 60 --seed 11 --effect internal_leakage=6e-12 >"$out/simulate.txt"
"$hydroscope" replay "$out/day_11.csv" --machine "$out/press.toml" --db "$out/press.db" --report "$out/report.html" \
  >"$out/replay.txt"
show trends --db "$out/press.db" --last 5

step "Open the reports:"
echo "  $out/report.html     maintenance report of all days"
echo "  $out/explain.html    what the model missed on day 10"

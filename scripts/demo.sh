#!/usr/bin/env bash
# Builds Hydroscope and shows its main job: a simulated press with four die cushions and the service that watches it,
# two processes that talk by DDS and Modbus TCP. The service learns the healthy press, the piston seal of one cushion
# wears within seconds, the alarm arrives with its explanation, a SCADA client reads and acknowledges it,
# and the page over all of it is served until Ctrl-C.
#   scripts/demo.sh [DIRECTORY]    where machine file, database and logs go; default out/demo
# HYDROSCOPE names a program that is built already.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."

hydroscope=${HYDROSCOPE:-}
if [[ -z $hydroscope ]]; then
  scripts/build.sh release hydroscope
  hydroscope=$PWD/build/release/hydroscope
fi
out=${1:-out/demo}
mkdir -p "$out"
out=$(cd "$out" && pwd)
rm -f "$out"/press*
speed=15                    # times real time
commissioning=100           # strokes; 1500 in life
press_port=1592 scada_port=1593  # not the usual ones: a service may run on this machine already

step() { printf '\n\033[1m%s\033[0m\n' "$*"; }
whole() { COLUMNS=400 "$hydroscope" "$@"; }  # lines that grep takes as a whole
show() { printf '$ hydroscope %s\n' "${*//$out\//}"; "$hydroscope" "$@"; }

# --- A machine file of its own, press and service -----------------------------------------------------------------
sed -e "s/^port = 1502\b/port = $press_port/" -e "s/^domain = 0\b/domain = 92/" machines/press_live.toml >"$out/press.toml"
cat >>"$out/press.toml" <<END

[feeds.modbus]
port = $scada_port
END
sed -e "s/^commissioning = 1500\b/commissioning = $commissioning/" machines/die_cushion_rules.toml >"$out/press_rules.toml"

stop() {
  exec 3>&- || true
  for process in "${service:-}" "${press:-}" "${page:-}"; do
    if [[ -n $process ]]; then kill "$process" 2>/dev/null || true; fi
  done
  rm -f "$out/press.orders"
}
trap stop EXIT
alive() {
  kill -0 "$1" 2>/dev/null || { echo "$2 ended early:" >&2; tail -5 "$out/$3" >&2; exit 1; }
}

# Waits until `command` succeeds; tells how the axes stand meanwhile. Learning and explaining stand back behind all other work,
# so that a machine with much to do may take minutes.
wait_for() {
  local seconds=400 told="" line=""
  for ((i = 0; i < seconds; ++i)); do
    alive "$service" "The service" press.service.txt
    alive "$press" "The press" press.machine.txt
    if "$@"; then return; fi
    if ((i % 5 == 0)); then
      line=$(whole status --db "$out/press.db" 2>/dev/null | grep -m1 '^health') || true
      if [[ $line != "$told" ]]; then echo "  $line"; told=$line; fi
    fi
    sleep 1
  done
  echo "nothing came within $seconds s; the service said at last:" >&2
  tail -5 "$out/press.service.txt" >&2
  exit 1
}
events() { "$hydroscope" alarms --db "$out/press.db" journal --quiet --json - 2>/dev/null | grep -c "\"event\": \"$1\""; }
learned() { [[ $(events reference_learned) -ge 4 ]]; }
explained() { [[ $(events explained) -ge 1 ]]; }

step "1. A press with four cushions works $speed times faster than in life; the service watches it."
mkfifo "$out/press.orders"
"$hydroscope" simulate press --serve "$out/press.toml" --speed "$speed" --oil 38:42 <>"$out/press.orders" >"$out/press.machine.txt" 2>&1 &
press=$!
exec 3>"$out/press.orders"
"$hydroscope" serve "$out/press.toml" --db "$out/press.db" --port 0 >"$out/press.service.txt" 2>&1 &
service=$!
echo "  press: process $press, service: process $service, database: $out/press.db"

step "2. It learns the healthy press from $commissioning strokes of each cushion."
wait_for learned
whole status --db "$out/press.db" | grep -E '^(writer|health)'

step "3. The piston seal of cushion 2 wears: within 20 s of the press's time it leaks 2.4 l/min at 200 bar."
echo "effect internal_leakage=2e-12 axis=2 ramp=20" >&3
wait_for explained
show alarms --db "$out/press.db" list

step "4. A SCADA system reads the same from the service's Modbus registers, and acknowledges."
show alarms --modbus "127.0.0.1:$scada_port" | tee "$out/press.scada.txt"
number=$(awk '/ internal_leakage,/ {print $1; exit}' "$out/press.scada.txt")
show alarms --modbus "127.0.0.1:$scada_port" --ack "$number" >"$out/press.ack.txt"
head -2 "$out/press.ack.txt"
show alarms --db "$out/press.db" journal --last 3

step "5. Press and service stop; every stroke stored is what a replay of its raw signals gives, to the last bit."
echo quit >&3
wait "$press"
kill -TERM "$service"
wait "$service"
service="" press=""
show verify-live --db "$out/press.db"

step "6. The page shows it. Go on there, or with:"
echo "  $hydroscope explain --db $out/press.db --machine-name press/cushion_2"
echo "  $hydroscope trends --db $out/press.db"
echo "  scripts/demo_logs.sh     ten days of logs: compare, locate, explain, extend, report"
"$hydroscope" open --db "$out/press.db" --machine "$out/press.toml" >"$out/press.page.txt" 2>&1 &
page=$!
for ((i = 0; i < 100; ++i)); do
  grep -qs '^http' "$out/press.page.txt" && break
  alive "$page" "The page" press.page.txt
  sleep 0.1
done
echo
cat "$out/press.page.txt"
if [[ -t 1 ]]; then wait "$page"; fi  # a person looks at it until Ctrl-C

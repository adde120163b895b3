#!/usr/bin/env bash
# Runs each parser of what comes from outside under libFuzzer, with address and undefined-behaviour checks:
#   scripts/fuzz.sh            a minute each
#   scripts/fuzz.sh 600        ten minutes each
# What was found stays in build/fuzz/corpus and is where the next run begins. A crash stops it and leaves its input
# there as crash-*. Needs clang (scripts/setup.sh --fuzz); without it, it says so and succeeds.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."

seconds=${1:-60}
if ! command -v clang++ >/dev/null; then
  echo "fuzz: clang is not installed, nothing was run; scripts/setup.sh --fuzz installs it"
  exit 0
fi
targets=(acquisition/message_fuzz acquisition/registers_fuzz models/machine_fuzz replay/csv_fuzz alarms/feeds/requests_fuzz)
scripts/build.sh fuzz "${targets[@]##*/}"
for target in "${targets[@]}"; do
  corpus=build/fuzz/corpus/${target##*/}
  mkdir -p "$corpus"
  [[ $target == models/machine_fuzz ]] && cp -n machines/*.toml "$corpus/"
  echo "fuzz: ${target##*/}, $seconds s"
  if ! build/fuzz/"$target" -max_total_time="$seconds" -timeout=20 -rss_limit_mb=2048 \
    -artifact_prefix="$corpus/" -print_final_stats=1 "$corpus" >"$corpus.log" 2>&1; then
    tail -n 40 "$corpus.log"
    echo "fuzz: ${target##*/} failed; its input is in $corpus"
    exit 1
  fi
  grep -E "number_of_executed_units|new_units_added" "$corpus.log"
done
echo "fuzz: all ${#targets[@]} parsers ran $seconds s without a finding"

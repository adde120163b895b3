#!/usr/bin/env bash
# Runs each parser of what comes from outside under libFuzzer, with address and undefined-behaviour checks:
#   scripts/fuzz.sh            a minute each
#   scripts/fuzz.sh 600        ten minutes each
#   scripts/fuzz.sh 600 csv mat  these alone
# HYDROSCOPE_FUZZ_JOBS of them (2) run at a time. What was found stays in build/sanitize/corpus and is where the next run
# begins. A crash stops it and leaves its input there as crash-*. Built as scripts/sanitize.sh builds; installs what
# that needs.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."

targets=(
  acquisition/message      # DDS messages
  acquisition/registers    # answers of a Modbus controller
  models/machine           # machine files, expressions
  replay/csv               # logs as text
  storage/blobs            # raw rows and Grams of a database
  pipeline/run_summary      # JSON in a database
  page/api_arguments       # bodies of requests to the page
  page/endpoints           # what the page's server reads, and every request it answers
  diagnosis/rules          # rules of the drift watch
  alarms/feeds/requests    # Modbus requests to the service
  alarms/feeds/payload     # commands by MQTT Sparkplug
)
# By name only: matio, which reads MAT files for us, takes the memory that a damaged file claims to need.
by_name=(replay/mat)

# fuzz TARGET SECONDS: 255, which ends xargs, if it finds something.
fuzz() {
  local name=${1##*/} corpus=build/sanitize/corpus/${1##*/}
  mkdir -p "$corpus"
  case $name in
    machine) cp -n machines/*.toml "$corpus/" ;;
    rules) cp -n machines/*_rules.toml "$corpus/" ;;
    csv) cp -n tests/fuzz_seeds/log.csv "$corpus/" ;;
    mat) cp -n tests/fuzz_seeds/*.mat "$corpus/" ;;
    api_arguments) cp -n tests/fuzz_seeds/page_mapping.json "$corpus/" ;;
    endpoints) cp -n tests/fuzz_seeds/page_request.txt "$corpus/" ;;
    requests) cp -n tests/fuzz_seeds/modbus_requests.bin "$corpus/" ;;
  esac
  local memory=(-rss_limit_mb=2048)
  [[ $name == mat ]] && memory=(-rss_limit_mb=0 -malloc_limit_mb=0)
  if ! ASAN_OPTIONS=allocator_may_return_null=1 "build/sanitize/${1}_fuzz" -max_total_time="$2" -timeout=60 "${memory[@]}" \
    -artifact_prefix="$corpus/" -print_final_stats=1 "$corpus" >"$corpus.log" 2>&1; then
    tail -n 40 "$corpus.log"
    echo "fuzz: $name failed; its input is in $corpus"
    return 255
  fi
  echo "fuzz: $name, $2 s: $(sed -n 's/stat::number_of_executed_units: *//p' "$corpus.log") inputs," \
    "$(sed -n 's/stat::new_units_added: *//p' "$corpus.log") of them new"
}
export -f fuzz

seconds=${1:-60}
shift || true
if [[ $# -gt 0 ]]; then
  wanted=()
  for target in "${targets[@]}" "${by_name[@]}"; do
    for name in "$@"; do [[ ${target##*/} == "$name" ]] && wanted+=("$target"); done
  done
  [[ ${#wanted[@]} -eq $# ]] || { echo "fuzz: not all of '$*' are parsers: ${targets[*]##*/} ${by_name[*]##*/}" >&2; exit 2; }
  targets=("${wanted[@]}")
fi
names=("${targets[@]##*/}")
scripts/build.sh sanitize "${names[@]/%/_fuzz}"
printf '%s\n' "${targets[@]}" | xargs -P "${HYDROSCOPE_FUZZ_JOBS:-2}" -I{} bash -c 'fuzz "$@"' fuzz {} "$seconds"
echo "fuzz: ${#targets[@]} parsers ran $seconds s each without a finding"

#!/usr/bin/env bash
# Builds with AddressSanitizer and UBSan what reads, computes, diagnoses and stores, below the rooms of the program, and runs
# its tests but for the longest:
#   scripts/sanitize.sh          all of these folders
#   scripts/sanitize.sh quarter  a quarter of them, the next after the next commit, each on the others as they are released
#   scripts/sanitize.sh all      the rooms of the program too, and the longest tests
#   scripts/sanitize.sh threads  what has threads, with ThreadSanitizer
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."

export LSAN_OPTIONS=suppressions=$PWD/scripts/lsan_suppressions.txt:print_suppressions=0
if [[ ${1:-} == all ]]; then
  scripts/build.sh sanitize
  exec ctest --preset sanitize --parallel 2
fi
if [[ ${1:-} == threads ]]; then
  # Libraries that are not built with it lock as they do.
  export TSAN_OPTIONS=suppressions=$PWD/scripts/tsan_suppressions.txt:detect_deadlocks=0:report_mutex_bugs=0
  folders=(acquisition alarms dds live page)
  scripts/build.sh tsan "${folders[@]/%/_test}"
  for folder in "${folders[@]}"; do "build/tsan/tests/${folder}_test" --gtest_brief=1; done
  exit
fi
folders=(diagnosis estimation acquisition alarms models simulator storage replay dds machines core)  # the longest first
export tests=build/sanitize/tests suffix=_test
if [[ ${1:-} == quarter ]]; then
  quarters=("diagnosis" "estimation" "models acquisition dds core" "alarms machines simulator storage replay")
  read -ra folders <<<"${quarters[$(git rev-list --count HEAD) % 4]}"
  tests=build/release/tests suffix=_sanitized_test
  scripts/setup.sh --sanitize
  scripts/build.sh release "${folders[@]/%/$suffix}"
else
  scripts/build.sh sanitize "${folders[@]/%/$suffix}"
fi
# The long tests, and what repeats one thing a thousand times, or simulates or explains for a second and more without sanitizers,
# and ten here.
long=$(sed -n 's/^[a-z]* //p' tests/long_tests.txt | paste -sd :)
export long=-$long:FrequencyResponse.Intervals*:*Endurance.*:FloorTrust.Believes*:LinearForm.Intervals*:NoiseFloor.*:SamplingRate.Is*\
:StateFit.Intervals*:StrokeClusters.Intervals*:Imperfections.Intermittent*:RandomMachine.IsValid*:SimulatePress.EveryEffect*\
:Standstill.Healthy*:StateLimit.OneBelow*:ParameterDrift.*:ExplainStates.FindsNothing*:ExplainStates.Gives*:ExplainSamples.Without*\
:ExperimentOfADrift.*:ExperimentTest.Recorded*:Sampling.How*:StateExperiment.WhatIsProposed*:StateExperiment.NoRecord*\
:OddStrokes.ALaw*:OddStrokes.ALeak*:OddStrokes.ABad*:OddStrokes.OneChange*
# test FOLDER SHARD: 255, which ends xargs, if a test fails; its output stays in one piece.
test_folder() {
  local output
  if ! output=$(ASAN_OPTIONS=new_delete_type_mismatch=0 GTEST_TOTAL_SHARDS=$(nproc) GTEST_SHARD_INDEX=$2 "$tests/$1$suffix" \
    --gtest_brief=1 --gtest_filter="$long" 2>&1); then
    echo "sanitize: $1 failed"$'\n'"$output"
    return 255
  fi
  echo "sanitize: $1"$'\n'"$output"
}
export -f test_folder
for folder in "${folders[@]}"; do seq -f "$folder %g" 0 $(($(nproc) - 1)); done | xargs -P "$(nproc)" -L 1 bash -c 'test_folder "$@"' test_folder

#!/usr/bin/env bash
# Builds with AddressSanitizer and UBSan what reads, computes, diagnoses and stores, below the rooms of the program, and runs
# its tests but for the longest. scripts/sanitize.sh all: everything; half: one half of these folders, the other after the next
# commit; threads: what has threads, with ThreadSanitizer.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."

export LSAN_OPTIONS=suppressions=$PWD/scripts/lsan_suppressions.txt:print_suppressions=0
folders=(diagnosis estimation acquisition alarms models simulator storage replay dds machines core)  # the longest first
if [[ ${1:-} == half ]]; then
  halves=("diagnosis acquisition dds" "estimation models alarms simulator storage replay machines core")
  read -ra folders <<<"${halves[$(git rev-list --count HEAD) % 2]}"
fi
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
scripts/build.sh sanitize "${folders[@]/%/_test}"
# They repeat one thing a thousand times, or simulate or explain for a second and more without sanitizers, and ten here. Of what
# only such tests reach (MissingDynamics, MissingLimit) one is run all the same.
export long=-FrequencyResponse.Intervals*:FrequencyResponse.Broadband*:*Endurance.*:FloorTrust.Believes*:IntegralEstimator.Time*\
:IntegralEstimator.StrokesThat*:LinearForm.Intervals*:LoopFollowing.AGain*:NoiseFloor.*:SamplingRate.Is*:StateFit.Intervals*\
:StrokeClusters.Intervals*:Imperfections.Of*:Imperfections.Intermittent*:RandomMachine.IsValid*:SimulatePress.EveryEffect*\
:Standstill.Healthy*:Predictability.FindsNothingIn*:MissingDynamics.Noise*:MissingLimit.A*:StateLimit.OneBelow*:ParameterDrift.*\
:ExplainStates.ACube*:ExplainStates.AStop*:ExplainStates.ARival*:ExplainStates.Names*:ExplainStates.FindsNothing*\
:ExplainStates.Gives*:ExplainStates.WhatStandsIn*:ExplainStates.CallsA*:ExplainSamples.Without*:ExperimentOfADrift.*:ExperimentTest.Recorded*:Sampling.How*:Sampling.WhereNoise*\
:StateExperiment.WhatIsProposed*:StateExperiment.NoRecord*:OddStrokes.After*:OddStrokes.ALaw*:OddStrokes.ALeak*:OddStrokes.ABad*:OddStrokes.Another*\
:OddStrokes.OneChange*
# test FOLDER: 255, which ends xargs, if a test fails; its output stays in one piece.
test_folder() {
  local output
  if ! output=$(ASAN_OPTIONS=new_delete_type_mismatch=0 "build/sanitize/tests/$1_test" --gtest_brief=1 \
    --gtest_filter="$long" 2>&1); then
    echo "sanitize: $1 failed"$'\n'"$output"
    return 255
  fi
  echo "sanitize: $1"$'\n'"$output"
}
export -f test_folder
printf '%s\n' "${folders[@]}" |
  xargs -P "$(nproc)" -I{} bash -c 'test_folder "$@"' test_folder {}

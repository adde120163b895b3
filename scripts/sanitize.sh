#!/usr/bin/env bash
# Builds with AddressSanitizer and UBSan what reads, computes and stores, below the rooms of the program, and runs its tests.
# scripts/sanitize.sh all: everything.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."

export LSAN_OPTIONS=suppressions=$PWD/scripts/lsan_suppressions.txt:print_suppressions=0
folders=(core dds models machines acquisition estimation storage alarms replay simulator)
if [[ ${1:-} == all ]]; then
  scripts/build.sh asan
  exec ctest --preset asan --parallel 2
fi
scripts/build.sh asan "${folders[@]/%/_test}"
for folder in "${folders[@]}"; do
  echo "sanitize: $folder"
  ASAN_OPTIONS=new_delete_type_mismatch=0 "build/asan/tests/${folder}_test" --gtest_brief=1
done

#!/usr/bin/env bash
# Sets up and builds one preset of CMakePresets.json: scripts/build.sh [PRESET [TARGET...]], default release.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."

preset=${1:-release}
shift || true
case "$preset" in
  bench) scripts/setup.sh --bench ;;
  sanitize | tsan) scripts/setup.sh --sanitize ;;
  *) scripts/setup.sh ;;
esac
cmake --preset "$preset" > "/tmp/hydroscope-configure.$$" || { cat "/tmp/hydroscope-configure.$$"; exit 1; }
rm -f "/tmp/hydroscope-configure.$$"
cmake --build --preset "$preset" ${1:+--target "$@"}

#!/usr/bin/env bash
# The page's server by libmicrohttpd beside one by Boost.Beast under 200 event streams, 50 of which stall, in one run: delay of
# events, of other requests, memory and CPU time.
#   bench/event_streams.sh [SECONDS [RUNS]]    default 10 s, 3 runs of each
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."

scripts/build.sh bench event_streams_bench
build/bench/bench/event_streams_bench "${1:-10}" "${2:-3}"

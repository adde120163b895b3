#!/usr/bin/env bash
# Looks at every source by itself: a name or header of ours that only sources compiled together with it bring along
# (HYDROSCOPE_UNITY) fails here. Nothing is generated. Needs build/release (scripts/build.sh), whose include paths and
# generated headers it uses. Usage:
#   scripts/plain.sh            all but tests, four minutes
#   scripts/plain.sh --quarter  every fourth of them, others after each commit
#   scripts/plain.sh FILE...
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."

read -ra paths <<<"$(grep -oE -- '(-I|-isystem )[^ "]+' build/release/compile_commands.json | sort -u | tr '\n' ' ')"
every=1
if [[ ${1:-} == --quarter ]]; then every=4 && shift; fi
if (($# == 0)); then
  turn=$(($(git rev-list --count HEAD) % every))
  mapfile -t files < <(git ls-files '*.cc' | grep -vE '(_test|_fuzz)\.cc$|^(bench|tests)/' |
    awk -v every=$every -v turn=$turn 'NR % every == turn')
  set -- "${files[@]}"
fi
compile=(clang++ -std=c++20 -Wall -Wextra -Werror '-DHYDROSCOPE_VERSION="0"' "${paths[@]}")
common=$(mktemp --suffix=.h)  # of the libraries that most sources read; half the time
trap 'rm -f "$common" "$common.pch"' EXIT
printf '#include <%s>\n' CLI/CLI.hpp Eigen/Dense fmt/format.h nlohmann/json.hpp >"$common"
"${compile[@]}" -fpch-instantiate-templates -x c++-header "$common" -o "$common.pch"
printf '%s\n' "$@" | xargs -P "$(nproc)" -n 4 "${compile[@]}" -include-pch "$common.pch" -fsyntax-only
echo "plain: $# sources stand by themselves"

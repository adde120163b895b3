#!/usr/bin/env bash
# Looks at every source by itself, as it stands, with clang: a name or header that only the sources compiled together with it
# bring along fails here, and so does what only GCC takes. Nothing is generated, so it takes a fraction of a build. Needs
# build/release (scripts/build.sh), whose include paths and generated headers it uses.
# Usage: scripts/plain.sh [FILE...], default all but tests.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."

read -ra paths <<<"$(grep -oE -- '(-I|-isystem )[^ "]+' build/release/compile_commands.json | sort -u | tr '\n' ' ')"
flags=(-std=c++20 -Wall -Wextra -Werror -DHYDROSCOPE_VERSION='"0"' "${paths[@]}")
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
# The large headers of others are read once.
printf '#include <%s>\n' Eigen/Dense nlohmann/json.hpp CLI/CLI.hpp fmt/format.h fmt/ranges.h toml++/toml.h > "$work/others.h"
clang++ "${flags[@]}" -x c++-header "$work/others.h" -o "$work/others.pch"
if (($# == 0)); then
  mapfile -t files < <(git ls-files '*.cc' | grep -vE '(_test|_fuzz)\.cc$|^(bench|tests)/')
  set -- "${files[@]}"
fi
printf '%s\n' "$@" | xargs -P "$(nproc)" -n 8 clang++ "${flags[@]}" -include-pch "$work/others.pch" -fsyntax-only
echo "plain: $# sources stand by themselves"

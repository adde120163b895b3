#!/usr/bin/env bash
# Looks at every source by itself, with clang: a name or header that only sources compiled together with it bring along fails
# here (HYDROSCOPE_UNITY), and so does what GCC alone takes. Nothing is generated. Needs build/release (scripts/build.sh),
# whose include paths and generated headers it uses. Usage: scripts/plain.sh [FILE...], default all but tests.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."

command -v clang++ >/dev/null || scripts/setup.sh --fuzz
read -ra paths <<<"$(grep -oE -- '(-I|-isystem )[^ "]+' build/release/compile_commands.json | sort -u | tr '\n' ' ')"
if (($# == 0)); then
  mapfile -t files < <(git ls-files '*.cc' | grep -vE '(_test|_fuzz)\.cc$|^(bench|tests)/')
  set -- "${files[@]}"
fi
printf '%s\n' "$@" | xargs -P "$(nproc)" -n 4 \
  clang++ -std=c++20 -Wall -Wextra -Werror -DHYDROSCOPE_VERSION='"0"' "${paths[@]}" -fsyntax-only
echo "plain: $# sources stand by themselves"

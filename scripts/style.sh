#!/usr/bin/env bash
# Fails if a source is not formatted as .clang-format says; scripts/style.sh --fix formats it. Installs clang-format if it
# is missing.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."

command -v clang-format >/dev/null || scripts/setup.sh --style
mapfile -t sources < <(git ls-files '*.cc' '*.h')
if [[ ${1:-} == --fix ]]; then
  clang-format -i "${sources[@]}"
else
  clang-format --dry-run -Werror "${sources[@]}"
  echo "style: ${#sources[@]} sources formatted"
fi

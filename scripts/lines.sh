#!/usr/bin/env bash
# Lines of C++ per folder, tests and fixtures apart from the rest.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."

printf '%-12s %8s %8s %8s\n' folder files lines tests
count() { # files from stdin
  xargs -r cat | wc -l
}
total=0
for folder in $(git ls-files '*.cc' '*.h' | cut -d/ -f1 | sort -u); do
  files=$(git ls-files "$folder/*.cc" "$folder/*.h")
  code=$(grep -vE '(_test|_fuzz)\.cc$|_fixture\.h$' <<<"$files" || true)
  tests=$(grep -E '(_test|_fuzz)\.cc$|_fixture\.h$' <<<"$files" || true)
  lines=$(count <<<"$code")
  printf '%-12s %8d %8d %8d\n' "$folder" "$(grep -c . <<<"$code" || true)" "$lines" "$(count <<<"$tests")"
  [[ $folder == tests ]] || total=$((total + lines))
done
printf '%-12s %8s %8d\n' 'all but tests' '' "$total"

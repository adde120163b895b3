#!/usr/bin/env bash
# Takes pictures of every page and state of `hydroscope open`, wide and as on a phone, light and dark, English and German.
# Usage: scripts/screenshots.sh [FOLDER], default out/screenshots
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."

scripts/build.sh release hydroscope
HYDROSCOPE=$PWD/build/release/hydroscope node web/tests/screenshots.mjs "${1:-out/screenshots}"

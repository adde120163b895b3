#!/usr/bin/env bash
# Installs what building Hydroscope needs on Debian 12, without questions. Does nothing if all is there.
#   scripts/setup.sh             to build and to run the tests
#   scripts/setup.sh --bench     and the benchmarks with the programs they compare with
#   scripts/setup.sh --sanitize  and what builds with sanitizers and the fuzz targets
#   scripts/setup.sh --style     and what formats the sources
set -euo pipefail

packages=(
  clang lld g++ cmake ninja-build pkg-config
  libeigen3-dev libceres-dev libtomlplusplus-dev libcli11-dev libexpected-dev libmatio-dev
  libsqlitecpp-dev libsqlite3-dev sqlite3 nlohmann-json3-dev libfmt-dev zlib1g-dev libfast-float-dev libboost-math-dev
  libfastrtps-dev libfastcdr-dev fastddsgen libmodbus-dev libssl-dev
  libmicrohttpd-dev libsodium-dev libspdlog-dev libsystemd-dev
  libpaho-mqttpp-dev libpaho-mqtt-dev libprotobuf-dev protobuf-compiler
  libgtest-dev libgmock-dev mosquitto mosquitto-clients nodejs openssl faketime
)
for option in "$@"; do
  case "$option" in
    --bench) packages+=(libbenchmark-dev libdlib-dev libblas-dev libpagmo-dev python3-numpy python3-pandas python3-sklearn python3-scipy) ;;
    --style) packages+=(clang-format) ;;
    --sanitize) packages+=(libclang-rt-14-dev) ;;
    *) echo "setup.sh: unknown option '$option', expected --bench, --sanitize or --style" >&2; exit 2 ;;
  esac
done

# Some packages of nodejs bring npm along and conflict with the one of its own.
command -v npm >/dev/null || packages+=(npm)
# In which the page is tested: Chromium without windows, or the whole.
command -v chromium-headless-shell chromium >/dev/null || packages+=(chromium-headless-shell fonts-dejavu-core)

missing=()
for package in "${packages[@]}"; do
  state=$(dpkg-query -W -f '${db:Status-Abbrev}' "$package" 2>/dev/null || true)
  [[ $state == ii* || $state == hi* ]] || missing+=("$package")
done
root=$(dirname "$0")/..
fetch=()  # folders whose npm packages are missing or older than their list
for folder in "$root/alarms/feeds/sparkplug/decoder" "$root/web"; do  # decodes MQTT payloads in tests | the page
  [[ $folder/node_modules/.package-lock.json -nt $folder/package-lock.json ]] || fetch+=("$folder")
done
if [[ ${#missing[@]} -eq 0 && ${#fetch[@]} -eq 0 ]]; then
  echo "setup: all ${#packages[@]} packages are there"
  exit 0
fi

if [[ ${#missing[@]} -gt 0 ]]; then
  echo "setup: installing ${missing[*]}"
  as_root=()
  if [[ $(id -u) -ne 0 ]]; then as_root=(sudo); fi
  apt=("${as_root[@]}" env DEBIAN_FRONTEND=noninteractive apt-get -q -o DPkg::Lock::Timeout=300)
  "${apt[@]}" update
  "${apt[@]}" install -y --no-install-recommends "${missing[@]}"
fi
fetching=()  # at the same time: the network is what takes long
for folder in "${fetch[@]}"; do
  npm ci --prefix "$folder" --no-audit --no-fund --ignore-scripts &
  fetching+=($!)
done
for job in "${fetching[@]}"; do wait "$job"; done

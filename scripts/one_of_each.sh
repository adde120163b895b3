#!/usr/bin/env bash
# Adds an effect, a kind of machine, a command, a log format, a feed and a source to a copy of the sources, compiles what was
# touched, and prints the files and lines that each took. Fails where one of them takes other than docs/architecture.md says.
# Usage: scripts/one_of_each.sh [compiler]
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."
compiler=${1:-c++}
copy=$(mktemp -d)
trap 'rm -rf "$copy"' EXIT
cp -r core models machines host setup cli replay acquisition storage alarms "$copy"
cd "$copy"
git init -q . && git add -A && git -c user.name=copy -c user.email=copy commit -qm copy

touched=()  # to be compiled, all together: most of the time goes to the headers that they share

# judge WHAT DOCUMENTED_LINES FILES_TO_COMPILE...: new files are free, lines in files that were there are counted.
judge() {
  local what=$1 documented=$2 created changed lines
  shift 2
  git add -A
  created=$(git diff --cached --name-only --diff-filter=A | wc -l)
  changed=$(git diff --cached --name-only --diff-filter=M | wc -l)
  lines=$(git diff --cached --numstat --diff-filter=M | awk '{n += $1} END {print n + 0}')
  touched+=("$@")
  printf '%-18s %d new file(s), %d line(s) in %d file(s) that were there\n' "$what" "$created" "$lines" "$changed"
  if ((lines != documented)); then
    echo "$what: $lines lines in files that were there, $documented are documented" >&2
    exit 1
  fi
  git -c user.name=copy -c user.email=copy commit -qm "$what"
}

# renamed FROM TO FILE: the file with one name in place of another.
renamed() { sed "s/$1/$2/g" "$3"; }

effects=machines/die_cushion/effects
renamed ExternalLeakage DrainLeakage $effects/external_leakage.cc | sed 's/external_leakage/drain_leakage/' > $effects/drain_leakage.cc
sed -i '0,/^  _(ReturnLineResistance)/s//  _(DrainLeakage) \\\n  _(ReturnLineResistance)/' $effects/effects.h
judge "effect" 1 $effects/drain_leakage.cc machines/die_cushion/library.cc

mkdir machines/winch
renamed kValve kWinch machines/valve/kind.h > machines/winch/kind.h
renamed kValve kWinch machines/valve/kind.cc | sed 's/machines\/valve/machines\/winch/; s/"valve"/"winch"/' > machines/winch/kind.cc
sed -i '/machines\/valve\/kind.h/i #include "machines/winch/kind.h"' machines/kinds.cc
sed -i 's/&kValve,/\&kWinch, \&kValve,/' machines/kinds.cc
judge "kind of machine" 2 machines/winch/kind.cc machines/kinds.cc

renamed AddInitCommand AddAdviseCommand cli/init.cc | sed 's/add_subcommand("init"/add_subcommand("advise"/' > cli/advise.cc
sed -i 's/^  _(Init) /  _(Advise) \\\n  _(Init) /' cli/commands.h
judge "command" 1 cli/advise.cc cli/command_line.cc

renamed CsvReader TdmsReader replay/csv_reader.h > replay/tdms_reader.h
sed -i 's/^    {IsMatFile, /    {IsTdmsFile, OpenTdms},\n    {IsMatFile, /; s/#include "replay\/mat_reader.h"/&\n#include "replay\/tdms_reader.h"/' replay/log_reader.cc
cat >> replay/tdms_reader.h <<'READER'
namespace hydroscope {
bool IsTdmsFile(const std::string& path);
Result<std::unique_ptr<LogReader>> OpenTdms(const std::string& path, const Machine& machine);
}  // namespace hydroscope
READER
judge "log format" 2 replay/log_reader.cc

mkdir alarms/feeds/opcua
for file in settings.h settings.cc; do
  renamed Modbus Opcua alarms/feeds/modbus/$file | sed 's/modbus/opcua/g' > alarms/feeds/opcua/$file
done
cat > alarms/feeds/opcua/opcua_feed.cc <<'FEED'
#include "alarms/feeds/feed_context.h"
#include "alarms/feeds/list.h"
#include "alarms/feeds/opcua/settings.h"
namespace hydroscope {
std::unique_ptr<Feed> MakeOpcuaFeed(const FeedContext& context) {
  class OpcuaFeed : public Feed {
    FeedStatus status() const override { return {.name = "opcua", .state = {"not yet written"}}; }
  };
  if (context.machine.feeds->Of<OpcuaFeedSpec>() == nullptr) return nullptr;
  return std::make_unique<OpcuaFeed>();
}
}  // namespace hydroscope
FEED
sed -i 's/^  _(Sparkplug)/  _(Opcua) \\\n  _(Sparkplug)/' alarms/feeds/list.h
judge "feed" 1 alarms/feeds/opcua/settings.cc alarms/feeds/opcua/opcua_feed.cc alarms/feeds/sections.cc alarms/feeds/feeds.cc

mkdir acquisition/opcua
for file in settings.h settings.cc; do
  renamed Modbus Opcua acquisition/modbus/$file | sed 's/modbus/opcua/g' > acquisition/opcua/$file
done
cat > acquisition/opcua/opcua_source.cc <<'SOURCE'
#include "acquisition/list.h"
#include "acquisition/opcua/settings.h"
namespace hydroscope {
std::vector<std::unique_ptr<Source>> MakeOpcuaSources(const Machine& machine, const Clock&, std::uint64_t) {
  class OpcuaSource : public Source {
    Status Start(Sink) override { return {}; }
    SourceStatus status() const override { return {.name = "opcua", .state = {"not yet written"}}; }
    void Stop() override {}
  };
  std::vector<std::unique_ptr<Source>> sources;
  if (machine.Source<OpcuaSpec>() != nullptr) sources.push_back(std::make_unique<OpcuaSource>());
  return sources;
}
}  // namespace hydroscope
SOURCE
sed -i 's/^  _(Modbus)/  _(Opcua) \\\n  _(Modbus)/' acquisition/list.h
judge "source" 1 acquisition/opcua/settings.cc acquisition/opcua/opcua_source.cc acquisition/source_kinds.cc acquisition/live_sources.cc

printf '#include "%s"\n' "${touched[@]}" > touched.cc
"$compiler" -std=c++20 -fsyntax-only -DHYDROSCOPE_VERSION='"0"' -I. -isystem /usr/include/eigen3 touched.cc

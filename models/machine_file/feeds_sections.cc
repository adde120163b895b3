// The [feeds] part of a machine file; what each feed's section holds stands in the feed's folder.
#include "models/machine_file/feed_section.h"
#include "models/machine_file/keys.h"
#include "models/machine_file/sections.h"

namespace hydroscope {

void ReadFeeds(TableReader& file, Machine& machine) {
  const toml::table* table = file.Table("feeds");
  if (table == nullptr) return;
  PartsSpec& feeds = machine.feeds.emplace();
  TableReader section(*table, "feeds", file.problems());
  section.AllowOnly(MachineFileKeys("feeds"));
  for (const FeedSection* feed : FeedSections())
    if (const toml::table* own = section.Table(feed->name)) {
      TableReader reader(*own, fmt::format("feeds.{}", feed->name), file.problems());
      reader.AllowOnly(feed->keys);
      feeds.settings.emplace(feed->name, feed->read(reader));
    }
}

std::string FeedsSections(const Machine& machine, const MachineNotes& notes) {
  if (!machine.feeds) return "";
  std::string text = Section("[feeds]", "Whom the live service tells.", {}, notes, "feeds");
  for (const FeedSection* feed : FeedSections())
    if (const auto at = machine.feeds->settings.find(feed->name); at != machine.feeds->settings.end()) {
      const std::string name = fmt::format("feeds.{}", feed->name);
      text += Section("[" + name + "]", std::string(feed->comment), feed->write(at->second), notes, name);
    }
  return text;
}

}  // namespace hydroscope

#include "alarms/feeds/sparkplug/settings.h"

#include "alarms/feeds/list.h"
#include "models/machine_file/sections.h"

namespace hydroscope {
namespace {

PartSettings ReadSparkplugSettings(TableReader& section) {
  SparkplugFeedSpec sparkplug;
  section.Text("broker", sparkplug.broker);
  if (!sparkplug.broker.starts_with("tcp://") && !sparkplug.broker.starts_with("ssl://"))
    section.Wrong("broker", "tcp://HOST:PORT or ssl://HOST:PORT, e.g. \"tcp://127.0.0.1:1883\"");
  for (const auto& [key, id] : {std::pair("group", &sparkplug.group), std::pair("node", &sparkplug.node),
                                std::pair("primary_host", &sparkplug.primary_host)}) {
    section.Text(key, *id);
    if (id->find_first_of("/+#") != std::string::npos || (section.Has(key) && id->empty()))
      section.Wrong(key, "a name without /, + and #");
  }
  if (sparkplug.group.empty()) sparkplug.group = SparkplugFeedSpec{}.group;
  section.Text("user", sparkplug.user);
  section.Text("password_file", sparkplug.password_file);
  for (const auto& [key, file] :
       {std::pair("ca_file", &sparkplug.ca_file), std::pair("certificate_file", &sparkplug.certificate_file),
        std::pair("key_file", &sparkplug.key_file)}) {
    section.Text(key, *file);
    if (!file->empty() && !sparkplug.broker.starts_with("ssl://"))
      section.Wrong(key,
                    "a file only with broker = \"ssl://...\": certificates are of encrypted connections");
  }
  if (sparkplug.certificate_file.empty() != sparkplug.key_file.empty())
    section.Problem("certificate_file and key_file go together: a certificate and its private key");
  return PartSettings(sparkplug);
}

Pairs WriteSparkplugSettings(const PartSettings& settings) {
  const SparkplugFeedSpec& sparkplug = *settings.As<SparkplugFeedSpec>();
  Pairs pairs = {{"broker", Quoted(sparkplug.broker)}, {"group", Quoted(sparkplug.group)}};
  const std::pair<const char*, const std::string*> optional[] = {
      {"node", &sparkplug.node},
      {"user", &sparkplug.user},
      {"password_file", &sparkplug.password_file},
      {"primary_host", &sparkplug.primary_host},
      {"ca_file", &sparkplug.ca_file},
      {"certificate_file", &sparkplug.certificate_file},
      {"key_file", &sparkplug.key_file}};
  for (const auto& [key, value] : optional)
    if (!value->empty()) pairs.emplace_back(key, Quoted(*value));
  return pairs;
}

}  // namespace

const FeedSection kSparkplugFeedSection = {
    .name = SparkplugFeedSpec::kName,
    .comment = "MQTT Sparkplug B edge node (docs/sparkplug.md).",
    .keys = {"broker", "group", "node", "user", "password_file", "primary_host", "ca_file",
             "certificate_file", "key_file"},
    .read = ReadSparkplugSettings,
    .write = WriteSparkplugSettings};

}  // namespace hydroscope

#pragma once

#include <gtest/gtest.h>

#include "alarms/feeds/sparkplug/settings.h"
#include "tests/broker_fixture.h"
#include "tests/feed_fixture.h"

namespace hydroscope {

using Json = nlohmann::json;

/// The value of a metric; null if it has none or is not there.
inline Json Metric(const Json& message, const std::string& name) {
  for (const Json& metric : message["payload"]["metrics"])
    if (metric["name"] == name) return metric.contains("value") ? metric["value"] : Json();
  return {};
}

class SparkplugFeedTest : public FeedTest {
 protected:
  void SetUp() override {
    if (const std::string missing = Host::Missing(); !missing.empty())
      GTEST_SKIP() << missing << " is not installed; scripts/setup.sh installs it";
  }
  /// `more`: lines of its configuration.
  void StartBroker(const std::string& more = "") {
    broker_.Start(File(""), more);
    ASSERT_TRUE(host_.Connect(broker_.port()));
  }
  /// At the unencrypted listener of the broker.
  SparkplugFeedSpec Spec() const {
    SparkplugFeedSpec spec;
    spec.broker = broker_.address();
    return spec;
  }
  void StartFeed() { StartFeed(Spec()); }
  void StartFeed(SparkplugFeedSpec spec) {
    PartsSpec feeds;
    feeds.Add(std::move(spec));
    feeds_.reset();
    feeds_.emplace(Feeds::Start(Press(feeds), database(), RealTime));
  }
  void StopFeed() { feeds_.reset(); }
  FeedStatus status() const { return feeds_->status().front(); }
  Broker& broker() { return broker_; }
  Host& host() { return host_; }
  std::vector<Json> Decoded(const std::string& part = "") { return host_.Decoded(part); }
  /// Sequence numbers of the events that arrived, in order of arrival.
  std::vector<std::int64_t> Events() {
    std::vector<std::int64_t> sequences;
    for (const Json& message : Decoded("DDATA"))
      if (const Json sequence = Metric(message, "Event/Sequence"); !sequence.is_null())
        sequences.push_back(sequence.get<std::int64_t>());
    return sequences;
  }

 private:
  Broker broker_;
  Host host_{File("")};
  std::optional<Feeds> feeds_;
};

}  // namespace hydroscope

#pragma once

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <chrono>
#include <condition_variable>
#include <functional>
#include <map>
#include <mutex>
#include <set>
#include <thread>

#include "acquisition/source.h"
#include "dds/domains.h"
#include "models/machine.h"
#include "simulator/die_cushion/press_server.h"

namespace hydroscope {

/// The real clocks, as the service hands them down.
inline HostTime RealTime() {
  const auto monotonic = std::chrono::steady_clock::now().time_since_epoch();
  const auto wall = std::chrono::system_clock::now().time_since_epoch();
  return {std::chrono::duration_cast<std::chrono::nanoseconds>(monotonic).count(),
          std::chrono::duration_cast<std::chrono::nanoseconds>(wall).count()};
}

/// A DDS domain that tests running at the same time do not share.
inline int OwnDomain() {
  static const int domain = FreeDomain();
  return domain;
}

/// A simulated press of two axes at 1 kHz in a thread of its own; lives may follow each other.
class TestPress {
 public:
  ~TestPress() { Kill(); }

  /// Serves DDS on `network`, if given, and Modbus, on the same port in every life.
  void Live(std::optional<DdsNetwork> network, double speed = 1) {
    PressServer::Options options;
    options.press.press.sample_period = 1e-3;
    options.press.press.seconds = 1e6;
    options.press.axes = 2;
    options.axes = {"left", "right"};
    options.session = ++lives_;
    options.speed = speed;
    options.dds = std::move(network);
    options.modbus = {.host = "127.0.0.1", .port = port_, .order = WordOrder::kAbcd};
    auto server = PressServer::Create(options, RealTime);
    ASSERT_TRUE(server) << server.error().text;
    server_ = std::move(*server);
    port_ = server_->modbus_port();
    thread_ = std::jthread([this](std::stop_token stop) { server_->Run(stop, 1e6); });
  }
  void Kill() {
    thread_ = {};
    server_.reset();
  }
  PressServer& server() { return *server_; }
  /// A port that is reserved for the lives to come.
  int port() {
    if (port_ == 0) {
      Live(std::nullopt);
      Kill();
    }
    return port_;
  }

 private:
  int port_ = 0;
  std::uint64_t lives_ = 0;
  std::unique_ptr<PressServer> server_;
  std::jthread thread_;
};

/// Collects what a source delivers and waits for it.
class TestSink {
 public:
  Source::Sink sink() {
    return [this](SampleBatch&& batch) {
      std::lock_guard lock(mutex_);
      rows_ += static_cast<std::int64_t>(batch.rows);
      sessions_.insert(batch.session);
      batches_.push_back(std::move(batch));
      if (batches_.size() > 5000) batches_.erase(batches_.begin(), batches_.begin() + 1000);
      changed_.notify_all();
    };
  }
  /// Waits for rows beyond those of now.
  bool WaitForMore(std::int64_t rows, double seconds = 10) {
    std::unique_lock lock(mutex_);
    const std::int64_t wanted = rows_ + rows;
    return changed_.wait_for(lock, std::chrono::duration<double>(seconds), [&] { return rows_ >= wanted; });
  }
  bool WaitForSessions(std::size_t count, double seconds = 10) {
    std::unique_lock lock(mutex_);
    return changed_.wait_for(lock, std::chrono::duration<double>(seconds),
                             [&] { return sessions_.size() >= count; });
  }
  std::vector<SampleBatch> batches() const {
    std::lock_guard lock(mutex_);
    return batches_;
  }
  std::int64_t rows() const {
    std::lock_guard lock(mutex_);
    return rows_;
  }

 private:
  mutable std::mutex mutex_;
  std::condition_variable changed_;
  std::vector<SampleBatch> batches_;
  std::int64_t rows_ = 0;
  std::set<std::uint64_t> sessions_;
};

/// Waits until `condition` holds; what it asks is no event that wakes, so it looks every 10 ms.
inline bool WaitUntil(const std::function<bool()>& condition, double seconds = 10) {
  const auto end = std::chrono::steady_clock::now() + std::chrono::duration<double>(seconds);
  while (!condition()) {
    if (std::chrono::steady_clock::now() > end) return false;
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
  }
  return true;
}

}  // namespace hydroscope

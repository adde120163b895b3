// How fast the page draws a long trend: makes a database with one parameter over many strokes (once; it is kept), then prints
// how long the first picture takes, how long lowest and highest values are collected for, and what zooming and panning cost
// after that.
//   long_trend_bench [STROKES] [DATABASE]    10 000 000 strokes in long_trend.db, 2.3 GB
#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <future>
#include <vector>

#include "page/watch/trend_cache.h"

namespace hydroscope {
namespace {

constexpr std::int64_t kBatch = 20'000;
constexpr std::int64_t kPixels = 1000;
constexpr int kPans = 300;

double Now() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

/// A stroke every 12 s; K follows the oil and falls slowly, with a spike now and then.
StrokeRecord StrokeOf(std::int64_t index) {
  const double x = static_cast<double>(index);
  StrokeRecord record;
  record.summary.index = index;
  record.summary.begin = 1.6e9 + 12 * x;
  record.summary.end = record.summary.begin + 1.5;
  record.summary.oil_temperature = 313 + 8 * std::sin(x / 1200);
  const double spike = index % 99'991 == 7 ? 5e7 : 0;
  record.estimates = {{"K", 1.2e9 + 2e7 * std::sin(x / 1200) - 3 * x + spike, 2e6, "Pa", 0.5,
                       record.summary.end, EstimateReason::kUpdated, record.summary.oil_temperature}};
  return record;
}

Status Fill(const std::string& path, std::int64_t strokes) {
  auto database = TRY(Database::Open(path));
  const auto machine = TRY(database.MachineId("press"));
  const auto version = TRY(database.PutModelVersion(machine, {0, "", {}}));
  const auto run = TRY(database.BeginRun(machine, version, "long trend", "long trend"));
  const double start = Now();
  for (std::int64_t first = run.strokes; first < strokes; first += kBatch) {
    std::vector<StrokeRecord> batch;
    for (std::int64_t k = first; k < std::min(first + kBatch, strokes); ++k) batch.push_back(StrokeOf(k));
    TRY(database.StoreStrokes(run.id, batch));
  }
  if (run.strokes < strokes)
    fmt::print("stored {} strokes in {:.0f} s\n", strokes - run.strokes, Now() - start);
  return {};
}

Status Measure(const std::string& path, std::int64_t strokes) {
  const auto database = TRY(Database::OpenReadOnly(path));
  std::promise<void> ready;
  TrendCache cache(path, [&] { ready.set_value(); });
  const auto picture = [&](std::int64_t first, std::int64_t end) {
    return cache.Picture(database, 1, "K", first, end, kPixels);
  };
  double start = Now();
  const auto glance = TRY(picture(0, strokes));
  fmt::print("first picture of {} strokes, {} bins: {:.1f} ms, {}\n", strokes, glance.bins.size(),
             1e3 * (Now() - start), glance.exact ? "exact" : "a glance");
  if (!glance.exact) {
    ready.get_future().wait();
    fmt::print("lowest and highest values collected after {:.1f} s\n", Now() - start);
  }
  start = Now();
  const auto exact = TRY(picture(0, strokes));
  std::int64_t values = 0;
  for (const TrendBin& bin : exact.bins) values += bin.values;
  fmt::print("all of it again: {:.1f} ms, {} values in {} bins\n", 1e3 * (Now() - start), values,
             exact.bins.size());
  for (const std::int64_t span : {strokes / 2, strokes / 20, std::int64_t{20'000}, std::int64_t{1000}}) {
    if (span < 2 || span > strokes) continue;
    std::vector<double> times;
    for (int pan = 0; pan < kPans; ++pan) {
      const std::int64_t first = (strokes - span) * pan / kPans;
      start = Now();
      TRY(picture(first, first + span));
      times.push_back(1e3 * (Now() - start));
    }
    std::sort(times.begin(), times.end());
    fmt::print("panning {} strokes wide: {:.2f} ms in the median, {:.2f} ms at p99\n", span, times[kPans / 2],
               times[kPans * 99 / 100]);
  }
  return {};
}

}  // namespace
}  // namespace hydroscope

int main(int count, char** words) {
  const std::int64_t strokes = count > 1 ? std::atoll(words[1]) : 10'000'000;
  const std::string path = count > 2 ? words[2] : "long_trend.db";
  auto done = hydroscope::Fill(path, strokes);
  if (done) done = hydroscope::Measure(path, strokes);
  if (!done) fmt::print(stderr, "{}\n", done.error().text);
  return done ? 0 : 1;
}

#include "cli/frequency_response/measured_bode.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "cli/frequency_response/bode_plot.h"
#include "core/constants.h"
#include "workbench/frequency_response/loop_output.h"

namespace hydroscope {
namespace {

constexpr std::size_t kPointsShown = 160;  // of a closed loop

}  // namespace

std::string ValveBodePlot(const ValveLog& measured, const std::string& title) {
  BodePicture picture{.points = measured.Used(), .title = title};
  if (measured.response.model) {
    const ValveModel& model = *measured.response.model;
    picture.response = [&model](double f) { return model.Response(f); };
    picture.phase = [&model](double f) { return model.Phase(f); };
    picture.gain_level = Decibels(std::abs(model.gain.value)) - kHalfPower;
    picture.legend =
        fmt::format(" — curve: f0 {:.4g} Hz, D {:.3g}, dead time {:.3f} ms", model.natural_frequency.value,
                    model.damping.value, 1e3 * model.dead_time.value + 0.0);
  }
  return BodePlot(picture);
}

std::string LoopBodePlot(const LoopLog& measured, const std::string& title) {
  const LoopResponse& response = measured.response;
  // What integrates has no level to fall below.
  BodePicture picture{.gain_level = kNaN, .title = title, .gain_label = "gain (dB, SI)"};
  picture.points = UsedPoints(response, kPointsShown);
  if (picture.points.empty())
    for (const FrequencyPoint& p : response.points) picture.points.push_back(&p);
  if (response.fit) {
    const std::vector<double>& parameters = response.fit->parameters;
    picture.response = [&](double f) { return measured.model.Response(f, parameters); };
    picture.phase = [&](double f) {  // as the points: nearest of them
      const auto near = std::ranges::min_element(picture.points, [f](const auto* a, const auto* b) {
        return std::abs(a->frequency - f) < std::abs(b->frequency - f);
      });
      return PhaseBeside(measured.model, parameters, f, **near);
    };
    picture.legend = " — curve: transfer function";
  }
  return BodePlot(picture);
}

}  // namespace hydroscope

#include "cli/frequency_response/loop_bode.h"

#include <algorithm>
#include <cmath>

#include "cli/frequency_response/bode_plot.h"
#include "core/constants.h"
#include "workbench/frequency_response/loop_output.h"

namespace hydroscope {

namespace {

constexpr std::size_t kPointsOfLoopPicture = 160;

}  // namespace

std::string LoopBodePlot(const LoopLog& measured, const std::string& title) {
  const LoopResponse& response = measured.response;
  // What integrates has no level to fall below.
  BodePicture picture{.gain_level = kNaN, .title = title, .gain_label = "gain (dB, SI)"};
  picture.points = UsedPoints(response, kPointsOfLoopPicture);
  if (picture.points.empty())
    for (const FrequencyPoint& p : response.points) picture.points.push_back(&p);
  if (response.fit) {
    const std::vector<double>& parameters = response.fit->parameters;
    picture.response = [&](double f) { return measured.model.Response(f, parameters); };
    picture.phase = [&](double f) {  // as the points: nearest of them
      const auto near =
          std::min_element(picture.points.begin(), picture.points.end(), [f](const auto* a, const auto* b) {
            return std::abs(a->frequency - f) < std::abs(b->frequency - f);
          });
      return PhaseBeside(measured.model, parameters, f, **near);
    };
    picture.legend = " — curve: transfer function";
  }
  return BodePlot(picture);
}

}  // namespace hydroscope

#include "cli/frequency_response/valve_bode.h"

#include <fmt/format.h>

#include <cmath>

#include "cli/frequency_response/bode_plot.h"

namespace hydroscope {

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

}  // namespace hydroscope

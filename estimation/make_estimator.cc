#include "estimation/integral_estimator.h"
#include "estimation/published_estimator.h"

namespace hydroscope {

std::unique_ptr<StrokeEstimator> MakeEstimator(const Machine& machine, std::shared_ptr<const ModelStructure> model,
                                               const WindowSamples& window) {
  if (machine.estimator.equation == EquationForm::kPublished) {
    const double area = machine.Geometry("A_A").value_or(KnownValue{}).value;
    return std::make_unique<PublishedEstimator>(machine.estimator, std::move(model), area, window.period);
  }
  return std::make_unique<IntegralEstimator>(machine.estimator, std::move(model), window);
}

}  // namespace hydroscope

#include "estimation/recursive/integral_estimator.h"
#include "estimation/recursive/published_estimator.h"

namespace hydroscope {

std::unique_ptr<StrokeEstimator> MakeEstimator(const Machine& machine,
                                               std::shared_ptr<const ModelStructure> model,
                                               const WindowSamples& window) {
  if (machine.estimator.equation == EquationForm::kPublished)
    return std::make_unique<PublishedEstimator>(machine.estimator, std::move(model), window.period);
  return std::make_unique<IntegralEstimator>(machine.estimator, std::move(model), window);
}

}  // namespace hydroscope

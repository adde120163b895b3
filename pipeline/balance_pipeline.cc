#include "pipeline/balance_pipeline.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "core/bytes.h"
#include "core/non_negative.h"
#include "estimation/gram_fit.h"

namespace hydroscope {
namespace {

constexpr std::uint32_t kStateMagic = 0x54535948;  // "HYST"
constexpr std::uint32_t kStateVersion = 2;
constexpr int kHeaderFields = 4;  ///< magic, version, base columns, columns
/// The published equations identify the base model alone.
bool HasAddedEffects(const Machine& machine) {
  return !machine.added_effects.empty() && machine.estimator.equation == EquationForm::kIntegral;
}

/// The first columns alone: triangles are packed by columns.
void KeepFirst(int columns, SymmetricMatrix& matrix) {
  if (matrix.dimension() <= columns) return;
  SymmetricMatrix kept(columns);
  std::copy_n(matrix.packed().begin(), kept.packed().size(), kept.packed().begin());
  matrix = std::move(kept);
}

}  // namespace

Result<std::unique_ptr<Pipeline>> BalancePipeline::Create(const Machine& machine, double sample_period,
                                                          RecordSink sink) {
  auto model = TRY(BuildModel(machine));
  WindowSamples window = WindowSamples::From(machine.window, sample_period);
  window.level_form = model->level_form;
  std::shared_ptr<const ModelStructure> wide = model;
  if (HasAddedEffects(machine)) {
    wide = TRY(AddedEffectsEstimator::ModelWithValues(machine, *model));
  }
  return std::unique_ptr<Pipeline>(new BalancePipeline(machine, model, wide, window, std::move(sink)));
}

BalancePipeline::BalancePipeline(const Machine& machine, std::shared_ptr<const ModelStructure> model,
                                 std::shared_ptr<const ModelStructure> wide, WindowSamples window,
                                 RecordSink sink)
    : Pipeline(model, window),
      wide_(wide),
      sink_(std::move(sink)),
      equations_(wide, window),
      accumulator_(wide->column_count()),
      estimator_(Estimator(machine)),
      segmenter_(machine, model, window,
                 {[this](Stretch& stretch, double begin) { OnStretch(stretch, begin); },
                  [this](const StrokeSummary& summary) { OnStroke(summary); },
                  [this] {
                    accumulator_.Take();
                    estimator_->DiscardStroke();
                  }}) {}

std::unique_ptr<StrokeEstimator> BalancePipeline::Estimator(const Machine& machine) {
  if (!HasAddedEffects(machine)) return MakeEstimator(machine, shared_model(), this->window());
  auto estimator = std::make_unique<AddedEffectsEstimator>(machine, wide_, this->window());
  added_ = estimator.get();
  return estimator;
}

void BalancePipeline::OnStretch(Stretch& stretch, double begin) {
  const SpanEquations& equations = equations_.Build(stretch, begin);
  if (accumulator_.empty()) theta_before_ = estimator_->theta();
  accumulator_.Add(equations);
  estimator_->AddStretch(stretch, equations);
  if (tap()) tap()(stretch, equations);
}

void BalancePipeline::OnStroke(const StrokeSummary& summary) {
  StrokeRecord record{summary, accumulator_.Take(), {}};
  record.summary.rms_error = std::numeric_limits<double>::quiet_NaN();
  const bool known = theta_before_.size() > 0;
  if (known) Judge(record.gram, record.summary);
  record.estimates = estimator_->EndStroke(summary, record.gram);
  if (!known) {
    theta_before_ = estimator_->theta();
    Judge(record.gram, record.summary);
  }
  column_weights_ = added_ != nullptr ? added_->ColumnWeights(estimator_->theta()) : estimator_->theta();
  for (SymmetricMatrix* matrix : {&record.gram.integral, &record.gram.noise, &record.gram.flow})
    KeepFirst(model().column_count(), *matrix);
  sink_(std::move(record));
}

void BalancePipeline::Judge(const StrokeGram& gram, StrokeSummary& summary) {
  const Eigen::VectorXd& theta = theta_before_;
  if (theta.size() == 0 || gram.windows == 0) return;
  const StrokeGram reduced = added_ != nullptr ? added_->Reduced(gram) : gram;
  std::vector<int> regressors(theta.size());
  std::iota(regressors.begin(), regressors.end(), 0);
  const int output = added_ != nullptr ? added_->regressors() : model().output_column();
  summary.rms_error =
      std::sqrt(NonNegative(MeanSquaredError(FlowEquations(reduced, regressors, output), theta)));
  const std::vector<int> walking =
      model().WalkingParameters(added_ != nullptr ? added_->effects() : std::vector<int>{});
  summary.noise_floor = NoiseFloor({&reduced, 1}, regressors, output, theta, window(), walking);
}

std::vector<std::uint8_t> BalancePipeline::SaveState() const {
  ByteWriter out;
  out.Put(kStateMagic);
  out.Put(kStateVersion);
  out.Put<std::uint32_t>(static_cast<std::uint32_t>(Regressors()));
  out.Put<std::uint32_t>(static_cast<std::uint32_t>(wide_->column_count()));
  estimator_->Save(out);
  return out.Take();
}

Status BalancePipeline::RestoreState(const std::vector<std::uint8_t>& state) {
  ByteReader in(state);
  const bool ours = in.Get<std::uint32_t>() == kStateMagic && in.Get<std::uint32_t>() == kStateVersion &&
                    in.Get<std::uint32_t>() == static_cast<std::uint32_t>(Regressors()) &&
                    in.Get<std::uint32_t>() == static_cast<std::uint32_t>(wide_->column_count());
  const std::vector<std::uint8_t> present = SaveState();
  if (!ours || !estimator_->Restore(in) || !in.at_end()) {
    ByteReader back(present);
    for (int k = 0; k < kHeaderFields; ++k) back.Get<std::uint32_t>();
    estimator_->Restore(back);  // a torn state may have been taken over in part
    return BadInput(
        "the stored estimator state belongs to another model or program version; start without it");
  }
  return {};
}

}  // namespace hydroscope

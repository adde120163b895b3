#include "service/pipeline.h"

#include <cmath>
#include <limits>
#include <numeric>

#include "core/bytes.h"
#include "estimation/gram_fit.h"

namespace hydroscope {
namespace {

constexpr std::uint32_t kStateMagic = 0x54535948;  // "HYST"
constexpr std::uint32_t kStateVersion = 1;
constexpr int kHeaderFields = 4;  ///< magic, version, base columns, columns

}  // namespace

Result<std::unique_ptr<Pipeline>> Pipeline::Create(const Machine& machine, double sample_period, RecordSink sink) {
  if (!(sample_period > 0))
    return BadInput("sample period is {} s, expected above 0: give [log] sample_period in the machine file", sample_period);
  auto model = BuildModel(machine);
  if (!model) return tl::unexpected(model.error());
  const WindowSamples window = WindowSamples::From(machine.window, sample_period);
  return std::unique_ptr<Pipeline>(new Pipeline(machine, *model, window, std::move(sink)));
}

Pipeline::Pipeline(const Machine& machine, std::shared_ptr<const ModelStructure> model, WindowSamples window,
                   RecordSink sink)
    : model_(model),
      window_(window),
      sink_(std::move(sink)),
      equations_(model, window),
      accumulator_(model->column_count()),
      estimator_(MakeEstimator(machine, model, window)),
      segmenter_(machine, model, window,
                 {[this](Stretch& stretch, double begin) { OnStretch(stretch, begin); },
                  [this](const StrokeSummary& summary) { OnStroke(summary); }, [this] { accumulator_.Take(); }}) {}

void Pipeline::OnStretch(Stretch& stretch, double begin) {
  const SpanEquations& equations = equations_.Build(stretch, begin);
  if (accumulator_.empty()) theta_before_ = estimator_->theta();
  accumulator_.Add(equations);
  estimator_->AddStretch(stretch, equations);
  if (tap_) tap_(stretch, equations);
}

void Pipeline::OnStroke(const StrokeSummary& summary) {
  StrokeRecord record{summary, accumulator_.Take(), {}};
  std::vector<int> base(model_->base_count);
  std::iota(base.begin(), base.end(), 0);
  record.estimates = estimator_->EndStroke(record.summary, record.gram);
  const Eigen::VectorXd after = estimator_->theta();
  record.summary.rms_error = std::numeric_limits<double>::quiet_NaN();
  const Eigen::VectorXd& judged = theta_before_.size() > 0 ? theta_before_ : after;
  if (judged.size() > 0 && record.gram.windows > 0) {
    const int output = model_->output_column();
    record.summary.rms_error =
        std::sqrt(std::max(0.0, MeanSquaredError(FlowEquations(record.gram, base, output), judged)));
    record.summary.noise_floor = NoiseFloor({&record.gram, 1}, base, output, judged, window_);
  }
  sink_(std::move(record));
}

std::vector<std::uint8_t> Pipeline::SaveState() const {
  ByteWriter out;
  out.Put(kStateMagic);
  out.Put(kStateVersion);
  out.Put<std::uint32_t>(static_cast<std::uint32_t>(model_->base_count));
  out.Put<std::uint32_t>(static_cast<std::uint32_t>(model_->column_count()));
  estimator_->Save(out);
  return out.Take();
}

Status Pipeline::RestoreState(const std::vector<std::uint8_t>& state) {
  ByteReader in(state);
  const bool ours = in.Get<std::uint32_t>() == kStateMagic && in.Get<std::uint32_t>() == kStateVersion &&
                    in.Get<std::uint32_t>() == static_cast<std::uint32_t>(model_->base_count) &&
                    in.Get<std::uint32_t>() == static_cast<std::uint32_t>(model_->column_count());
  const std::vector<std::uint8_t> present = SaveState();
  if (!ours || !estimator_->Restore(in) || !in.at_end()) {
    ByteReader back(present);
    for (int k = 0; k < kHeaderFields; ++k) back.Get<std::uint32_t>();
    estimator_->Restore(back);  // a torn state may have been taken over in part
    return BadInput("the stored estimator state belongs to another model or program version; start without it");
  }
  return {};
}

}  // namespace hydroscope

#include "pipeline/episode_pipeline.h"

#include <cmath>

#include "core/bytes.h"
#include "estimation/closed_loop/loop_episodes.h"
#include "estimation/states/state_episodes.h"
#include "models/machine_kind.h"
#include "models/state_model.h"

namespace hydroscope {
namespace {

constexpr std::uint32_t kEpisodeStateMagic = 0x45535948;  // "HYSE"
constexpr std::uint32_t kEpisodeStateVersion = 1;

EpisodeFollowerOptions FollowingOf(const Machine& machine) {
  EpisodeFollowerOptions options;
  options.time_constant = machine.estimator.time_constant;
  return options;
}

}  // namespace

std::string SilentEpisode(const Machine& machine) {
  return KindOf(machine).has_states
             ? "the model cannot be run through it: a state runs away or a rate is not finite"
             : "it is too short for averaged spectra, or its set point is not excited";
}

Result<EpisodePipeline::Episodes> EpisodePipeline::EpisodesOf(const Machine& machine, double sample_period) {
  if (!KindOf(machine).has_states)
    return Episodes{EpisodesOfLoop(machine, sample_period), {SignalsOfLoop(machine), {}}};
  const auto states = TRY(BuildStateModel(machine, machine.added_effects));
  return Episodes{EpisodesOfStates(states), {states->inputs, states->outputs}};
}

Result<std::unique_ptr<Pipeline>> EpisodePipeline::Create(const Machine& machine, double sample_period,
                                                          RecordSink sink) {
  auto model = TRY(BuildModel(machine));
  auto episodes = TRY(EpisodesOf(machine, sample_period));
  TRY(EpisodeCutter::Check(machine));
  WindowSamples window = WindowSamples::From(machine.window, sample_period);
  window.level_form = true;
  return std::unique_ptr<Pipeline>(new EpisodePipeline(model, std::move(episodes), FollowingOf(machine),
                                                       window, sample_period, std::move(sink)));
}

EpisodePipeline::EpisodePipeline(std::shared_ptr<const ModelStructure> model, Episodes episodes,
                                 const EpisodeFollowerOptions& following, WindowSamples window, double period,
                                 RecordSink sink)
    : Pipeline(std::move(model), window),
      episode_model_(episodes.model),
      follower_(episodes.model, following),
      cutter_(episodes.model->machine(), std::move(episodes.signals), {.period = period},
              [this](Episode&& episode, const StrokeCounters& counters) { OnEpisode(episode, counters); }),
      conditions_(this->model()),
      sink_(std::move(sink)),
      period_(period) {}

void EpisodePipeline::OnEpisode(const Episode& episode, const StrokeCounters& counters) {
  const FollowedEpisode followed = follower_.Add(episode);
  StrokeRecord record;
  StrokeSummary& summary = record.summary;
  summary.index = episodes_++;
  summary.begin = episode.time.front();
  summary.end = episode.time.back();
  summary.counters = counters;
  TakeConditions(episode, summary);
  summary.rms_error = follower_.shown_noise() *
                      (std::isfinite(followed.error_before) ? followed.error_before : followed.error_least);
  summary.noise_floor = follower_.shown_noise() * followed.error_white;
  record.gram = GramOf(followed);
  record.estimates = followed.estimates;
  parameters_ = follower_.parameters();
  doubts_ = episode_model_->DoubtsOf(episode);
  sink_(std::move(record));
}

/// What it was driven at, from means over blocks as of strokes.
void EpisodePipeline::TakeConditions(const Episode& episode, StrokeSummary& summary) {
  conditions_.Begin();
  const int rows = std::max(1, window().block);
  std::vector<double> sample(static_cast<std::size_t>(episode.signal.cols() * rows));
  for (int first = 0; first + rows <= episode.rows(); first += rows) {
    for (Eigen::Index s = 0; s < episode.signal.cols(); ++s)
      for (int k = 0; k < rows; ++k) sample[s * rows + k] = episode.signal(first + k, s);
    conditions_.Add(sample, rows);
  }
  conditions_.Write(episode.rows() * period_, summary);
}

StrokeGram EpisodePipeline::GramOf(const FollowedEpisode& followed) const {
  const int n = model().base_count;
  StrokeGram gram;
  gram.integral = gram.noise = gram.flow = SymmetricMatrix(n + 1);
  const EpisodeEvidence& e = followed.evidence;
  if (e.readings == 0) return gram;
  const double unit = follower_.shown_noise() * follower_.shown_noise();
  const Eigen::VectorXd cross = e.information * e.at + e.gradient;
  const double output = e.energy + 2 * e.gradient.dot(e.at) + e.at.dot(e.information * e.at);
  for (int i = 0; i < n; ++i) {
    for (int j = 0; j <= i; ++j) gram.integral(j, i) = unit * e.information(j, i);
    gram.integral(i, n) = unit * cross[i];
  }
  gram.integral(n, n) = unit * output;
  gram.flow = gram.integral;
  // Readings enter as they are: NoiseFloor averages what it takes for means of blocks.
  gram.noise(n, n) =
      unit * followed.error_least * followed.error_least * e.readings / window().FlowVarianceGain();
  gram.blocks = gram.windows = e.readings;
  return gram;
}

std::vector<std::uint8_t> EpisodePipeline::SaveState() const {
  ByteWriter out;
  out.Put(kEpisodeStateMagic);
  out.Put(kEpisodeStateVersion);
  out.Put<std::uint32_t>(static_cast<std::uint32_t>(model().base_count));
  out.Put<std::uint32_t>(static_cast<std::uint32_t>(model().column_count()));
  follower_.Save(out);
  return out.Take();
}

Status EpisodePipeline::RestoreState(const std::vector<std::uint8_t>& state) {
  ByteReader in(state);
  const bool ours = in.Get<std::uint32_t>() == kEpisodeStateMagic &&
                    in.Get<std::uint32_t>() == kEpisodeStateVersion &&
                    in.Get<std::uint32_t>() == static_cast<std::uint32_t>(model().base_count) &&
                    in.Get<std::uint32_t>() == static_cast<std::uint32_t>(model().column_count());
  EpisodeFollower follower = follower_;
  if (!ours || !follower.Restore(in) || !in.at_end())
    return BadInput(
        "the stored estimator state belongs to another model or program version; start without it");
  follower_ = std::move(follower);
  parameters_ = follower_.parameters();
  return {};
}

}  // namespace hydroscope

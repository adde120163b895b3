#pragma once

#include "estimation/recursive/episode_follower.h"
#include "estimation/stroke_conditions.h"
#include "pipeline/episode_cutter.h"
#include "pipeline/pipeline.h"

namespace hydroscope {

/// Why an episode tells of no parameter (StrokeRecord::estimates is empty), a clause: "its model cannot be run ...".
std::string SilentEpisode(const Machine& machine);

/// The way of a sample where rows are judged in episodes (InEpisodes): samples -> episodes -> EpisodeFollower -> StrokeRecord.
/// What an episode leaves in place of a stroke's Gram are the products of its slopes and of errors + slopes * parameters
/// (BuildEpisodeStructure), in the unit that errors are shown in; `integral` and `flow` are the same. An episode is linearised
/// when it is over.
class EpisodePipeline : public Pipeline {
 public:
  static Result<std::unique_ptr<Pipeline>> Create(const Machine& machine, double sample_period,
                                                  RecordSink sink);

  void Process(const SampleBlock& block) override { cutter_.Process(block); }
  void Finish() override { cutter_.Finish(); }
  std::vector<std::uint8_t> SaveState() const override;
  Status RestoreState(const std::vector<std::uint8_t>& state) override;
  const StrokeCounters& totals() const override { return cutter_.totals(); }
  const Eigen::VectorXd& column_weights() const override { return parameters_; }
  double stroke_closed_for() const override { return cutter_.outside(); }
  std::int64_t discarded_strokes() const override { return cutter_.discarded(); }
  std::vector<Told> doubts() const override { return doubts_; }

 private:
  /// How a machine is judged in episodes.
  struct Episodes {
    std::shared_ptr<const EpisodeModel> model;
    EpisodeSignals signals;
  };
  static Result<Episodes> EpisodesOf(const Machine& machine, double sample_period);

  EpisodePipeline(std::shared_ptr<const ModelStructure> model, Episodes episodes,
                  const EpisodeFollowerOptions& following, WindowSamples window, double period,
                  RecordSink sink);
  void OnEpisode(const Episode& episode, const StrokeCounters& counters);
  void TakeConditions(const Episode& episode, StrokeSummary& summary);
  StrokeGram GramOf(const FollowedEpisode& followed) const;

  std::shared_ptr<const EpisodeModel> episode_model_;
  EpisodeFollower follower_;
  EpisodeCutter cutter_;
  StrokeConditions conditions_;
  RecordSink sink_;
  double period_;
  Eigen::VectorXd parameters_;
  std::int64_t episodes_ = 0;
  std::vector<Told> doubts_;  ///< of the last one
};

}  // namespace hydroscope

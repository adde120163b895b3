#pragma once

#include <functional>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "core/told.h"
#include "estimation/states/simulation.h"

namespace hydroscope {

/// How the rows grow that runs of a whole episode are fitted to. No calibration of these and those of StepDamping is on record;
/// `hydroscope benchmark flexible-axis` and `manipulator` print what fits come to with them.
struct HorizonGrowth {
  int first_rows = 200;     ///< that a start is first fitted to
  double tolerance = 3e-3;  ///< relative change of the cost at which the horizon grows
  double most = 2;          ///< times as many rows
  /// Times as many, from which on down it is the model's fault that the longer run loses its way, and no shorter one is tried.
  double least = 1.02;
  int rest = 10;          ///< of the rows reached: when fewer than that are left they are taken along at once
  double astray = 3;      ///< cost of a reading over that of the shorter run: the longer one lost its way
  double hopeless = 50;   ///< ... before it is fitted: none leads back from there, as a rule
  double on_its_way = 2;  ///< ... up to which a run over all rows needs no growth
  double flat = 1e-3;  ///< share of the cost that a parameter's whole range changes where it does not matter
  int parts_of_flat = 8;  ///< that its range is tried in
};

/// Levenberg and Marquardt's damping, as a share of the largest curvature, where the horizon grows.
struct StepDamping {
  double first = 1e-10;        ///< Gauss and Newton's step, where many outputs are measured
  double first_of_few = 1e-3;  ///< few lead astray from far off
  double less = 0.1;           ///< factor after a step that helps
  double more = 4;             ///< ... and after one that is too long; squared after one that does not help
  double least = 1e-15, most = 1e12;
  double longest = 1;  ///< step of a parameter on its scale that is trusted
  /// Share of their own curvature that initial states are damped by at least, and curvature of a state that nothing tells.
  double least_of_states = 1e-9, of_none = 1e-300;
  /// Change of half a chi square that moves nothing by more than a tenth of its deviation.
  double no_matter = 5e-3;
};

struct StateFitOptions {
  int starts = 8;             ///< drawn from the ranges of the parameters, beside that of the machine file
  std::uint32_t seed = 1;     ///< of the draws
  int start_rows = 1000;      ///< starts are tried on so many rows, the best minima are then fitted to all
  int segment_rows = 50;      ///< of the shooting segments that a start is first fitted with
  HorizonGrowth growth = {};  ///< where the horizon grows (growing.h)
  StepDamping damping = {};   ///< ... of its steps
  /// Energy of the error over that of white noise at which no further start is tried there.
  double at_noise = 1.1;
  /// What the runs of a start may cost, of those that ended so far on the mean: what needs far more ends nowhere, as a rule.
  double most_effort = 8;
  bool until_white = false;  ///< no further start is tried once one leaves white noise
  /// Where not all are tried (until_agreed): cost of a start's short segments over that of the best runs so far, from which on it
  /// is not taken on.
  double far_worse = 2;
  int until_agreed = 0;        ///< no further start is tried once so many end in the best minimum; 0: all are
  Eigen::VectorXd ended = {};  ///< parameters that an earlier start ended with; empty: none is known
  int polished = 2;            ///< minima that are fitted to all rows
  int iterations = 60;         ///< of the last fit
  int start_iterations = 25;
  /// DescentOptions::first_radius of segments that are fitted once more, since bold first steps may end in a wrong minimum.
  double cautious_radius = 1;
  double start_tolerance = 1e-4;  ///< relative change of the cost at which a start is left alone
  double tolerance = 1e-7;        ///< ... and the last fit
  double same_minimum = 0.02;     ///< costs that differ by less are one minimum
  int least_clusters = 40;        ///< pieces of the log that intervals and errors left out are computed over
  std::function<void(int start, std::size_t starts)> tells_start =
      {};  ///< hears which start is begun, counted from 1
};

/// Starts that end with the same parameters, after which there is hardly a better minimum.
inline constexpr int kEnoughStarts = 3;
/// Of fits of which the best minimum alone is asked for.
StateFitOptions BestAlone();

/// A minimum that starts ended in.
struct StateMinimum {
  Eigen::VectorXd parameters;
  double cost = 0;  ///< weighted rms error on the rows that starts are tried on, of the best one's
  int starts = 0;   ///< that ended in it
};

/// A piece of the rows, as it enters the normal equations: outputs over their noise, initial states taken out.
struct StatePiece {
  int episode = 0, first = 0, last = 0;  ///< rows first ... last - 1 of the episode
  Eigen::MatrixXd information;           ///< of the parameters, and of the gains if there are
  Eigen::VectorXd gradient;              ///< J' r, r measured less modelled
  double energy = 0;                     ///< r' r
  int readings = 0;
};

/// Energy of the error on each piece after a regression on all others.
std::vector<double> HeldOutEnergies(std::span<const StatePiece> pieces);

/// A direction of the parameters that the data do not see.
struct UnseenDirection {
  std::vector<std::pair<std::string, double>> parts;  ///< parameter, relative change
};

struct StateFit {
  std::shared_ptr<const StateModel> model;
  Told failed;  ///< why there is no fit, a sentence; empty = there is one
  Eigen::VectorXd parameters;
  RowMatrix gain;                        ///< of the innovations form, state x output; empty: a free run
  Eigen::MatrixXd covariance;            ///< from the residuals as they are, pieces of the log as clusters
  std::vector<Eigen::VectorXd> initial;  ///< estimated initial states, per episode (all states)
  Eigen::VectorXd noise;                 ///< per output: rms of what is left
  Eigen::VectorXd scale;                 ///< per output: its standard deviation in the data
  std::vector<StateRun> runs;            ///< per episode
  std::vector<RowMatrix> residuals;  ///< per episode: measured less modelled, NaN where nothing was measured
  std::vector<StatePiece> pieces;
  std::vector<StateMinimum> minima;  ///< best first; empty: fitted from one start only
  std::vector<UnseenDirection> unseen;
  std::vector<bool> at_limit;  ///< per parameter: stands at a limit of its range
  int starts_tried = 0;
  int starts_diverged = 0;  ///< ... or given up (StateFitOptions::most_effort, far_worse)

  bool solved() const { return failed.empty(); }
  int readings() const;
  /// Error over the output's variation in the data, of the output that errs most.
  double ErrorOfVariation() const { return noise.cwiseQuotient(scale).maxCoeff(); }
  /// Energy of the error on pieces left out in turn, outputs over their noise: linearised about the fit. What stands at a limit
  /// of its range stays there.
  double HeldOutEnergy() const;
  /// The same per piece, for comparisons.
  std::vector<double> HeldOutEnergies() const;
};

/// StateFit::ErrorOfVariation beyond which a free run hardly follows what was measured: what it leaves, unless it is white noise,
/// tells more of where it lost its way than of the machine.
inline constexpr double kHardlyFollows = 0.5;

/// Fits by output error: free runs over whole episodes, outputs weighted by their noise, the squares of the errors minimised
/// by Ceres within the ranges. Each start is first fitted with short segments whose joints are soft (multiple shooting, Bock
/// 1981), since a free run from far off diverges or ends in a wrong minimum; then as a whole. Models with several outputs are
/// fitted over a growing horizon instead (growing.h).
StateFit FitStates(std::shared_ptr<const StateModel> model, std::span<const Episode> episodes,
                   const StateFitOptions& options = {});

/// Where a fit begins; `initial` as StateFit::initial, empty: as the data say.
struct StateStart {
  Eigen::VectorXd parameters;
  std::vector<Eigen::VectorXd> initial;
};

/// From known starts: each is fitted roughly (options.start_iterations) to all rows, the best of them to the end. `weights`:
/// noise per output, empty: found.
StateFit RefitStates(std::shared_ptr<const StateModel> model, std::span<const Episode> episodes,
                     std::span<const StateStart> starts, const Eigen::VectorXd& weights,
                     const StateFitOptions& options = {});

/// A start for RefitStates from far off: what short segments of the first rows give. Nothing if the model diverges.
std::optional<StateStart> ShootStart(std::shared_ptr<const StateModel> model,
                                     std::span<const Episode> episodes, const Eigen::VectorXd& parameters,
                                     const StateFitOptions& options = {});

/// By prediction error in innovations form (Ljung 1999, 5.3 and 7.2) where noise acts on the process itself: the states are
/// corrected after each row by a gain that is estimated with the parameters. Begins at a free-run fit and leaves
/// the residuals of one step.
StateFit PredictStates(const StateFit& free_run, std::span<const Episode> episodes,
                       const StateFitOptions& options = {});

/// Initial states alone, on data that the parameters were not fitted to.
StateFit FollowStates(std::shared_ptr<const StateModel> model, std::span<const Episode> episodes,
                      const Eigen::VectorXd& parameters, const Eigen::VectorXd& weights);

/// Rms of the errors of each output over all episodes.
Eigen::VectorXd RmsOf(const std::vector<RowMatrix>& residuals, int outputs);

}  // namespace hydroscope

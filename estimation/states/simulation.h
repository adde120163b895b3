#pragma once

#include <Eigen/Dense>
#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <limits>
#include <memory>
#include <span>
#include <vector>

#include "estimation/episode.h"
#include "estimation/states/row_course.h"
#include "estimation/states/steps.h"
#include "models/state_model.h"

namespace hydroscope {

/// Further columns of the sensitivities: what terms added to the equations would change, per unit of each.
struct AddedTerms {
  struct Place {
    int value = 0, row = 0, column = 0;  ///< row: of the states, or of the outputs
  };
  int values = 0;   ///< that `evaluate` gives
  int columns = 0;  ///< all; those that change a state come first
  int moving = 0;   ///< columns that change a state
  std::vector<Place> to_states, to_outputs;
  /// Values of the terms at a state and input.
  std::function<void(const double* state, const double* input, double* values)> evaluate;
};

struct SimulationOptions {
  double tolerance = 1e-5;  ///< of a step's error, over the state's size
  int stiff_steps = 40;  ///< more explicit steps between two rows than these: the implicit method takes over
  int max_steps = 4000;  ///< between two rows; what needs more has diverged
  /// ... on average; what swings some five times faster than rows can show has diverged.
  int mean_steps = 40;
  int spare_steps = 1000;    ///< beyond that average, for the beginning of a run
  double divergence = 1e15;  ///< SI; a state beyond has diverged
};

/// What a run gives at each row of an episode.
struct StateRun {
  bool diverged = false;
  int rows = 0;  ///< rows reached
  /// Row x output; where readings are means: those, NaN at the end of a part that began before.
  RowMatrix outputs;
  RowMatrix states;      ///< row x state
  RowMatrix slopes;      ///< (row, output) x (parameters, initial states, columns of added terms)
  Eigen::VectorXd end;   ///< states at the end
  RowMatrix end_slopes;  ///< their sensitivities
};

/// Where the values of equations' slopes stand in registers: those by states, row by row, and those by parameters.
struct TangentEntries {
  struct Entry {
    int row = 0, column = 0;
    std::size_t place = 0;
  };
  std::vector<Entry> by_states, by_parameters;
};

/// The equations at a point, as their tangent needs them.
struct TangentPoint {
  const double* registers;    ///< that hold the values of the entries
  const unsigned char* held;  ///< per state
  const double* added;        ///< values of the added terms
};

/// Runs a model with states over rows: between two rows by Dormand and Prince's method of order 5(4) (1980) with steps
/// chosen by its error estimate, or, where that takes too many steps, by the L-stable SDIRK method of order 4(3) of Hairer
/// and Wanner (1996, IV.6). Sensitivities are those of the steps as they are taken: each stage is differentiated exactly,
/// with the Jacobians of the compiled equations, those of an explicit step's stages side by side once it is accepted. Where a
/// state is at a limit and driven beyond, it stays there.
class StateSimulator {
 public:
  StateSimulator(std::shared_ptr<const StateModel> model, const SimulationOptions& options = {});

  /// Sensitivities of all following runs are by the initial states alone.
  void KnowParameters();
  /// For all following runs.
  void SetParameters(const Eigen::VectorXd& parameters);
  /// Innovations form (Ljung 1999, 5.3): after each row the states move by gain times measured less modelled; state x output.
  /// Sensitivities by the gain, state by state, follow those by the parameters in the columns. Empty: a free run.
  void SetGain(const RowMatrix& gain) { gain_ = gain; }
  /// Initial states of an episode: as the machine file says, `estimated` (one per state, those used that are estimated)
  /// elsewhere; `slopes` (if not nullptr) by the parameters. Clamped to the limits.
  Eigen::VectorXd Initial(const Episode& episode, const Eigen::VectorXd& estimated,
                          RowMatrix* slopes = nullptr);

  /// Initial states as far as the machine file says what those that are estimated lie near; NaN elsewhere.
  Eigen::VectorXd Near(const Episode& episode) const;

  /// Runs from row `first` to row `last` (inclusive) with initial states x0. `start_slopes`: sensitivities of x0, states x
  /// columns, parameters first unless they are known; nullptr: none are wanted.
  void Run(const Episode& episode, int first, int last, const Eigen::VectorXd& x0,
           const RowMatrix* start_slopes, StateRun& run, const AddedTerms* added = nullptr);

  const StateModel& model() const { return *model_; }
  /// SI; min of each state, then max of each.
  const Eigen::VectorXd& limits() const { return limits_; }
  std::int64_t steps() const { return steps_; }  ///< taken since it was made
  std::int64_t work() const { return work_; }    ///< what they cost, in explicit steps without sensitivities

 private:
  std::vector<double> InitialRegisters(const Episode& episode) const;
  void Rate(const double* x, double fraction, double* rate);
  void RateAndSlopes(const double* x, double fraction, double* rate);
  void HoldAtLimits(const double* x, double* rate);
  void InputAt(double fraction);
  void TakeInputs(const Episode& episode, int row);
  void TakeParts(const Episode& episode, int row, double from, double to);
  void TakeRipples(const Episode& episode, int row, double from, double to);
  void Take(const RowCourse& course, std::size_t place);
  bool Row(const Episode& episode, int row);
  void Breaks(const Episode& episode, int row);
  void TakeDelayed(const Episode& episode, int row, double from, double to);
  bool Interval(double period);
  template <int kStates>
  void RateOf(const double* x, double fraction, double* rate);
  bool ExplicitStep(double fraction, double share, double period, double& error);
  template <int kStates>
  bool ExplicitStepOf(double fraction, double share, double period, double& error);
  bool ExplicitSlopes(double fraction, double share, double period);
  void SlopesAtStages(std::span<const double> nodes, double fraction, double share);
  std::array<TangentPoint, kStateStages> StagePoints() const;
  void KeepLastStage();
  bool BeginsAsItEnded();
  double Fastest();
  bool ImplicitStep(double fraction, double share, double period, double& error);
  bool SolveStage(double fraction, double step, const double* base, double* k);
  bool FactorStage(double step);
  void ImplicitSlopes(double fraction, double share, double period);
  bool Clamp();
  void Correct(const Episode& episode, int row, const StateRun& run);
  void Output(int row, StateRun& run);
  void Average(const Episode& episode, int row, StateRun& run);

  std::shared_ptr<const StateModel> model_;
  SimulationOptions options_;
  int states_, inputs_, parameters_;  ///< inputs: with what is delayed; parameters: columns of theirs
  int wanted_ = 0, columns_ = 0;      ///< columns of sensitivities, and with what they are padded by
  InputHold hold_;
  double late_;  ///< LogFormat::outputs_late: inputs act so much later on what the rows say of outputs
  Eigen::VectorXd theta_, limits_;
  RowMatrix gain_;
  RowMatrix limit_slopes_;
  std::vector<double> values_registers_, slopes_registers_, output_registers_, output_slopes_registers_;
  /// Of the equations' slopes, the stages of an explicit step side by side.
  std::vector<double> point_registers_;
  TangentEntries entries_, point_entries_;  ///< of the equations' slopes in their registers and in these
  std::vector<std::size_t> rate_places_;    ///< of the equations' values
  std::vector<double> x_, next_, scale_, u0_, u1_, bend0_, bend1_, u_, ended_u_, k_, stage_x_;
  std::vector<unsigned char> held_;       ///< states at a limit in the stage looked at
  std::vector<double> s_, stage_s_, ks_;  ///< sensitivities, row by row
  std::vector<double> jacobian_, added_values_;
  RowMatrix mean_outputs_, mean_slopes_;  ///< on the way, where readings are means
  /// Of each stage of an explicit step: values of the added terms, states held.
  std::vector<double> stage_added_;
  std::vector<unsigned char> stage_held_;
  const AddedTerms* added_ = nullptr;
  int first_ = 0;               ///< row of the run
  int added_from_ = 0;          ///< first column of the added terms
  std::vector<double> breaks_;  ///< parts of a row at whose ends a delayed input may jump or bend
  /// The first stage of the step to come is known: it was rejected, or the last stage of the one before.
  bool begun_ = false;
  std::vector<double> stage_factor_;  ///< of an implicit stage's matrix
  std::vector<std::size_t> stage_pivots_;
  std::vector<unsigned char> stage_factor_held_;  ///< states held there
  bool factored_ = false;                         ///< ... and it serves the next iteration
  bool stiff_ = false, with_slopes_ = false;
  bool limited_ = true;  ///< some state has a limit
  double next_share_ = 1, fastest_ = 0;
  std::int64_t steps_ = 0, work_ = 0;
};

}  // namespace hydroscope

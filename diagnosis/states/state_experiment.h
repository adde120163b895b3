#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "diagnosis/states/explain_states.h"
#include "diagnosis/states/record_move.h"

namespace hydroscope {

/// Of the search for a record, and when a parameter counts as seen in it; no verdict hangs on them.
struct StateExperimentOptions {
  int most_rows = 4000;       ///< of a simulated record; more tell more of the same
  int sped_up = 3;            ///< best moves that are tried at other speeds too
  int most_rivals = 4;        ///< models that are held apart, best first
  double seen = 0.7;          ///< standard error of a relative change below which a parameter is seen ...
  double clearly_seen = 0.1;  ///< ... and below which nothing more is asked for
  /// Share of the parameter seen least by which parameters are moved where a record is to show what it promises, and the share of
  /// the energy foreseen below which it does not.
  double moved = 0.1, least_promised = 0.25;
};

/// A record that might be made, simulated.
struct TriedRecord {
  RecordMove move;
  Episode record;  ///< inputs; outputs are those of its first row only
  double seconds = 0;
  /// Noise variances between the two rivals nearest to one another, with what was recorded.
  double separation = 0;
  /// Where parameters are asked for: largest standard error of a relative change of those not seen, with what was recorded.
  double standard_error = 0;
};

/// What to record so that rivals are told apart, or, if there are none, that parameters are seen that the data do not show.
struct StateExperiment {
  std::vector<std::vector<std::string>> rivals;  ///< effects of each; empty: there are none
  std::vector<std::string> unseen;               ///< parameters
  TriedRecord now;                               ///< what the recorded rows say alone
  std::vector<TriedRecord> tried;                ///< best first

  /// Whether the best is worth the while.
  bool proposed() const;
  /// Whether it is enough, for all that can be foreseen.
  bool settles() const;
};

/// Each record is simulated with every rival from where the recorded one began. How far two rivals are apart is the energy of
/// the difference of their outputs that the second's parameters, inside their ranges, and initial states cannot make up for, over
/// recorded and new rows together, by linearisation about its fit; the less of the two ways round. Noise counts as often as its
/// readings hang together. Records in which a rival diverges are left out. Nothing is tried if the verdict is not ambiguous
/// and all parameters are seen.
StateExperiment ProposeStateExperiment(const StatesExplanation& explanation,
                                       std::span<const Episode> episodes,
                                       const StateExperimentOptions& options = {});

}  // namespace hydroscope

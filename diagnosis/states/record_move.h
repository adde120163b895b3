#pragma once

#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "estimation/states/simulation.h"
#include "models/experimenter.h"

namespace hydroscope {

/// What a record of a machine with states was not driven with yet: the recorded inputs, an input of them from one level to
/// another in place of its own, sped up; or a course of an input that its kind knows.
struct RecordMove {
  struct Levels {
    int signal = 0;           ///< of the machine
    double from = 0, to = 0;  ///< SI: where the recorded input is lowest, and where it is highest
  };
  std::vector<Levels> inputs;  ///< those that differ from what was recorded
  double speed = 1;            ///< times as fast
  std::optional<InputCourse> course;
};

/// "u from -2 to 2 V (recorded: -1 to 1 V), twice as fast".
Told MoveText(const RecordMove& move, const StateModel& model, const Episode& recorded);

/// Moves of single inputs, and of all at once, within the limits that [experiment] of the machine file gives under `signals`,
/// else within what was recorded; at the recorded speed. Courses of the kind, with levels made smaller to fit.
std::vector<RecordMove> RecordMoves(const StateModel& model, const Episode& recorded);
/// How much faster or slower a record may be run through; that recorded is not among them.
std::vector<double> RecordSpeeds();
/// Whether all inputs keep to the speeds that the machine file allows.
bool KeepsSpeeds(const StateModel& model, const Episode& moved);

/// The record with its inputs moved, as long as the recorded one and no longer than `most_rows`; it begins at the states of the
/// recorded one, outputs as they were at its first row.
Episode MovedRecord(const RecordMove& move, const StateModel& model, const Episode& recorded, int most_rows);

}  // namespace hydroscope

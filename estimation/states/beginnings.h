#pragma once

#include "estimation/states/fit.h"
#include "estimation/states/shooting.h"

namespace hydroscope::shooting {

/// Moves the guessed initial states of segments (GuessSegments) to where the model, its parameters as they are, comes close to the
/// rows that follow: the largest posterior with the guess as a prior of one state's scale and readings of 5 % of an output's
/// variation, over more and more rows up to `rows`. A run that went astray guesses states, and above all phases, from which no fit
/// over a whole segment leads back. Segments that are close already stay.
void SeekBeginnings(const Task& task, const std::vector<Segment>& segments, int rows, Point& point);

}  // namespace hydroscope::shooting

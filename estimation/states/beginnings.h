#pragma once

#include "estimation/states/fit.h"
#include "estimation/states/shooting.h"

namespace hydroscope::shooting {

/// Moves the guessed initial states of segments (GuessSegments) to where the model, its parameters as they are, comes close to the
/// rows that follow: the largest posterior with the guess as a prior of one state's scale and readings of 5 % of an output's
/// variation, over more and more rows up to `rows`. A run that went astray guesses states, and above all phases, from which no fit
/// over a whole segment leads back. Segments that are close already stay.
void SeekBeginnings(const Task& task, const std::vector<Segment>& segments, int rows, Point& point);

/// Initial states of an episode, over their scale, for known parameters. The first rows tell where an episode begins; over all of
/// them a free run from elsewhere may end in a wrong minimum. Where the guess leaves more than noise in them, states that are not
/// measured are sought from where the model comes by later in the episode, too: from beyond a brim nothing leads back.
std::vector<double> BeginningOf(const Task& of_all, const Episode& episode, const Eigen::VectorXd& parameters,
                                const StateFitOptions& options);

}  // namespace hydroscope::shooting

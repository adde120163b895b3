#pragma once

#include <string>
#include <vector>

#include "core/told.h"
#include "diagnosis/states/general_laws.h"
#include "diagnosis/states/remainder.h"
#include "diagnosis/states/specificity.h"

namespace hydroscope {

// What the search for missing effects of a model with states tells people.

Told CannotBeTried(const std::string& effect, const Told& why);
/// The explanation found is not all; `unexplained`: of what functions could predict before, the share they still can.
Told MoreIsMissing(const StateRemainder& left, double unexplained);
/// The error comes in bursts.
Told BurstsText(const ErrorBursts& bursts);
/// A law may be missing that the log shows too seldom, or this tells too little.
Told MayBeMissing(const StateRemainder& left);
/// What is left is no noise of sensors; `share`: of what was found.
Told MoreIsSlow(double share);
/// A weak effect that a function without a name could stand in for.
Told NotToldFrom(const Told& effect, const LikeFunction& like);
/// Effects of the one set that the other has not, in place of those of the other.
Told InPlaceOf(const std::vector<std::string>& set, const std::vector<std::string>& other);
/// A law that the file does not name does better than the effect.
Told NotToldFromGeneral(const std::string& effect, const GeneralLaw& law);
/// A law that the file does not name takes away much beside what was found; `share`: of what both do.
Told MoreThanForeseen(const GeneralLaw& law, double share);
/// One of several effects takes away so little that what is left may be of the law it stands in for; `share`: left of that.
Told MayStandIn(const std::string& effect, double share);

}  // namespace hydroscope

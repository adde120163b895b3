#pragma once

#include <optional>
#include <string>
#include <vector>

#include "core/told.h"
#include "diagnosis/states/found_sets.h"

namespace hydroscope {

/// An effect of general shape that the machine file does not name.
struct GeneralLaw {
  std::string id;
  std::vector<std::string> equations;  ///< of these states or outputs
  Told formula;                        ///< in a state or input
};

/// A function of one state or input that laws of general shape are made of.
struct GeneralShape {
  std::string term;  ///< of {0}, which is of a size of one
  Told formula;      ///< as people read it
};
std::vector<GeneralShape> GeneralShapes(const std::string& of);

/// A law of general shape (powers and a step of each state and input), in one of the equations that `effect` adds to or in all of
/// them, that the machine file does not name and that does better in place of this effect of the set found, both fitted: a sentence
/// that says so.
std::optional<Told> BetterGeneralLaw(FoundSets& found, const std::string& effect);

/// The same of one law in the equations of the whole set, in place of all its effects, that does better: several effects imitate
/// a law that the file lacks better than one does.
std::optional<Told> GeneralLawInPlaceOfAll(FoundSets& found);

/// A law of general shape beside the set found, both fitted.
struct LawBeside {
  GeneralLaw law;
  double removed = 0;  ///< energy that it takes from what the set leaves
};

/// The one, in the equations that the set's effects add to, that takes away most. Where an effect imitates another law, what is
/// left shows far less of that about its fit than once a law beside it is fitted.
std::optional<LawBeside> FindLawBeside(FoundSets& found);

}  // namespace hydroscope

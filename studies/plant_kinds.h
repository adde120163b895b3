#pragma once

#include <initializer_list>
#include <random>
#include <string>
#include <vector>

#include "simulator/die_cushion/press_options.h"

namespace hydroscope {

/// What an imperfection asks of the diagnosis.
enum class PlantNature {
  kNoise,     ///< noise or transport: no law is missing because of it
  kLibrary,   ///< a law or a fault that the library holds
  kRelative,  ///< the physics of an effect of the library under another law, or a class without an id
  kFlagged,   ///< readings that are flagged and left out
  kFault,     ///< readings that should be, but may pass for physics
  kRefused,   ///< nothing may be concluded from such a log
};

/// A kind of imperfection of `benchmark plant-logs`: one of the simulator, or a combination of effects.
struct PlantKind {
  std::string name;  ///< of the simulator, or own
  PlantNature nature;
  std::vector<std::string> right;  ///< ids that name it rightly
  bool both_ways = false;          ///< sizes of either sign
  bool needs_effect = false;       ///< is nothing without a hidden effect
};

const std::vector<PlantKind>& PlantKinds();

/// One log to be made.
struct PlantCase {
  const PlantKind* kind = nullptr;
  PressOptions options;
  std::vector<const PlantKind*> imperfections;  ///< kinds of those of `options`
  std::vector<std::string> right;               ///< ids of everything that is hidden
  bool has_effect = false;                      ///< effects of the library are hidden beside the imperfection

  /// What is to be found, without the readings that do not count, ...
  PressOptions ToBeFound() const;
  /// ... and the same machine with nothing to be found: how far the errors differ says whether it can be.
  PressOptions Reference() const;

 private:
  /// Imperfections of these natures alone.
  PressOptions With(std::initializer_list<PlantNature> natures) const;
};

/// Case `index` of a campaign over `kinds`: machine, sizes and all further numbers at random, off every grid;
/// of every two rounds through the kinds one is with a hidden effect. `further`: imperfections of other kinds beside it, noise,
/// transport or in the library.
PlantCase DrawPlantCase(int index, std::uint64_t seed, const std::vector<const PlantKind*>& kinds,
                        int further = 0);

}  // namespace hydroscope

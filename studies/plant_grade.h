#pragma once

#include <string>
#include <vector>

#include "diagnosis/explain.h"
#include "estimation/gram_fit.h"
#include "studies/plant_kinds.h"

namespace hydroscope {

/// How an answer of `explain` is graded.
enum class PlantGrade {
  kRight,  ///< a true name is in the set; or adequate, and nothing that raises the error noticeably is hidden
  kWrong,  ///< a set without a true name, said without doubt; or a verdict where none can be
  kFlagged,  ///< a set without a true name, flagged as partial or doubtful
  kUnknown,  ///< no name, or no verdict at all
  kMissed,   ///< adequate, although something identifiable is hidden
};
const char* GradeName(PlantGrade grade);

/// Answer to one log.
struct PlantAnswer {
  bool refused = false;  ///< the chain returned an error in place of a verdict
  Verdict verdict = Verdict::kUnknown;
  std::vector<std::vector<std::string>> groups;  ///< per hidden effect those that may be it
  bool flagged = false;
  /// What explains strokes that differ from the rest; [] each if nothing.
  std::vector<std::vector<std::string>> odd = {};
  double excess = 0;  ///< relative rise of the base model's held-out error over that of the reference
};

/// Whether the truth can be identified in principle: the kind is noise, flagged or in the library, and what
/// is hidden either raises the error of the base model by more than kStrongError, or by less than
/// kNoticedError, which is as good as nothing (the right answer is then `adequate`).
bool Identifiable(const PlantCase& c, double excess);

PlantGrade GradeAnswer(const PlantCase& c, const PlantAnswer& answer);

/// A true name is there, and beside it a group without one.
bool ExtraName(const PlantCase& c, const PlantAnswer& answer);

/// A base parameter of a fit lies outside its 99.9 % interval by more than 2 % of its value (y_0: by 0.002),
/// from every value it had during the log. "" if none, else which and by how much.
std::string ParametersOff(const PlantCase& c, const std::vector<Estimate>& parameters);

}  // namespace hydroscope

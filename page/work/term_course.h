#pragma once

#include <cstdint>
#include <memory>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "models/machine.h"
#include "models/model_structure.h"
#include "workbench/compare_log.h"

namespace hydroscope {

/// A stroke, of a model the one that it errs most on, kept so that a term can be looked at over it while somebody writes it.
class TermStroke {
 public:
  /// `logs`: those that were compared; read once more where the model does not read every signal of the machine.
  static std::shared_ptr<const TermStroke> Of(const CompareResult& compared,
                                              const std::vector<std::string>& logs);

  /// The longest stroke of a log, with every signal; null: it has none.
  static std::shared_ptr<const TermStroke> Of(const std::string& log, const Machine& machine);

  /// The term of an effect of a machine file without its size, SI: `stroke`, `step` (s), `values` (a mean over each block of
  /// the model, null between stretches) and `unit` ("" = not known exactly). Null: the stroke does not hold a signal that
  /// it names.
  nlohmann::json Course(const Machine& machine, const UserEffectSpec& effect) const;

 private:
  static std::shared_ptr<const TermStroke> Of(const LogStrokes& log, std::size_t stroke, std::int64_t number);

  std::int64_t stroke_ = 0;
  StrokeStretches stretches_;
  std::shared_ptr<const ModelStructure> model_;
  int block_ = 1;  ///< samples
};

}  // namespace hydroscope

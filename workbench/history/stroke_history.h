#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "core/result.h"
#include "diagnosis/extended_fit.h"
#include "estimation/span_equations.h"
#include "models/counted_words.h"
#include "models/machine.h"
#include "models/model_structure.h"
#include "storage/database.h"
#include "workbench/explain/explain_log.h"

namespace hydroscope {

/// Strokes of one machine of a database: first <= sequence < last.
struct HistoryPart {
  std::string machine;
  std::int64_t id = 0;
  std::int64_t first = 0, last = 0;

  std::int64_t strokes() const { return last - first; }
};

/// Stored strokes as Grams, without their samples. Few strokes stand for themselves; of many, groups of
/// consecutive ones are the independent units of every fit, read from the stored sums.
struct StrokeHistory {
  std::string database;
  Machine
      machine;  ///< with the model in force, and tolerances of its geometry (pipeline/geometry_tolerance.h)
  std::shared_ptr<const ModelStructure> model;
  WindowSamples window;
  std::vector<HistoryPart> parts;
  std::vector<StrokeGram> units;
  std::vector<HistoryPart> unit_parts;  ///< the strokes of each of `units`
  std::vector<StrokeSummary> sample;    ///< of some strokes, evenly spread; `index` is the sequence

  /// RunSummary::noise_scale and evidence_scale of the strokes on average.
  double noise_scale = 1, evidence_scale = 1;
  bool noise_known = true;  ///< of all of them
  /// Energy of the noise floor (flow form) that `explain` trusts on the logs over that of white noise, on average; nothing: not
  /// known of all strokes.
  std::optional<double> floor_scale = 1.0;
  std::string no_verdict;  ///< RunSummary::too_slow or impossible of a run among them
  /// Of a machine with states, whose sums hold what no parameters of an episode take away for noise: the error that white noise
  /// causes at most, rms, SI of the output. 0: the sums themselves say what is noise.
  double white_noise = 0;

  std::int64_t strokes() const;
  /// Independent equations of all units.
  double equations() const;
  /// What noise alone would cause, of what the sums say (rms, SI of the output).
  double NoiseFloor(double of_sums) const;
  /// The same of the fit `solved` to them, of the effects `choices`, as `explain` found it on the logs where it looked.
  double NoiseFloor(std::shared_ptr<const ModelStructure> fitted, const std::vector<EffectChoice>& choices,
                    const ExtendedFit& solved) const;
  /// Counts what is known of the noise in `share` of the strokes.
  void CountNoise(const std::optional<NoiseScales>& noise, double share);
  /// Strokes of the largest unit; 1 = single strokes.
  std::int64_t strokes_per_unit() const;
};

/// Machines chosen by name, all if `names` is empty. Error: an unknown name (suggests the nearest), or no machine.
Result<std::vector<HistoryPart>> ChosenMachines(Database& database, const std::string& path,
                                                const std::vector<std::string>& names);

/// A place in a machine's history as people write it: "1234" (stroke number), "run:3" (where a log begins), "81.5s"
/// (time of the logs), "2025-03-01" or "2025-03-01T06:30" (local time, where the logs' time counts from 1970).
Result<std::int64_t> FindPlace(const Database& database, std::int64_t machine, const std::string& text);

/// Narrows a part to the strokes from `from` up to, not including, `to`; "" leaves that end as it is.
Status Narrow(const Database& database, const std::string& from, const std::string& to, HistoryPart& part);

/// What a machine of the database `path` is judged by; strokes where the database does not say.
CountedWords CountedWordsIn(const std::string& path, const std::string& machine);

/// The machine as the database has it: the version promoted last, else that of the newest run.
Result<Machine> StoredMachine(const Database& database, const std::string& path, const HistoryPart& part);

/// Reads the Grams of `parts`, several machines as one fleet; up to `most_single` strokes stand for
/// themselves. Errors: no strokes, strokes recorded with other Gram columns than `machine` has, or logs of
/// different sample periods.
Result<StrokeHistory> LoadHistory(const Database& database, const std::string& path,
                                  const std::vector<HistoryPart>& parts, const Machine& machine,
                                  std::int64_t most_single = 256);

}  // namespace hydroscope

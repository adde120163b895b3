#include "cli/machines/simulated_log.h"

#include <nlohmann/json.hpp>

#include "host/output.h"
#include "host/text_sink.h"

namespace hydroscope {

void AddFiles(CLI::App& app, SimulatedLogFiles& files) {
  app.add_option("--out", files.out, "Log to write, .csv or .csv.gz; - is stdout")
      ->type_name("FILE")
      ->required();
  app.add_option("--truth", files.truth, "Write the true parameters as JSON")->type_name("FILE");
}

Status WriteSimulated(const SimulatedLogFiles& files, std::string_view log, const nlohmann::json& truth) {
  if (const Status written = WriteTextFile(files.out, log); !written || files.truth.empty()) return written;
  return WriteJson(files.truth, truth);
}

}  // namespace hydroscope

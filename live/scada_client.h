#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "acquisition/modbus/link.h"
#include "alarms/health.h"
#include "core/result.h"

namespace hydroscope {

/// A number of the register map that is identified.
struct ScadaParameter {
  std::string name;
  double value = 0, std = 0;  ///< SI
  int quality = 0;
};
struct ScadaAxis {
  std::string name;
  Health health;       ///< its text made from the codes
  int stroke_age = 0;  ///< s, 65535: long ago or never
  std::int64_t strokes = 0;
  double oil_temperature = 0;  ///< degC
  std::vector<ScadaParameter> parameters;
};
struct ScadaAlarm {
  int number = 0, axis = 0;
  std::string name, state, severity;
  std::int64_t raised = 0;               ///< s since 1970
  double value = 0, std = 0, limit = 0;  ///< SI
};
/// A row of the journal's ring.
struct ScadaRow {
  std::int64_t sequence = 0;
  double wall = 0;  ///< s since 1970
  int alarm = 0, axis = 0;
  std::string event, state;
  std::int64_t stroke = 0;
  double value = 0;
};

/// Reads the register map of docs/register_map.md over Modbus TCP, as a SCADA system would: with registers
/// alone, nothing else of the program. Errors: nobody there, no such map.
class ScadaClient {
 public:
  static Result<ScadaClient> Connect(const std::string& host, int port);

  Result<std::vector<ScadaAxis>> Axes();
  /// Alarms that are not at rest.
  Result<std::vector<ScadaAlarm>> Alarms();
  /// Rows since the last call, in order; the first call begins with the oldest one in the ring.
  Result<std::vector<ScadaRow>> NewRows();
  /// Rows that were overwritten before they could be read.
  std::int64_t missed() const { return missed_; }
  /// Acknowledges and waits for the outcome, at most 5 s. False: there was nothing to acknowledge.
  Result<bool> Acknowledge(int number);

 private:
  using Words = std::vector<std::uint16_t>;
  explicit ScadaClient(std::unique_ptr<ModbusLink> link) : link_(std::move(link)) {}
  /// As many requests as it takes.
  Result<Words> Read(int first, int count);

  std::unique_ptr<ModbusLink> link_;
  std::int64_t next_ = 0;
  std::int64_t missed_ = 0;
};

}  // namespace hydroscope

#include "machines/valve/kind.h"

namespace hydroscope {
namespace {

MachineWords ValveWords(const Machine&) {
  return {.output = {"response", "Antwort"},
          .stroke = {"sweep", "Durchlauf"},
          .vary = {"frequency and amplitude of the command", "Frequenz und Amplitude des Befehls"},
          .hydraulic = true};
}

/// The loop of a servo axis answers like a valve.
bool IsAxis(const LogSample& log) {
  return log.signals.contains("z") && log.signals.contains("z_command") && !log.signals.contains("p_A");
}
bool HasSpoolAndCommand(const LogSample& log) {
  return log.signals.contains("y_v") && log.signals.contains("U_v");
}

Told SuitsValve(const LogSample& log) {
  if (HasSpoolAndCommand(log))
    return {"spool and valve command are there, but not both pressure and position",
            "Schieber und Ventilbefehl sind da, aber nicht beide, Druck und Position"};
  if (!IsAxis(log)) return {};
  return {"a position and its command are there, no pressure and spool",
          "eine Position und ihr Befehl sind da, kein Druck und kein Schieber"};
}

void CompleteValve(const LogSample& log, const std::map<std::string, double>&, MachineDraft& draft) {
  if (!HasSpoolAndCommand(log)) draft.machine.valve = {"z_command", "z", 1.0};
}

}  // namespace

const MachineKind kValve = {.id = "valve",
                            .title = {"valve", "Ventil"},
                            .output_unit = "m3/s",
                            .words = ValveWords,
                            .temperature = "T_oil",
                            .supply = "p_0",
                            .draft = {SuitsValve, CompleteValve}};

}  // namespace hydroscope

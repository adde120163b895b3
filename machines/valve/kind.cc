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

/// Three positions, four ports, a solenoid at either end.
MachinePicture ValvePicture() {
  MachinePicture picture;
  picture.height = 200;
  picture.drawing = R"svg(
    <path class="pipe" d="M230 80V50M250 80V50M230 120V146M250 120V134H288V158"/>
    <rect class="body" x="185" y="80" width="110" height="40" rx="3"/><path d="M221 80V120M258 80V120"/>
    <path class="thin" d="M197 100h14m-5 -4l5 4l-5 4M232 93h16M232 107h16M269 100h14m-9 -4l-5 4l5 4"/>
    <path class="thin" d="M295 90h13v20h-13M185 90h-13v20h13"/>
    <circle class="body" cx="230" cy="158" r="12"/><path class="fill" d="M224 160l6 -10l6 10z"/>
    <path class="pipe" d="M276 158v12h24v-12"/>)svg";
  picture.places = {{"U_v", 70, 100, 172, 100},
                    {"y_v", 410, 100, 258, 120},
                    {"p_0", 120, 168, 218, 158},
                    {"T_oil", 390, 168, 288, 164}};
  return picture;
}

}  // namespace

const MachineKind kValve = {.id = "valve",
                            .title = {"valve", "Ventil"},
                            .output_unit = "m3/s",
                            .words = ValveWords,
                            .picture = ValvePicture,
                            .temperature = "T_oil",
                            .supply = "p_0",
                            .draft = {SuitsValve, CompleteValve}};

}  // namespace hydroscope

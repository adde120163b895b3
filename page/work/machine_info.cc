#include "page/work/machine_info.h"

#include <nlohmann/json.hpp>

#include "models/counted_words.h"
#include "models/machine_kind.h"

namespace hydroscope {
namespace {

/// "" of signals that the kind of the machine does not know.
Wording MeaningOf(const MachineKind& kind, const std::string& signal) {
  for (const MachineInput& input : kind.signals)
    if (input.name == signal) return input.meaning;
  return "";
}

/// Of the parameters that the kind knows: name, meaning, and the unit they are shown in where the usual one does not do.
nlohmann::json KindParametersJson(const MachineKind& kind) {
  nlohmann::json parameters = nlohmann::json::object();
  for (const MachineParameter& known : kind.parameters) {
    nlohmann::json& json = parameters[std::string(known.name)];
    json = {{"symbol", known.symbol.empty() ? known.name : known.symbol},
            {"meaning", known.meaning.english},
            {"shown", nullptr},
            {"german", {{"meaning", known.meaning.german}}}};
    if (!known.shown.empty())
      json["shown"] = {{"name", known.shown}, {"factor", known.factor}, {"offset", 0}};
  }
  return parameters;
}

}  // namespace

nlohmann::json PictureJson(const Machine& machine) {
  const MachinePicture picture = PictureOf(machine);
  nlohmann::json places = nlohmann::json::array();
  for (const SignalPlace& place : picture.places) {
    const Wording meaning = MeaningOf(KindOf(machine), place.signal);
    places.push_back({{"signal", place.signal},
                      {"x", place.x},
                      {"y", place.y},
                      {"to_x", place.to_x},
                      {"to_y", place.to_y},
                      {"meaning", meaning.english},
                      {"german", {{"meaning", meaning.german}}}});
  }
  return {
      {"width", picture.width}, {"height", picture.height}, {"drawing", picture.drawing}, {"places", places}};
}

nlohmann::json MachineInfoJson(const Machine& machine) {
  const MachineKind& kind = KindOf(machine);
  const MachineWords words = WordsOf(machine);
  nlohmann::json own_effects = nlohmann::json::array();
  for (const UserEffectSpec& effect : machine.user_effects) own_effects.push_back(effect.id);
  return {{"name", machine.name},
          {"title", kind.title.english},
          {"own_effects", own_effects},
          {"version", machine.model_version},
          {"effects", machine.added_effects},
          {"output", words.output.english},
          {"stroke", words.stroke.english},
          {"sign", words.sign.english},
          {"german",
           {{"title", kind.title.german},
            {"output", words.output.InGerman()},
            {"stroke", words.stroke.InGerman()},
            {"sign", words.sign.german}}},
          {"picture", PictureJson(machine)},
          {"parameters", KindParametersJson(kind)},
          {"counted", CountedWordsOf(machine).one},
          {"states", kind.has_states},
          {"closed_loop", kind.closed_loop != nullptr},
          {"valve", kind.closed_loop == nullptr && machine.SignalIndex(machine.valve.input) >= 0 &&
                        machine.SignalIndex(machine.valve.output) >= 0},
          {"valve_alone", MeasuredByResponse(kind) && kind.closed_loop == nullptr}};
}

}  // namespace hydroscope

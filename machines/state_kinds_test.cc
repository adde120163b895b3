// What every built-in kind of machine with states must be.

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>

#include "machines/manipulator/effects/effects.h"
#include "models/expressions/check.h"
#include "models/machine_kind.h"
#include "models/state_effects.h"
#include "models/state_model.h"
#include "models/state_names.h"

namespace hydroscope {
namespace {

std::vector<const MachineKind*> BuiltInKinds() {
  std::vector<const MachineKind*> kinds;
  for (const MachineKind* kind : MachineKinds())
    if (kind->states != nullptr) kinds.push_back(kind);
  return kinds;
}

/// A machine file with all that the kind may know, its shaft taken for one whose ripple is taken out (or requires only).
std::string FileOf(const MachineKind& kind, bool all) {
  std::string text = fmt::format("[machine]\nmodel = \"{}\"\n[signals]\n", kind.id);
  for (const MachineInput& input : kind.signals)
    if (all || input.required)
      text += fmt::format("{0} = {{ column = \"{0}\", unit = \"{1}\" }}\n", input.name, input.si);
  for (const MachineInput& input : kind.signals)
    if (all && input.required && std::string_view(input.si) == "rad/s")
      text += fmt::format("[episodes]\nshaft = \"{}\"\n", input.name);
  text += "[geometry]\n";
  for (const MachineInput& input : kind.geometry)
    if (all || input.required) {
      const double size = input.otherwise ? *input.otherwise
                          : input.highest > input.lowest && input.lowest > 0
                              ? std::sqrt(input.lowest * input.highest)
                              : 0.5 * (input.lowest + input.highest);
      text +=
          fmt::format("{} = {{ value = {}, unit = \"{}\" }}\n", input.name, size == 0 ? 1.0 : size, input.si);
    }
  return text;
}

void ExpectText(const std::string& what, const std::string& text, const ExpressionNames& names,
                const std::string& unit) {
  const auto checked = CheckExpression(text, names);
  ASSERT_TRUE(checked) << what << ": " << checked.error().text.english << "\n"
                       << CaretLine(text, checked.error().at);
  const auto expected = ParseSiUnit(unit);
  if (!expected || !checked->unit.exact) return;
  EXPECT_TRUE(checked->unit.dimension == *expected)
      << what << ": " << text << " is in " << SiUnitName(checked->unit.dimension) << ", expected " << unit;
}

std::string RateOf(const std::string& unit) {
  const auto dimension = ParseSiUnit(unit);
  return dimension ? SiUnitName(*dimension / *ParseSiUnit("s")) : "";
}

std::string UnitOfEquation(const Machine& machine, const std::string& name) {
  const int state = StateIndex(machine, name), signal = machine.SignalIndex(name);
  if (state >= 0) return RateOf(machine.states.states[static_cast<std::size_t>(state)].unit);
  return machine.signals[static_cast<std::size_t>(signal)].unit;
}

void ExpectTexts(const Machine& machine) {
  const ExpressionNames names = StateNamesOf(machine);
  for (const StateSpec& s : machine.states.states) {
    ExpectText(s.name, s.ddt, names, RateOf(s.unit));
    for (const std::string& limit : {s.min, s.max})
      if (!limit.empty()) ExpectText("limit of " + s.name, limit, LimitNamesOf(machine), s.unit);
    if (s.initial != "estimate")
      ExpectText("initial of " + s.name, s.initial, InitialNamesOf(machine), s.unit);
    if (!s.near.empty()) ExpectText("initial of " + s.name, s.near, InitialNamesOf(machine), s.unit);
  }
  for (const OutputSpec& o : machine.states.outputs)
    ExpectText(o.signal, o.expression, names, UnitOfEquation(machine, o.signal));
  for (const Effect& effect : StateEffectsOf(machine))
    for (const TermSpec& term : effect.adds)
      ExpectText(effect.id, term.expression, StateNamesOf(machine, effect.parameters),
                 UnitOfEquation(machine, term.parameter));
}

TEST(KindsWithStates, LawsOfEffectsSayWhatMovesByMoreThanModelled) {
  for (const MachineKind* kind : BuiltInKinds()) {
    const auto machine = ParseMachine(FileOf(*kind, true), "conformance");
    ASSERT_TRUE(machine) << machine.error().text;
    for (const Effect& effect : StateEffectsOf(*machine)) {
      if (effect.law.find("(" + effect.adds.front().expression + ")") == effect.law.npos) continue;
      const std::string& name = effect.adds.front().parameter;
      const bool state = StateIndex(*machine, name) >= 0;
      EXPECT_TRUE(effect.law.starts_with(state ? "d" + name + "/dt = ... + (" : name + " = ... + ("))
          << kind->id << " " << effect.id << ": " << effect.law;
    }
  }
}

TEST(KindsWithStates, HaveEquationsInTheirUnitsThatBuild) {
  for (const MachineKind* kind : BuiltInKinds())
    for (const bool all : {false, true}) {
      SCOPED_TRACE(fmt::format("{}, {}", kind->id, all ? "with all signals" : "with those required"));
      const auto machine = ParseMachine(FileOf(*kind, all), "conformance");
      ASSERT_TRUE(machine) << machine.error().text << "\n" << FileOf(*kind, all);
      ExpectTexts(*machine);
      const auto base = BuildStateModel(*machine, {});
      ASSERT_TRUE(base) << base.error().text;
      for (const Effect& effect : StateEffectsOf(*machine)) {
        const auto with = BuildStateModel(*machine, {effect.id});
        EXPECT_TRUE(with) << with.error().text;
      }
      const std::string written = FormatMachine(*machine);
      for (const char* unused : {"[gate]", "[window]"})
        EXPECT_EQ(written.find(unused), written.npos) << unused;
      const auto again = ParseMachine(written, "conformance");
      ASSERT_TRUE(again) << again.error().text;
      EXPECT_EQ(*again, *machine);
    }
}

TEST(KindsWithStates, SayWhatEachParameterIs) {
  for (const MachineKind* kind : BuiltInKinds()) {
    const auto machine = ParseMachine(FileOf(*kind, true), "conformance");
    ASSERT_TRUE(machine) << machine.error().text;
    for (const ParameterSpec& p : machine->states.parameters) {
      const MachineParameter* known = FindParameter(*kind, p.name);
      ASSERT_NE(known, nullptr) << kind->id << ": " << p.name;
      EXPECT_EQ(known->si, p.unit) << kind->id << ": " << p.name;
      EXPECT_FALSE(known->meaning.english.empty() || known->sentence.german.empty())
          << kind->id << ": " << p.name;
      EXPECT_TRUE(std::isfinite(p.min) && std::isfinite(p.max) && p.min <= p.start && p.start <= p.max)
          << kind->id << ": " << p.name << " is drawn from its range";
    }
  }
}

TEST(KindsWithStates, SayWhatEachEffectIs) {
  for (const MachineKind* kind : BuiltInKinds()) {
    const auto machine = ParseMachine(FileOf(*kind, true), "conformance");
    ASSERT_TRUE(machine) << machine.error().text;
    for (const Effect& e : StateEffectsOf(*machine)) {
      EXPECT_FALSE(e.title.empty() || e.plain.empty() || e.source.empty()) << kind->id << ": " << e.id;
      for (const ParameterSpec& p : e.parameters)
        EXPECT_TRUE(std::isfinite(p.min) && std::isfinite(p.max)) << e.id << "." << p.name;
    }
  }
}

TEST(KindsWithStates, APlayIsSoftNearTheReversalOfItsLoadAlone) {
  constexpr double kCarried = 15e3;  // N, what a joint carries that never lets go
  for (const int joint : {1, 2}) {
    const ParameterSpec sets_in = manipulator::JointPlay(joint).parameters.back();
    ASSERT_EQ(sets_in.name, "F_0");
    EXPECT_LT(std::pow(std::cosh(kCarried / sets_in.max), -2), 0.01) << "else it is a soft rod";
  }
}

TEST(KindsWithStates, DriveInputsAlongTheirCourses) {
  for (const MachineKind* kind : BuiltInKinds()) {
    if (kind->experiment.courses == nullptr) continue;
    const auto machine = ParseMachine(FileOf(*kind, true), "conformance");
    ASSERT_TRUE(machine) << machine.error().text;
    for (const InputCourse& course : kind->experiment.courses(*machine)) {
      SCOPED_TRACE(fmt::format("{}, {}", kind->id, course.name.english));
      EXPECT_GE(machine->SignalIndex(course.signal), 0);
      for (const OutputSpec& output : machine->states.outputs) EXPECT_NE(output.signal, course.signal);
      EXPECT_GT(course.seconds, 0);
      EXPECT_FALSE(course.levels.empty());
    }
  }
}

}  // namespace
}  // namespace hydroscope

#include "machines/manipulator/effects/effects.h"
#include "machines/manipulator/equations.h"

namespace hydroscope::manipulator {

/// A point mass at the tip adds m a_1, m a_1^2 to link 1 and m a_2, m a_2^2 to link 2.
Effect Payload() {
  Effect e;
  e.id = "payload";
  e.title = "Payload changed";
  e.law = "mx_1 + m a_1, J_1 + m a_1^2, mx_2 + m a_2, J_2 + m a_2^2";
  e.source = "rigid-body dynamics, a point mass at the tip";
  e.plain = "The arm carries more or less than when its base parameters were identified.";
  e.german = {"Nutzlast verändert",
              "Der Arm trägt mehr oder weniger als bei der Identifikation seiner Basisparameter."};
  e.parameters = {{"m_payload", 20, -1e3, 1e4, "kg"}};
  const BaseParameters heavier = {"(mx_1 + m_payload*a_1)", "my_1", "(J_1 + m_payload*a_1^2)",
                                  "(mx_2 + m_payload*a_2)", "my_2", "(J_2 + m_payload*a_2^2)"};
  const std::string torque_1 = CylinderTorque(1), torque_2 = CylinderTorque(2);
  const Accelerations with = AccelerationsOf(heavier, torque_1, torque_2),
                      without = AccelerationsOf({}, torque_1, torque_2);
  e.adds = {{"speed_1", with.first},
            {"speed_1", "-(" + without.first + ")"},
            {"speed_2", with.second},
            {"speed_2", "-(" + without.second + ")"}};
  return e;
}

}  // namespace hydroscope::manipulator

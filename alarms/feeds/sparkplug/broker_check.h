#pragma once

#include <string>

#include "alarms/feeds/sparkplug/mqtt_connection.h"

namespace hydroscope {

/// Why no connection to a broker came about, in words that say what to change: nobody listens there, no such
/// computer, a certificate that is of another authority, of another name or expired. The MQTT library only says
/// that it failed, so that the first steps are taken again here, with a patience of 2 s each. "": these went well.
std::string WhyNoConnection(const std::string& broker, const MqttCertificates& certificates);

}  // namespace hydroscope

#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <string>

#include "core/result.h"

namespace hydroscope {

struct MqttMessage {
  std::string topic, payload;
  int quality = 0;  ///< of service: 0 or 1
};

/// PEM files of an encrypted connection.
struct MqttCertificates {
  std::string ca;                ///< signs the broker's certificate; "": those of the system
  std::string certificate, key;  ///< our own; "": the broker asks for none
};

struct MqttOptions {
  std::string broker;  ///< "tcp://host:port", or "ssl://host:port" whose certificate must be of this host
  std::string client_id;
  std::string user, password;
  MqttMessage will;                    ///< published by the broker when the connection breaks
  MqttCertificates certificates = {};  ///< of ssl://
};

/// One connection to an MQTT 3.1.1 broker; when it is over it stays over. Calls wait 2 s at most.
class MqttConnection {
 public:
  /// Called on the library's thread.
  struct Listener {
    std::function<void(std::int64_t id)> acknowledged;  ///< the broker has taken the message with this id
    std::function<void(MqttMessage message)> arrived;
    std::function<void(const std::string& why)> lost;  ///< `why` as the library says it, often ""
  };

  /// Errors: no broker there, it refuses us, its certificate is not to be trusted, a file cannot be read.
  static Result<std::unique_ptr<MqttConnection>> Open(const MqttOptions& options, Listener listener);
  /// Disconnects; after that the listener is not called.
  virtual ~MqttConnection() = default;

  virtual bool IsConnected() const = 0;
  virtual Status Subscribe(const std::string& topic) = 0;
  /// Takes the message without waiting for the broker; messages keep their order. `id` > 0 with quality 1:
  /// acknowledged(id) tells that the broker has it.
  virtual Status Publish(const MqttMessage& message, std::int64_t id = 0) = 0;
};

}  // namespace hydroscope

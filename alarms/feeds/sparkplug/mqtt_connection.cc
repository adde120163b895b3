#include "alarms/feeds/sparkplug/mqtt_connection.h"

#include <mqtt/async_client.h>

#include <chrono>
#include <fstream>

#include "alarms/feeds/sparkplug/broker_check.h"
#include "core/secret_file.h"

namespace hydroscope {
namespace {

constexpr std::chrono::seconds kPatience{2};
constexpr int kKeepAlive = 20;       // s
constexpr int kMostInFlight = 1000;  // messages the library may hold unacknowledged

/// Why a broker refuses a client (MQTT 3.1.1, 3.2.2.3).
const char* Refusal(int code) {
  switch (code) {
    case 1:
      return "it speaks no MQTT 3.1.1";
    case 2:
      return "it refuses the client's name; do its rules allow names as [feeds.sparkplug] group and node make them?";
    case 3:
      return "it says that it is not available now";
    case 4:
      return "it refuses user or password; see [feeds.sparkplug] user and password_file";
    case 5:
      return "it does not let this client in; see [feeds.sparkplug] user, password_file and certificate_file";
    default:
      return nullptr;
  }
}

/// Runs `body`; what the library throws or does not finish in time becomes an error.
template <typename Body>
Status Guarded(const std::string& broker, Body&& body) {
  try {
    if (body()) return {};
    return InternalError("the MQTT broker {} does not answer within {} s", broker, kPatience.count());
  } catch (const mqtt::exception& exception) {
    const char* const refusal = Refusal(exception.get_return_code());
    return BadInput("MQTT broker {}: {}", broker, refusal != nullptr ? refusal : exception.what());
  } catch (const std::exception& exception) {
    return BadInput("MQTT broker {}: {}", broker, exception.what());
  }
}

mqtt::ssl_options Encryption(const MqttCertificates& files) {
  mqtt::ssl_options ssl;
  ssl.set_enable_server_cert_auth(true);
  ssl.set_verify(true);  // the certificate is of the host we meant
  if (!files.ca.empty()) ssl.set_trust_store(files.ca);
  if (!files.certificate.empty()) ssl.set_key_store(files.certificate);
  if (!files.key.empty()) ssl.set_private_key(files.key);
  return ssl;
}

/// An error that names the first file that cannot be read: the library only says that it cannot connect.
Status Readable(const MqttCertificates& files) {
  for (const std::string* path : {&files.ca, &files.certificate, &files.key})
    if (!path->empty() && !std::ifstream(*path))
      return BadInput("[feeds.sparkplug]: {} cannot be read; does the file exist and may it be read?", *path);
  return files.key.empty() ? Status{} : CheckSecret(files.key, "[feeds.sparkplug] key_file");
}

class Connection : public MqttConnection, public mqtt::callback, public mqtt::iaction_listener {
 public:
  Connection(const MqttOptions& options, Listener listener)
      : broker_(options.broker),
        listener_(std::move(listener)),
        client_(options.broker, options.client_id, kMostInFlight) {
    client_.set_callback(*this);
  }
  ~Connection() override {
    if (client_.is_connected())
      static_cast<void>(Guarded(broker_, [&] { return client_.disconnect()->wait_for(kPatience); }));
  }

  Status Connect(const MqttOptions& options) {
    mqtt::connect_options connect;
    connect.set_clean_session(true);
    connect.set_keep_alive_interval(kKeepAlive);
    connect.set_connect_timeout(kPatience);
    connect.set_max_inflight(kMostInFlight);
    connect.set_will(
        mqtt::will_options(options.will.topic, options.will.payload, options.will.quality, false));
    if (!options.user.empty()) connect.set_user_name(options.user);
    if (!options.password.empty()) connect.set_password(options.password);
    if (broker_.starts_with("ssl://")) connect.set_ssl(Encryption(options.certificates));
    return Guarded(broker_, [&] { return client_.connect(connect)->wait_for(kPatience); });
  }

  bool IsConnected() const override { return client_.is_connected(); }
  Status Subscribe(const std::string& topic) override {
    return Guarded(broker_, [&] { return client_.subscribe(topic, 1)->wait_for(kPatience); });
  }
  Status Publish(const MqttMessage& message, std::int64_t id) override {
    return Guarded(broker_, [&] {
      const auto sent = mqtt::make_message(message.topic, message.payload, message.quality, false);
      if (id > 0)
        client_.publish(sent, reinterpret_cast<void*>(static_cast<std::intptr_t>(id)), *this);
      else
        client_.publish(sent);
      return true;
    });
  }

 private:
  void connection_lost(const std::string& why) override { listener_.lost(why); }
  void message_arrived(mqtt::const_message_ptr message) override {
    listener_.arrived({message->get_topic(), message->to_string(), message->get_qos()});
  }
  void on_success(const mqtt::token& token) override {
    listener_.acknowledged(
        static_cast<std::int64_t>(reinterpret_cast<std::intptr_t>(token.get_user_context())));
  }
  void on_failure(const mqtt::token&) override {}  // the message stays with the caller and is sent again

  std::string broker_;
  Listener listener_;
  mqtt::async_client client_;  // ended first: afterwards no callback comes
};

}  // namespace

Result<std::unique_ptr<MqttConnection>> MqttConnection::Open(const MqttOptions& options, Listener listener) {
  TRY(Readable(options.certificates));
  try {
    auto connection = std::make_unique<Connection>(options, std::move(listener));
    if (const Status connected = connection->Connect(options); !connected) {
      const std::string why = WhyNoConnection(options.broker, options.certificates);
      if (!why.empty()) return BadInput("MQTT broker {}: {}", options.broker, why);
      return tl::unexpected(connected.error());
    }
    return connection;
  } catch (const std::exception& exception) {
    return BadInput("[feeds.sparkplug] broker = \"{}\": {}", options.broker, exception.what());
  }
}

}  // namespace hydroscope

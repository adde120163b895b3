#include "alarms/feeds/sparkplug/mqtt_connection.h"

#include <arpa/inet.h>
#include <fcntl.h>
#include <fmt/format.h>
#include <mqtt/async_client.h>
#include <netdb.h>
#include <openssl/err.h>
#include <openssl/ssl.h>
#include <openssl/x509v3.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <cerrno>
#include <chrono>
#include <cstring>
#include <fstream>
#include <memory>
#include <string>

#include "core/secret_file.h"

namespace hydroscope {
namespace {

constexpr int kPatienceMs = 2000;
constexpr timeval kReadPatience = {2, 0};

/// A connection of TCP, closed with its object; or why there is none.
class TcpConnection {
 public:
  TcpConnection(const std::string& host, const std::string& port) {
    addrinfo wanted{}, *found = nullptr;
    wanted.ai_socktype = SOCK_STREAM;
    if (const int failed = getaddrinfo(host.c_str(), port.c_str(), &wanted, &found); failed != 0) {
      problem_ = fmt::format("the name {} is not known: {}", host, gai_strerror(failed));
      return;
    }
    const std::unique_ptr<addrinfo, decltype(&freeaddrinfo)> addresses(found, freeaddrinfo);
    for (const addrinfo* address = found; address != nullptr && !Connect(*address, host, port);
         address = address->ai_next) {
    }
  }
  ~TcpConnection() { Close(); }
  TcpConnection(const TcpConnection&) = delete;
  TcpConnection& operator=(const TcpConnection&) = delete;

  int socket() const { return socket_; }
  const std::string& problem() const { return problem_; }

 private:
  void Close() {
    if (socket_ >= 0) close(socket_);
    socket_ = -1;
  }
  bool Connect(const addrinfo& address, const std::string& host, const std::string& port) {
    Close();
    socket_ = ::socket(address.ai_family, SOCK_STREAM | SOCK_NONBLOCK | SOCK_CLOEXEC, 0);
    int error = 0;
    if (connect(socket_, address.ai_addr, address.ai_addrlen) != 0) {
      pollfd waiting{socket_, POLLOUT, 0};
      socklen_t size = sizeof error;
      if (errno != EINPROGRESS)
        error = errno;
      else if (poll(&waiting, 1, kPatienceMs) <= 0)
        error = ETIMEDOUT;
      else
        getsockopt(socket_, SOL_SOCKET, SO_ERROR, &error, &size);
    }
    problem_ = error == 0 ? "" : fmt::format("nobody listens at {}:{}: {}", host, port, std::strerror(error));
    if (error != 0) return false;
    fcntl(socket_, F_SETFL, fcntl(socket_, F_GETFL) & ~O_NONBLOCK);  // from here on with waits that end
    setsockopt(socket_, SOL_SOCKET, SO_RCVTIMEO, &kReadPatience, sizeof kReadPatience);
    setsockopt(socket_, SOL_SOCKET, SO_SNDTIMEO, &kReadPatience, sizeof kReadPatience);
    return true;
  }

  int socket_ = -1;
  std::string problem_;
};

std::string Words(long verified, const std::string& host) {
  switch (verified) {
    case X509_V_ERR_CERT_HAS_EXPIRED:
      return "the certificate of the broker, or of its authority, has expired";
    case X509_V_ERR_CERT_NOT_YET_VALID:
      return "the certificate of the broker is not valid yet; is a clock wrong?";
    case X509_V_ERR_HOSTNAME_MISMATCH:
    case X509_V_ERR_IP_ADDRESS_MISMATCH:
      return fmt::format("the certificate of the broker is not of {}: it was made for another name", host);
    case X509_V_ERR_UNABLE_TO_GET_ISSUER_CERT_LOCALLY:
    case X509_V_ERR_UNABLE_TO_GET_ISSUER_CERT:
    case X509_V_ERR_SELF_SIGNED_CERT_IN_CHAIN:
    case X509_V_ERR_DEPTH_ZERO_SELF_SIGNED_CERT:
    case X509_V_ERR_UNABLE_TO_VERIFY_LEAF_SIGNATURE:
    case X509_V_ERR_CERT_SIGNATURE_FAILURE:
      return "the certificate of the broker is of another authority than ca_file";
    default:
      return fmt::format("the certificate of the broker is refused: {}",
                         X509_verify_cert_error_string(verified));
  }
}

/// What OpenSSL has to say last, in its own words.
std::string LastError() {
  char text[256] = "";
  if (const unsigned long error = ERR_peek_last_error(); error != 0)
    ERR_error_string_n(error, text, sizeof text);
  ERR_clear_error();
  return text;
}

std::string WhyNotEncrypted(const std::string& host, int socket, const MqttCertificates& files) {
  const std::unique_ptr<SSL_CTX, decltype(&SSL_CTX_free)> context(SSL_CTX_new(TLS_client_method()),
                                                                  SSL_CTX_free);
  SSL_CTX_set_verify(context.get(), SSL_VERIFY_PEER, nullptr);
  if (files.ca.empty())
    SSL_CTX_set_default_verify_paths(context.get());
  else if (SSL_CTX_load_verify_locations(context.get(), files.ca.c_str(), nullptr) != 1)
    return fmt::format("ca_file = \"{}\" holds no certificate: {}", files.ca, LastError());
  if (!files.certificate.empty() &&
      SSL_CTX_use_certificate_chain_file(context.get(), files.certificate.c_str()) != 1)
    return fmt::format("certificate_file = \"{}\" holds no certificate: {}", files.certificate, LastError());
  if (!files.key.empty() &&
      SSL_CTX_use_PrivateKey_file(context.get(), files.key.c_str(), SSL_FILETYPE_PEM) != 1)
    return fmt::format("key_file = \"{}\" is not the key of certificate_file: {}", files.key, LastError());
  const std::unique_ptr<SSL, decltype(&SSL_free)> tls(SSL_new(context.get()), SSL_free);
  in6_addr any{};
  if (inet_pton(AF_INET, host.c_str(), &any) == 1 || inet_pton(AF_INET6, host.c_str(), &any) == 1) {
    X509_VERIFY_PARAM_set1_ip_asc(SSL_get0_param(tls.get()), host.c_str());
  } else {
    SSL_set1_host(tls.get(), host.c_str());
    SSL_set_tlsext_host_name(tls.get(), host.c_str());
  }
  SSL_set_fd(tls.get(), socket);
  char byte = 0;
  // Whether our own certificate is accepted shows when something is read.
  if (SSL_connect(tls.get()) == 1 && (SSL_peek(tls.get(), &byte, 1) == 1 || ERR_peek_error() == 0)) return "";
  if (const long verified = SSL_get_verify_result(tls.get()); verified != X509_V_OK)
    return Words(verified, host);
  const std::string error = LastError();
  if (error.find("alert") != std::string::npos)
    return fmt::format(
        "the broker refuses our certificate: certificate_file is missing, expired or of another "
        "authority than the broker trusts ({})",
        error);
  return error.empty() ? "the broker speaks no TLS there" : fmt::format("no TLS with the broker: {}", error);
}

/// Why no connection to a broker came about, in words that say what to change: nobody listens there, no such
/// computer, a certificate that is of another authority, of another name or expired. The MQTT library only says
/// that it failed, so that the first steps are taken again here, with a patience of 2 s each. "": these went well.
std::string WhyNoConnection(const std::string& broker, const MqttCertificates& certificates) {
  const std::size_t begin = broker.find("://"), colon = broker.rfind(':');
  if (begin == std::string::npos || colon <= begin) return "";
  const std::string host = broker.substr(begin + 3, colon - begin - 3);
  const TcpConnection connection(host, broker.substr(colon + 1));
  if (!connection.problem().empty()) return connection.problem();
  return broker.starts_with("ssl://") ? WhyNotEncrypted(host, connection.socket(), certificates) : "";
}

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

#include "alarms/feeds/sparkplug/broker_check.h"

#include <arpa/inet.h>
#include <fcntl.h>
#include <fmt/format.h>
#include <netdb.h>
#include <openssl/err.h>
#include <openssl/ssl.h>
#include <openssl/x509v3.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <memory>

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

}  // namespace

std::string WhyNoConnection(const std::string& broker, const MqttCertificates& certificates) {
  const std::size_t begin = broker.find("://"), colon = broker.rfind(':');
  if (begin == std::string::npos || colon <= begin) return "";
  const std::string host = broker.substr(begin + 3, colon - begin - 3);
  const TcpConnection connection(host, broker.substr(colon + 1));
  if (!connection.problem().empty()) return connection.problem();
  return broker.starts_with("ssl://") ? WhyNotEncrypted(host, connection.socket(), certificates) : "";
}

}  // namespace hydroscope

#include "live/service_socket.h"

#include <sys/socket.h>
#include <sys/time.h>
#include <sys/un.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <nlohmann/json.hpp>

namespace hydroscope {

std::string SocketOf(const std::string& database) { return database + ".sock"; }

Result<std::string> AskService(const std::string& path, const std::string& method, const std::string& what) {
  sockaddr_un address{};
  address.sun_family = AF_UNIX;
  if (path.size() >= sizeof(address.sun_path))
    return UsageError("the path {} is too long for a socket", path);
  std::strcpy(address.sun_path, path.c_str());
  const int link = socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0);
  const timeval patience{5, 0};
  setsockopt(link, SOL_SOCKET, SO_RCVTIMEO, &patience, sizeof(patience));
  if (connect(link, reinterpret_cast<const sockaddr*>(&address), sizeof(address)) != 0) {
    const int error = errno;
    close(link);
    if (error == EACCES || error == EPERM)
      return BadInput(
          "the service at {} may not be asked by this user; its user and its group may: ask for that group, "
          "or run the command as its user",
          path);
    return BadInput("no service answers at {}; is `hydroscope serve` running with this database?", path);
  }
  const std::string request = fmt::format("{} {} HTTP/1.0\r\n\r\n", method, what);
  std::string answer;
  if (send(link, request.data(), request.size(), MSG_NOSIGNAL) == static_cast<ssize_t>(request.size())) {
    char piece[4096];
    for (ssize_t got = 0; (got = recv(link, piece, sizeof(piece), 0)) > 0;)
      answer.append(piece, static_cast<std::size_t>(got));
  }
  close(link);
  const std::size_t body = answer.find("\r\n\r\n");
  if (body == std::string::npos) return InternalError("the service at {} gave no answer within 5 s", path);
  if (answer.find(" 200 ") > answer.find("\r\n"))
    return BadInput("the service says: {}", answer.substr(body + 4));
  return answer.substr(body + 4);
}

std::string WhyNothingIsStored(const std::string& database) {
  const auto answer = AskService(SocketOf(database), "GET", "/status");
  const auto status = answer ? nlohmann::json::parse(*answer, nullptr, false) : nlohmann::json();
  if (!status.is_object() || !status.contains("writer")) return "";
  const nlohmann::json& writer = status["writer"];
  return writer.value("state", "writing") == "writing" ? "" : writer.value("problem", "nobody knows why");
}

}  // namespace hydroscope

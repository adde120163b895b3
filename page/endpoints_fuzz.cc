// libFuzzer target: whatever bytes come to the server, and whatever is asked of any request that the page answers, there is an
// answer, and the server goes on.
#include <sys/socket.h>
#include <sys/time.h>
#include <sys/un.h>
#include <unistd.h>

#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <filesystem>

#include "page/api_route.h"
#include "page/page_server.h"
#include "storage/database.h"

namespace {

using namespace hydroscope;

/// The page of a service over an empty database, by the socket of its owner, whom nothing is refused.
class ServedPage {
 public:
  ServedPage() {
    const char* tests = std::getenv("TMPDIR");
    std::string folder = std::string(tests == nullptr ? "/tmp" : tests) + "/endpoints_fuzz_XXXXXX";
    if (mkdtemp(folder.data()) == nullptr) std::abort();
    folder_ = folder;
    ServicePageOptions options;
    options.watch.database = folder_ + "/empty.db";
    options.listen.socket = socket_ = folder_ + "/socket";
    options.service = [](const HttpRequest&) { return std::nullopt; };
    if (!Database::Open(options.watch.database)) std::abort();
    auto page = PageServer::OpenForService(options);
    if (!page) std::abort();
    page_ = std::move(*page);
  }
  ~ServedPage() {
    page_.reset();
    std::filesystem::remove_all(folder_);
  }

  /// Sends and hangs up.
  void Send(const std::string& bytes) const { close(Sent(bytes)); }
  /// What comes back of a whole request, until the end; of a stream of events, which has none, its begin.
  std::string Ask(const std::string& request, bool streams = false) const {
    const int link = Sent(request);
    std::string answer;
    char piece[4096];
    ssize_t got = 0;
    while ((got = recv(link, piece, sizeof(piece), 0)) > 0) {
      answer.append(piece, static_cast<std::size_t>(got));
      if (streams) break;
    }
    if (got < 0 && errno == EAGAIN) std::abort();  // it hangs
    close(link);
    return answer;
  }

 private:
  int Sent(const std::string& bytes) const {
    const int link = socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0);
    const timeval patience{20, 0};
    setsockopt(link, SOL_SOCKET, SO_RCVTIMEO, &patience, sizeof(patience));
    sockaddr_un address{};
    address.sun_family = AF_UNIX;
    std::strncpy(address.sun_path, socket_.c_str(), sizeof(address.sun_path) - 1);
    if (connect(link, reinterpret_cast<const sockaddr*>(&address), sizeof(address)) != 0) std::abort();
    for (std::size_t sent = 0; sent < bytes.size();) {
      const ssize_t more = send(link, bytes.data() + sent, bytes.size() - sent, MSG_NOSIGNAL);
      if (more <= 0) break;  // refused before all of it was read
      sent += static_cast<std::size_t>(more);
    }
    return link;
  }

  std::string folder_, socket_;
  std::unique_ptr<PageServer> page_;
};

/// A query as it stands in an address: "name=press.csv&version=1".
std::string Encoded(const std::string& query) {
  std::string out;
  for (const unsigned char c : query)
    out += std::isalnum(c) != 0 || c == '=' || c == '&' ? std::string(1, static_cast<char>(c))
                                                        : fmt::format("%{:02X}", c);
  return out;
}

std::string Request(const std::string& method, const std::string& path, const std::string& query,
                    const std::string& body) {
  return fmt::format("{} {}{}?{} HTTP/1.1\r\nHost: page\r\nConnection: close\r\nContent-Length: {}\r\n\r\n{}",
                     method, kApi, path, Encoded(query), method == "POST" ? body.size() : 0,
                     method == "POST" ? body : "");
}

}  // namespace

/// The bytes as they are; then of each request the first line of them as the query and the rest as the body.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static const ServedPage page;
  const std::string bytes(reinterpret_cast<const char*>(data), size);
  page.Send(bytes);
  const std::size_t end = std::min(bytes.find('\n'), bytes.size());
  const std::string query = bytes.substr(0, end), body = bytes.substr(std::min(end + 1, bytes.size()));
  (void)page.Ask(Request("POST", "logs", "name=press.csv", "t,p,F\n0,1,2\n1,2,3\n2,1,4\n3,5,1\n"));
  for (const ApiRoute& route : ApiRoutes()) {
    const std::string answer =
        page.Ask(Request(route.method, route.path, query, body), std::string(route.path) == "events");
    if (answer.starts_with("HTTP/1.1 ") && answer.compare(9, 3, "500") != 0) continue;
    std::fprintf(stderr, "%s %s: %s\n", route.method, route.path, answer.c_str());
    std::abort();
  }
  return 0;
}

#pragma once

#include <cstdint>
#include <map>
#include <string>

namespace hydroscope {

/// A request as the server read it.
struct HttpRequest {
  std::string method, path;                  ///< "GET", "/api/v1/session"
  std::map<std::string, std::string> query;  ///< decoded
  std::string host, origin, fetch_site;      ///< headers Host, Origin, Sec-Fetch-Site; "" = absent
  std::string token;                         ///< header X-Hydroscope-Token
  std::int64_t length = -1;                  ///< header Content-Length; -1 = absent
  bool by_socket = false;                    ///< not by the port: from the owner of the program
  std::string body;                          ///< or, of an upload, empty ...
  std::string file;                          ///< ... and this file holds it
};

/// An answer.
struct HttpReply {
  unsigned status = 200;
  std::string type = "application/json";
  std::string body;
  bool gzipped = false;  ///< the body is
  bool stays = false;    ///< may be kept by the browser for good
};

}  // namespace hydroscope

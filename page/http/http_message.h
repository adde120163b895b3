#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "page/access/role.h"

namespace hydroscope {

/// A request as the server read it.
struct HttpRequest {
  std::string method, path;                    ///< "GET", "/api/v1/session"
  std::map<std::string, std::string> query;    ///< decoded
  std::map<std::string, std::string> cookies;  ///< by name
  std::string host, origin, fetch_site;        ///< headers Host, Origin, Sec-Fetch-Site; "" = absent
  std::string token;                           ///< header X-Hydroscope-Token
  std::string from;                            ///< address of who asks; "" by the socket
  std::int64_t length = -1;                    ///< header Content-Length; -1 = absent
  bool by_socket = false;                      ///< not by the port: from the owner of the program
  Who who;                                     ///< as found out before it is answered
  std::string body;                            ///< or, of an upload, empty ...
  std::string file;                            ///< ... and this file holds it

  /// "" if the query has no such name.
  std::string Query(const std::string& name) const {
    const auto found = query.find(name);
    return found == query.end() ? "" : found->second;
  }
};

/// An answer.
struct HttpReply {
  unsigned status = 200;
  std::string type = "application/json";
  std::string body;
  bool gzipped = false;                                           ///< the body is
  bool stays = false;                                             ///< may be kept by the browser for good
  std::vector<std::pair<std::string, std::string>> headers = {};  ///< more of them
};

}  // namespace hydroscope

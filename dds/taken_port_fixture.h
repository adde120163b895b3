#pragma once

#include <gtest/gtest.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <unistd.h>

#include "dds/participant.h"

namespace hydroscope {

/// Another program, which never heard of DDS, on the port of a domain.
class TakenPort {
 public:
  explicit TakenPort(int domain) {
    sockaddr_in address{};
    address.sin_family = AF_INET;
    address.sin_port = htons(static_cast<std::uint16_t>(DiscoveryPort(domain)));
    EXPECT_EQ(bind(socket_, reinterpret_cast<const sockaddr*>(&address), sizeof address), 0);
  }
  TakenPort(const TakenPort&) = delete;
  TakenPort& operator=(const TakenPort&) = delete;
  ~TakenPort() { close(socket_); }

 private:
  int socket_ = socket(AF_INET, SOCK_DGRAM, 0);
};

}  // namespace hydroscope

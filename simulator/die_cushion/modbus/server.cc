#include "simulator/die_cushion/modbus/server.h"

#include <arpa/inet.h>
#include <modbus/modbus.h>
#include <netinet/in.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <cerrno>
#include <mutex>
#include <thread>
#include <vector>

#include "core/contains.h"
#include "simulator/random.h"

namespace hydroscope {
namespace {

constexpr int kAddresses = 65536, kCoils = 8;
constexpr int kWake = 20;  // ms between two looks at the stop flag
constexpr std::size_t kMostClients = 32;
constexpr int kFunctionCode = 7;  // place in a Modbus TCP request

struct FreeContext {
  void operator()(modbus_t* context) const { modbus_free(context); }
};
struct FreeMapping {
  void operator()(modbus_mapping_t* mapping) const { modbus_mapping_free(mapping); }
};

bool IsServed(std::uint8_t function) {
  constexpr std::array<std::uint8_t, 8> kServed = {1, 3, 5, 6, 15, 16, 22, 23};
  return Contains(kServed, function);
}

/// Waits without a clock of our own.
void Pause(int milliseconds) { poll(nullptr, 0, milliseconds); }

class Server : public ModbusServer {
 public:
  Server(std::unique_ptr<modbus_t, FreeContext> context,
         std::unique_ptr<modbus_mapping_t, FreeMapping> mapping, int listener, int port, OnCoil on_coil)
      : context_(std::move(context)),
        mapping_(std::move(mapping)),
        listener_(listener),
        port_(port),
        on_coil_(std::move(on_coil)),
        thread_([this](std::stop_token stop) { Serve(stop); }) {}
  ~Server() override {
    thread_ = {};
    for (const int client : clients_) close(client);
    close(listener_);
  }

  int port() const override { return port_; }
  void Update(const Change& change) override {
    std::lock_guard lock(mutex_);
    change(Registers());
  }
  void SetFault(ModbusFault fault, double delay) override {
    delay_ms_ = static_cast<int>(delay * 1e3);
    fault_ = fault;
  }

 private:
  std::span<std::uint16_t> Registers() { return {mapping_->tab_registers, kAddresses}; }

  void Serve(const std::stop_token& stop) {
    std::vector<pollfd> sockets;
    while (!stop.stop_requested()) {
      if (fault_ == ModbusFault::kHang) {
        Pause(kWake);
        continue;
      }
      sockets.assign(1, {listener_, POLLIN, 0});
      for (const int client : clients_) sockets.push_back({client, POLLIN, 0});
      if (poll(sockets.data(), sockets.size(), kWake) <= 0) continue;
      for (std::size_t k = 1; k < sockets.size(); ++k)
        if (sockets[k].revents != 0 && !Answer(sockets[k].fd)) Drop(sockets[k].fd);
      if (sockets[0].revents != 0) Accept();
    }
  }

  void Accept() {
    const int client = accept(listener_, nullptr, nullptr);
    if (client < 0) return;
    if (clients_.size() == kMostClients) {
      close(client);
      return;
    }
    clients_.push_back(client);
  }
  void Drop(int client) {
    close(client);
    std::erase(clients_, client);
  }

  /// False if the connection is over.
  bool Answer(int client) {
    std::array<std::uint8_t, MODBUS_TCP_MAX_ADU_LENGTH> request{};
    modbus_set_socket(context_.get(), client);
    const int length = modbus_receive(context_.get(), request.data());
    if (length <= kFunctionCode) return false;
    if (fault_ == ModbusFault::kGarbage) return SendGarbage(client);
    if (fault_ == ModbusFault::kLate) Pause(delay_ms_);
    std::lock_guard lock(mutex_);
    if (!IsServed(request[kFunctionCode]))
      return modbus_reply_exception(context_.get(), request.data(), MODBUS_EXCEPTION_ILLEGAL_FUNCTION) >= 0;
    const bool sent = modbus_reply(context_.get(), request.data(), length, mapping_.get()) >= 0;
    for (int coil = 0; coil < kCoils; ++coil) {
      if (mapping_->tab_bits[coil] == 0) continue;
      mapping_->tab_bits[coil] = 0;
      on_coil_(coil, Registers());
    }
    return sent;
  }

  bool SendGarbage(int client) {
    std::array<std::uint8_t, 64> bytes;
    for (std::uint8_t& byte : bytes) byte = static_cast<std::uint8_t>(garbage_.Uniform(0, 256));
    const auto length = static_cast<std::size_t>(garbage_.Uniform(1, bytes.size()));
    return send(client, bytes.data(), length, MSG_NOSIGNAL) >= 0;
  }

  std::unique_ptr<modbus_t, FreeContext> context_;
  std::unique_ptr<modbus_mapping_t, FreeMapping> mapping_;
  int listener_, port_;
  OnCoil on_coil_;
  std::vector<int> clients_;
  std::mutex mutex_;
  std::atomic<ModbusFault> fault_ = ModbusFault::kNone;
  std::atomic<int> delay_ms_ = 0;
  RandomStream garbage_{1};
  std::jthread thread_;
};

int PortOf(int socket) {
  sockaddr_in address{};
  socklen_t size = sizeof(address);
  getsockname(socket, reinterpret_cast<sockaddr*>(&address), &size);
  return ntohs(address.sin_port);
}

}  // namespace

Result<std::unique_ptr<ModbusServer>> ModbusServer::Start(const std::string& host, int port,
                                                          const Change& fill, OnCoil on_coil) {
  std::unique_ptr<modbus_t, FreeContext> context(modbus_new_tcp(host.c_str(), port));
  std::unique_ptr<modbus_mapping_t, FreeMapping> mapping(modbus_mapping_new(kCoils, 0, kAddresses, 0));
  if (!context || !mapping) return InternalError("no memory for the Modbus registers");
  fill({mapping->tab_registers, kAddresses});
  // A malformed or half request may hold up the other clients for this long only.
  modbus_set_response_timeout(context.get(), 0, 1000);
  modbus_set_byte_timeout(context.get(), 0, 20000);
  const int listener = modbus_tcp_listen(context.get(), 8);
  if (listener < 0)
    return BadInput(
        "Modbus server: {}:{} cannot be opened: {}; expected an address of this computer and a free port",
        host, port, modbus_strerror(errno));
  return std::make_unique<Server>(std::move(context), std::move(mapping), listener, PortOf(listener),
                                  std::move(on_coil));
}

}  // namespace hydroscope

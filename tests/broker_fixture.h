#pragma once

#include <arpa/inet.h>
#include <fcntl.h>
#include <fmt/format.h>
#include <gtest/gtest.h>
#include <signal.h>
#include <sys/prctl.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <sstream>
#include <string>
#include <thread>
#include <vector>

namespace hydroscope {

/// Another program, its output in a file, killed with its object.
class Program {
 public:
  Program() = default;
  ~Program() { Kill(); }
  Program(const Program&) = delete;
  Program& operator=(const Program&) = delete;

  /// A path in the usual places, "" if the program is not there.
  static std::string Find(const std::string& name) {
    for (const char* folder : {"/usr/sbin/", "/usr/bin/", "/usr/local/sbin/", "/usr/local/bin/"})
      if (access((folder + name).c_str(), X_OK) == 0) return folder + name;
    return "";
  }
  void Start(const std::string& name, const std::vector<std::string>& arguments, const std::string& output) {
    Kill();
    const std::string path = Find(name);
    std::vector<char*> words = {const_cast<char*>(path.c_str())};
    for (const std::string& argument : arguments) words.push_back(const_cast<char*>(argument.c_str()));
    words.push_back(nullptr);
    pid_ = fork();
    if (pid_ != 0) return;
    prctl(PR_SET_PDEATHSIG, SIGKILL);
    dup2(open("/dev/null", O_RDONLY), STDIN_FILENO);
    dup2(open(output.c_str(), O_WRONLY | O_CREAT | O_APPEND, 0644), STDOUT_FILENO);
    dup2(open("/dev/null", O_WRONLY), STDERR_FILENO);
    execv(path.c_str(), words.data());
    _exit(127);
  }
  /// Exit code.
  int Wait() {
    int state = 0;
    waitpid(pid_, &state, 0);
    pid_ = -1;
    return WEXITSTATUS(state);
  }
  void Kill() {
    if (pid_ <= 0) return;
    kill(pid_, SIGKILL);
    Wait();
  }

 private:
  pid_t pid_ = -1;
};

/// A real broker, the program mosquitto, on a port of its own; lives may follow each other on the same port.
class Broker {
 public:
  Broker() : port_(FreePort()) {}

  /// `more`: lines of its configuration, further listeners say.
  void Start(const std::string& folder, const std::string& more = "") {
    const std::string configuration = folder + "/mosquitto.conf";
    std::ofstream(configuration) << "listener " << port_
                                 << " 127.0.0.1\nallow_anonymous true\npersistence false\n"
                                 << "max_queued_messages 100000\nmax_inflight_messages 0\nlog_dest none\n"
                                 << (getuid() == 0 ? "user root\n" : "") << more;
    program_.Start("mosquitto", {"-c", configuration}, "/dev/null");
  }
  void Kill() { program_.Kill(); }
  std::string address() const { return "tcp://127.0.0.1:" + port(); }
  std::string port() const { return std::to_string(port_); }
  /// One that nobody listens on.
  static int FreePort() {
    const int probe = socket(AF_INET, SOCK_STREAM, 0);
    sockaddr_in address{};
    address.sin_family = AF_INET;
    address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    socklen_t size = sizeof address;
    bind(probe, reinterpret_cast<sockaddr*>(&address), size);
    getsockname(probe, reinterpret_cast<sockaddr*>(&address), &size);
    close(probe);
    return ntohs(address.sin_port);
  }

 private:
  int port_;
  Program program_;
};

/// A host application that is none of ours: mosquitto_sub takes every Sparkplug message, the npm package
/// sparkplug-payload decodes it.
class Host {
 public:
  explicit Host(const std::string& folder)
      : messages_(folder + "/messages.txt"), errors_(folder + "/errors.txt") {}

  /// What is not installed, "" if all is there.
  static std::string Missing() {
    for (const char* name : {"mosquitto", "mosquitto_sub", "mosquitto_pub"})
      if (Program::Find(name).empty()) return name;
    if (Program::Find("node").empty()) return "node";
    return std::filesystem::exists(Decoder() + "/node_modules") ? "" : "the decoder of " + Decoder();
  }
  /// Until messages arrive.
  bool Connect(const std::string& port) {
    for (int k = 0; k < 50; ++k) {
      if (k % 10 == 0)
        subscriber_.Start("mosquitto_sub",
                          {"-h", "127.0.0.1", "-p", port, "-q", "1", "-t", "spBv1.0/#", "-F", "%t %q %x"},
                          messages_);
      const std::size_t before = Lines("probe").size();
      if (!Send(port, "spBv1.0/probe", "00")) {
        std::this_thread::sleep_for(std::chrono::milliseconds(50));
        continue;
      }
      std::this_thread::sleep_for(std::chrono::milliseconds(30));
      if (Lines("probe").size() > before) return true;
    }
    return false;
  }
  /// Publishes a text; `retained`: the broker gives it to whoever subscribes later.
  bool SendText(const std::string& port, const std::string& topic, const std::string& text,
                bool retained) const {
    std::vector<std::string> words = {"-h", "127.0.0.1", "-p", port, "-q", "1", "-t", topic, "-m", text};
    if (retained) words.push_back("-r");
    Program publisher;
    publisher.Start("mosquitto_pub", words, errors_);
    return publisher.Wait() == 0;
  }
  /// Publishes bytes given as hex digits.
  bool Send(const std::string& port, const std::string& topic, const std::string& hex) const {
    std::ofstream bytes(messages_ + ".payload", std::ios::binary);
    for (std::size_t k = 0; k + 1 < hex.size(); k += 2)
      bytes.put(static_cast<char>(std::stoi(hex.substr(k, 2), nullptr, 16)));
    bytes.close();
    Program publisher;
    publisher.Start("mosquitto_pub",
                    {"-h", "127.0.0.1", "-p", port, "-q", "1", "-t", topic, "-f", messages_ + ".payload"},
                    errors_);
    return publisher.Wait() == 0;
  }
  /// Messages of the node whose topic contains `part`.
  std::size_t Count(const std::string& part) const { return Lines(part).size(); }
  /// {"topic", "quality", "payload"} of the node's messages with `part` in their topic, in order.
  std::vector<nlohmann::json> Decoded(const std::string& part) const {
    const std::string some = messages_ + ".some";
    {
      std::ofstream out(some);
      for (const std::string& line : Lines(part)) out << line << "\n";
    }
    std::remove((some + ".json").c_str());
    Program decoder;
    decoder.Start("node", {Decoder() + "/decode.js", some}, some + ".json");
    EXPECT_EQ(decoder.Wait(), 0) << "the decoder refuses a payload";
    std::vector<nlohmann::json> decoded;
    std::ifstream in(some + ".json");
    for (std::string line; std::getline(in, line);)
      decoded.push_back(nlohmann::json::parse(line, nullptr, false));
    return decoded;
  }
  static std::string Decoder() {
    return std::string(HYDROSCOPE_SOURCE_DIR) + "/alarms/feeds/sparkplug/decoder";
  }

 private:
  /// Complete lines; probes and commands are left out unless asked for.
  std::vector<std::string> Lines(const std::string& part) const {
    std::vector<std::string> lines;
    std::ifstream in(messages_);
    for (std::string line; std::getline(in, line) && !in.eof();) {
      const std::string topic = line.substr(0, line.find(' '));
      const bool own = topic.find("probe") == std::string::npos && topic.find("CMD") == std::string::npos &&
                       topic.find("STATE") == std::string::npos;
      if (topic.find(part) != std::string::npos && (own || !part.empty())) lines.push_back(line);
    }
    return lines;
  }

  std::string messages_, errors_;
  Program subscriber_;
};

}  // namespace hydroscope

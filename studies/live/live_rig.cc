#include "studies/live/live_rig.h"

#include <fcntl.h>
#include <sched.h>
#include <signal.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <filesystem>
#include <fstream>
#include <thread>

#include "dds/domains.h"
#include "live/service_socket.h"

namespace hydroscope {
namespace {

constexpr double kLook = 0.02;  ///< s between two questions

/// The press of machines/press_live.toml with any number of axes, on a domain and a port of its own.
std::string MachineText(const RigOptions& o, int domain, int port, const std::string& own_address) {
  std::string axes;
  for (int a = 1; a <= o.axes; ++a) axes += fmt::format("{}\"cushion_{}\"", a > 1 ? ", " : "", a);
  std::string text = fmt::format(
      "[machine]\nname = \"press\"\nmodel = \"die_cushion\"\n\n[live]\ngrid_period = {}\naxes = [{}]\n\n"
      "[live.modbus]\nhost = \"{}\"\nport = {}\nunit = 1\npoll_period = 0.1\ntimeout = 0.3\nheartbeat = 15\n"
      "time = 8\nsweep = {{ coil = 0, status = 20, axis = 21, amplitude = 22 }}\n",
      1 / o.rate, axes, o.press_address, port);
  if (o.modbus_ring) {
    const int width = 2 + 14 * o.axes;
    text += fmt::format(
        "ring = {{ session = 2, newest = 4, time = 8, first = 1000, records = {}, width = {}, "
        "period = {}, poll_period = 0.01 }}\n",
        std::min(1024, (65536 - 1000) / width), width, 1 / o.rate);
  } else {
    text += fmt::format(
        "\n[live.dds]\ndomain = {}\ntopic = \"hydroscope/samples\"\ninterfaces = [\"{}\"]\n"
        "transport = \"{}\"\n",
        domain, own_address, o.transport);
  }
  text += "\n[signals]\n";
  struct Signal {
    const char *name, *unit, *limits;
    int ring;
    bool required;
  };
  for (const Signal& s :
       {Signal{"p_A", "Pa", "min = -20e5, max = 600e5", 0, true},
        Signal{"p_B", "Pa", "min = -20e5, max = 600e5", 2, false},
        Signal{"z", "m", "min = -1, max = 3", 6, true}, Signal{"y_v", "1", "min = -1.2, max = 1.2", 8, true},
        Signal{"U_v", "V", "min = -12, max = 12, stuck_time = 0", 10, false}})
    text += fmt::format("{} = {{ {}, unit = \"{}\", {}, required = {} }}\n", s.name,
                        o.modbus_ring ? fmt::format("modbus = {{ ring = {}, stride = 14 }}", s.ring)
                                      : fmt::format("dds = \"{{axis}}/{}\"", s.name),
                        s.unit, s.limits, s.required);
  return text +
         "p_0 = { modbus = { register = 32, type = \"float32\" }, unit = \"bar\", "
         "stuck_time = 0, required = false }\n"
         "T_oil = { modbus = { register = 30, type = \"float32\" }, unit = \"degC\", "
         "stuck_time = 0, required = false }\n\n"
         "[geometry]\nA_A = 0.0125\ndp_nom = { value = 35, unit = \"bar\" }\np_t = 0\n\n"
         "[gate]\nconditions = { y_v = { min = 0.04 }, \"ddt(z)\" = { max = -0.004, unit = \"m/s\" } }\n"
         "stroke_gap = 0.25\nmin_stroke = 0.3\n";
}

}  // namespace

void Sleep(double seconds) { std::this_thread::sleep_for(std::chrono::duration<double>(seconds)); }

double Now() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

Child::Child(const std::vector<std::string>& arguments, const std::string& log, int network,
             const std::string& program, const Environment& environment) {
  int ends[2];
  if (pipe2(ends, O_CLOEXEC) != 0) return;
  std::vector<char*> words = {const_cast<char*>("hydroscope")};
  for (const std::string& argument : arguments) words.push_back(const_cast<char*>(argument.c_str()));
  words.push_back(nullptr);
  const int out = open(log.c_str(), O_WRONLY | O_CREAT | O_APPEND | O_CLOEXEC, 0644);
  pid_ = fork();
  if (pid_ == 0) {
    prctl(PR_SET_PDEATHSIG, SIGKILL);
    if (network >= 0 && setns(network, CLONE_NEWNET) != 0) _exit(126);
    for (const auto& [name, value] : environment) setenv(name.c_str(), value.c_str(), 1);
    dup2(ends[0], STDIN_FILENO);
    dup2(out, STDOUT_FILENO);
    dup2(out, STDERR_FILENO);
    execv(program.c_str(), words.data());
    _exit(127);
  }
  close(ends[0]);
  close(out);
  input_ = ends[1];
}

Child::~Child() {
  if (Alive()) End(SIGKILL);
  if (input_ >= 0) close(input_);
}

void Child::Say(const std::string& line) const {
  const std::string text = line + "\n";
  static_cast<void>(!write(input_, text.data(), text.size()));
}

void Child::SetNice(int nice) const {
  if (pid_ > 0 && nice != 0) static_cast<void>(setpriority(PRIO_PROCESS, static_cast<id_t>(pid_), nice));
}

void Child::Signal(int signal) const {
  if (pid_ > 0) kill(pid_, signal);
}

int Child::End(int signal) {
  if (pid_ <= 0) return -1;
  kill(pid_, signal);
  int state = 0;
  waitpid(pid_, &state, 0);
  pid_ = -1;
  return WIFEXITED(state) ? WEXITSTATUS(state) : 128 + WTERMSIG(state);
}

bool Child::Alive() const {
  siginfo_t info{};
  return pid_ > 0 && waitid(P_PID, static_cast<id_t>(pid_), &info, WEXITED | WNOHANG | WNOWAIT) == 0 &&
         info.si_pid == 0;
}

LiveRig::LiveRig(const RigOptions& options) : options_(options), folder_(options.folder) {
  signal(SIGPIPE, SIG_IGN);
  if (folder_.empty()) {
    folder_ = (std::filesystem::temp_directory_path() / fmt::format("hydroscope-live-{}", getpid())).string();
    temporary_ = true;
    std::filesystem::remove_all(folder_);
  }
  std::filesystem::create_directories(folder_);
  const int own = static_cast<int>(getpid());
  domain_ = FreeDomain();
  port_ = 20'000 + own % 20'000;
  feeds_ = options.feeds;
  WriteMachines();
}

void LiveRig::WriteMachines() {
  std::ofstream(File("press.toml")) << MachineText(options_, domain_, port_, options_.press_address);
  std::ofstream(File("rival.toml")) << MachineText(options_, domain_, port_ + 1, options_.press_address);
  std::ofstream(File("service.toml"))
      << MachineText(options_, domain_, port_, options_.service_address) << feeds_;
}

void LiveRig::SetFeeds(const std::string& feeds) {
  feeds_ = feeds;
  WriteMachines();
}

void LiveRig::StartAgain(const std::string& transport, Child::Environment press, Child::Environment service) {
  this->service().End(SIGTERM);
  this->press().End(SIGTERM);
  options_.transport = transport;
  press_environment_ = std::move(press);
  service_environment_ = std::move(service);
  WriteMachines();
  StartPress();
  StartService();
}

void LiveRig::StartRival() {
  rival_ = std::make_unique<Child>(
      std::vector<std::string>{"simulate", "press", "--serve", File("rival.toml"), "--seed", "99",
                               "--sample-period", fmt::format("{:.9g}", 1 / options_.rate)},
      File("rival.log"), options_.press_network);
}

LiveRig::~LiveRig() {
  service_.reset();
  press_.reset();
  rival_.reset();
  if (temporary_) std::filesystem::remove_all(folder_);
}

void LiveRig::StartPress() {
  std::vector<std::string> arguments = {"simulate", "press", "--serve", File("press.toml")};
  for (const auto& [option, value] :
       {std::pair<std::string, std::string>{"--seed", std::to_string(options_.seed)},
        {"--sample-period", fmt::format("{:.9g}", 1 / options_.rate)},
        {"--adc-bits", std::to_string(options_.adc_bits)}}) {
    arguments.push_back(option);
    arguments.push_back(value);
  }
  if (options_.clock_drift != 0) {
    arguments.push_back("--clock-drift");
    arguments.push_back(fmt::format("{:g}", options_.clock_drift));
  }
  press_ = std::make_unique<Child>(arguments, File("press.log"), options_.press_network, "/proc/self/exe",
                                   press_environment_);
  press_->SetNice(options_.nice);  // a controller has a computer of its own
}

void LiveRig::StartService(std::vector<std::string> more) {
  std::vector<std::string> arguments = {"serve", File("service.toml"), "--db", database(), "--port",
                                        "0",     "--log-level",        "info"};
  arguments.insert(arguments.end(), more.begin(), more.end());
  service_ = std::make_unique<Child>(arguments, File("serve.log"), options_.service_network, "/proc/self/exe",
                                     service_environment_);
  service_->SetNice(options_.nice);
}

Status LiveRig::Begin(std::vector<std::string> more) {
  StartPress();
  StartService(std::move(more));
  const auto stored = [](const nlohmann::json& s) {
    return s.at("writer").at("strokes").get<std::int64_t>() > 0;
  };
  if (WaitFor(stored, 60)) return {};
  return InternalError("no stroke was stored within 60 s");
}

std::string LiveRig::LastWords() const {
  std::string words;
  for (const char* log : {"press.log", "serve.log"}) {
    std::ifstream file(File(log));
    std::string last;
    for (std::string line; std::getline(file, line);) last = line;
    words += fmt::format("\n{}: {}", log, last);
  }
  return words;
}

int LiveRig::nice() const { return getpriority(PRIO_PROCESS, static_cast<id_t>(service_->pid())); }

std::optional<nlohmann::json> LiveRig::Ask() const {
  const auto answer = AskService(SocketOf(database()), "GET", "/status");
  if (!answer) return std::nullopt;
  auto status = nlohmann::json::parse(*answer, nullptr, false);
  if (!status.is_object()) return std::nullopt;
  return status;
}

std::optional<double> LiveRig::WaitFor(const std::function<bool(const nlohmann::json&)>& condition,
                                       double limit) const {
  const double begin = Now();
  while (Now() - begin < limit) {
    const double asked = Now() - begin;
    if (const auto status = Ask(); status && condition(*status)) return asked;
    Sleep(kLook);
  }
  return std::nullopt;
}

}  // namespace hydroscope

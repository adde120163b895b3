#include <fmt/format.h>
#include <termios.h>
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <iostream>
#include <memory>
#include <nlohmann/json.hpp>

#include "cli/command_answer.h"
#include "cli/commands.h"
#include "cli/user_name.h"
#include "core/printable.h"
#include "core/time_text.h"
#include "host/output.h"
#include "host/real_clock.h"
#include "page/access/login_api.h"
#include "page/access/secrets.h"

namespace hydroscope {
namespace {

constexpr std::int64_t kAuditRowsShown = 1000;

struct UsersArguments {
  std::string database, name, role, json;
};

/// A line of stdin; at a terminal it is asked for, and what is typed does not show.
std::string AskSecret(const char* question) {
  termios before{};
  const bool terminal = isatty(STDIN_FILENO) != 0 && tcgetattr(STDIN_FILENO, &before) == 0;
  if (terminal) {
    termios silent = before;
    silent.c_lflag &= ~static_cast<tcflag_t>(ECHO);
    tcsetattr(STDIN_FILENO, TCSAFLUSH, &silent);
    std::cerr << question;
  }
  std::string line;
  std::getline(std::cin, line);
  if (terminal) {
    tcsetattr(STDIN_FILENO, TCSAFLUSH, &before);
    std::cerr << "\n";
  }
  return line;
}

Result<std::string> HashOfNewPassword() {
  const std::string password = AskSecret("Password: ");
  auto hash = HashOfPassword(password);
  if (hash && isatty(STDIN_FILENO) != 0 && AskSecret("Once more: ") != password)
    return BadInput("the two passwords differ; nothing was changed");
  return hash;
}

/// What was done here stands in the audit table too.
Status Tell(AccessStore& store, const std::string& what, const std::string& detail) {
  return store.Append({0, WallSeconds(), UserName(), "", "", what, detail, ""});
}

/// A new user, or another role or password of one who is there; his logins end.
Status PutUser(const UsersArguments& a, bool is_new) {
  if (!IsUserName(a.name))
    return UsageError("'{}' is no name of a user: expected up to 64 letters, digits and . _ - @",
                      Printable(a.name));
  auto store = TRY(is_new ? AccessStore::Open(a.database) : AccessStore::OpenExisting(a.database));
  const auto known = TRY(store.User(a.name));
  if (is_new && known) return BadInput("there is a user '{}' already; change it with `users change`", a.name);
  if (!is_new && !known) return BadInput("there is no user '{}'; make one with `users add`", a.name);
  StoredUser user = known.value_or(StoredUser{a.name, a.role, "", WallSeconds()});
  const bool asks = is_new || a.role.empty();
  if (!a.role.empty()) user.role = a.role;
  if (asks) {
    user.password = TRY(HashOfNewPassword());
  }
  const char* what = is_new ? "user added" : asks ? "password changed" : "role changed";
  TRY(Tell(store, what, fmt::format("{}, {}", user.name, user.role)));
  TRY(store.PutUser(user));
  Say(fmt::format("{}: {}, role {}\n", what, user.name, user.role));
  return {};
}

Status RemoveUser(const UsersArguments& a) {
  auto store = TRY(AccessStore::OpenExisting(a.database));
  const auto known = TRY(store.User(a.name));
  if (!known) return BadInput("there is no user '{}'", Printable(a.name));
  TRY(Tell(store, "user removed", a.name));
  TRY(store.RemoveUser(a.name));
  Say(fmt::format("user removed: {}\n", a.name));
  return {};
}

Status ListUsers(const UsersArguments& a) {
  const auto store = TRY(AccessStore::OpenExisting(a.database));
  const auto users = TRY(store.Users());
  std::string text;
  nlohmann::json list = nlohmann::json::array();
  for (const StoredUser& user : users) {
    text += fmt::format("{:24}{}\n", user.name, user.role);
    list.push_back({{"name", user.name}, {"role", user.role}, {"since_s", user.since}});
  }
  return Answer(text, {{"users", std::move(list)}}, a.json);
}

Status ShowAudit(const UsersArguments& a) {
  const auto store = TRY(AccessStore::OpenExisting(a.database));
  const auto rows = TRY(store.Audit(kAuditRowsShown));
  std::string text;
  nlohmann::json list = nlohmann::json::array();
  for (auto row = rows.rbegin(); row != rows.rend(); ++row) {
    text += fmt::format("{}  {} {} {} {} {}\n", LocalTimeText(row->wall), row->user.empty() ? "-" : row->user,
                        row->from.empty() ? "here" : row->from, row->what, Printable(row->detail),
                        Printable(row->outcome));
    list.push_back(AuditJson(*row));
  }
  return Answer(text, {{"audit", std::move(list)}}, a.json);
}

}  // namespace

void AddUsersCommand(CLI::App& app, int& exit_code) {
  auto arguments = std::make_shared<UsersArguments>();
  CLI::App* users =
      app.add_subcommand("users", "Who may log in to the page of `serve`, and what they changed");
  users->require_subcommand(1);
  users->add_option("--db,-d", arguments->database, "Trend database, beside which they are kept")->required();
  const auto add = [&](const char* name, const char* what, auto run) {
    CLI::App* command = users->add_subcommand(name, what);
    command->fallthrough();  // --db may stand behind it too
    RunsAs(*command, exit_code, [arguments, run] { return run(*arguments); });
    return command;
  };
  const auto takes_name = [&](CLI::App* command) {
    command->add_option("NAME", arguments->name, "Up to 64 letters, digits and . _ - @")->required();
    return command;
  };
  const auto takes_role = [&](CLI::App* command) {
    return command
        ->add_option("--role", arguments->role,
                     "view: look; operate: also act on alarms and work on models; admin: also promote them")
        ->check(CLI::IsMember({"view", "operate", "admin"}));
  };
  takes_role(takes_name(add("add", "A new user; the password is asked for, or the first line of stdin",
                            [](const UsersArguments& a) { return PutUser(a, true); })))
      ->required();
  takes_role(
      takes_name(add("change", "Another role, or without --role another password; logins of the user end",
                     [](const UsersArguments& a) { return PutUser(a, false); })));
  takes_name(add("remove", "Removes a user, whose logins end", RemoveUser));
  for (CLI::App* command : {add("list", "Users and their roles", ListUsers),
                            add("audit", "What was changed, when and by whom", ShowAudit)})
    AddJsonOption(*command, arguments->json);
  users->footer(
      "Examples:\n"
      "  hydroscope users --db press.db add anna --role admin\n"
      "  hydroscope users --db press.db change anna\n"
      "  hydroscope users --db press.db list\n"
      "  hydroscope users --db press.db audit");
}

}  // namespace hydroscope

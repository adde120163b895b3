#include "page/page_api.h"

#include <charconv>
#include <functional>
#include <optional>

#include "page/assets.h"
#include "page/json_reply.h"
#include "page/request_guard.h"

namespace hydroscope {
namespace {

HttpReply DoneReply(const Status& done) {
  return done ? JsonReply(nlohmann::json::object()) : FailureReply(done.error());
}

HttpReply JobReply(const Result<std::int64_t>& job) {
  return job ? JsonReply({{"job", *job}}, 202) : FailureReply(job.error());
}

std::string Query(const HttpRequest& request, const char* name) {
  const auto found = request.query.find(name);
  return found == request.query.end() ? "" : found->second;
}

/// The whole number under `name`, `otherwise` if absent, nothing if it is no such number.
std::optional<std::int64_t> NumberQuery(const HttpRequest& request, const char* name,
                                        std::int64_t otherwise) {
  const std::string text = Query(request, name);
  if (text.empty()) return otherwise;
  std::int64_t number = 0;
  const auto read = std::from_chars(text.data(), text.data() + text.size(), number);
  if (read.ec != std::errc() || read.ptr != text.data() + text.size() || number < 0 || number > 1'000'000'000)
    return std::nullopt;
  return number;
}

HttpReply FoundReply(const nlohmann::json& found) {
  return found.is_null() ? ErrorReply(404, "this is not worked out yet") : JsonReply(found);
}

HttpReply GetResult(WorkSession& session, const HttpRequest& request) {
  const auto version = NumberQuery(request, "version", 0);
  if (!version) return ErrorReply(400, "version: expected the number of a version");
  return FoundReply(
      session.Find(Query(request, "kind"), Query(request, "about"), static_cast<int>(*version)));
}

HttpReply GetStroke(WorkSession& session, const HttpRequest& request) {
  const auto stroke = NumberQuery(request, "stroke", 0), version = NumberQuery(request, "version", 0);
  if (!stroke || !version) return ErrorReply(400, "stroke, version: expected whole numbers from 0");
  return FoundReply(session.Stroke(*stroke, static_cast<int>(*version)));
}

HttpReply GetMachine(WorkSession& session, const HttpRequest&) {
  const std::string text = session.MachineText();
  if (text.empty()) return ErrorReply(404, "there is no machine file yet");
  return {200, "text/plain; charset=utf-8", text};
}

HttpReply PostWork(WorkSession& session, const HttpRequest& request) {
  const auto work = ParseWorkRequest(request.body);
  return work ? JobReply(session.Start(*work)) : FailureReply(work.error());
}

HttpReply PostProposal(WorkSession& session, const HttpRequest& request) {
  const auto mapping = ParseColumnMapping(request.body);
  if (!mapping) return FailureReply(mapping.error());
  const auto proposal = session.Propose(*mapping);
  return proposal ? JsonReply(*proposal) : FailureReply(proposal.error());
}

HttpReply PostExample(WorkSession& session, const HttpRequest& request) {
  const auto id = ParseText(request.body, "id");
  return id ? JobReply(session.StartExample(*id)) : FailureReply(id.error());
}

HttpReply PostHoldOut(WorkSession& session, const HttpRequest& request) {
  const auto log = ParseText(request.body, "log");
  return log ? DoneReply(session.HoldOut(*log)) : FailureReply(log.error());
}

HttpReply PostSave(WorkSession& session, const HttpRequest& request) {
  const auto name = ParseText(request.body, "name");
  if (!name) return FailureReply(name.error());
  const auto path = session.Save(*name);
  return path ? JsonReply({{"path", *path}}) : FailureReply(path.error());
}

HttpReply PostEffect(WorkSession& session, const HttpRequest& request) {
  const auto effect = ParseOwnEffect(request.body);
  return effect ? DoneReply(session.TakeEffect(*effect)) : FailureReply(effect.error());
}

struct Route {
  const char *method, *path;
  HttpReply (*answer)(WorkSession&, const HttpRequest&);
};
constexpr Route kRoutes[] = {
    {"GET", "/api/v1/effects", [](WorkSession& s, const HttpRequest&) { return JsonReply(s.Effects()); }},
    {"GET", "/api/v1/results", GetResult},
    {"GET", "/api/v1/strokes", GetStroke},
    {"GET", "/api/v1/machine", GetMachine},
    {"POST", "/api/v1/logs",
     [](WorkSession& s, const HttpRequest& r) { return DoneReply(s.TakeLog(Query(r, "name"), r.file)); }},
    {"POST", "/api/v1/machine",
     [](WorkSession& s, const HttpRequest& r) { return DoneReply(s.TakeMachine(Query(r, "name"), r.body)); }},
    {"POST", "/api/v1/example", PostExample},
    {"POST", "/api/v1/proposal", PostProposal},
    {"POST", "/api/v1/accept",
     [](WorkSession& s, const HttpRequest&) { return DoneReply(s.AcceptProposal()); }},
    {"POST", "/api/v1/effect", PostEffect},
    {"POST", "/api/v1/work", PostWork},
    {"POST", "/api/v1/save", PostSave},
    {"POST", "/api/v1/hold_out", PostHoldOut},
    {"POST", "/api/v1/start_over",
     [](WorkSession& s, const HttpRequest&) {
       s.StartOver();
       return JsonReply(nlohmann::json::object());
     }},
};

}  // namespace

HttpReply PageApi::Answer(const HttpRequest& request) {
  if (request.path.starts_with(kWatchPath))
    return watch_ != nullptr ? watch_->Answer(request)
                             : ErrorReply(404, "no database is watched here (open --db)");
  bool known = request.path == "/api/v1/session";
  if (known && request.method == "GET") return JsonReply(Session());
  for (const Route& route : kRoutes) {
    if (request.path != route.path) continue;
    known = true;
    if (request.method == route.method && session_ != nullptr) return route.answer(*session_, request);
  }
  if (known) return ErrorReply(405, request.method + " is not answered here");
  if (request.method == "GET" && !request.path.starts_with("/api/")) return Asset(request.path);
  return ErrorReply(404, "there is nothing at " + request.path);
}

/// Of the workbench, empty where there is none, and what else the page may show.
nlohmann::json PageApi::Session() const {
  nlohmann::json session = session_ != nullptr ? session_->Json()
                                               : nlohmann::json{{"machine", nullptr},
                                                                {"file", nullptr},
                                                                {"unsaved", false},
                                                                {"units", nlohmann::json::object()}};
  for (const char* list : {"logs", "versions", "results", "jobs", "examples"})
    if (!session.contains(list)) session[list] = nlohmann::json::array();
  session["workbench"] = session_ != nullptr;
  session["watched"] = watch_ != nullptr;
  session["changes"] = !token_.empty();
  return session;
}

std::string PageApi::BodyFile(const HttpRequest& request) {
  return request.method == "POST" && request.path == "/api/v1/logs" && session_ != nullptr
             ? session_->UploadFile()
             : "";
}

HttpReply PageApi::Asset(const std::string& path) const {
  for (const hydroscope::Asset& asset : Assets()) {
    if (asset.path != path) continue;
    HttpReply reply{200, std::string(asset.type), std::string(asset.bytes), asset.gzipped, path != "/"};
    if (const auto at = reply.body.find(kTokenPlaceholder); path == "/" && at != reply.body.npos)
      reply.body.replace(at, kTokenPlaceholder.size(), token_);
    return reply;
  }
  return ErrorReply(404, "there is nothing at " + path);
}

}  // namespace hydroscope

#include "page/page_api.h"

#include <algorithm>
#include <charconv>
#include <cstring>
#include <functional>
#include <optional>

#include "page/assets.h"
#include "page/http/json_arguments.h"
#include "page/http/json_reply.h"
#include "page/http/request_guard.h"
#include "page/work/region.h"

namespace hydroscope {
namespace {

HttpReply DoneReply(const Status& done) {
  return done ? JsonReply(nlohmann::json::object()) : FailureReply(done.error());
}

HttpReply JobReply(const Result<std::int64_t>& job) {
  return job ? JsonReply({{"job", *job}}, 202) : FailureReply(job.error());
}

/// The whole number under `name`, `otherwise` if absent, nothing if it is no such number.
std::optional<std::int64_t> NumberQuery(const HttpRequest& request, const char* name,
                                        std::int64_t otherwise) {
  const std::string text = request.Query(name);
  if (text.empty()) return otherwise;
  std::int64_t number = 0;
  const auto read = std::from_chars(text.data(), text.data() + text.size(), number);
  if (read.ec != std::errc() || read.ptr != text.data() + text.size() || number < 0 || number > 1'000'000'000)
    return std::nullopt;
  return number;
}

HttpReply FoundReply(const nlohmann::json& found) {
  return found.is_null()
             ? ErrorReply(404, Told("this is not worked out yet", "das ist noch nicht ausgerechnet"))
             : JsonReply(found);
}

HttpReply GetResult(WorkSession& session, const HttpRequest& request) {
  const auto version = NumberQuery(request, "version", 0);
  if (!version) return ErrorReply(400, "version: expected the number of a version");
  return FoundReply(session.Find(request.Query("kind"), request.Query("about"), static_cast<int>(*version)));
}

HttpReply GetStroke(WorkSession& session, const HttpRequest& request) {
  const auto stroke = NumberQuery(request, "stroke", 0), version = NumberQuery(request, "version", 0);
  if (!stroke || !version) return ErrorReply(400, "stroke, version: expected whole numbers from 0");
  return FoundReply(session.Stroke(*stroke, static_cast<int>(*version), request.Query("effect")));
}

HttpReply GetRegion(WorkSession& session, const HttpRequest& request) {
  const auto version = NumberQuery(request, "version", 0);
  if (!version) return ErrorReply(400, "version: expected the number of a version");
  const auto region = ParseRegion(request.Query("where"));
  if (!region) return FailureReply(region.error());
  const auto errors = session.ErrorsIn(*region, static_cast<int>(*version));
  return errors ? FoundReply(*errors) : FailureReply(errors.error());
}

HttpReply GetMachine(WorkSession& session, const HttpRequest&) {
  const std::string text = session.MachineText();
  if (text.empty())
    return ErrorReply(404, Told("there is no machine file yet", "es gibt noch keine Maschinendatei"));
  return {200, "text/plain; charset=utf-8", text};
}

HttpReply PostWork(WorkSession& session, const HttpRequest& request) {
  const auto work = ParseWorkRequest(request.body);
  return work ? JobReply(session.Start(*work)) : FailureReply(work.error());
}

HttpReply PostProposal(WorkSession& session, const HttpRequest& request) {
  const auto mapping = ParseColumnMapping(request.body);
  if (!mapping) return FailureReply(mapping.error());
  const auto proposal = session.Propose(*mapping, ParseObject(request.body).value_or(nullptr));
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
  if (!effect) return FailureReply(effect.error());
  auto course = session.TakeEffect(*effect);
  return course ? JsonReply({{"course", std::move(*course)}}) : FailureReply(course.error());
}

HttpReply PostMeasured(WorkSession& session, const HttpRequest& request) {
  const auto measured = ParseMeasuredEffect(request.body);
  return measured ? DoneReply(session.TakeMeasured(*measured)) : FailureReply(measured.error());
}

HttpReply PostStrokes(WorkSession& session, const HttpRequest& request) {
  const auto stretch = ParseStrokeStretch(request.body);
  return stretch ? DoneReply(session.TakeStrokes(*stretch)) : FailureReply(stretch.error());
}

HttpReply PostPromote(WorkSession& session, const HttpRequest& request) {
  const auto json = ParseObject(request.body);
  if (!json) return FailureReply(json.error());
  const auto comment = TextOf(*json, "comment", kLongestComment);
  return comment ? JobReply(session.StartPromotion(*comment, request.who.name))
                 : FailureReply(comment.error());
}

struct WorkRoute : ApiRoute {
  HttpReply (*answer)(WorkSession&, const HttpRequest&);
};
constexpr UserRole kLook = UserRole::kView, kWork = UserRole::kOperate;
constexpr WorkRoute kWorkRoutes[] = {
    {{"GET", "effects", kLook}, [](WorkSession& s, const HttpRequest&) { return JsonReply(s.Effects()); }},
    {{"GET", "results", kLook}, GetResult},
    {{"GET", "strokes", kLook}, GetStroke},
    {{"GET", "region", kLook}, GetRegion},
    {{"GET", "machine", kLook}, GetMachine},
    {{"POST", "logs", kWork},
     [](WorkSession& s, const HttpRequest& r) { return DoneReply(s.TakeLog(r.Query("name"), r.file)); }},
    {{"POST", "machine", kWork},
     [](WorkSession& s, const HttpRequest& r) { return DoneReply(s.TakeMachine(r.Query("name"), r.body)); }},
    {{"POST", "example", kWork}, PostExample},
    {{"POST", "proposal", kWork}, PostProposal},
    {{"POST", "accept", kWork},
     [](WorkSession& s, const HttpRequest&) { return DoneReply(s.AcceptProposal()); }},
    {{"POST", "reopen", kWork},
     [](WorkSession& s, const HttpRequest&) { return DoneReply(s.ReopenProposal()); }},
    {{"POST", "effect", kWork}, PostEffect},
    {{"POST", "measured", kWork}, PostMeasured},
    {{"POST", "work", kWork}, PostWork},
    {{"POST", "save", UserRole::kAdmin}, PostSave},
    {{"POST", "strokes", kWork}, PostStrokes},
    {{"POST", "promote", UserRole::kAdmin, true}, PostPromote},
    {{"POST", "hold_out", kWork}, PostHoldOut},
    {{"POST", "start_over", kWork},
     [](WorkSession& s, const HttpRequest&) {
       s.StartOver();
       return JsonReply(nlohmann::json::object());
     }},
};
bool IsAsset(const std::string& path) {
  const auto assets = Assets();
  return std::any_of(assets.begin(), assets.end(), [&](const Asset& asset) { return asset.path == path; });
}

constexpr ApiRoute kPageRoutes[] = {{"GET", "session", UserRole::kNobody}, {"GET", "events"}};

}  // namespace

std::vector<ApiRoute> ApiRoutes() {
  std::vector<ApiRoute> routes(std::begin(kPageRoutes), std::end(kPageRoutes));
  routes.insert(routes.end(), std::begin(kLoginRoutes), std::end(kLoginRoutes));
  routes.insert(routes.end(), std::begin(kWorkRoutes), std::end(kWorkRoutes));
  const std::vector<ApiRoute> watch = WatchApi::Routes();
  routes.insert(routes.end(), watch.begin(), watch.end());
  return routes;
}

const ApiRoute* FindRoute(const std::string& method, const std::string& path) {
  static const std::vector<ApiRoute> kRoutes = ApiRoutes();
  for (const ApiRoute& route : kRoutes)
    if (method == route.method && path == std::string(kApi) + route.path) return &route;
  return nullptr;
}

UserRole RoleNeeded(const std::string& method, const std::string& path) {
  if (const ApiRoute* route = FindRoute(method, path)) return route->role;
  if (method == "POST") return UserRole::kAdmin;
  return IsAsset(path) ? UserRole::kNobody : UserRole::kView;
}

HttpReply PageApi::Answer(const HttpRequest& request) {
  if (!request.path.starts_with(kApi)) return Asset(request.path);
  const std::string what = request.path.substr(std::strlen(kApi));
  const ApiRoute* route = FindRoute(request.method, request.path);
  if (route == nullptr) {
    const bool known =
        FindRoute("GET", request.path) != nullptr || FindRoute("POST", request.path) != nullptr;
    return known ? ErrorReply(405, request.method + " is not answered here")
                 : ErrorReply(404, "there is nothing at " + request.path);
  }
  if (what == "session") return JsonReply(Session(request.who));
  for (const ApiRoute& login : kLoginRoutes)
    if (what == login.path)
      return login_ != nullptr ? login_->Answer(request) : ErrorReply(404, "nobody has to log in here");
  if (what.starts_with(kWatchPath))
    return watch_ != nullptr ? watch_->Answer(request)
                             : ErrorReply(404, Told("no database is watched here (open --db)",
                                                    "hier wird keine Datenbank beobachtet (open --db)"));
  if (what == "save" && login_ != nullptr)
    return ErrorReply(
        403,
        Told(
            "a service keeps no files for others: download the machine file, or promote the model",
            "ein Dienst bewahrt keine Dateien für andere auf: die Maschinendatei herunterladen oder das Modell "
            "übernehmen"));
  for (const WorkRoute& work : kWorkRoutes)
    if (session_ != nullptr && what == work.path && request.method == work.method)
      return work.answer(*session_, request);
  return ErrorReply(404, Told("there is no workbench here", "hier gibt es keine Werkbank"));
}

/// Of the workbench, empty where there is none, and what else the page may show.
nlohmann::json PageApi::Session(const Who& who) const {
  nlohmann::json shown = UserJson(who);
  const nlohmann::json login = login_ != nullptr ? login_->Json() : nlohmann::json();
  if (shown.is_null() && login.is_object() && login["to_read"]) return {{"user", nullptr}, {"login", login}};
  nlohmann::json session = session_ != nullptr ? session_->Json()
                                               : nlohmann::json{{"machine", nullptr},
                                                                {"file", nullptr},
                                                                {"unsaved", false},
                                                                {"strokes", nullptr},
                                                                {"units", nlohmann::json::object()}};
  for (const char* list : {"logs", "versions", "results", "jobs", "examples"})
    if (!session.contains(list)) session[list] = nlohmann::json::array();
  session["workbench"] = session_ != nullptr;
  session["watched"] = watch_ != nullptr;
  session["changes"] = who.role >= UserRole::kOperate;
  session["user"] = std::move(shown);
  session["login"] = login;
  return session;
}

bool PageApi::IsUpload(const HttpRequest& request) const {
  return request.method == "POST" && request.path == "/api/v1/logs" && session_ != nullptr;
}

std::optional<HttpReply> PageApi::Refuse(const HttpRequest& request) const {
  if (!IsUpload(request)) return std::nullopt;
  if (request.length < 0)
    return ErrorReply(411, Told("the header Content-Length is missing: it says whether there is room",
                                "der Header Content-Length fehlt: er sagt, ob Platz ist"));
  const Status room = session_->MayUpload(request.length);
  return room ? std::nullopt : std::optional(ErrorReply(413, ToldOf(room.error())));
}

std::string PageApi::BodyFile(const HttpRequest& request) {
  return IsUpload(request) ? session_->UploadFile() : "";
}

HttpReply PageApi::Asset(const std::string& path) {
  for (const hydroscope::Asset& asset : Assets())
    if (asset.path == path)
      return {200, std::string(asset.type), std::string(asset.bytes), asset.gzipped, path != "/"};
  return ErrorReply(404, "there is nothing at " + path);
}

}  // namespace hydroscope

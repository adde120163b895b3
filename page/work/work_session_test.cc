#include "page/work/work_session.h"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <chrono>
#include <filesystem>
#include <fstream>
#include <thread>

#include "page/first_run/log_picture.h"
#include "page/page_api.h"
#include "simulator/die_cushion/log_format.h"
#include "simulator/die_cushion/press.h"

namespace hydroscope {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

/// A press with a leak, 40 s.
Status WriteLeakingPress(const std::string& path) {
  PressOptions options;
  options.seconds = 40;
  options.effects = {{"internal_leakage", 4e-12, {}}};
  PressGenerator generator(options);
  std::string text(kPressLogHeader);
  for (PressRow row; generator.Next(row);) AppendPressLine(row, text);
  std::ofstream(path) << text;
  return {};
}

/// The API over a session, without a socket.
class PageSession : public testing::Test {
 protected:
  void SetUp() override {
    auto session = WorkSession::Create(
        {}, "", {{"leak", WriteLeakingPress}, {"known", WriteLeakingPress, {{"A_A", 0.0125}}}}, feed_);
    ASSERT_TRUE(session) << session.error().text;
    session_ = std::move(*session);
    api_ = std::make_unique<PageApi>(session_.get(), nullptr, nullptr);
  }
  HttpReply Get(const std::string& path, std::map<std::string, std::string> query = {}) {
    HttpRequest request;
    request.method = "GET";
    request.path = path;
    request.query = std::move(query);
    return api_->Answer(request);
  }
  HttpReply Post(const std::string& path, const std::string& body) {
    HttpRequest request;
    request.method = "POST";
    request.path = path;
    request.body = body;
    return api_->Answer(request);
  }
  /// Of a log, to be written to its file.
  HttpRequest Upload(const char* name) {
    HttpRequest request;
    request.method = "POST";
    request.path = "/api/v1/logs";
    request.query["name"] = name;
    request.file = api_->BodyFile(request);
    return request;
  }
  static nlohmann::json Json(const HttpReply& reply) {
    return nlohmann::json::parse(reply.body, nullptr, false);
  }
  nlohmann::json Session() { return Json(Get("/api/v1/session")); }

  /// Starts work and waits for its end; the job.
  nlohmann::json Work(const std::string& body, const std::string& path = "/api/v1/work") {
    const nlohmann::json started = Json(Post(path, body));
    if (!started.contains("job")) return started;
    for (int tries = 0; tries < 6000; ++tries) {
      const nlohmann::json session = Session();
      for (const nlohmann::json& job : session["jobs"])
        if (job["job"] == started["job"] && (job["state"] == "done" || job["state"] == "failed")) return job;
      std::this_thread::sleep_for(std::chrono::milliseconds(10));
    }
    return nullptr;
  }
  /// The example on the page, mapped and accepted.
  void MapExample() {
    ASSERT_EQ(Work(R"({"id": "leak"})", "/api/v1/example")["state"], "done");
    ASSERT_EQ(Post("/api/v1/proposal", R"({"geometry": {"A_A": 0.0125}})").status, 200u);
    ASSERT_EQ(Post("/api/v1/accept", "{}").status, 200u);
  }

  EventFeed feed_;
  std::unique_ptr<WorkSession> session_;
  std::unique_ptr<PageApi> api_;
};

TEST_F(PageSession, AnExampleTellsTheSizesThatNobodyElseKnows) {
  ASSERT_EQ(Work(R"({"id": "known"})", "/api/v1/example")["state"], "done");
  const nlohmann::json mapping = Json(Get("/api/v1/session"))["mapping"];
  EXPECT_EQ(mapping["geometry"]["A_A"], 0.0125);
  EXPECT_TRUE(Json(Post("/api/v1/proposal", mapping.dump()))["problem"].is_null());
}

TEST_F(PageSession, AsksForTheAreaBeforeItTakesAProposal) {
  ASSERT_EQ(Work(R"({"id": "leak"})", "/api/v1/example")["state"], "done");
  const nlohmann::json proposal = Json(Post("/api/v1/proposal", "{}"));
  EXPECT_EQ(proposal["title"], "die cushion");
  EXPECT_FALSE(proposal["problem"].is_null());
  EXPECT_EQ(Post("/api/v1/accept", "{}").status, 400u);
  EXPECT_TRUE(Json(Post("/api/v1/proposal", R"({"geometry": {"A_A": 0.0125}})"))["problem"].is_null());
}

TEST_F(PageSession, LeadsBackFromTheMachineFileToTheProposalItCameOf) {
  MapExample();
  nlohmann::json session = Session();
  EXPECT_TRUE(session["mapped"]);
  EXPECT_FALSE(session["machine"].is_null());
  EXPECT_EQ(Post("/api/v1/reopen", "{}").status, 200u);
  session = Session();
  EXPECT_TRUE(session["machine"].is_null());
  EXPECT_EQ(session["mapping"]["geometry"]["A_A"], 0.0125) << "what was said is not to be said again";
  EXPECT_EQ(session["logs"].size(), 1u);
  EXPECT_EQ(Post("/api/v1/reopen", "{}").status, 400u);
}

TEST_F(PageSession, PutsColumnsWhereAPersonPutsThem) {
  ASSERT_EQ(Work(R"({"id": "leak"})", "/api/v1/example")["state"], "done");
  const nlohmann::json proposal = Json(Post(
      "/api/v1/proposal",
      R"({"columns": [{"column": "t", "signal": "time"}, {"column": "p_B", "signal": "p_A"}, {"column": "z", "signal": "z"},
          {"column": "y_v", "signal": "y_v"}], "geometry": {"A_A": 0.0125}})"));
  std::map<std::string, nlohmann::json> columns;
  for (const nlohmann::json& pin : proposal["pins"]) columns[pin["signal"]] = pin["column"];
  EXPECT_EQ(columns["p_A"], "p_B");
  EXPECT_TRUE(columns["p_B"].is_null());
}

TEST_F(PageSession, TakesTheKindOfMachineThatAPersonChooses) {
  ASSERT_EQ(Work(R"({"id": "leak"})", "/api/v1/example")["state"], "done");
  const nlohmann::json pump = Json(Post(
      "/api/v1/proposal", R"({"model": "pump", "columns": [{"column": "p_A", "signal": "outlet_pressure"}],
          "geometry": {"X_p": 0.012}})"));
  EXPECT_EQ(pump["german"]["title"], "druckgeregelte Pumpe");
  std::map<std::string, nlohmann::json> columns;
  for (const nlohmann::json& pin : pump["pins"]) columns[pin["signal"]] = pin["column"];
  EXPECT_EQ(columns["outlet_pressure"], "p_A");
  EXPECT_TRUE(columns["shaft_speed"].is_null());
  for (const nlohmann::json& size : pump["geometry"])
    if (size["name"] == "X_p") {
      EXPECT_EQ(size["value"], 0.012);
    }
  EXPECT_FALSE(pump["problem"].is_null());
  EXPECT_EQ(Post("/api/v1/accept", "{}").status, 400u);
}

TEST_F(PageSession, TellsFailuresInGermanToo) {
  const nlohmann::json none = Json(Post("/api/v1/proposal", "{}"));
  EXPECT_EQ(none["error"], "there is no log yet");
  EXPECT_EQ(none["german"]["error"], "es gibt noch kein Log");
  const nlohmann::json odd = Json(Post("/api/v1/work", R"({"kind": "dance"})"));
  EXPECT_TRUE(odd["german"].is_null()) << "what only programs see is told in English alone";
}

TEST_F(PageSession, TakesABalanceThatAPersonWrites) {
  ASSERT_EQ(Work(R"({"id": "leak"})", "/api/v1/example")["state"], "done");
  const auto propose = [&](const char* expression) {
    return Json(
        Post("/api/v1/proposal", fmt::format(R"({{"model": "expressions", "balance": {{"output": "p_A",
                                 "terms": [{{"name": "k", "expression": "{}"}}]}}}})",
                                             expression)));
  };
  const nlohmann::json told = propose("p_B + q")["problem"];
  const std::string problem = told["error"];
  EXPECT_THAT(std::string(told["german"]["error"]), HasSubstr("unbekanntes Signal \"q\""));
  EXPECT_THAT(problem, HasSubstr("unknown signal \"q\""));
  EXPECT_EQ(problem.front(), '[') << "without the place in a file that nobody looks at: " << problem;
  const nlohmann::json fine = propose("p_B");
  EXPECT_TRUE(fine["problem"].is_null()) << fine["problem"];
  EXPECT_EQ(fine["balance"]["terms"][0]["expression"], "p_B");
  EXPECT_EQ(Post("/api/v1/accept", "{}").status, 200u);
}

TEST_F(PageSession, AddsWhatIsMissingAndLosesNoVersion) {
  MapExample();
  ASSERT_EQ(Work(R"({"kind": "compare"})")["state"], "done");
  ASSERT_EQ(Work(R"({"kind": "explain"})")["state"], "done");
  const nlohmann::json explained = Json(Get("/api/v1/results", {{"kind", "explain"}}));
  EXPECT_THAT(explained["set"], ElementsAre("internal_leakage"));
  ASSERT_EQ(Work(R"({"kind": "preview", "effect": "internal_leakage"})")["state"], "done");
  const nlohmann::json preview =
      Json(Get("/api/v1/results", {{"kind", "preview"}, {"about", "internal_leakage"}}));
  EXPECT_LT(preview["error"]["after"], preview["error"]["before"]);
  EXPECT_EQ(Session()["versions"].size(), 1u) << "a preview changes nothing";
  ASSERT_EQ(Work(R"({"kind": "add", "effect": "internal_leakage"})")["state"], "done");
  ASSERT_EQ(Session()["versions"].size(), 2u);
  EXPECT_EQ(Session()["versions"][1]["rms_holdout"], preview["error"]["after"]);

  ASSERT_EQ(Work(R"({"kind": "restore", "version": 1})")["state"], "done");
  ASSERT_EQ(Work(R"({"kind": "add", "effect": "external_leakage"})")["state"], "done");
  const nlohmann::json versions = Session()["versions"];
  ASSERT_EQ(versions.size(), 3u) << "the version gone back from is still there";
  EXPECT_EQ(versions[1]["parent"], 1);
  EXPECT_EQ(versions[2]["parent"], 1) << "a branch";
  ASSERT_EQ(Work(R"({"kind": "restore", "version": 2})")["state"], "done");
  EXPECT_EQ(Session()["machine"]["effects"], nlohmann::json({"internal_leakage"}));
}

TEST_F(PageSession, DrawsStrokesMeasuredAndModelled) {
  MapExample();
  EXPECT_EQ(Get("/api/v1/strokes", {{"stroke", "0"}}).status, 404u);
  ASSERT_EQ(Work(R"({"kind": "compare"})")["state"], "done");
  const nlohmann::json stroke = Json(Get("/api/v1/strokes", {{"stroke", "0"}}));
  EXPECT_GT(stroke["measured"].size(), 20u);
  EXPECT_EQ(stroke["measured"].size(), stroke["modelled"].size());
  EXPECT_EQ(stroke["unit"], "l/min");
  EXPECT_FALSE(stroke["free_run"].is_null());
  ASSERT_EQ(Work(R"({"kind": "picture"})")["state"], "done");
  const nlohmann::json picture = Json(Get("/api/v1/results", {{"kind", "picture"}}));
  EXPECT_LE(picture["signals"][0]["low"].size(), kPicturePoints);
  EXPECT_EQ(picture["strokes"].size(), Json(Get("/api/v1/results", {{"kind", "compare"}}))["strokes"]);
}

TEST_F(PageSession, SaysWhyWorkFailed) {
  const nlohmann::json job = Work(R"({"kind": "compare"})");
  EXPECT_EQ(job["state"], "failed");
  EXPECT_THAT(job["error"].get<std::string>(), HasSubstr("no log"));
}

TEST_F(PageSession, KeepsUploadsAsLongAsTheyAreWorkedOn) {
  HttpRequest request = Upload("press.csv");
  const std::filesystem::path folder = std::filesystem::path(request.file).parent_path();
  ASSERT_TRUE(WriteLeakingPress(request.file));
  ASSERT_EQ(api_->Answer(request).status, 200u);
  EXPECT_FALSE(std::filesystem::is_empty(folder));
  EXPECT_EQ(Post("/api/v1/proposal", "{}").status, 200u);
  EXPECT_EQ(Post("/api/v1/start_over", "{}").status, 200u);
  EXPECT_TRUE(std::filesystem::is_empty(folder));
}

TEST_F(PageSession, RefusesUploadsThatAreNoLog) {
  HttpRequest request = Upload("../../odd.csv");
  std::ofstream(request.file) << "nothing\n";
  const HttpReply reply = api_->Answer(request);
  EXPECT_EQ(reply.status, 400u);
  EXPECT_TRUE(std::filesystem::is_empty(std::filesystem::path(request.file).parent_path()));
  EXPECT_THAT(reply.body, HasSubstr("odd.csv"));
  EXPECT_EQ(reply.body.find("hydroscope_page_"), reply.body.npos) << "folders are nobody's business";
  EXPECT_TRUE(Session()["logs"].empty());
}

TEST_F(PageSession, RefusesMachineFilesThatAreNone) {
  EXPECT_EQ(Post("/api/v1/machine", "[machine").status, 400u);
  EXPECT_TRUE(Session()["machine"].is_null());
}

TEST_F(PageSession, SavesUnderPlainNamesOnly) {
  MapExample();
  EXPECT_EQ(Post("/api/v1/save", R"({"name": "../../x"})").status, 400u);
  EXPECT_EQ(Post("/api/v1/save", R"({"name": ""})").status, 400u);
}

TEST_F(PageSession, AnswersNothingElse) {
  for (const char* path :
       {"/api/v1/nothing", "/api/v2/session", "/../etc/passwd", "/assets/../../etc/passwd", "//etc/passwd"})
    EXPECT_EQ(Get(path).status, 404u) << path;
  EXPECT_EQ(Post("/api/v1/session", "{}").status, 405u);
  EXPECT_EQ(Get("/api/v1/strokes", {{"stroke", "-1"}}).status, 400u);
  EXPECT_EQ(Get("/api/v1/strokes", {{"stroke", "1x"}}).status, 400u);
  EXPECT_EQ(Get("/api/v1/results", {{"kind", "compare"}, {"version", "99999999999999999999"}}).status, 400u);
}

TEST_F(PageSession, CarriesTheSchemaInEveryAnswer) {
  for (const char* path : {"/api/v1/session", "/api/v1/effects", "/api/v1/nothing"})
    EXPECT_TRUE(Json(Get(path)).contains("schema")) << path;
}

}  // namespace
}  // namespace hydroscope

#include "page/access/gate.h"

#include <gtest/gtest.h>

#include <filesystem>

#include "core/expect_ok_fixture.h"
#include "page/access/secrets.h"
#include "page/api_route.h"

namespace hydroscope {
namespace {

constexpr const char* kPassword = "a long password";

/// A database's users, and a clock that the test moves.
class PageGate : public testing::Test {
 protected:
  void SetUp() override {
    database =
        testing::TempDir() + "gate_" + testing::UnitTest::GetInstance()->current_test_info()->name() + ".db";
    std::filesystem::remove(AccessStore::PathFor(database));
    const std::string hash = HashOfPassword(kPassword).value();
    auto store = AccessStore::Open(database);
    ASSERT_TRUE(store) << store.error().text;
    for (const char* role : {"view", "operate", "admin"}) EXPECT_OK(store->PutUser({role, role, hash, 0}));
  }
  HttpRequest Asking(const char* method, const std::string& path, const Logins::Begun& login = {}) const {
    HttpRequest request;
    request.method = method;
    request.path = kApi + path;
    request.token = login.who.token;
    if (!login.cookie.empty()) request.cookies["page"] = login.cookie;
    return request;
  }
  unsigned StatusOf(Gate& gate, HttpRequest request) const {
    const auto refusal = gate.Refuse(request);
    return refusal ? refusal->status : 200;
  }
  Logins::Begun In(const std::string& name) { return logins.Begin(name, kPassword, "::1").value(); }

  HostTime now{1'000'000'000, 1'700'000'000'000'000'000};
  std::string database;
  Logins logins{
      testing::TempDir() + "gate_" + testing::UnitTest::GetInstance()->current_test_info()->name() + ".db",
      [this] { return now; }};
};

TEST_F(PageGate, AtHomeEverybodyLooksAndNobodyChangesWithoutALogin) {
  Gate gate(logins, true, "page");
  EXPECT_EQ(StatusOf(gate, Asking("GET", "watch/overview")), 200u);
  EXPECT_EQ(StatusOf(gate, Asking("GET", "audit")), 401u);
  EXPECT_EQ(StatusOf(gate, Asking("POST", "watch/alarms")), 401u);
  EXPECT_EQ(StatusOf(gate, Asking("POST", "login")), 200u);
}

TEST_F(PageGate, ElsewhereNobodyLooksWithoutALogin) {
  Gate gate(logins, false, "page");
  for (const ApiRoute& route : ApiRoutes()) {
    const bool open = route.role == UserRole::kNobody;
    EXPECT_EQ(StatusOf(gate, Asking(route.method, route.path)), open ? 200u : 401u) << route.path;
  }
  EXPECT_EQ(StatusOf(gate, Asking("GET", "events")), 401u);
  EXPECT_EQ(StatusOf(gate, Asking("GET", "no_route")), 401u);
  HttpRequest metrics;
  metrics.method = "GET";
  metrics.path = "/metrics";
  EXPECT_EQ(StatusOf(gate, metrics), 401u);
  EXPECT_EQ(StatusOf(gate, Asking("GET", "watch/overview", In("view"))), 200u);
}

TEST_F(PageGate, EachMayWhatItsRoleMay) {
  Gate gate(logins, true, "page");
  const auto view = In("view"), operate = In("operate"), admin = In("admin");
  EXPECT_EQ(StatusOf(gate, Asking("POST", "watch/alarms", view)), 403u);
  EXPECT_EQ(StatusOf(gate, Asking("POST", "watch/alarms", operate)), 200u);
  EXPECT_EQ(StatusOf(gate, Asking("POST", "watch/alarms", admin)), 200u);
  EXPECT_EQ(StatusOf(gate, Asking("GET", "audit", operate)), 403u);
  EXPECT_EQ(StatusOf(gate, Asking("GET", "audit", admin)), 200u);
  EXPECT_EQ(StatusOf(gate, Asking("POST", "no_route", operate)), 403u);
}

TEST_F(PageGate, AChangeNeedsTheTokenOfTheSameLogin) {
  Gate gate(logins, true, "page");
  const auto one = In("operate"), other = In("operate");
  HttpRequest request = Asking("POST", "watch/alarms", one);
  for (const std::string& token : {std::string(), other.who.token, std::string(64, '0')}) {
    request.token = token;
    EXPECT_EQ(StatusOf(gate, request), 403u) << token;
  }
}

TEST_F(PageGate, ACookieThatNobodyWasGivenIsNobody) {
  Gate gate(logins, true, "page");
  HttpRequest request = Asking("POST", "watch/alarms", In("admin"));
  for (const std::string& cookie :
       {std::string(), std::string(64, '0'), HashOfToken(request.cookies["page"])}) {
    request.cookies["page"] = cookie;
    EXPECT_EQ(StatusOf(gate, request), 401u) << cookie;
  }
}

TEST_F(PageGate, ALoginEndsWhenItIsIdleOrOldOrEnded) {
  const auto idle = In("view"), used = In("view"), ended = In("view");
  EXPECT_OK(logins.End(ended.cookie));
  EXPECT_EQ(logins.Find(ended.cookie).role, UserRole::kNobody);
  for (double at = 0; at < Logins::kLife - 1800; at += 1800) {
    now.wall_ns += 1'800'000'000'000;
    EXPECT_EQ(logins.Find(used.cookie).role, UserRole::kView) << at;
  }
  EXPECT_EQ(logins.Find(idle.cookie).role, UserRole::kNobody);
  now.wall_ns += 1'801'000'000'000;
  EXPECT_EQ(logins.Find(used.cookie).role, UserRole::kNobody) << "a shift is over";
}

TEST_F(PageGate, ALoginSurvivesARestartAndEndsWithItsUser) {
  const auto login = In("operate");
  Logins again(database, [this] { return now; });
  EXPECT_EQ(again.Find(login.cookie).name, "operate");
  EXPECT_EQ(again.Find(login.cookie).token, login.who.token);
  EXPECT_OK(AccessStore::Open(database)->RemoveUser("operate"));
  EXPECT_EQ(again.Find(login.cookie).role, UserRole::kNobody);
}

TEST_F(PageGate, WrongPasswordsAreRefusedRecordedAndThenWaitedFor) {
  for (int k = 0; k < 5; ++k) EXPECT_EQ(logins.Begin("admin", "a wrong password", "::1")->cookie, "");
  EXPECT_GT(logins.Begin("admin", kPassword, "::1")->wait, 0);
  EXPECT_NE(logins.Begin("admin", kPassword, "::2")->cookie, "");
  EXPECT_EQ(logins.Begin("nobody", kPassword, "::2")->cookie, "");
  const auto rows = logins.Audit(100);
  ASSERT_EQ(rows->size(), 7u);
  EXPECT_EQ(rows->back().outcome, "refused");
  EXPECT_EQ((*rows)[1].outcome, "");
}

TEST_F(PageGate, ThePageOfOnePersonIsHisAndNeedsItsToken) {
  Gate gate("anna");
  HttpRequest request = Asking("POST", "save");
  EXPECT_EQ(StatusOf(gate, request), 403u);
  EXPECT_EQ(StatusOf(gate, Asking("GET", "session")), 200u);
  request.token = gate.WhoAsks(request).token;
  EXPECT_EQ(StatusOf(gate, request), 200u);
  EXPECT_EQ(gate.WhoAsks(request).name, "anna");
}

TEST(Secrets, APasswordIsKnownByItsHashAlone) {
  const auto hash = HashOfPassword(kPassword);
  ASSERT_TRUE(hash) << hash.error().text;
  EXPECT_TRUE(hash->starts_with("$argon2id$v=19$m=65536,t=2,p=1$")) << *hash;
  EXPECT_TRUE(IsPassword(*hash, kPassword));
  EXPECT_FALSE(IsPassword(*hash, "a long passwore"));
  EXPECT_FALSE(IsPassword("", kPassword));
  EXPECT_NE(*hash, HashOfPassword(kPassword).value()) << "each has a salt of its own";
  EXPECT_FALSE(HashOfPassword("short"));
  EXPECT_FALSE(HashOfPassword(std::string(1025, 'x')));
}

TEST(Secrets, AreDrawnAnewAndComparedWhole) {
  EXPECT_EQ(RandomToken().size(), 64u);
  EXPECT_NE(RandomToken(), RandomToken());
  EXPECT_TRUE(SameSecret("secret", "secret"));
  EXPECT_FALSE(SameSecret("", ""));
  for (const char* token : {"", "secre", "secret ", "Secret", "secret2"})
    EXPECT_FALSE(SameSecret(token, "secret"));
}

TEST(UserName, IsOfPlainCharacters) {
  for (const char* name : {"anna", "a.b-c_d@plant", "7"}) EXPECT_TRUE(IsUserName(name)) << name;
  for (const char* name : {"", "a b", "a\n", "<b>", "\xc3\xa4"}) EXPECT_FALSE(IsUserName(name)) << name;
  EXPECT_FALSE(IsUserName(std::string(65, 'a')));
}

}  // namespace
}  // namespace hydroscope

#include "page/page_server.h"

#include <fmt/format.h>

#include "host/real_clock.h"
#include "page/access/gate.h"
#include "page/access/login_api.h"
#include "page/assets.h"
#include "page/http/json_reply.h"
#include "page/http/request_guard.h"
#include "page/page_api.h"

namespace hydroscope {

struct PageServer::Impl {
  EventFeed feed;
  RequestGuard guard;
  std::unique_ptr<Logins> logins;  ///< of a service
  std::unique_ptr<Gate> gate;
  std::unique_ptr<LoginApi> login;
  std::unique_ptr<WorkSession> session;
  std::unique_ptr<WatchApi> watch;
  std::unique_ptr<PageApi> api;
  std::unique_ptr<HttpServer> http;
};

PageServer::PageServer() : impl_(std::make_unique<Impl>()) {}

PageServer::~PageServer() = default;

std::string PageServer::address() const { return fmt::format("http://127.0.0.1:{}/", impl_->http->port()); }

void PageServer::KeepAlive() { impl_->feed.KeepAlive(); }

Status PageServer::Listen(const HttpListen& listen, std::function<HttpReply(const HttpRequest&)> answer) {
  Impl& impl = *impl_;
  HttpServer::Hooks hooks;
  hooks.refuse = [&impl](HttpRequest& request) {
    auto refusal = impl.guard.Refuse(request);
    if (!refusal) refusal = impl.gate->Refuse(request);
    return refusal ? refusal : impl.api->Refuse(request);
  };
  hooks.body_file = [&impl](const HttpRequest& request) { return impl.api->BodyFile(request); };
  hooks.answer = std::move(answer);
  hooks.event_path = kEventPath;
  hooks.events = &impl.feed;
  hooks.may_listen_on = [&impl](HttpRequest request) { return !impl.gate->Refuse(request); };
  impl.http = TRY(HttpServer::Open(listen, std::move(hooks)));
  impl.guard.port = impl.http->port();
  return {};
}

/// What changes something for good stands in the audit table before it is done: nothing is changed in secret.
HttpReply PageServer::AnswerRecorded(const HttpRequest& request) {
  const ApiRoute* route = FindRoute(request.method, request.path);
  if (route == nullptr || !route->recorded || impl_->logins == nullptr) return impl_->api->Answer(request);
  const auto record = [&](const std::string& outcome) {
    return impl_->logins->Record(request.who, request.from, route->path, request.body, outcome);
  };
  if (const Status told = record(""); !told)
    return ErrorReply(
        507, Tell("nothing was changed, for it cannot be recorded: {}",
                  "nichts wurde geändert, denn es kann nicht festgehalten werden: {}", ToldOf(told.error())));
  HttpReply reply = impl_->api->Answer(request);
  if (reply.status >= 400) (void)record(reply.body);  // that it was asked stands there
  return reply;
}

Result<std::unique_ptr<PageServer>> PageServer::Open(const PageOptions& options) {
  if (Assets().empty())
    return BadInput(
        "this program was built without the page: npm or its packages were missing. Run scripts/setup.sh and build "
        "again "
        "(scripts/build.sh)");
  std::unique_ptr<PageServer> page(new PageServer);
  Impl& impl = *page->impl_;
  impl.gate = std::make_unique<Gate>(options.watch.user);
  const int niceness = options.watch.database.empty() ? 0 : JobQueue::kBesideAService;
  impl.session =
      TRY(WorkSession::Create(options.logs, options.machine, options.examples, impl.feed, niceness));
  if (!options.watch.database.empty()) {
    // Said at once, before anybody opens the page.
    TRY(Database::OpenReadOnly(options.watch.database));
    impl.watch = std::make_unique<WatchApi>(options.watch, impl.feed, impl.session->jobs());
    impl.session->set_database(options.watch.database);
  }
  impl.api = std::make_unique<PageApi>(impl.session.get(), impl.watch.get(), nullptr);
  TRY(page->Listen({options.port},
                   [&impl](const HttpRequest& request) { return impl.api->Answer(request); }));
  return page;
}

Result<std::unique_ptr<PageServer>> PageServer::OpenForService(const ServicePageOptions& options) {
  const bool tls = !options.listen.certificate.empty(), at_home = options.listen.at_home();
  if (!at_home && !tls)
    return UsageError("at {} other computers would see passwords on the wire: give --certificate and --key",
                      options.listen.address);
  std::unique_ptr<PageServer> page(new PageServer);
  Impl& impl = *page->impl_;
  impl.guard = {0, at_home, options.host_names, tls};
  // Cookies know hosts, but no ports: those of two services must not be the same.
  const std::string cookie =
      fmt::format("{}hydroscope_{}", tls ? "__Host-" : "", options.listen.port.value_or(0));
  impl.logins = std::make_unique<Logins>(options.watch.database, RealTime);
  impl.gate = std::make_unique<Gate>(*impl.logins, at_home, cookie);
  impl.login = std::make_unique<LoginApi>(*impl.logins, cookie, tls, !at_home);
  impl.session = TRY(WorkSession::Create({}, "", {}, impl.feed, JobQueue::kBesideAService));
  impl.session->set_database(options.watch.database);
  impl.watch = std::make_unique<WatchApi>(options.watch, impl.feed, impl.session->jobs());
  impl.api = std::make_unique<PageApi>(impl.session.get(), impl.watch.get(), impl.login.get());
  TRY(page->Listen(options.listen,
                   [page = page.get(), service = options.service](const HttpRequest& request) {
                     const auto answer = service(request);
                     return answer ? *answer : page->AnswerRecorded(request);
                   }));
  return page;
}

}  // namespace hydroscope

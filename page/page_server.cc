#include "page/page_server.h"

#include <fmt/format.h>

#include "page/assets.h"
#include "page/page_api.h"
#include "page/request_guard.h"

namespace hydroscope {

struct PageServer::Impl {
  EventFeed feed;
  RequestGuard guard;
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
  hooks.refuse = [&impl](const HttpRequest& request) { return impl.guard.Refuse(request); };
  hooks.body_file = [&impl](const HttpRequest& request) { return impl.api->BodyFile(request); };
  hooks.answer = std::move(answer);
  hooks.event_path = kEventPath;
  hooks.events = &impl.feed;
  auto http = HttpServer::Open(listen, std::move(hooks));
  if (!http) return tl::unexpected(http.error());
  impl.http = std::move(*http);
  impl.guard.port = impl.http->port();
  return {};
}

Result<std::unique_ptr<PageServer>> PageServer::Open(const PageOptions& options) {
  if (Assets().empty())
    return BadInput(
        "this program was built without the page: npm or its packages were missing. Run scripts/setup.sh and build again "
        "(scripts/build.sh)");
  std::unique_ptr<PageServer> page(new PageServer);
  Impl& impl = *page->impl_;
  impl.guard.token = RandomToken();
  if (impl.guard.token.empty()) return InternalError("the system gives no random numbers");
  auto session = WorkSession::Create(options.logs, options.machine, options.examples, impl.feed);
  if (!session) return tl::unexpected(session.error());
  impl.session = std::move(*session);
  if (!options.watch.database.empty()) {
    // Said at once, before anybody opens the page.
    if (const auto database = Database::OpenReadOnly(options.watch.database); !database)
      return tl::unexpected(database.error());
    impl.watch = std::make_unique<WatchApi>(options.watch, impl.feed);
  }
  impl.api = std::make_unique<PageApi>(impl.session.get(), impl.watch.get(), impl.guard.token);
  const Status listening = page->Listen(
      {options.port, ""}, [&impl](const HttpRequest& request) { return impl.api->Answer(request); });
  if (!listening) return tl::unexpected(listening.error());
  return page;
}

Result<std::unique_ptr<PageServer>> PageServer::OpenForService(const ServicePageOptions& options) {
  std::unique_ptr<PageServer> page(new PageServer);
  Impl& impl = *page->impl_;  // without a token nothing is changed by the port
  impl.watch = std::make_unique<WatchApi>(options.watch, impl.feed);
  impl.api = std::make_unique<PageApi>(nullptr, impl.watch.get(), "");
  const Status listening =
      page->Listen(options.listen, [&impl, service = options.service](const HttpRequest& request) {
        const auto answer = service(request);
        return answer ? *answer : impl.api->Answer(request);
      });
  if (!listening) return tl::unexpected(listening.error());
  return page;
}

}  // namespace hydroscope

#include "page/page_server.h"

#include <fmt/format.h>

#include "page/assets.h"
#include "page/http_server.h"
#include "page/page_api.h"
#include "page/request_guard.h"

namespace hydroscope {

struct PageServer::Impl {
  EventFeed feed;
  RequestGuard guard;
  std::unique_ptr<WorkSession> session;
  std::unique_ptr<PageApi> api;
  std::unique_ptr<HttpServer> http;
};

PageServer::PageServer() : impl_(std::make_unique<Impl>()) {}

PageServer::~PageServer() = default;

std::string PageServer::address() const { return fmt::format("http://127.0.0.1:{}/", impl_->http->port()); }

void PageServer::KeepAlive() { impl_->feed.KeepAlive(); }

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
  impl.api = std::make_unique<PageApi>(*impl.session, impl.guard.token);
  HttpServer::Hooks hooks;
  hooks.refuse = [&impl](const HttpRequest& request) { return impl.guard.Refuse(request); };
  hooks.body_file = [&impl](const HttpRequest& request) { return impl.api->BodyFile(request); };
  hooks.answer = [&impl](const HttpRequest& request) { return impl.api->Answer(request); };
  hooks.event_path = kEventPath;
  hooks.events = &impl.feed;
  auto http = HttpServer::Open(options.port, std::move(hooks));
  if (!http) return tl::unexpected(http.error());
  impl.http = std::move(*http);
  impl.guard.port = impl.http->port();
  return page;
}

}  // namespace hydroscope

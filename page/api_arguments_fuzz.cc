// libFuzzer target: whatever a request's body holds, it is read or refused, and names of uploads lead nowhere else.
#include <cstdlib>

#include "page/api_arguments.h"
#include "page/watch/requests.h"
#include "page/work/measured_effect.h"
#include "page/work/own_effect.h"
#include "page/work/region.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace hydroscope;
  const std::string body(reinterpret_cast<const char*>(data), size);
  (void)ParseWorkRequest(body);
  (void)ParseColumnMapping(body);
  (void)ParseText(body, "name");
  (void)ParseStrokeStretch(body);
  (void)ParseOwnEffect(body);
  (void)ParseMeasuredEffect(body);
  (void)ParseAlarmRequest(body);
  (void)ParseLearnRequest(body);
  (void)ParseRegion(body);
  const std::size_t comma = body.find(',');  // two arguments of a query
  (void)ParseTrendQuestion({{"machine", "m"},
                            {"parameter", "K"},
                            {"first", body.substr(0, comma)},
                            {"end", comma == body.npos ? "" : body.substr(comma + 1)}});
  const std::string name = PlainFileName(body);
  if (name.find('/') != name.npos || name.starts_with('.')) std::abort();
  return 0;
}

#pragma once

#include <Eigen/Dense>
#include <cstdint>
#include <string>

#include "core/bytes.h"

namespace hydroscope::drift {

/// Text and vectors in saved states: length, then content.
inline void PutText(ByteWriter& out, const std::string& text) {
  out.Put<std::uint32_t>(static_cast<std::uint32_t>(text.size()));
  for (const char c : text) out.Put(c);
}
inline std::string GetText(ByteReader& in) {
  std::string text;
  for (auto left = in.Get<std::uint32_t>(); left > 0 && in.ok(); --left) text.push_back(in.Get<char>());
  return text;
}
inline void PutVector(ByteWriter& out, const Eigen::VectorXd& values) {
  out.Put<std::uint32_t>(static_cast<std::uint32_t>(values.size()));
  for (const double v : values) out.Put(v);
}
/// At most `limit` long, so that a damaged length cannot ask for memory.
inline Eigen::VectorXd GetVector(ByteReader& in, std::uint32_t limit = 1024) {
  const auto size = in.Get<std::uint32_t>();
  Eigen::VectorXd values(in.ok() && size <= limit ? size : 0);
  for (double& v : values) v = in.Get<double>();
  return values;
}

}  // namespace hydroscope::drift

#include "core/registers.h"

#include <bit>
#include <cmath>
#include <limits>

namespace hydroscope {
namespace {

constexpr int kMostRegisters = 4;

std::uint16_t SwapBytes(std::uint16_t word) { return static_cast<std::uint16_t>(word << 8 | word >> 8); }

bool SwapsWords(WordOrder order) { return order == WordOrder::kCdab || order == WordOrder::kDcba; }
bool SwapsBytes(WordOrder order) { return order == WordOrder::kBadc || order == WordOrder::kDcba; }

/// Where word `k` (0 = most significant) of `count` lies.
std::size_t Place(std::size_t k, std::size_t count, WordOrder order) {
  return SwapsWords(order) ? count - 1 - k : k;
}

template <typename Integer>
std::uint64_t Rounded(double value) {
  if (std::isnan(value)) return 0;
  const double rounded = std::round(value);
  constexpr auto low = std::numeric_limits<Integer>::min();
  constexpr auto high = std::numeric_limits<Integer>::max();
  // The comparison is exact: double(high) is at or just above high.
  if (rounded >= static_cast<double>(high)) return static_cast<std::uint64_t>(high);
  if (rounded <= static_cast<double>(low)) return static_cast<std::uint64_t>(low);
  return static_cast<std::uint64_t>(static_cast<Integer>(rounded));
}

std::uint64_t Bits(double value, RegisterType type) {
  switch (type) {
    case RegisterType::kFloat32:
      return std::bit_cast<std::uint32_t>(static_cast<float>(value));
    case RegisterType::kFloat64:
      return std::bit_cast<std::uint64_t>(value);
    case RegisterType::kInt16:
      return Rounded<std::int16_t>(value);
    case RegisterType::kUint16:
      return Rounded<std::uint16_t>(value);
    case RegisterType::kInt32:
      return Rounded<std::int32_t>(value);
    case RegisterType::kUint32:
      return Rounded<std::uint32_t>(value);
    case RegisterType::kInt64:
      return Rounded<std::int64_t>(value);
    case RegisterType::kUint64:
      return Rounded<std::uint64_t>(value);
  }
  return 0;
}

double Value(std::uint64_t bits, RegisterType type) {
  switch (type) {
    case RegisterType::kFloat32:
      return std::bit_cast<float>(static_cast<std::uint32_t>(bits));
    case RegisterType::kFloat64:
      return std::bit_cast<double>(bits);
    case RegisterType::kInt16:
      return static_cast<std::int16_t>(bits);
    case RegisterType::kUint16:
      return static_cast<std::uint16_t>(bits);
    case RegisterType::kInt32:
      return static_cast<std::int32_t>(bits);
    case RegisterType::kUint32:
      return static_cast<std::uint32_t>(bits);
    case RegisterType::kInt64:
      return static_cast<double>(static_cast<std::int64_t>(bits));
    case RegisterType::kUint64:
      return static_cast<double>(bits);
  }
  return 0;
}

}  // namespace

int RegisterCount(RegisterType type) {
  switch (type) {
    case RegisterType::kInt16:
    case RegisterType::kUint16:
      return 1;
    case RegisterType::kFloat32:
    case RegisterType::kInt32:
    case RegisterType::kUint32:
      return 2;
    case RegisterType::kFloat64:
    case RegisterType::kInt64:
    case RegisterType::kUint64:
      return kMostRegisters;
  }
  return 1;
}

double DecodeRegisters(std::span<const std::uint16_t> registers, RegisterType type, WordOrder order) {
  const auto count = static_cast<std::size_t>(RegisterCount(type));
  if (registers.size() < count) return std::numeric_limits<double>::quiet_NaN();
  std::uint64_t bits = 0;
  for (std::size_t k = 0; k < count; ++k) {
    const std::uint16_t word = registers[Place(k, count, order)];
    bits = bits << 16 | (SwapsBytes(order) ? SwapBytes(word) : word);
  }
  return Value(bits, type);
}

void EncodeRegisters(double value, RegisterType type, WordOrder order, std::span<std::uint16_t> registers) {
  const auto count = static_cast<std::size_t>(RegisterCount(type));
  const std::uint64_t bits = Bits(value, type);
  for (std::size_t k = 0; k < count; ++k) {
    const auto word = static_cast<std::uint16_t>(bits >> 16 * (count - 1 - k));
    registers[Place(k, count, order)] = SwapsBytes(order) ? SwapBytes(word) : word;
  }
}

std::uint64_t DecodeUnsigned(std::span<const std::uint16_t> words) {
  std::uint64_t value = 0;
  for (const std::uint16_t word : words) value = value << 16 | word;
  return value;
}

void EncodeUnsigned(std::uint64_t value, std::span<std::uint16_t> words) {
  for (std::size_t k = words.size(); k-- > 0; value >>= 16) words[k] = static_cast<std::uint16_t>(value);
}

}  // namespace hydroscope

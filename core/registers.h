#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <string_view>

namespace hydroscope {

/// How a number lies in 16-bit Modbus registers.
enum class RegisterType { kFloat32, kFloat64, kInt16, kUint16, kInt32, kUint32, kInt64, kUint64 };

/// Order of the bytes of a 32-bit value on the wire, A being the most significant; 64-bit values likewise by words.
/// ABCD is what the Modbus specification does within a register, CDAB swaps the words ("little-endian words").
enum class WordOrder { kAbcd, kCdab, kBadc, kDcba };

inline constexpr std::array<std::string_view, 8> kRegisterTypeNames = {
    "float32", "float64", "int16", "uint16", "int32", "uint32", "int64", "uint64"};
inline constexpr std::array<std::string_view, 4> kWordOrderNames = {"ABCD", "CDAB", "BADC", "DCBA"};

/// Registers that a value of this type takes: 1, 2 or 4.
int RegisterCount(RegisterType type);

/// The number in the first RegisterCount(type) of `registers`; NaN if there are fewer. 64-bit integers beyond
/// 2^53 are rounded to double.
double DecodeRegisters(std::span<const std::uint16_t> registers, RegisterType type, WordOrder order);

/// Writes `value` into the first RegisterCount(type) of `registers`, which must have room. Integers are
/// rounded and held within their range; NaN becomes 0 in an integer.
void EncodeRegisters(double value, RegisterType type, WordOrder order, std::span<std::uint16_t> registers);

/// Whole numbers without the way over double; `words` is most significant word first, in order ABCD.
std::uint64_t DecodeUnsigned(std::span<const std::uint16_t> words);
void EncodeUnsigned(std::uint64_t value, std::span<std::uint16_t> words);

}  // namespace hydroscope

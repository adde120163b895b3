#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "core/records/stroke_gram.h"
#include "core/result.h"

namespace hydroscope {

/// How exactly `noise` is stored. It is an estimate good to a few per cent, so a stroke's takes float32
/// scaled per column (relative rounding 6e-8, whatever the units); sums over strokes keep double.
enum class NoisePrecision : std::uint8_t { kFloat = 4, kDouble = 8 };

/// StrokeGram as bytes, little endian, layout version 1 (docs/database.md):
///   char[4] "HSGM" | u16 version | u16 bytes per noise value | u16 dimension of integral, noise, flow | u16
///   0 | i64 blocks, spans, windows | f64 integral[] | f64 flow[] | kFloat: i16 e[dimension], f32 noise(i,j)
///   * 2^-(e_i + e_j); kDouble: f64 noise[] | u32 CRC-32 of all before.
/// Triangles are packed by columns as in SymmetricMatrix. `integral`, `flow` and the counts come back to the bit.
std::vector<std::uint8_t> EncodeGram(const StrokeGram& gram, NoisePrecision precision);

/// The error text tells what is wrong with the bytes, to stand behind the name of run and stroke.
Result<StrokeGram> DecodeGram(std::span<const std::uint8_t> bytes);

}  // namespace hydroscope

#include "storage/blobs/gram_codec.h"

#include <zlib.h>

#include <array>
#include <bit>
#include <cmath>
#include <cstring>

namespace hydroscope {
namespace {

static_assert(std::endian::native == std::endian::little, "stored numbers are little endian");

constexpr std::array<char, 4> kMagic = {'H', 'S', 'G', 'M'};
constexpr std::uint16_t kLayoutVersion = 1;

struct Header {
  std::array<char, 4> magic = kMagic;
  std::uint16_t version = kLayoutVersion;
  std::uint16_t noise_bytes = 0;
  std::uint16_t integral_dimension = 0, noise_dimension = 0, flow_dimension = 0;
  std::uint16_t zero = 0;
  std::int64_t blocks = 0, spans = 0, windows = 0;
};
static_assert(sizeof(Header) == 40);

std::size_t NoiseSize(const Header& header) {
  const std::size_t values = SymmetricMatrix::Size(header.noise_dimension);
  if (header.noise_bytes == 8) return 8 * values;
  return 2 * header.noise_dimension + 4 * values;
}

std::size_t BlobSize(const Header& header) {
  return sizeof(Header) + 8 * SymmetricMatrix::Size(header.integral_dimension) +
         8 * SymmetricMatrix::Size(header.flow_dimension) + NoiseSize(header) + sizeof(std::uint32_t);
}

std::uint32_t Checksum(const std::uint8_t* bytes, std::size_t size) {
  return static_cast<std::uint32_t>(crc32_z(crc32_z(0, nullptr, 0), bytes, size));
}

/// Writes plain values one after the other into a buffer that is large enough.
class Cursor {
 public:
  explicit Cursor(std::uint8_t* at) : at_(at) {}
  void Put(const void* data, std::size_t size) {
    if (size > 0) std::memcpy(at_, data, size);
    at_ += size;
  }

 private:
  std::uint8_t* at_;
};

class ConstCursor {
 public:
  explicit ConstCursor(const std::uint8_t* at) : at_(at) {}
  void Get(void* data, std::size_t size) {
    if (size > 0) std::memcpy(data, at_, size);
    at_ += size;
  }

 private:
  const std::uint8_t* at_;
};

/// Half the binary exponent of the column's own noise, so that scaled values are around one.
std::vector<std::int16_t> ColumnExponents(const SymmetricMatrix& noise) {
  std::vector<std::int16_t> exponents(static_cast<std::size_t>(noise.dimension()), 0);
  for (int i = 0; i < noise.dimension(); ++i) {
    const double diagonal = std::abs(noise(i, i));
    if (diagonal > 0 && std::isfinite(diagonal))
      exponents[i] = static_cast<std::int16_t>(std::ilogb(diagonal) / 2);
  }
  return exponents;
}

/// 2^(sign e) per column: multiplying by a power of two is exact.
std::vector<double> PowersOfTwo(const std::vector<std::int16_t>& exponents, int sign) {
  std::vector<double> powers;
  for (const std::int16_t exponent : exponents) powers.push_back(std::ldexp(1.0, sign * exponent));
  return powers;
}

void PutScaledNoise(const SymmetricMatrix& noise, Cursor& out) {
  const auto exponents = ColumnExponents(noise);
  const auto scale = PowersOfTwo(exponents, -1);
  std::vector<float> scaled;
  scaled.reserve(noise.packed().size());
  for (std::size_t j = 0, k = 0; j < scale.size(); ++j)
    for (std::size_t i = 0; i <= j; ++i, ++k)
      scaled.push_back(static_cast<float>(noise.packed()[k] * scale[i] * scale[j]));
  out.Put(exponents.data(), exponents.size() * sizeof(std::int16_t));
  out.Put(scaled.data(), scaled.size() * sizeof(float));
}

void GetScaledNoise(SymmetricMatrix& noise, ConstCursor& in) {
  std::vector<std::int16_t> exponents(static_cast<std::size_t>(noise.dimension()));
  std::vector<float> scaled(noise.packed().size());
  in.Get(exponents.data(), exponents.size() * sizeof(std::int16_t));
  in.Get(scaled.data(), scaled.size() * sizeof(float));
  const auto scale = PowersOfTwo(exponents, 1);
  for (std::size_t j = 0, k = 0; j < scale.size(); ++j)
    for (std::size_t i = 0; i <= j; ++i, ++k)
      noise.packed()[k] = static_cast<double>(scaled[k]) * scale[i] * scale[j];
}

}  // namespace

std::vector<std::uint8_t> EncodeGram(const StrokeGram& gram, NoisePrecision precision) {
  Header header;
  header.noise_bytes = static_cast<std::uint16_t>(precision);
  header.integral_dimension = static_cast<std::uint16_t>(gram.integral.dimension());
  header.noise_dimension = static_cast<std::uint16_t>(gram.noise.dimension());
  header.flow_dimension = static_cast<std::uint16_t>(gram.flow.dimension());
  header.blocks = gram.blocks;
  header.spans = gram.spans;
  header.windows = gram.windows;

  std::vector<std::uint8_t> bytes(BlobSize(header));
  Cursor out(bytes.data());
  out.Put(&header, sizeof(header));
  out.Put(gram.integral.packed().data(), gram.integral.packed().size() * sizeof(double));
  out.Put(gram.flow.packed().data(), gram.flow.packed().size() * sizeof(double));
  if (precision == NoisePrecision::kDouble)
    out.Put(gram.noise.packed().data(), gram.noise.packed().size() * sizeof(double));
  else
    PutScaledNoise(gram.noise, out);
  const std::uint32_t checksum = Checksum(bytes.data(), bytes.size() - sizeof(std::uint32_t));
  out.Put(&checksum, sizeof(checksum));
  return bytes;
}

Result<StrokeGram> DecodeGram(std::span<const std::uint8_t> bytes) {
  Header header;
  if (bytes.size() < sizeof(header) + sizeof(std::uint32_t))
    return BadInput("torn: {} bytes, at least {} expected", bytes.size(),
                    sizeof(header) + sizeof(std::uint32_t));
  ConstCursor in(bytes.data());
  in.Get(&header, sizeof(header));
  if (header.magic != kMagic) return BadInput("not a Gram: it does not start with HSGM");
  if (header.version != kLayoutVersion)
    return BadInput("layout version {}, this program reads version {}", header.version, kLayoutVersion);
  if (header.noise_bytes != 4 && header.noise_bytes != 8)
    return BadInput("damaged: {} bytes per noise value, expected 4 or 8", header.noise_bytes);
  if (bytes.size() != BlobSize(header))
    return BadInput("torn: {} bytes, {} expected for dimension {}", bytes.size(), BlobSize(header),
                    header.integral_dimension);
  std::uint32_t checksum = 0;
  std::memcpy(&checksum, bytes.data() + bytes.size() - sizeof(checksum), sizeof(checksum));
  if (checksum != Checksum(bytes.data(), bytes.size() - sizeof(checksum)))
    return BadInput("damaged: the checksum does not fit the content");

  StrokeGram gram{header.blocks,
                  header.spans,
                  header.windows,
                  SymmetricMatrix(header.integral_dimension),
                  SymmetricMatrix(header.noise_dimension),
                  SymmetricMatrix(header.flow_dimension)};
  in.Get(gram.integral.packed().data(), gram.integral.packed().size() * sizeof(double));
  in.Get(gram.flow.packed().data(), gram.flow.packed().size() * sizeof(double));
  if (header.noise_bytes == 8)
    in.Get(gram.noise.packed().data(), gram.noise.packed().size() * sizeof(double));
  else
    GetScaledNoise(gram.noise, in);
  return gram;
}

}  // namespace hydroscope

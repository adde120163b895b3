#include <matio.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <limits>

#include "core/told_error.h"
#include "replay/mat_reader.h"

namespace hydroscope {
namespace {

// Of a matrix that is taken for signals; a damaged file claims any number.
constexpr std::int64_t kMostColumns = 10'000;

template <typename T>
void CopyAsDoubles(const unsigned char* bytes, std::int64_t count, std::int64_t stride, double* out) {
  for (std::int64_t i = 0; i < count; ++i) {
    T value;
    std::memcpy(&value, bytes + static_cast<std::size_t>(i * stride) * sizeof(T), sizeof(T));
    out[i] = static_cast<double>(value);
  }
}

/// Numbers of a MATLAB class as doubles; false if the class holds no numbers.
bool ToDoubles(matio_classes kind, const unsigned char* bytes, std::int64_t count, std::int64_t stride,
               double* out) {
  switch (kind) {
    case MAT_C_DOUBLE:
      CopyAsDoubles<double>(bytes, count, stride, out);
      return true;
    case MAT_C_SINGLE:
      CopyAsDoubles<float>(bytes, count, stride, out);
      return true;
    case MAT_C_INT8:
      CopyAsDoubles<std::int8_t>(bytes, count, stride, out);
      return true;
    case MAT_C_UINT8:
      CopyAsDoubles<std::uint8_t>(bytes, count, stride, out);
      return true;
    case MAT_C_INT16:
      CopyAsDoubles<std::int16_t>(bytes, count, stride, out);
      return true;
    case MAT_C_UINT16:
      CopyAsDoubles<std::uint16_t>(bytes, count, stride, out);
      return true;
    case MAT_C_INT32:
      CopyAsDoubles<std::int32_t>(bytes, count, stride, out);
      return true;
    case MAT_C_UINT32:
      CopyAsDoubles<std::uint32_t>(bytes, count, stride, out);
      return true;
    case MAT_C_INT64:
      CopyAsDoubles<std::int64_t>(bytes, count, stride, out);
      return true;
    case MAT_C_UINT64:
      CopyAsDoubles<std::uint64_t>(bytes, count, stride, out);
      return true;
    default:
      return false;
  }
}

constexpr std::size_t kVersion4Head = 20, kLongestName = 64;  // bytes

/// Version 4 has no signature: five whole numbers (type, rows, columns, imaginary part, length of the name) and the name
/// of the first matrix, with a zero behind it (MAT-File Format, The MathWorks, 2019, chapter 2). The type's decimal
/// digits MOPT are machine, 0, precision and kind. No text begins so: its first four bytes are a number above 5000.
bool IsVersion4(std::string_view head) {
  if (head.size() < kVersion4Head + 2) return false;
  std::array<std::int32_t, 5> number;
  std::memcpy(number.data(), head.data(), kVersion4Head);
  if (number[0] < 0 || number[0] >= 5000)  // of a machine with the other order of bytes
    for (std::int32_t& n : number)
      n = static_cast<std::int32_t>(__builtin_bswap32(static_cast<std::uint32_t>(n)));
  const auto [type, rows, columns, imaginary, length] = number;
  const bool plain =
      type >= 0 && type < 5000 && type / 100 % 10 == 0 && type / 10 % 10 <= 5 && type % 10 <= 2;
  if (!plain || rows < 1 || columns < 1 || (imaginary != 0 && imaginary != 1)) return false;
  if (length < 2 || length > static_cast<std::int32_t>(std::min(kLongestName, head.size() - kVersion4Head)))
    return false;
  const std::string_view name = head.substr(kVersion4Head, static_cast<std::size_t>(length));
  return name.back() == '\0' && std::all_of(name.begin(), name.end() - 1, [](char c) {
           return std::isalnum(static_cast<unsigned char>(c)) != 0 || c == '_';
         });
}

bool HoldsNumbers(const matvar_t& variable) {
  double none;
  return variable.isComplex == 0 && variable.rank == 2 &&
         ToDoubles(variable.class_type, nullptr, 0, 1, &none);
}

/// Bytes of a variable in memory, as the file says; of a struct or a cell array those of its parts.
double UnpackedBytes(const matvar_t& variable) {
  if (variable.class_type == MAT_C_STRUCT || variable.class_type == MAT_C_CELL) {
    double bytes = 0;
    const auto* const* parts = static_cast<const matvar_t* const*>(variable.data);
    for (std::size_t i = 0; parts != nullptr && i < variable.nbytes / sizeof(*parts); ++i)
      if (parts[i] != nullptr) bytes += UnpackedBytes(*parts[i]);
    return bytes;
  }
  auto bytes = static_cast<double>(Mat_SizeOfClass(variable.class_type));
  for (int i = 0; variable.dims != nullptr && i < variable.rank; ++i)
    bytes *= static_cast<double>(variable.dims[i]);
  return bytes;
}

/// Measurements pack into a half to a tenth; what packs into less than a thirtieth, and is large, is none.
double MostHeld(const std::string& path) {
  constexpr double kAlways = 64e6, kOfFile = 30;  // bytes, times its size
  std::error_code failure;
  const auto size = std::filesystem::file_size(path, failure);
  return kAlways + (failure ? 0 : kOfFile * static_cast<double>(size));
}

}  // namespace

bool IsMatFile(const std::string& path) {
  std::array<char, kVersion4Head + kLongestName> head{};
  std::ifstream file(path, std::ios::binary);
  file.read(head.data(), head.size());
  const std::string_view text(head.data(), static_cast<std::size_t>(file.gcount()));
  return text.starts_with("MATLAB 5.0") || text.starts_with("MATLAB 7.3") || IsVersion4(text);
}

Result<std::unique_ptr<MatColumns>> MatColumns::Open(const std::string& path) {
  std::unique_ptr<MatColumns> columns(new MatColumns(path));
  columns->file_ = Mat_Open(path.c_str(), MAT_ACC_RDONLY);
  if (columns->file_ == nullptr)
    return BadInput(Tell("log '{}': the MAT file cannot be opened; expected version 4 to 7.3",
                         "Log '{}': die MAT-Datei lässt sich nicht öffnen; erwartet: Version 4 bis 7.3",
                         path));
  columns->may_hold_ = MostHeld(path);
  while (matvar_t* variable = Mat_VarReadNextInfo(columns->file_)) columns->variables_.push_back(variable);
  for (matvar_t*& variable : columns->variables_) {
    if (variable->name == nullptr) continue;
    const bool whole = variable->class_type == MAT_C_STRUCT;
    if (whole) {
      TRY(columns->Reserve(*variable));
      matvar_t* read = Mat_VarRead(columns->file_, variable->name);
      if (read == nullptr) continue;
      Mat_VarFree(variable);
      variable = read;
    }
    columns->AddVariable(variable, variable->name, whole);
  }
  if (columns->columns_.empty())
    return BadInput(
        Tell("log '{}': no vectors or matrices of numbers found among the {} variables of the MAT file",
             "Log '{}': unter den {} Variablen der MAT-Datei ist kein Vektor und keine Matrix aus Zahlen",
             path, columns->variables_.size()));
  return columns;
}

MatColumns::~MatColumns() {
  for (matvar_t* variable : variables_) Mat_VarFree(variable);
  if (file_ != nullptr) Mat_Close(file_);
}

void MatColumns::AddVariable(matvar_t* variable, const std::string& name, bool held) {
  if (variable->class_type == MAT_C_STRUCT) {
    const unsigned fields = Mat_VarGetNumberOfFields(variable);
    char* const* field_names = Mat_VarGetStructFieldnames(variable);
    const bool complete =
        field_names != nullptr && variable->data != nullptr && variable->nbytes >= fields * sizeof(matvar_t*);
    if (!complete) return;  // the file says there are more than it holds
    for (unsigned i = 0; i < fields; ++i)
      if (matvar_t* field = Mat_VarGetStructFieldByIndex(variable, i, 0))
        AddVariable(field, field_names[i], held);
    return;
  }
  if (!HoldsNumbers(*variable) || (held && variable->data == nullptr)) return;
  const auto down = static_cast<std::int64_t>(variable->dims[0]);
  const auto across = static_cast<std::int64_t>(variable->dims[1]);
  const bool upright = down >= across;
  const std::int64_t count = upright ? across : down;
  if (count < 1 || count > kMostColumns || std::max(down, across) < 2) return;
  for (std::int64_t i = 0; i < count; ++i) {
    Column column{variable, held, upright ? i * down : i, upright ? 1 : down, upright ? down : across};
    columns_.push_back(column);
    names_.push_back(count == 1 ? name : fmt::format("{}({})", name, i + 1));
  }
}

Status MatColumns::Reserve(const matvar_t& variable) {
  const double bytes = UnpackedBytes(variable);
  may_hold_ -= bytes;
  if (may_hold_ >= 0) return {};
  return BadInput(Tell(
      "log '{}': variable '{}' of the MAT file unpacks to {:.0f} MB, more than measurements in a file of this size",
      "Log '{}': die Variable '{}' der MAT-Datei wird entpackt {:.0f} MB groß, mehr als Messwerte in so einer Datei",
      path_, variable.name, bytes / 1e6));
}

/// Reads the whole variable of a column into memory.
Status MatColumns::Hold(Column& column) {
  TRY(Reserve(*column.variable));
  if (Mat_VarReadDataAll(file_, column.variable) != 0 || column.variable->data == nullptr)
    return BadInput(
        Tell("log '{}': variable '{}' of the MAT file is damaged or too big for the memory",
             "Log '{}': die Variable '{}' der MAT-Datei ist beschädigt oder zu groß für den Speicher", path_,
             column.variable->name));
  for (Column& other : columns_)
    if (other.variable == column.variable) other.held = true;
  return {};
}

Status MatColumns::Read(std::size_t index, std::int64_t first, std::int64_t count, double* out) {
  Column& column = columns_[index];
  matvar_t* variable = column.variable;
  // Every slice of compressed data would be unpacked from the beginning.
  if (!column.held && variable->compression == MAT_COMPRESSION_ZLIB && Mat_GetVersion(file_) != MAT_FT_MAT73)
    TRY(Hold(column));
  const std::int64_t start = column.start + first * column.stride;
  const std::size_t size = Mat_SizeOfClass(variable->class_type);
  if (column.held) {
    const auto* bytes =
        static_cast<const unsigned char*>(variable->data) + static_cast<std::size_t>(start) * size;
    ToDoubles(variable->class_type, bytes, count, column.stride, out);
    return {};
  }
  if (start + count * column.stride > std::numeric_limits<int>::max())
    return BadInput(Tell(
        "log '{}': variable '{}' has more than {} numbers, more than matio reads; save every signal as a "
        "vector of its own, or split the log",
        "Log '{}': die Variable '{}' hat mehr als {} Zahlen, mehr als matio liest; jedes Signal als eigenen Vektor "
        "speichern, oder das Log teilen",
        path_, names_[index], std::numeric_limits<int>::max()));
  slice_.resize(static_cast<std::size_t>(count) * size);
  if (Mat_VarReadDataLinear(file_, variable, slice_.data(), static_cast<int>(start),
                            static_cast<int>(column.stride), static_cast<int>(count)) != 0)
    return BadInput(Tell("log '{}': variable '{}' of the MAT file is damaged near row {}",
                         "Log '{}': die Variable '{}' der MAT-Datei ist bei Zeile {} beschädigt", path_,
                         names_[index], first + 1));
  ToDoubles(variable->class_type, slice_.data(), count, 1, out);
  return {};
}

}  // namespace hydroscope

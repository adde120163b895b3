#pragma once

#include <cstddef>
#include <vector>

namespace hydroscope {

/// Upper triangle of a symmetric matrix, packed by columns: element (i, j), i <= j, at j(j+1)/2 + i.
class SymmetricMatrix {
 public:
  SymmetricMatrix() = default;
  explicit SymmetricMatrix(int dimension) : dimension_(dimension), packed_(Size(dimension), 0.0) {}

  static std::size_t Size(int dimension) { return static_cast<std::size_t>(dimension) * (dimension + 1) / 2; }

  int dimension() const { return dimension_; }
  double operator()(int i, int j) const { return packed_[Index(i, j)]; }
  double& operator()(int i, int j) { return packed_[Index(i, j)]; }
  const std::vector<double>& packed() const { return packed_; }
  std::vector<double>& packed() { return packed_; }

  SymmetricMatrix& operator+=(const SymmetricMatrix& other) {
    for (std::size_t k = 0; k < packed_.size(); ++k) packed_[k] += other.packed_[k];
    return *this;
  }
  SymmetricMatrix& operator-=(const SymmetricMatrix& other) {
    for (std::size_t k = 0; k < packed_.size(); ++k) packed_[k] -= other.packed_[k];
    return *this;
  }
  bool operator==(const SymmetricMatrix&) const = default;

 private:
  static std::size_t Index(int i, int j) {
    if (i > j) return Index(j, i);
    return static_cast<std::size_t>(j) * (j + 1) / 2 + i;
  }
  int dimension_ = 0;
  std::vector<double> packed_;
};

}  // namespace hydroscope

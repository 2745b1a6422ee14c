// The product by packs of numbers: included by one source per instruction set, which says what a
// pack is. No Eigen here: its functions would be compiled for a CPU that may not be there.
#pragma once

#include <cstddef>

namespace palpate::deformation::dense {

/// Column-major.
struct Operands {
  const double *a = nullptr, *b = nullptr;
  double* c = nullptr;
  std::size_t a_stride = 0, b_stride = 0, c_stride = 0;
  std::size_t rows = 0, columns = 0, depth = 0;  ///< of C; columns of A and B
  bool lower = false;                            ///< tiles above C's diagonal are left out
};

/// What an instruction set offers.
struct Functions {
  /// Of the scratch that `subtract` needs.
  std::size_t (*scratch_size)(const Operands& operands) = nullptr;
  void (*subtract)(const Operands& operands, double* scratch) = nullptr;
};
const Functions& portable_functions();
const Functions& avx2_functions();
const Functions& avx512_functions();

/// @tparam Packs  Pack, kWidth, kPacks and kColumns of a tile, load, store, broadcast, fma
template <class Packs>
class Product {
  using Pack = typename Packs::Pack;
  static constexpr std::size_t kWidth = Packs::kWidth, kPacks = Packs::kPacks;
  static constexpr std::size_t kRows = kPacks * kWidth, kColumns = Packs::kColumns;

  static std::size_t strips(std::size_t count, std::size_t width) {
    return (count + width - 1) / width;
  }

  static std::size_t scratch_size(const Operands& o) {
    return o.depth * (kRows + strips(o.columns, kColumns) * kColumns);
  }

  /// `count` ≤ kStrip rows of a matrix, one column after the other, zeros for those that lack.
  template <std::size_t kStrip>
  static void copy_strip(const double* from, std::size_t stride, std::size_t count,
                         std::size_t depth, double* to) {
    for (std::size_t k = 0; k < depth; ++k, from += stride, to += kStrip) {
      if (count == kStrip) {
        for (std::size_t i = 0; i < kStrip; ++i) to[i] = from[i];
      } else {
        for (std::size_t i = 0; i < kStrip; ++i) to[i] = i < count ? from[i] : 0;
      }
    }
  }

  static void subtract(const Operands& o, double* scratch) {
    double *strip_a = scratch, *strips_b = scratch + o.depth * kRows;
    for (std::size_t j = 0; j < o.columns; j += kColumns) {
      const std::size_t count = o.columns - j < kColumns ? o.columns - j : kColumns;
      copy_strip<kColumns>(o.b + j, o.b_stride, count, o.depth, strips_b + j * o.depth);
    }
    for (std::size_t i = 0; i < o.rows; i += kRows) {
      const std::size_t rows = o.rows - i < kRows ? o.rows - i : kRows;
      copy_strip<kRows>(o.a + i, o.a_stride, rows, o.depth, strip_a);
      const std::size_t end = o.lower && i + rows < o.columns ? i + rows : o.columns;
      for (std::size_t j = 0; j < end; j += kColumns) {
        const std::size_t columns = o.columns - j < kColumns ? o.columns - j : kColumns;
        tile(o.depth, strip_a, strips_b + j * o.depth, rows, columns, o.c + i + j * o.c_stride,
             o.c_stride);
      }
    }
  }

  static void tile(std::size_t depth, const double* a, const double* b, std::size_t rows,
                   std::size_t columns, double* c, std::size_t stride) {
    Pack sum[kColumns][kPacks] = {};
    for (std::size_t k = 0; k < depth; ++k, a += kRows, b += kColumns) {
      Pack column[kPacks];
      for (std::size_t p = 0; p < kPacks; ++p) column[p] = Packs::load(a + p * kWidth);
      for (std::size_t j = 0; j < kColumns; ++j) {
        const Pack value = Packs::broadcast(b[j]);
        for (std::size_t p = 0; p < kPacks; ++p) {
          sum[j][p] = Packs::fma(column[p], value, sum[j][p]);
        }
      }
    }
    if (rows == kRows && columns == kColumns) {
      for (std::size_t j = 0; j < kColumns; ++j) {
        for (std::size_t p = 0; p < kPacks; ++p) {
          double* at = c + j * stride + p * kWidth;
          Packs::store(at, Packs::load(at) - sum[j][p]);
        }
      }
      return;
    }
    double part[kColumns * kRows] = {};
    for (std::size_t j = 0; j < kColumns; ++j) {
      for (std::size_t p = 0; p < kPacks; ++p) {
        Packs::store(part + j * kRows + p * kWidth, sum[j][p]);
      }
    }
    for (std::size_t j = 0; j < columns; ++j) {
      for (std::size_t i = 0; i < rows; ++i) c[i + j * stride] -= part[j * kRows + i];
    }
  }

 public:
  static constexpr Functions functions{&scratch_size, &subtract};
};

}  // namespace palpate::deformation::dense

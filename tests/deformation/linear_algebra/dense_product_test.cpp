#include "deformation/linear_algebra/dense_product.h"

#include <catch2/catch.hpp>
#include <limits>

#include "tests/deformation/elements/solids.h"

namespace palpate::deformation {
namespace {

Eigen::MatrixXd noisy_matrix(Eigen::Index rows, Eigen::Index columns, std::size_t seed) {
  Eigen::MatrixXd matrix(rows, columns);
  for (Eigen::Index i = 0; i < matrix.size(); ++i) {
    matrix.data()[i] = testing::noise(seed + static_cast<std::size_t>(i));
  }
  return matrix;
}

TEST_CASE("dense product: every instruction set subtracts the same product, of parts of matrices") {
  // Oracle: Eigen's product, within the rounding of two sums of `depth` terms below 1.
  for (const auto set : available_instruction_sets()) {
    INFO(name_of(set));
    DenseProduct product(set);
    for (const Eigen::Index rows : {0, 1, 7, 24, 61}) {
      for (const Eigen::Index columns : {0, 1, 8, 29, 50}) {
        for (const Eigen::Index depth : {0, 1, 5, 64}) {
          const auto a = noisy_matrix(rows + 3, depth + 1, 1);
          const auto b = noisy_matrix(columns + 2, depth + 1, 2);
          const auto c = noisy_matrix(rows + 1, columns + 4, 3);
          auto expected = c, found = c;
          expected.block(1, 2, rows, columns) -=
              a.block(2, 1, rows, depth) * b.block(1, 1, columns, depth).transpose();
          product.subtract(a.block(2, 1, rows, depth), b.block(1, 1, columns, depth),
                           found.block(1, 2, rows, columns));
          const double rounding =
              2 * static_cast<double>(depth + 1) * std::numeric_limits<double>::epsilon();
          CHECK((found - expected).cwiseAbs().maxCoeff() <= rounding);
        }
      }
    }
  }
}

TEST_CASE("dense product: of a lower triangle, the lower triangle is the whole product's") {
  // Oracle: subtract(); the same sums, so the same bits.
  for (const auto set : available_instruction_sets()) {
    DenseProduct product(set);
    for (const Eigen::Index rows : {50, 77}) {
      const auto a = noisy_matrix(rows, 40, 4), b = noisy_matrix(50, 40, 5);
      Eigen::MatrixXd whole = noisy_matrix(rows, 50, 6), lower = whole;
      product.subtract(a, b, whole);
      product.subtract_lower(a, b, lower);
      CHECK(Eigen::MatrixXd(lower.triangularView<Eigen::Lower>()) ==
            Eigen::MatrixXd(whole.triangularView<Eigen::Lower>()));
    }
  }
}

TEST_CASE("dense product: instruction sets that fuse multiply and add give the same bits") {
  // Oracle: each other; on a CPU that lacks them nothing is compared.
  const auto sets = available_instruction_sets();
  const auto a = noisy_matrix(53, 64, 7), b = noisy_matrix(31, 64, 8);
  std::vector<Eigen::MatrixXd> found;
  for (const auto set : sets) {
    Eigen::MatrixXd& c = found.emplace_back(noisy_matrix(53, 31, 9));
    DenseProduct(set).subtract(a, b, c);
  }
  for (std::size_t s = 2; s < found.size(); ++s) CHECK(found[s] == found[1]);
}

}  // namespace
}  // namespace palpate::deformation

#include "modules/core/simd_vectors.h"

#include <catch2/catch.hpp>
#include <cmath>

using namespace palpate::deformation;

TEST_CASE("simd vectors: a step along a direction is its parts, one after the other") {
  // Oracle: dot(), add() and the product of each block, to float's rounding.
  constexpr std::size_t kCount = 100;  // not a multiple of what is summed together
  std::vector<Vec4f> d, q, x, r, z(kCount, Vec4f::Zero());
  std::vector<std::array<Vec4f, 3>> P;
  int n = 0;
  const auto any = [&n] {
    ++n;
    return palpate::Vec3(std::sin(n), std::cos(n), 0.3);
  };
  for (std::size_t i = 0; i < kCount; ++i) {
    for (auto* vector : {&d, &q, &x, &r}) vector->push_back(wide(any()));
    P.push_back({wide(any()), wide(any()), wide(any())});
  }
  std::vector<Vec4f> expected_x = x, expected_r = r, expected_z;
  add(0.7, d, expected_x);
  add(-0.7, q, expected_r);
  for (std::size_t i = 0; i < kCount; ++i) {
    const Vec4f& rest = expected_r[i];
    expected_z.emplace_back(rest[0] * P[i][0] + rest[1] * P[i][1] + rest[2] * P[i][2]);
  }
  const Gone gone = go_along(0.7, d, q, P, x, r, z);
  CHECK(x == expected_x);
  CHECK(r == expected_r);
  CHECK(z == expected_z);
  CHECK(gone.descent == Approx(dot(r, z)).epsilon(1e-5));
  CHECK(gone.change == Approx(dot(q, z)).epsilon(1e-5));
}

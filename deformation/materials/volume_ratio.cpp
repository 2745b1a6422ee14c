#include "deformation/materials/volume_ratio.h"

namespace palpate::deformation {

Mat3 cofactor(const Mat3& F) {
  Mat3 result;
  result << F.col(1).cross(F.col(2)), F.col(2).cross(F.col(0)), F.col(0).cross(F.col(1));
  return result;
}

// Column j of the cofactor is F_{j+1} × F_{j+2}; its derivative by F_{j+2} is [F_{j+1}]×.
Mat9 cofactor_derivative(const Mat3& F) {
  const auto cross_matrix = [](const Vec3& v) {
    Mat3 m;
    m << 0, -v.z(), v.y(), v.z(), 0, -v.x(), -v.y(), v.x(), 0;
    return m;
  };
  Mat9 result = Mat9::Zero();
  for (int j = 0; j < 3; ++j) {
    const int next = (j + 1) % 3, last = (j + 2) % 3;
    result.block<3, 3>(3 * j, 3 * last) = cross_matrix(F.col(next));
    result.block<3, 3>(3 * j, 3 * next) = -cross_matrix(F.col(last));
  }
  return result;
}

}  // namespace palpate::deformation

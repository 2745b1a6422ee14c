#include "deformation/elements/quadrature.h"

#include <cmath>

namespace palpate::deformation {
namespace {

std::array<TetrahedronPoint, 4> make_four_point_rule() {
  const double a = (5 - std::sqrt(5.0)) / 20;
  std::array<TetrahedronPoint, 4> rule{};
  for (int i = 0; i < 4; ++i) {
    rule[i] = {Eigen::Vector4d::Constant(a), 0.25};
    rule[i].barycentric[i] = 1 - 3 * a;
  }
  return rule;
}

std::array<TetrahedronPoint, 14> make_fourteen_point_rule() {
  std::array<TetrahedronPoint, 14> rule{};
  int next = 0;
  const auto add_corners = [&](double a, double weight) {
    for (int i = 0; i < 4; ++i) {
      rule[next] = {Eigen::Vector4d::Constant(a), weight};
      rule[next++].barycentric[i] = 1 - 3 * a;
    }
  };
  add_corners(0.31088591926330060980, 6 * 0.01878132095300264180);
  add_corners(0.09273525031089122640, 6 * 0.01224884051939365826);
  const double b = 0.04550370412564964949;
  for (const auto& [i, j] : kTetrahedronEdges) {
    rule[next] = {Eigen::Vector4d::Constant(0.5 - b), 6 * 0.007091003462846911073};
    rule[next].barycentric[i] = rule[next].barycentric[j] = b;
    ++next;
  }
  return rule;
}

std::array<TrianglePoint, 6> make_six_point_rule() {
  std::array<TrianglePoint, 6> rule{};
  int next = 0;
  const auto add_corners = [&](double a, double weight) {
    for (int i = 0; i < 3; ++i) {
      rule[next] = {Vec3::Constant(a), weight};
      rule[next++].barycentric[i] = 1 - 2 * a;
    }
  };
  add_corners(0.445948490915965, 0.223381589678011);
  add_corners(0.091576213509771, 0.109951743655322);
  return rule;
}

}  // namespace

const std::array<TetrahedronPoint, 4>& four_point_rule() {
  static const auto kRule = make_four_point_rule();
  return kRule;
}

const std::array<TetrahedronPoint, 14>& fourteen_point_rule() {
  static const auto kRule = make_fourteen_point_rule();
  return kRule;
}

const std::array<TrianglePoint, 6>& six_point_rule() {
  static const auto kRule = make_six_point_rule();
  return kRule;
}

Eigen::Matrix<double, kElementNodes, 1> quadratic_shape(const Eigen::Vector4d& l) {
  Eigen::Matrix<double, kElementNodes, 1> shape;
  for (int i = 0; i < 4; ++i) shape[i] = l[i] * (2 * l[i] - 1);
  for (int e = 0; e < 6; ++e) {
    shape[4 + e] = 4 * l[kTetrahedronEdges[e][0]] * l[kTetrahedronEdges[e][1]];
  }
  return shape;
}

Eigen::Matrix<double, kElementNodes, 3> quadratic_shape_gradient(const Eigen::Vector4d& l) {
  Eigen::Matrix<double, 4, 3> dl;  // ∂L/∂(L₁, L₂, L₃)
  dl << -1, -1, -1, Mat3::Identity();
  Eigen::Matrix<double, kElementNodes, 3> gradient;
  for (int i = 0; i < 4; ++i) gradient.row(i) = (4 * l[i] - 1) * dl.row(i);
  for (int e = 0; e < 6; ++e) {
    const auto& [a, b] = kTetrahedronEdges[e];
    gradient.row(4 + e) = 4 * (l[a] * dl.row(b) + l[b] * dl.row(a));
  }
  return gradient;
}

Eigen::Matrix<double, kFaceNodes, 1> face_shape(const Vec3& l) {
  Eigen::Matrix<double, kFaceNodes, 1> shape;
  for (int i = 0; i < 3; ++i) {
    shape[i] = l[i] * (2 * l[i] - 1);
    shape[3 + i] = 4 * l[i] * l[(i + 1) % 3];
  }
  return shape;
}

Eigen::Matrix<double, kFaceNodes, 2> face_shape_gradient(const Vec3& l) {
  Eigen::Matrix<double, 3, 2> dl;
  dl << -1, -1, 1, 0, 0, 1;
  Eigen::Matrix<double, kFaceNodes, 2> gradient;
  for (int i = 0; i < 3; ++i) {
    const int next = (i + 1) % 3;
    gradient.row(i) = (4 * l[i] - 1) * dl.row(i);
    gradient.row(3 + i) = 4 * (l[i] * dl.row(next) + l[next] * dl.row(i));
  }
  return gradient;
}

}  // namespace palpate::deformation

#include "modules/geometry/continuous_collision.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace palpate::geometry {
namespace {

// Evaluating F at a corner adds up less than 64 roundings of numbers below the largest coordinate
// (each lerp ≤ 14 units of 2⁻⁵³ on top of its inputs; dyadic arguments are exact).
constexpr double kRoundings = 64;
constexpr double kRounding = kRoundings * 0.5 * std::numeric_limits<double>::epsilon();

/// 113 bits, by the compiler in software: unit of rounding 2⁻¹¹³.
__extension__ using Quad = __float128;
constexpr Quad kQuadRounding = kRoundings * 0x1p-113;

/// [lower, lower + width] per argument t, u, v; all dyadic.
struct ParameterBox {
  std::array<double, 3> lower{0, 0, 0};
  std::array<double, 3> width{1, 1, 1};
};

template <typename T, typename Number>
T lerp(const T& a, const T& b, Number fraction) {
  return a + fraction * (b - a);
}

struct PointTriangle {
  static constexpr bool kTriangular = true;
  template <typename T, typename Number>
  static T value(const std::array<T, 4>& x, Number u, Number v) {
    return x[0] - ((x[1] + u * (x[2] - x[1])) + v * (x[3] - x[1]));
  }
};

struct EdgeEdge {
  static constexpr bool kTriangular = false;
  template <typename T, typename Number>
  static T value(const std::array<T, 4>& x, Number u, Number v) {
    return lerp(x[0], x[1], u) - lerp(x[2], x[3], v);
  }
};

template <typename Pair>
class RootSearch {
 public:
  RootSearch(const FourPoints& start, const FourPoints& end, double separation)
      : start_(start), end_(end), quads_left_(separation > 0 ? 0 : kMaxQuadTests) {
    double extent = 0;
    for (const FourPoints* points : {&start, &end}) {
      for (const Vec3& x : *points) {
        largest_ = std::max(largest_, x.cwiseAbs().maxCoeff());
        extent = std::max(extent, (x - start[0]).cwiseAbs().maxCoeff());
      }
    }
    reach_ = separation + kRounding * largest_;
    tolerance_ = std::max(kImpactTolerance * extent, separation);
    set_slopes();
    set_directions();
  }

  std::optional<Impact> run() {
    std::array<ParameterBox, 256> stack;  // depth first: at most one waiting box per halving
    std::size_t waiting = 1;
    stack[0] = ParameterBox();
    std::optional<Impact> earliest;
    int visited = 0;
    while (waiting > 0) {
      const ParameterBox box = stack[--waiting];
      if (earliest && box.lower[0] >= earliest->time) continue;
      const bool undecided = ++visited > kMaxImpactBoxes || waiting + 2 > stack.size();
      bool is_small = false;
      if (!may_hold_root(box, is_small)) continue;
      if (is_small || undecided) {
        earliest = Impact{box.lower[0], box.lower[1], box.lower[2]};
        continue;
      }
      const int split = widest(box);
      ParameterBox early = box;
      early.width[split] *= 0.5;
      ParameterBox late = early;
      late.lower[split] += early.width[split];
      stack[waiting++] = late;
      stack[waiting++] = early;
    }
    return earliest;
  }

 private:
  /// Largest change of F per unit of each argument, for choosing which to halve.
  void set_slopes() {
    for (int k = 0; k < 4; ++k) {
      slopes_[0] = std::max(slopes_[0], (end_[k] - start_[k]).cwiseAbs().maxCoeff());
    }
    for (const FourPoints* x : {&start_, &end_}) {
      const Vec3 corner = Pair::value(*x, 0.0, 0.0);
      slopes_[1] = std::max(slopes_[1], (Pair::value(*x, 1.0, 0.0) - corner).cwiseAbs().maxCoeff());
      slopes_[2] = std::max(slopes_[2], (Pair::value(*x, 0.0, 1.0) - corner).cwiseAbs().maxCoeff());
    }
  }

  /// Across each two of F's slopes: along them its hull over a box of slender or oblique features
  /// is far smaller than along the axes.
  void set_directions() {
    FourPoints middle;
    for (int k = 0; k < 4; ++k) middle[k] = lerp(start_[k], end_[k], 0.5);
    const Vec3 at = Pair::value(middle, 0.5, 0.5);
    const Vec3 t = Pair::value(end_, 0.5, 0.5) - Pair::value(start_, 0.5, 0.5);
    const Vec3 u = Pair::value(middle, 1.0, 0.5) - at, v = Pair::value(middle, 0.5, 1.0) - at;
    directions_ = {u.cross(v).normalized(), v.cross(t).normalized(), t.cross(u).normalized()};
    for (Vec3& direction : directions_) {
      if (!direction.allFinite()) direction.setZero();  // tells nothing apart
    }
  }

  bool may_hold_root(const ParameterBox& box, bool& is_small) {
    if (Pair::kTriangular && box.lower[1] + box.lower[2] > 1) return false;
    std::array<Vec3, 8> values;
    for (int side = 0; side < 2; ++side) {
      const double t = box.lower[0] + side * box.width[0];
      FourPoints x;
      for (int k = 0; k < 4; ++k) x[k] = lerp(start_[k], end_[k], t);
      for (int corner = 0; corner < 4; ++corner) {
        values[4 * side + corner] = Pair::value(x, box.lower[1] + (corner & 1) * box.width[1],
                                                box.lower[2] + (corner >> 1) * box.width[2]);
      }
    }
    Vec3 lowest = values[0], highest = values[0];
    for (const Vec3& value : values) {
      lowest = lowest.cwiseMin(value);
      highest = highest.cwiseMax(value);
    }
    is_small = (highest - lowest).maxCoeff() <= tolerance_;
    if ((lowest.array() > reach_).any() || (highest.array() < -reach_).any()) return false;
    for (const Vec3& direction : directions_) {
      double least = direction.dot(values[0]), greatest = least;
      for (const Vec3& value : values) {
        least = std::min(least, direction.dot(value));
        greatest = std::max(greatest, direction.dot(value));
      }
      if (least > kAcross * reach_ || greatest < -kAcross * reach_) return false;
    }
    for (int axis = 0; axis < 3; ++axis) {
      const bool is_rounding = lowest[axis] >= -reach_ || highest[axis] <= reach_;
      if (is_rounding && quads_left_-- > 0 && misses_zero(box, axis)) return false;
    }
    return true;
  }

  /// The same along one axis, decided with 60 bits more.
  bool misses_zero(const ParameterBox& box, int axis) const {
    const Quad reach = kQuadRounding * largest_;
    bool above = true, below = true;
    for (int side = 0; side < 2; ++side) {
      const Quad t = Quad(box.lower[0]) + side * Quad(box.width[0]);
      std::array<Quad, 4> x;
      for (int k = 0; k < 4; ++k) x[k] = lerp(Quad(start_[k][axis]), Quad(end_[k][axis]), t);
      for (int corner = 0; corner < 4; ++corner) {
        const Quad u = Quad(box.lower[1]) + (corner & 1) * Quad(box.width[1]);
        const Quad v = Quad(box.lower[2]) + (corner >> 1) * Quad(box.width[2]);
        const Quad value = Pair::value(x, u, v);
        above = above && value > reach;
        below = below && value < -reach;
      }
    }
    return above || below;
  }

  int widest(const ParameterBox& box) const {
    int best = 0;
    for (int k = 1; k < 3; ++k) {
      if (box.width[k] * slopes_[k] > box.width[best] * slopes_[best]) best = k;
    }
    return best;
  }

  /// Along a unit vector a value is off by less than √3 times what it is along each axis, and the
  /// roundings of the product.
  static constexpr double kAcross = 3;

  const FourPoints& start_;
  const FourPoints& end_;
  int quads_left_ = 0;    ///< of kMaxQuadTests
  double largest_ = 0;    ///< coordinate [m]
  double reach_ = 0;      ///< [m]
  double tolerance_ = 0;  ///< [m]
  std::array<double, 3> slopes_{0, 0, 0};
  std::array<Vec3, 3> directions_;
};

}  // namespace

std::optional<Impact> point_triangle_impact(const FourPoints& start, const FourPoints& end,
                                            double separation) {
  return RootSearch<PointTriangle>(start, end, separation).run();
}

std::optional<Impact> edge_edge_impact(const FourPoints& start, const FourPoints& end,
                                       double separation) {
  return RootSearch<EdgeEdge>(start, end, separation).run();
}

double gap_along(const Vec3& direction, std::size_t first_count, const FourPoints& x) {
  double first = -std::numeric_limits<double>::infinity(), second = -first;
  for (std::size_t k = 0; k < x.size(); ++k) {
    // About a node of the pair, so that pairs far from the origin keep their digits.
    const double height = direction.dot(x[k] - x[0]);
    if (k < first_count) {
      first = std::max(first, height);
    } else {
      second = std::min(second, height);
    }
  }
  return second - first;
}

}  // namespace palpate::geometry

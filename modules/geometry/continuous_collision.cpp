#include "modules/geometry/continuous_collision.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace palpate::geometry {
namespace {

// Evaluating F at a corner adds up less than 64 roundings of numbers below the largest coordinate
// (each lerp ≤ 14 units of 2⁻⁵³ on top of its inputs; dyadic arguments are exact).
constexpr double kRounding = 64 * 0.5 * std::numeric_limits<double>::epsilon();

/// [lower, lower + width] per argument t, u, v; all dyadic.
struct ParameterBox {
  std::array<double, 3> lower{0, 0, 0};
  std::array<double, 3> width{1, 1, 1};
};

Vec3 lerp(const Vec3& a, const Vec3& b, double fraction) { return a + fraction * (b - a); }

struct PointTriangle {
  static constexpr bool kTriangular = true;
  static Vec3 value(const FourPoints& x, double u, double v) {
    return x[0] - ((x[1] + u * (x[2] - x[1])) + v * (x[3] - x[1]));
  }
};

struct EdgeEdge {
  static constexpr bool kTriangular = false;
  static Vec3 value(const FourPoints& x, double u, double v) {
    return lerp(x[0], x[1], u) - lerp(x[2], x[3], v);
  }
};

template <typename Pair>
class RootSearch {
 public:
  RootSearch(const FourPoints& start, const FourPoints& end, double separation)
      : start_(start), end_(end) {
    double largest = 0, extent = 0;
    for (const FourPoints* points : {&start, &end}) {
      for (const Vec3& x : *points) {
        largest = std::max(largest, x.cwiseAbs().maxCoeff());
        extent = std::max(extent, (x - start[0]).cwiseAbs().maxCoeff());
      }
    }
    reach_ = separation + kRounding * largest;
    tolerance_ = std::max(kImpactTolerance * extent, separation);
    set_slopes();
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
      const Vec3 corner = Pair::value(*x, 0, 0);
      slopes_[1] = std::max(slopes_[1], (Pair::value(*x, 1, 0) - corner).cwiseAbs().maxCoeff());
      slopes_[2] = std::max(slopes_[2], (Pair::value(*x, 0, 1) - corner).cwiseAbs().maxCoeff());
    }
  }

  bool may_hold_root(const ParameterBox& box, bool& is_small) const {
    if (Pair::kTriangular && box.lower[1] + box.lower[2] > 1) return false;
    Vec3 lowest = Vec3::Constant(std::numeric_limits<double>::infinity()), highest = -lowest;
    for (int side = 0; side < 2; ++side) {
      const double t = box.lower[0] + side * box.width[0];
      FourPoints x;
      for (int k = 0; k < 4; ++k) x[k] = lerp(start_[k], end_[k], t);
      for (int corner = 0; corner < 4; ++corner) {
        const Vec3 value = Pair::value(x, box.lower[1] + (corner & 1) * box.width[1],
                                       box.lower[2] + (corner >> 1) * box.width[2]);
        lowest = lowest.cwiseMin(value);
        highest = highest.cwiseMax(value);
      }
    }
    is_small = (highest - lowest).maxCoeff() <= tolerance_;
    return (lowest.array() <= reach_).all() && (highest.array() >= -reach_).all();
  }

  int widest(const ParameterBox& box) const {
    int best = 0;
    for (int k = 1; k < 3; ++k) {
      if (box.width[k] * slopes_[k] > box.width[best] * slopes_[best]) best = k;
    }
    return best;
  }

  const FourPoints& start_;
  const FourPoints& end_;
  double reach_ = 0;      ///< [m]
  double tolerance_ = 0;  ///< [m]
  std::array<double, 3> slopes_{0, 0, 0};
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

}  // namespace palpate::geometry

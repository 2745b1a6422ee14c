#include "deformation/contact/outer_seat.h"

#include <algorithm>
#include <vector>

#include "modules/geometry/closest_points.h"
#include "modules/geometry/winding_number.h"

namespace palpate::deformation {
namespace {

constexpr double kOff = 1e-6;          ///< so far beyond a core its wall is put, at first [m]
constexpr double kMostOff = 3e-5;      ///< … each round twice as far, up to this [m]
constexpr int kMostSeatings = 24;      ///< rounds over all cores
constexpr std::size_t kMostWays = 32;  ///< out of a wall that are looked at

bool is_inside(const Vec3& p, const Body& body, std::span<const Vec3> positions) {
  return geometry::winding_number(p, positions.first(body.surface_node_count), body.triangles) >
         0.5;
}

/// Where the wall cuts a core, as fractions of it, and its ends; ascending.
std::vector<double> cuts_of(const CoreLine& core, const Body& body,
                            std::span<const Vec3> positions) {
  std::vector<double> cuts{0, 1};
  const Vec3 along = core.b - core.a;
  if (along.isZero(0)) return cuts;
  const Vec3 low = core.a.cwiseMin(core.b), high = core.a.cwiseMax(core.b);
  for (const geometry::Triangle& t : body.triangles) {
    const geometry::TriangleCorners x{positions[t[0]], positions[t[1]], positions[t[2]]};
    const Vec3 from = x[0].cwiseMin(x[1]).cwiseMin(x[2]), to = x[0].cwiseMax(x[1]).cwiseMax(x[2]);
    if ((from.array() > high.array()).any() || (to.array() < low.array()).any()) continue;
    const auto pair = geometry::closest_of_segment_and_triangle(core.a, core.b, x);
    if (pair.distance == 0)
      cuts.push_back(along.dot(pair.on_segment - core.a) / along.squaredNorm());
  }
  std::ranges::sort(cuts);
  return cuts;
}

/// Ends of a core that are inside, and middles of its pieces that are: between two cuts it is on
/// one side.
void append_inside(const CoreLine& core, const Body& body, std::span<const Vec3> positions,
                   std::vector<Vec3>& places) {
  const auto append = [&](double at) {
    const Vec3 place = core.a + at * (core.b - core.a);
    if (is_inside(place, body, positions)) places.push_back(place);
  };
  const std::vector<double> cuts = cuts_of(core, body, positions);
  append(0);
  append(1);
  for (std::size_t i = 1; i < cuts.size(); ++i) append((cuts[i - 1] + cuts[i]) / 2);
}

/// Where a triangle is nearest to a point behind it.
struct NearPlace {
  const geometry::Triangle* nodes = nullptr;
  Vec3 weights = Vec3::Zero();
  Vec3 way = Vec3::Zero();  ///< from there to the point [m]
  double distance = 0;      ///< [m]
};

/// Ascending by distance.
std::vector<NearPlace> places_behind(const Vec3& p, const Body& body,
                                     std::span<const Vec3> positions) {
  std::vector<NearPlace> places;
  for (const geometry::Triangle& t : body.triangles) {
    const geometry::TriangleCorners x{positions[t[0]], positions[t[1]], positions[t[2]]};
    if (!(geometry::unit_normal(x).dot(p - x[0]) < 0)) continue;
    const auto at = geometry::closest_on_triangle(p, x);
    const Vec3 way = p - at.point;
    if (way.norm() > 0) places.push_back({&t, at.weights, way, way.norm()});
  }
  std::ranges::sort(places, {}, &NearPlace::distance);
  return places;
}

/// The nearest place beyond which it is outside: where a wall is folded over itself that is not the
/// nearest wall.
/// @param along  the way a wall there was moved before: a ridge on a core is not moved to and fro
NearPlace nearest_way_out(const Vec3& p, double off, const Vec3& along, const Body& body,
                          std::span<const Vec3> positions) {
  auto places = places_behind(p, body, positions);
  std::erase_if(places, [&](const NearPlace& place) { return place.way.dot(along) < 0; });
  places.resize(std::min(places.size(), kMostWays));
  for (const NearPlace& place : places) {
    if (!is_inside(p - place.way * (1 + off / place.distance), body, positions)) return place;
  }
  return places.empty() ? NearPlace{} : places[0];
}

/// The nearest place comes to the point, and what is around it along with it, less with the
/// distance: so slowly that no tissue is turned inside out.
void move_to(const NearPlace& wall, double off, const Body& body, std::span<Vec3> positions) {
  if (wall.nodes == nullptr) return;
  Vec3 place = Vec3::Zero(), shares = Vec3::Zero();
  for (int k = 0; k < 3; ++k) place += wall.weights[k] * positions[(*wall.nodes)[k]];
  double reach = 4 * wall.distance;
  for (const std::uint32_t node : *wall.nodes) {
    reach = std::max(reach, 2 * (positions[node] - place).norm());
  }
  const auto share_of = [&](std::size_t node) {
    const double away = (positions[node] - place).squaredNorm() / (reach * reach);
    return away < 1 && body.inverse_masses[node] > 0 ? (1 - away) * (1 - away) : 0.0;
  };
  for (int k = 0; k < 3; ++k) shares[k] = share_of((*wall.nodes)[k]);
  const double share = wall.weights.dot(shares);
  if (!(share > 0)) return;  // held
  const Vec3 way = wall.way * ((1 + off / wall.distance) / share);
  for (std::size_t i = 0; i < positions.size(); ++i) positions[i] += share_of(i) * way;
}

/// Where walls were moved, and which way.
class Moves {
 public:
  void add(const Vec3& place, const Vec3& way) { moves_.push_back({place, way}); }
  /// Zero: none yet.
  Vec3 nearest_to(const Vec3& p) const {
    const auto nearest = std::ranges::min_element(
        moves_, {}, [&](const Move& move) { return (move.place - p).squaredNorm(); });
    return nearest == moves_.end() ? Vec3::Zero() : nearest->way;
  }

 private:
  struct Move {
    Vec3 place, way;
  };
  std::vector<Move> moves_;
};

}  // namespace

bool are_outside(std::span<const CoreLine> cores, const Body& body,
                 std::span<const Vec3> positions) {
  std::vector<Vec3> inside;
  for (const CoreLine& core : cores) append_inside(core, body, positions, inside);
  return inside.empty();
}

bool seat_outside(std::span<const CoreLine> cores, const Body& body, std::span<Vec3> positions) {
  double off = kOff;
  std::vector<Vec3> inside;
  Moves moves;
  for (int round = 0; round <= kMostSeatings; ++round, off = std::min(2 * off, kMostOff)) {
    inside.clear();
    for (const CoreLine& core : cores) append_inside(core, body, positions, inside);
    if (inside.empty()) return true;
    if (round == kMostSeatings) break;
    for (const Vec3& p : inside) {
      if (!is_inside(p, body, positions)) continue;  // what moved another took it along
      const NearPlace wall = nearest_way_out(p, off, moves.nearest_to(p), body, positions);
      moves.add(p, wall.way);
      move_to(wall, off, body, positions);
    }
  }
  return false;
}

}  // namespace palpate::deformation

#include "deformation/contact/confined_motion.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "modules/geometry/edge_uses.h"

namespace palpate::deformation {
namespace {

/// Of growing zones before all is held.
constexpr int kMostRounds = 16;

/// Nodes of all surfaces in one row, joined into zones.
class Zones {
 public:
  explicit Zones(std::span<const MovingSurface> surfaces)
      : surfaces_(surfaces), sets_(count(surfaces)), ways_(count(surfaces)) {
    for (const MovingSurface& surface : surfaces) {
      first_.push_back(first_.empty() ? 0 : first_.back() + size_);
      size_ = surface.start.size();
      for (std::size_t i = 0; i < size_; ++i) {
        ways_[first_.back() + i] = surface.end[i] - surface.start[i];
      }
    }
  }

  void join(const collision::FeaturePair& pair) {
    const auto place = [&](std::size_t k) {
      return static_cast<std::uint32_t>(first_[pair.surface_of(k)] + pair.nodes[k]);
    };
    for (std::size_t k = 1; k < pair.nodes.size(); ++k) sets_.join(place(0), place(k));
  }

  /// Ends of all nodes: those of a zone go along, all others go their own way.
  void move() {
    std::vector<Zone> zones(ways_.size());
    each_node([&](const MovingSurface& surface, std::size_t i, std::uint32_t place) {
      Zone& zone = zones[sets_.root(place)];
      zone.way += surface.body->masses[i] * ways_[place];
      zone.mass += surface.body->masses[i];
      ++zone.nodes;
      zone.fixed |= surface.body->inverse_masses[i] == 0;
    });
    each_node([&](const MovingSurface& surface, std::size_t i, std::uint32_t place) {
      const Zone& zone = zones[sets_.root(place)];
      if (zone.nodes < 2) return;
      surface.end[i] = surface.start[i];
      if (!zone.fixed) surface.end[i] += zone.way / zone.mass;
    });
  }

 private:
  struct Zone {
    Vec3 way = Vec3::Zero();  ///< times mass
    double mass = 0;
    std::size_t nodes = 0;
    bool fixed = false;
  };

  static std::size_t count(std::span<const MovingSurface> surfaces) {
    std::size_t sum = 0;
    for (const MovingSurface& surface : surfaces) sum += surface.start.size();
    return sum;
  }

  template <class Visit>
  void each_node(Visit visit) const {
    for (std::size_t s = 0; s < surfaces_.size(); ++s) {
      for (std::size_t i = 0; i < surfaces_[s].start.size(); ++i) {
        visit(surfaces_[s], i, static_cast<std::uint32_t>(first_[s] + i));
      }
    }
  }

  std::span<const MovingSurface> surfaces_;
  std::vector<std::size_t> first_;
  std::size_t size_ = 0;
  geometry::DisjointSets sets_;
  std::vector<Vec3> ways_;  ///< asked for [m]
};

bool is_complete(std::span<const MovingSurface> surfaces) {
  return std::all_of(surfaces.begin(), surfaces.end(), [](const MovingSurface& surface) {
    return farthest_travel(surface.searched, surface.end, surface.together) <= surface.travel;
  });
}

std::vector<const StepPair*> meeting(std::span<const StepPair> pairs,
                                     std::span<const MovingSurface> surfaces) {
  std::vector<const StepPair*> found;
  for (const StepPair& step : pairs) {
    collision::FourPoints end;
    for (std::size_t k = 0; k < end.size(); ++k) {
      end[k] = surfaces[step.pair.surface_of(k)].end[step.pair.nodes[k]];
    }
    if (!collision::stays_apart(step.pair.is_edges, step.start, end, step.separation,
                                kLeastDistance)) {
      found.push_back(&step);
    }
  }
  return found;
}

}  // namespace

double farthest_travel(std::span<const Vec3> origins, std::span<const Vec3> positions,
                       const Vec3& together) {
  double squared = 0;
  bool finite = true;
  for (std::size_t i = 0; i < origins.size(); ++i) {
    const double way = (positions[i] - origins[i] - together).squaredNorm();
    finite &= std::isfinite(way);
    squared = std::max(squared, way);
  }
  return finite ? std::sqrt(squared) : std::numeric_limits<double>::infinity();
}

Confinement confine_motion(std::span<const StepPair> pairs,
                           std::span<const MovingSurface> surfaces) {
  if (!is_complete(surfaces)) return Confinement::kIncomplete;
  auto found = meeting(pairs, surfaces);
  if (found.empty()) return Confinement::kNone;
  Zones zones(surfaces);
  for (int round = 0; round < kMostRounds; ++round) {
    for (const StepPair* step : found) zones.join(step->pair);
    zones.move();
    if (!is_complete(surfaces)) return Confinement::kIncomplete;
    found = meeting(pairs, surfaces);
    if (found.empty()) return Confinement::kZones;
  }
  for (const MovingSurface& surface : surfaces) {
    std::copy(surface.start.begin(), surface.start.end(), surface.end.begin());
  }
  return Confinement::kHeld;
}

}  // namespace palpate::deformation

// A solid whose mesh follows the touch: what a change of the mesh costs and does. A sphere is
// pressed into a flat block, slides at constant depth, and circles; on a block that is the same
// everywhere the force is constant but for the mesh.
#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdio>
#include <limits>
#include <numbers>
#include <numeric>
#include <span>
#include <string>
#include <vector>

#include "deformation/contact/touch_follower.h"
#include "deformation/model/following_mesh.h"
#include "modules/core/error.h"
#include "modules/runtime/program.h"
#include "modules/scene/models.h"
#include "studies/report/measures.h"
#include "studies/rigs/slid_block.h"

using namespace palpate;

namespace {

constexpr double kYoungsModulus = 5e3, kDensity = 1060, kDrag = 40;  // [Pa], [kg/m³], [1/s]

constexpr std::array kAngles{0.0, 45.0, 90.0};

struct Options {
  double rate = 100, radius_mm = 8, depth_mm = 4, force_error = 0.1;
  double edge_mm = 14;
  std::string model = "nodal_pressure";
  int budget = 0, changes = 0;
  bool rocks = false;
  std::vector<double> speeds{5, 10, 20, 40};  // [mm/s]
};

rigs::SmallEdges wanted(const Options& options) {
  using scene::Refinement;
  const double radius = 1e-3 * options.radius_mm;
  if (scene::is_quadratic(options.model)) {
    return {deformation::quadratic_edge_over_radius(options.force_error) * radius,
            Refinement::kQuadraticGrowth};
  }
  return {deformation::edge_over_radius(options.force_error) * radius, Refinement::kGrowth};
}

scene::Organ organ_of(const Options& options, bool follows) {
  scene::Organ organ;
  organ.model = options.model;
  organ.tissue.youngs_modulus = kYoungsModulus;
  organ.tissue.density = kDensity;
  organ.tissue.drag = kDrag;
  organ.solid.refine.follow = follows;
  if (follows) {
    organ.solid.refine.edge_length = wanted(options).edge;
    organ.solid.refine.growth = wanted(options).growth;
  }
  if (options.budget > 0) {
    organ.solid.refine.nodes = static_cast<std::size_t>(options.budget);
  }
  return organ;
}

/// @param follows  or the mesh is as fine all along the way and never changes
rigs::BlockSlide slide_of(const Options& options, bool follows, double degrees) {
  rigs::BlockSlide slide;
  slide.rate = options.rate;
  slide.radius = 1e-3 * options.radius_mm;
  slide.depth = 1e-3 * options.depth_mm;
  slide.coarse_edge = 1e-3 * options.edge_mm;
  slide.direction = degrees * std::numbers::pi / 180;
  if (!follows) slide.small = wanted(options);
  return slide;
}

class Slide {
 public:
  Slide(const Options& options, bool follows, double angle)
      : depth_(1e-3 * options.depth_mm),
        block_(slide_of(options, follows, angle), organ_of(options, follows)) {}

  /// Above the start of the way, then down.
  void start() {
    block_.go(block_.at(-rigs::BlockSlide::kHalfWay, -4e-3), 40e-3);
    block_.go(block_.at(-rigs::BlockSlide::kHalfWay, depth_), 10e-3);
    costs.clear();
  }
  /// One period. @returns the force upwards [N]
  double step(const Vec3& to) {
    const double before = pressed().busy();
    const double force = block_.step(to);
    costs.push_back(pressed().busy() - before);
    return force;
  }
  Vec3 at(double way) const { return block_.at(way, depth_); }
  /// Off the way, from the block's middle [m].
  Vec3 at(double x, double y) const { return block_.at(0, depth_) + Vec3(x, y, 0); }
  void go(const Vec3& to, double speed) { block_.go(to, speed); }
  rigs::PressedOrgan& pressed() { return block_.pressed(); }
  const geometry::OrganShape& shape() const { return block_.shape(); }

  std::vector<double> costs;  // of deformation, by period [s]

 private:
  double depth_;
  rigs::SlidBlock block_;
};

/// Slides at each speed over a way of which the first tenth is not looked at.
void measure(const Options& options, bool follows, double angle) {
  constexpr double kWay = 2 * rigs::BlockSlide::kHalfWay;  // [m]
  Slide slide(options, follows, angle);
  for (const double speed : options.speeds) {
    slide.start();
    std::vector<double> forces;
    const std::uint32_t first = slide.pressed().generation();
    double at_change = 0, other = 0;
    std::uint32_t generation = first;
    int since = 100;
    const int steps = static_cast<int>(1e3 * kWay * options.rate / speed);
    for (int k = 1; k <= steps; ++k) {
      const double way = kWay * k / steps;
      const double force = slide.step(slide.at(way - kWay / 2));
      const std::uint32_t now = slide.pressed().generation();
      since = now != generation ? 0 : since + 1;
      generation = now;
      if (way <= kWay / 10) continue;
      if (!forces.empty()) {
        double& most = since <= 1 ? at_change : other;
        most = std::max(most, std::abs(force / forces.back() - 1));
      }
      forces.push_back(force);
    }
    const double mean =
        std::accumulate(forces.begin(), forces.end(), 0.0) / static_cast<double>(forces.size());
    const auto [low, high] = std::ranges::minmax(forces);
    std::printf("%-8s %9.0f %5.0f %6zu %8u %8.4f %7.2f %% %7.2f %% %7.2f %% %7.2f %8.2f\n",
                follows ? "follows" : "fine", angle, speed, slide.pressed().node_count(),
                generation - first, mean, 100 * (high - low) / mean, 100 * at_change, 100 * other,
                1e3 * report::median(slide.costs), 1e3 * report::quantile(slide.costs, 0.999));
    std::fflush(stdout);
  }
}

/// All bits of a run, for another to be compared with.
class Fingerprint {
 public:
  void add(double x) {
    hash_ = (hash_ ^ std::bit_cast<std::uint64_t>(x)) * 0x100000001b3;  // FNV-1a, word by word
    hash_ ^= hash_ >> 32;
  }
  void add(const Vec3& x) {
    for (const double part : x) add(part);
  }
  std::uint64_t value() const { return hash_; }

 private:
  std::uint64_t hash_ = 0xcbf29ce484222325;
};

/// Whether the mesh it has is the one that a mesh without a past has for these places.
bool is_as_fresh(const rigs::PressedOrgan& pressed, const geometry::OrganShape& coarse,
                 std::span<const deformation::TouchedPlace> places,
                 const scene::Refinement& refine) {
  const bool quadratic = !coarse.edge_nodes.empty();
  deformation::FollowingMesh fresh(
      coarse, *refine.growth,
      refine.nodes.value_or(quadratic ? scene::Refinement::kQuadraticNodes
                                      : scene::Refinement::kNodes));
  const auto made = fresh.fine_at(places).shape;
  if (made.node_count() != pressed.node_count()) return false;
  for (std::size_t i = 0; i < made.node_count(); ++i) {
    if (made.node(i) != pressed.rest_position(i)) return false;
  }
  return made.surface.triangles == pressed.model().triangles;
}

/// What happened while the mesh changed some times.
struct Tally {
  double most_energy = 0, least_energy = std::numeric_limits<double>::infinity();  // [J]
  std::vector<double> forces;                                                      // [N]
};

void print(int changes, const rigs::PressedOrgan& pressed, const Tally& tally) {
  const double middle = report::median(tally.forces);
  double most = 0;
  std::size_t outstanding = 0;
  for (const double force : tally.forces) {
    const double off = std::abs(force / middle - 1);
    most = std::max(most, off);
    outstanding += off > 0.1;
  }
  std::printf("%9d %9.1f %12.5f %12.5f %9.4f %7.1f %% %7.2f %% %9.1e %5s %5s\n", changes,
              pressed.time(), 1e3 * tally.least_energy, 1e3 * tally.most_energy, middle, 100 * most,
              100 * static_cast<double>(outstanding) / static_cast<double>(tally.forces.size()),
              pressed.volume_error(), pressed.lacks_contacts() ? "yes" : "no",
              pressed.diverged() ? "yes" : "no");
  std::fflush(stdout);
}

/// Round and round, or to and fro by so little that the mesh just changes, until it has changed so
/// often.
/// @param tenths  of the changes that are made
/// @returns all bits of the first tenth
std::uint64_t change(const Options& options, std::uint32_t tenths) {
  constexpr double kCircle = 10e-3;                // [m]
  const double rock = 0.5e-3 * options.radius_mm;  // [m]: there and back, R/4 each
  constexpr std::uint32_t kFreshEvery = 50;        // changes
  const bool is_told = tenths > 1;
  const auto wanted_changes = static_cast<std::uint32_t>(options.changes);
  const double speed = 1e-3 * (options.speeds.size() == 1 ? options.speeds[0] : 40);
  const double size = options.rocks ? rock / 2 : kCircle;
  Slide slide(options, true, 0);
  rigs::PressedOrgan& pressed = slide.pressed();
  const auto at = [&](double angle) {
    return options.rocks ? slide.at(size * std::cos(angle), 0.0)
                         : slide.at(size * std::cos(angle), size * std::sin(angle));
  };
  slide.go(at(0) + Vec3(0, 0, 10e-3), 40e-3);
  slide.go(at(0), 10e-3);
  if (is_told) {
    std::printf("%9s %9s %12s %12s %9s %9s %9s %9s %5s %5s\n", "changes", "time s", "least E [mJ]",
                "most E", "middle N", "most off", "over 10%", "|V-V*|/V*", "lost", "reset");
  }
  const double turn = speed / size / options.rate;
  const std::uint32_t first = slide.pressed().generation();
  std::uint32_t changes = 0, told = 0;
  int fresh = 0, looked_at = 0;
  Fingerprint bits;
  Tally tally;
  std::vector<deformation::TouchedPlace> places;
  for (double angle = turn; changes < tenths * wanted_changes / 10; angle += turn) {
    places.assign(pressed.touched_places().begin(), pressed.touched_places().end());
    tally.forces.push_back(slide.step(at(angle)));
    const auto reading = pressed.read();
    const double energy = reading.kinetic_energy + pressed.elastic_energy();
    tally.most_energy = std::max(tally.most_energy, energy);
    tally.least_energy = std::min(tally.least_energy, energy);
    if (told == 0) {
      for (std::size_t i = 0; i < pressed.node_count(); ++i) bits.add(pressed.position(i));
    }
    const std::uint32_t now = slide.pressed().generation() - first;
    if (now != changes && now / kFreshEvery != changes / kFreshEvery && is_told) {
      ++looked_at;
      fresh += is_as_fresh(pressed, slide.shape(), places, organ_of(options, true).solid.refine);
    }
    changes = now;
    if (changes < told + wanted_changes / 10) continue;
    if (is_told) print(static_cast<int>(changes), pressed, tally);
    told = changes;
    tally = {};
  }
  if (is_told) {
    std::printf("%d of %d meshes looked at are those that a fresh one has there\n", fresh,
                looked_at);
  }
  return bits.value();
}

int run(const Options& options) {
  if (options.changes > 0) {
    const bool same = change(options, 10) == change(options, 1);
    std::printf("a second run of the first tenth: %s\n", same ? "the same bits" : "OTHER BITS");
    return same ? kExitDone : kExitFailed;
  }
  std::printf("%-8s %9s %5s %6s %8s %8s %9s %9s %9s %7s %8s\n", "mesh", "direction", "mm/s",
              "nodes", "changes", "mean N", "ripple", "at change", "other", "ms", "p99.9");
  for (const double angle : kAngles) {
    for (const bool follows : {true, false}) measure(options, follows, angle);
  }
  return kExitDone;
}

}  // namespace

int main(int argc, char** argv) {
  runtime::Program program("A solid whose mesh follows the touch: what a change costs and does.",
                           "palpate-bench-following");
  Options options;
  program.add("--rate", options.rate, "Of deformation [Hz]").range(10, 1000).shows_default();
  program.add("--radius-mm", options.radius_mm, "Of the sphere").range(0.5, 20).shows_default();
  program.add("--depth-mm", options.depth_mm, "Of the slide").range(0.5, 20).shows_default();
  program.add("--force-error", options.force_error, "Asked for").range(0.01, 1).shows_default();
  program
      .add("--changes", options.changes,
           "Circles of 20 mm instead, until the mesh has changed so often")
      .range(10, 1e6);
  program.flag("--rock", options.rocks, "Then to and fro by half the radius, not round");
  program.add("--speed", options.speeds, "Of the slide, or one of the circle (usually 40) [mm/s]")
      .range(1, 500)
      .shows_default();
  program.add("--nodes", options.budget, "At most; 0: what is usual").range(0, 50000);
  program.add("--model", options.model, "Which")
      .one_of({"nodal_pressure", "corotational", "quadratic_pressure"})
      .shows_default();
  program.add("--edge-mm", options.edge_mm, "Of the coarse block").range(2, 50).shows_default();
  return program.run(argc, argv, [&] { return run(options); });
}

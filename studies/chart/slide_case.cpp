// A block under a sphere that slides at constant depth: what is felt of the mesh.
#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "modules/scene/region.h"
#include "studies/chart/case_parts.h"
#include "studies/chart/reference_solutions.h"
#include "studies/rigs/slid_block.h"
#include "studies/truth/force_truth.h"

namespace palpate::chart {
namespace {

constexpr double kSlideSpeed = 10e-3, kApproach = 20e-3;  // [m/s]
constexpr double kHalfWay = 20e-3, kStride = 1e-3;        // ±, and between samples [m]
constexpr double kSlideDrag = 40;                         // [1/s]
constexpr std::size_t kRoom = 20'000;                     // nodes; so that no edge is longer
constexpr std::array kTruePlaces{0.0, 10e-3, 20e-3};      // from the middle [m]

constexpr rigs::BlockSlide kSlide;

/// Of the way, by the truth's places on its one half: the block is as long on the other.
double between_places(const std::array<double, kTruePlaces.size()>& values, double way) {
  const double at = std::abs(way) / (kTruePlaces[1] - kTruePlaces[0]);
  const auto low = std::min(static_cast<std::size_t>(at), kTruePlaces.size() - 2);
  const double part = at - static_cast<double>(low);
  return (1 - part) * values[low] + part * values[low + 1];
}

}  // namespace

Measurement measure_slide(const Setting& setting, const KeepGoing& keep_going) {
  rigs::BlockSlide slide = kSlide;
  slide.rate = setting.rate;
  if (setting.small == Small::kNowhere)
    slide.coarse_edge = std::ldexp(kSlide.coarse_edge, -setting.level);
  const double volume = 0.12 * 0.12 * 0.05;
  scene::Organ organ = solid_organ(setting, std::cbrt(3 * volume / (4 * M_PI)), kVirtualNodes,
                                   kYoungsModulus, kDensity);
  organ.tissue.drag = kSlideDrag;
  if (setting.small != Small::kNowhere) {
    const SmallTetrahedra wanted = small_tetrahedra(setting);
    if (setting.small == Small::kAtPlaces) {
      slide.small = {wanted.edge * slide.radius, wanted.growth};
    } else {
      organ.solid.refine.follow = true;
      organ.solid.refine.edge_length = wanted.edge * slide.radius;
      organ.solid.refine.growth = wanted.growth;
      organ.solid.refine.nodes = kRoom;
    }
  }
  rigs::SlidBlock block(slide, organ);
  keep_going();
  block.go(block.at(-slide.kHalfWay, -4e-3), kApproach);
  block.go(block.at(-slide.kHalfWay, slide.depth), kApproach);
  const double per_step = kSlideSpeed * block.pressed().period();
  std::vector<Sample> samples;
  double next = -kHalfWay;
  for (double way = -slide.kHalfWay; next < kHalfWay + kStride / 2;) {
    keep_going();
    way += per_step;
    const double force = block.step(block.at(way, slide.depth));
    if (way < next - per_step / 2) continue;
    Sample& sample = samples.emplace_back();
    sample.load = next;
    sample.force = force;
    next += kStride;
  }
  Measurement result = summary(block.pressed(), block.shape());
  result.surface_nodes = block.pressed().model().surface_node_count;
  result.inner_nodes = block.pressed().node_count() - result.surface_nodes;
  result.is_course = true;
  result.samples = samples;
  return result;
}

Measurement truth_of_slide(int, const KeepGoing& keep_going) {
  const auto base = rigs::slid_block_base();
  const truth::Body body{rigs::coarse_block(kSlide.coarse_edge),
                         {kYoungsModulus, kPoissonRatio},
                         [&](const Vec3& x) { return scene::contains(base, x); }};
  std::array<double, kTruePlaces.size()> forces{}, bars{};
  Measurement result;
  for (std::size_t i = 0; i < kTruePlaces.size(); ++i) {
    const auto at = [&](double depth) {
      const Vec3 centre(kTruePlaces[i], 0, kSlide.radius - depth);
      return truth::Station{{centre, centre, kSlide.radius}};
    };
    const auto truths =
        truth::force_truth(body, {at(-1e-3), {at(kSlide.depth)}, {}}, {nullptr, 1, keep_going});
    if (truths.empty()) throw std::runtime_error("no equilibrium was found under the slide");
    forces[i] = truths[0].forces[0].z();
    bars[i] = truths[0].bars[0];
    result.surface_nodes = truths[0].node_count;
  }
  result.is_course = true;
  const int count = static_cast<int>(std::lround(kHalfWay / kStride));
  for (int k = -count; k <= count; ++k) {
    Sample& sample = result.samples.emplace_back();
    sample.load = k * kStride;
    sample.force = between_places(forces, sample.load);
    sample.force_bar = between_places(bars, sample.load);
  }
  return result;
}

}  // namespace palpate::chart

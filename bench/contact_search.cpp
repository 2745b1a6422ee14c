// What an update of an organ and a search for a probe's contacts cost on one core, from 19,362 to
// 310,000 nodes: an 8 mm sphere that touches lightly, and one whose centre is 10 mm behind the
// skin; beside FCL's refit and collide, and beside brute force over all triangles.
//
// All take turns on each site, so that a machine whose speed drifts slows all; ratios are of
// medians of one run. After each of the two others' turns two periods of ours are run untimed: a
// session's searches follow each other, not a walk over all triangles.
#include <fcl/geometry/bvh/BVH_model.h>
#include <fcl/geometry/shape/sphere.h>
#include <fcl/narrowphase/collision.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <memory>

#include "bench/fine_surface.h"
#include "collision/activation_distance.h"
#include "collision/contact_finder.h"
#include "collision/contact_reduction.h"
#include "modules/core/data_folder.h"
#include "modules/core/error.h"
#include "modules/geometry/closest_points.h"
#include "modules/runtime/program.h"
#include "modules/scene/assets.h"
#include "modules/scene/scene_reader.h"
#include "studies/report/measures.h"

namespace {

using namespace palpate;
using Seconds = std::vector<double>;

constexpr double kRadius = 8e-3;          // of the sphere [m]
constexpr double kLightTouch = 0.5e-3;    // deep [m]
constexpr double kBehindSkin = 10e-3;     // its centre [m]
constexpr double kSlide = 0.05;           // along the skin, to and fro [m/s]
constexpr double kSwell = 0.3e-3;         // of a wave through the organ, 1 Hz [m]
constexpr double kPeriod = 4e-3;          // [s]
constexpr int kSites = 5;                 // where it touches, spread over the organ
constexpr int kFrames = 8;                // of the wave, again and again
constexpr int kTurns = 10, kTurn = 50;    // of a site; periods of a turn
constexpr std::size_t kMostPairs = 4096;  // that FCL is asked for

/// The organ as it comes: the wire's floats, by frame.
std::vector<std::vector<float>> frames_of(const geometry::TriangleSurface& rest) {
  std::vector<std::vector<float>> frames(kFrames);
  for (int f = 0; f < kFrames; ++f) {
    const double phase = 2 * M_PI * kPeriod * (f < kFrames / 2 ? f : kFrames - f);
    for (const Vec3& x : rest.nodes) {
      const Vec3 now = x + kSwell * std::sin(phase + 100 * x.x()) * Vec3(0, 0.6, 0.8);
      for (int k = 0; k < 3; ++k) frames[f].push_back(static_cast<float>(now[k]));
    }
  }
  return frames;
}

struct Site {
  Vec3 skin, out, along;
};

Site site_of(const geometry::TriangleSurface& organ, std::size_t triangle) {
  const auto& [a, b, c] = organ.triangles[triangle];
  const Vec3 out = geometry::unit_normal({organ.nodes[a], organ.nodes[b], organ.nodes[c]});
  return {organ.nodes[a], out, (organ.nodes[b] - organ.nodes[a]).normalized()};
}

/// The sphere's centre after k periods at a height over the skin.
Vec3 centre_at(const Site& site, double height, int k) {
  const int way = k % 16 < 8 ? k % 16 : 16 - k % 16;
  return site.skin + height * site.out + kSlide * kPeriod * way * site.along;
}

template <class Work>
double seconds_of(const Work& work) {
  const double start = report::processor_time();
  work();
  return report::processor_time() - start;
}

/// Collision's way: positions as decoded, update, search.
class OurSearch {
 public:
  explicit OurSearch(const geometry::TriangleSurface& organ)
      : blocks_of_triangle_(geometry::SurfaceBlocks::split(organ.nodes, organ.triangles)),
        blocks_(organ.triangles, blocks_of_triangle_),
        finder_({organ.triangles}, {geometry::RoundedSegment{Vec3::Zero(), Vec3::Zero(), kRadius}},
                {blocks_of_triangle_}) {}

  /// Puts it where it begins; @param site  of which it comes down to `height`
  void begin(const Site& site, double height, const std::vector<std::vector<float>>& frames) {
    finder_.reset();
    height_ = kRadius + 2e-3;
    k_ = 0;
    before_ = {centre_at(site, height_, k_), Quat::Identity()};
    while (height_ > height) {
      height_ = std::max(height, height_ - 1e-3);
      period(site, frames);
    }
    for (int k = 0; k < 20; ++k) period(site, frames);
  }

  void period(const Site& site, const std::vector<std::vector<float>>& frames) {
    message_ = frames[k_ % kFrames];  // deformation and decoding, which are not timed
    blocks_.bound(message_, boxes_);
    ++k_;
    const Pose now{centre_at(site, height_, k_), Quat::Identity()};
    update_s = seconds_of([&] { finder_.take_organ(0, message_, boxes_); });
    search_s = seconds_of([&] {
      finder_.find(0, {before_, now}, margin_, {collision::kUsualContacts, 0, 0}, contacts);
    });
    before_ = now;
  }

  double update_s = 0, search_s = 0;
  ContactSet contacts;

 private:
  std::vector<std::uint32_t> blocks_of_triangle_;
  geometry::SurfaceBlocks blocks_;
  collision::ContactFinder finder_;
  std::vector<geometry::BlockBox> boxes_;
  std::vector<float> message_;
  Pose before_;
  double height_ = 0;
  const double margin_ = collision::activation_distance({}, kSlide);
  int k_ = 0;
};

/// FCL: its tree refitted to the frame, and every pair with the sphere grown by the margin.
class FclSearch {
 public:
  explicit FclSearch(const geometry::TriangleSurface& organ)
      : tree_(std::make_shared<fcl::BVHModel<fcl::AABBd>>()) {
    std::vector<fcl::Triangle> triangles;
    for (const auto& t : organ.triangles) triangles.emplace_back(t[0], t[1], t[2]);
    tree_->beginModel(static_cast<int>(triangles.size()), static_cast<int>(organ.nodes.size()));
    tree_->addSubModel(organ.nodes, triangles);
    tree_->endModel();
    tree_->computeLocalAABB();
  }

  std::size_t period(const std::vector<Vec3>& nodes, const Vec3& centre, double radius) {
    tree_->beginReplaceModel();
    tree_->replaceSubModel(nodes);
    tree_->endReplaceModel(true, true);
    const fcl::Sphered sphere(radius);
    const fcl::Transform3d at(Eigen::Translation3d{centre});
    const fcl::CollisionRequestd request(kMostPairs, true);
    fcl::CollisionResultd result;
    fcl::collide(tree_.get(), fcl::Transform3d::Identity(), &sphere, at, request, result);
    return result.numContacts();
  }

 private:
  std::shared_ptr<fcl::BVHModel<fcl::AABBd>> tree_;
};

/// The nearest point of every triangle to the sphere's centre.
std::size_t brute_force(const geometry::TriangleSurface& organ, const std::vector<Vec3>& nodes,
                        const Vec3& centre, double reach) {
  std::size_t near = 0;
  for (const auto& [a, b, c] : organ.triangles) {
    const auto closest = geometry::closest_on_triangle(centre, {nodes[a], nodes[b], nodes[c]});
    near += (closest.point - centre).squaredNorm() <= reach * reach;
  }
  return near;
}

std::vector<Vec3> doubles_of(const std::vector<float>& frame) {
  std::vector<Vec3> nodes(frame.size() / 3);
  for (std::size_t i = 0; i < nodes.size(); ++i) {
    nodes[i] = Vec3(frame[3 * i], frame[3 * i + 1], frame[3 * i + 2]);
  }
  return nodes;
}

double p99(const Seconds& values) { return report::quantile(values, 0.99); }

struct Samples {
  Seconds update, search, both;
  std::size_t contacts = 0, truncated = 0;

  void take(const OurSearch& ours) {
    update.push_back(ours.update_s);
    search.push_back(ours.search_s);
    both.push_back(ours.update_s + ours.search_s);
    contacts = std::max(contacts, ours.contacts.contacts.size());
    truncated += ours.contacts.truncated;
  }
};

void print(const char* what, const Samples& of, const Samples& touching) {
  const double both = report::median(of.both);
  std::printf("  %-24s %9.1f %9.1f %9.1f %9.1f %9.2f %9.2f %9zu%s\n", what,
              1e6 * report::median(of.update), 1e6 * report::median(of.search), 1e6 * both,
              1e6 * p99(of.both), p99(of.both) / both, both / report::median(touching.both),
              of.contacts, of.truncated > 0 ? " truncated" : "");
}

void print(const char* what, const Seconds& of, const Samples& touching) {
  const double median = report::median(of);
  std::printf("  %-24s %9s %9s %9.1f %9.1f %9s %9.2f\n", what, "", "", 1e6 * median, 1e6 * p99(of),
              "", median / report::median(touching.both));
}

void measure(const geometry::TriangleSurface& organ) {
  const auto frames = frames_of(organ);
  OurSearch light(organ), deep(organ);
  FclSearch fcl(organ);
  Samples touching, behind;
  Seconds with_fcl, by_brute_force, decoded;
  std::vector<float> message;
  for (int s = 0; s < kSites; ++s) {
    const Site site = site_of(organ, (2 * s + 1) * organ.triangles.size() / (2 * kSites));
    light.begin(site, kRadius - kLightTouch, frames);
    deep.begin(site, -kBehindSkin, frames);
    for (int turn = 0; turn < kTurns; ++turn) {
      for (auto [ours, samples] : {std::pair(&light, &touching), std::pair(&deep, &behind)}) {
        for (int k = -2; k < kTurn; ++k) {
          ours->period(site, frames);
          if (k >= 0) samples->take(*ours);
        }
      }
      const auto nodes = doubles_of(frames[turn % kFrames]);
      const Vec3 centre = centre_at(site, kRadius - kLightTouch, turn);
      const double reach = kRadius + collision::activation_distance({}, kSlide);
      decoded.push_back(seconds_of([&] { message = frames[turn % kFrames]; }));
      with_fcl.push_back(seconds_of([&] { fcl.period(nodes, centre, reach); }));
      by_brute_force.push_back(seconds_of([&] { brute_force(organ, nodes, centre, reach); }));
    }
  }
  std::printf("%zu nodes, %zu triangles\n", organ.nodes.size(), organ.triangles.size());
  std::printf("  %-24s %9s %9s %9s %9s %9s %9s %9s\n", "us", "update", "search", "both", "p99",
              "p99/med", "/touching", "contacts");
  print("touching lightly", touching, touching);
  print("centre 10 mm behind", behind, touching);
  print("FCL refit and collide", with_fcl, touching);
  print("brute force", by_brute_force, touching);
  print("a copy of the positions", decoded, touching);
}

int run(const std::string& scene_file, const std::vector<std::size_t>& sizes) {
  const auto scene = scene::load_scene(scene_file);
  const scene::Organ& organ = scene.organs[0];
  const auto surface = scene::load_organ(organ).surface;
  std::printf("%s; organ '%s'; sphere of %g mm, %g mm deep, %d sites, %d periods each\n",
              report::machine_name().c_str(), organ.name.c_str(), 1e3 * kRadius, 1e3 * kLightTouch,
              kSites, kTurns * kTurn);
  for (const std::size_t nodes : sizes) measure(bench::fine_surface(surface, nodes));
  return kExitDone;
}

}  // namespace

int main(int argc, char** argv) {
  runtime::Program program("What an update and a search for contacts cost, by mesh size.",
                           "palpate-bench-contact-search");
  auto scene = (data_folder() / "scenes/stomach_probe_refined.yaml").string();
  std::vector<std::size_t> sizes{19'362, 77'440, 309'760};
  program.add("--scene", scene, "Scene whose first organ is searched").shows_default();
  program.add("--nodes", sizes, "Mesh sizes").range(4, 1'000'000).shows_default();
  return program.run(argc, argv, [&] { return run(scene, sizes); });
}

// Solids put into shapes no organ comes into, as shape_insults_test.cpp does with balls of springs.
// shape_error() is over the cube root of the volume, 10 cm here.
#include <catch2/catch.hpp>
#include <random>

#include "tests/stability/models_under_test.h"

namespace palpate::deformation {
namespace {

using scene::Model;
using testing::run;
using testing::shape_error;

constexpr double kBackTime = 5.0;    // [s]

/// A cube of 10 cm about the origin.
SimulatedOrgan cube(Model model) {
  return testing::simulate(testing::organ_of({model}), testing::compact_shape(model));
}

void report(const SimulatedOrgan& organ, const testing::Story& story, const char* what) {
  std::printf("%s %s: finite %d replaced %d torest %d reduced %d reason %d fastest %g shape %g vol %g inverted %zu\n", what,"",
   story.finite, story.replaced, story.to_rest, story.step_reduced, int(story.first_reason), story.fastest, shape_error(organ), testing::volume_error(organ), inverted_tetrahedra(organ.model(), organ.state().positions));
  fflush(stdout);
}

TEST_CASE("solid insults: explore") {
  for (auto model : {Model::kCorotational, Model::kNodalPressure, Model::kXpbdTetrahedra, Model::kQuadraticElements, Model::kModal}) {
    std::printf("== %s\n", scene::word_of(model));
    auto organ = cube(model);
    const OrganState rest = organ.state();
    const auto with = [&](auto f) { OrganState s = rest; for (std::size_t i=0;i<s.positions.size();++i) f(s.positions[i], s.velocities[i]); return s; };
    std::mt19937 random(1);
    std::uniform_real_distribution<double> any(-1, 1);
    const auto vec = [&] { return Vec3(any(random), any(random), any(random)); };
    std::vector<std::pair<const char*, OrganState>> all;
    all.emplace_back("disc", with([](Vec3& p, Vec3&) { p.z() = 0; }));
    all.emplace_back("line", with([](Vec3& p, Vec3&) { p.z() = p.y() = 0; }));
    all.emplace_back("point", with([](Vec3& p, Vec3&) { p.setZero(); }));
    all.emplace_back("everted", with([](Vec3& p, Vec3&) { p = -p; }));
    all.emplace_back("mirrored", with([](Vec3& p, Vec3&) { p.z() = -p.z(); }));
    all.emplace_back("everted half", with([](Vec3& p, Vec3&) { p *= -0.5; }));
    all.emplace_back("random .3", with([&](Vec3& p, Vec3&) { p = 0.7 * p + 0.3 * 0.05 * vec(); }));
    all.emplace_back("random 1", with([&](Vec3& p, Vec3&) { p = 0.05 * vec(); }));
    all.emplace_back("twisted", with([&](Vec3& p, Vec3& v) { double z = p.z() / 0.05; v = Vec3(30,0,0) + Vec3(0,0,100*z).cross(p); p = Eigen::AngleAxisd(M_PI * z, Vec3::UnitZ()) * p; }));
    all.emplace_back("spun", with([&](Vec3& p, Vec3& v) { v = Vec3(0,0,600).cross(p); }));
    for (auto& [name, state] : all) {
      organ.reset();
      organ.put(state);
      const auto begin = std::chrono::steady_clock::now();
      double back = -1;
      testing::Story story;
      for (double t = 0; t < kBackTime; t += 0.1) {
        const auto part = run(organ, 0.1);
        story.finite &= part.finite;
        if (story.replaced == 0) story.first_reason = part.first_reason;
        story.replaced += part.replaced;
        story.to_rest += part.to_rest;
        story.fastest = std::max(story.fastest, part.fastest);
        const bool good = shape_error(organ) < 2e-3;
        if (!good) back = -1; else if (back < 0) back = t + 0.1;
      }
      std::printf("back %g ", back);
      report(organ, story, name);
      std::printf("   %g s\n", std::chrono::duration<double>(std::chrono::steady_clock::now()-begin).count());
    }
  }
}

}  // namespace
}  // namespace palpate::deformation

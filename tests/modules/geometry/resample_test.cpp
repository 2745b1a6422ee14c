#include <algorithm>
#include <csignal>
#include <utility>

#include "modules/core/error.h"
#include "modules/core/stop_signal.h"
#include "modules/geometry/mesh_prepare.h"
#include "modules/geometry/primitives.h"
#include "modules/messages/messages.h"
#include "tests/modules/geometry/scratch.h"

using namespace palpate;
using namespace palpate::geometry;
using namespace palpate::geometry::test;
using Catch::Contains;

namespace {

/// The bounds that explicit time steps rely on.
void check_quality(const TriangleSurface& result, std::size_t node_count, double volume) {
  const MeshReport report = check_surface(result);
  CHECK(report.node_count == node_count);
  CHECK(report.triangle_count == 2 * node_count - 4);
  CHECK(report.holds_volume());
  CHECK(report.volume == Approx(volume).epsilon(1e-12));
  CHECK(report.longest_edge / report.shortest_edge < 4);
  CHECK(report.worst_aspect < 3);
}

}  // namespace

TEST_CASE("resample: exact counts down and up, closed, even, with the volume kept") {
  // Oracle: invariants and Euler's formula for the triangle count.
  const TriangleSurface ball = make_ball(0.05, 3), capsule = make_capsule(0.03, 0.1, 24);
  for (const std::size_t nodes : {60u, 100u, 333u, 641u, 643u, 1500u}) {
    INFO(nodes);
    check_quality(resample_surface(ball, nodes), nodes, volume_of(ball));
    check_quality(resample_surface(capsule, nodes), nodes, volume_of(capsule));
  }
}

TEST_CASE("resample: a ball stays a ball") {
  // Oracle: analytic: nodes lie on the inscribed surface (0.7 % below the sphere at 642 nodes) and
  // the volume scaling moves them by at most a third of the coarse mesh's missing 5 %.
  const TriangleSurface result = resample_surface(make_ball(0.05, 3), 200);
  for (const Vec3& node : result.nodes) CHECK(node.norm() == Approx(0.05).epsilon(0.02));
  CHECK(solid_centroid(result).norm() < 2e-4);
}

TEST_CASE("resample: sharp solids and very few nodes stay closed") {
  // Oracle: invariants; below about 20 nodes only closedness and volume are promised.
  const TriangleSurface box = make_box({0.1, 0.1, 0.1}, 6);
  check_quality(resample_surface(box, 150), 150, volume_of(box));
  const MeshReport few = check_surface(resample_surface(make_ball(0.05, 2), 12));
  CHECK(few.node_count == 12);
  CHECK(few.holds_volume());
}

TEST_CASE("resample: it tells how far it is") {
  // Oracle: definition: from 0 to 1, never back.
  std::vector<double> parts{0};
  resample_surface(make_ball(0.05, 2), 100, [&](double part) { parts.push_back(part); });
  CHECK(parts.size() > 5);
  CHECK(std::ranges::is_sorted(parts));
  CHECK(parts[1] == 0);
  CHECK(parts.back() == 1);
}

TEST_CASE("resample: a signal ends it where one is waited for") {
  // Oracle: definition; without StopSignal the signal itself would have ended the program.
  const TriangleSurface ball = make_ball(0.05, 2);
  const StopSignal stop;
  bool raised = false;
  const auto raise_once = [&](double part) {
    if (part > 0 && !std::exchange(raised, true)) std::raise(SIGTERM);
  };
  CHECK_THROWS_AS(resample_surface(ball, 1000, raise_once), Interrupted);
}

TEST_CASE("resample: the same input gives the same bits") {
  // Oracle: determinism.
  const TriangleSurface ball = make_ball(0.05, 3);
  const TriangleSurface one = resample_surface(ball, 300), two = resample_surface(ball, 300);
  CHECK(one.nodes == two.nodes);
  CHECK(one.triangles == two.triangles);
}

TEST_CASE("resample: a surface that has the count already is returned as it is") {
  // Oracle: identity.
  const TriangleSurface ball = make_ball(0.05, 2);
  const TriangleSurface same = resample_surface(ball, ball.nodes.size());
  CHECK(same.nodes == ball.nodes);
  CHECK(same.triangles == ball.triangles);
}

TEST_CASE("resample: counts out of range and open surfaces are refused") {
  // Oracle: the rules of resample_surface.
  const TriangleSurface ball = make_ball(0.05, 1);
  const auto refusal = [](const TriangleSurface& surface, std::size_t nodes) {
    return message_of<InputError>([&] { resample_surface(surface, nodes); });
  };
  CHECK_THAT(refusal(ball, 3), Contains("to 3 nodes") && Contains("allowed: 4 to 200000"));
  CHECK_THAT(refusal(ball, kMaxNodes + 1), Contains("allowed: 4 to 200000"));
  TriangleSurface open = ball;
  open.triangles.pop_back();
  CHECK_THAT(refusal(open, 100), Contains("3 open edges"));
  CHECK_THAT(refusal(inside_out(ball), 100), Contains("inside out"));
}

#include "bench/bullet/squeezed_ball.h"

#include <algorithm>
#include <cmath>

#include "modules/geometry/mesh_prepare.h"
#include "modules/geometry/node_order.h"
#include "modules/geometry/primitives.h"
#include "studies/report/measures.h"

namespace palpate::bench {

namespace {

/// Minimum jerk from 0 to 1.
double smooth(double t) { return t * t * t * (10 + t * (6 * t - 15)); }

geometry::TriangleSurface sphere(std::size_t nodes) {
  int levels = 0;
  while (10 * (std::size_t{1} << (2 * levels)) + 2 < nodes && levels < 5) ++levels;
  auto surface = geometry::make_ball(kBallRadius, levels);
  return surface.nodes.size() == nodes ? surface : geometry::resample_surface(surface, nodes);
}

}  // namespace

Ball make_bench_ball(std::size_t nodes) {
  Ball ball;
  ball.organ.name = "ball";
  ball.organ.tissue = {.youngs_modulus = 10e3, .wall_thickness = 3e-3, .density = 1000};
  ball.surface = sphere(nodes);
  geometry::order_nodes_by_neighbourhood(ball.surface);
  ball.model = deformation::build_organ_model(ball.organ, Vec3::Zero(), ball.surface);
  return ball;
}

const char* Outcome::verdict() const {
  constexpr double kBlownUp = 2, kCollapsed = 0.5, kSwinging = 0.05;  // of V₀
  if (contacts_left_out > 0) return "contacts left out";
  if (!finite || peak > kBlownUp) return "blew up";
  if (held > kCollapsed) return "collapsed";
  return swing > kSwinging ? "swings" : "stable";
}

bool Outcome::stable() const { return std::string("stable") == verdict(); }

Outcome run(Squeezer& squeezer, const Squeeze& squeeze, const std::function<void()>& keep_going) {
  const double rest_volume = squeezer.volume();
  const int steps = squeeze.closing_steps + squeeze.holding_steps;
  const int held_from = steps - squeeze.holding_steps / 5;
  Outcome outcome;
  double lowest = 1, highest = 1;
  double spent = 0;
  for (int k = 1; k <= steps && outcome.finite; ++k) {
    keep_going();
    const double closed = smooth(std::min(1.0, double(k) / squeeze.closing_steps));
    const double begin = report::processor_time();
    squeezer.step(kBallRadius * (1 - squeeze.compression * closed));
    spent += report::processor_time() - begin;

    outcome.contacts_left_out = squeezer.contacts_left_out();
    const double ratio = squeezer.volume() / rest_volume;
    outcome.finite = std::isfinite(ratio);
    outcome.peak = std::max(outcome.peak, std::abs(ratio - 1));
    if (k <= held_from) continue;
    if (k == held_from + 1) lowest = highest = ratio;
    lowest = std::min(lowest, ratio);
    highest = std::max(highest, ratio);
    const double height = kBallRadius * (1 - squeeze.compression);
    outcome.beyond = std::max(outcome.beyond, squeezer.depth_beyond(height));
  }
  outcome.held = std::max(std::abs(lowest - 1), std::abs(highest - 1));
  outcome.swing = highest - lowest;
  outcome.pressure = squeezer.pressure();
  outcome.contacts = squeezer.contact_count();
  outcome.cost.solver = 1e6 * squeezer.solver_seconds() / steps;
  if (squeezer.is_whole()) outcome.cost.whole = 1e6 * spent / steps;
  return outcome;
}

}  // namespace palpate::bench

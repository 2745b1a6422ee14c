#include "studies/certify/still_force.h"

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <cmath>

#include "studies/certify/hands.h"
#include "studies/rigs/pressed_organ.h"

namespace palpate::certify {
namespace {

constexpr int kSteps = 3;
constexpr double kHold = 1.5;         // [s]
constexpr double kMean = 0.1;         // over the end of a hold: encoders make the body tremble [s]
constexpr double kLeast = 0.01;       // what is weaker is not judged by its share [N]
constexpr double kPressSpeed = 0.02;  // of the organ alone [m/s]

}  // namespace

std::vector<double> still_forces(const Subject& subject, const std::vector<Vec3>& places,
                                 const KeepGoing& keep_going, ContactTroubles* troubles) {
  scene::Scene scene = subject.scene;
  scene.organs = {subject.scene.organs[subject.place.organ]};
  rigs::PressedOrgan organ(scene, subject.assets.organs[subject.place.organ],
                           {pose_below(subject.place, -kAbove)});
  std::vector<double> forces;
  for (const Vec3& place : places) {
    organ.move_and_settle({place}, kPressSpeed, keep_going);
    forces.push_back(-organ.force(0).dot(subject.place.into));
  }
  if (troubles != nullptr) *troubles += organ.contact_troubles();
  return forces;
}

std::vector<StillForce> measure_still_force(const Loop& loop, const Subject& subject,
                                            const KeepGoing& keep_going) {
  const double move = (kAbove + subject.depth / kSteps) / subject.speed;
  std::vector<scene::ScriptedDevice::Move> moves;
  for (int i = 1; i <= kSteps; ++i) {
    moves.push_back({pose_below(subject.place, subject.depth * i / kSteps).position, move});
    moves.push_back({std::nullopt, kHold});
  }
  const auto ticks = run_loop(loop, firm_hand(subject.device, subject.place, moves),
                              kSteps * (move + kHold), keep_going);
  std::vector<StillForce> found;
  std::vector<Vec3> places;
  for (int i = 1; i <= kSteps; ++i) {
    StillForce mean;
    Vec3 off = Vec3::Zero();
    int count = 0;
    for (const Tick& tick : ticks) {
      const double until_move = i * (move + kHold) - tick.time;
      if (until_move <= 0 || until_move > kMean) continue;
      mean.depth += tick.depth;
      mean.felt += tick.motor;
      off += tick.off;
      ++count;
    }
    if (count == 0) break;
    found.push_back({mean.depth / count, mean.felt / count, 0});
    places.push_back(subject.place.pose.position + off / count);
  }
  const auto forces = still_forces(subject, places, keep_going, loop.options.troubles);
  for (std::size_t i = 0; i < forces.size(); ++i) found[i].organ = forces[i];
  return found;
}

Line still_force_line(const std::vector<StillForce>& forces) {
  const std::string name = "held, felt less the organ's own at rest";
  double worst = 0;
  std::string note;
  for (const StillForce& f : forces) {
    worst = std::max(worst, std::abs(f.felt - f.organ) / std::max(std::abs(f.organ), kLeast));
    note += fmt::format("{}{:.1f} mm: {:.4f} of {:.4f} N", note.empty() ? "" : "; ", 1e3 * f.depth,
                        f.felt, f.organ);
  }
  if (forces.size() < kSteps) worst = HUGE_VAL;
  const bool touched = std::ranges::any_of(forces, [](const StillForce& f) {
    return std::max(std::abs(f.felt), std::abs(f.organ)) >= kLeast;
  });
  if (forces.size() == kSteps && !touched) {
    return not_measured(
        "force", name,
        "nothing to judge, no force reaches " + fmt::format("{:g} N: {}", kLeast, note));
  }
  return at_most("force",
                 {name, 100 * worst, 100 * kForceJnd, "%",
                  "smallest difference of forces a hand tells apart (Pang et al. 1991)", note});
}

}  // namespace palpate::certify

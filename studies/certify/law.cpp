#include "studies/certify/law.h"

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "haptics/local_law.h"
#include "studies/report/measures.h"
#include "studies/rigs/pressed_organ.h"

namespace palpate::certify {
namespace {

constexpr double kSpeed = 0.02, kApproach = 1e-3, kOff = 2e-5;  // [m/s], [m], [m]
constexpr double kDepths[] = {1. / 12, 1. / 6, 1. / 3, 2. / 3, 1, 4. / 3};
constexpr double kMedian = 10, kWorst = 20;  // [%]

/// Forces against the press after a period that ends `off` beside it.
struct Forces {
  double law = 0, organ = 0;  ///< what the law made before it gives then; the organ's own [N]
};

/// What the haptic loop makes of the law on its way to `end`, tick by tick.
double law_force(const Subject& subject, const LocalLaw& law, const Vec3& end) {
  const scene::Rates& rates = subject.scene.rates;
  const int ticks = std::max(1, static_cast<int>(std::lround(rates.haptics / rates.deformation)));
  haptics::LawSolver solver;
  solver.take(law);
  haptics::LawForce found;
  for (int i = 1; i <= ticks; ++i) {
    Pose pose = law.anchor;
    pose.position += double(i) / ticks * (end - law.anchor.position);
    found = solver.evaluate(pose, i * law.period / ticks);
  }
  return -found.wrench.force.dot(subject.place.into);
}

Forces forces_after(const Subject& subject, double depth, double off, const KeepGoing& keep_going,
                    ContactTroubles& troubles) {
  scene::Scene scene = subject.scene;
  scene.organs = {subject.scene.organs[subject.place.organ]};
  const auto at = [&](double below) { return pose_below(subject.place, below); };
  const double way = kSpeed / scene.rates.deformation;
  const int periods = static_cast<int>((depth + kApproach) / way);
  rigs::PressedOrgan organ(scene, subject.assets.organs[subject.place.organ], {at(-kApproach)});
  for (int i = 1; i <= periods; ++i) {
    keep_going();
    organ.advance({at(i * way - kApproach)});
  }
  const LocalLaw law = organ.law(0);
  const Pose end = at((periods + 1) * way - kApproach + off);
  organ.advance({end});
  troubles += organ.contact_troubles();
  return {law_force(subject, law, end.position), -organ.force(0).dot(subject.place.into)};
}

}  // namespace

std::vector<LawStiffness> measure_law(const Subject& subject, const KeepGoing& keep_going,
                                      ContactTroubles& troubles) {
  std::vector<LawStiffness> found;
  for (const double share : kDepths) {
    const double depth = share * subject.depth;
    const Forces more = forces_after(subject, depth, kOff, keep_going, troubles);
    const Forces less = forces_after(subject, depth, -kOff, keep_going, troubles);
    found.push_back(
        {depth, (more.law - less.law) / (2 * kOff), (more.organ - less.organ) / (2 * kOff)});
  }
  return found;
}

std::vector<Line> law_lines(const std::vector<LawStiffness>& stiffness) {
  std::vector<double> errors;
  std::string note;
  for (const LawStiffness& s : stiffness) {
    note += fmt::format("{}{:.1f} mm: {:.1f} of {:.1f} N/m", note.empty() ? "" : "; ",
                        1e3 * s.depth, s.law, s.organ);
    const double off = std::abs(s.law - s.organ), own = std::abs(s.organ);
    errors.push_back(own > 0 ? 100 * off / own : std::numeric_limits<double>::infinity());
  }
  const std::string group = "law", median = "stiffness beside the organ's own, median",
                    worst = "stiffness beside the organ's own, worst";
  const std::string source = "set in docs/certify.md";
  return {at_most(group, {median, report::median(errors), kMedian, "%", source, note}),
          at_most(group, {worst, *std::max_element(errors.begin(), errors.end()), kWorst, "%",
                          source, note})};
}

}  // namespace palpate::certify

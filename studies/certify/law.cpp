#include "studies/certify/law.h"

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "studies/report/measures.h"
#include "studies/rigs/pressed_organ.h"

namespace palpate::certify {
namespace {

constexpr double kSpeed = 0.02, kApproach = 1e-3, kOff = 2e-5;  // [m/s], [m], [m]
constexpr double kDepths[] = {1. / 12, 1. / 6, 1. / 3, 2. / 3, 1, 4. / 3};
constexpr double kMedian = 10, kWorst = 20;  // [%]

/// Force against the press after a period that ends `off` beside it; the law before.
double force(const Subject& subject, double depth, double off, LocalLaw& law,
             const KeepGoing& keep_going) {
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
  law = organ.law(0);
  organ.advance({at((periods + 1) * way - kApproach + off)});
  *subject.contacts += organ.contact_troubles();
  return -organ.force(0).dot(subject.place.into);
}

}  // namespace

std::vector<LawStiffness> measure_law(const Subject& subject, const KeepGoing& keep_going) {
  std::vector<LawStiffness> found;
  const Vec3& into = subject.place.into;
  for (const double share : kDepths) {
    const double depth = share * subject.depth;
    LocalLaw law;
    const double more = force(subject, depth, kOff, law, keep_going);
    const double less = force(subject, depth, -kOff, law, keep_going);
    found.push_back({depth, into.dot(law.stiffness * into), (more - less) / (2 * kOff)});
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

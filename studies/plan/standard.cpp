#include "studies/plan/standard.h"

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <chrono>
#include <limits>
#include <mutex>
#include <numeric>
#include <ostream>
#include <thread>
#include <utility>

#include "modules/core/error.h"
#include "modules/runtime/worker_team.h"
#include "modules/scene/assets.h"
#include "studies/plan/probe_paths.h"
#include "studies/report/progress.h"

namespace palpate::plan {
namespace {

using KeepGoing = Standard::KeepGoing;

bool is_solid(const scene::Scene& scene) {
  return scene.needs.contents == scene::Needs::Contents::kSolid;
}

InputError untouched(const scene::Scene& scene, double seconds) {
  return InputError(fmt::format(
      "{}: no probe touches the organ in the first {:g} s, so key 'needs.{}' "
      "cannot be judged; give a longer --seconds",
      scene.file.string(), seconds, scene.needs.force_error ? "force_error" : "surface_error_m"));
}

/// A force error is of a force.
void check_touched(const scene::Scene& scene, const Course& reference, double seconds) {
  if (!scene.needs.force_error) return;
  for (const auto& forces : reference.forces) {
    for (const Vec3& force : forces) {
      if (force.norm() > 0) return;
    }
  }
  throw untouched(scene, seconds);
}

/// An instant took longer than it may: there a surface folds, nearly always.
struct TooLong {};
constexpr std::chrono::minutes kLongest{10};
/// Of a finer truth, whose price is four times as much.
constexpr std::chrono::minutes kLongestFiner{40};

std::string text_of(const TrueTouch& touch) {
  std::string text = fmt::format("{:.2f} s:", touch.time);
  for (std::size_t j = 0; j < touch.probes.size(); ++j) {
    text += fmt::format(" {:.4g} ± {:.2g} N", touch.truth.forces[j].norm(), touch.truth.bars[j]);
  }
  return text + fmt::format(", {} nodes", touch.truth.node_count);
}

truth::Body body_of(const scene::Organ& organ, bool solid, std::ostream& log) {
  if (solid) return truth::body_of(organ);
  std::size_t thinned = 0;
  auto body = truth::wall_of(organ, &thinned);
  log << fmt::format("  of a wall {:g} mm thick, incompressible, filled with fluid",
                     1e3 * organ.tissue.wall_thickness);
  if (thinned > 0) {
    log << fmt::format("; thinner at {} of {} nodes, where the surface bends too sharply", thinned,
                       body.mesh.nodes.size() / 2);
  }
  log << std::endl;
  return body;
}

bool stand_alike(const truth::Station& one, const truth::Station& other) {
  return std::ranges::equal(one, other, [](const auto& a, const auto& b) {
    return a.a == b.a && a.b == b.b && a.radius == b.radius;
  });
}

/// One equilibrium, and the instants at which it is asked for: probes that are held stand alike.
struct Asked {
  truth::Question question;
  std::vector<TrueTouch> touches;
};

std::vector<Asked> asked_at(const ProbePaths& paths, const std::vector<double>& times,
                            const std::vector<Vec3>& marks) {
  std::vector<Asked> asked;
  for (const double time : times) {
    TrueTouch touch{time, {}, {}};
    auto question = paths.question_at(time, touch.probes);
    question.marks = marks;
    const auto same = std::ranges::find_if(asked, [&](const Asked& before) {
      return before.touches[0].probes == touch.probes &&
             stand_alike(before.question.stations[0], question.stations[0]);
    });
    if (same == asked.end()) {
      asked.push_back({std::move(question), {std::move(touch)}});
    } else {
      same->touches.push_back(std::move(touch));
    }
  }
  return asked;
}

/// Equilibria of quadratic elements, each said when it is found.
/// @param fineness  see truth::Effort
/// @returns those found, in order of time
std::vector<TrueTouch> truths_at(const scene::Scene& scene, const ProbePaths& paths,
                                 const std::vector<double>& times, const std::vector<Vec3>& marks,
                                 double fineness, std::ostream& log, const KeepGoing& keep_going) {
  const std::chrono::minutes longest = fineness < 1 ? kLongestFiner : kLongest;
  std::vector<Asked> asked = asked_at(paths, times, marks);
  report::Progress progress(log, [] { return false; });
  std::string at = fmt::format("{} instants", times.size());
  if (asked.size() < times.size()) at += fmt::format(", {} of them different", asked.size());
  progress.begin("truth: equilibria of quadratic elements at " + at);
  const auto body = body_of(scene.organs[0], is_solid(scene), log);
  std::mutex lock;
  std::vector<double> parts(asked.size(), 0);  // done
  const auto say = [&](std::size_t i, double part) {
    const std::lock_guard guard(lock);
    parts[i] = part;
    progress.at(std::accumulate(parts.begin(), parts.end(), 0.0), double(asked.size()), "instants");
  };
  const auto find = [&](std::size_t i) {
    const auto until = std::chrono::steady_clock::now() + longest;
    return truth::force_truth(body, asked[i].question,
                              {nullptr, fineness,
                               [&] {
                                 keep_going();
                                 if (std::chrono::steady_clock::now() > until) throw TooLong{};
                               },
                               [&](double part) { say(i, part / 2); }});
  };
  std::vector<TrueTouch> found;
  std::size_t done = 0;
  runtime::WorkerTeam team(std::clamp(std::thread::hardware_concurrency(), 1u, 4u));
  truth::run_all(team, asked.size(), [&](std::size_t i) {
    std::vector<truth::Truth> truths;
    bool was_too_long = false;
    try {
      truths = find(i);
    } catch (const TooLong&) {
      was_too_long = true;
    }
    const std::lock_guard guard(lock);
    parts[i] = 1;
    log << fmt::format("  {} of {}: ", ++done, asked.size());
    std::vector<TrueTouch>& touches = asked[i].touches;
    if (truths.empty()) {
      log << fmt::format("{:.2f} s: no equilibrium found{}", touches[0].time,
                         was_too_long ? fmt::format(" within {} minutes", longest.count()) : "")
          << std::endl;
      return;
    }
    for (TrueTouch& touch : touches) touch.truth = truths[0];
    log << text_of(touches[0]) << std::endl;
    found.insert(found.end(), touches.begin(), touches.end());
  });
  std::ranges::sort(found, {}, &TrueTouch::time);
  return found;
}

}  // namespace

bool is_judged_by_truth(const scene::Scene& scene) {
  if (is_solid(scene)) return true;
  return (scene.needs.force_error || scene.needs.surface_error) && has_known_shapes(scene);
}

Standard::Standard(const scene::Scene& scene, const PlanOptions& options)
    : scene_(scene),
      options_(options),
      marks_(marks_on(scene::load_organ(scene.organs[0]).surface)) {
  if (!is_judged_by_truth(scene)) return;
  const ProbePaths paths(scene, scene::load_skin(scene.organs[0]), options.seconds);
  if (paths.touching(options.touches).empty()) throw untouched(scene, options.seconds);
  radius_ = paths.smallest_radius();
  if (is_solid(scene)) touched_ = paths.regions();
}

Errors Standard::errors_of(const Course& course) const {
  if (course.stopped.empty()) {
    return truths_.empty() ? compare(course, reference_) : compare(course, truths_);
  }
  if (!course.held_forces.empty()) {
    return compare(course, truths_, course.held_forces.size());
  }
  Errors errors;
  errors.force = errors.surface = std::numeric_limits<double>::quiet_NaN();
  errors.volume = course.volume_error;
  return errors;
}

void Standard::find(std::ostream& log, const KeepGoing& keep_going) {
  if (std::exchange(is_known_, true)) return;
  is_judged_by_truth(scene_) ? find_truths(log, keep_going) : run_references(log, keep_going);
}

/// At some of the poses in which probes touch.
void Standard::find_truths(std::ostream& log, const KeepGoing& keep_going) {
  const ProbePaths paths(scene_, scene::load_skin(scene_.organs[0]), options_.seconds);
  const auto times = paths.touching(options_.touches);
  truths_ = truths_at(scene_, paths, times, marks_, 1, log, keep_going);
  for (const TrueTouch& touch : truths_) held_.push_back(touch.time);
  if (truths_.empty() && !is_solid(scene_)) return run_references(log, keep_going);
  if (truths_.empty()) {
    throw std::runtime_error("no equilibrium was found where probes touch: no plan");
  }
}

/// Of springs on four times the nodes, and on twice, which say how far those may be off.
void Standard::run_references(std::ostream& log, const KeepGoing& keep_going) {
  const auto run = [&](std::size_t part) {
    auto candidate = reference_of(scene_);
    candidate.nodes /= part;
    const auto changed = scene_with(scene_, candidate);
    return run_course(changed, scene::load_organ(changed.organs[0]), marks_, options_.seconds, {},
                      keep_going);
  };
  log << "reference: " << reference_of(scene_).name() << ", and a coarser one" << std::endl;
  reference_ = run(1);
  if (reference_.diverged)
    throw std::runtime_error("the reference diverged on this scene: no plan");
  if (reference_.contacts.truncated + reference_.contacts.lost > 0) {
    throw std::runtime_error("contacts of the reference were left out on this scene: no plan");
  }
  check_touched(scene_, reference_, options_.seconds);
  const Course coarser = run(2);
  const Errors errors = compare(coarser, reference_);
  log << fmt::format(
             "reference: {} nodes; a coarser one of {} differs by {:.1f}% of the force, {:.2g} mm "
             "of surface",
             reference_.node_count, coarser.node_count, 100 * errors.force, 1e3 * errors.surface)
      << std::endl;
}

Verification verified(const scene::Scene& scene, const Candidate& chosen,
                      const PlanOptions& options, std::ostream& log, const KeepGoing& keep_going) {
  constexpr double kFiner = 0.75;  // edges over those of the plan's truth; four times its price
  constexpr std::size_t kMostVerified = 3;
  const ProbePaths paths(scene, scene::load_skin(scene.organs[0]), options.seconds);
  const auto planned = paths.touching(options.touches);
  std::vector<double> times;
  for (const double time : paths.touching(2 * options.touches + 1)) {
    if (std::ranges::find(planned, time) == planned.end()) times.push_back(time);
  }
  times = spread(times, kMostVerified);
  log << fmt::format("verifying by a finer truth at {} other instants", times.size()) << std::endl;
  const auto truths = truths_at(scene, paths, times, {}, kFiner, log, keep_going);
  if (truths.empty()) return {};
  times.clear();
  for (const TrueTouch& touch : truths) times.push_back(touch.time);
  const auto changed = scene_with(scene, chosen);
  const Course course = run_course(changed, scene::load_organ(changed.organs[0]), {},
                                   options.seconds, times, keep_going);
  for (std::size_t k = 0; k < course.held_forces.size(); ++k) {
    for (std::size_t j = 0; j < truths[k].probes.size(); ++j) {
      const Vec3& expected = truths[k].truth.forces[j];
      log << fmt::format("  {:.2f} s: the choice gives {:.4g} N along the {:.4g} N of probe '{}'",
                         times[k],
                         course.held_forces[k][truths[k].probes[j]].dot(expected.normalized()),
                         expected.norm(), scene.probes[truths[k].probes[j]].name)
          << std::endl;
    }
  }
  return {compare(course, truths), times.size()};
}

}  // namespace palpate::plan

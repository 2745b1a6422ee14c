#include "studies/plan/rivals.h"

#include <catch2/catch.hpp>

namespace palpate::plan {
namespace {

/// Of true forces of 1 N and 2 N, known to the digit.
std::vector<TrueTouch> two_truths() {
  return {{0.1, {0}, {{Vec3(0, 0, 1)}, {0.0}, {}, 0}}, {0.2, {0}, {{Vec3(0, 0, 2)}, {0.0}, {}, 0}}};
}

Course loaded_course(double load, std::vector<double> forces) {
  Course course;
  course.deformation_cost = load;
  course.time = 0.5;
  for (const double force : forces) course.held_forces.push_back({Vec3(0, 0, force)});
  course.moving_forces = course.held_forces;
  course.held_surfaces.resize(forces.size());
  return course;
}

/// That of a candidate which ran to its end.
void add(Rivals& rivals, const scene::Needs& needs, const std::vector<TrueTouch>& truths,
         const Course& course) {
  const Candidate candidate{"nodal_pressure", 100, 100};
  rivals.add(judge(needs, candidate, course, compare(course, truths)), course);
}

scene::Needs needs_of_force(double error) {
  scene::Needs needs;
  needs.force_error = error;
  return needs;
}

TEST_CASE("rivals: who loads a core far too much is stopped after a short piece") {
  // Oracle: the limits; 0.8 of a core is allowed. Before anything meets the needs a core 2.5 times
  // as fast is worth knowing of, one 5 times as fast is not.
  const auto needs = needs_of_force(0.2);
  const auto truths = two_truths();
  Rivals rivals(needs, truths, false);
  CHECK(rivals.why_stop({}, loaded_course(2, {})).empty());
  CHECK_THAT(rivals.why_stop({}, loaded_course(4, {})),
             Catch::Contains("load of the core of deformation 4 > 0.8 in its first 0.5 s"));
  add(rivals, needs, truths, loaded_course(0.1, {1.1, 2.2}));
  CHECK_FALSE(rivals.why_stop({}, loaded_course(2, {})).empty());
  CHECK(rivals.why_stop({}, loaded_course(1, {})).empty());
}

TEST_CASE(
    "rivals: beside one that meets all, dearer ones are stopped if they err more or cost twice") {
  // Oracle: by hand, after the first of two instants; the rival is 10 % off there.
  const auto needs = needs_of_force(0.2);
  const auto truths = two_truths();
  Rivals rivals(needs, truths, false);
  add(rivals, needs, truths, loaded_course(0.1, {1.1, 2.2}));
  CHECK_THAT(
      rivals.why_stop({}, loaded_course(0.15, {1.2})),
      Catch::Contains("by 1 of 2 instants more load and more error than nodal_pressure, 100"));
  CHECK(rivals.why_stop({}, loaded_course(0.15, {1.05})).empty());
  CHECK_THAT(
      rivals.why_stop({}, loaded_course(0.25, {1.0})),
      Catch::Contains("times the load of nodal_pressure, 100 nodes, 100 Hz, which meets all"));
  CHECK(rivals.why_stop({}, loaded_course(0.105, {1.2})).empty());      // as loaded, but for noise
  CHECK(rivals.why_stop({}, loaded_course(0.25, {1.2, 2.4})).empty());  // it is at its end
}

TEST_CASE("rivals: beside one that misses a need, only what misses it for sure is stopped") {
  // Oracle: by hand. The rival is 10 and 30 % off, and 20 are allowed: after the first instant 15 %
  // are worse than its own, and allowed, 25 % are not.
  const auto needs = needs_of_force(0.2);
  const auto truths = two_truths();
  Rivals rivals(needs, truths, false);
  add(rivals, needs, truths, loaded_course(0.1, {1.1, 2.6}));
  CHECK(rivals.why_stop({}, loaded_course(0.15, {1.15})).empty());
  CHECK_FALSE(rivals.why_stop({}, loaded_course(0.15, {1.25})).empty());
}

TEST_CASE("rivals: where all organs are to have one rate, those of another are none") {
  // Oracle: the rule.
  const auto needs = needs_of_force(0.2);
  const auto truths = two_truths();
  Rivals rivals(needs, truths, true);
  add(rivals, needs, truths, loaded_course(0.1, {1.1, 2.2}));
  CHECK(rivals.why_stop({"modal", 100, 200}, loaded_course(0.3, {1.2})).empty());
  CHECK_FALSE(rivals.why_stop({"modal", 100, 100}, loaded_course(0.3, {1.2})).empty());
}

TEST_CASE("rivals: what is cut is not chosen, shows no way out and says why") {
  // Oracle: the rule; its errors so far are none.
  const auto needs = needs_of_force(0.2);
  Course cut = loaded_course(0.01, {});
  cut.stopped = "for a reason";
  std::vector<Verdict> verdicts{judge(needs, {}, cut, {})};
  CHECK(verdicts[0].is_cut);
  CHECK(verdicts[0].failures == std::vector<std::string>{"for a reason"});
  CHECK(best(verdicts) == nullptr);
  CHECK(ways_out(needs, verdicts).empty());
}

}  // namespace
}  // namespace palpate::plan

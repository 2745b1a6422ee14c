#include "studies/plan/verdict.h"

#include <catch2/catch.hpp>
#include <limits>

#include "modules/core/data_folder.h"
#include "tests/studies/plan/courses.h"

namespace palpate::plan {
namespace {

Course costly_course(double force, double surface) {
  Course course = testing::course_to(force, surface);
  course.deformation_cost = 0.1;
  course.collision_cost = 0.01;
  course.publishing_cost = 0.002;
  course.haptic_tick = 3e-6;
  return course;
}

TEST_CASE("plan: the cheapest that meets all needs is chosen, and losers know why") {
  // Oracle: by hand.
  scene::Needs needs;
  needs.force_error = 0.2;
  const Course reference = costly_course(1, 1e-3);
  Course dear = costly_course(1.05, 1e-3), wrong = costly_course(1.5, 1e-3),
         slow = costly_course(1, 1e-3);
  dear.deformation_cost = 0.3;
  slow.deformation_cost = 2;
  std::vector<Verdict> verdicts;
  for (const Course& course : {wrong, dear, slow}) {
    verdicts.push_back(judge(needs, {}, course, compare(course, reference)));
  }
  REQUIRE(best(verdicts) == &verdicts[1]);
  CHECK_THAT(verdicts[0].failures.at(0), Catch::Contains("force error 0.5 > 0.2"));
  CHECK_THAT(verdicts[2].failures.at(0), Catch::Contains("load of the core"));
  CHECK(verdicts[1].total_load == Approx(0.312 + needs.haptics_rate * 3e-6));

  verdicts.erase(verdicts.begin() + 1);
  CHECK(best(verdicts) == nullptr);
  const auto ways = ways_out(needs, verdicts);
  REQUIRE(ways.size() == 2);
  CHECK_THAT(ways[0], Catch::Contains("cores 2.5 times as fast"));
  CHECK_THAT(ways[1], Catch::Contains("force_error 0.5"));
}

TEST_CASE("plan: an error whose bar reaches beyond the need does not meet it") {
  // Oracle: 0.18 ± 0.03 against 0.2 and 0.22.
  scene::Needs needs;
  Errors errors;
  errors.force = 0.18;
  errors.force_bar = 0.03;
  needs.force_error = 0.2;
  CHECK_THAT(judge(needs, {}, {}, errors).failures.at(0),
             Catch::Contains("force error 0.18 ± 0.03 > 0.2"));
  needs.force_error = 0.22;
  CHECK(judge(needs, {}, {}, errors).failures.empty());
}

TEST_CASE("plan: loads that noise may have made are equal, and fewer nodes win") {
  // Oracle: the rule; 5 % more load is within the noise, 20 % is not.
  const auto verdict = [](const char* model, std::size_t nodes, double rate, double load) {
    Verdict v;
    v.candidate = {model, nodes, rate};
    v.node_count = nodes;
    v.total_load = load;
    return v;
  };
  std::vector<Verdict> verdicts{
      verdict("nodal_pressure", 900, 100, 0.100), verdict("nodal_pressure", 500, 200, 0.105),
      verdict("corotational", 500, 200, 0.104), verdict("corotational", 500, 100, 0.106),
      verdict("corotational", 100, 100, 0.120)};
  CHECK(best(verdicts) == &verdicts[3]);
  CHECK(best(verdicts, 200) == &verdicts[2]);
  verdicts[4].total_load = 0.109;
  CHECK(best(verdicts) == &verdicts[4]);
}

}  // namespace
}  // namespace palpate::plan

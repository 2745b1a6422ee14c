#include "deformation/guard/guard_log.h"

#include <catch2/catch.hpp>
#include <string>

namespace palpate::deformation {
namespace {

AdvanceReport replaced(Disbelief reason) {
  AdvanceReport report;
  report.diverged = report.step_reduced = true;
  report.reason = reason;
  return report;
}

TEST_CASE("guard log: nothing acted, nothing is said") {
  // Oracle: definition.
  GuardLog log;
  CHECK(std::string(log.describe({}, 0)).empty());
}

TEST_CASE("guard log: every guard has words of its own") {
  // Oracle: definition; AdvanceReport has no guard the log does not know.
  std::vector<AdvanceReport> reports;
  for (int reason = 1; reason <= static_cast<int>(Disbelief::kCollapsed); ++reason) {
    reports.push_back(replaced(static_cast<Disbelief>(reason)));
  }
  for (const auto flag :
       {&AdvanceReport::back_to_rest, &AdvanceReport::step_reduced, &AdvanceReport::pressure_capped,
        &AdvanceReport::volume_released, &AdvanceReport::volume_skipped,
        &AdvanceReport::contacts_ignored, &AdvanceReport::tissue_inverted,
        &AdvanceReport::contact_refused, &AdvanceReport::probe_jumped}) {
    reports.emplace_back();
    reports.back().*flag = true;
  }
  CHECK(reports.size() == GuardLog::kKinds);
  std::vector<std::string> texts;
  GuardLog log;
  for (const auto& report : reports) texts.emplace_back(log.describe(report, 0));
  for (const auto& text : texts) {
    CHECK(!text.empty());
    CHECK(std::count(texts.begin(), texts.end(), text) == 1);
  }
}

TEST_CASE("guard log: the harshest guard speaks, and says how often it acted") {
  // Oracle: definition; two advances within a second are one event.
  GuardLog log;
  auto report = replaced(Disbelief::kTooFast);
  report.probe_jumped = true;
  const std::string once = log.describe(report, 1.0);
  CHECK_THAT(once, Catch::Contains("100 m/s") && !Catch::Contains("times"));
  CHECK(log.describe(report, 1.5) == once);
  CHECK(log.describe(report, 3.0) == once + " (2 times)");
  CHECK(log.describe(report, 5.0) == once + " (3 times)");
  AdvanceReport jumped;
  jumped.probe_jumped = true;
  CHECK_THAT(log.describe(jumped, 7.0),
             Catch::Contains("a probe jumped") && Catch::Contains("(4 times)"));
  log.reset();
  CHECK(log.describe(report, 7.0) == once);
}

}  // namespace
}  // namespace palpate::deformation

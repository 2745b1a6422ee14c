#include "studies/plan/plan_report.h"

#include <catch2/catch.hpp>
#include <limits>
#include <sstream>

namespace palpate::plan {
namespace {

TEST_CASE("plan report: it names every machine that loads were measured on") {
  // Oracle: the names given.
  OrganPlan organ;
  organ.name = "ball";
  organ.verdicts.resize(1);
  organ.verdicts[0].failures = {"too slow"};
  const std::set<std::string> machines{"one, 2 cores", "two, 64 cores"};
  std::ostringstream text, json;
  print_text({}, {organ}, machines, {}, text);
  print_json({}, {organ}, machines, {}, json);
  CHECK_THAT(text.str(), Catch::Contains("on one, 2 cores; two, 64 cores") &&
                             Catch::Contains("nothing meets the needs"));
  CHECK_THAT(json.str(), Catch::Contains("\"one, 2 cores; two, 64 cores\""));
}

TEST_CASE("plan report: of what was dropped before anything was to compare no error is shown") {
  // Oracle: a dash, and null, for what is not known.
  OrganPlan organ;
  organ.verdicts.resize(1);
  Verdict& dropped = organ.verdicts[0];
  dropped.failures = {"too slow"};
  dropped.is_cut = true;
  dropped.errors.force = dropped.errors.surface = std::numeric_limits<double>::quiet_NaN();
  std::ostringstream text, json;
  print_text({}, {organ}, {}, {}, text);
  print_json({}, {organ}, {}, {}, json);
  CHECK_THAT(text.str(), !Catch::Contains("nan") && Catch::Contains("–"));
  CHECK_THAT(json.str(), !Catch::Contains("NaN") && Catch::Contains("\"surface_error_m\" : null"));
}

TEST_CASE("plan report: a choice that no finer truth was found for is told, as not verified") {
  // Oracle: the words; no error of a truth that there is none of.
  OrganPlan organ;
  organ.name = "ball";
  organ.verdicts.resize(1);
  organ.verdicts[0].errors.force_bar = 0.01;
  organ.chosen = organ.verdicts.data();
  organ.verification = Verification{};
  std::ostringstream text, json;
  print_text({}, {organ}, {}, "planned.yaml", text);
  print_json({}, {organ}, {}, "planned.yaml", json);
  CHECK_THAT(text.str(), Catch::Contains("not verified: ") && Catch::Contains("planned.yaml") &&
                             !Catch::Contains("verified by"));
  const auto verified = json.str().substr(json.str().find("\"verified\""));
  CHECK_THAT(verified, Catch::Contains("\"instants\" : 0") && !Catch::Contains("\"force_error\""));
}

TEST_CASE("plan report: a choice that a finer truth finds beyond its need is told as refuted") {
  // Oracle: the rule, 25 ± 4 % of 20 % allowed, and 22 ± 4 %, which may be right.
  scene::Scene scene;
  scene.needs.force_error = 0.2;
  OrganPlan organ;
  organ.name = "ball";
  organ.verdicts.resize(1);
  organ.verdicts[0].errors.force_bar = 0.01;
  organ.chosen = organ.verdicts.data();
  for (const auto& [error, is_refuted] : {std::pair(0.25, true), {0.22, false}}) {
    organ.verification = Verification{{}, 2};
    organ.verification->errors.force = error;
    organ.verification->errors.force_bar = 0.04;
    CHECK(organ.verification->refutes(scene.needs) == is_refuted);
    CHECK_FALSE(organ.verification->refutes({}));
    std::ostringstream text, json;
    print_text(scene, {organ}, {}, "planned.yaml", text);
    print_json(scene.needs, {organ}, {}, "planned.yaml", json);
    CHECK_THAT(text.str(), Catch::Contains(is_refuted ? "\nrefuted by" : "\nverified by") &&
                               Catch::Contains("2 other instants") &&
                               Catch::Contains("of 20% allowed"));
    CHECK_THAT(json.str(),
               Catch::Contains(is_refuted ? "\"refuted\" : true" : "\"refuted\" : false"));
  }
}

}  // namespace
}  // namespace palpate::plan

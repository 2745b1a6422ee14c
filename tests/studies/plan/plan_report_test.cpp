#include "studies/plan/plan_report.h"

#include <catch2/catch.hpp>
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
  print_json({organ}, machines, {}, json);
  CHECK_THAT(text.str(), Catch::Contains("on one, 2 cores; two, 64 cores") &&
                             Catch::Contains("nothing meets the needs"));
  CHECK_THAT(json.str(), Catch::Contains("\"one, 2 cores; two, 64 cores\""));
}

}  // namespace
}  // namespace palpate::plan

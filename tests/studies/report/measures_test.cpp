#include "studies/report/measures.h"

#include <catch2/catch.hpp>

#include "modules/core/error.h"
#include "tests/scratch_folder.h"

namespace palpate::report {
namespace {

TEST_CASE("measures: median") {
  // Oracle: by hand.
  CHECK(median({3, 1, 2}) == 2);
  CHECK(median({4, 1, 3, 2}) == 3);
}

TEST_CASE("measures: quantiles are values that so many do not exceed") {
  // Oracle: definition, on 1 to 1000, and on 1 to 100, where 0.07 · 100 rounds to more than 7.
  std::vector<double> values;
  for (int i = 1000; i > 0; --i) values.push_back(i);
  CHECK(quantile(values, 0.5) == 500);
  CHECK(quantile(values, 0.999) == 999);
  CHECK(quantile(values, 1) == 1000);
  CHECK(quantile(values, 1e-6) == 1);
  REQUIRE(0.07 * 100 > 7);
  CHECK(quantile({values.end() - 100, values.end()}, 0.07) == 7);
  CHECK(quantile({}, 0.5) == 0);
}

TEST_CASE("measures: processor time runs while this thread works") {
  // Oracle: a busy loop, ended by the time itself.
  const double begin = processor_time();
  while (processor_time() - begin < 1e-3) {
  }
  CHECK(processor_time() > begin);
}

TEST_CASE("measures: the machine has a name") {
  // Oracle: /proc/cpuinfo of any Linux machine.
  CHECK(machine_name().find("cores seen") != std::string::npos);
}

TEST_CASE("measures: a folder that cannot be made is bad input and named") {
  // Oracle: a file is no folder.
  const ScratchFolder folder;
  make_out_folder(folder / "a/b");
  CHECK(std::filesystem::is_directory(folder / "a/b"));
  const auto file = folder / "file";
  std::ofstream(file) << "x";
  CHECK_THROWS_AS(make_out_folder(file / "b"), InputError);
}

}  // namespace
}  // namespace palpate::report

#include "palpate/device/device_log.h"

#include <catch2/catch.hpp>
#include <sstream>

using namespace palpate;
using launcher::DeviceLog;

TEST_CASE("device log: a line a second, a row a period, and what it came to") {
  // Oracle: what was put in: 1 mm to and fro for a second and a half, then still.
  std::ostringstream lines, table;
  DeviceLog log(lines, &table);
  for (int i = 0; i <= 3000; ++i) {
    const double x = i < 1500 ? 1e-3 * (i % 2) : 0;
    log.add(5'000'000 + i, 1e-3 * i, Vec3(x, 0.02, 0), Vec3(0, i == 10 ? 3 : 0.5, 0));
  }
  CHECK(lines.str() ==
        "   1.0 s  at 0.00 20.00 0.00 mm, force 0.500 N, swing 1.000 mm, at most 1.000 mm\n"
        "   2.0 s  at 0.00 20.00 0.00 mm, force 0.500 N, swing 1.000 mm, at most 1.000 mm\n"
        "   3.0 s  at 0.00 20.00 0.00 mm, force 0.500 N, swing 0.000 mm, at most 1.000 mm\n");
  CHECK(log.summary() ==
        "3.0 s at 0.00 20.00 0.00 mm, force 0.500 N (at most 3.000 N), within 0.1 mm since 1.5 s");
  CHECK(table.str().find("5000000,0,0,0.02,0,0,0.5,0\n"
                         "5000001,0.001,0.001,0.02,0,0,0.5,0\n") == 0);
}

TEST_CASE("device log: a device that swings to the end is not called at rest") {
  // Oracle: what was put in.
  std::ostringstream lines;
  DeviceLog log(lines, nullptr);
  for (int i = 0; i <= 1000; ++i) log.add(i, 1e-3 * i, Vec3(2e-3 * (i % 2), 0, 0), Vec3::Zero());
  CHECK(log.summary() ==
        "1.0 s at 0.00 0.00 0.00 mm, force 0.000 N (at most 0.000 N), not at rest: swing 2.000 mm");
}

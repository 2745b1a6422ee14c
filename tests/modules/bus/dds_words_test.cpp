#include "modules/bus/dds_words.h"

#include <catch2/catch.hpp>
#include <fastdds/dds/log/Log.hpp>

#include <algorithm>
#include <iostream>
#include <sstream>

using namespace palpate;

TEST_CASE("DDS words: an error is told once, in a plain line", "[bus]") {
  // Oracle: the lines by hand; the log's own way to wait for its thread.
  namespace dds = eprosima::fastdds::dds;
  bus::tell_plainly();
  std::ostringstream said;
  std::streambuf* const before = std::cerr.rdbuf(said.rdbuf());
  for (int k = 0; k < 3; ++k) {
    EPROSIMA_LOG_ERROR(TEST_OF_WORDS, "not in\nallow rule. (./src/cpp/security/Permissions.cpp:7)");
    EPROSIMA_LOG_WARNING(TEST_OF_WORDS, "no error");
  }
  dds::Log::Flush();
  for (int k = 0; k < 100; ++k) EPROSIMA_LOG_ERROR(TEST_OF_WORDS, "number " << k);
  dds::Log::Flush();
  std::cerr.rdbuf(before);
  CHECK(said.str().starts_with(
      "DDS: TEST_OF_WORDS: not in allow rule.\nDDS: TEST_OF_WORDS: number 0\n"));
  CHECK(std::ranges::count(said.str(), '\n') <= 20);
}

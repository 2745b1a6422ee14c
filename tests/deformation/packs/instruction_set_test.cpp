#include "deformation/packs/instruction_set.h"

#include <algorithm>
#include <catch2/catch.hpp>
#include <fstream>
#include <iterator>
#include <set>
#include <sstream>
#include <string>

using namespace palpate::deformation;

namespace {

/// What the kernel of the operating system says of the first processor.
std::set<std::string> flags_of_cpu() {
  std::ifstream info("/proc/cpuinfo");
  for (std::string line; std::getline(info, line);) {
    if (!line.starts_with("flags")) continue;
    std::istringstream words(line.substr(line.find(':') + 1));
    return {std::istream_iterator<std::string>(words), {}};
  }
  return {};
}

}  // namespace

TEST_CASE("instruction sets: those of this processor, the slowest first") {
  // Oracle: /proc/cpuinfo.
  const auto sets = available_instruction_sets();
  CHECK(std::ranges::is_sorted(sets));
  CHECK(sets.front() == InstructionSet::kPortable);
  const auto flags = flags_of_cpu();
  const auto has = [&](InstructionSet set) { return std::ranges::find(sets, set) != sets.end(); };
  CHECK(has(InstructionSet::kAvx2) == (flags.contains("avx2") && flags.contains("fma")));
  CHECK(has(InstructionSet::kAvx512) ==
        (flags.contains("avx512f") && flags.contains("avx512dq") && flags.contains("avx512vl")));
}

TEST_CASE("instruction sets: each has a name of its own") {
  // Oracle: that they differ.
  std::set<std::string> names;
  for (const auto set :
       {InstructionSet::kPortable, InstructionSet::kAvx2, InstructionSet::kAvx512}) {
    names.insert(name_of(set));
  }
  CHECK(names.size() == 3);
}

#include "studies/certify/group_store.h"

#include <catch2/catch.hpp>
#include <cmath>
#include <limits>
#include <sstream>

#include "tests/scratch_folder.h"
#include "tests/studies/damages.h"

using namespace palpate;
using namespace palpate::certify;

TEST_CASE("group store: lines come back bit by bit, and only for what they are of") {
  // Oracle: what was written.
  const ScratchFolder folder;
  std::ostringstream log;
  const GroupStore store(folder.path(), "this scene", log);
  const double infinite = std::numeric_limits<double>::infinity();
  GroupResult written;
  written.lines = {at_most("a", {"b", 0.1 + 0.2, 1.0 / 3, "N", "source, \"quoted\"", "note\n"}),
                   at_least("a", {"c", infinite, -infinite, "", "", ""}),
                   not_measured("d", "e", "why")};
  written.troubles = {1, 2, 3};
  written.push = M_PI;
  store.write("link: 10 ms", written);
  GroupResult read;
  REQUIRE(store.read("link: 10 ms", read));
  REQUIRE(read.lines.size() == written.lines.size());
  for (std::size_t i = 0; i < read.lines.size(); ++i) {
    const Line &a = read.lines[i], &b = written.lines[i];
    CHECK(text_of(a) == text_of(b));
    CHECK(a.value == b.value);
    CHECK(a.limit == b.limit);
    CHECK(a.note == b.note);
    CHECK(a.source == b.source);
  }
  CHECK(read.push == written.push);
  CHECK(read.troubles.unsolved == 3);
  CHECK_FALSE(store.read("another", read));
  CHECK_FALSE(GroupStore(folder.path(), "another scene", log).read("link: 10 ms", read));
  CHECK(log.str().empty());
  const std::string file = store.key("link: 10 ms") + ".json";
  for (const std::string& text : damaged(text_in(folder / file))) {
    INFO(text);
    folder.write(file, text);
    std::ostringstream said;
    CHECK_FALSE(GroupStore(folder.path(), "this scene", said).read("link: 10 ms", read));
    CHECK_THAT(said.str(), Catch::Contains(file + ": was "));
  }
}

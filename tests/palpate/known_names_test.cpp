#include "palpate/known_names.h"

#include <catch2/catch.hpp>
#include <sstream>

using namespace palpate::launcher;

TEST_CASE("known names: what is wrong with a file of a temporary folder is told of what it is of") {
  // Oracle: the texts by hand.
  KnownNames names;
  names.add("/tmp/p-1/scene.yaml", "a.yaml with --set b=1");
  names.add("/tmp/p-1/probe_0.csv", "r.mcap, probe 0");
  CHECK(names.in("/tmp/p-1/scene.yaml: no end") == "a.yaml with --set b=1: no end");
  CHECK(names.in("/tmp/p-1/scene.yaml:12: of /tmp/p-1/scene.yaml") ==
        "a.yaml with --set b=1: of a.yaml with --set b=1");
  CHECK(names.in("b.yaml:12: no end") == "b.yaml:12: no end");
  CHECK(names.in(palpate::InputError("/tmp/p-1/probe_0.csv:2: only 1 usable poses")).what() ==
        std::string("r.mcap, probe 0: only 1 usable poses"));
}

TEST_CASE("known names: they are in lines that are passed on, however these were written") {
  // Oracle: the text by hand.
  KnownNames names;
  names.add("/tmp/p-1/probe_0.csv", "r.mcap, probe 0");
  std::ostringstream log;
  {
    NamingStream stream(log, names);
    stream << "warning: /tmp/p-1/"
           << "probe_0.csv:7: a gap" << std::endl
           << "of " << 5;
    CHECK(log.str() == "warning: r.mcap, probe 0: a gap\n");
  }
  CHECK(log.str() == "warning: r.mcap, probe 0: a gap\nof 5");
}

#include "modules/recording/idl_text.h"

#include <catch2/catch.hpp>

#include "modules/bus/topics.h"
#include "tests/modules/recording/recording_files.h"

namespace palpate::recording {
TEST_CASE("idl text: every topic has the text of its IDL file") {
  // Oracle: the files themselves, and the type each defines.
  for (const bus::TopicInfo& topic : bus::all_topics()) {
    const std::string type(topic.type->name);
    CAPTURE(type);
    const auto file = std::filesystem::path(PALPATE_SOURCE_DIR) / "idl" / (type + ".idl");
    CHECK(text_in(file) == idl_text_of(*topic.type));
    CHECK(idl_text_of(*topic.type).find("struct " + type) != std::string_view::npos);
  }
}

TEST_CASE("idl text: texts are the same if only comments and spaces differ") {
  // Oracle: pairs judged by eye.
  CHECK(same_idl("struct A { double x; };", "// about A\nstruct A {\n  double x;  // [m]\n};\n"));
  CHECK(same_idl("", "  // nothing"));
  CHECK_FALSE(same_idl("struct A { double x; };", "struct A { float x; };"));
  CHECK_FALSE(same_idl("struct A { double x; };", "struct A { double x; double y; };"));
  CHECK_FALSE(same_idl("unsigned long x;", "unsignedlong x;"));
}

}  // namespace palpate::recording

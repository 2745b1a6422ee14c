#include "modules/core/text.h"

#include <catch2/catch.hpp>

using namespace palpate;

TEST_CASE("text: UTF-8 is what Unicode calls well-formed") {
  // Oracle: the Unicode Standard, table 3-7.
  for (const char* good :
       {"", "plain", "\xc3\xa9", "\xe2\x82\xac", "\xf0\x9f\x98\x80", "\xed\x9f\xbf"}) {
    CHECK(is_utf8(good));
  }
  for (const char* bad :
       {"\xff", "\x80", "\xc0\xaf", "\xe0\x80\xaf", "\xed\xa0\x80", "\xf4\x90\x80\x80", "a\xc3"}) {
    CHECK_FALSE(is_utf8(bad));
  }
}

TEST_CASE("text: what a terminal would obey is found, and shown as question marks") {
  // Oracle: by hand.
  CHECK_FALSE(has_control_bytes("two words \xc3\xa9"));
  for (const char* bad : {"\x1b[2J", "a\n", "\x7f", "\t"}) CHECK(has_control_bytes(bad));
  CHECK(printable("a\x1b[2J\n\x07\x7f \xc3\xa9 \xc2\x9b") == "a?[2J??? \xc3\xa9 ??");
}

TEST_CASE("text: a number as printf writes it") {
  // Oracle: by hand.
  CHECK(text_of("%.2f s", 1.234) == "1.23 s");
  CHECK(text_of("%.0f", -0.4) == "-0");
}

TEST_CASE("text: a text is cut between letters") {
  // Oracle: by hand; letters of one to four bytes.
  const std::string text = "a\xc3\xa9\xe2\x82\xac\xf0\x9f\x98\x80";
  const std::size_t ends[] = {0, 1, 1, 3, 3, 3, 6, 6, 6, 6, 10, 10};
  for (std::size_t bytes = 0; bytes < std::size(ends); ++bytes) {
    CHECK(cut_at_letter(text, bytes) == text.substr(0, ends[bytes]));
    CHECK(is_utf8(cut_at_letter(text, bytes)));
  }
}

TEST_CASE("text: what stands behind a colon, where there is anything") {
  // Oracle: by hand; lines of /proc/cpuinfo and of Gmsh's log.
  CHECK(after_colon("model name\t: Xeon: 2 GHz") == "Xeon: 2 GHz");
  CHECK(after_colon("Error   :no space") == "no space");
  for (const char* none : {"", "Error", "Error   :", "Error   : "})
    CHECK(after_colon(none).empty());
}

#include "modules/trajectories/table_columns.h"

#include <catch2/catch.hpp>

#include "modules/core/error.h"

using namespace palpate;
using namespace palpate::trajectories;

TEST_CASE("table columns: the separator is the strongest that a line holds") {
  // Oracle: the stated order.
  CHECK(separator_of("a\tb;c,d e") == '\t');
  CHECK(separator_of("a;b,c d") == ';');
  CHECK(separator_of("a, b") == ',');
  CHECK(separator_of("a b") == ' ');
}

TEST_CASE("table columns: fields lose blanks and quotation marks, empty ones count") {
  // Oracle: by hand.
  using Fields = std::vector<std::string>;
  CHECK(fields_of(" a , \"b c\",,d,", ',') == Fields{"a", "b c", "", "d", ""});
  CHECK(fields_of("  a   b ", ' ') == Fields{"a", "b"});
  CHECK(fields_of("a\t\tb", '\t') == Fields{"a", "", "b"});
  CHECK_THROWS_AS(fields_of(std::string(kMostColumns, ','), ','), InputError);
}

TEST_CASE("table columns: places go to time, x, y, z, qx, qy, qz, qw") {
  // Oracle: by hand.
  const auto columns = find_columns({"a", "w", "i", "j", "k", "x", "y", "z"},
                                    {"a", "x", "y", "z", "w", "i", "j", "k"}, true);
  CHECK(columns.of == std::array<std::size_t, 8>{0, 5, 6, 7, 2, 3, 4, 1});
  CHECK(columns.count == 8);
  CHECK(columns.headed);
  const auto numbered = find_columns({"0.5", "1", "2", "3"}, {"1", "2", "3", "4"}, false);
  CHECK(numbered.wanted == 4);
  CHECK_FALSE(numbered.headed);
}

TEST_CASE("table columns: one column cannot be two things") {
  // Oracle: the stated rule and form.
  const std::vector<std::string> header{"t", "x", "y", "z"};
  const auto said = [&](const std::vector<std::string>& names) -> std::string {
    try {
      find_columns(header, names, false);
    } catch (const InputError& error) {
      return error.what();
    }
    return "accepted";
  };
  CHECK(said({"t", "x", "x", "z"}) ==
        "key columns is [t, x, x, z]: 'x' and 'x' are the same column, 2; each must be another");
  CHECK(said({"t", "2", "x", "z"}) ==
        "key columns is [t, 2, x, z]: '2' and 'x' are the same column, 2; each must be another");
  CHECK(said({"t", "x", "y", "4"}) == "accepted");
}

// Names of tests that reach their test: CMake makes a list of them, ctest hands each to Catch2.
#include <algorithm>
#include <catch2/catch.hpp>

#include "tests/structure/source_tree.h"

using namespace palpate::structure;

namespace {

/// The literal that begins at `at`, as the compiler reads it; `at` moves behind it.
std::string read_literal(const std::string& text, std::size_t& at) {
  std::string literal;
  for (++at; at < text.size() && text[at] != '"'; ++at) {
    if (text[at] == '\\') ++at;
    literal += text[at];
  }
  ++at;
  return literal;
}

/// Names of the cases in a source text. Literals side by side are one name.
std::vector<std::string> case_names(const std::string& text) {
  const std::string macro = std::string("TEST_CASE") + "(";
  std::vector<std::string> names;
  for (auto at = text.find(macro); at != std::string::npos; at = text.find(macro, at)) {
    std::string name;
    at = text.find_first_not_of(" \n", at + macro.size());
    while (at < text.size() && text[at] == '"') {
      name += read_literal(text, at);
      at = text.find_first_not_of(" \n", at);
    }
    if (!name.empty()) names.push_back(name);  // else this page only speaks of it
  }
  return names;
}

/// Why ctest would run another test than the one of this name, or none. Empty: it would not.
std::string lost(const std::string& name) {
  if (name.find(';') != std::string::npos) return "CMake splits lists at ';'";
  if (name.find('\\') != std::string::npos) return "CMake and Catch2 take '\\' away";
  if (std::ranges::count(name, '[') != std::ranges::count(name, ']')) {
    return "CMake joins names up to the bracket that closes this one's";
  }
  if (std::string("*~\" ").find(name.front()) != std::string::npos) return "Catch2 reads its start";
  if (name.back() == '*' || name.back() == ' ') return "Catch2 reads its end";
  return "";
}

std::string text_of(const std::string& file) {
  std::string text;
  for (const auto& line : lines_of(file)) text += line + "\n";
  return text;
}

}  // namespace

TEST_CASE("test names: each reaches its test through CMake, ctest and Catch2") {
  // Oracle: the names in the sources, and what CatchAddTests.cmake and Catch2's test
  // specification do to characters.
  std::string found;
  std::size_t checked = 0;
  for (const auto& file : sources("tests")) {
    if (file.ends_with("test_names_test.cpp")) continue;  // the bad ones below
    for (const auto& name : case_names(text_of(file))) {
      ++checked;
      if (const auto why = lost(name); !why.empty())
        found += file + ": " + name + ": " + why + "\n";
    }
  }
  CHECK(found == "");
  CHECK(checked > 1000);  // it did read the tree
}

TEST_CASE("test names: those that do not reach it are found") {
  // Oracle: written by hand.
  const std::string macro = "TEST_CASE";
  const auto names = case_names(macro + "(\"a: b\") {}\n TEMPLATE_" + macro +
                                "(\n    \"one \\\"quoted\\\" \"\n    \"two\", \"[tag]\", int) {}");
  CHECK(names == std::vector<std::string>{"a: b", "one \"quoted\" two"});
  CHECK(lost(names[1]) == "");
  CHECK(lost("probe: forces on [0, 1] stay") == "");
  for (const auto* name : {"a; b", "a\\b", "on [0, 1) only", "a]", "*", "a *", "~a", " a", "a "}) {
    INFO(name);
    CHECK(lost(name) != "");
  }
}

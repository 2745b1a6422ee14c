// docs/paper.md names all of the paper. That its links lead to what they name: tests/structure.
#include <catch2/catch.hpp>
#include <fstream>
#include <sstream>
#include <string>

#include "studies/paper/paper_command.h"

namespace {

std::string page() {
  std::ifstream stream(std::string(PALPATE_SOURCE_DIR) + "/docs/paper.md");
  std::stringstream text;
  text << stream.rdbuf();
  return text.str();
}

TEST_CASE("paper page: it names the command of every part") {
  // Oracle: what --only takes.
  for (const auto& part : palpate::paper::paper_parts()) {
    INFO(part);
    std::string command = "palpate paper --only ";
    CHECK(page().find(command.append(part)) != std::string::npos);
  }
}

TEST_CASE("paper page: each of the paper's eight equations has a row") {
  // Oracle: the paper numbers (1) to (8).
  const std::string text = page();
  for (int number = 1; number <= 8; ++number) {
    INFO(number);
    CHECK(text.find("\n| (" + std::to_string(number) + ") ") != std::string::npos);
  }
}

}  // namespace

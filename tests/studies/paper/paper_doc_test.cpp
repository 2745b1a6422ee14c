// docs/paper.md stays true: its links lead to what they name.
#include <catch2/catch.hpp>
#include <filesystem>
#include <fstream>
#include <regex>
#include <sstream>
#include <string>
#include <vector>

#include "studies/paper/paper_command.h"

namespace {

const std::filesystem::path kRoot = PALPATE_SOURCE_DIR;

std::vector<std::string> lines_of(const std::filesystem::path& file) {
  std::vector<std::string> lines;
  std::ifstream stream(file);
  for (std::string line; std::getline(stream, line);) lines.push_back(line);
  return lines;
}

std::string page() {
  std::string text;
  for (const auto& line : lines_of(kRoot / "docs/paper.md")) text += line + "\n";
  return text;
}

/// Line numbers at which a word stands, for the message.
std::string places_of(const std::string& word, const std::vector<std::string>& lines) {
  std::ostringstream places;
  for (std::size_t i = 0; i < lines.size(); ++i) {
    if (lines[i].find(word) != std::string::npos) places << ' ' << i + 1;
  }
  return places.str();
}

TEST_CASE("paper page: each linked line holds the name it is linked from") {
  // Oracle: the sources. A link is [`name`](../file#Lline).
  static const std::regex kLink(R"(\[`([^`]+)`\]\(\.\./([^)#]+)#L([0-9]+)\))");
  const std::string text = page();
  std::size_t links = 0;
  for (std::sregex_iterator it(text.begin(), text.end(), kLink), end; it != end; ++it, ++links) {
    const std::string name = (*it)[1], file = (*it)[2];
    const std::size_t number = std::stoul((*it)[3]);
    INFO(name << " is linked to " << file << " line " << number);
    REQUIRE(std::filesystem::exists(kRoot / file));
    const auto lines = lines_of(kRoot / file);
    INFO("it stands in lines" << places_of(name, lines));
    CHECK((number >= 1 && number <= lines.size() &&
           lines[number - 1].find(name) != std::string::npos));
  }
  CHECK(links >= 20);
}

TEST_CASE("paper page: every other file it links to exists") {
  // Oracle: the tree.
  static const std::regex kLink(R"(\]\(([^)#]+)\))");
  const std::string text = page();
  for (std::sregex_iterator it(text.begin(), text.end(), kLink), end; it != end; ++it) {
    const std::string file = (*it)[1];
    INFO(file);
    CHECK((file.rfind("http", 0) == 0 || std::filesystem::exists(kRoot / "docs" / file)));
  }
}

TEST_CASE("paper page: it names the command of every part") {
  // Oracle: what --only takes.
  for (const auto& part : palpate::bench::paper_parts()) {
    INFO(part);
    std::string command = "palpate chart paper --only ";
    CHECK(page().find(command.append(part)) != std::string::npos);
  }
}

TEST_CASE("paper page: the tests it names exist") {
  // Oracle: the TEST_CASE names of the tree. A test is named as *"…"*.
  static const std::regex kTest(R"re(\*"([^"]+)"\*)re");
  std::string tests;
  for (const auto& entry : std::filesystem::recursive_directory_iterator(kRoot / "tests")) {
    if (entry.path().extension() != ".cpp") continue;
    for (const auto& line : lines_of(entry.path())) tests += line + "\n";
  }
  const std::string text = page();
  std::size_t named = 0;
  for (std::sregex_iterator it(text.begin(), text.end(), kTest), end; it != end; ++it, ++named) {
    INFO((*it)[1]);
    std::string declared = "TEST_CASE(\"";
    declared.append((*it)[1]).append("\"");
    CHECK(tests.find(declared) != std::string::npos);
  }
  CHECK(named >= 5);
}

}  // namespace

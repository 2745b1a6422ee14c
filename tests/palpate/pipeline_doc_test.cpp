// docs/pipeline.md stays true: what it names exists.
#include <algorithm>
#include <catch2/catch.hpp>
#include <filesystem>
#include <fstream>
#include <regex>
#include <set>
#include <sstream>

namespace {

const std::filesystem::path kRoot = PALPATE_SOURCE_DIR;

std::string read(const std::filesystem::path& file) {
  std::ifstream stream(file);
  std::stringstream text;
  text << stream.rdbuf();
  return text.str();
}

/// Cells of every table row that begins with a stage number.
std::vector<std::vector<std::string>> stages() {
  std::vector<std::vector<std::string>> rows;
  std::istringstream page(read(kRoot / "docs/pipeline.md"));
  for (std::string line; std::getline(page, line);) {
    if (!std::regex_search(line, std::regex(R"(^\| *[0-9]+ *\|)"))) continue;
    std::vector<std::string> cells;
    std::istringstream row(line.substr(1));
    for (std::string cell; std::getline(row, cell, '|');) cells.push_back(cell);
    rows.push_back(cells);
  }
  return rows;
}

/// The `quoted` words of a cell.
std::vector<std::string> quoted(const std::string& cell) {
  static const std::regex kQuoted("`([^`]+)`");
  std::vector<std::string> words;
  for (std::sregex_iterator it(cell.begin(), cell.end(), kQuoted), end; it != end; ++it) {
    words.push_back((*it)[1]);
  }
  return words;
}

/// "ContactFinder::find()" → "find".
std::string bare_name(std::string function) {
  function = function.substr(0, function.find('('));
  const auto scope = function.rfind("::");
  return scope == std::string::npos ? function : function.substr(scope + 2);
}

std::set<std::string> topic_names() {
  static const std::regex kTopic(R"re(\{"([a-z_]+)", Delivery::)re");
  const std::string text = read(kRoot / "modules/bus/topics.h");
  std::set<std::string> names;
  for (std::sregex_iterator it(text.begin(), text.end(), kTopic), end; it != end; ++it) {
    names.insert((*it)[1]);
  }
  return names;
}

}  // namespace

TEST_CASE("pipeline page: every stage's function is in the file it names") {
  // Oracle: the sources. Columns: stage | what | function | file | topics | rate.
  const auto rows = stages();
  REQUIRE(rows.size() >= 9);
  for (std::size_t i = 0; i < rows.size(); ++i) {
    INFO("stage " << rows[i][0] << ":" << rows[i][1]);
    CHECK(std::stoul(rows[i][0]) == i + 1);
    REQUIRE(rows[i].size() >= 6);
    const auto functions = quoted(rows[i][2]);
    const auto files = quoted(rows[i][3]);
    REQUIRE_FALSE(functions.empty());
    REQUIRE(files.size() == 1);
    INFO(files[0]);
    REQUIRE(std::filesystem::exists(kRoot / files[0]));
    const std::string text = read(kRoot / files[0]);
    for (const auto& function : functions) {
      INFO(function);
      CHECK(std::regex_search(text, std::regex("\\b" + bare_name(function) + "\\(")));
    }
  }
}

TEST_CASE("pipeline page: every function of a traced cycle is in the file it names") {
  // Oracle: the sources. A line is a function, how often it was called, and its file; or a message.
  static const std::regex kCall(R"(^ *([\w:]+)(?: x\d+)? +(\S+\.(?:cpp|h))$)"),
      kMessage(R"(^ *(<-|->) (\w+)(?: x\d+)?$)");
  const std::string messages = read(kRoot / "modules/messages/messages.h");
  std::istringstream page(read(kRoot / "docs/pipeline.md"));
  std::size_t cycles = 0, calls = 0;
  bool traced = false;
  for (std::string line; std::getline(page, line);) {
    if (line.starts_with("```")) {
      traced = line == "```trace";
      cycles += traced;
      continue;
    }
    if (!traced) continue;
    INFO(line);
    std::smatch found;
    if (std::regex_match(line, found, kMessage)) {
      CHECK(std::regex_search(messages, std::regex("struct " + found[2].str() + "\\b")));
    } else {
      REQUIRE(std::regex_match(line, found, kCall));
      REQUIRE(std::filesystem::exists(kRoot / found[2].str()));
      CHECK(std::regex_search(read(kRoot / found[2].str()),
                              std::regex("\\b" + bare_name(found[1]) + "\\(")));
      ++calls;
    }
  }
  CHECK(cycles == 5);
  CHECK(calls > 100);
}

TEST_CASE("pipeline page: its topics exist and none is left out") {
  // Oracle: modules/bus/topics.h.
  const auto existing = topic_names();
  REQUIRE(existing.size() >= 10);
  std::set<std::string> named;
  for (const auto& row : stages()) {
    for (const auto& topic : quoted(row[4])) named.insert(topic);
  }
  CHECK(named == existing);
}

TEST_CASE("pipeline page: its rates are keys of the scene") {
  // Oracle: the schema.
  const std::string schema = read(kRoot / "modules/scene/schema.h");
  std::size_t checked = 0;
  for (const auto& row : stages()) {
    for (const auto& rate : quoted(row[5])) {
      INFO(rate);
      CHECK(schema.find("\"" + rate + "\"") != std::string::npos);
      ++checked;
    }
  }
  CHECK(checked == 4);
}

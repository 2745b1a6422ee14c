// Every page stays true to the tree: its links lead somewhere, to what they name.
#include <algorithm>
#include <catch2/catch.hpp>
#include <cctype>
#include <filesystem>
#include <fstream>
#include <regex>
#include <set>
#include <sstream>
#include <string>
#include <vector>

#include "tests/scratch_folder.h"

namespace {

using palpate::text_in;
namespace fs = std::filesystem;

const fs::path kRoot = PALPATE_SOURCE_DIR;

/// All files of the tree, not of build folders or what a demo left behind.
std::vector<fs::path> files() {
  std::vector<fs::path> found;
  for (fs::recursive_directory_iterator it(kRoot), end; it != end; ++it) {
    const std::string name = it->path().filename().string();
    const bool skipped = name == "build" || name == "out" || (name[0] == '.' && name != ".ci");
    if (it->is_directory() && skipped) {
      it.disable_recursion_pending();
    } else if (it->is_regular_file()) {
      found.push_back(it->path());
    }
  }
  return found;
}

std::vector<fs::path> pages() {
  std::vector<fs::path> found = files();
  std::erase_if(found, [](const fs::path& file) { return file.extension() != ".md"; });
  return found;
}

void add_words(const std::string& text, std::set<std::string>& words) {
  const auto in_word = [](unsigned char letter) { return std::isalnum(letter) || letter == '_'; };
  for (auto begin = text.begin(); begin != text.end();) {
    begin = std::find_if(begin, text.end(), in_word);
    const auto end = std::find_if_not(begin, text.end(), in_word);
    words.emplace(begin, end);
    begin = end;
  }
}

struct Link {
  fs::path page;
  std::string text, target;
};

/// Links to files of the tree.
std::vector<Link> links_of(const fs::path& page) {
  static const std::regex kLink(R"(\[([^\]]*)\]\(([^)#\s]+)(#[^)]*)?\))");
  static const std::regex kForeign("^[a-z]+:.*");
  const std::string text = text_in(page);
  std::vector<Link> links;
  for (std::sregex_iterator it(text.begin(), text.end(), kLink), end; it != end; ++it) {
    if (!std::regex_match((*it)[2].str(), kForeign)) links.push_back({page, (*it)[1], (*it)[2]});
  }
  return links;
}

/// Whether a source file declares `name`: "class X", "struct X", or a function, Python's included.
bool declares(const std::string& source, const std::string& name) {
  static const std::regex kType("^(class|struct) [A-Za-z]+$");
  const bool type = std::regex_match(name, kType);
  return std::regex_search(source, std::regex("\\b" + name + (type ? "\\b" : "\\(")));
}

TEST_CASE("pages: every relative link leads to a file or folder") {
  // Oracle: the tree.
  std::size_t checked = 0;
  for (const auto& page : pages()) {
    for (const auto& link : links_of(page)) {
      INFO(fs::relative(page, kRoot).string() << ": " << link.target);
      CHECK(fs::exists(page.parent_path() / link.target));
      ++checked;
    }
  }
  CHECK(checked > 80);  // it did read the pages
}

TEST_CASE("pages: a linked source file declares the name it is linked from") {
  // Oracle: the sources. Such a link is [`name`](path): a class, a struct or a function.
  std::size_t checked = 0;
  for (const auto& page : pages()) {
    for (const auto& link : links_of(page)) {
      const fs::path file = page.parent_path() / link.target;
      const std::string kind = file.extension().string();
      if (kind != ".h" && kind != ".cpp" && kind != ".py") continue;
      if (link.text.size() < 3 || link.text.front() != '`' || !fs::exists(file)) continue;
      INFO(fs::relative(page, kRoot).string() << ": " << link.text << " in " << link.target);
      CHECK(declares(text_in(file), link.text.substr(1, link.text.size() - 2)));
      ++checked;
    }
  }
  CHECK(checked >= 20);
}

TEST_CASE("pages: source files they name exist") {
  // Oracle: the tree. A path begins with a folder of the tree's top; what it names has a slash.
  static const std::regex kPath(
      R"(`((?:modules|deformation|collision|haptics|visualizer|palpate|studies|bench|python|tests|idl|docs|scenes|scripts|cmake)/[a-z0-9_/]*(?:\.[a-z]+)?)`)");
  std::size_t named = 0;
  for (const auto& page : pages()) {
    // The changelog tells of what was; the pipeline page has a test of its own.
    if (page.filename() == "CHANGELOG.md" || page.filename() == "pipeline.md") continue;
    const std::string text = text_in(page);
    for (std::sregex_iterator it(text.begin(), text.end(), kPath), end; it != end; ++it, ++named) {
      const std::string path = (*it)[1];
      INFO(fs::relative(page, kRoot).string() << ": " << path);
      CHECK((fs::exists(kRoot / path) || fs::exists(page.parent_path() / path)));
    }
  }
  CHECK(named > 30);
}

TEST_CASE("pages: functions, fields and keys they quote exist") {
  // Oracle: the words of all files that are no pages, and their names. Quoted as `a_b`, `A::b` or
  // `a()`.
  static const std::regex kQuoted("`((?:[A-Za-z]\\w*::)*[A-Za-z]\\w*)(\\(\\))?`");
  std::set<std::string> words;
  for (const auto& file : files()) {
    if (file.extension() != ".md") add_words(text_in(file), words);
    words.insert(file.stem().string());
  }
  std::size_t quoted = 0;
  for (const auto& page : pages()) {
    if (page.filename() == "CHANGELOG.md") continue;  // it tells of what was
    const std::string text = text_in(page);
    for (std::sregex_iterator it(text.begin(), text.end(), kQuoted), end; it != end; ++it) {
      const std::string name = (*it)[1];
      if (name.find_first_of("_:") == std::string::npos && !(*it)[2].matched) continue;
      INFO(fs::relative(page, kRoot).string() << ": " << name);
      std::set<std::string> parts;
      add_words(name, parts);
      for (const auto& part : parts) CHECK(words.contains(part));
      ++quoted;
    }
  }
  CHECK(quoted > 300);
}

TEST_CASE("pages: every folder of sources says what lives there") {
  // Oracle: a README in each folder that holds code; tests mirror the tree and need none.
  std::size_t folders = 0;
  for (const char* top : {"modules", "deformation", "collision", "haptics", "visualizer", "palpate",
                          "studies", "bench", "python"}) {
    std::vector<fs::path> found{kRoot / top};
    for (const auto& entry : fs::recursive_directory_iterator(kRoot / top)) {
      if (entry.is_directory()) found.push_back(entry.path());
    }
    for (const auto& folder : found) {
      INFO(fs::relative(folder, kRoot).string());
      CHECK(fs::exists(folder / "README.md"));
      ++folders;
    }
  }
  CHECK(folders > 30);
}

TEST_CASE("pages: the tests they name exist") {
  // Oracle: the TEST_CASE names of the tree. A page names a test as *"subject: what holds"*.
  static const std::regex kTest(R"re(\*"([^"]+: [^"]+)"\*)re");
  std::string tests;
  for (const auto& entry : fs::recursive_directory_iterator(kRoot / "tests")) {
    if (entry.path().extension() == ".cpp") tests += text_in(entry.path());
  }
  std::size_t named = 0;
  for (const auto& page : pages()) {
    const std::string text = std::regex_replace(text_in(page), std::regex("\\s+"), " ");
    for (std::sregex_iterator it(text.begin(), text.end(), kTest), end; it != end; ++it, ++named) {
      INFO(fs::relative(page, kRoot).string() << ": " << (*it)[1]);
      CHECK(tests.find("TEST_CASE(\"" + (*it)[1].str() + "\"") != std::string::npos);
    }
  }
  CHECK(named >= 5);
}

}  // namespace

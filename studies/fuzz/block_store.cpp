#include "studies/fuzz/block_store.h"

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <sstream>

#include "studies/report/measures.h"
#include "studies/report/table_file.h"

namespace palpate::fuzz {
namespace {

/// Raised when the generator or what counts as a failure changes.
constexpr int kVersion = 5;

/// One cell: no commas, quotation marks or ends of lines.
std::string cell_text(std::string text) {
  std::replace_if(
      text.begin(), text.end(), [](char c) { return c == ',' || c == '"' || c == '\n'; }, ' ');
  return text;
}

bool parse(const std::string& line, Outcome& out) {
  std::istringstream cells(line);
  std::string cell;
  if (!std::getline(cells, cell, ',')) return false;
  out.ending = static_cast<Ending>(std::atoi(cell.c_str()));
  if (!std::getline(cells, cell, ',')) return false;
  out.unguarded = static_cast<Unguarded>(std::atoi(cell.c_str()));
  if (!std::getline(cells, cell, ',')) return false;
  out.time = std::strtod(cell.c_str(), nullptr);
  for (auto& guard : out.guards) {
    if (!std::getline(cells, cell, ',')) return false;
    guard = static_cast<std::uint32_t>(std::strtoul(cell.c_str(), nullptr, 10));
  }
  std::getline(cells, out.what);
  return true;
}

}  // namespace

BlockStore::BlockStore(const std::filesystem::path& folder, std::uint64_t seed, std::ostream& log)
    : files_(folder, log), seed_(seed) {
  report::make_out_folder(folder);
}

std::string BlockStore::name_of(std::uint64_t first, std::size_t count) const {
  return fmt::format("seed{}-{:06}-{}-v{}", seed_, first, count, kVersion);
}

bool BlockStore::read(std::uint64_t first, std::size_t count, std::vector<Outcome>& out) const {
  std::istringstream stream(files_.read(name_of(first, count) + ".csv").value_or(""));
  std::string line;
  if (!std::getline(stream, line)) return false;
  out.clear();
  while (std::getline(stream, line)) {
    if (!parse(line, out.emplace_back())) return false;
  }
  return out.size() == count;
}

void BlockStore::write(std::uint64_t first, const std::vector<Outcome>& outcomes) const {
  std::vector<std::string> columns{"ending", "unguarded", "time_s"};
  columns.insert(columns.end(), kGuardNames.begin(), kGuardNames.end());
  columns.push_back("what");
  std::string text = report::table_line(columns);
  for (const Outcome& outcome : outcomes) {
    std::vector<std::string> cells{std::to_string(int(outcome.ending)),
                                   std::to_string(int(outcome.unguarded)),
                                   fmt::format("{:.6g}", outcome.time)};
    for (const auto guard : outcome.guards) cells.push_back(std::to_string(guard));
    cells.push_back(cell_text(outcome.what));
    text += report::table_line(cells);
  }
  files_.write(name_of(first, outcomes.size()) + ".csv", text);
}

}  // namespace palpate::fuzz

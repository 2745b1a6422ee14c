#include "bench/accuracy/case_parts.h"

#include <spdlog/fmt/fmt.h>

#include <cmath>
#include <fstream>
#include <sstream>

#include "modules/core/error.h"

namespace palpate::accuracy {
namespace {

std::vector<std::string> cells_of(const std::string& line) {
  std::vector<std::string> cells;
  std::istringstream stream(line);
  for (std::string cell; std::getline(stream, cell, ',');) cells.push_back(cell);
  return cells;
}

}  // namespace

ReferenceTable::ReferenceTable(const std::filesystem::path& file) : file_(file) {
  std::ifstream stream(file);
  std::string line;
  if (!std::getline(stream, line)) {
    throw InputError(fmt::format("{}: no such reference table", file.string()));
  }
  const auto names = cells_of(line);
  for (std::size_t number = 2; std::getline(stream, line); ++number) {
    const auto cells = cells_of(line);
    for (std::size_t i = 0; i < names.size(); ++i) {
      char* end = nullptr;
      const std::string cell = i < cells.size() ? cells[i] : "";
      const double value = std::strtod(cell.c_str(), &end);
      // Words, as of mode families, stay out of reach as numbers that are none.
      columns_[names[i]].push_back(end == cell.c_str() ? kUnknown : value);
    }
    ++rows_;
  }
}

double ReferenceTable::at(const std::string& column, std::size_t row) const {
  const auto found = columns_.find(column);
  if (found == columns_.end()) {
    throw InputError(fmt::format("{}:1: column '{}' is missing", file_.string(), column));
  }
  return found->second.at(row);
}

std::size_t ReferenceTable::row_of(const std::string& column, double value) const {
  for (std::size_t row = 0; row < rows_; ++row) {
    if (std::abs(at(column, row) - value) < 1e-9) return row;
  }
  throw InputError(fmt::format("{}: no row with {} = {:g}", file_.string(), column, value));
}

Pose plate(double height, bool facing_up) {
  Pose pose;
  pose.position = Vec3(0, 0, height);
  if (!facing_up) pose.rotation = Quat(0, 1, 0, 0);
  return pose;
}

void move_and_settle(Stage& stage, std::vector<Pose>& poses, const std::vector<Vec3>& to,
                     double speed, const KeepGoing& keep_going) {
  double longest = 0;
  for (std::size_t i = 0; i < poses.size(); ++i) {
    longest = std::max(longest, (to[i] - poses[i].position).norm());
  }
  const int steps = std::max(1, static_cast<int>(std::ceil(longest / (speed * stage.period()))));
  const std::vector<Pose> from = poses;
  for (int k = 1; k <= steps; ++k) {
    keep_going();
    for (std::size_t i = 0; i < poses.size(); ++i) {
      poses[i].position = from[i].position + double(k) / steps * (to[i] - from[i].position);
    }
    stage.advance(poses);
  }
  keep_going();
  stage.settle(kLongestSettling);
}

Measurement summary(const Stage& stage, const geometry::OrganShape& shape) {
  Measurement result;
  result.surface_nodes = shape.surface.nodes.size();
  result.inner_nodes = shape.inner_nodes.size();
  result.tetrahedra = shape.tetrahedra.size();
  result.step = stage.step();
  result.cost = stage.time() > 0 ? stage.busy() / stage.time() : 0;
  result.volume_error = stage.volume_error();
  result.diverged = stage.diverged();
  return result;
}

}  // namespace palpate::accuracy

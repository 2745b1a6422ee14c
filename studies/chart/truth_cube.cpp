#include "studies/chart/truth_cube.h"

#include <Eigen/QR>
#include <cmath>
#include <cstdlib>
#include <fstream>
#include <numeric>
#include <sstream>

#include "modules/core/error.h"
#include "modules/core/input_file.h"
#include "modules/core/polar_decomposition.h"

namespace palpate::chart {
namespace {

constexpr int kHeaderLines = 7, kColumns = 15;
constexpr std::array kCompressions{0.05, 0.125, 0.1825};

Vec3 mean(const std::vector<Vec3>& points) {
  const Vec3 sum = std::accumulate(points.begin(), points.end(), Vec3(Vec3::Zero()));
  return sum / static_cast<double>(points.size());
}

std::array<double, kColumns> numbers_of(const std::string& line, const std::string& place) {
  std::array<double, kColumns> numbers{};
  std::istringstream stream(line);
  std::string cell;
  for (double& number : numbers) {
    char* end = nullptr;
    if (std::getline(stream, cell, ',')) number = std::strtod(cell.c_str(), &end);
    if (end == nullptr || end == cell.c_str()) {
      throw InputError(place + ": 15 numbers are wanted: i, j, k and four positions [mm]");
    }
  }
  return numbers;
}

/// All monomials of x, y, z up to the fifth degree.
Eigen::MatrixXd monomials(const std::vector<Vec3>& points) {
  constexpr int kDegree = 5;
  const Vec3 centre = mean(points);
  Eigen::MatrixXd values(static_cast<long>(points.size()), 56);
  for (std::size_t row = 0; row < points.size(); ++row) {
    const Vec3 p = (points[row] - centre) / 0.03;
    int column = 0;
    for (int i = 0; i <= kDegree; ++i) {
      for (int j = 0; i + j <= kDegree; ++j) {
        for (int k = 0; i + j + k <= kDegree; ++k) {
          values(static_cast<long>(row), column++) =
              std::pow(p.x(), i) * std::pow(p.y(), j) * std::pow(p.z(), k);
        }
      }
    }
  }
  return values;
}

}  // namespace

std::optional<std::filesystem::path> truth_cube_folder() {
  const char* data = std::getenv("PALPATE_DATA");
  if (data == nullptr) return {};
  const auto folder = std::filesystem::path(data) / "truthcube";
  return std::filesystem::exists(folder) ? std::optional(folder) : std::nullopt;
}

TruthCube read_truth_cube(const std::filesystem::path& folder) {
  const auto file = folder / "truthcube_uniaxial_positions.csv";
  std::ifstream stream = open_input(file);
  TruthCube cube;
  std::string line;
  for (int number = 1; std::getline(stream, line); ++number) {
    if (number <= kHeaderLines || line.empty() || line[0] == ',') continue;
    const auto values = numbers_of(line, file.string() + ":" + std::to_string(number));
    const auto at = [&](std::size_t state) {
      const double* p = &values[3 + 3 * state];
      return Vec3(1e-3 * Vec3(p[0], -p[1], -p[2]));  // half a turn about x
    };
    cube.rest.push_back(at(0));
    for (std::size_t s = 0; s < kCompressions.size(); ++s) {
      cube.states[kCompressions[s]].push_back(at(s + 1));
    }
  }
  if (cube.rest.empty()) throw InputError(file.string() + ": holds no beads");
  const Vec3 shift = Vec3(0, 0, 0.04) - mean(cube.rest);
  for (Vec3& bead : cube.rest) bead += shift;
  for (auto& [compression, beads] : cube.states) {
    for (Vec3& bead : beads) bead += shift;
  }
  return cube;
}

double distance_after_fit(const std::vector<Vec3>& moved, const std::vector<Vec3>& measured) {
  PALPATE_DEMAND(moved.size() == measured.size() && !moved.empty());
  const Vec3 from = mean(moved), to = mean(measured);
  Mat3 spread = Mat3::Zero();
  for (std::size_t i = 0; i < moved.size(); ++i) {
    spread += (measured[i] - to) * (moved[i] - from).transpose();
  }
  const Mat3 turn = nearest_rotation(spread);
  double sum = 0;
  for (std::size_t i = 0; i < moved.size(); ++i) {
    sum += (to + turn * (moved[i] - from) - measured[i]).squaredNorm();
  }
  return std::sqrt(sum / static_cast<double>(moved.size()));
}

double tracking_noise(const TruthCube& cube, double compression) {
  const auto& beads = cube.states.at(compression);
  Eigen::MatrixXd displacement(static_cast<long>(beads.size()), 3);
  for (std::size_t i = 0; i < beads.size(); ++i) {
    displacement.row(static_cast<long>(i)) = (beads[i] - cube.rest[i]).transpose();
  }
  const Eigen::MatrixXd smooth = monomials(cube.rest);
  const Eigen::MatrixXd fitted =
      smooth * Eigen::MatrixXd(smooth.colPivHouseholderQr().solve(displacement));
  const auto freedom = static_cast<double>(smooth.rows() - smooth.cols());
  return std::sqrt((displacement - fitted).squaredNorm() / freedom);
}

}  // namespace palpate::chart

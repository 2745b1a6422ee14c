// The most accurate model against reference solutions of another finite-element package.
//   A  solid ball between frictionless plates           (an octant)
//   C  block with bonded ends, compressed               (an octant)
//   D  block indented by a frictionless sphere of 5 mm  (a quarter)
//   E  free vibration of a ball against Lamb's exact roots  (the whole ball)
// Tissue: E = 5 kPa, ν = 0.499.
#pragma once

#include <filesystem>
#include <functional>
#include <string>
#include <vector>

namespace palpate::elements_bench {

struct Setting {
  std::filesystem::path reference_folder;
  bool quick = false;                                   ///< fewer load steps
  std::function<void()> keep_going;                     ///< asked several times a second; may throw
  std::function<void(const std::string& line)> report;  ///< progress
};

struct ErrorRow {
  double load = 0;   ///< compression [1], depth [m]; for E the exact frequency [Hz]
  double force = 0;  ///< [N]; for E the frequency [Hz]
  double reference_force = 0;
  double bulge = 0;  ///< growth of the half-width [m]; 0: none measured (D, E)
  double reference_bulge = 0;
  int iterations = 0;  ///< of Newton since the row before
};

struct Run {
  double size = 0;  ///< finest wanted edge length over the case's length, see default_sizes()
  std::size_t nodes = 0, elements = 0, unknowns = 0;
  std::vector<ErrorRow> rows;  ///< those reached
  bool complete = true;        ///< false: Newton failed at a load beyond the last row
};

/// "A", "C", "D", "E".
const std::vector<std::string>& case_names();
/// Coarse to fine, relative to the radius of ball or indenter, or half the width of the block.
std::vector<double> default_sizes(const std::string& name, bool quick);

/// Runs one case on one mesh.
/// @throws InputError if gmsh or a reference table is missing; what keep_going throws
Run run_case(const std::string& name, double size, const Setting& setting);

}  // namespace palpate::elements_bench

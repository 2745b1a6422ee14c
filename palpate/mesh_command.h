// What `palpate mesh IN -o OUT [--nodes N] [--unit mm] [--largest] [--fill-holes]` does, and with
// `--near TRAJECTORY --radius-m R`.
#pragma once

#include <filesystem>
#include <iosfwd>
#include <string>

#include "palpate/mesh_near_motion.h"

namespace palpate::geometry {

struct MeshCommandOptions {
  std::filesystem::path input;
  /// Empty: check only; else .ply, .stl, .obj or .off, of tetrahedra .msh, in metres.
  std::filesystem::path output;
  std::size_t node_count = 0;  ///< to decimate or refine to; 0: keep
  std::string unit = "m";      ///< of the input's numbers, see metres_per_unit()
  bool largest = false;        ///< keep the shell that encloses most
  bool fill_holes = false;     ///< close what is open
  bool overwrite = false;      ///< a file that is there already
  bool json = false;           ///< the report as JSON
  NearMotion near = {};        ///< fills it with tetrahedra, small where this touches
};

/// Of a command that takes surfaces: says what a scene does with a file of tetrahedra.
/// @param tool  what the command does instead, for the message
/// @throws InputError always: as read_tetrahedra(), or that it holds tetrahedra
[[noreturn]] void refuse_tetrahedra(const std::filesystem::path& file, const std::string& tool);

/// Reads, repairs, resamples and refines where asked, and prints a one-screen report to `out`;
/// writes the result only if it holds a volume. What is wrong goes to `err`.
/// @return kExitDone, kExitBadInput (not written, or not replaced), kExitStopped, or kExitFailed if
/// writing failed
int run_mesh_command(const MeshCommandOptions& options, std::ostream& out, std::ostream& err);

}  // namespace palpate::geometry

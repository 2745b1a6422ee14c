#include "modules/geometry/tools/gmsh_tool.h"

#include <fcntl.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cmath>
#include <csignal>
#include <cstdlib>
#include <cstring>
#include <fstream>
#include <sstream>
#include <stdexcept>
#include <vector>

#include "modules/core/error.h"
#include "modules/core/input_file.h"
#include "modules/core/organ_limits.h"
#include "modules/core/stop_signal.h"
#include "modules/core/temporary_folder.h"
#include "modules/core/text.h"
#include "modules/geometry/gmsh_file.h"
#include "modules/geometry/mesh_io.h"

namespace palpate::geometry {
namespace {

/// In the child, after fork: only what is safe there. The kernel ends it with the thread that
/// started it.
[[noreturn]] void become(char* const* arguments, const char* log, pid_t parent) {
  ::prctl(PR_SET_PDEATHSIG, SIGKILL);
  const int output = ::open(log, O_WRONLY | O_CREAT | O_TRUNC, 0600);
  ::dup2(output, STDOUT_FILENO);
  ::dup2(output, STDERR_FILENO);
  if (::getppid() == parent) ::execvp(arguments[0], arguments);
  ::_exit(127);
}

constexpr const char* kStoppedMeshing = "stopped while Gmsh made tetrahedra";

/// Runs the program found in PATH, both outputs into `log`. @returns exit status, 127 if not found,
/// or not loaded
/// @throws Interrupted if a signal of StopSignal comes, or ends the program with those of its
///         terminal
int run(std::vector<std::string> words, const std::filesystem::path& log) {
  std::vector<char*> arguments;
  arguments.reserve(words.size() + 1);
  for (std::string& word : words) arguments.push_back(word.data());
  arguments.push_back(nullptr);
  const StopSignal stop;
  const pid_t parent = ::getpid(), child = ::fork();
  if (child < 0) throw std::runtime_error(words[0] + ": cannot be started");
  if (child == 0) become(arguments.data(), log.c_str(), parent);
  int status = 0;
  while (::waitpid(child, &status, WNOHANG) == 0) {  // asked again: a signal may come before a wait
    if (stop.requested()) ::kill(child, SIGKILL);
    ::usleep(2000);
  }
  const int ended_by = WIFSIGNALED(status) ? WTERMSIG(status) : 0;
  if (stop.requested() || ended_by == SIGINT || ended_by == SIGTERM || ended_by == SIGHUP) {
    throw Interrupted(kStoppedMeshing);
  }
  return WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
}

/// Lines of Gmsh's log that say what is wrong.
std::string complaints(const std::filesystem::path& log) {
  std::ifstream stream(log);
  std::string found;
  for (std::string line; std::getline(stream, line);) {
    if (line.rfind("Error", 0) != 0) continue;
    if (!found.empty()) found += "; ";
    const std::string words = after_colon(line);
    found += words.empty() ? line : words;
  }
  return found;
}

bool is_in_path(const std::string& program) {
  const char* const path = std::getenv("PATH");
  std::istringstream folders(path == nullptr ? "/bin:/usr/bin" : path);
  for (std::string folder; std::getline(folders, folder, ':');) {
    if (::access((std::filesystem::path(folder) / program).c_str(), X_OK) == 0) return true;
  }
  return false;
}

/// Of one that is there: its loader's words, of memory that a limit denies, say.
std::string why_not_started(const std::filesystem::path& log) {
  std::ifstream stream(log);
  std::string words;
  std::getline(stream, words);
  return "gmsh: is installed, but cannot be started; is there memory for it?" +
         (words.empty() ? "" : " " + words);
}

std::string number(double value) {
  std::ostringstream text;
  text.precision(17);
  text << value;
  return text.str();
}

std::string point(const Vec3& p) {
  std::string text = number(p.x());
  text.append(", ").append(number(p.y())).append(", ").append(number(p.z()));
  return text;
}

/// Edge lengths from an expression everywhere, not from corners or the boundary.
std::string size_field(const std::string& size) {
  std::string text = "Mesh.CharacteristicLengthFromPoints = 0;\n";
  text.append("Mesh.CharacteristicLengthExtendFromBoundary = 0;\n");
  text.append("Field[1] = MathEval;\nField[1].F = \"").append(size).append("\";\n");
  text.append("Background Field = 1;\n");
  return text;
}

TetMesh run_gmsh_with(const TemporaryFolder& folder, std::vector<std::string> options) {
  const auto output = folder / "solid.msh", log = folder / "log";
  std::vector<std::string> words{"gmsh", "-format", "msh22", "-nt", "1", "-o", output.string()};
  words.insert(words.end(), options.begin(), options.end());
  const int status = run(std::move(words), log);
  if (status == 127 && is_in_path("gmsh")) throw std::runtime_error(why_not_started(log));
  if (status == 127) {
    throw InputError("gmsh: not found; tetrahedra are made by it (apt-get install gmsh)");
  }
  const std::string wrong = complaints(log);
  if (status > 128) {
    const std::string signal = ::strsignal(status - 128);
    throw InputError("gmsh: broke down (" + signal + ")" + (wrong.empty() ? "" : ": " + wrong));
  }
  if (status != 0 || !wrong.empty()) {
    const std::string said = wrong.empty() ? "without a word of why" : wrong;
    throw InputError("gmsh: exit status " + std::to_string(status) + ": " + printable(said));
  }
  try {
    TetMesh mesh = read_gmsh(output);
    if (StopSignal().requested()) throw Interrupted(kStoppedMeshing);
    return mesh;
  } catch (const InputError& error) {  // "/tmp/…/solid.msh:12: what": nobody knows that file
    const std::string text = error.what();
    throw InputError(text.substr(text.find(": ") + 2));
  }
}

TetMesh run_gmsh_in(const TemporaryFolder& folder, const std::string& script) {
  const auto input = folder / "solid.geo";
  std::ofstream(input) << script;
  return run_gmsh_with(folder, {"-3", input.string()});
}

bool is_msh_2(const std::filesystem::path& file) {
  std::ifstream stream(file);
  std::string section, version, kind;
  stream >> section >> version >> kind;
  return section == "$MeshFormat" && version == "2.2" && kind == "0";
}

/// Gmsh would go on for hours. Tetrahedra with edges h have about √2/h³ nodes; so many are refused
/// that half of them would still be too many.
void refuse_too_many_nodes(const TriangleSurface& surface, double size) {
  const double volume = std::abs(enclosed_volume(surface.nodes, surface.triangles));
  const double nodes = std::sqrt(2.0) * volume / (size * size * size);
  if (nodes <= 2.0 * kMaxNodes) return;
  std::ostringstream text;
  text.precision(2);
  text << "elements of " << size << " m would need some " << nodes << " nodes, at most "
       << double{kMaxNodes} << " are allowed: choose "
       << std::cbrt(std::sqrt(2.0) * volume / kMaxNodes) << " m or more";
  throw InputError(text.str());
}

}  // namespace

TetMesh run_gmsh(const std::string& script) { return run_gmsh_in(TemporaryFolder(), script); }

bool is_tetrahedra_file(const std::filesystem::path& file) {
  return file.extension() == ".msh" || file.extension() == ".vtk";
}

TetMesh read_tetrahedra(const std::filesystem::path& file) {
  check_input(file, kMaxMeshFileBytes);
  if (std::filesystem::file_size(file) == 0) throw InputError(file.string() + ": is empty");
  if (is_msh_2(file)) return read_gmsh(file);
  try {
    return run_gmsh_with(TemporaryFolder(), {"-save_all", "-save", file.string()});
  } catch (const InputError& error) {
    throw InputError(file.string() + ": " + error.what());
  }
}

TetMesh fill_surface(const TriangleSurface& surface, double size) {
  refuse_too_many_nodes(surface, size);
  const TemporaryFolder folder;
  const auto file = folder / "surface.msh";
  write_gmsh(surface, file);
  std::string script = "Merge \"";
  script.append(file.string()).append("\";\nSurface Loop(1) = {1};\nVolume(1) = {1};\n");
  script.append("Mesh.SaveAll = 1;\n");
  script.append("Mesh.CharacteristicLengthMax = ").append(number(size)).append(";\n");
  TetMesh mesh = run_gmsh_in(folder, script);
  const std::size_t count = surface.nodes.size();
  // Gmsh writes 16 digits; a node that is not where it was has been moved or renumbered.
  for (std::size_t i = 0; i < count; ++i) {
    if (i >= mesh.nodes.size() ||
        (mesh.nodes[i] - surface.nodes[i]).norm() > 1e-12 * (1 + surface.nodes[i].norm())) {
      throw InputError("gmsh: node " + std::to_string(i) + " of the surface was not kept");
    }
    mesh.nodes[i] = surface.nodes[i];
  }
  if (boundary_triangles(mesh).size() != surface.triangles.size()) {
    throw InputError("gmsh: the triangles of the surface were not kept");
  }
  return mesh;
}

TetMesh mesh_ball(double radius, BallPart part, const std::string& size) {
  std::string script = "SetFactory(\"OpenCASCADE\");\nSphere(1) = {0, 0, 0, ";
  script.append(number(radius));
  script.append(part == BallPart::kOctant ? ", 0, Pi/2, Pi/2};\n" : "};\n")
      .append(size_field(size));
  TetMesh mesh = run_gmsh(script);
  // Gmsh leaves 1e-17 where symmetry says 0, and 1e-9 of the radius on the sphere.
  for (Vec3& node : mesh.nodes) {
    for (int i = 0; i < 3; ++i) {
      if (std::abs(node[i]) < 1e-9 * radius) node[i] = 0;
    }
    if (std::abs(node.norm() - radius) < 1e-6 * radius) node *= radius / node.norm();
  }
  return mesh;
}

TetMesh mesh_block(const Vec3& low, const Vec3& high, const std::string& size) {
  std::string script = "SetFactory(\"OpenCASCADE\");\nBox(1) = {";
  script.append(point(low)).append(", ").append(point(high - low)).append("};\n");
  TetMesh mesh = run_gmsh(script + size_field(size));
  const double snap = 1e-9 * (high - low).norm();
  for (Vec3& node : mesh.nodes) {
    for (int i = 0; i < 3; ++i) {
      if (std::abs(node[i] - low[i]) < snap) node[i] = low[i];
      if (std::abs(node[i] - high[i]) < snap) node[i] = high[i];
    }
  }
  return mesh;
}

}  // namespace palpate::geometry

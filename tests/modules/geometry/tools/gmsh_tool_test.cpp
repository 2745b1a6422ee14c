#include "modules/geometry/tools/gmsh_tool.h"

#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <catch2/catch.hpp>
#include <chrono>
#include <cstdlib>
#include <fstream>
#include <thread>

#include "modules/core/error.h"
#include "modules/geometry/primitives.h"
#include "tests/modules/geometry/scratch.h"
#include "tests/modules/geometry/tetrahedra.h"

namespace palpate::geometry {
namespace {

/// Stands for a Gmsh that works for long: the first in PATH as long as this object lives.
class SlowGmsh {
 public:
  SlowGmsh() : path_(std::getenv("PATH")) {
    const auto program = folder_.write("gmsh", "#!/bin/sh\necho $$ > \"$0.id\"\nexec sleep 100\n");
    std::filesystem::permissions(program, std::filesystem::perms::owner_all);
    ::setenv("PATH", (program.parent_path().string() + ":" + path_).c_str(), 1);
  }
  ~SlowGmsh() { ::setenv("PATH", path_.c_str(), 1); }

  /// Of the one that works; 0: none yet.
  pid_t process_id() const {
    pid_t id = 0;
    std::ifstream(folder_ / "gmsh.id") >> id;
    return id;
  }

 private:
  ScratchFolder folder_;
  std::string path_;
};

template <class Holds>
bool comes_true(const Holds& holds) {
  for (int i = 0; i < 2000; ++i) {
    if (holds()) return true;
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
  }
  return false;
}

/// Gone, or a zombie that waits for init.
bool is_over(pid_t process) {
  std::ifstream status("/proc/" + std::to_string(process) + "/status");
  for (std::string line; std::getline(status, line);) {
    if (line.starts_with("State:")) return line.find('Z') != std::string::npos;
  }
  return true;
}

/// A process that meshes, with its temporary folders in one of its own: kExitStopped once Gmsh was
/// interrupted.
pid_t start_meshing(const std::filesystem::path& temporary) {
  const pid_t child = ::fork();
  if (child > 0) return child;
  ::setpgid(0, 0);  // as a job of a terminal
  ::setenv("TMPDIR", temporary.c_str(), 1);
  try {
    mesh_ball(0.05, BallPart::kWhole, "0.02");
  } catch (const Interrupted&) {
    ::_exit(kExitStopped);
  }
  ::_exit(kExitFailed);
}

TEST_CASE("gmsh tool: it ends with the program that runs it, however that ends") {
  // Oracle: the kernel's table of processes.
  const SlowGmsh gmsh;
  const ScratchFolder temporary;
  const pid_t meshing = start_meshing(temporary.path());
  REQUIRE(comes_true([&] { return gmsh.process_id() > 0; }));
  ::kill(meshing, SIGKILL);
  ::waitpid(meshing, nullptr, 0);
  CHECK(comes_true([&] { return is_over(gmsh.process_id()); }));
}

TEST_CASE("gmsh tool: a signal that asks for an end ends it with a word and leaves no folder") {
  // Oracle: the exit code, the file system, and the kernel's table of processes. A terminal sends
  // it to Gmsh, too.
  const int signal = GENERATE(SIGINT, SIGTERM, SIGHUP);
  const bool to_both = GENERATE(false, true);
  const SlowGmsh gmsh;
  const ScratchFolder temporary;
  const pid_t meshing = start_meshing(temporary.path());
  REQUIRE(comes_true([&] { return gmsh.process_id() > 0; }));
  ::kill(to_both ? -meshing : meshing, signal);
  int status = -1;
  REQUIRE(comes_true([&] { return ::waitpid(meshing, &status, WNOHANG) == meshing; }));
  CHECK(WIFEXITED(status));
  CHECK(WEXITSTATUS(status) == kExitStopped);
  CHECK(is_over(gmsh.process_id()));
  CHECK(std::filesystem::is_empty(temporary.path()));
}

TEST_CASE("gmsh tool: a filled surface keeps its nodes and triangles, first and in order") {
  // Oracle: the surface itself, to the last bit; its enclosed volume.
  if (testing::without_gmsh()) return;
  const auto ball = make_ball(0.05, 2);
  const auto mesh = fill_surface(ball, 0.02);
  REQUIRE(mesh.nodes.size() > ball.nodes.size());
  for (std::size_t i = 0; i < ball.nodes.size(); ++i) CHECK(mesh.nodes[i] == ball.nodes[i]);
  auto sorted = [](Triangle t) {
    std::rotate(t.begin(), std::min_element(t.begin(), t.end()), t.end());
    return t;
  };
  std::vector<Triangle> wanted, found;
  for (const auto& triangle : ball.triangles) wanted.push_back(sorted(triangle));
  for (const auto& triangle : boundary_triangles(mesh)) found.push_back(sorted(triangle.nodes));
  std::sort(wanted.begin(), wanted.end());
  std::sort(found.begin(), found.end());
  CHECK(found == wanted);
  CHECK(testing::volume_of(mesh) == Approx(enclosed_volume(ball.nodes, ball.triangles)));
}

TEST_CASE("gmsh tool: an octant of a ball lies on its planes and its sphere, a block is a block") {
  // Oracle: geometry. Chords of 15 mm cut 4 % off the octant's π R³/6.
  if (testing::without_gmsh()) return;
  const auto octant = mesh_ball(0.05, BallPart::kOctant, "0.015");
  double farthest = 0;
  for (const Vec3& p : octant.nodes) {
    CHECK(p.minCoeff() >= 0);
    farthest = std::max(farthest, p.norm());
  }
  CHECK(farthest == Approx(0.05).epsilon(1e-12));
  CHECK(testing::volume_of(octant) == Approx(3.14159265 * 0.05 * 0.05 * 0.05 / 6).epsilon(0.05));
  const auto block = mesh_block({0, 0, 0}, {0.04, 0.04, 0.08}, "0.02 + 0*x");
  CHECK(testing::volume_of(block) == Approx(0.04 * 0.04 * 0.08));
}

TEST_CASE("gmsh tool: what it cannot do is said") {
  // Oracle: the stated messages; PATH without gmsh.
  const std::string path = std::getenv("PATH");
  ::setenv("PATH", "/nowhere", 1);
  CHECK_THROWS_WITH(mesh_ball(0.05, BallPart::kWhole, "0.02"), Catch::Contains("gmsh: not found"));
  // A loader that fails ends with 127, too.
  const ScratchFolder folder;
  const auto script =
      folder.write("gmsh", "#!/bin/sh\necho gmsh: cannot map a segment\nexit 127\n");
  std::filesystem::permissions(script, std::filesystem::perms::owner_all);
  ::setenv("PATH", (folder.path().string() + ":" + path).c_str(), 1);
  CHECK_THROWS_WITH(mesh_ball(0.05, BallPart::kWhole, "0.02"),
                    "gmsh: is installed, but cannot be started; is there memory for it? gmsh: "
                    "cannot map a segment");
  folder.write("gmsh", "#!/bin/sh\nkill -ABRT $$\n");
  const auto mesh = folder.write("organ.vtk", "no mesh");
  CHECK_THROWS_WITH(read_tetrahedra(mesh), mesh.string() + ": gmsh: broke down (Aborted)");
  folder.write("gmsh", "#!/bin/sh\necho 'Error   :'\nexit 0\n");
  CHECK_THROWS_WITH(read_tetrahedra(mesh), Catch::EndsWith("exit status 0: Error   :"));
  folder.write("gmsh", "#!/bin/sh\nexit 3\n");
  CHECK_THROWS_WITH(read_tetrahedra(mesh), Catch::EndsWith("exit status 3: without a word of why"));
  ::setenv("PATH", path.c_str(), 1);
  if (testing::without_gmsh()) return;
  CHECK_THROWS_AS(run_gmsh("Box(1) = {"), InputError);
  auto open = make_ball(0.05, 1);
  open.triangles.pop_back();
  CHECK_THROWS_AS(fill_surface(open, 0.02), InputError);
}

TEST_CASE("gmsh tool: what would need far too many nodes is refused at once") {
  // Oracle: the message; a ball of 0.52 l holds some 7e8 nodes 0.1 mm apart.
  CHECK_THROWS_WITH(fill_surface(make_ball(0.05, 3), 1e-4), Catch::Contains("choose 0.0015 m"));
}

TEST_CASE("gmsh tool: a file without tetrahedra is refused by its own name") {
  // Oracle: the message. One triangle, as VTK's legacy format has it.
  if (testing::without_gmsh()) return;
  const ScratchFolder folder;
  const auto file = folder / "shell.vtk";
  std::ofstream(file) << "# vtk DataFile Version 2.0\nshell\nASCII\nDATASET UNSTRUCTURED_GRID\n"
                         "POINTS 3 double\n0 0 0\n1 0 0\n0 1 0\n"
                         "CELLS 1 4\n3 0 1 2\nCELL_TYPES 1\n5\n";
  CHECK_THROWS_WITH(read_tetrahedra(file),
                    file.string() +
                        ": no tetrahedra, which files of this kind are read as; convert a surface "
                        "to .ply, .stl, .obj or .off first");
}

}  // namespace
}  // namespace palpate::geometry

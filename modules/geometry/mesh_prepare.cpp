#include "modules/geometry/mesh_prepare.h"

#include "modules/core/error.h"
#include "modules/geometry/mesh_io.h"

namespace palpate::geometry {

TriangleSurface load_organ_surface(const std::filesystem::path& file, std::string_view unit,
                                   std::size_t node_count,
                                   const std::function<void(const TriangleSurface&)>& admit,
                                   const std::function<void(double)>& progress) {
  TriangleSurface surface = read_surface(file, unit);
  repair_surface(surface);
  try {
    if (node_count > 0) surface = resample_surface(surface, node_count, progress);
    if (admit) admit(surface);
  } catch (const InputError& error) {
    throw InputError(file.string() + ": " + error.what());
  }
  const MeshReport report = check_surface(surface);
  if (report.holds_volume()) return surface;
  std::string message = file.string() + ": cannot hold a volume";
  for (const std::string& problem : describe_problems(report, surface)) message += "; " + problem;
  throw InputError(message);
}

}  // namespace palpate::geometry

#include "modules/core/units.h"

#include <array>
#include <utility>

#include "modules/core/error.h"

namespace palpate {

double metres_per_unit(std::string_view unit) {
  constexpr std::array<std::pair<std::string_view, double>, 6> kUnits{
      {{"m", 1.0}, {"dm", 0.1}, {"cm", 0.01}, {"mm", 1e-3}, {"um", 1e-6}, {"in", 0.0254}}};
  for (const auto& [name, metres] : kUnits) {
    if (name == unit) return metres;
  }
  throw InputError("unit '" + std::string(unit) + "' is not known; allowed: m, dm, cm, mm, um, in");
}

}  // namespace palpate

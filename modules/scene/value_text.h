// Numbers and names as they are written in scenes, tables and messages.
#pragma once

#include <string>

#include "modules/core/types.h"

namespace palpate::scene {

/// Fewest digits that read back to the same double.
std::string number_text(double value);
std::string list_text(const Vec3& value);  ///< "[x, y, z]"
std::string list_text(const Quat& value);  ///< "[x, y, z, w]"

/// In double quotes, with escapes where YAML needs them.
std::string quoted_text(const std::string& text);

}  // namespace palpate::scene

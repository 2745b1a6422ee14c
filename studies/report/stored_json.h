// Results a study keeps in its folder, so that it goes on where it was stopped.
#pragma once

#include <json/value.h>

#include <optional>
#include <string>

#include "studies/report/point_files.h"

namespace palpate::report {

/// What was stored there of the same inputs; none: nothing, not whole, or of others.
/// @param of  all that the result depends on, in words
std::optional<Json::Value> stored_json(const PointFiles& files, const std::string& name,
                                       const std::string& of);

/// Keeps a result; numbers come back with the same bits, also those that are not finite.
/// @throws std::runtime_error if it cannot be written
void store_json(const PointFiles& files, const std::string& name, const std::string& of,
                Json::Value result);

}  // namespace palpate::report

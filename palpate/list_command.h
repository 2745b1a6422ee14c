// `palpate list`: what there is to choose from.
#pragma once

#include <iosfwd>
#include <string>
#include <vector>

namespace palpate::launcher {

/// Shipped scenes, models, shapes of probes and devices, each with a line on what it is.
/// @param kind  one of list_kinds(); empty: all
/// @return an exit code of core/error.h
int list_command(const std::string& kind, std::ostream& out);

const std::vector<std::string>& list_kinds();

}  // namespace palpate::launcher

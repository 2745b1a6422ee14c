// A process of a session with keys, as far as the bus is concerned.
#pragma once

#include <cstdlib>
#include <filesystem>
#include <memory>

#include "tests/modules/bus/loopback.h"

namespace palpate::bus::testing {

/// A process of a role with the keys of a folder; an empty one: without keys.
inline std::unique_ptr<DdsBus> keyed_process(const std::filesystem::path& keys, const char* role,
                                             const BusOptions& options) {
  if (!keys.empty()) ::setenv("PALPATE_KEYS", keys.c_str(), 1);
  ::setenv("PALPATE_ROLE", role, 1);
  std::unique_ptr<DdsBus> bus;
  try {
    bus = std::make_unique<DdsBus>(options);
  } catch (...) {
    ::unsetenv("PALPATE_KEYS");
    ::unsetenv("PALPATE_ROLE");
    throw;
  }
  ::unsetenv("PALPATE_KEYS");
  ::unsetenv("PALPATE_ROLE");
  return bus;
}

}  // namespace palpate::bus::testing

// Buses of their own for each test.
#pragma once

#include <unistd.h>

#include <string>

#include "modules/bus/bus.h"
#include "tests/modules/own_domain.h"
#include "tests/modules/waiting.h"

namespace palpate::testing {

/// Domain and session that no other test shares.
inline bus::BusOptions own_bus_options() {
  static int count = 0;
  bus::BusOptions options;
  options.domain = own_domain(100);
  options.session = std::to_string(getpid()) + "_" + std::to_string(++count);
  return options;
}

}  // namespace palpate::testing

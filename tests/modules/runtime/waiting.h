// Buses of their own for each test, and waiting on conditions with a deadline.
#pragma once

#include <unistd.h>

#include <chrono>
#include <string>
#include <thread>

#include "modules/bus/bus.h"

namespace palpate::testing {

inline constexpr double kDeadline = 20;  // [s] far beyond any sound run, even on a busy machine

template <class Condition>
bool wait_until(const Condition& condition, double deadline = kDeadline) {
  const auto end = std::chrono::steady_clock::now() + std::chrono::duration<double>(deadline);
  while (!condition()) {
    if (std::chrono::steady_clock::now() > end) return false;
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  }
  return true;
}

/// Domain and session that no other test shares.
inline bus::BusOptions own_bus_options() {
  static int count = 0;
  bus::BusOptions options;
  options.domain = 100 + static_cast<int>(getpid() % 90);
  options.session = std::to_string(getpid()) + "_" + std::to_string(++count);
  return options;
}

}  // namespace palpate::testing

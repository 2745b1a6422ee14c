// Waiting on conditions with a deadline.
#pragma once

#include <chrono>
#include <thread>

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

}  // namespace palpate::testing

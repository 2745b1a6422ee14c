// Random numbers that are the same on every machine: only the engine's raw output is used, for the
// distributions of the standard library differ.
#pragma once

#include <cstdint>
#include <random>

#include "modules/core/types.h"

namespace palpate::fuzz {

class RandomStream {
 public:
  /// Streams of different numbers have nothing in common.
  RandomStream(std::uint64_t seed, std::uint64_t number);

  double uniform(double low, double high);
  /// Every decade as likely. Rounded to four digits, so that no library's exp() shows.
  double log_uniform(double low, double high);
  std::size_t below(std::size_t count);  ///< 0 … count − 1
  bool chance(double probability) { return uniform(0, 1) < probability; }
  Vec3 direction();  ///< unit
  Quat rotation();   ///< unit

 private:
  std::mt19937_64 engine_;
};

}  // namespace palpate::fuzz

#include "studies/fuzz/random_stream.h"

#include <cmath>
#include <cstdlib>

#include "studies/report/measures.h"

namespace palpate::fuzz {
namespace {

/// The finalizer of SplitMix64: neighbouring numbers become seeds without likeness.
std::uint64_t mixed(std::uint64_t x) {
  x += 0x9e3779b97f4a7c15u;
  x = (x ^ (x >> 30)) * 0xbf58476d1ce4e5b9u;
  x = (x ^ (x >> 27)) * 0x94d049bb133111ebu;
  return x ^ (x >> 31);
}

}  // namespace

RandomStream::RandomStream(std::uint64_t seed, std::uint64_t number)
    : engine_(mixed(mixed(seed) ^ number)) {}

double RandomStream::uniform(double low, double high) {
  return low + static_cast<double>(engine_() >> 11) * 0x1p-53 * (high - low);
}

double RandomStream::log_uniform(double low, double high) {
  const double value = low * std::exp(uniform(0, 1) * std::log(high / low));
  return std::strtod(report::text_of("%.4g", value).c_str(), nullptr);
}

std::size_t RandomStream::below(std::size_t count) { return engine_() % count; }

Vec3 RandomStream::direction() {
  for (;;) {
    const double x = uniform(-1, 1), y = uniform(-1, 1), z = uniform(-1, 1);
    const Vec3 v(x, y, z);
    if (v.squaredNorm() <= 1 && v.squaredNorm() > 0.01) return v.normalized();
  }
}

Quat RandomStream::rotation() {
  for (;;) {
    const double x = uniform(-1, 1), y = uniform(-1, 1), z = uniform(-1, 1), w = uniform(-1, 1);
    const Quat q(w, x, y, z);
    if (q.squaredNorm() <= 1 && q.squaredNorm() > 0.01) return q.normalized();
  }
}

}  // namespace palpate::fuzz

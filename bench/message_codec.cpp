// What checking and encoding, and decoding and checking, the largest stream costs: node positions
// of the refined stomach, beside a plain copy of as many bytes.
#include <algorithm>
#include <chrono>
#include <cstdio>
#include <cstring>
#include <vector>

#include "modules/core/error.h"
#include "modules/messages/cdr.h"
#include "modules/runtime/program.h"

namespace {

constexpr std::size_t kNodes = 19'362;
constexpr int kRounds = 2000;

// Median time of a call [µs].
template <class Work>
double median_us(const Work& work) {
  using Clock = std::chrono::steady_clock;
  std::vector<double> times(kRounds);
  for (double& time : times) {
    const auto start = Clock::now();
    work();
    time = std::chrono::duration<double, std::micro>(Clock::now() - start).count();
  }
  std::nth_element(times.begin(), times.begin() + kRounds / 2, times.end());
  return times[kRounds / 2];
}

int measure() {
  palpate::NodePositions message, decoded;
  message.header = {1, 0, 1};
  message.positions.assign(3 * kNodes, 0.125f);
  std::vector<std::uint8_t> payload, copy;
  bool good = palpate::messages::encode(message, payload) == nullptr;
  copy.resize(payload.size());

  const double copying = median_us([&] {
    std::memcpy(copy.data(), payload.data(), payload.size());
    payload[payload.size() - 1] = copy[0];
  });
  good &= palpate::messages::encode(message, payload) == nullptr;
  const double encoding =
      median_us([&] { good &= palpate::messages::encode(message, payload) == nullptr; });
  const double decoding =
      median_us([&] { good &= palpate::messages::decode(payload, decoded) == nullptr; });
  if (!good) return palpate::kExitFailed;
  std::printf("node positions, %zu nodes, %zu bytes; medians of %d\n", kNodes, payload.size(),
              kRounds);
  std::printf("  copy   %7.2f us\n", copying);
  std::printf("  encode %7.2f us, %.2f x copy\n", encoding, encoding / copying);
  std::printf("  decode %7.2f us, %.2f x copy\n", decoding, decoding / copying);
  return palpate::kExitDone;
}

}  // namespace

int main(int argc, char** argv) {
  palpate::runtime::Program program(
      "What encoding and decoding node positions costs, beside a plain copy.",
      "palpate-bench-message-codec");
  return program.run(argc, argv, measure);
}

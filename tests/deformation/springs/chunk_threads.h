// Real threads for code that is told to share its work out.
#pragma once

#include <thread>
#include <vector>

#include "modules/core/parallel.h"

namespace palpate::deformation::testing {

/// Chunks shared out over real threads, round robin.
class ChunkThreads : public ChunkRunner {
 public:
  explicit ChunkThreads(std::size_t count) : count_(count) {}
  void run(std::size_t chunks, ChunkBody body) override {
    std::vector<std::thread> threads;
    for (std::size_t t = 0; t < count_; ++t) {
      threads.emplace_back([=, this] {
        for (std::size_t chunk = t; chunk < chunks; chunk += count_) body(chunk);
      });
    }
    for (auto& thread : threads) thread.join();
  }

 private:
  std::size_t count_;
};

}  // namespace palpate::deformation::testing

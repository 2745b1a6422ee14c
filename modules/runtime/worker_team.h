// A few threads that share out the chunks of a computation.
#pragma once

#include <atomic>
#include <cstdint>
#include <thread>
#include <vector>

#include "modules/core/parallel.h"

namespace palpate::runtime {

/// The calling thread and `threads` − 1 more. Workers spin for some microseconds after a run, for
/// the next is usually near, then sleep. A run neither allocates nor locks.
class WorkerTeam : public ChunkRunner {
 public:
  /// @param threads  ≥ 1; 1 has no workers
  /// @throws std::system_error if the system gives no more threads
  explicit WorkerTeam(std::size_t threads);
  ~WorkerTeam() override;
  WorkerTeam(const WorkerTeam&) = delete;
  WorkerTeam& operator=(const WorkerTeam&) = delete;

  std::size_t size() const { return workers_.size() + 1; }
  /// Called from one thread at a time; the body must not throw.
  void run(std::size_t count, ChunkBody body) override;

 private:
  void work();
  void end();
  std::uint32_t await_run(std::uint32_t last_run) const;
  void take_chunks(std::uint32_t run);

  std::vector<std::thread> workers_;
  std::atomic<const ChunkBody*> body_{nullptr};
  std::atomic<std::size_t> count_{0}, done_{0};  ///< chunks
  /// The run's number and, in the low half, its next chunk. A worker that wakes late finds no chunk
  /// of its run left and goes on waiting: nobody waits for it.
  std::atomic<std::uint64_t> ticket_{0};
  std::atomic<std::uint32_t> run_{0};
  std::atomic<bool> stop_{false};
};

}  // namespace palpate::runtime

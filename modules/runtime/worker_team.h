// A few threads that share out the chunks of a computation.
#pragma once

#include <atomic>
#include <cstdint>
#include <thread>
#include <vector>

#include "modules/core/parallel.h"

namespace palpate::runtime {

/// The calling thread and `threads` − 1 more. Each has its share of a run's chunks, the same part
/// in every run, so that what it worked on is in its core's cache still; who is done with his takes
/// from the others'. Workers spin for 60 µs after a run, for the next is usually near, then
/// sleep. A run neither allocates nor locks.
class WorkerTeam : public ChunkRunner {
 public:
  /// @param threads  ≥ 1; 1 has no workers
  /// @throws std::system_error if the system gives no more threads
  explicit WorkerTeam(std::size_t threads);
  ~WorkerTeam() override;
  WorkerTeam(const WorkerTeam&) = delete;
  WorkerTeam& operator=(const WorkerTeam&) = delete;

  std::size_t size() const { return shares_.size(); }
  /// Where there were as many cores as threads when the team began, each keeps to one from now on,
  /// the calling thread to the first: two that share a core while another is free would hold up
  /// each other.
  void keep_to_own_cores();
  /// Called from one thread at a time; the body must not throw.
  void run(std::size_t count, ChunkBody body) override;

 private:
  /// What threads write often, each in a pair of cache lines of its own: they are fetched in pairs.
  static constexpr std::size_t kApart = 128;
  struct alignas(kApart) Share {
    /// The run's number and, in the low half, the share's next chunk. A worker that wakes late
    /// finds no chunk of its run left and goes on waiting: nobody waits for it.
    std::atomic<std::uint64_t> ticket{0};
    std::atomic<std::size_t> done{0};  ///< chunks, whosesoever, by the thread whose share it is
  };

  void work(std::size_t own);
  void end();
  std::uint32_t await_run(std::uint32_t last_run) const;
  void take_chunks(std::uint32_t run, std::size_t own);
  void take_share(std::uint32_t run, std::size_t share, Share& own);
  std::size_t first_chunk(std::size_t share, std::size_t count) const {
    return share * count / shares_.size();
  }
  std::size_t done() const;

  std::vector<std::thread> workers_;
  std::vector<Share> shares_;
  alignas(kApart) std::atomic<const ChunkBody*> body_{nullptr};
  std::atomic<std::size_t> count_{0};  ///< chunks
  std::atomic<std::uint32_t> run_{0};
  std::atomic<bool> stop_{false};
};

}  // namespace palpate::runtime

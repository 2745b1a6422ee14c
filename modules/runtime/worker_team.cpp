#include "modules/runtime/worker_team.h"

#include <chrono>

#include "modules/core/error.h"
#include "modules/runtime/realtime.h"

namespace palpate::runtime {
namespace {

/// Of looking before sleeping: longer than most of what one thread does alone between two runs of a
/// step. To wake a sleeper costs the caller some 10 µs; who looks keeps others from a core, those
/// who draw pictures too.
constexpr std::chrono::microseconds kSpin{60};
constexpr int kLooksPerTime = 50;  ///< between looks at the clock

constexpr std::uint64_t kClosed = ~std::uint64_t{0};  ///< a ticket whose chunk is beyond any count

void relax() {
#if defined(__x86_64__) || defined(__i386__)
  __builtin_ia32_pause();
#endif
}

}  // namespace

WorkerTeam::WorkerTeam(std::size_t threads) : shares_(threads) {
  PALPATE_DEMAND(threads >= 1);
  try {
    for (std::size_t i = 1; i < threads; ++i) workers_.emplace_back([this, i] { work(i); });
  } catch (...) {  // no thread more: those that run are not left behind
    end();
    throw;
  }
}

WorkerTeam::~WorkerTeam() { end(); }

void WorkerTeam::keep_to_own_cores() {
  if (workers_.empty()) return;
  // The calling thread may have left the first core since the workers were started.
  keep_to_own_core(0, size(), pthread_self(), workers_.front().native_handle());
  for (std::size_t i = 1; i < size(); ++i) {
    keep_to_own_core(i, size(), workers_[i - 1].native_handle());
  }
}

void WorkerTeam::end() {
  stop_ = true;
  ++run_;
  run_.notify_all();
  for (auto& worker : workers_) worker.join();
}

void WorkerTeam::run(std::size_t count, ChunkBody body) {
  if (workers_.empty()) {
    for (std::size_t chunk = 0; chunk < count; ++chunk) body(chunk);
    return;
  }
  // All tickets are closed while the run changes, or a worker late from the last one takes its end
  // for a chunk.
  for (Share& share : shares_) share.ticket = kClosed;
  body_ = &body;  // cppcheck-suppress danglingLifetime; all chunks end before this returns
  count_ = count;
  const std::uint32_t run = run_ + 1;
  for (std::size_t i = 0; i < shares_.size(); ++i) {
    shares_[i].done = 0;
    shares_[i].ticket = std::uint64_t{run} << 32 | first_chunk(i, count);
  }
  run_ = run;
  if (count > 1) run_.notify_all();
  take_chunks(run, 0);
  while (done() < count) relax();  // at most one chunk per worker is still under way
}

std::size_t WorkerTeam::done() const {
  std::size_t done = 0;
  for (const Share& share : shares_) done += share.done;
  return done;
}

void WorkerTeam::work(std::size_t own) {
  std::uint32_t run = 0;
  while (true) {
    run = await_run(run);
    if (stop_) return;
    take_chunks(run, own);
  }
}

std::uint32_t WorkerTeam::await_run(std::uint32_t last_run) const {
  const auto end = std::chrono::steady_clock::now() + kSpin;
  do {
    for (int look = 0; look < kLooksPerTime; ++look) {
      if (run_.load() != last_run) return run_.load();
      relax();
    }
  } while (std::chrono::steady_clock::now() < end);
  run_.wait(last_run);
  return run_.load();
}

void WorkerTeam::take_chunks(std::uint32_t run, std::size_t own) {
  for (std::size_t i = 0; i < shares_.size(); ++i) {
    take_share(run, (own + i) % shares_.size(), shares_[own]);
  }
}

void WorkerTeam::take_share(std::uint32_t run, std::size_t share, Share& own) {
  std::atomic<std::uint64_t>& next = shares_[share].ticket;
  std::uint64_t ticket = next;
  while (true) {
    // Read before the chunk is claimed: as long as one is left, the run cannot end and change them.
    const ChunkBody* const body = body_;
    const std::size_t end = first_chunk(share + 1, count_), chunk = ticket & 0xffffffffu;
    if (ticket >> 32 != run || chunk >= end) return;
    if (!next.compare_exchange_weak(ticket, ticket + 1)) continue;
    (*body)(chunk);
    ++own.done;
    ticket = next;
  }
}

}  // namespace palpate::runtime

// The squeezed ball by Bullet's soft body and by ours, in one run.
#pragma once

#include <filesystem>
#include <functional>
#include <iosfwd>
#include <string>
#include <vector>

#include "bench/bullet/squeezed_ball.h"

namespace palpate::bench {

struct BulletOptions {
  std::filesystem::path out;                   ///< folder for bullet.csv; empty: none
  std::vector<std::size_t> nodes{642, 19362};  ///< sizes of the ball
  bool quick = false;                          ///< few settings, 642 nodes, one timing each
};

/// One line of the table.
struct TableRow {
  std::size_t nodes = 0;
  bool ours = false;
  std::string setting;
  Outcome outcome;          ///< its cost: medians of `turns`
  std::vector<Cost> turns;  ///< of every timed run; the n-th of all rows stand side by side in time
};

/// What a time holds: the solver with contacts given, or a whole step with their search.
enum class Work { kSolver, kWhole };
double time_of(const Cost& cost, Work work);  ///< [µs]

/// Runs every setting once, then the cheapest and the most accurate stable ones of Bullet and all
/// of ours in turn, so that a machine whose speed drifts slows all.
/// @param keep_going  asked at every step; may throw
std::vector<TableRow> compare(const BulletOptions& options, std::ostream& log,
                              const std::function<void()>& keep_going);

void print_table(const std::vector<TableRow>& rows, std::ostream& out);
/// For each size and kind of work: how many times fewer µs per step than Bullet's cheapest stable
/// setting (median, worst and best turn) and than its most accurate one, how many times smaller a
/// held volume error than the latter's, and how hard the contents push.
void print_ratios(const std::vector<TableRow>& rows, std::ostream& out);
void write_table(const std::vector<TableRow>& rows, const std::filesystem::path& file);

/// The whole command. @return an exit code
int run_bullet(const BulletOptions& options, std::ostream& out, std::ostream& log);

}  // namespace palpate::bench

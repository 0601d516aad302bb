// Which attempts a search makes, and in what order, whatever the lanes it has.
#pragma once

#include <algorithm>
#include <cstddef>
#include <limits>
#include <optional>
#include <span>
#include <vector>

namespace manyhands::internal {

/// One start for one target; round 0 begins at the search's start, the others at random.
struct IkAttempt {
  std::size_t target = 0;
  int round = 0;
};

/// Hands out attempts and settles targets. A target's answer is that of its first round that succeeds, as if rounds ran
/// one after another, though later ones may run ahead in lanes that nothing else needs.
class IkSchedule {
 public:
  /// Rounds `first_round` to `last_round` of the targets in `open`, which is in rising order.
  IkSchedule(std::span<const std::size_t> open, int first_round, int last_round)
      : open_(open.begin(), open.end()),
        targets_(open.empty() ? 0 : open.back() + 1, Target{.next_round = first_round}),
        last_round_(last_round) {}

  /// What a free lane is to try next, if anything: one more round of a target without success, or a target not begun;
  /// else, ahead of time, one of those in `running`.
  [[nodiscard]] std::optional<IkAttempt> next(std::span<const IkAttempt> running) {
    if (!failed_.empty()) {
      const std::size_t target = failed_.back();
      failed_.pop_back();
      return begin(target);
    }
    if (fresh_ < open_.size()) return begin(open_[fresh_++]);
    const IkAttempt* fewest = nullptr;
    for (const IkAttempt& attempt : running) {
      if (!is_open(attempt.target)) continue;
      if (!fewest || targets_[attempt.target].running < targets_[fewest->target].running) fewest = &attempt;
    }
    if (!fewest) return std::nullopt;
    return begin(fewest->target);
  }

  void end(const IkAttempt& attempt, bool success) {
    Target& target = targets_[attempt.target];
    --target.running;
    if (success) target.winner = std::min(target.winner, attempt.round);
    if (target.running == 0 && is_open(attempt.target)) failed_.push_back(attempt.target);
  }

  /// Whether an earlier round has succeeded, so that this one no longer counts.
  [[nodiscard]] bool is_late(const IkAttempt& attempt) const { return attempt.round > winner(attempt.target); }

  [[nodiscard]] int winner(std::size_t target) const { return targets_[target].winner; }

  static constexpr int kNone = std::numeric_limits<int>::max();

 private:
  struct Target {
    int next_round = 0, running = 0;
    int winner = kNone;  // the first round known to succeed
  };

  [[nodiscard]] bool is_open(std::size_t target) const {
    return targets_[target].winner == kNone && targets_[target].next_round <= last_round_;
  }

  [[nodiscard]] IkAttempt begin(std::size_t target) {
    ++targets_[target].running;
    return {target, targets_[target].next_round++};
  }

  std::vector<std::size_t> open_;
  std::vector<Target> targets_;
  std::vector<std::size_t> failed_;  // without success or a running attempt
  std::size_t fresh_ = 0;
  int last_round_;
};

}  // namespace manyhands::internal

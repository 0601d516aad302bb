// Whether a helper thread pays: found out by trial, again and again.
#pragma once

#include <algorithm>
#include <chrono>

namespace manyhands::learn {

/// Runs rounds by turns without and with a helper, and goes on in the quicker way until the next trial.
///
/// On a machine with other work a helper is now and then kept from its core, and whoever waits for it loses more than
/// it gains. A turn is long enough to see the scheduler at work, and the helper's ends as soon as it has lost.
class Contest {
 public:
  using Duration = std::chrono::nanoseconds;

  /// How the next round is to run.
  [[nodiscard]] bool with_helper() const { return stage_ == Stage::kWith || (stage_ == Stage::kRest && helper_won_); }

  /// What the round took.
  void record(Duration round) {
    ++rounds_;
    took_ += round;
    if (stage_ == Stage::kWithout) {
      if (rounds_ >= kLeastRounds && took_ >= kLeastTime) begin_helper();
    } else if (stage_ == Stage::kWith) {
      if (took_ >= without_) {
        rest(false);
      } else if (rounds_ >= trial_rounds_) {
        rest(true);
      }
    } else if (rounds_ >= rest_ * trial_rounds_) {
      begin(Stage::kWithout);
    }
  }

 private:
  enum class Stage { kWithout, kWith, kRest };

  static constexpr int kLeastRounds = 24;  // more than a gradient step has, whose rounds differ
  static constexpr Duration kLeastTime = std::chrono::milliseconds(10);
  static constexpr int kLeastRest = 16, kMostRest = 128;  // in trials

  void begin(Stage stage) {
    stage_ = stage;
    rounds_ = 0;
    took_ = Duration::zero();
  }

  void begin_helper() {
    trial_rounds_ = rounds_;
    without_ = took_;
    begin(Stage::kWith);
  }

  /// The same result again lets the next trial wait longer.
  void rest(bool helper_won) {
    rest_ = helper_won == helper_won_ ? std::min(2 * rest_, kMostRest) : kLeastRest;
    helper_won_ = helper_won;
    begin(Stage::kRest);
  }

  Stage stage_ = Stage::kWithout;
  bool helper_won_ = false;
  int rounds_ = 0, trial_rounds_ = 0, rest_ = kLeastRest / 2;
  Duration took_{}, without_{};
};

}  // namespace manyhands::learn

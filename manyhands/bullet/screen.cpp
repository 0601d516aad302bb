#include "manyhands/bullet/screen.h"

#include <algorithm>
#include <utility>

namespace manyhands::bullet {

namespace {

constexpr int kDown = 1, kTriggered = 2, kReleased = 4;

/// Longer than any program runs, and short enough for the clock.
constexpr double kLongestLife = 1e8;

}  // namespace

int Screen::add(DebugItem item, int replaced) {
  expire();
  const int id = items.contains(replaced) ? replaced : next_item_++;
  item.serial = ++serial;
  if (item.life > 0) {
    const std::chrono::duration<double> life(std::min(item.life, kLongestLife));
    deadlines_.emplace(Clock::now() + std::chrono::duration_cast<Clock::duration>(life), std::pair(id, serial));
  }
  items[id] = std::move(item);
  return id;
}

void Screen::remove(int id) {
  if (items.erase(id) > 0) ++serial;
}

void Screen::remove_all(bool parameters) {
  const auto is_meant = [=](const auto& one) { return (one.second.kind == DebugItem::kParameter) == parameters; };
  if (std::erase_if(items, is_meant) > 0) ++serial;
}

void Screen::expire() {
  const Clock::time_point now = Clock::now();
  for (; !deadlines_.empty() && deadlines_.begin()->first <= now; deadlines_.erase(deadlines_.begin())) {
    const auto [id, of_item] = deadlines_.begin()->second;
    const DebugItem* const item = find(id);
    if (item != nullptr && item->serial == of_item) remove(id);  // else it was replaced
  }
}

DebugItem* Screen::find(int id) {
  const auto found = items.find(id);
  return found == items.end() ? nullptr : &found->second;
}

bool Screen::set_parameter(int id, double value) {
  DebugItem* const item = find(id);
  if (item == nullptr || item->kind != DebugItem::kParameter) return false;
  item->value = item->low > item->high ? value : std::clamp(value, item->low, item->high);
  return true;
}

void Screen::press(int key, bool down) {
  int& state = keys[key];
  if (down) {
    const bool is_held = (state & kDown) != 0 && (state & kReleased) == 0;
    state = is_held ? state : kDown | kTriggered;
  } else {
    // Who asks seldom is told that a key was down, too.
    state = (state & kTriggered) != 0 ? state | kReleased : kReleased;
  }
}

void Screen::click(int button, bool down, double x, double y) {
  mouse.push_back({.type = 2, .x = x, .y = y, .button = button, .state = down ? kDown | kTriggered : kReleased});
}

std::map<int, int> Screen::take_keys() {
  std::map<int, int> told = keys;
  std::erase_if(keys, [](const auto& key) { return (key.second & kReleased) != 0; });
  for (auto& [key, state] : keys) state = kDown;
  return told;
}

}  // namespace manyhands::bullet

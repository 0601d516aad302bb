// What a client's screen shows besides bodies, and what people do there. The viewer draws it; a test can set it.
#pragma once

#include <array>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "manyhands/math/vec3.h"

namespace manyhands::bullet {

struct DebugItem {
  enum Kind { kLine, kText, kPoints, kParameter };
  Kind kind = kLine;
  std::string text{};
  std::vector<Vec3<double>> points{}, colours{};
  double size = 1;
  double life = 0;                      ///< [s]; 0: for ever
  std::array<int, 2> parent{-1, -1};    ///< body and link in whose frame the points are
  double low = 0, high = 1, value = 0;  ///< of a parameter
};

struct MouseEvent {
  int type = 1;  ///< 1: moved, 2: button
  double x = 0, y = 0;
  int button = -1, state = 0;
};

struct Screen {
  static constexpr int kWidth = 1024, kHeight = 768;
  struct Orbit {
    double distance = 2, yaw = 50, pitch = -35;  ///< [m], [degrees]
    Vec3<double> target{0, 0, 0};
  };

  std::map<int, DebugItem> items{};
  std::map<int, bool> switches{};  ///< of configureDebugVisualizer
  std::map<int, int> keys{};       ///< code and state bits: 1 down, 2 triggered, 4 released
  std::vector<MouseEvent> mouse{};
  Orbit camera{};
  int camera_moves = 0;  ///< grows with resetDebugVisualizerCamera
  int next_item = 0;

  /// Returns the id; that of an item which it replaces, if there is one.
  int add(DebugItem item, int replaced) {
    const int id = items.contains(replaced) ? replaced : next_item++;
    items[id] = std::move(item);
    return id;
  }
  [[nodiscard]] DebugItem* find(int id) {
    const auto found = items.find(id);
    return found == items.end() ? nullptr : &found->second;
  }
  /// Keys and their states; what was triggered or released is told once.
  [[nodiscard]] std::map<int, int> take_keys() {
    constexpr int kDown = 1;
    std::map<int, int> told = keys;
    std::erase_if(keys, [](const auto& key) { return (key.second & kDown) == 0; });
    for (auto& [key, state] : keys) state = kDown;
    return told;
  }
};

}  // namespace manyhands::bullet

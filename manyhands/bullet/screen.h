// What a client's screen shows besides bodies, and what people do there. The viewer draws it; a test can set it.
#pragma once

#include <array>
#include <chrono>
#include <cstdint>
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
  double life = 0;                      ///< [s] of the wall's clock; 0: for ever
  std::array<int, 2> parent{-1, -1};    ///< body and link in whose centre-of-mass frame the points are
  double low = 0, high = 1, value = 0;  ///< of a parameter: a slider, or a button where low > high
  std::int64_t serial = 0;              ///< of the change that made it
};

struct MouseEvent {
  int type = 1;  ///< 1: moved, 2: button
  double x = 0, y = 0;
  int button = -1, state = 0;
};

/// A force by which somebody drags a link of the world.
struct Pull {
  std::string link{};             ///< its name
  Vec3<double> point{}, force{};  ///< in the link's frame [m]; in world axes [N]
};

/// States of keys and buttons are bits: 1 down, 2 triggered, 4 released.
struct Screen {
  using Clock = std::chrono::steady_clock;

  static constexpr int kWidth = 1024, kHeight = 768;
  struct Orbit {
    double distance = 2, yaw = 50, pitch = -35;  ///< [m], [degrees]
    Vec3<double> target{0, 0, 0};
  };

  std::map<int, DebugItem> items{};
  std::map<int, bool> switches{};  ///< of configureDebugVisualizer
  std::map<int, int> keys{};       ///< code and state
  std::vector<MouseEvent> mouse{};
  std::vector<Pull> pulls{};
  Orbit camera{};
  int camera_moves = 0;                                    ///< grows with resetDebugVisualizerCamera
  bool listens_to_keys = false, listens_to_mouse = false;  ///< whether the program has asked for events
  std::int64_t serial = 0;                                 ///< grows with every change of items

  /// Returns the id; that of an item which it replaces, if there is one.
  int add(DebugItem item, int replaced);
  void remove(int id);
  void remove_all(bool parameters);
  /// Takes away what has lived for long enough.
  void expire();
  [[nodiscard]] DebugItem* find(int id);
  /// Moves a slider, within its range, or tells how often a button was pressed. False if there is none of that id.
  bool set_parameter(int id, double value);

  void press(int key, bool down);
  void move_mouse(double x, double y) { mouse.push_back({.type = 1, .x = x, .y = y}); }
  void click(int button, bool down, double x, double y);
  /// Keys and their states; what was triggered or released is told once.
  [[nodiscard]] std::map<int, int> take_keys();

 private:
  int next_item_ = 0;
  std::multimap<Clock::time_point, std::pair<int, std::int64_t>> deadlines_{};  // ids and serials of items
};

}  // namespace manyhands::bullet

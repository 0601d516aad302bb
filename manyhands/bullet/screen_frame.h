// What a client shows at one moment, copied for whoever draws it.
#pragma once

#include <memory>
#include <optional>
#include <utility>

#include "manyhands/bullet/screen.h"
#include "manyhands/math/quaternion.h"
#include "manyhands/model/model.h"

namespace manyhands::bullet {

struct ScreenFrame {
  std::int64_t scene = 0;  ///< changes when bodies come, go or are built anew
  double time = 0;         ///< [s]
  std::vector<double> q{};
  std::vector<Vec3<double>> positions{};     ///< (links) of the model, their frames in the world [m]
  std::vector<Quat<double>> quaternions{};   ///< (links)
  std::shared_ptr<const Model> model{};      ///< a copy, if it was asked for
  std::int64_t looks = 0;                    ///< grows with changes of colours
  std::vector<std::array<float, 4>> rgba{};  ///< (geoms) if the colours are not those that were seen
  std::int64_t serial = 0;                   ///< of the screen's items
  std::vector<int> ids{};                    ///< of all items
  /// Those that are not as they were seen, and those that move with a link; points are in the world's frame.
  std::vector<std::pair<int, DebugItem>> items{};
  Screen screen{};  ///< without items, keys and mouse
};

}  // namespace manyhands::bullet

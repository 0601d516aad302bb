// The last pictures of every world, and numbers that belong to them: a replay for those who see.
#pragma once

#include <cstdint>
#include <filesystem>
#include <span>
#include <vector>

#include "manyhands/base/memory_block.h"
#include "manyhands/envs/sight.h"
#include "manyhands/learn/archive.h"
#include "manyhands/learn/encoder.h"

namespace manyhands::learn {

/// A ring of moments. A moment is a state of every world at one time: a row for each, with pictures, their place in the
/// episode and a few numbers. Stacks are found in the moments before, so that each picture is kept once. In files there
/// are no pictures, but what they show: they are taken again.
class PictureMemory {
 public:
  /// `sight` is borrowed. Holds `moments` of `worlds` worlds. `folder`: where pictures lie, see `MemoryBlock`.
  PictureMemory(Sight& sight, int worlds, int moments, int stack, int numbers,
                const std::filesystem::path& folder = {});

  /// Takes pictures of worlds (all, or those that are `wanted`) and keeps them in place of the oldest moment.
  /// steps (worlds): since the episode began. numbers (worlds, numbers per row), or empty.
  void add(std::span<const int> steps, std::span<const float> numbers, std::span<const std::uint8_t> wanted = {});

  /// Rows to choose from: their stacks are whole.
  [[nodiscard]] int size() const;
  /// Row `i` of these, from the oldest on; the newest are those of the last moment, world by world.
  [[nodiscard]] Stack stack(int i, int eye) const;
  [[nodiscard]] const float* numbers(int i) const;

  void save(ArchiveWriter& out) const;
  void load(ArchiveReader& in);

 private:
  struct Moment {
    std::vector<SeenWorld> views;  // (worlds)
    std::vector<int> steps;        // (worlds)
    std::vector<float> numbers;    // (worlds, numbers)
  };

  void take_pictures(int number, std::span<const std::uint8_t> wanted);
  [[nodiscard]] int oldest() const;  // whose stacks are whole
  [[nodiscard]] const Moment& moment(int number) const;
  [[nodiscard]] std::size_t colours_at(int number) const;

  Sight& sight_;
  int worlds_, capacity_, stack_, numbers_;
  int count_ = 0;                // moments ever added
  std::vector<Moment> moments_;  // moment number k is at k % capacity
  std::size_t row_;              // bytes of a world's pictures at one time
  MemoryBlock colours_;          // (moments, worlds, eyes, height, width, 3)
  std::vector<SeenWorld> views_;
  std::vector<std::uint8_t> taken_;
};

}  // namespace manyhands::learn

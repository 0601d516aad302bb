#include "manyhands/learn/picture_memory.h"

#include <algorithm>

namespace manyhands::learn {

namespace {

/// Sizes are those of a robot's model, with room to spare: a damaged file asks for no more memory than that.
constexpr std::uint64_t kMostNumbers = 1 << 20;

template <class T>
void save_vector(const std::vector<T>& values, ArchiveWriter& out) {
  out.value(static_cast<std::uint64_t>(values.size()));
  out.array(std::span(values));
}

template <class T>
void load_vector(ArchiveReader& in, std::vector<T>& values) {
  const auto size = in.value<std::uint64_t>();
  in.check(size <= kMostNumbers, "a list in it is too long");
  values.resize(size);
  in.array(std::span(values));
}

void save_view(const SeenWorld& view, ArchiveWriter& out) {
  save_vector(view.q, out);
  out.value(static_cast<std::uint64_t>(view.sizes.size()));
  for (const Vec3<double>& size : view.sizes) {
    for (const double length : {size.x, size.y, size.z}) out.value(length);
  }
  save_vector(view.goal, out);
}

SeenWorld load_view(ArchiveReader& in) {
  SeenWorld view;
  load_vector(in, view.q);
  const auto objects = in.value<std::uint64_t>();
  in.check(objects <= kMostNumbers, "a list in it is too long");
  view.sizes.resize(objects);
  for (Vec3<double>& size : view.sizes) {
    for (double* length : {&size.x, &size.y, &size.z}) in.value(*length);
  }
  load_vector(in, view.goal);
  return view;
}

}  // namespace

PictureMemory::PictureMemory(Sight& sight, int worlds, int moments, int stack, int numbers,
                             const std::filesystem::path& folder)
    : sight_(sight),
      worlds_(worlds),
      capacity_(std::max(moments, stack)),
      stack_(stack),
      numbers_(numbers),
      row_(static_cast<std::size_t>(sight.num_eyes()) * sight.picture_size()),
      colours_(static_cast<std::size_t>(capacity_) * static_cast<std::size_t>(worlds) * row_, folder) {}

void PictureMemory::add(std::span<const int> steps, std::span<const float> numbers,
                        std::span<const std::uint8_t> wanted) {
  const int number = count_++;
  const auto at = static_cast<std::size_t>(number % capacity_);
  if (at == moments_.size()) moments_.emplace_back();
  Moment& moment = moments_[at];
  moment.views.resize(static_cast<std::size_t>(worlds_));
  for (int world = 0; world < worlds_; ++world) {
    if (wanted.empty() || wanted[static_cast<std::size_t>(world)] != 0) {
      moment.views[static_cast<std::size_t>(world)] = sight_.view(world);
    }
  }
  moment.steps.assign(steps.begin(), steps.end());
  moment.numbers.assign(numbers.begin(), numbers.end());
  take_pictures(number, wanted);
}

void PictureMemory::take_pictures(int number, std::span<const std::uint8_t> wanted) {
  const std::vector<SeenWorld>& views = moment(number).views;
  std::uint8_t* colours = colours_.as<std::uint8_t>() + colours_at(number);
  if (wanted.empty()) return sight_.take(views, {colours, views.size() * row_});
  views_.clear();
  for (std::size_t w = 0; w < wanted.size(); ++w) {
    if (wanted[w] != 0) views_.push_back(views[w]);
  }
  taken_.resize(views_.size() * row_);
  sight_.take(views_, taken_);
  for (std::size_t w = 0, k = 0; w < wanted.size(); ++w) {
    if (wanted[w] != 0) std::copy_n(taken_.data() + k++ * row_, row_, colours + w * row_);
  }
}

/// Moments before the first, or that have been overwritten, are in no stack.
int PictureMemory::oldest() const { return count_ <= capacity_ ? 0 : count_ - capacity_ + stack_ - 1; }

int PictureMemory::size() const { return (count_ - oldest()) * worlds_; }

const PictureMemory::Moment& PictureMemory::moment(int number) const {
  return moments_[static_cast<std::size_t>(number % capacity_)];
}

std::size_t PictureMemory::colours_at(int number) const {
  return static_cast<std::size_t>(number % capacity_) * static_cast<std::size_t>(worlds_) * row_;
}

Stack PictureMemory::stack(int i, int eye) const {
  const int number = oldest() + i / worlds_, world = i % worlds_;
  const int steps = moment(number).steps[static_cast<std::size_t>(world)];
  Stack stack;
  for (int back = 0; back < stack_; ++back) {
    const std::uint8_t* of_world = colours_.as<std::uint8_t>() + colours_at(number - std::min({back, steps, number})) +
                                   static_cast<std::size_t>(world) * row_;
    stack.push_back(of_world + static_cast<std::size_t>(eye) * sight_.picture_size());
  }
  return stack;
}

const float* PictureMemory::numbers(int i) const {
  return moment(oldest() + i / worlds_).numbers.data() + i % worlds_ * numbers_;
}

void PictureMemory::save(ArchiveWriter& out) const {
  out.value(capacity_);
  out.value(count_);
  for (const Moment& moment : moments_) {
    for (const SeenWorld& view : moment.views) save_view(view, out);
    out.array(std::span(moment.steps));
    out.array(std::span(moment.numbers));
  }
}

void PictureMemory::load(ArchiveReader& in) {
  in.expect("number of moments with pictures", capacity_);
  in.value(count_);
  in.check(count_ >= 0, "it counts too few moments");
  moments_.resize(static_cast<std::size_t>(std::min(count_, capacity_)));
  for (int number = 0; number < static_cast<int>(moments_.size()); ++number) {
    Moment& moment = moments_[static_cast<std::size_t>(number)];
    moment.views.clear();
    for (int world = 0; world < worlds_; ++world) moment.views.push_back(load_view(in));
    moment.steps.resize(static_cast<std::size_t>(worlds_));
    moment.numbers.resize(static_cast<std::size_t>(worlds_ * numbers_));
    in.array(std::span(moment.steps));
    in.array(std::span(moment.numbers));
    take_pictures(number, {});
  }
}

}  // namespace manyhands::learn

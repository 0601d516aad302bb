#include "manyhands/physics/world/snapshot.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <sstream>

#include "manyhands/base/hash.h"
#include "manyhands/model/fingerprint.h"
#include "manyhands/physics/world/parameters.h"
#include "manyhands/physics/world/world_checks.h"

namespace manyhands {

namespace {

static_assert(std::endian::native == std::endian::little, "snapshots are written as they lie in memory");

constexpr std::array<char, 8> kMagic{'m', 'h', 'a', 'n', 'd', 's', '\r', '\n'};
constexpr std::uint32_t kVersion = 1;
constexpr std::size_t kCheckOffset = 24, kHead = 32;

template <class Number>
Number number_at(std::span<const std::uint8_t> bytes, std::size_t offset) {
  Number number;
  std::memcpy(&number, &bytes[offset], sizeof(number));
  return number;
}

/// FNV-1a by words of 8 bytes in place of bytes: eight times as fast, and any change within one word shows as well.
std::uint64_t check_sum(std::span<const std::uint8_t> bytes) {
  std::uint64_t sum = 0xcbf29ce484222325ULL ^ bytes.size();
  const auto add = [&](std::span<const std::uint8_t> part) {
    for (std::size_t i = 0; i < part.size(); i += 8) {
      std::uint64_t word = 0;
      std::memcpy(&word, &part[i], std::min<std::size_t>(8, part.size() - i));
      sum = (sum ^ word) * 0x100000001b3ULL;
      sum ^= sum >> 32;
    }
  };
  add(bytes.first(kCheckOffset));
  add(bytes.subspan(kHead));
  return sum;
}

/// One line that any program can show.
std::string printable(std::span<const std::uint8_t> bytes) {
  constexpr std::size_t kLongest = 300;
  std::string text;
  for (const std::uint8_t byte : bytes.first(std::min(bytes.size(), kLongest))) {
    text += byte >= ' ' && byte < 127 ? static_cast<char>(byte) : '?';
  }
  return text;
}

std::string printable(const std::string& text) {
  return printable(std::span(reinterpret_cast<const std::uint8_t*>(text.data()), text.size()));
}

template <Real R>
bool is_within(Range range, R x) {
  switch (range) {
    case Range::kFinite:
      return is_finite(x);
    case Range::kNotNegative:
      return is_finite(x) && x >= 0;
    case Range::kForceLimit:
      return x >= 0;
    case Range::kLimit:
      return x == x;
    case Range::kFlag:
      return x == 0 || x == 1;
    case Range::kResult:
      return true;
  }
  return false;
}

const char* to_string(Range range) {
  switch (range) {
    case Range::kFinite:
      return "a finite number";
    case Range::kNotNegative:
      return "a finite number of 0 or more";
    case Range::kForceLimit:
      return "0 or more";
    case Range::kFlag:
      return "0 or 1";
    default:
      return "a number";
  }
}

/// Calls visit(info, field) for every field of a view that a snapshot holds.
template <class View, class Visit>
void visit_kept(const View& view, Visit&& visit) {
  View::visit_fields(
      [&](const FieldInfo& info, const auto& field) {
        if (info.range != Range::kResult) visit(info, field);
      },
      view);
}

[[noreturn]] void refuse(const std::string& what) { throw std::invalid_argument("the snapshot " + what); }

}  // namespace

SnapshotOwner snapshot_owner(const std::string& kind, const Model& model, double time_step) {
  Hash hash;
  hash.add(fingerprint(model));
  hash.add(time_step);
  std::ostringstream text;
  text << kind << " of '" << model.name() << "' (" << model.links().size() << " links, nq " << model.nq() << ", nv "
       << model.nv() << "), time_step " << time_step;
  return {text.str(), hash.value()};
}

SnapshotWriter::SnapshotWriter(const SnapshotOwner& owner) {
  const std::string text = printable(owner.text);
  put(kMagic);
  put(kVersion);
  put(static_cast<std::uint32_t>(text.size()));
  put(owner.fingerprint);
  put(std::uint64_t{0});
  bytes_.insert(bytes_.end(), text.begin(), text.end());
}

template <class View>
void SnapshotWriter::put_fields(const View& view) {
  visit_kept(view, [&](const FieldInfo&, const auto& field) {
    if (field.stride == 1) {
      const auto* first = reinterpret_cast<const std::uint8_t*>(field.first);
      bytes_.insert(bytes_.end(), first, first + field.size() * sizeof(*field.first));
      return;
    }
    const std::size_t first = bytes_.size(), size = sizeof(*field.first);
    bytes_.resize(first + field.size() * size);
    for (std::size_t i = 0; i < field.size(); ++i) std::memcpy(&bytes_[first + i * size], &field[i], size);
  });
}

std::vector<std::uint8_t> SnapshotWriter::finish() {
  const std::uint64_t sum = check_sum(bytes_);
  std::memcpy(&bytes_[kCheckOffset], &sum, sizeof(sum));
  return std::move(bytes_);
}

SnapshotReader::SnapshotReader(std::span<const std::uint8_t> bytes, const SnapshotOwner& owner) {
  if (bytes.size() < kHead || number_at<std::array<char, 8>>(bytes, 0) != kMagic) {
    throw std::invalid_argument("these " + std::to_string(bytes.size()) + " bytes are no snapshot; expected one of " +
                                printable(owner.text));
  }
  if (const auto version = number_at<std::uint32_t>(bytes, 8); version != kVersion) {
    refuse("is of version " + std::to_string(version) + " of the format; expected version " + std::to_string(kVersion));
  }
  if (number_at<std::uint64_t>(bytes, kCheckOffset) != check_sum(bytes)) {
    refuse("is damaged: its " + std::to_string(bytes.size()) + " bytes do not give its check sum; expected one of " +
           printable(owner.text));
  }
  const std::size_t length = std::min<std::size_t>(number_at<std::uint32_t>(bytes, 12), bytes.size() - kHead);
  const std::string text = printable(bytes.subspan(kHead, length)), expected = printable(owner.text);
  if (text != expected) refuse("is of " + text + "; expected one of " + expected);
  if (number_at<std::uint64_t>(bytes, 16) != owner.fingerprint) {
    refuse("is of " + text + " with other parts or options; expected one of the same");
  }
  rest_ = bytes.subspan(kHead + length);
}

std::span<const std::uint8_t> SnapshotReader::take_bytes(std::size_t count) {
  if (count > rest_.size()) refuse("ends too early");
  const std::span<const std::uint8_t> first = rest_.first(count);
  rest_ = rest_.subspan(count);
  return first;
}

std::int64_t SnapshotReader::take_count(const char* what, std::int64_t most) {
  const auto count = take<std::int64_t>();
  if (count < 0 || count > most) {
    refuse("holds " + std::string(what) + " of " + std::to_string(count) + "; expected 0 to " + std::to_string(most));
  }
  return count;
}

template <class View>
void SnapshotReader::take_fields(const View& view) {
  visit_kept(view, [&](const FieldInfo& info, const auto& field) {
    using R = std::remove_reference_t<decltype(*field.first)>;
    for (std::size_t i = 0; i < field.size(); ++i) {
      const R number = take<R>();
      if (!is_within(info.range, number)) {
        refuse("holds " + std::string(info.name) + "[" + std::to_string(i) + "] = " + std::to_string(number) +
               "; expected " + to_string(info.range));
      }
      field[i] = number;
    }
  });
}

void SnapshotReader::finish() const {
  if (!rest_.empty()) refuse("has " + std::to_string(rest_.size()) + " bytes too many");
}

template <Real R>
void require_sound(const Model& model, const StateView<R>& state) {
  const auto check = [](const char* array, const Strided<R>& numbers, std::size_t i) {
    try {
      (void)internal::require_unit_quaternion<R>(numbers, i, array);
    } catch (const std::invalid_argument& error) {
      refuse(std::string("cannot be: ") + error.what());
    }
  };
  internal::for_each_quaternion(model, [&](std::size_t i) { check("q[", state.q, i); });
  for (std::size_t i = 3; i < state.mocap.size(); i += kPoseNumbers) check("mocap[", state.mocap, i);
}

namespace {

/// Whether the ten numbers of a RigidInertia can be those of a body.
template <Real R>
bool is_inertia(const Strided<R>& all, std::size_t body) {
  const auto number = [&](std::size_t k) { return static_cast<double>(all[10 * body + k]); };
  constexpr double kRounding = 1e-3;
  const auto meet = [&](std::size_t i, std::size_t j, std::size_t product) {
    return number(product) * number(product) <= (1 + kRounding) * number(i) * number(j);
  };
  return number(0) >= 0 && number(4) >= 0 && number(5) >= 0 && number(6) >= 0 && meet(4, 5, 7) && meet(4, 6, 8) &&
         meet(5, 6, 9);
}

}  // namespace

template <Real R>
void require_sound(const Model& model, const WorldView<R>& world) {
  require_sound(model, world.state);
  for (std::size_t i = 0; i < world.extras.link_mass.size(); ++i) {
    const Link& link = model.links()[i];
    const R mass = world.extras.link_mass[i];
    if ((link.inertial.mass > 0) == (mass > 0)) continue;
    refuse("holds a mass of " + std::to_string(mass) + " kg of link '" + link.name + "', whose model has " +
           std::to_string(link.inertial.mass) + " kg");
  }
  for (std::size_t b = 1; b < model.bodies().size(); ++b) {
    const bool has_mass = model.bodies()[b].inertia.m > 0;
    if (is_inertia(world.params.inertia, b) && (world.params.inertia[10 * b] > 0) == has_mass) continue;
    refuse("holds an inertia that no body has, that of body " + std::to_string(b));
  }
  for (std::size_t i = 0; i < model.geoms().size(); ++i) {
    Shape shape = model.geoms()[i].shape;
    const auto size = [&](std::size_t k) { return static_cast<double>(world.params.geom_size[3 * i + k]); };
    shape.size = {size(0), size(1), size(2)};
    require_shape_size("the snapshot's geom '" + geom_label(model, GeomId(i)) + "'", shape);
  }
}

template <Real R>
void require_listed_contacts(const StateView<R>& state) {
  for (std::size_t i = 0; i < state.contact_cache.size(); i += kManifoldNumbers<R>) {
    const R key = state.contact_cache[i], used = state.contact_cache[i + 1];
    if (key != 0 || !is_within(Range::kFlag, used)) refuse("holds a contact that no world remembers");
  }
}

void require_found_contacts(const StateView<double>& state, std::size_t geoms) {
  double last = -1;
  const double end = static_cast<double>(kManifoldPoints) * static_cast<double>(geoms) * static_cast<double>(geoms);
  for (std::size_t i = 0; i < state.contact_cache.size(); i += kManifoldNumbers<double>) {
    const double key = state.contact_cache[i], used = state.contact_cache[i + 1];
    const bool sound = key > last && key < end && key == std::floor(key) && is_within(Range::kFlag, used);
    if (!sound) refuse("holds a contact that no world remembers");
    last = key;
  }
}

template <class View>
void add_fields(const View& view, Hash& hash) {
  visit_kept(view, [&](const FieldInfo&, const auto& field) {
    for (std::size_t i = 0; i < field.size(); ++i) hash.add(field[i]);
  });
}

#define MANYHANDS_INSTANTIATE_VIEW(View)                  \
  template void SnapshotWriter::put_fields(const View&);  \
  template void SnapshotReader::take_fields(const View&); \
  template void add_fields(const View&, Hash&);
#define MANYHANDS_INSTANTIATE(R)                                  \
  MANYHANDS_INSTANTIATE_VIEW(StateView<R>)                        \
  MANYHANDS_INSTANTIATE_VIEW(ParamsView<R>)                       \
  MANYHANDS_INSTANTIATE_VIEW(ExtrasView<R>)                       \
  template void require_sound(const Model&, const StateView<R>&); \
  template void require_sound(const Model&, const WorldView<R>&); \
  template void require_listed_contacts(const StateView<R>&);
MANYHANDS_INSTANTIATE(double)
MANYHANDS_INSTANTIATE(float)

}  // namespace manyhands

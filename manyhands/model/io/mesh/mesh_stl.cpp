// STL: the binary form is 80 bytes of header, a count, and 50 bytes a triangle; the ASCII form is words.
#include <bit>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <unordered_map>

#include "manyhands/model/io/mesh/mesh_file.h"
#include "manyhands/model/io/text_numbers.h"

namespace manyhands::io {

namespace {

constexpr std::size_t kHeader = 84;
constexpr std::size_t kTriangle = 50;

static_assert(std::endian::native == std::endian::little, "binary STL files are little-endian");

/// Collects triangles; equal vertices become one.
class Welder {
 public:
  int vertex(Vec3<float> v) {
    if (!std::isfinite(v.x) || !std::isfinite(v.y) || !std::isfinite(v.z)) throw MeshError("a vertex is not finite");
    v = v + Vec3<float>::zero();  // -0 and 0 are one number
    const auto [entry, is_new] = indices_.try_emplace(v, static_cast<int>(mesh_.vertices.size()));
    if (is_new) mesh_.vertices.push_back(v);
    return entry->second;
  }

  void triangle(int a, int b, int c) { mesh_.triangles.push_back({a, b, c}); }

  Mesh take() { return std::move(mesh_); }

 private:
  struct Hash {
    std::size_t operator()(const Vec3<float>& v) const {
      std::uint64_t h = 0;
      for (const float x : {v.x, v.y, v.z}) h = (h ^ std::bit_cast<std::uint32_t>(x)) * 0x9E3779B97F4A7C15u ^ (h >> 29);
      return h;
    }
  };
  struct Equal {
    bool operator()(const Vec3<float>& a, const Vec3<float>& b) const { return a.x == b.x && a.y == b.y && a.z == b.z; }
  };

  Mesh mesh_;
  std::unordered_map<Vec3<float>, int, Hash, Equal> indices_;
};

Mesh read_binary(std::string_view bytes, std::size_t count) {
  Welder welder;
  for (std::size_t i = 0; i < count; ++i) {
    std::array<float, 12> numbers{};  // the normal, then the corners
    std::memcpy(numbers.data(), bytes.data() + kHeader + kTriangle * i, sizeof numbers);
    std::array<int, 3> corners{};
    for (std::size_t k = 0; k < 3; ++k) {
      corners[k] = welder.vertex({numbers[3 * k + 3], numbers[3 * k + 4], numbers[3 * k + 5]});
    }
    welder.triangle(corners[0], corners[1], corners[2]);
  }
  return welder.take();
}

Mesh read_ascii(std::string_view bytes) {
  const std::vector<std::string_view> words = split_blanks(bytes);
  Welder welder;
  std::vector<int> loop;
  for (std::size_t i = 0; i < words.size(); ++i) {
    if (words[i] == "vertex") {
      std::array<float, 3> v{};
      for (float& x : v) {
        const auto number = ++i < words.size() ? parse_number(words[i]) : std::nullopt;
        if (!number) throw MeshError("expected three numbers after 'vertex'");
        x = static_cast<float>(*number);
      }
      loop.push_back(welder.vertex({v[0], v[1], v[2]}));
    } else if (words[i] == "endloop") {
      for (std::size_t k = 2; k < loop.size(); ++k) welder.triangle(loop[0], loop[k - 1], loop[k]);
      loop.clear();
    }
  }
  if (!loop.empty()) throw MeshError("the file ends in the middle of a facet");
  return welder.take();
}

}  // namespace

Mesh read_stl(std::string_view bytes) {
  // Binary headers may begin with "solid" too, so the size decides.
  std::uint32_t count = 0;
  if (bytes.size() >= kHeader) std::memcpy(&count, bytes.data() + kHeader - sizeof count, sizeof count);
  const std::size_t needed = kHeader + kTriangle * std::size_t{count};
  if (bytes.size() >= kHeader && bytes.size() == needed) return read_binary(bytes, count);
  if (bytes.substr(0, bytes.find_first_of(" \t\r\n")) == "solid") return read_ascii(bytes);
  if (bytes.size() > needed && bytes.size() >= kHeader) return read_binary(bytes, count);
  throw MeshError("neither an ASCII STL file, which begins with 'solid', nor a whole binary one: " +
                  std::to_string(bytes.size()) + " bytes, expected " + std::to_string(needed));
}

}  // namespace manyhands::io

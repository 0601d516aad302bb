// MSH, MuJoCo's binary meshes: four int32 (vertices, normals, texture coordinates, faces), then three float32 a vertex,
// three a normal, two a texture coordinate, and three int32 a face.
#include <bit>
#include <cstdint>
#include <cstring>

#include "manyhands/model/io/mesh/mesh_file.h"

namespace manyhands::io {

namespace {

static_assert(std::endian::native == std::endian::little, "MSH files are little-endian");

constexpr std::size_t kMshHeader = 4 * sizeof(std::int32_t);

std::string count_of(std::size_t number, const char* what) { return std::to_string(number) + " " + what; }

}  // namespace

Mesh read_msh(std::string_view bytes) {
  std::array<std::int32_t, 4> counts{};
  if (bytes.size() >= kMshHeader) std::memcpy(counts.data(), bytes.data(), kMshHeader);
  for (const std::int32_t count : counts) {
    if (count < 0) throw MeshError("the header holds the negative count " + std::to_string(count));
  }
  const auto at = [&](std::size_t i) { return static_cast<std::size_t>(counts[i]); };
  const std::size_t vertices = at(0), faces = at(3);
  const std::size_t skipped = 3 * at(1) * sizeof(float) + 2 * at(2) * sizeof(float);
  const std::size_t needed = kMshHeader + 12 * vertices + skipped + 12 * faces;
  if (bytes.size() != needed) {
    throw MeshError("no whole MSH file: " + count_of(bytes.size(), "bytes") + ", expected " +
                    count_of(needed, "bytes"));
  }
  Mesh mesh;
  mesh.vertices.resize(vertices);
  for (std::size_t i = 0; i < vertices; ++i) {
    std::array<float, 3> v{};
    std::memcpy(v.data(), bytes.data() + kMshHeader + i * sizeof v, sizeof v);
    mesh.vertices[i] = {v[0], v[1], v[2]};
  }
  const char* const first_face = bytes.data() + kMshHeader + 12 * vertices + skipped;
  for (std::size_t i = 0; i < faces; ++i) {
    std::array<std::int32_t, 3> corners{};
    std::memcpy(corners.data(), first_face + i * sizeof corners, sizeof corners);
    for (const std::int32_t corner : corners) {
      if (corner >= 0 && corner < counts[0]) continue;
      throw MeshError("face " + std::to_string(i) + " has the corner " + std::to_string(corner) +
                      ", which is none of the " + count_of(vertices, "vertices"));
    }
    mesh.triangles.push_back({corners[0], corners[1], corners[2]});
  }
  return mesh;
}

}  // namespace manyhands::io

// Wavefront OBJ: the vertices and faces; normals, texture coordinates, groups and materials do not matter here.
#include "manyhands/model/io/mesh/mesh_file.h"
#include "manyhands/model/io/text_numbers.h"

namespace manyhands::io {

namespace {

[[noreturn]] void fail(int line, const std::string& message) {
  throw MeshError("line " + std::to_string(line) + ": " + message);
}

Vec3<float> read_vertex(const std::vector<std::string_view>& words, int line) {
  std::array<float, 3> v{};
  for (std::size_t k = 0; k < 3; ++k) {
    const auto number = k + 1 < words.size() ? parse_number(words[k + 1]) : std::nullopt;
    if (!number) fail(line, "expected three numbers after 'v'");
    v[k] = static_cast<float>(*number);
  }
  return {v[0], v[1], v[2]};
}

/// The vertex of "7", "7/1", "7/1/3" or "7//3"; counted from 1, or backwards from the last vertex if negative.
int read_corner(std::string_view word, std::size_t num_vertices, int line) {
  const auto number = parse_number(word.substr(0, word.find('/')));
  const double n = static_cast<double>(num_vertices);
  const double index = !number ? -1 : *number < 0 ? n + *number : *number - 1;
  if (!(index >= 0 && index < n) || index != static_cast<double>(static_cast<int>(index))) {
    fail(line, "the face's corner " + in_quotes(word) + " is none of the " + std::to_string(num_vertices) +
                   " vertices before it");
  }
  return static_cast<int>(index);
}

}  // namespace

Mesh read_obj(std::string_view bytes) {
  Mesh mesh;
  int line = 0;
  while (!bytes.empty()) {
    ++line;
    const std::size_t end = bytes.find('\n');
    const std::vector<std::string_view> words = split_blanks(bytes.substr(0, end));
    bytes.remove_prefix(std::min(end == bytes.npos ? end : end + 1, bytes.size()));
    if (words.empty()) continue;
    if (words[0] == "v") {
      mesh.vertices.push_back(read_vertex(words, line));
    } else if (words[0] == "f") {
      std::vector<int> corners;
      for (std::size_t k = 1; k < words.size(); ++k) {
        corners.push_back(read_corner(words[k], mesh.vertices.size(), line));
      }
      for (std::size_t k = 2; k < corners.size(); ++k) {
        mesh.triangles.push_back({corners[0], corners[k - 1], corners[k]});
      }
    }
  }
  return mesh;
}

}  // namespace manyhands::io

// Wavefront OBJ: the vertices, faces and objects; normals, texture coordinates and materials do not matter here.
#include <map>

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

struct Object {
  std::string name;
  std::size_t first;  ///< of its triangles
};

/// All triangles; where objects begin goes to `objects`.
Mesh read_all(std::string_view bytes, std::vector<Object>& objects) {
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
    } else if (words[0] == "o" || words[0] == "g") {
      objects.push_back({words.size() > 1 ? std::string(words[1]) : "", mesh.triangles.size()});
    }
  }
  return mesh;
}

/// Triangles [first, end) with the vertices that they use, in the order of their use.
Mesh part_of(const Mesh& mesh, std::size_t first, std::size_t end) {
  Mesh part;
  std::map<int, int> places;
  for (std::size_t i = first; i < end; ++i) {
    std::array<int, 3> triangle = mesh.triangles[i];
    for (int& vertex : triangle) {
      const auto [place, is_new] = places.emplace(vertex, static_cast<int>(part.vertices.size()));
      if (is_new) part.vertices.push_back(mesh.vertices[static_cast<std::size_t>(vertex)]);
      vertex = place->second;
    }
    part.triangles.push_back(triangle);
  }
  return part;
}

}  // namespace

Mesh read_obj(std::string_view bytes) {
  std::vector<Object> objects;
  return read_all(bytes, objects);
}

std::vector<Mesh> read_obj_objects(std::string_view bytes) {
  std::vector<Object> objects{{"", 0}};  // what stands before the first name
  const Mesh all = read_all(bytes, objects);
  std::vector<Mesh> parts;
  for (std::size_t i = 0; i < objects.size(); ++i) {
    const std::size_t end = i + 1 < objects.size() ? objects[i + 1].first : all.triangles.size();
    if (objects[i].first == end) continue;
    parts.push_back(part_of(all, objects[i].first, end));
    parts.back().source = objects[i].name;
  }
  return parts;
}

}  // namespace manyhands::io

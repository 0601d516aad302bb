// glTF 2.0: the triangles of the scene's nodes, from a text (.gltf) or a binary container (.glb).
#include <cmath>
#include <cstdint>
#include <cstring>
#include <map>
#include <optional>

#include "manyhands/math/quaternion.h"
#include "manyhands/model/io/json.h"
#include "manyhands/model/io/mesh/mesh_file.h"

namespace manyhands::io {

namespace {

/// x -> A x + b.
struct Placed {
  Mat3<double> A = Mat3<double>::identity();
  Vec3<double> b = Vec3<double>::zero();

  friend Placed operator*(const Placed& outer, const Placed& inner) {
    return {outer.A * inner.A, outer.A * inner.b + outer.b};
  }
  [[nodiscard]] bool mirrors() const { return dot(A.x, cross(A.y, A.z)) < 0; }
};

std::uint32_t word_at(std::string_view bytes, std::size_t at) {
  if (at + 4 > bytes.size()) throw MeshError("the file ends too early");
  std::uint32_t value = 0;
  std::memcpy(&value, bytes.data() + at, 4);
  return value;
}

std::string base64_decoded(std::string_view text) {
  std::string bytes;
  std::uint32_t bits = 0;
  int count = 0;
  for (const char c : text) {
    const int digit = c >= 'A' && c <= 'Z'   ? c - 'A'
                      : c >= 'a' && c <= 'z' ? c - 'a' + 26
                      : c >= '0' && c <= '9' ? c - '0' + 52
                      : c == '+'             ? 62
                      : c == '/'             ? 63
                                             : -1;
    if (digit < 0) break;
    bits = (bits << 6) | static_cast<std::uint32_t>(digit);
    count += 6;
    if (count < 8) continue;
    count -= 8;
    bytes += static_cast<char>((bits >> count) & 0xff);
  }
  return bytes;
}

class GltfReader {
 public:
  GltfReader(std::string_view bytes, const GltfFiles& files) {
    constexpr std::uint32_t kMagic = 0x46546c67, kJson = 0x4e4f534a;
    std::string_view text = bytes;
    std::string_view binary;
    if (bytes.size() >= 4 && word_at(bytes, 0) == kMagic) {
      const std::size_t size = word_at(bytes, 12);
      if (word_at(bytes, 16) != kJson || size > bytes.size() - 20) throw MeshError("the file does not begin with JSON");
      text = bytes.substr(20, size);
      if (const std::size_t next = 20 + size; next + 8 <= bytes.size()) {
        binary = bytes.substr(next + 8, word_at(bytes, next));
      }
    }
    root_ = Json::parse(text);
    if (root_.has("extensionsRequired") && !root_["extensionsRequired"].array().empty()) {
      throw MeshError("the file needs the extension " + root_["extensionsRequired"].at(0).text());
    }
    if (!root_.has("buffers")) return;
    for (const Json& buffer : root_["buffers"].array()) {
      if (!buffer.has("uri")) {
        buffers_.emplace_back(binary);
        continue;
      }
      const std::string& uri = buffer["uri"].text();
      const std::size_t data = uri.find(";base64,");
      buffers_.push_back(uri.starts_with("data:") && data != uri.npos ? base64_decoded(uri.substr(data + 8))
                                                                      : files(uri));
    }
  }

  std::vector<Mesh> read() {
    const std::size_t scene = root_.has("scene") ? root_["scene"].count() : 0;
    for (const Json& node : root_["scenes"].at(scene)["nodes"].array()) {
      // Here z points up, there y.
      read_node(node.count(), {{{1, 0, 0}, {0, 0, 1}, {0, -1, 0}}, Vec3<double>::zero()}, 0);
    }
    return std::move(meshes_);
  }

 private:
  void read_node(std::size_t index, const Placed& around, int depth) {
    if (depth > kMostDepth || ++num_nodes_ > kMostNodes)
      throw MeshError("the nodes are nested too deep, or in a circle");
    const Json& node = root_["nodes"].at(index);
    const Placed place = around * place_of(node);
    if (node.has("mesh")) {
      Mesh mesh{.source = node.has("name") ? node["name"].text() : ""};
      for (const Json& primitive : root_["meshes"].at(node["mesh"].count())["primitives"].array()) {
        add(primitive, place, mesh);
      }
      meshes_.push_back(std::move(mesh));
    }
    if (!node.has("children")) return;
    for (const Json& child : node["children"].array()) read_node(child.count(), place, depth + 1);
  }

  static Placed place_of(const Json& node) {
    if (node.has("matrix")) {  // by columns
      const auto m = [&](std::size_t i) { return node["matrix"].at(i).number(); };
      return {{{m(0), m(1), m(2)}, {m(4), m(5), m(6)}, {m(8), m(9), m(10)}}, {m(12), m(13), m(14)}};
    }
    Placed place;
    const auto number = [&](const char* key, std::size_t i, double otherwise) {
      return node.has(key) ? node[key].at(i).number() : otherwise;
    };
    const Quat<double> q{number("rotation", 0, 0), number("rotation", 1, 0), number("rotation", 2, 0),
                         number("rotation", 3, 1)};
    if (!(q.x * q.x + q.y * q.y + q.z * q.z + q.w * q.w > 1e-12)) throw MeshError("a rotation of length 0");
    place.A = to_matrix(normalized(q));
    place.A.x = number("scale", 0, 1) * place.A.x;
    place.A.y = number("scale", 1, 1) * place.A.y;
    place.A.z = number("scale", 2, 1) * place.A.z;
    place.b = {number("translation", 0, 0), number("translation", 1, 0), number("translation", 2, 0)};
    return place;
  }

  void add(const Json& primitive, const Placed& place, Mesh& mesh) {
    enum Mode : std::size_t { kTriangles = 4, kStrip = 5, kFan = 6 };
    const std::size_t mode = primitive.has("mode") ? primitive["mode"].count() : kTriangles;
    if (mode < kTriangles || mode > kFan) return;  // points and lines
    const std::size_t first = mesh.vertices.size();
    const View positions = view(primitive["attributes"]["POSITION"].count(), 3);
    constexpr std::size_t kFloat = 5126;
    if (positions.type != kFloat) throw MeshError("positions that are no floats");
    num_vertices_ += positions.count;
    if (num_vertices_ > kMostVertices) throw MeshError("more than 20 million vertices");
    for (std::size_t i = 0; i < positions.count; ++i) {
      float p[3];
      std::memcpy(p, positions.data + i * positions.stride, sizeof p);
      const Vec3<double> v = place.A * Vec3<double>{p[0], p[1], p[2]} + place.b;
      mesh.vertices.push_back({static_cast<float>(v.x), static_cast<float>(v.y), static_cast<float>(v.z)});
    }
    const std::vector<int> corners = corners_of(primitive, first, positions.count);
    const std::size_t step = mode == kTriangles ? 3 : 1;
    for (std::size_t i = 0; i + 2 < corners.size(); i += step) {
      std::array<int, 3> t{corners[mode == kFan ? 0 : i], corners[i + 1], corners[i + 2]};
      if ((mode == kStrip && i % 2 == 1) != place.mirrors()) std::swap(t[1], t[2]);
      mesh.triangles.push_back(t);
    }
  }

  std::vector<int> corners_of(const Json& primitive, std::size_t first, std::size_t vertices) {
    std::vector<int> corners;
    if (!primitive.has("indices")) {
      for (std::size_t i = 0; i < vertices; ++i) corners.push_back(static_cast<int>(first + i));
      return corners;
    }
    const View indices = view(primitive["indices"].count(), 1);
    num_vertices_ += indices.count;
    if (num_vertices_ > kMostVertices) throw MeshError("more than 20 million vertices");
    for (std::size_t i = 0; i < indices.count; ++i) {
      std::uint32_t index = 0;
      std::memcpy(&index, indices.data + i * indices.stride, indices.item);
      if (index >= vertices)
        throw MeshError("a triangle names vertex " + std::to_string(index) + " of " + std::to_string(vertices));
      corners.push_back(static_cast<int>(first + index));
    }
    return corners;
  }

  struct View {
    const char* data = nullptr;
    std::size_t count = 0, stride = 0, item = 0, type = 0;
  };

  /// The numbers of an accessor, checked to lie within their buffer.
  [[nodiscard]] View view(std::size_t index, std::size_t width) const {
    const Json& accessor = root_["accessors"].at(index);
    if (accessor.has("sparse")) throw MeshError("sparse accessors are not read");
    const Json& view = root_["bufferViews"].at(accessor["bufferView"].count());
    const std::size_t buffer = view["buffer"].count();
    if (buffer >= buffers_.size()) throw MeshError("there is no buffer " + std::to_string(buffer));
    const auto or_zero = [](const Json& json, const char* key) { return json.has(key) ? json[key].count() : 0; };
    View result{.count = accessor["count"].count(), .type = accessor["componentType"].count()};
    const std::map<std::size_t, std::size_t> sizes{{5121, 1}, {5123, 2}, {5125, 4}, {5126, 4}};
    const auto size = sizes.find(result.type);
    if (size == sizes.end() || (width == 1 && result.type == 5126)) throw MeshError("numbers of an unknown type");
    result.item = size->second;
    result.stride = or_zero(view, "byteStride");
    if (result.stride == 0) result.stride = width * result.item;
    const std::size_t start = or_zero(view, "byteOffset") + or_zero(accessor, "byteOffset");
    const std::size_t end = result.count == 0 ? 0 : start + (result.count - 1) * result.stride + width * result.item;
    if (end > buffers_[buffer].size()) throw MeshError("a list reaches beyond its buffer");
    result.data = buffers_[buffer].data() + std::min(start, buffers_[buffer].size());
    return result;
  }

  static constexpr std::size_t kMostVertices = 20'000'000;
  static constexpr int kMostDepth = 64, kMostNodes = 1'000'000;

  Json root_;
  std::vector<std::string> buffers_;
  std::vector<Mesh> meshes_;
  std::size_t num_vertices_ = 0;
  int num_nodes_ = 0;
};

}  // namespace

std::vector<Mesh> read_gltf_objects(std::string_view bytes, const GltfFiles& files) {
  try {
    return GltfReader(bytes, files).read();
  } catch (const JsonError& error) {
    throw MeshError(error.what());
  }
}

Mesh read_gltf(std::string_view bytes, const GltfFiles& files) {
  Mesh whole;
  for (const Mesh& part : read_gltf_objects(bytes, files)) {
    const int first = static_cast<int>(whole.vertices.size());
    whole.vertices.insert(whole.vertices.end(), part.vertices.begin(), part.vertices.end());
    for (const auto& [a, b, c] : part.triangles) whole.triangles.push_back({first + a, first + b, first + c});
  }
  return whole;
}

}  // namespace manyhands::io
